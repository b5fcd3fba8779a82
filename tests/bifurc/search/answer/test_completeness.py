"""What a search says of what it did not find."""

import numpy as np
import pytest

from bifurc.atlas import Provenance
from bifurc.completeness import Claim, Level
from bifurc.function_problem import FunctionProblem
from bifurc.search.answer.completeness import judge_completeness
from bifurc.search.findings import Findings
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.seeding import missed_probability
from bifurc.seeds import Audit, Seeds
from bifurc.settings import SearchSettings

PROBLEM = FunctionProblem(lambda u: np.array([u @ u - 1]), [(-2, 2)] * 2)
FORM, OTHER_FORM = SeedFate(Fate.ON_FORM, 0), SeedFate(Fate.ON_FORM, 1)
NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)


def findings_of(fates, missed=0, constructed=0):
    """Findings with random seeds of these fates (None: not looked at), random starts
    that missed, and constructed seeds on a form."""
    count = len(fates) + constructed
    is_random = np.arange(count) < len(fates)
    nowhere = np.zeros((missed, 2))
    seeds = Seeds(np.zeros((count, 2)), is_random, np.full(missed, 0.1), nowhere)
    findings = Findings(PROBLEM)
    findings.book.add(seeds, np.zeros((count, 2)))
    known = enumerate([*fates, *[OTHER_FORM] * constructed])
    findings.book.fates = {number: fate for number, fate in known if fate is not None}
    return findings


def test_without_an_audit_the_estimate_counts_random_starts_alone():
    findings = findings_of([FORM] * 30 + [OTHER_FORM], missed=9, constructed=5)
    completeness = judge_completeness(findings, Provenance())
    assert completeness.level is Level.ESTIMATED
    assert completeness.statement.startswith("31 of 40 random starts reached")
    assert completeness.missed_probability == missed_probability([30, 1, 9])


def test_a_start_that_cannot_be_corrected_reached_no_solution():
    findings = findings_of([FORM] * 20 + [NO_SOLUTION] * 2, missed=3)
    completeness = judge_completeness(findings, Provenance())
    assert completeness.statement.startswith("20 of 25 random starts reached")
    assert completeness.missed_probability == missed_probability([20, 5])
    lost = judge_completeness(findings_of([NO_SOLUTION], missed=1), Provenance())
    assert lost.statement.startswith("none of 2 random starts reached a solution")


@pytest.mark.parametrize("level", ["counted", "certified", "estimated"])
def test_the_word_of_the_audit_stands_before_the_estimate(level):
    findings = findings_of([FORM] * 10)
    audit = Audit((Claim("test", "so it is", level=Level(level)),), np.empty((0, 2)))
    findings.set_audit(audit)
    completeness = judge_completeness(findings, Provenance())
    assert completeness.level == level
    assert completeness.statement.startswith("so it is; 10 of 10 random starts")


def test_what_ended_a_search_early_is_said_first():
    provenance = Provenance(settings=SearchSettings(budget=2.0), out_of_time=True)
    late = judge_completeness(findings_of([FORM, None, None]), provenance)
    assert late.level is Level.OUT_OF_TIME
    assert "budget of 2 s was used up with 2 starts not looked at" in late.statement
    assert late.missed_probability == 1.0
    findings = findings_of([FORM, None])
    findings.set_audit(
        Audit((Claim("test", "so it is", level=Level.COUNTED),), np.empty((0, 2)))
    )
    assert judge_completeness(findings, provenance).level is Level.OUT_OF_TIME
    proven = findings_of([FORM])
    proven.set_audit(
        Audit((Claim("test", "so it is", level=Level.COUNTED),), np.empty((0, 2)))
    )
    assert judge_completeness(proven, provenance).level is Level.OUT_OF_TIME
    stopped = judge_completeness(findings_of([FORM]), Provenance(interrupted=True))
    assert stopped.level is Level.INTERRUPTED
