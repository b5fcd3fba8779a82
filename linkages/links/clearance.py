"""How near links come to each other along a form: the least distance of every two links
that share no joint, and where it is.

Links are the rods of `linkages.links.rods`, without thickness. The distance of two of
them is a Lipschitz function of the arclength, with a constant that the geometry gives:
intervals that cannot hold a smaller value are left out, the others are halved
(Piyavskii 1972, Shubert 1972), until nothing smaller by more than the tolerance is
left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import minimize_scalar

from bifurc.branch import Branch
from linkages.links.rods import CORNERS, place_links
from linkages.loop import Loop

__all__ = ["Approach", "approaches_along", "distances_of_links", "pairs_apart"]

TOLERANCE = 1e-3  # of the characteristic length: how far below a minimum may be
FIRST_INTERVALS = 64
MOST_INTERVALS = 2000  # that may hold less; where there are more the error is larger
RATE_SAMPLES = 12  # on each piece, where the rates of joints are looked at
MARGIN = 1.05  # over the largest rate that was seen
TINY = 1e-300

Distance = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Approach:
    """Where two links, given by the joints (from 0) that they follow, are nearest along
    a form.

    ``distance`` of their middle lines, the arclength ``s`` and the configuration
    ``theta`` (n,), rad, there. No distance along the form is less by more than
    ``error``.
    """

    links: tuple[int, int]
    distance: float
    s: float
    theta: np.ndarray
    error: float


def pairs_apart(n: int) -> list[tuple[int, int]]:
    """Every two links of a loop that share no joint."""
    pairs = []
    for first, second in combinations(range(n), 2):
        if second - first not in (1, n - 1):
            pairs.append((first, second))
    return pairs


def approaches_along(loop: Loop, branch: Branch) -> list[Approach]:
    """Where every two links that share no joint are nearest along a branch, the nearest
    first."""
    rates = _largest_rates(branch)
    approaches = []
    for pair in pairs_apart(loop.n):
        slope = _lipschitz_constant(loop, rates, pair)
        approaches.append(_nearest(loop, branch, pair, slope))
    return sorted(approaches, key=lambda approach: approach.distance)


def _nearest(
    loop: Loop, branch: Branch, pair: tuple[int, int], slope: float
) -> Approach:
    """Where two links are nearest along a branch."""

    def distance(s: np.ndarray) -> np.ndarray:
        return distances_of_links(loop, branch(s), [pair])[:, 0]

    error = TOLERANCE * loop.characteristic_length
    minimum = _global_minimum(distance, branch.length, slope, error)
    s = _polished(distance, minimum)
    least = float(distance(np.array([s]))[0])
    missed = max(least - minimum.bound, 0.0)
    return Approach(pair, least, s, branch(s), missed)


def _largest_rates(branch: Branch) -> np.ndarray:
    """The largest |d theta / ds| (n,) of each joint along a branch."""
    places = branch.places(np.linspace(0.0, 1.0, RATE_SAMPLES)).ravel()
    rates: np.ndarray = MARGIN * np.abs(branch(places, derivative=1)).max(axis=0)
    return rates


def _lipschitz_constant(loop: Loop, rates: np.ndarray, pair: tuple[int, int]) -> float:
    """How fast two links can near each other for each unit of arclength.

    Only the joints between them move them, either way round; of these a point of a
    closed loop is no farther away than half the way round.
    """
    lengths, _, offsets = loop.arrays
    half_way = float(np.abs(lengths).sum() + np.abs(offsets).sum()) / 2
    # joints that were moved aside stand that far out at both ends
    farthest = half_way + 2 * loop.characteristic_length
    first, second = pair
    between = rates[first + 1 : second + 1].sum()
    around = rates.sum() - between
    return farthest * float(min(between, around))


@dataclass(frozen=True)
class _Minimum:
    """A least value at ``s`` between ``low`` and ``high``, and a ``bound`` that no
    value is below."""

    low: float
    s: float
    high: float
    bound: float


def _global_minimum(
    distance: Distance, length: float, slope: float, error: float
) -> _Minimum:
    """The minimum of a distance along a branch, to within ``error`` unless that takes
    too many intervals."""
    width = length / FIRST_INTERVALS
    ends = np.linspace(0.0, length, FIRST_INTERVALS + 1)
    values = distance(ends)
    best = int(np.argmin(values))
    best_value, best_s = float(values[best]), float(ends[best])
    low, at_low, at_high = ends[:-1], values[:-1], values[1:]
    bound = _least_possible(at_low, at_high, slope * width)
    while True:
        may_hold_less = bound < best_value - error
        count = np.count_nonzero(may_hold_less)
        if count == 0 or count > MOST_INTERVALS:
            break
        low, at_low, at_high = (x[may_hold_less] for x in (low, at_low, at_high))
        width /= 2
        middle = low + width
        at_middle = distance(middle)
        least = int(np.argmin(at_middle))
        if at_middle[least] < best_value:
            best_value, best_s = float(at_middle[least]), float(middle[least])
        low = np.concatenate([low, middle])
        at_low = np.concatenate([at_low, at_middle])
        at_high = np.concatenate([at_middle, at_high])
        bound = _least_possible(at_low, at_high, slope * width)
    lowest = (
        min(float(bound.min()), best_value - error) if count else best_value - error
    )
    return _Minimum(
        low=max(best_s - width, 0.0),
        s=best_s,
        high=min(best_s + width, length),
        bound=max(lowest, 0.0),
    )


def _least_possible(at_low: np.ndarray, at_high: np.ndarray, rise: float) -> np.ndarray:
    """What a distance cannot fall below between values at the ends of intervals (k,),
    along which it changes by at most ``rise``."""
    least: np.ndarray = np.maximum((at_low + at_high - rise) / 2, 0.0)
    return least


def _polished(distance: Distance, minimum: _Minimum) -> float:
    """The arclength of the minimum, to rounding."""
    found = minimize_scalar(
        # counted from near the minimum: steps are relative to the variable
        lambda x: float(distance(np.array([minimum.s + x]))[0]),
        bounds=(minimum.low - minimum.s, minimum.high - minimum.s),
        method="bounded",
        options={"xatol": 1e-12},
    )
    known = float(distance(np.array([minimum.s]))[0])
    return minimum.s + float(found.x) if found.fun < known else minimum.s


# --- distances ------------------------------------------------------------------------


def distances_of_links(
    loop: Loop, theta: np.ndarray, pairs: list[tuple[int, int]]
) -> np.ndarray:
    """Distances (k, p) of pairs of links at configurations (k, n), rad."""
    corners = place_links(loop, theta)
    first = corners[:, [pair[0] for pair in pairs]]
    second = corners[:, [pair[1] for pair in pairs]]
    rods = range(CORNERS - 1)
    least = np.full(first.shape[:2], np.inf)
    for i in rods:
        for j in rods:
            between = _segment_distances(
                first[..., i, :],
                first[..., i + 1, :],
                second[..., j, :],
                second[..., j + 1, :],
            )
            least = np.minimum(least, between)
    return least


def _segment_distances(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> np.ndarray:
    """Distances (...) of the segments from a to b and from c to d, each (..., 3)."""
    ends = [
        _point_distances(a, c, d),
        _point_distances(b, c, d),
        _point_distances(c, a, b),
        _point_distances(d, a, b),
    ]
    least: np.ndarray = np.minimum.reduce(ends)
    normal = np.cross(b - a, d - c)
    square = (normal**2).sum(axis=-1)
    gap = c - a
    # where the lines are nearest, as fractions of the two segments
    along_first = (np.cross(gap, d - c) * normal).sum(axis=-1)
    along_second = (np.cross(gap, b - a) * normal).sum(axis=-1)
    crosses = (square > TINY) & _within(along_first, square)
    crosses &= _within(along_second, square)
    height = np.abs((gap * normal).sum(axis=-1)) / np.sqrt(np.maximum(square, TINY))
    return np.where(crosses, np.minimum(least, height), least)


def _within(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Whether fractions (...) lie between 0 and 1."""
    inside: np.ndarray = (numerator >= 0) & (numerator <= denominator)
    return inside


def _point_distances(point: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances (...) of points from the segments from a to b, each (..., 3)."""
    along = b - a
    square = np.maximum((along**2).sum(axis=-1), TINY)
    fraction = np.clip(((point - a) * along).sum(axis=-1) / square, 0.0, 1.0)
    foot = a + fraction[..., None] * along
    distance: np.ndarray = np.linalg.norm(point - foot, axis=-1)
    return distance
