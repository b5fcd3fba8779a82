"""Which forms and which assemblies are one up to whole turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias, TypeVar

import numpy as np

from bifurc.branch import Branch
from bifurc.torus import difference
from linkages.decisions import is_moved_by_whole_turns
from linkages.turns.turn_lattice import TurnLattice

T = TypeVar("T")
Classes: TypeAlias = list[list[T]]

SAMPLES = 400  # of a form, beside which points of another one are looked for
PLACES = 16  # of a form at which it is looked for on another one
BESIDE = 2.0  # spacings of samples by which others than the nearest may be beside it
# places that forms have in common where they are one: others meet at singular points
COMMON = 2
LENGTHS = 1e-6  # relative, by which lengths of closed forms that are one may differ


def classes_of_forms(
    branches: Sequence[Branch], lattice: TurnLattice
) -> Classes[Branch]:
    """The branches, those together that whole turns bring onto each other, all of them
    or, where they go to the limits, a part."""

    def are_one(one: Branch, other: Branch) -> bool:
        if one.closed and other.closed:
            gap = abs(one.length - other.length)
            if gap > LENGTHS * max(one.length, other.length):
                return False
        longer, shorter = (one, other) if one.length > other.length else (other, one)
        return _lies_on(shorter, longer, lattice)

    return _classes(branches, are_one)


def classes_of_assemblies(
    points: Sequence[np.ndarray], periods: np.ndarray, lattice: TurnLattice
) -> Classes[np.ndarray]:
    """The assemblies (n,), those together that are whole turns apart; ``periods`` (n,)
    are those of the unknowns."""

    def are_one(one: np.ndarray, other: np.ndarray) -> bool:
        (shift,) = lattice.shifts_towards(one[None], other)
        gap = difference(other, one + shift, periods)
        return bool(is_moved_by_whole_turns(float(np.linalg.norm(gap))))

    return _classes(points, are_one)


def _classes(things: Sequence[T], are_one: Callable[[T, T], bool]) -> Classes[T]:
    classes: Classes[T] = []
    for thing in things:
        own = next((one for one in classes if are_one(one[0], thing)), None)
        if own is None:
            classes.append([thing])
        else:
            own.append(thing)
    return classes


def _lies_on(one: Branch, other: Branch, lattice: TurnLattice) -> bool:
    """Whether whole turns bring some of the first branch onto the second one."""
    samples = other.sample(SAMPLES)
    # no end of a branch, where it may pass its limits by rounding
    fractions = (np.arange(PLACES) + 0.5) / PLACES
    common = 0
    for place in one(fractions * one.length):
        common += _passes(other, samples, place, lattice)
        if common == COMMON:
            return True
    return False


def passes_but_for_turns(
    branch: Branch, points: np.ndarray, lattice: TurnLattice
) -> np.ndarray:
    """Which of the points (k, n) whole turns bring onto a branch (k,)."""
    samples = branch.sample(SAMPLES)
    passed = [_passes(branch, samples, point, lattice) for point in points]
    return np.array(passed, dtype=bool)


def _passes(
    branch: Branch, samples: np.ndarray, place: np.ndarray, lattice: TurnLattice
) -> bool:
    """Whether whole turns bring a place (n,) onto a branch with these samples
    (k, n)."""
    shifts = lattice.shifts_towards(samples, place)
    gaps = np.linalg.norm(difference(place, samples + shifts, branch.periods), axis=1)
    # at an end it may be next to samples a turn away from where it lies on the branch
    spacing = branch.length / len(samples)
    near = np.unique(shifts[gaps <= gaps.min() + BESIDE * spacing], axis=0)
    distances, _ = branch.nearest(place - near)
    return bool(is_moved_by_whole_turns(float(distances.min())))
