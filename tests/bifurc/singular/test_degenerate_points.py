"""Singular points of every kind with a known answer, and arcs that nearly meet."""

import numpy as np
import pytest

from bifurc.branch import Branch, Outcome
from bifurc.function_problem import FunctionProblem
from bifurc.search.answer.meeting_points import meeting_points
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings, TraceSettings
from bifurc.singular.point import Kind, SingularPoint
from tests.samples import one_in

BOX = [[-1.1, 1.0], [-1.05, 1.2]]
AT_THE_ORIGIN = {  # polynomial, its kind, number of half-branches, number of forms
    "two lines": (lambda x, y: x * y, Kind.BIFURCATION, 4, 2),
    "pitchfork": (lambda x, y: x * y - y**3, Kind.BIFURCATION, 4, 2),
    "three lines": (lambda x, y: y * (y - x) * (y + 2 * x), Kind.BIFURCATION, 6, 3),
    "four lines": (
        lambda x, y: y * (y - x) * (y + x) * (x - 0.3 * y),
        Kind.BIFURCATION,
        8,
        4,
    ),
    "tacnode": (lambda x, y: y * (y - x**2), Kind.BIFURCATION, 4, 2),
    "two parabolas": (lambda x, y: (y - x**2) * (y + x**2), Kind.BIFURCATION, 4, 2),
    "two cubics": (lambda x, y: (y - x**3) * (y + x**3), Kind.BIFURCATION, 4, 2),
    "cusp": (lambda x, y: y**2 - x**3, Kind.CUSP, 2, 2),
    "cusp of the second kind": (lambda x, y: y**2 - x**5, Kind.CUSP, 2, 2),
    "isolated point": (lambda x, y: x**2 + 2 * y**2, Kind.ISOLATED, 0, 0),
}


@pytest.mark.parametrize("seed", one_in(2, range(4)))
def test_a_sharp_cusp_is_one_in_every_direction_and_with_other_rounding(seed):
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 2 * np.pi)
    across, along = np.array(
        [[-np.sin(angle), np.cos(angle)], [np.cos(angle), np.sin(angle)]]
    )

    def function(u):
        noise = 1 + 2e-16 * rng.normal(size=2)
        return np.array([noise @ [(across @ u) ** 2, -((along @ u) ** 5)]])

    settings = SearchSettings(starts=40)
    atlas = explore(FunctionProblem(function, BOX), settings=settings, seed=seed)
    (point,) = atlas.points
    assert (point.kind, point.note) == (Kind.CUSP, "")
    assert len(point.passes) == 2


@pytest.mark.parametrize("bounds", [[(-1, 1), (-1, 1)], [(-2, 2.1), (-1.7, 2.3)]])
def test_forms_from_a_cusp_end_there_and_at_the_bounds(bounds):
    atlas = explore(FunctionProblem(lambda u: [u[1] ** 2 - u[0] ** 3], bounds))
    outcomes = [form.branch.outcome for form in atlas.forms]
    assert outcomes == [Outcome.ENDS_AT_A_POINT] * 2


def stalled(start, end):
    """The straight branch between two points of the plane that stalled at both ends."""
    pieces = np.array([[(start + end) / 2, (end - start) / 2]])
    length = float(np.linalg.norm(end - start))
    half, breaks = np.array([length / 2]), np.array([0.0, length])
    return Branch(
        pieces, half, half, breaks, np.zeros(1), np.full(2, np.inf), Outcome.STALLED
    )


def meeting_point(problem, singular_point, branches):
    """The only point of the atlas of a singular point and two branches."""
    no_periods = np.full(problem.n, np.inf)
    (point,) = meeting_points(problem, [singular_point], branches, (), no_periods)
    return point


@pytest.mark.parametrize(
    "gap", [-0.03, -0.01, -1e-9, 1e-9, 0.003, 0.0199, 0.0201, 0.032, 0.05]
)
def test_a_cusp_has_its_two_ends_wherever_before_or_beyond_it_the_branches_stalled(gap):
    problem = FunctionProblem(lambda u: np.array([u[1] ** 2 - u[0] ** 5]), BOX)
    halves = np.array([[1.0, 1e-4], [1.0, -1e-4]])
    cusp = SingularPoint(
        np.zeros(2),
        0,
        np.eye(2),
        1e-3,
        halves,
        np.empty((0, 2)),
        1,
        0,
        0.02 * problem.domain.scale,
    )
    branches = [stalled(gap * half, 0.9 * half) for half in halves]
    point = meeting_point(problem, cusp, branches)
    assert (point.kind, point.note, len(point.passes)) == (Kind.CUSP, "", 2)


def test_a_branch_that_passes_a_singular_point_and_stalls_beyond_it_passes():
    problem = FunctionProblem(lambda u: np.array([u[0] * u[1]]), BOX)
    halves = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    crossing = SingularPoint(
        np.zeros(2), 0, np.eye(2), 1e-12, halves, np.empty((0, 2)), 1, 0, 0.02
    )
    branches = [stalled(-0.07 * half, 0.9 * half) for half in halves[::2]]
    point = meeting_point(problem, crossing, branches)
    assert (point.kind, point.note, len(point.passes)) == (Kind.BIFURCATION, "", 2)


@pytest.mark.parametrize("longest", one_in(2, [2.0, 0.1]))
@pytest.mark.parametrize("name", AT_THE_ORIGIN)
def test_a_singular_point_of_any_kind_is_found_once_with_its_half_branches(
    name, longest
):
    polynomial, kind, half_branches, forms = AT_THE_ORIGIN[name]
    problem = FunctionProblem(lambda u: np.array([polynomial(*u)]), BOX)
    atlas = explore(
        problem,
        settings=SearchSettings(starts=40, tracing=TraceSettings(longest=longest)),
    )
    assert [(p.kind, len(p.point.half_branches), p.note) for p in atlas.points] == [
        (kind, half_branches, "")
    ]
    assert len(atlas.forms) == forms
    # what is stated holds also where convergence was linear, beside 1e-12 for the
    # points that are exact to rounding
    assert (
        np.linalg.norm(atlas.points[0].point.u) <= atlas.points[0].point.error + 1e-12
    )


@pytest.mark.parametrize("longest", [0.02, 0.1, 0.5, 2.0])
@pytest.mark.parametrize("error", [1e-15, 1e-16])
def test_what_misses_a_crossing_by_rounding_is_a_singular_point(error, longest):
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[1] - u[1] ** 3 + error]), BOX
    )
    (point,) = explore(
        problem,
        settings=SearchSettings(starts=40, tracing=TraceSettings(longest=longest)),
    ).points
    assert point.kind is Kind.BIFURCATION
    assert np.linalg.norm(point.point.u) < np.sqrt(error)


@pytest.mark.parametrize("longest", [0.1, 2.0])
@pytest.mark.parametrize("error", [1e-6, 1e-9, 1e-12])
def test_what_doubles_resolve_is_a_near_miss_and_no_singular_point(error, longest):
    problem = FunctionProblem(
        lambda u: np.array([u[0] * u[1] - u[1] ** 3 + error]), BOX
    )
    atlas = explore(
        problem,
        settings=SearchSettings(starts=40, tracing=TraceSettings(longest=longest)),
    )
    assert (len(atlas.forms), len(atlas.points), len(atlas.near_misses)) == (2, 0, 2)
