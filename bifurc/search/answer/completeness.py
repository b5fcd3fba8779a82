"""What a search claims of its answer and what it doubts: kinds, whose words stand in the
table beside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Provenance
from bifurc.completeness import (
    Claim,
    ClaimKind,
    Completeness,
    Doubt,
    DoubtKind,
    Kinds,
    Level,
    Scope,
)
from bifurc.decisions import closes_to_rounding
from bifurc.numerics.connected_parts import connected_parts
from bifurc.search.findings import Findings
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.seeding import missed_probability

SearchClaim = Kinds(ClaimKind, __file__, "claims")
SearchDoubt = Kinds(DoubtKind, __file__, "doubts")
NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)


def judge_completeness(
    findings: Findings,
    provenance: Provenance,
    doubts: Sequence[Doubt] = (),
    held: int = 0,
) -> Completeness:
    """What the audit proves, the estimate for the rest, and what is in doubt; so many
    isolated solutions of lower rank are as they were given, ``held`` by a stress."""
    hits = findings.book.random_hits()
    hits[NO_SOLUTION] += len(findings.book.seeds.gaps)
    missed = missed_probability(list(hits.values()))
    left = len(findings.book.open_seeds)
    missed_at_most = 1.0 if provenance.out_of_time and left else missed
    total = hits.total()
    reached = total - hits[NO_SOLUTION]
    kind = SearchClaim.REACHED if reached else SearchClaim.NOTHING_REACHED
    estimate = kind.claim(
        Scope.STARTS, None, reached=reached, starts=total, missed=missed
    )
    claims = (*_claims(findings, provenance, left), estimate)
    if held:
        claims = (*claims, SearchClaim.HELD.claim(Scope.ASSEMBLIES, None, count=held))
    return Completeness(claims, tuple(doubts), missed_at_most)


def ended_early(provenance: Provenance, left: int) -> tuple[Claim, ...]:
    """The claim that a search did not come to its end, with so much ``left``; none where
    it did."""
    if provenance.interrupted:
        return (SearchClaim.INTERRUPTED.claim(Scope.SEARCH, Level.INTERRUPTED),)
    if not provenance.out_of_time:
        return ()
    budget = float(provenance.settings.budget)
    kind = SearchClaim.OUT_OF_TIME
    return (kind.claim(Scope.SEARCH, Level.OUT_OF_TIME, budget=budget, left=left),)


def _claims(findings: Findings, provenance: Provenance, left: int) -> tuple[Claim, ...]:
    """What is claimed beside the estimate, with so many starts ``left``."""
    # what an audit says holds once all that it led to is looked at
    early = ended_early(provenance, left)
    if early or findings.audit is None:
        return early
    loose = sum(not closes_to_rounding(t.misclosure) for t in findings.traced.values())
    if loose:
        kind = SearchClaim.CLOSING_TOLERANCE
        return (kind.claim(Scope.MOTIONS, Level.ESTIMATED, forms=loose),)
    return findings.audit.claims


# --- whether more random starts are worth while ---------------------------------------

# What was met by a few starts only has neighbours as small as it is that were met by none:
# of an island with a share p of N starts none comes with a probability of exp(-p N). So
# starts are drawn until each island was met some times. Where too many were met just once
# there is no end in sight, and no more are drawn.
#
# Starts that meet an island: of one as large none comes in 5e-5 of searches.
FEWEST = 10
# Share of the starts that met what no other one met: of those to come about as many meet
# something new (Good 1953).
ENDLESS = 0.25


def asks_for_more_starts(findings: Findings) -> bool:
    """Whether some island was met by few random starts, and most by more. Islands are
    forms, joined by singular points, isolated assemblies and near motions; what lies on
    components of higher dimension says nothing of them."""
    hits = _hits_of_islands(findings)
    if not len(hits) or hits.min() >= FEWEST:
        return False
    singles = np.count_nonzero(hits == 1)
    return bool(singles < ENDLESS * hits.sum())


def _hits_of_islands(findings: Findings) -> np.ndarray:
    """How many random starts (i,) met each island."""
    islands = _islands_of_forms(findings)
    rigid = [SeedFate(Fate.RIGID, k) for k in findings.rigid]
    near = [SeedFate(Fate.ON_NEAR_MOTION, k) for k in findings.near_motions]
    places: list[SeedFate | int] = [*islands.values(), *rigid, *near]
    hits = dict.fromkeys(places, 0)
    for fate, count in findings.book.random_hits().items():
        island: SeedFate | int = islands.get(fate, fate)
        if island in hits:
            hits[island] += count
    return np.array(list(hits.values()), dtype=int)


def _islands_of_forms(findings: Findings) -> dict[SeedFate, int]:
    """The number of the island that each traced branch lies on, by the fate of seeds on
    the branch."""
    branches = findings.branches
    meeting = [
        [
            number
            for number, branch in enumerate(branches)
            if branch.nearest(point.u, within=point.radius)[0][0] <= point.radius
        ]
        for point in findings.points.values()
    ]
    islands = connected_parts(len(branches), meeting)
    fates = [SeedFate(Fate.ON_FORM, number) for number in findings.traced]
    return dict(zip(fates, islands, strict=True))
