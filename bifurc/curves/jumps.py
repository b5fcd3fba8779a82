"""Signs that a traced curve has jumped from one branch to another.

A branch is analytic. What stands still on one stretch of it, however short, does so all
along, and the rank of F' is the same but for single points. It has no kinks, and it
does not pass the same place twice along the same line, or it would have closed before.

Where the theorem of `bifurc.curves.certificate` holds a curve cannot jump. Stretches
are compared across other places only: beside a near miss an unknown may well all but
stand still.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import Profile, usual_rank
from bifurc.decisions import (
    goes_straight_on,
    is_same_line,
    is_same_point,
    is_slow,
    rests,
)
from bifurc.system import System

# shares of its length at which a curve is looked at again
PLACES = np.array([0.07, 0.23, 0.41, 0.61, 0.83])
SEVERAL = 2  # of these places: a curve may touch itself at one
LEAST = 4  # samples of a stretch that is compared


def repeats_itself(problem: System, branch: Branch) -> bool:
    """Whether a curve passes several of its places more than once along the same
    line."""
    within = is_same_point.threshold * problem.domain.scale
    repeated = 0
    places = branch.length * PLACES
    for point, along in zip(branch(places), branch(places, 1), strict=True):
        arclengths = branch.passes(point, within)
        if len(arclengths) < 2:
            continue
        cosines = branch(arclengths, 1) @ along
        is_along = is_same_line(1.0 - np.abs(cosines))
        repeated += int(np.count_nonzero(is_along) > 1)
    return repeated >= SEVERAL


def kinks(branch: Branch, from_ends: float = 0.0) -> np.ndarray:
    """Arclengths (k,) at which a curve goes on in another direction, farther
    ``from_ends`` than that."""
    slopes = branch.compiled.ends_of_pieces(derivative=1)
    begins, ends = slopes / np.linalg.norm(slopes, axis=2, keepdims=True)
    arclengths = branch.breaks[1:]
    after = np.roll(begins, -1, axis=0)
    if not branch.closed:
        arclengths, ends, after = arclengths[:-1], ends[:-1], after[:-1]
    is_inside = np.minimum(arclengths, branch.length - arclengths) >= from_ends
    cosines = np.sum(ends[is_inside] * after[is_inside], axis=1)
    goes_on = goes_straight_on(1.0 - cosines)
    places: np.ndarray = arclengths[is_inside][~goes_on]
    return places


def changes_of_course(branch: Branch, profile: Profile, cuts: np.ndarray) -> np.ndarray:
    """Those of the ``cuts`` (c,), arclengths in order, at which an unknown comes to
    rest or sets out, or the rank of F' changes."""
    if not len(cuts):
        return cuts
    s = profile.arclength.ravel()
    stretches = np.searchsorted(cuts, s)
    if branch.closed:
        stretches %= len(cuts)  # what comes after the last cut runs into the first
    rates = np.abs(branch(s, 1))
    values = profile.values.reshape(len(s), -1)
    courses: dict[int, _Course] = {}
    for stretch in range(len(cuts) + 1):
        inside = stretches == stretch
        if np.count_nonzero(inside) >= LEAST:
            courses[stretch] = _Course.of(rates[inside], values[inside])
    changes = []
    for k, cut in enumerate(cuts):
        after = (k + 1) % len(cuts) if branch.closed else k + 1
        are_known = k in courses and after in courses
        if are_known and courses[k].differs_from(courses[after]):
            changes.append(cut)
    return np.array(changes)


@dataclass(frozen=True)
class _Course:
    """What is the same all along a branch: which unknowns rest (n,), which move (n,), and
    the rank of F'."""

    rests: np.ndarray
    moves: np.ndarray
    rank: int

    @staticmethod
    def of(rates: np.ndarray, values: np.ndarray) -> _Course:
        """That of a stretch with rates (k, n) of the unknowns and singular values (k,
        n)."""
        largest = rates.max(axis=0)
        return _Course(
            rests=rests(largest),
            moves=~is_slow(largest),
            rank=usual_rank(values),
        )

    def differs_from(self, other: _Course) -> bool:
        """Whether one branch cannot have both."""
        sets_out = (self.rests & other.moves).any()
        comes_to_rest = (self.moves & other.rests).any()
        return bool(sets_out or comes_to_rest or self.rank != other.rank)
