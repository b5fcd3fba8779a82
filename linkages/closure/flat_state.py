"""What leads out of the flat state of a sheet, as its creases are assigned."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.limits import one_thread
from linkages.closure.system import ClosureSystem
from linkages.structure.leading_folds import LeadingFolds

SIZES = (0.3, 0.1, 0.03)  # rad, the largest fold angle
STAYS = 0.5  # of the fold angles of leading order, by how much they may change


class WayOut(NamedTuple):
    """A folded state ``point`` (n,) near the flat one, and which unknowns ``rest`` there
    (n,), as they do in the flat one."""

    point: np.ndarray
    rest: np.ndarray


class FlatState(NamedTuple):
    """A ``way`` out of it that was found, or whether it ``is_isolated``, as there is none;
    neither where that is not known, and where a mechanism is no flat sheet."""

    way: WayOut | None = None
    is_isolated: bool = False


def flat_state(problem: ClosureSystem) -> FlatState:
    """The flat state of a sheet in which all variables are 0."""
    structure = problem.structure
    if structure.is_held_flat or not structure.flat_vertices:
        return FlatState(is_isolated=structure.is_held_flat)
    with one_thread(problem.n):
        return _searched(problem)


def _searched(problem: ClosureSystem) -> FlatState:
    structure = problem.structure
    folds = LeadingFolds(structure.flat_vertices, structure.fold_signs)
    for fold in folds.random(np.random.default_rng(0)):
        for way in _ways_along(problem, fold):
            return FlatState(way)
    from linkages.structure.flat_boxes import first_fold  # few sheets need it

    fold, is_none = first_fold(folds)
    for way in _ways_along(problem, fold) if fold is not None else ():
        return FlatState(way)
    return FlatState(
        is_isolated=is_none and bool(folds.about[list(structure.column_of)].all())
    )


def _ways_along(problem: ClosureSystem, fold: np.ndarray) -> Iterator[WayOut]:
    """The ways out near a fold (v,) of leading order, with larger angles before
    smaller ones."""
    directions = np.zeros(problem.n)
    for variable, column in problem.structure.column_of.items():
        directions[column] = fold[variable]
    directions /= np.abs(directions).max()
    rest = directions == 0.0
    for size in SIZES:
        start = problem.reference + size * directions
        points, gaps = problem.compiled.project(start[None], rest)
        change = np.abs(points[0] - start).max()
        is_inside = problem.domain.are_inside(points)[0]
        if is_start_solved(gaps[0]) and is_inside and change < STAYS * size:
            yield WayOut(points[0], rest)
