"""What a search can say of what it did not find."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from bifurc.atlas import Provenance
from bifurc.completeness import Claim, Completeness, Doubt, Level, Scope
from bifurc.decisions import closes_to_rounding
from bifurc.search.findings import Findings
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.search.statements import SearchClaim
from bifurc.seeding import missed_probability

NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)


def judge_completeness(
    findings: Findings, provenance: Provenance, doubts: Sequence[Doubt] = ()
) -> Completeness:
    """What the audit proves, the estimate for the rest, and what is in doubt."""
    hits = _count_hits(findings)
    missed = missed_probability(list(hits.values()))
    left = len(findings.open_seeds)
    missed_at_most = 1.0 if provenance.out_of_time and left else missed
    claims = (*_claims(findings, provenance, left), _estimate(hits, missed))
    return Completeness(claims, tuple(doubts), missed_at_most)


def _claims(findings: Findings, provenance: Provenance, left: int) -> tuple[Claim, ...]:
    """What is claimed beside the estimate, with so many starts ``left``."""
    # what an audit says holds once all that it led to is looked at
    if provenance.out_of_time:
        budget = provenance.settings.budget
        level = Level.OUT_OF_TIME
        out_of_time = SearchClaim.OUT_OF_TIME
        return (out_of_time.claim(Scope.SEARCH, level, budget=budget, left=left),)
    if provenance.interrupted:
        return (SearchClaim.INTERRUPTED.claim(Scope.SEARCH, Level.INTERRUPTED),)
    if findings.audit is None:
        return ()
    loose = sum(not closes_to_rounding(t.misclosure) for t in findings.traced)
    if loose:
        kind = SearchClaim.CLOSING_TOLERANCE
        return (kind.claim(Scope.MOTIONS, Level.ESTIMATED, forms=loose),)
    return findings.audit.claims


def _count_hits(findings: Findings) -> Counter[SeedFate]:
    """How many random starts came to each fate."""
    seeds = findings.seeds
    hits = Counter(
        fate for number, fate in findings.fates.items() if seeds.random[number]
    )
    hits[NO_SOLUTION] += len(seeds.gaps)
    return hits


def _estimate(hits: Counter[SeedFate], missed: float) -> Claim:
    """What random starts reached, and what one more of them would."""
    total = hits.total()
    reached = total - hits[NO_SOLUTION]
    kind = SearchClaim.REACHED if reached else SearchClaim.NOTHING_REACHED
    return kind.claim(Scope.STARTS, None, reached=reached, starts=total, missed=missed)
