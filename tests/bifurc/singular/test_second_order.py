"""Tangents of second order, all quadratic forms together."""

import numpy as np

from bifurc.function_problem import FunctionProblem
from bifurc.singular.second_order import second_order_tangents


def tangents_at_origin(function) -> np.ndarray | None:
    problem = FunctionProblem(lambda u: np.atleast_1d(function(*u)), [(-2, 2)] * 2)
    return second_order_tangents(problem, np.zeros(2), np.eye(2))


def test_two_lines_have_two_tangents():
    tangents = tangents_at_origin(lambda x, y: (x - y) * (x + 2 * y))
    assert tangents is not None
    slopes = tangents[:, 1] / tangents[:, 0]
    assert np.abs(np.sort(slopes) - [-0.5, 1.0]).max() < 1e-9


def test_tangents_satisfy_all_forms_together():
    # two quadratic forms x y and y (x + y) with the single common root y = 0
    tangents = tangents_at_origin(lambda x, y: np.array([x * y, y * (y + x)]))
    assert tangents is not None
    assert len(tangents) == 1
    assert np.abs(np.abs(tangents[0]) - [1.0, 0.0]).max() < 1e-9


def test_an_isolated_point_has_no_tangent():
    tangents = tangents_at_origin(lambda x, y: x * x + 2 * y * y)
    assert tangents is not None
    assert tangents.shape == (0, 2)


def test_forms_without_a_common_root_leave_no_tangent():
    tangents = tangents_at_origin(lambda x, y: np.array([x * y, x * x - 2 * y * y]))
    assert tangents is not None
    assert tangents.shape == (0, 2)


def test_second_order_leaves_tangential_branches_undecided():
    assert tangents_at_origin(lambda x, y: y * (y - x * x)) is None


def test_second_order_leaves_three_branches_undecided():
    assert tangents_at_origin(lambda x, y: x * (x - y) * (x + y)) is None
