"""Singular points of every kind: what leaves them, with known answers."""

import numpy as np
import pytest

from bifurc.function_problem import FunctionProblem
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import locate_singular_point
from bifurc.singular.point import Kind, SingularPoint


def plane(function, repeat: int = 1) -> FunctionProblem:
    """The plane curve of a function, its equation given more than once."""

    def equations(u):
        return np.concatenate([np.atleast_1d(function(*u))] * repeat)

    return FunctionProblem(equations, [(-2, 2)] * 2)


def classify(problem: FunctionProblem, near) -> SingularPoint:
    """The point of nullity 2 near one, classified."""
    located = locate_singular_point(problem, np.asarray(near, dtype=float), 2, 0.5)
    assert located is not None
    return classify_singular_point(problem, located)


def assert_up_to_sign(tangents, expected, within):
    """Each of the expected directions is one of the tangents, or opposite to it."""
    for direction in np.asarray(expected, dtype=float):
        unit = direction / np.linalg.norm(direction)
        same = np.abs(tangents - unit).max(axis=1)
        opposite = np.abs(tangents + unit).max(axis=1)
        assert np.minimum(same, opposite).min() < within


CROSSINGS = {  # function, place, directions of the two branches
    "two lines": (
        lambda x, y: (x - y) * (x + 2 * y - 0.3),
        (0.1, 0.1),
        [(1, 1), (2, -1)],
    ),
    "pitchfork": (lambda x, y: x * (y - x * x), (0.0, 0.0), [(0, 1), (1, 0)]),
    "transcritical": (lambda x, y: x * (y - np.sin(x)), (0.0, 0.0), [(0, 1), (1, 1)]),
    "sharp crossing": (
        lambda x, y: y * (y - 0.05 * x),
        (0.0, 0.0),
        [(1, 0), (1, 0.05)],
    ),
    "lemniscate": (
        lambda x, y: (x * x + y * y) ** 2 - x * x + y * y,
        (0.0, 0.0),
        [(1, 1), (1, -1)],
    ),
}


@pytest.mark.parametrize("name", CROSSINGS)
@pytest.mark.parametrize("repeat", [1, 3])
def test_crossings_are_located_to_rounding_with_their_tangents(name, repeat):
    function, exact, tangents = CROSSINGS[name]
    point = classify(plane(function, repeat), np.add(exact, (0.02, -0.03)))
    off = np.linalg.norm(point.u - exact)
    assert off < 1e-12
    assert off <= point.error
    assert point.error < 1e-11
    assert (point.kind, point.rank, point.order) == (Kind.BIFURCATION, 0, 2)
    assert len(point.tangents) == 2
    assert_up_to_sign(point.tangents, tangents, 1e-9)
    assert len(point.half_branches) == 4


def test_three_branches_at_one_point_give_six_half_branches():
    point = classify(plane(lambda x, y: x * (x - y) * (x + y)), (0.02, 0.01))
    assert len(point.half_branches) == 6
    assert point.kind is Kind.BIFURCATION
    # second order says nothing here, so convergence is linear and the accuracy only
    # what the estimate says
    assert np.linalg.norm(point.u) <= point.error
    assert_up_to_sign(point.half_branches, [(0, 1), (1, 1), (1, -1)], 1e-5)


def test_an_isolated_point_has_no_half_branch():
    point = classify(plane(lambda x, y: x * x + 2 * y * y), (0.02, 0.01))
    assert point.kind is Kind.ISOLATED
    assert len(point.half_branches) == 0
    assert point.order == 2


def test_a_rank_drop_has_a_single_branch_and_is_no_bifurcation():
    # y = 0 and x = 0: the second equation alone is singular; and a factor that vanishes
    # at the origin only
    problem = plane(lambda x, y: np.array([x * y, y * (y + x)]))
    point = classify(problem, (0.02, 0.01))
    assert np.linalg.norm(point.u) < 1e-12
    assert len(point.half_branches) == 2
    assert point.kind is Kind.RANK_DROP
    assert_up_to_sign(point.half_branches, [(1, 0)], 1e-6)


def test_a_crossing_in_space_of_redundant_equations_is_classified():
    # the plane z = x y and two crossing lines in it, four equations of rank two
    def redundant(u):
        x, y, z = u
        return np.array([z - x * y, x * y, 1e3 * z, z + x * y])

    point = classify(FunctionProblem(redundant, [(-2, 2)] * 3), (0.02, -0.01, 0.01))
    assert np.linalg.norm(point.u) < 1e-12
    assert point.rank == 1
    assert_up_to_sign(point.tangents, [(1, 0, 0), (0, 1, 0)], 1e-9)
