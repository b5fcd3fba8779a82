"""What leads out of the flat state of a sheet, as its creases are assigned."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.domain import Domain
from bifurc.limits import one_thread
from linkages.closure.within_limits import Holding
from linkages.structure.flat_sheet import FlatVertex
from linkages.structure.leading_folds import LeadingFolds
from linkages.structure.structure import Structure

SIZES = (0.3, 0.1, 0.03)  # rad, the largest fold angle
MOST_UNKNOWNS = 500  # of sheets without modes, whose matrices are dense
UNEQUAL = 0.9  # fold angles of a way, over those of another with which it folds
STAYS = 0.5  # of the fold angles of leading order, by how much they may change


class WayOut(NamedTuple):
    """A folded state ``point`` (n,) near the flat one, and which unknowns ``rest`` there
    (n,), as they do in the flat one."""

    point: np.ndarray
    rest: np.ndarray


class FlatState(NamedTuple):
    """The ``ways`` out of it that were found, those in which most folds first, and
    whether it ``is_isolated``, as there is none."""

    ways: tuple[WayOut, ...] = ()
    is_isolated: bool = False


def flat_state(structure: Structure, domain: Domain, hold: Holding) -> FlatState:
    """The flat state of a sheet in which all variables are 0: with all ways where its
    vertices have modes, else with one that is found."""
    if structure.is_held_flat or not structure.flat_vertices:
        return FlatState(is_isolated=structure.is_held_flat)
    with one_thread(len(domain.bounds)):
        ways, is_none = _ways_and_whether_none(structure, domain, hold)
    return FlatState(ways, is_none and structure.are_about_flat_vertices)


def _ways_and_whether_none(
    structure: Structure, domain: Domain, hold: Holding
) -> tuple[tuple[WayOut, ...], bool]:
    """The ways, and whether there is not even a fold to leading order."""
    folds = structure.ways_by_modes
    if folds is not None and not len(folds):
        return (), True
    if folds is not None:
        order = np.argsort(np.count_nonzero(folds == 0.0, axis=1), kind="stable")
        folds = _with_those_together(folds[order], structure.flat_vertices)
        ways = [_way_along(structure, domain, hold, fold) for fold in folds]
        return tuple(way for way in ways if way is not None), False
    if len(domain.bounds) > MOST_UNKNOWNS:
        return (), False
    leading = LeadingFolds(structure.flat_vertices, structure.fold_signs)
    way = _with_least_at_rest(structure, domain, hold, leading)
    if way is not None:
        return (way,), False
    from linkages.structure.flat_boxes import first_fold  # few sheets need it

    first, is_none = first_fold(leading)
    way = None if first is None else _way_along(structure, domain, hold, first)
    return (() if way is None else (way,)), is_none


def _with_least_at_rest(
    structure: Structure, domain: Domain, hold: Holding, leading: LeadingFolds
) -> WayOut | None:
    """The way out to which random folds lead in which the fewest creases rest."""
    found: list[WayOut] = []
    for fold in leading.random(np.random.default_rng(0)):
        way = _way_along(structure, domain, hold, fold)
        found += [] if way is None else [way]
        if way is not None and not way.rest.any():
            break
    return min(found, key=lambda way: int(way.rest.sum()), default=None)


def _with_those_together(
    folds: np.ndarray, vertices: Sequence[FlatVertex]
) -> np.ndarray:
    """Folds (w, v) of a freedom each, and before them, where the first of them folds
    beside others at vertices of their own, all these together."""
    together = np.zeros(folds.shape[1])
    taken: set[int] = set()
    size = 1.0
    for fold in folds:
        own = {k for k, one in enumerate(vertices) if fold[list(one.variables)].any()}
        if not own & taken:
            together += size * fold
            size *= UNEQUAL
            taken |= own
    return folds if size == UNEQUAL else np.concatenate([together[None], folds])


def _way_along(
    structure: Structure, domain: Domain, hold: Holding, fold: np.ndarray
) -> WayOut | None:
    """The way out near a fold (v,) of leading order, with as large angles as close; None
    where none does."""
    directions = np.zeros(len(domain.bounds))
    for variable, column in structure.column_of.items():
        directions[column] = fold[variable]
    rest = directions == 0.0
    if rest.all():
        return None
    for size in SIZES:
        moved = directions * (size / np.abs(directions).max())
        start = structure.reference + moved
        points, gaps = hold(start[None], rest)
        change = np.abs(points[0] - start).max()
        is_inside = domain.are_inside(points)[0]
        if is_start_solved(gaps[0]) and is_inside and change < STAYS * size:
            return WayOut(np.where(rest, start, points[0]), rest)
    return None
