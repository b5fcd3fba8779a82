"""What a search knows: nothing twice, and every seed has one fate."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.completeness import Claim, Level
from bifurc.curves.continuation import trace_branch
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import profile_branch
from bifurc.decisions import is_same_point
from bifurc.function_problem import FunctionProblem
from bifurc.search.findings import Findings
from bifurc.search.records import TracedBranch
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.seeds import Audit, Seeds
from bifurc.singular.germ import Germ
from bifurc.singular.local_branches import Neighbourhood
from bifurc.singular.point import SingularPoint

PROBLEM = FunctionProblem(lambda u: np.array([u @ u - 1]), [(-2, 2)] * 2)
ON_CIRCLE = np.array([[1.0, 0.0], [0.0, -1.0], [0.6, 0.8]])


def traced(start):
    branch = trace_branch(PROBLEM, start)
    profile = profile_branch(PROBLEM, branch)
    minima = singular_value_minima(PROBLEM, branch, profile)
    return TracedBranch(branch, profile, minima, ())


def point_at(u):
    nothing = np.empty((0, 2))
    return SingularPoint(np.array(u), 0, np.eye(2), 0.0, nothing, nothing, 1, 0, 0.01)


@pytest.fixture
def findings():
    points = np.concatenate([ON_CIRCLE, [[0.3, 0.3]]])
    count = len(points)
    findings = Findings(PROBLEM)
    seeds = Seeds(points, np.ones(count, dtype=bool), np.empty(0), np.empty((0, 2)))
    findings.book.add(seeds, np.zeros((count, 2)))
    return findings


def test_seeds_on_a_branch_are_settled_and_the_others_stay_open(findings):
    assert findings.book.open_seeds == [0, 1, 2, 3]
    fate = findings.add_branch(traced(ON_CIRCLE[0]))
    assert findings.match_seeds([3, 2, 0], fate.number) == [3]
    assert findings.book.fates[0] == findings.book.fates[2] == fate
    assert findings.book.open_seeds == [1, 3]
    findings.book.reopen([0])
    assert findings.book.open_seeds == [0, 1, 3]
    assert findings.match_seeds([], fate.number) == []


def test_a_branch_is_known_by_a_point_on_it_and_by_its_course(findings):
    assert findings.branch_through(ON_CIRCLE[1]) is None
    fate = findings.add_branch(traced(ON_CIRCLE[0]))
    assert findings.branch_through(ON_CIRCLE[1]) == fate
    assert (
        findings.branch_through(ON_CIRCLE[1] * (1 + 5 * is_same_point.threshold))
        is None
    )
    assert findings.branch_along(trace_branch(PROBLEM, ON_CIRCLE[2])) == fate


def test_of_no_points_none_lies_on_a_branch(findings):
    findings.add_branch(traced(ON_CIRCLE[0]))
    assert len(findings.are_on_branches(np.empty((0, 2)))) == 0


def test_a_singular_point_is_new_once(findings):
    first = findings.add_point(point_at([0.0, 1.0]))
    assert (first.number, first.is_new) == (0, True)
    again = findings.point_near(np.array([0.0, 1.0 + 1e-8]), is_same_point.threshold)
    assert again == (first.point, 0, False)
    assert findings.point_near(np.array([0.0, 1.1]), is_same_point.threshold) is None


def test_seeds_at_points_that_are_one_follow_the_point_that_stays(findings):
    errors = [0.1, 0.2, 0.3, 0.4]
    for k, error in enumerate(errors):
        findings.add_point(replace(point_at([0.1 * k, 1.0]), error=error))
    for k in range(4):
        findings.book.fates[k] = SeedFate(Fate.AT_SINGULAR_POINT, k)
    findings.merge_points([(0, 1), (1, 0), (1, 3)])  # 0 is 1, and this is 3
    assert [point.error for point in findings.points.values()] == [0.3, 0.4]
    at_third, at_fourth = (SeedFate(Fate.AT_SINGULAR_POINT, k) for k in findings.points)
    assert findings.book.fates == {
        0: at_fourth,
        1: at_fourth,
        2: at_third,
        3: at_fourth,
    }


def test_seeds_at_points_that_a_germ_replaces_are_at_its_point():
    lost = FunctionProblem(lambda u: [u[1] ** 2 - u[0] ** 8], [(-2, 2)] * 2)
    findings = Findings(lost)
    ghost = replace(point_at([1e-3, 0.0]), is_confirmed=False)
    far = point_at([1.0, 1.0])
    for point in (ghost, far):
        findings.add_point(point)
    findings.book.fates = {k: SeedFate(Fate.AT_SINGULAR_POINT, k) for k in (0, 1)}
    findings.book.fates[2] = findings.add_assembly(np.array([0.0, 0.0]))
    neighbourhood = Neighbourhood(0.01, ())
    germ = Germ(
        np.zeros(2), np.empty((0, 2)), (), neighbourhood, None, np.empty((0, 2))
    )
    sighting = findings.add_point(point_at(germ.u), germ)
    assert list(findings.points.values()) == [far, sighting.point]
    assert findings.points[findings.book.fates[1].number] is far
    assert findings.book.fates[0] == findings.book.fates[2] == sighting.fate
    assert not findings.rigid


def test_a_rigid_assembly_keeps_its_number(findings):
    places = [np.array([1.0, 2.0]), np.array([2.0, 1.0]), np.array([1.0, 2.0 + 1e-9])]
    assert [findings.add_assembly(u).number for u in places] == [0, 1, 0]
    assert len(findings.rigid) == 2


def test_an_audit_is_due_until_it_has_seen_every_branch(findings):
    audit = Audit(
        (Claim("test", "none is missing", level=Level.COUNTED),), np.empty((0, 2))
    )
    assert findings.awaits_audit
    findings.set_audit(audit)
    assert not findings.awaits_audit
    findings.add_branch(traced(ON_CIRCLE[0]))
    assert findings.awaits_audit


def test_what_stalled_on_the_way_along_another_branch_is_forgotten(findings):
    whole = traced(ON_CIRCLE[0])
    part = replace(whole.branch, outcome=Outcome.STALLED)
    kept = part.pieces[: len(part.pieces) // 2]
    half = replace(
        part,
        pieces=kept,
        breaks=part.breaks[: len(kept) + 1],
        centers=part.centers[: len(kept)],
        radii=part.radii[: len(kept)],
        residuals=part.residuals[: len(kept)],
    )
    findings.add_branch(replace(whole, branch=half))
    fate = findings.add_branch(whole)
    findings.match_seeds([0, 1, 2], fate.number)
    findings.forget_parts()
    assert findings.branches == [whole.branch]
    assert findings.book.fates[0] == fate
