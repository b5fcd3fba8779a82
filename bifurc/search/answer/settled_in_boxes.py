"""An atlas held against all isolated solutions that boxes show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.completeness import Claim, Completeness, Level, Scope
from bifurc.decisions import is_same_point
from bifurc.domain import Domain
from bifurc.search.answer.completeness import SearchClaim, SearchDoubt
from bifurc.search.canonical_order import order_points
from bifurc.search.isolated_boxes import IsolatedInBoxes
from bifurc.torus import wrap, wrapped_periods

# What starts leave open of isolated solutions, and boxes do not.
OF_SOLUTIONS = (
    SearchDoubt.HIDDEN_ASSEMBLIES,
    SearchDoubt.DOUBLE_SOLUTIONS,
    SearchDoubt.NEAR_ASSEMBLIES,
    SearchDoubt.SHORT_STOPS,
)


def settled_in_boxes(atlas: Atlas, found: IsolatedInBoxes, domain: Domain) -> Atlas:
    """The atlas of as many equations as unknowns with the solutions ``found`` in boxes,
    where these settle all of the bounds; else with a doubt where they leave open places
    that it does not know."""
    if found.is_complete:
        return _with_all(atlas, found, domain)
    places = found.left.mean(axis=2)
    is_claimed = any(
        claim.scope is Scope.ASSEMBLIES for claim in atlas.completeness.claims
    )
    if atlas.surfaces or is_claimed:
        return atlas
    count = int(np.count_nonzero(~_are_known(atlas, places, domain)))
    if not count:
        return atlas
    doubt = SearchDoubt.OPEN_BOXES.doubt(count=count)
    doubts = (*atlas.completeness.doubts, doubt)
    return replace(atlas, completeness=replace(atlas.completeness, doubts=doubts))


def _with_all(atlas: Atlas, found: IsolatedInBoxes, domain: Domain) -> Atlas:
    """The atlas with all solutions; where it has others, what it doubts is of these."""
    periods = wrapped_periods(domain.periods, domain.bounds)
    rigid = wrap(found.points, periods)
    rigid = rigid[order_points(rigid, periods, domain.scale)]
    listed = len(atlas.forms) + len(atlas.surfaces) + len(atlas.points)
    is_same = not listed and len(rigid) == len(atlas.rigid)
    claim = SearchClaim.BOXES_OF_SOLUTIONS.claim(
        Scope.ASSEMBLIES, Level.PROVED, boxes=found.count
    )
    known = atlas.completeness
    if is_same and not known.doubts:
        return replace(atlas, rigid=rigid, completeness=_and_claim(known, claim))
    names = [kind.name for kind in OF_SOLUTIONS]
    doubts = tuple(doubt for doubt in known.doubts if doubt.kind not in names)
    if not is_same:
        atlas = replace(atlas, forms=(), surfaces=(), points=(), near_motions=())
        atlas = replace(atlas, near_misses=(), dead_points=())
        doubts = ()
    completeness = replace(_and_claim(known, claim), doubts=doubts)
    provenance = replace(atlas.provenance, out_of_time=False)
    return replace(
        atlas,
        rigid=rigid,
        closure_gap=0.0 if len(rigid) else atlas.closure_gap,
        completeness=completeness,
        provenance=provenance,
    )


def _and_claim(known: Completeness, claim: Claim) -> Completeness:
    """What was known, with a further claim before what only random starts show."""
    settled = [
        one for one in known.claims if one.level in (Level.PROVED, Level.CERTIFIED)
    ]
    estimates = [one for one in known.claims if one.level is None]
    return replace(known, claims=(claim, *settled, *estimates))


def _are_known(atlas: Atlas, places: np.ndarray, domain: Domain) -> np.ndarray:
    """Which places (k, n) an atlas knows: they lie at isolated solutions, singular points,
    or on forms of it."""
    within = is_same_point.threshold * domain.scale
    points = [*atlas.rigid, *(point.point.u for point in atlas.points)]
    are_known = np.zeros(len(places), dtype=bool)
    for point in points:
        gaps = np.linalg.norm(domain.difference(places, point), axis=1)
        are_known |= is_same_point(gaps, domain.scale)
    for form in atlas.forms:
        distances, _ = form.branch.nearest(places, within=within)
        are_known |= is_same_point(distances, domain.scale)
    return are_known
