"""More random starts are drawn where some of what they met was met by few."""

import numpy as np
import pytest

from bifurc.curves.continuation import trace_branch
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import profile_branch
from bifurc.function_problem import FunctionProblem
from bifurc.search.answer.completeness import FEWEST, asks_for_more_starts
from bifurc.search.findings import Findings
from bifurc.search.records import Components, RigidAssembly, TracedBranch
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.seeds import Seeds
from bifurc.singular.point import SingularPoint

# two lines that cross at the origin
PROBLEM = FunctionProblem(lambda u: np.array([u[0] * u[1]]), [(-2, 2)] * 2)


def findings_with(hits):
    """What a search knows when each fate was met by so many random starts."""
    fates = [fate for fate, count in hits.items() for _ in range(count)]
    findings = Findings(PROBLEM)
    points = np.tile([1.0, 0.0], (len(fates), 1))
    nowhere = np.empty((0, 2))
    seeds = Seeds(points, np.ones(len(fates), dtype=bool), np.empty(0), nowhere)
    findings.book.add(seeds, np.ones((len(fates), 2)))
    findings.book.fates = dict(enumerate(fates))
    numbers = [fate.number for fate in hits if fate.fate is Fate.RIGID]
    for k in range(max(numbers, default=-1) + 1):
        findings.rigid.add(RigidAssembly(np.array([0.5, k]), 0.0))
    return findings


def assemblies(*counts):
    return {SeedFate(Fate.RIGID, k): count for k, count in enumerate(counts)}


@pytest.mark.parametrize(
    ("counts", "asks"),
    [
        ((FEWEST, 30 * FEWEST), False),
        ((FEWEST - 1, 30 * FEWEST), True),
        ((0, 30 * FEWEST), True),  # known from elsewhere
        ((1, 1, 30 * FEWEST), True),
        ((1,) * 60 + (60,), False),  # as many again are to be expected
        ((), False),
    ],
)
def test_more_starts_are_asked_for_where_few_met_something(counts, asks):
    assert asks_for_more_starts(findings_with(assemblies(*counts))) == asks


def test_forms_that_cross_count_as_one():
    findings = findings_with({SeedFate(Fate.ON_FORM, 0): 2 * FEWEST})
    for start in ([1.0, 0.0], [0.0, 1.0]):
        branch = trace_branch(PROBLEM, np.array(start))
        profile = profile_branch(PROBLEM, branch)
        minima = singular_value_minima(PROBLEM, branch, profile)
        findings.add_branch(TracedBranch(branch, profile, minima, ()))
    assert asks_for_more_starts(findings)
    nothing = np.empty((0, 2))
    crossing = SingularPoint(
        np.zeros(2), 0, np.eye(2), 0.0, nothing, nothing, 1, 0, 0.01
    )
    findings.points.add(crossing)
    assert not asks_for_more_starts(findings)


def test_starts_that_met_a_surface_say_nothing_of_islands():
    findings = findings_with(assemblies(1, FEWEST))
    findings.components = Components(seeds={2: [0]})
    assert asks_for_more_starts(findings)
    only_a_surface = findings_with({})
    only_a_surface.components = Components(seeds={2: [0]})
    assert not asks_for_more_starts(only_a_surface)
