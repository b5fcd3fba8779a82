"""What a search claims of its answer and what it doubts, in English: a kind each, with
its words."""

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
    Level,
    Scope,
)
from bifurc.decisions import closes_to_rounding
from bifurc.search.findings import Findings
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.seeding import missed_probability


class SearchClaim(ClaimKind):
    """What a search can claim of its answer."""

    OUT_OF_TIME = (
        "the budget of {budget:.4g} s was used up with {left} starts not looked at"
    )
    INTERRUPTED = "the search was interrupted"
    CLOSING_TOLERANCE = "{forms} of the forms close within the closing tolerance only"
    BOXES = (
        "the bounds were divided into {boxes} boxes, and each one holds no solution, or a "
        "single arc of a form listed here"
    )
    BOXES_BESIDE_POINTS = (
        "the bounds were divided into {boxes} boxes, and each one holds no solution, or a "
        "single arc of a form listed here; next to singular points, within {beside:.1g} of "
        "a quarter of the region in which solutions were found, nothing is claimed"
    )
    REACHED = (
        "{reached} of {starts} random starts reached a solution, each listed here: one "
        "more start would reach something new with a probability of at most {missed:.2g} "
        "(95 % confidence)"
    )
    NOTHING_REACHED = (
        "none of {starts} random starts reached a solution: one more start would reach "
        "something new with a probability of at most {missed:.2g} (95 % confidence)"
    )


class SearchDoubt(DoubtKind):
    """What doubles can leave undecided in the answer of a search."""

    # --- of surfaces
    SURFACE_OR_CURVES = (
        "{subject} may be a surface, or curves on one that misses the equations by "
        "{amount:.1e}, more than rounding"
    )
    UNCHARTED = (
        "no charted surface is known to hold {starts:start}, at which no chart fits: there "
        "may be more surfaces, or small parts of them"
    )
    # --- of forms
    CURVE_OR_SURFACE = (
        "{subject} may be a curve or a part of a surface: its place is known to "
        "{amount:.1e} of the scale"
    )
    MULTIPLICITY = (
        "{subject} has a multiplicity, F' having rank {rank} all along it: how large it "
        "is, and what meets it, is not known"
    )
    SEVERAL_CURVES = (
        "{subject} may be several curves, or none, {amount:.1e} of the scale from each "
        "other: along it the equations miss by what that makes"
    )
    STILL_UNKNOWNS = (
        "on {subject} rounding hides whether these unknowns stand still: {unknowns}"
    )
    UNLOCATED_POINT = (
        "{subject} is singular to within rounding about s = {amount:.6g}, where no "
        "singular point was located"
    )
    NO_BOUNDS = "{subject} is known as far as it was followed: there are no bounds on {unknowns}"
    TOO_LONG = "{subject} is longer than it was traced"
    STALLED = "{subject} stalls at {ends} of its 2 ends, where it may end or go on"
    STALLED_AT_RIM = (
        "{subject} stalls at {ends} of its 2 ends, where it may end or go on; F' is not "
        "finite beside {rough} of them"
    )
    UNCERTIFIED = "{subject} is not certified {places}"
    BLURRED = (
        "{subject} is singular to within rounding {places}, where no singular point is "
        "known"
    )
    ONE_CURVE = "{subject} stall at {point} in opposite directions and may be one curve through it"
    # --- of points
    NEAR_MISSES = (
        "{count:near miss} may be at bifurcations: the numbers of the geometry are known "
        "to {rounding:.1e} only, which explains a singular value of {amount:.1e}"
    )
    HIDDEN_POINTS = (
        "the exact equations have {count:more singular point} beside those listed, where "
        "the same branches meet again: doubles do not tell them apart"
    )
    DOUBLE_SOLUTIONS = (
        "rounding does not tell a double solution from two, or none: {points}"
    )
    POINT_OR_NEAR_MISS = (
        "{subject} ({point_kind}) may be a near miss: it misses the equations by "
        "{amount:.1e}"
    )
    UNDECIDED = "{subject} is undecided: {reason}"
    NOT_WHOLE = "{subject} ({point_kind}) is not whole: {reason}"
    UNCONFIRMED = "{subject} is seen in doubles, and more digits do not show it"
    # --- of the values of a function
    NOISE = (
        "the values of the function are noisy to {amount:.1e} of their typical change: it is "
        "solved to within that, and what is smaller is not told from it"
    )
    # --- of isolated solutions
    HIDDEN_ASSEMBLIES = (
        "rounding does not tell how many isolated solutions lie together, up to "
        "{amount:.1e} of the scale apart, at {count} of the places listed"
    )
    ON_RIM = (
        "starts end at {count:place} on the rim of where the equations are defined, and F' "
        "is not finite there: these may be isolated solutions, or lie on curves"
    )
    SHORT_STOPS = (
        "starts end where the equations are solved to {amount:.1e}, about nothing that is "
        "listed, and there may be more solutions"
    )
    # --- of near motions
    FAINT_NEAR_MOTIONS = (
        "{count} of the near motions miss by less than {amount:.0e}: where forms crossed, "
        "doubles may not tell which of them are one"
    )
    LOOSE_NEAR_MOTIONS = (
        "{count} of the near motions end where they cannot be followed, and may go on"
    )
    REPEATED_NEAR_MOTIONS = (
        "{count} of the near motions pass the same places twice: they went over to another "
        "one on the way, and their lengths are wrong"
    )
    BLURRED_NEAR_MOTIONS = (
        "{count} of the near motions pass where the rank drops but for the misclosure; "
        "there they may be interrupted"
    )
    NEAR_ASSEMBLIES = (
        "on near motions there may be more isolated solutions than are listed, where the "
        "misclosure passes zero"
    )


NO_SOLUTION = SeedFate(Fate.NO_SOLUTION)


def judge_completeness(
    findings: Findings, provenance: Provenance, doubts: Sequence[Doubt] = ()
) -> Completeness:
    """What the audit proves, the estimate for the rest, and what is in doubt."""
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
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    points, branches = findings.points.values(), findings.branches
    meet = np.zeros((len(points), len(branches)), dtype=bool)
    for row, point in enumerate(points):
        for column, branch in enumerate(branches):
            distance, _ = branch.nearest(point.u, within=point.radius)
            meet[row, column] = distance[0] <= point.radius
    rows, columns = np.nonzero(meet)
    size = len(points) + len(branches)
    places = (rows + len(branches), columns)
    links = coo_array((np.ones(len(rows)), places), shape=(size, size))
    _, islands = connected_components(links, directed=False)
    fates = [SeedFate(Fate.ON_FORM, number) for number in findings.traced]
    return dict(zip(fates, islands.tolist(), strict=False))
