"""Distances of straight segments, many at a time, and the least of some distances along
a branch.

Where the geometry bounds how fast each of them changes, intervals that cannot hold a
smaller value are left out, and the others are halved (Piyavskii 1972, Shubert 1972).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch

FIRST_INTERVALS = 64
MOST_INTERVALS = (
    2000  # of one distance that may hold less: with more, errors are larger
)
RATE_SAMPLES = 12  # on each piece, where the rates of joints are looked at
TINY = 1e-300  # a square of a length that is none
MARGIN = 1.05  # over the largest rate that was seen

Distance = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""The distances (k,) of given numbers (k,) at arclengths (k,)."""


@dataclass(frozen=True)
class LeastDistance:
    """The least of some distances: its ``number``, its ``value`` at the arclength
    ``s``, and the ``error``: no distance is less by more than that."""

    number: int
    value: float
    s: float
    error: float


class _Sample(NamedTuple):
    """A value of the distance ``number``, at ``s``."""

    value: float
    number: int
    s: float


class _Intervals(NamedTuple):
    """Intervals (k,) of one width, each for the distance of a number: where they begin,
    and the values at both ends."""

    numbers: np.ndarray
    low: np.ndarray
    at_low: np.ndarray
    at_high: np.ndarray


def find_least_distance(
    distance: Distance,
    slopes: np.ndarray,
    length: float,
    error: float,
    floor: float = 0.0,
) -> LeastDistance:
    """The least along a branch of some distances, each of which changes by at most its
    slope (p,) for each unit of arclength and is never below the ``floor``; to within
    ``error`` unless that takes too many intervals."""
    width = length / FIRST_INTERVALS
    intervals = _first_intervals(distance, len(slopes), length)
    best = _least_end(intervals, width)
    while True:
        rises = slopes[intervals.numbers] * width
        bounds = np.maximum((intervals.at_low + intervals.at_high - rises) / 2, floor)
        may_hold_less = bounds < best.value - error
        count = np.count_nonzero(may_hold_less)
        if count == 0 or count > MOST_INTERVALS * len(slopes):
            break
        width /= 2
        wanted = _Intervals(*(column[may_hold_less] for column in intervals))
        intervals = _halves(distance, wanted, width)
        best = min(best, _least_end(intervals, width))
    lowest = best.value - error
    if count:
        lowest = min(float(bounds.min()), lowest)
    s = _polished(distance, best, width, length)
    value = float(distance(np.array([best.number]), np.array([s]))[0])
    missed = max(value - max(lowest, floor), 0.0)
    return LeastDistance(best.number, value, s, missed)


def largest_rates(branch: Branch) -> np.ndarray:
    """The largest |d theta / ds| (n,) of each joint along a branch."""
    _, rates = places_along(branch)
    largest: np.ndarray = MARGIN * np.abs(rates).max(axis=0)
    return largest


def places_along(branch: Branch) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, n) of all pieces of a branch, and the derivatives (k, n) there."""
    places = branch.places(np.linspace(0.0, 1.0, RATE_SAMPLES)).ravel()
    return branch(places), branch(places, derivative=1)


def _first_intervals(distance: Distance, count: int, length: float) -> _Intervals:
    """Intervals of equal width over a branch, for each of ``count`` distances."""
    ends = np.linspace(0.0, length, FIRST_INTERVALS + 1)
    numbers = np.repeat(np.arange(count), len(ends))
    values = distance(numbers, np.tile(ends, count)).reshape(count, len(ends))
    return _Intervals(
        np.repeat(np.arange(count), FIRST_INTERVALS),
        np.tile(ends[:-1], count),
        values[:, :-1].ravel(),
        values[:, 1:].ravel(),
    )


def _halves(distance: Distance, whole: _Intervals, width: float) -> _Intervals:
    """The halves, of this ``width``, of all intervals, first the lower ones."""
    middle = whole.low + width
    at_middle = distance(whole.numbers, middle)
    lower = whole._replace(at_high=at_middle)
    upper = whole._replace(low=middle, at_low=at_middle)
    return _Intervals(*map(np.concatenate, zip(lower, upper, strict=True)))


def _least_end(intervals: _Intervals, width: float) -> _Sample:
    """The least value at an end of intervals of this ``width``."""
    values = np.minimum(intervals.at_low, intervals.at_high)
    k = int(np.argmin(values))
    is_at_low = intervals.at_low[k] <= intervals.at_high[k]
    s = intervals.low[k] if is_at_low else intervals.low[k] + width
    return _Sample(float(values[k]), int(intervals.numbers[k]), float(s))


def _polished(distance: Distance, best: _Sample, width: float, length: float) -> float:
    """The arclength of the minimum within a ``width`` of a sample, to rounding."""
    from scipy.optimize import minimize_scalar  # it takes longer to import than a map

    low, high = max(best.s - width, 0.0), min(best.s + width, length)

    def value(x: float) -> float:
        return float(distance(np.array([best.number]), np.array([best.s + x]))[0])

    found = minimize_scalar(
        # counted from near the minimum: steps are relative to the variable
        value,
        bounds=(low - best.s, high - best.s),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return best.s + float(found.x) if found.fun < value(0.0) else best.s


# --- of segments ----------------------------------------------------------------------


def distances_by_ends(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distances (...) of segments (..., 2, 3), each given by its two ends."""
    return segment_distances(
        first[..., 0, :], first[..., 1, :], second[..., 0, :], second[..., 1, :]
    )


def segment_distances(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> np.ndarray:
    """Distances (...) of the segments from a to b and from c to d, each (..., 3); a
    segment may be a point.

    Ericson 2005, Real-Time Collision Detection, section 5.1.9: the nearest point of the
    first line, kept on the segment; the nearest to that of the second; and back, which
    also serves parallel segments, for which any point will do at first.
    """
    along, other, gap = b - a, d - c, a - c
    square, other_square = _dot(along, along), np.maximum(_dot(other, other), TINY)
    product = _dot(along, other)
    gap_along, gap_other = _dot(gap, along), _dot(gap, other)
    # divided early: fourth powers of lengths leave the range of doubles
    slope = product / other_square
    fraction = _share(slope * gap_other - gap_along, square - slope * product)
    other_fraction = _share(product * fraction + gap_other, other_square)
    fraction = _share(product * other_fraction - gap_along, square)
    between = gap + fraction[..., None] * along - other_fraction[..., None] * other
    distances: np.ndarray = np.sqrt(_dot(between, between))
    return distances


def _dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The products (...) of vectors (..., 3)."""
    products: np.ndarray = np.einsum("...i,...i", first, second)
    return products


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """The fractions (...), between 0 and 1, that parts are of a whole."""
    positive = np.maximum(whole, TINY)
    shares: np.ndarray = np.clip(part, 0.0, positive) / positive
    return shares
