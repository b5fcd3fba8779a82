"""Tracing: closing, leaving, stalling, and what it says of each."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.errors import ProblemError
from bifurc.function_problem import FunctionProblem
from bifurc.limits import Deadline
from bifurc.settings import TraceSettings
from tests.bifurc.near_surfaces import CirclesBesideSphere


def plane(function, low=-2.0, high=2.0, **more):
    return FunctionProblem(
        lambda u: np.array([function(*u)]), [(low, high)] * 2, **more
    )


def torus_line(p, q):
    """Winds p times about one angle and q times about the other before it closes."""
    return plane(
        lambda x, y: np.sin(0.5 * (q * x - p * y)),
        -np.pi,
        np.pi,
        periods=[2 * np.pi] * 2,
    )


def test_a_circle_closes_after_its_length():
    branch = trace_branch(plane(lambda x, y: x * x + y * y - 1), [0.0, 1.0])
    assert branch.outcome is Outcome.CLOSED
    assert branch.length == pytest.approx(2 * np.pi, abs=1e-12)


@pytest.mark.parametrize(("p", "q"), [(1, 0), (1, 1), (2, 1), (5, 3)])
def test_closing_is_recognised_on_the_torus_after_as_many_turns_as_it_takes(p, q):
    problem = torus_line(p, q)
    problem.domain.bounds[:] = [-np.inf, np.inf]
    branch = trace_branch(problem, np.array([0.0, 0.0]), np.array([1.0, 0.5]))
    assert branch.outcome is Outcome.CLOSED
    assert sorted(np.abs(branch.winding)) == sorted([p, q])
    assert branch.length == pytest.approx(2 * np.pi * np.hypot(p, q), abs=1e-11)


def test_a_figure_of_eight_closes_after_both_loops_and_not_at_its_crossing():
    # the lemniscate of Bernoulli with half-width 1 has the length 2 times the
    # lemniscate constant
    for start in ([1.0, 0.0], [-1.0, 0.0], [np.sqrt(3 / 8), np.sqrt(1 / 8)]):
        branch = trace_branch(
            plane(lambda x, y: (x * x + y * y) ** 2 - x * x + y * y), start
        )
        assert branch.outcome is Outcome.CLOSED
        assert branch.length == pytest.approx(5.244115108584239, abs=1e-11)


def test_the_direction_decides_which_way_a_curve_is_followed_first():
    problem = plane(lambda x, y: x * x + y * y - 1)
    for sign in (1.0, -1.0):
        branch = trace_branch(problem, [1.0, 0.0], [0.0, sign])
        assert branch(0.0, 1) == pytest.approx([0.0, sign], abs=1e-12)


def test_a_curve_that_leaves_the_region_is_followed_both_ways_to_the_bounds():
    branch = trace_branch(plane(lambda x, y: y - x**3, -1.0, 1.0), [0.2, 0.008])
    assert branch.outcome is Outcome.LEFT_REGION
    ends = branch(np.array([0.0, branch.length]))
    assert np.abs(ends) == pytest.approx(np.ones((2, 2)), abs=1e-11)


@pytest.mark.parametrize("is_recorded", [True, False])
@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_curve_ends_where_it_bulges_out_of_the_bounds(height, is_recorded):
    # y = 1 + height - x^2 leaves y <= 1 for 2 sqrt(height), far less than a piece
    problem = plane(
        lambda x, y: y - 1 - height + x * x, -1.0, 1.0, is_recorded=is_recorded
    )
    side = np.sqrt(height)
    for start in (0.5, -0.5, 0.313):
        branch = trace_branch(problem, [start, 1 + height - start**2])
        assert branch.outcome is Outcome.LEFT_REGION
        ends = branch(np.array([0.0, branch.length]))
        inner = ends[np.argmin(np.abs(ends[:, 0]))]
        # what is left of y, 1e-13, over the slope there
        expected = np.copysign(side, start)
        assert inner[0] == pytest.approx(expected, abs=1e-12 / side)
        assert inner[1] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("height", [0.0, 1e-10, -1e-10, -1e-6])
def test_a_curve_that_only_touches_a_bound_goes_on(height):
    problem = plane(lambda x, y: y - 1 - height + x * x, -1.0, 1.0)
    branch = trace_branch(problem, [0.5, 0.75 + height])
    ends = branch(np.array([0.0, branch.length]))
    assert np.sort(ends[:, 0]) == pytest.approx([-1.0, 1.0], abs=1e-9)


def test_a_region_that_is_no_box_is_followed_to_its_own_rim():
    problem = FunctionProblem(lambda u: np.array([u[1] - u[0] ** 3]), [(-2.0, 2.0)] * 2)
    problem.domain = replace(
        problem.domain, rim=lambda points: np.linalg.norm(points, axis=1) - 1.0
    )
    branch = trace_branch(problem, [0.2, 0.008])
    assert branch.outcome is Outcome.LEFT_REGION
    ends = branch(np.array([0.0, branch.length]))
    assert np.linalg.norm(ends, axis=1) == pytest.approx([1.0, 1.0], abs=1e-13)


def test_a_start_that_is_no_solution_gives_no_curve_and_its_gap():
    problem = plane(lambda x, y: x * x + y * y + 0.5)
    branch = trace_branch(problem, [0.5, 0.5])
    assert branch.outcome is Outcome.OPEN
    assert branch.length == 0.0
    # Gauss-Newton across the tangent does not go below the smallest residual on its
    # line
    assert branch.gap * problem.magnitude >= 0.5
    assert branch.max_residual == branch.gap


def test_a_curve_longer_than_allowed_says_so():
    problem = torus_line(1, 40)
    problem.domain.bounds[:] = [-np.inf, np.inf]
    branch = trace_branch(problem, [0.0, 0.0], None, TraceSettings(max_length=3.0))
    assert branch.outcome is Outcome.STEP_LIMIT
    assert branch.length > 3.0 * problem.domain.scale
    assert np.linalg.norm(problem.residuals(branch.sample(300)), axis=1).max() < 1e-12


@pytest.mark.parametrize("coefficient", [1.0, 4.0])
def test_a_cusp_ends_a_curve_at_the_cusp_and_nowhere_else(coefficient):
    branch = trace_branch(
        plane(lambda x, y: y * y - coefficient * x**3), [1.0, np.sqrt(coefficient)]
    )
    assert branch.outcome is not Outcome.CLOSED
    # every point that is returned is a solution, and the cusp is approached
    points = branch.sample(2000)
    # within 1e-4 of the cusp F is below 1e-10 whatever the direction: there it says no
    # more
    assert np.abs(points[:, 1] ** 2 - coefficient * points[:, 0] ** 3).max() < 1e-10
    assert np.linalg.norm(points, axis=1).min() < 1e-2


def test_a_crossing_is_passed_on_the_branch_that_was_followed():
    branch = trace_branch(plane(lambda x, y: x * y), [1.0, 0.0])
    assert branch.length == pytest.approx(4.0, abs=1e-12)
    assert np.abs(branch.sample(400)[:, 1]).max() < 1e-13


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 1e-8])
def test_an_arc_close_to_another_is_not_left(gap):
    # a hyperbola: the arcs come within sqrt(2 gap) of each other
    branch = trace_branch(plane(lambda x, y: x * y - gap, -1.0, 1.0), [0.5, 2 * gap])
    assert branch.outcome is Outcome.LEFT_REGION
    points = branch.sample(4000)
    assert points.min() > 0.0
    ends = sorted(branch(np.array([0.0, branch.length]))[:, 0])
    assert ends == pytest.approx([gap, 1.0], abs=1e-10)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("order", 1),
        ("order", 31),
        ("tolerance", 1e-15),
        ("tolerance", 0.1),
        ("tolerance", np.nan),
        ("shortest", 0.0),
        ("longest", 1e-10),
        ("max_length", 1.0),
    ],
)
def test_settings_out_of_range_are_refused_by_name_and_value(field, value):
    with pytest.raises(ProblemError) as caught:
        TraceSettings(**{field: value})
    assert field in caught.value.name
    assert str(value) in str(caught.value)


@pytest.mark.parametrize("start", [np.zeros(3), [np.inf, 0.0]])
def test_a_start_that_cannot_be_one_is_refused(start):
    with pytest.raises(ProblemError, match="start"):
        trace_branch(plane(lambda x, y: x * y), start)


def test_a_direction_of_the_wrong_shape_is_refused():
    with pytest.raises(ProblemError, match="direction"):
        trace_branch(plane(lambda x, y: x * y), [1.0, 0.0], [1.0])


@pytest.mark.parametrize("e", [1e-3, 1e-5, 1e-7])
def test_curves_beside_a_surface_are_followed_through_their_crossings(e):
    problem = CirclesBesideSphere(e)
    branch = trace_branch(problem, problem.points(3)[1])
    assert branch.closed
    assert branch.length == pytest.approx(2 * np.pi, abs=1e-13 / e)
    assert np.abs(branch.sample(200)[:, 0]).max() < 1e-12 / e


def test_a_curve_that_starts_on_the_bounds_runs_from_bound_to_bound():
    parabola = FunctionProblem(
        lambda u: np.array([u[0] ** 3 - u[1] * u[0]]), [(-1.5, 1.5), (-1.0, 2.0)]
    )
    start = np.array([-np.sqrt(2.0), 2.0])
    branch = trace_branch(parabola, start, np.array([1.0, 2 * start[0]]))
    assert branch.outcome is Outcome.LEFT_REGION
    ends = branch(np.array([0.0, branch.length]))
    assert ends == pytest.approx(np.array([start, [-start[0], 2.0]]), abs=1e-12)
    half = np.sqrt(2.0)  # of the arc x -> (x, x^2)
    speed = np.sqrt(1.0 + 4.0 * half**2)
    length = half * speed + 0.5 * np.arcsinh(2.0 * half)
    assert branch.length == pytest.approx(length, abs=1e-12)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("low", [0.0, -0.5, 0.1])
def test_a_curve_that_begins_at_a_bound_has_a_break_on_either_side_of_a_piece(
    low, direction
):
    bounds = [(low, 2.0), (-2.0, 2.0)]
    arc = FunctionProblem(lambda u: [u[0] ** 2 + u[1] ** 2 - 1], bounds=bounds)
    start = np.array([0.0, 1.0])
    branch = trace_branch(arc, start, np.array([direction, 0.0]))
    assert branch.outcome is Outcome.LEFT_REGION
    assert len(branch.breaks) == len(branch.pieces) + 1
    is_outside = low > 0.0
    assert (branch.length == 0.0) == is_outside
    if not is_outside:
        expected = 2 * np.arccos(low)
        assert branch.length == pytest.approx(expected, rel=1e-12)


def test_a_curve_is_followed_no_farther_once_its_time_is_over():
    wave = plane(lambda x, y: y - 0.1 * np.sin(30 * x), -20.0, 20.0)
    branch = trace_branch(wave, [0.0, 0.0], deadline=Deadline(0.0))
    assert branch.outcome is Outcome.TIME_LIMIT
    # the pieces that are made at once, to one side
    assert 0 < len(branch.pieces) <= 40
    assert branch.max_residual < 1e-12


@pytest.mark.parametrize("order", [-3, 0, 1, 2, 4, 31])
def test_an_order_out_of_its_range_is_refused_with_the_range(order):
    with pytest.raises(ProblemError) as error:
        TraceSettings(order=order)
    assert str(error.value) == (
        f"order: {order} is not allowed; it must be from 5 to 30 for a tolerance of "
        "1e-13; pieces of a lower order are too short"
    )


@pytest.mark.parametrize(
    ("tolerance", "lowest"), [(1e-2, 2), (1e-7, 3), (1e-10, 4), (1e-13, 5), (1e-14, 5)]
)
def test_the_lowest_order_follows_a_circle_in_some_thousand_pieces(tolerance, lowest):
    with pytest.raises(ProblemError, match=f"from {lowest} to 30"):
        TraceSettings(order=lowest - 1, tolerance=tolerance)
    settings = TraceSettings(order=lowest, tolerance=tolerance)
    circle = plane(lambda x, y: x * x + y * y - 1)
    branch = trace_branch(circle, [0.0, 1.0], settings=settings)
    assert branch.outcome is Outcome.CLOSED
    assert branch.length == pytest.approx(2 * np.pi, abs=30 * tolerance)
    assert len(branch.pieces) < 10_000
