"""What a search can say of what it did not find."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Form, MeetingPoint, Provenance
from bifurc.branch import Outcome
from bifurc.curves.certificate import Certificate
from bifurc.problem import Problem
from bifurc.search.findings import Findings
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.seeding import missed_probability
from bifurc.seeds import Completeness, Level
from bifurc.singular.point import Kind

__all__ = ["describe_doubt", "judge_completeness"]

NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)
# of an end, in scales, at which a form stalls: a cusp may lie so far beyond
AT_END = 0.2


def judge_completeness(
    findings: Findings, provenance: Provenance, doubt: str = ""
) -> Completeness:
    """What the audit proves, and the estimate for the rest.

    Where forms are in ``doubt`` the audit was made of curves that may have jumped or
    end too early, and proves nothing.
    """
    hits = _count_hits(findings)
    missed = missed_probability(list(hits.values()))
    estimate = _estimate(hits, missed)
    audit = findings.audit
    if audit is None and provenance.out_of_time:
        left = len(findings.open_seeds)
        statement = (
            f"the budget of {provenance.settings.budget:.4g} s was used up with "
            f"{left} starts not looked at; {estimate}"
        )
        bound = 1.0 if left else missed
        return Completeness(Level.OUT_OF_TIME, statement, bound)
    if provenance.interrupted:
        statement = f"the search was interrupted; {estimate}"
        return Completeness(Level.INTERRUPTED, statement, missed)
    if audit is None:
        return Completeness(Level.ESTIMATED, estimate, missed)
    cut_off = sum(branch.outcome is Outcome.STEP_LIMIT for branch in findings.branches)
    if cut_off:
        statement = (
            f"{cut_off} of the forms are longer than they were traced; {estimate}"
        )
        return Completeness(Level.ESTIMATED, statement, missed)
    if doubt:
        statement = f"{doubt}; {estimate}"
        return Completeness(Level.ESTIMATED, statement, missed)
    return Completeness(audit.level, f"{audit.statement}; {estimate}", missed)


def describe_doubt(
    problem: Problem, forms: Sequence[Form], points: Sequence[MeetingPoint]
) -> str:
    """Which forms, numbered from 1, are not certified, and from where to where, which
    may be anything there to within rounding, and which stall where there is no cusp; empty where none does."""
    parts = []
    for index, form in enumerate(forms):
        doubt = ""
        if form.certificate is not None and form.certificate.leaves_doubt:
            doubt = _refusal(form.certificate)
        elif not _is_whole(problem, form, _cusps_on(points, index)):
            doubt = "stalls where there is no cusp"
        if doubt:
            parts.append(f"form {index + 1} {doubt}")
    return ", ".join(parts)


def _refusal(certificate: Certificate) -> str:
    """Where nothing is certified, in words."""
    if len(certificate.gaps):
        return f"is not certified {_places(certificate.gaps)}"
    where = _places(certificate.blurred)
    return f"is singular to within rounding {where}, where no singular point is known"


def _places(intervals: np.ndarray) -> str:
    """The first of some intervals (k, 2), in words, and how many more there are."""
    low, high = intervals[0]
    places = f"between s = {low:.6g} and {high:.6g}"
    more = len(intervals) - 1
    if more:
        places += f" and at {more} more places"
    return places


def _cusps_on(points: Sequence[MeetingPoint], index: int) -> list[float]:
    """Arclengths of the cusps on a form, given by its index."""
    arclengths = []
    for point in points:
        if point.kind is Kind.CUSP:
            arclengths += [s for form, s in point.passes if form == index]
    return arclengths


def _is_whole(problem: Problem, form: Form, cusps: Sequence[float]) -> bool:
    """Whether a form does not stall, or there are ``cusps`` at both its ends."""
    if form.branch.outcome is not Outcome.STALLED:
        return True
    reach = AT_END * problem.scale
    begins = any(s < reach for s in cusps)
    ends = any(form.branch.length - s < reach for s in cusps)
    return begins and ends


def _count_hits(findings: Findings) -> Counter[SeedFate]:
    """How many random starts came to each fate."""
    seeds = findings.seeds
    hits = Counter(
        fate for number, fate in findings.fates.items() if seeds.random[number]
    )
    hits[NO_SOLUTION] += len(seeds.gaps)
    return hits


def _estimate(hits: Counter[SeedFate], missed: float) -> str:
    """What random starts reached, and what one more of them would, as a sentence."""
    total = hits.total()
    reached = total - hits[NO_SOLUTION]
    if reached:
        outcome = (
            f"{reached} of {total} random starts reached a solution, each listed here"
        )
    else:
        outcome = f"none of {total} random starts reached a solution"
    return (
        f"{outcome}: one more start would reach something new with a probability of "
        f"at most {missed:.2g} (95 % confidence)"
    )
