"""Curves along which F' has a lower rank throughout."""

import numpy as np

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, lower_rank_direction
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


def double_circle() -> FunctionProblem:
    """The unit circle of the plane z = 0 as a double curve: F' has rank 1 of 3 all
    along it."""
    return FunctionProblem(
        lambda u: np.array(
            [
                (u[0] ** 2 + u[1] ** 2 - 1) ** 2,
                u[2] + u[0] * (u[0] ** 2 + u[1] ** 2 - 1),
            ]
        ),
        [[-2, 2]] * 3,
    )


def test_a_double_circle_is_traced_round_to_full_accuracy():
    branch = trace_branch(
        Deflated(double_circle()), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    )
    assert branch.outcome is Outcome.CLOSED
    assert abs(branch.length - 2 * np.pi) < 1e-12
    points = branch.sample(1000)
    # deflation makes the curve regular: no square root of the rounding is lost
    assert np.abs(np.linalg.norm(points[:, :2], axis=1) - 1).max() < 1e-12
    assert np.abs(points[:, 2]).max() < 1e-12


def test_the_tangent_at_a_point_of_a_double_circle_comes_from_a_section():
    along = lower_rank_direction(double_circle(), np.array([0.6, 0.8, 0.0]))
    assert along is not None
    # a chord of the section at radius 1e-2 turns from the tangent by less than that
    assert abs(along @ [-0.8, 0.6, 0.0]) > 1 - 1e-4


def test_a_crossing_of_two_curves_is_no_curve_of_lower_rank():
    crossing = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [[-1, 1]] * 2)
    assert lower_rank_direction(crossing, np.zeros(2)) is None


def test_a_regular_point_is_no_start_of_a_curve_of_lower_rank():
    circle = FunctionProblem(lambda u: np.array([u @ u - 1]), [[-2, 2]] * 2)
    assert lower_rank_direction(circle, np.array([1.0, 0.0])) is None


def test_explore_finds_a_double_circle_once_and_says_its_multiplicity():
    atlas = explore(double_circle(), settings=SearchSettings(starts=40))
    assert [(form.multiplicity, form.branch.outcome) for form in atlas.forms] == [
        (2, Outcome.CLOSED)
    ]
    assert atlas.points == ()


def test_a_curve_of_lower_rank_on_a_surface_is_no_form():
    """A plane, along a line of which the other equation vanishes to second order."""
    atlas = explore(
        FunctionProblem(
            lambda u: [u[0] * u[1], u[0] * (u[1] + u[0])], [(-1.3, 1.2)] * 3
        )
    )
    assert not atlas.forms
    assert [surface.dimension for surface in atlas.surfaces] == [2]
