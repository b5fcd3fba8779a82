"""An atlas held against all isolated solutions that boxes show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.completeness import Scope
from bifurc.decisions import is_same_point
from bifurc.domain import Domain
from bifurc.search.answer.completeness import SearchDoubt
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
    of which there are none where these settle all of the bounds; else with a doubt where
    they leave open places that it does not know."""
    if found.is_complete:
        return _without_any(atlas, found)
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


def listed_solutions(found: IsolatedInBoxes, domain: Domain) -> np.ndarray:
    """The solutions (k, n) found in boxes, as an atlas lists them."""
    periods = wrapped_periods(domain.periods, domain.bounds)
    rigid = wrap(found.points, periods)
    listed: np.ndarray = rigid[order_points(rigid, periods, domain.scale)]
    return listed


def _without_any(atlas: Atlas, found: IsolatedInBoxes) -> Atlas:
    """The atlas of equations that have no solution; where it has some, what it doubts is
    of these."""
    is_same = not any(
        map(len, (atlas.forms, atlas.surfaces, atlas.points, atlas.rigid))
    )
    known = atlas.completeness
    names = [kind.name for kind in OF_SOLUTIONS]
    doubts = tuple(doubt for doubt in known.doubts if doubt.kind not in names)
    estimates = tuple(claim for claim in known.claims if claim.level is None)
    if not is_same:
        atlas = replace(atlas, forms=(), surfaces=(), points=(), near_motions=())
        atlas = replace(atlas, near_misses=(), dead_points=(), rigid=found.points)
        doubts = ()
    return replace(
        atlas,
        completeness=replace(known, claims=(found.claim, *estimates), doubts=doubts),
        provenance=replace(atlas.provenance, out_of_time=False),
    )


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
