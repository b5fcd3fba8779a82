"""How near bodies of a mechanism come to each other along a form: the least distance of
every two that share no joint, and where it is.

Bodies are the lines of `linkages.links.mechanism_drawing`, without thickness. The
distance of two of them changes no faster than the ends of the lines of one move, seen
from the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from linkages.links.clearance import TOLERANCE, Approach
from linkages.links.least_distance import (
    MARGIN,
    RATE_SAMPLES,
    find_least_distance,
)
from linkages.links.mechanism_drawing import draw_bodies
from linkages.links.segments import distances_by_ends
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.poses import Poses
from linkages.structure.structure import Structure

STEP = 1e-5  # rad, along a branch: of the differences that are taken for speeds


@dataclass(frozen=True, eq=False)
class BodyLines:
    """The lines (m, 2, 3) of every body of a ``structure`` in its reference
    configuration, in the user's unit."""

    structure: Structure
    lines: tuple[np.ndarray, ...]

    def pairs_apart(self) -> list[tuple[int, int]]:
        """Every two bodies, by number, that have lines and share no joint."""
        mechanism = self.structure.mechanism
        drawn = [body for body, lines in enumerate(self.lines) if len(lines)]
        pairs = combinations(drawn, 2)
        return [pair for pair in pairs if not _share_a_joint(mechanism, pair)]


def lines_of_bodies(structure: Structure, branch: Branch) -> BodyLines:
    """The lines of all bodies, with rails as long as slides are used along a branch."""
    drawings = draw_bodies(structure, branch(_places(branch)))
    lines = [np.array(one["lines"]).reshape(-1, 2, 3) for one in drawings]
    return BodyLines(structure, tuple(structure.unit * one for one in lines))


def approaches_of_bodies(structure: Structure, branch: Branch) -> list[Approach]:
    """Where every two bodies that share no joint are nearest along a branch of the
    closure of a structure, the nearest first; bodies are given by their numbers."""
    bodies = lines_of_bodies(structure, branch)
    steps = _steps_along(structure, branch)
    approaches = []
    for pair in bodies.pairs_apart():
        speed = _closing_speed(bodies, steps, pair)
        approaches.append(_nearest(bodies, branch, pair, speed))
    return sorted(approaches, key=lambda approach: approach.distance)


def _share_a_joint(mechanism: Mechanism, pair: tuple[int, int]) -> bool:
    names = {mechanism.bodies[body] for body in pair}
    return any(names <= set(joint.bodies) for joint in mechanism.joints)


def _nearest(
    bodies: BodyLines, branch: Branch, pair: tuple[int, int], speed: float
) -> Approach:
    """Where two bodies, which near each other no faster than at some speed, are nearest
    along a branch."""

    def distance(_: np.ndarray, s: np.ndarray) -> np.ndarray:
        return distances_of_bodies(bodies, branch(s), pair)

    error = TOLERANCE * bodies.structure.unit
    least = find_least_distance(distance, np.array([speed]), branch.length, error)
    return Approach(pair, least.value, least.s, branch(least.s), least.error)


# --- distances ------------------------------------------------------------------------


def distances_of_bodies(
    bodies: BodyLines, points: np.ndarray, pair: tuple[int, int]
) -> np.ndarray:
    """Distances (k,) of two bodies at configurations (k, n) of the structure."""
    poses = Poses(bodies.structure).at(points)
    first, second = (
        _moved(bodies.lines[body], poses[:, body]).reshape(len(points), -1, 2, 3)
        for body in pair
    )
    between = distances_by_ends(first[:, :, None], second[:, None])
    least: np.ndarray = between.min(axis=(1, 2))
    return least


def _moved(lines: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """The ends (k, 2 m, 3) of lines (m, 2, 3) after transforms (k, 4, 4)."""
    ends = lines.reshape(-1, 3)
    turned = ends @ np.swapaxes(poses[:, :3, :3], 1, 2)
    moved: np.ndarray = turned + poses[:, None, :3, 3]
    return moved


# --- speeds ---------------------------------------------------------------------------


class _Steps(NamedTuple):
    """The poses (k, b, 4, 4) of all bodies `STEP` before and after some places of a
    branch."""

    before: np.ndarray
    after: np.ndarray


def _steps_along(structure: Structure, branch: Branch) -> _Steps:
    """Steps at some places on each piece of a branch."""
    places = _places(branch)
    points, rates = branch(places), branch(places, derivative=1)
    poses = Poses(structure)
    return _Steps(poses.at(points - STEP * rates), poses.at(points + STEP * rates))


def _places(branch: Branch) -> np.ndarray:
    """Arclengths (k,) on every piece of a branch."""
    places: np.ndarray = branch.places(np.linspace(0.0, 1.0, RATE_SAMPLES)).ravel()
    return places


def _closing_speed(bodies: BodyLines, steps: _Steps, pair: tuple[int, int]) -> float:
    """How fast two bodies can near each other for each unit of arclength: no faster
    than the fastest end of a line of one, seen from the other, either way round."""
    first, second = pair
    speeds = [
        _largest_speed(bodies.lines[second], steps, first, second),
        _largest_speed(bodies.lines[first], steps, second, first),
    ]
    return MARGIN * min(speeds)


def _largest_speed(
    lines: np.ndarray, steps: _Steps, seen_from: int, body: int
) -> float:
    """The largest speed of an end of the lines of a body, seen from another one."""
    before, after = (
        _moved(lines, np.linalg.inv(poses[:, seen_from]) @ poses[:, body])
        for poses in steps
    )
    return float(np.linalg.norm(after - before, axis=-1).max()) / (2 * STEP)
