"""An atlas held against all isolated solutions that boxes show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.completeness import Claim, Scope
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
    SearchDoubt.ON_RIM,
)


def settled_in_boxes(atlas: Atlas, found: IsolatedInBoxes, domain: Domain) -> Atlas:
    """The atlas of as many equations as unknowns with the solutions ``found`` in boxes
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
    """The atlas of equations of which all solutions are ``found``, each isolated; where it
    has others, what it doubts is of these."""
    periods = wrapped_periods(domain.periods, domain.bounds)
    points = wrap(found.points, periods)
    points = points[order_points(points, periods, domain.scale)]
    known = atlas.completeness
    names = [kind.name for kind in OF_SOLUTIONS]
    doubts = tuple(doubt for doubt in known.doubts if doubt.kind not in names)
    if any(map(len, (atlas.forms, atlas.surfaces, atlas.points))):
        atlas = replace(atlas, forms=(), surfaces=(), points=(), near_motions=())
        atlas = replace(atlas, near_misses=(), dead_points=())
        doubts = ()
    others = [_beside_boxes(claim, len(points)) for claim in known.claims]
    claims = (found.claim, *(claim for claim in others if claim is not None))
    return replace(
        atlas,
        rigid=points,
        completeness=replace(known, claims=claims, doubts=doubts),
        provenance=replace(atlas.provenance, out_of_time=False),
    )


def _beside_boxes(claim: Claim, count: int) -> Claim | None:
    """What a claim says beside boxes with so many solutions, which show more: an estimate,
    or that of all paths which end at as many."""
    if claim.level is None:
        return claim
    is_same = (
        SearchClaim.ALL_ISOLATED.is_kind_of(claim) and claim.data["inside"] == count
    )
    return replace(claim, level=None) if is_same else None


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
