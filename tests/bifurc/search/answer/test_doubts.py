"""What doubles leave undecided is said, and no level is high then."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.atlas import Provenance
from bifurc.branch import Branch, Outcome
from bifurc.completeness import Claim, Doubt, Level
from bifurc.curves.continuation import trace_branch
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem
from bifurc.numerics.blur import blur_along
from bifurc.search.answer.completeness import judge_completeness
from bifurc.search.answer.doubts import doubts_of
from bifurc.search.answer.meeting_points import meeting_points
from bifurc.search.branches.branch_parts import part_of
from bifurc.search.explore import explore
from bifurc.search.findings import Findings
from bifurc.search.records import TracedBranch
from bifurc.seeds import Audit
from bifurc.settings import SearchSettings
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint
from bifurc.singular.point import Kind, SingularPoint
from tests.bifurc.known_surfaces import SPHERE
from tests.bifurc.near_surfaces import CirclesBesideSphere
from tests.samples import one_in

FEW = SearchSettings(starts=12, charts=300)


def test_curves_beside_a_surface_are_told_from_it():
    atlas = explore(CirclesBesideSphere(1e-6), settings=FEW)
    assert [len(atlas.forms), len(atlas.bifurcations)] == [2, 2]
    assert all(form.branch.closed for form in atlas.forms)
    assert not atlas.surfaces and not len(atlas.rigid)
    assert not atlas.completeness.is_in_doubt


def test_a_surface_that_misses_by_more_than_rounding_is_in_doubt():
    atlas = explore(CirclesBesideSphere(1e-13), settings=FEW)
    assert len(atlas.surfaces) == 1
    statement = atlas.completeness.statement
    assert statement.startswith("in doubt: surface 1 may be a surface, or curves")
    assert atlas.completeness.level is Level.ESTIMATED


def test_a_surface_is_not_in_doubt():
    atlas = explore(SPHERE, settings=FEW)
    assert len(atlas.surfaces) == 1
    assert not atlas.completeness.is_in_doubt


def traced(problem, branch: Branch) -> TracedBranch:
    nothing = (np.empty(0), np.empty(0))
    profile = profile_branch(problem, branch)
    blur = blur_along(problem, branch)
    return TracedBranch(branch, profile, nothing, (), blur=blur)


def test_a_form_known_less_well_than_points_are_told_apart_is_in_doubt():
    clear = CirclesBesideSphere(1e-3)
    branch = trace_branch(clear, clear.points(3)[1])
    assert not list(doubts_of(clear, [traced(clear, branch)], [], [], []))
    # the great circle is a solution whatever e is
    blurred = CirclesBesideSphere(1e-10)
    (doubt,) = doubts_of(blurred, [traced(blurred, branch)], [], [], [])
    assert doubt.text.startswith("Form 1 may be a curve or a part of a surface")


def test_a_form_that_stalls_at_nothing_known_is_in_doubt():
    problem = CirclesBesideSphere(1.0)
    branch = trace_branch(problem, problem.points(3)[1])
    assert not list(doubts_of(problem, [traced(problem, branch)], [], [], []))
    loose = replace(branch, outcome=Outcome.STALLED)
    (doubt,) = doubts_of(problem, [traced(problem, loose)], [], [], [])
    assert doubt.text.startswith("Form 1 stalls at 2 of its 2 ends")


@pytest.mark.parametrize("level", [Level.COUNTED, Level.CERTIFIED])
def test_nothing_is_proved_of_an_answer_in_doubt(level):
    findings = Findings(SPHERE)
    findings.set_audit(
        Audit((Claim("test", "no motion is missing", level=level),), np.empty((0, 3)))
    )
    assert judge_completeness(findings, Provenance()).level is level
    completeness = judge_completeness(
        findings, Provenance(), [Doubt("undecided", "B1 is undecided")]
    )
    assert completeness.level is Level.ESTIMATED
    assert completeness.statement.startswith("in doubt: B1 is undecided; no motion")


@pytest.mark.parametrize("power", [3, 5])
def test_a_form_that_ends_at_a_cusp_and_at_the_bounds_is_not_in_doubt(power):
    problem = FunctionProblem(
        lambda u: np.array([u[1] ** 2 - u[0] ** power]), [(-2.0, 2.1)] * 2
    )
    atlas = explore(problem, settings=SearchSettings(starts=40))
    assert [point.kind for point in atlas.points] == [Kind.CUSP]
    assert not atlas.completeness.is_in_doubt


def test_forms_that_end_where_no_bounds_are_given_are_in_doubt():
    parabola = FunctionProblem(lambda u: [u[1] - u[0] ** 2], [(-2, 2), (-1, np.inf)])
    assert not explore(parabola).completeness.is_in_doubt
    free = FunctionProblem(lambda u: [u[1] - u[0] ** 2], [(-np.inf, np.inf)] * 2)
    statement = explore(free).completeness.statement
    assert statement.startswith("in doubt: ")
    assert "no bounds on u2" in statement


def crossing_of_lines() -> tuple[FunctionProblem, tuple[SingularPoint, list[Branch]]]:
    """Two lines that cross, the point where they do, and both of them traced."""
    problem = FunctionProblem(lambda u: [u[0] * u[1]], [(-1, 1)] * 2)
    place = LocatedPoint(np.zeros(2), np.eye(2), 1e-15)
    point = classify_singular_point(problem, place)
    starts = (
        (np.array([0.5, 0.0]), np.eye(2)[0]),
        (np.array([0.0, 0.5]), np.eye(2)[1]),
    )
    return problem, (point, [trace_branch(problem, *start) for start in starts])


def test_a_point_with_fewer_branches_traced_than_seen_is_in_doubt():
    problem, (point, branches) = crossing_of_lines()
    periods = np.full(2, np.inf)
    whole = meeting_points(problem, [point], branches, (), periods)
    assert whole[0].note == ""
    lines = [traced(problem, branch) for branch in branches]
    assert not list(doubts_of(problem, lines, [], whole, ()))
    lacking = meeting_points(problem, [point], branches[:1], (), periods)
    (doubt,) = doubts_of(problem, lines[:1], [], lacking, ())
    assert "2 half-branches were traced, the section shows 4" in doubt.text


def test_a_bifurcation_with_another_count_of_branches_is_said_not_to_be_whole():
    problem, (point, branches) = crossing_of_lines()
    fewer = replace(point, half_branches=point.half_branches[:2])
    met = meeting_points(problem, [fewer], branches, (), np.full(2, np.inf))
    lines = [traced(problem, branch) for branch in branches]
    (doubt,) = doubts_of(problem, lines, [], met, ())
    assert doubt.text == (
        f"{met[0].name} (bifurcation) is not whole: 4 half-branches were traced, the "
        "section shows 2"
    )


def test_halves_of_a_curve_that_stall_at_a_bifurcation_are_in_doubt():
    problem, (point, (line, other)) = crossing_of_lines()
    middle = 0.5 * line.length
    halves = [
        replace(part_of(line, *ends), outcome=Outcome.STALLED)
        for ends in ((0.0, middle), (middle, line.length))
    ]
    branches = [*halves, other]
    met = meeting_points(problem, [point], branches, (), np.full(2, np.inf))
    assert met[0].note == ""
    forms = [traced(problem, branch) for branch in branches]
    (doubt,) = doubts_of(problem, forms, [], met, ())
    assert doubt.text == (
        f"ends of Form 1 and Form 2 at {met[0].name}, where they stall in opposite "
        "directions, may be of one curve through it"
    )
    assert doubt.naming(["Bennett form", "4R form", "Form I"]).text == (
        f"ends of Bennett form and 4R form at {met[0].name}, where they stall in opposite "
        "directions, may be of one curve through it"
    )


@pytest.mark.parametrize("distance", [1e-3, 3e-4])
@pytest.mark.parametrize("seed", one_in(2, range(2)))
def test_crossings_that_doubles_do_not_tell_apart_are_in_doubt(distance, seed):
    def function(u):
        x, y = u
        return [y * (y - x * (x**2 - distance**2))]

    problem = FunctionProblem(function, [(-2, 2)] * 2)
    atlas = explore(problem, settings=FEW, seed=seed)
    missing = 3 - len(atlas.bifurcations)
    assert atlas.completeness.is_in_doubt == (missing > 0)
    if missing:
        more = f"the exact equations have {missing} more singular point"
        assert more in atlas.completeness.statement
