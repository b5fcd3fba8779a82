"""How near links come to each other along a form: the least distance of every two links
that share no joint, and where it is.

Links are the rods of `linkages.links.rods`, without thickness. The distance of two of
them is a Lipschitz function of the arclength, with a constant that the geometry gives,
so that nothing smaller by more than the tolerance is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bifurc.branch import Branch
from linkages.links.least_distance import find_least_distance, largest_rates
from linkages.links.rods import CORNERS, place_links
from linkages.links.segments import segment_distances
from linkages.loop import Loop

TOLERANCE = 1e-3  # of the characteristic length: how far below a minimum may be


@dataclass(frozen=True, eq=False)
class Approach:
    """Where two links are nearest along a form: those of a loop are given by the
    joints (from 0) that they follow, bodies of a mechanism by their numbers.

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
    rates = largest_rates(branch)
    approaches = []
    for pair in pairs_apart(loop.n):
        slope = _lipschitz_constant(loop, rates, pair)
        approaches.append(_nearest(loop, branch, pair, slope))
    return sorted(approaches, key=lambda approach: approach.distance)


def _nearest(
    loop: Loop, branch: Branch, pair: tuple[int, int], slope: float
) -> Approach:
    """Where two links are nearest along a branch."""

    def distance(_: np.ndarray, s: np.ndarray) -> np.ndarray:
        return distances_of_links(loop, branch(s), [pair])[:, 0]

    error = TOLERANCE * loop.characteristic_length
    least = find_least_distance(distance, np.array([slope]), branch.length, error)
    return Approach(pair, least.value, least.s, branch(least.s), least.error)


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
            between = segment_distances(
                first[..., i, :],
                first[..., i + 1, :],
                second[..., j, :],
                second[..., j + 1, :],
            )
            least = np.minimum(least, between)
    return least
