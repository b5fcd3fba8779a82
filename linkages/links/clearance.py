"""How near links of a loop, or bodies of a mechanism, come to each other along a form:
the least distance of every two that share no joint, and where it is.

Links are the rods of `linkages.links.rods`, bodies the lines of
`linkages.links.mechanism_drawing`, without thickness. The distance of two of them is a
Lipschitz function of the arclength, with a constant that the geometry of links gives,
and the speeds of bodies, so that nothing smaller by more than the tolerance is left.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias

import numpy as np

from bifurc.branch import Branch
from linkages.links.distances import (
    MARGIN,
    RATE_SAMPLES,
    distances_by_ends,
    find_least_distance,
    largest_rates,
)
from linkages.links.mechanism_drawing import draw_bodies
from linkages.links.rods import place_links
from linkages.loop import Loop
from linkages.readout.poses import Poses
from linkages.structure.structure import Structure

TOLERANCE = 1e-3  # of the characteristic length: how far below a minimum may be
STEP = 1e-5  # rad, along a branch: of the differences that are taken for speeds

Pair: TypeAlias = tuple[int, int]  # of links, or of bodies, by their numbers


@dataclass(frozen=True, eq=False)
class Approach:
    """Where two links are nearest along a form: those of a loop are given by the
    joints (from 0) that they follow, bodies of a mechanism by their numbers.

    ``distance`` of their middle lines, the arclength ``s`` and the configuration
    ``theta`` (n,), rad, there. No distance along the form is less by more than
    ``error``.
    """

    links: Pair
    distance: float
    s: float
    theta: np.ndarray
    error: float


def _approaches(
    pairs: Iterable[Pair],
    branch: Branch,
    distances: Callable[[np.ndarray, Pair], np.ndarray],
    speed: Callable[[Pair], float],
    size: float,
) -> list[Approach]:
    """Where pairs, which near each other no faster than at some speed, are nearest along
    a branch, the nearest first; ``distances`` gives those (k,) at configurations
    (k, n), ``size`` is the characteristic length."""
    approaches = []
    error = TOLERANCE * size
    for pair in pairs:

        def distance(_: np.ndarray, s: np.ndarray, pair: Pair = pair) -> np.ndarray:
            return distances(branch(s), pair)

        slopes = np.array([speed(pair)])
        least = find_least_distance(distance, slopes, branch.length, error)
        place = branch(least.s)
        approaches.append(Approach(pair, least.value, least.s, place, least.error))
    return sorted(approaches, key=lambda approach: approach.distance)


def _between(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The least distances (k,) of lines (k, m, 2, 3) from others."""
    distances = distances_by_ends(first[:, :, None], second[:, None])
    least: np.ndarray = distances.min(axis=(1, 2))
    return least


# --- links of a loop ------------------------------------------------------------------


def pairs_apart(n: int) -> list[Pair]:
    """Every two links of a loop that share no joint."""
    pairs = combinations(range(n), 2)
    return [(first, last) for first, last in pairs if last - first not in (1, n - 1)]


def approaches_along(loop: Loop, branch: Branch) -> list[Approach]:
    """Where every two links that share no joint are nearest along a branch, the nearest
    first."""
    rates = largest_rates(branch)
    return _approaches(
        pairs_apart(loop.n),
        branch,
        lambda points, pair: distances_of_links(loop, points, pair),
        lambda pair: _lipschitz_constant(loop, rates, pair),
        loop.characteristic_length,
    )


def distances_of_links(loop: Loop, theta: np.ndarray, pair: Pair) -> np.ndarray:
    """Distances (k,) of two links at configurations (k, n), rad."""
    corners = place_links(loop, theta)[:, list(pair)]
    rods = np.stack([corners[:, :, :-1], corners[:, :, 1:]], axis=3)
    return _between(rods[:, 0], rods[:, 1])


def _lipschitz_constant(loop: Loop, rates: np.ndarray, pair: Pair) -> float:
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


# --- bodies of a mechanism ------------------------------------------------------------


class Bodies:
    """The ``lines`` (m, 2, 3) of every body of a ``structure`` in its reference
    configuration, in the user's unit, with rails as long as slides are used along a
    ``branch``."""

    def __init__(self, structure: Structure, branch: Branch):
        places = branch.places(np.linspace(0.0, 1.0, RATE_SAMPLES)).ravel()
        self.structure = structure
        self.branch = branch
        self.poses = Poses(structure)
        points, rates = branch(places), branch(places, derivative=1)
        drawings = draw_bodies(structure, points)
        lines = [np.array(one["lines"]).reshape(-1, 2, 3) for one in drawings]
        self.lines = [structure.unit * one for one in lines]
        steps = (points - STEP * rates, points + STEP * rates)
        self._before, self._after = (self.poses.at(step) for step in steps)

    def pairs_apart(self) -> list[Pair]:
        """Every two bodies, by number, that have lines and share no joint."""
        mechanism = self.structure.mechanism
        drawn = [body for body, lines in enumerate(self.lines) if len(lines)]
        apart = []
        for pair in combinations(drawn, 2):
            names = {mechanism.bodies[body] for body in pair}
            if not any(names <= set(joint.bodies) for joint in mechanism.joints):
                apart.append(pair)
        return apart

    def distances(self, points: np.ndarray, pair: Pair) -> np.ndarray:
        """Distances (k,) of two bodies at configurations (k, n) of the structure."""
        poses = self.poses.at(points)
        first, second = (_moved(self.lines[body], poses[:, body]) for body in pair)
        return _between(first, second)

    def closing_speed(self, pair: Pair) -> float:
        """How fast two bodies can near each other for each unit of arclength: no faster
        than the fastest end of a line of one, seen from the other, either way round."""
        speeds = []
        for seen_from, body in (pair, pair[::-1]):
            before, after = (
                np.linalg.inv(poses[:, seen_from]) @ poses[:, body]
                for poses in (self._before, self._after)
            )
            lines = self.lines[body]
            change = np.linalg.norm(
                _moved(lines, after) - _moved(lines, before), axis=-1
            )
            speeds.append(float(change.max()) / (2 * STEP))
        return MARGIN * min(speeds)


def approaches_of_bodies(structure: Structure, branch: Branch) -> list[Approach]:
    """Where every two bodies that share no joint are nearest along a branch of the
    closure of a structure, the nearest first; bodies are given by their numbers."""
    bodies = Bodies(structure, branch)
    return _approaches(
        bodies.pairs_apart(),
        branch,
        bodies.distances,
        bodies.closing_speed,
        structure.unit,
    )


def _moved(lines: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Lines (k, m, 2, 3) that transforms (k, 4, 4) make of lines (m, 2, 3)."""
    turned = lines.reshape(-1, 3) @ np.swapaxes(poses[:, :3, :3], 1, 2)
    moved: np.ndarray = turned + poses[:, None, :3, 3]
    return moved.reshape(len(poses), -1, 2, 3)
