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
from scipy.optimize import minimize_scalar

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
    minimum = _global_minimum(distance, slopes, length, error, floor)
    s = _polished(distance, minimum)
    number = np.array([minimum.number])
    value = float(distance(number, np.array([s]))[0])
    missed = max(value - minimum.bound, 0.0)
    return LeastDistance(minimum.number, value, s, missed)


def largest_rates(branch: Branch) -> np.ndarray:
    """The largest |d theta / ds| (n,) of each joint along a branch."""
    places = branch.places(np.linspace(0.0, 1.0, RATE_SAMPLES)).ravel()
    rates: np.ndarray = MARGIN * np.abs(branch(places, derivative=1)).max(axis=0)
    return rates


class _Sample(NamedTuple):
    """A value of the distance ``number``, at ``s``."""

    value: float
    number: int
    s: float


@dataclass(frozen=True, eq=False)
class _Intervals:
    """Intervals (k,) of one ``width``, each for the distance of a number: where they
    begin, and the values at both ends."""

    numbers: np.ndarray
    low: np.ndarray
    at_low: np.ndarray
    at_high: np.ndarray
    width: float

    def bounds(self, slopes: np.ndarray, floor: float) -> np.ndarray:
        """What the distances (k,) cannot fall below inside."""
        rises = slopes[self.numbers] * self.width
        least: np.ndarray = np.maximum((self.at_low + self.at_high - rises) / 2, floor)
        return least

    def halved(self, distance: Distance) -> _Intervals:
        """The halves of all intervals, first the lower ones."""
        width = self.width / 2
        middle = self.low + width
        at_middle = distance(self.numbers, middle)
        return _Intervals(
            np.concatenate([self.numbers, self.numbers]),
            np.concatenate([self.low, middle]),
            np.concatenate([self.at_low, at_middle]),
            np.concatenate([at_middle, self.at_high]),
            width,
        )

    def those(self, mask: np.ndarray) -> _Intervals:
        """The intervals where ``mask`` (k,) says so."""
        return _Intervals(
            self.numbers[mask],
            self.low[mask],
            self.at_low[mask],
            self.at_high[mask],
            self.width,
        )

    def least(self) -> _Sample:
        """The least value at an end."""
        values = np.minimum(self.at_low, self.at_high)
        k = int(np.argmin(values))
        is_at_low = self.at_low[k] <= self.at_high[k]
        s = self.low[k] if is_at_low else self.low[k] + self.width
        return _Sample(float(values[k]), int(self.numbers[k]), float(s))


@dataclass(frozen=True)
class _Minimum:
    """A least value, of the distance ``number``, at ``s`` between ``low`` and
    ``high``, and a ``bound`` that no value is below."""

    number: int
    low: float
    s: float
    high: float
    bound: float


def _global_minimum(
    distance: Distance, slopes: np.ndarray, length: float, error: float, floor: float
) -> _Minimum:
    """The minimum of all distances along a branch, to within ``error`` unless that
    takes too many intervals."""
    intervals = _first_intervals(distance, len(slopes), length)
    most = MOST_INTERVALS * len(slopes)
    best = intervals.least()
    while True:
        bounds = intervals.bounds(slopes, floor)
        may_hold_less = bounds < best.value - error
        count = np.count_nonzero(may_hold_less)
        if count == 0 or count > most:
            break
        intervals = intervals.those(may_hold_less).halved(distance)
        best = min(best, intervals.least())
    lowest = best.value - error
    if count:
        lowest = min(float(bounds.min()), lowest)
    return _Minimum(
        number=best.number,
        low=max(best.s - intervals.width, 0.0),
        s=best.s,
        high=min(best.s + intervals.width, length),
        bound=max(lowest, floor),
    )


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
        length / FIRST_INTERVALS,
    )


def _polished(distance: Distance, minimum: _Minimum) -> float:
    """The arclength of the minimum, to rounding."""
    number = np.array([minimum.number])

    def value(x: float) -> float:
        return float(distance(number, np.array([minimum.s + x]))[0])

    found = minimize_scalar(
        # counted from near the minimum: steps are relative to the variable
        value,
        bounds=(minimum.low - minimum.s, minimum.high - minimum.s),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return minimum.s + float(found.x) if found.fun < value(0.0) else minimum.s


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
