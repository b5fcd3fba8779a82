"""What a search can say of what it did not find."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from bifurc.atlas import Provenance
from bifurc.decisions import closes_to_rounding
from bifurc.search.findings import Findings
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.seeding import missed_probability
from bifurc.seeds import Completeness, Level

IN_DOUBT = "in doubt: "  # how the statement on an answer begins that is not decided

NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)


def judge_completeness(
    findings: Findings, provenance: Provenance, doubts: Sequence[str] = ()
) -> Completeness:
    """What the audit proves, and the estimate for the rest.

    Of an answer that holds ``doubts`` nothing is proved: the statement begins with
    them.
    """
    completeness = _without_doubts(findings, provenance)
    if not doubts:
        return completeness
    level = completeness.level
    if level in (Level.PROVED, Level.CERTIFIED):
        level = Level.ESTIMATED
    statement = f"{IN_DOUBT}{'; '.join(doubts)}; {completeness.statement}"
    return replace(completeness, level=level, statement=statement)


def _without_doubts(findings: Findings, provenance: Provenance) -> Completeness:
    """The same, where everything is decided."""
    hits = _count_hits(findings)
    missed = missed_probability(list(hits.values()))
    estimate = _estimate(hits, missed)
    audit = findings.audit
    # what an audit says holds once all that it led to is looked at
    if provenance.out_of_time:
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
    loose = sum(not closes_to_rounding(t.misclosure) for t in findings.traced)
    if loose:
        statement = (
            f"{loose} of the forms close within the closing tolerance only; {estimate}"
        )
        return Completeness(Level.ESTIMATED, statement, missed)
    return Completeness(audit.level, f"{audit.statement}; {estimate}", missed)


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
