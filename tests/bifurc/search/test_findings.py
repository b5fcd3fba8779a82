"""What a search knows: nothing twice, and every seed has one fate."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.branch import Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import profile_branch
from bifurc.decisions import is_same_point
from bifurc.function_problem import FunctionProblem
from bifurc.search.findings import Findings, TracedBranch
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.seeds import Audit, Level, Seeds
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
    findings.add_seeds(seeds, np.zeros((count, 2)))
    return findings


def test_seeds_on_a_branch_are_settled_and_the_others_stay_open(findings):
    assert findings.open_seeds == [0, 1, 2, 3]
    number = findings.add_branch(traced(ON_CIRCLE[0]))
    assert findings.match_seeds([3, 2, 0], number) == [3]
    assert findings.fates[0] == findings.fates[2] == SeedFate(Fate.ON_FORM, number)
    assert findings.open_seeds == [1, 3]
    findings.reopen_seeds([0])
    assert findings.open_seeds == [0, 1, 3]
    assert findings.match_seeds([], number) == []


def test_a_branch_is_known_by_a_point_on_it_and_by_its_course(findings):
    assert findings.branch_through(ON_CIRCLE[1]) is None
    number = findings.add_branch(traced(ON_CIRCLE[0]))
    assert findings.branch_through(ON_CIRCLE[1]) == number
    assert (
        findings.branch_through(ON_CIRCLE[1] * (1 + 5 * is_same_point.threshold))
        is None
    )
    assert findings.branch_along(trace_branch(PROBLEM, ON_CIRCLE[2])) == number


def test_a_singular_point_is_new_once(findings):
    first = findings.add_point(point_at([0.0, 1.0]))
    assert (first.number, first.is_new) == (0, True)
    again = findings.point_near(np.array([0.0, 1.0 + 1e-8]), is_same_point.threshold)
    assert again == (first.point, 0, False)
    assert findings.point_near(np.array([0.0, 1.1]), is_same_point.threshold) is None


def test_a_rigid_assembly_keeps_its_number(findings):
    places = [np.array([1.0, 2.0]), np.array([2.0, 1.0]), np.array([1.0, 2.0 + 1e-9])]
    assert [findings.rigid_assembly(u) for u in places] == [0, 1, 0]
    assert len(findings.rigid) == 2


def test_an_audit_is_due_until_it_has_seen_every_branch(findings):
    audit = Audit(Level.PROVED, "none is missing", np.empty((0, 2)))
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
    number = findings.add_branch(whole)
    findings.match_seeds([0, 1, 2], number)
    findings.forget_parts()
    assert findings.branches == [whole.branch]
    assert findings.fates[0] == SeedFate(Fate.ON_FORM, 0)
