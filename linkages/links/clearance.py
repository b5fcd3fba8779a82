"""How near links of a loop, or bodies of a mechanism, come to each other along a form:
the least distance of every two that share no joint, and where it is.

They are lines without thickness (`linkages.links.parts`). The distance of two of them is
a Lipschitz function of the arclength, with a constant that the geometry of links gives,
and the speeds of bodies, so that nothing smaller by more than the tolerance is left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch
from linkages.links.distances import (
    distances_by_ends,
    find_least_distance,
    places_along,
)
from linkages.links.parts import Pair, Parts, moved_lines

TOLERANCE = 1e-3  # of the characteristic length: how far below a minimum may be


@dataclass(frozen=True, eq=False)
class Approach:
    """Where two of some parts, by their numbers, are nearest along a form.

    ``distance`` of their lines, the arclength ``s`` and the configuration ``theta``
    (n,) there. No distance along the form is less by more than ``error``.
    """

    links: Pair
    distance: float
    s: float
    theta: np.ndarray
    error: float


def approaches_along(parts: Parts, branch: Branch) -> list[Approach]:
    """Where every two parts that share no joint are nearest along a branch, the nearest
    first."""
    lines = parts.lines(places_along(branch)[0])
    pairs = parts.pairs_apart(lines)
    speeds = parts.closing_speeds(pairs, lines, branch)
    error = TOLERANCE * parts.size
    approaches = []
    for pair, speed in zip(pairs, speeds, strict=True):

        def distance(_: np.ndarray, s: np.ndarray, pair: Pair = pair) -> np.ndarray:
            return distances_of(parts, lines, branch(s), pair)

        slopes = np.array([speed])
        least = find_least_distance(distance, slopes, branch.length, error)
        place = branch(least.s)
        approaches.append(Approach(pair, least.value, least.s, place, least.error))
    return sorted(approaches, key=lambda approach: approach.distance)


def distances_of(
    parts: Parts, lines: list[np.ndarray], points: np.ndarray, pair: Pair
) -> np.ndarray:
    """Distances (k,) of two parts with these lines at configurations (k, n)."""
    poses = parts.poses(points)
    first, second = (moved_lines(lines[body], poses[:, body]) for body in pair)
    distances = distances_by_ends(first[:, :, None], second[:, None])
    least: np.ndarray = distances.min(axis=(1, 2))
    return least
