"""Where the joints of a mechanism are, and how far along each its point may be chosen.

A cylindrical joint may be written as a turn and a slide with a body between them, a
planar one as two slides and a turn. They are one place here, however they are written,
and the bodies between have no length.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkages.decisions import is_parallel_axis
from linkages.mechanisms.joint import Joint, JointKind, Place
from linkages.mechanisms.mechanism import Mechanism

TURNS = (JointKind.REVOLUTE, JointKind.HELICAL)


@dataclass(frozen=True, eq=False)
class JointPlace:
    """A ``point`` (3,) that stands for ``joints``, by their names, between ``bodies``,
    which may move along ``free`` unit vectors (k, 3)."""

    joints: tuple[str, ...]
    bodies: frozenset[str]
    point: np.ndarray
    free: np.ndarray


def joint_places(mechanism: Mechanism) -> list[JointPlace]:
    """The places of all joints, those that make one cylindrical or planar joint
    together as one. Where the point of a slide is given does not matter."""
    neighbours = _neighbours(mechanism)
    planar = _planar_chains(neighbours)
    in_planes = {joint.name for chain in planar for joint in chain}
    rest = [
        pair for pair in neighbours if not in_planes & {joint.name for joint in pair}
    ]
    cylindrical = _cylindrical_chains(rest)
    used = in_planes | {joint.name for chain in cylindrical for joint in chain}
    places = [
        JointPlace(
            (joint.name,),
            frozenset(joint.bodies),
            joint.place,
            _free_directions(joint),
        )
        for joint in mechanism.joints
        if joint.name not in used
    ]
    places += [_place_of_chain(chain, np.eye(3)) for chain in planar]
    for chain in cylindrical:
        places.append(_place_of_chain(chain, _free_directions(chain[0])))
    return places


def _place_of_chain(chain: list[Joint], free: np.ndarray) -> JointPlace:
    """The place of joints between whose bodies nothing else is: that of the turn."""
    ends = frozenset(chain[0].bodies)
    for joint in chain[1:]:
        ends ^= frozenset(joint.bodies)
    (turn,) = [joint for joint in chain if joint.kind in TURNS]
    names = tuple(joint.name for joint in chain)
    return JointPlace(names, ends, turn.place, free)


def _neighbours(mechanism: Mechanism) -> list[list[Joint]]:
    """The two joints of every body that has but two, if they lead on from there to two
    other bodies."""
    pairs = []
    for joints in mechanism.joints_of.values():
        is_binary = len(joints) == 2 and all(len(one.bodies) == 2 for one in joints)
        if is_binary and set(joints[0].bodies) != set(joints[1].bodies):
            pairs.append(joints)
    return pairs


def _cylindrical_chains(neighbours: list[list[Joint]]) -> list[list[Joint]]:
    """Turns, each with the slides along its axis beside it.

    A slide between two turns is with either of them: it is as far from one to the
    other, whichever has it.
    """
    chains: dict[str, list[Joint]] = {}
    placed: set[str] = set()
    for joints in neighbours:
        for slide, turn in (joints, joints[::-1]):
            if slide.kind is not JointKind.PRISMATIC or turn.kind not in TURNS:
                continue
            if slide.name in placed or not is_parallel_axis(_sine(slide, turn)):
                continue
            chains.setdefault(turn.name, [turn]).append(slide)
            placed.add(slide.name)
    return list(chains.values())


def _planar_chains(neighbours: list[list[Joint]]) -> list[list[Joint]]:
    """Two slides and a turn across them, in any order, that make a planar joint. Of
    several that share a joint none is: each would leave another turn where it is."""
    chains: list[list[Joint]] = []
    for first, second in combinations(neighbours, 2):
        chain = list({joint.name: joint for joint in first + second}.values())
        if len(chain) == 3 and _is_planar(chain):
            chains.append(chain)
    counts = Counter(joint.name for chain in chains for joint in chain)
    return [chain for chain in chains if all(counts[one.name] == 1 for one in chain)]


def _is_planar(chain: list[Joint]) -> bool:
    slides = [joint for joint in chain if joint.kind is JointKind.PRISMATIC]
    turns = [joint for joint in chain if joint.kind is JointKind.REVOLUTE]
    if len(slides) != 2 or len(turns) != 1:
        return False
    if is_parallel_axis(_sine(*slides)):
        return False
    normal = turns[0].motions[0].direction
    across = [abs(float(slide.motions[0].direction @ normal)) for slide in slides]
    return bool(is_parallel_axis(max(across)))


def _sine(first: Joint, second: Joint) -> float:
    """The sine of the angle between the directions of two joints."""
    directions = first.motions[0].direction, second.motions[0].direction
    return float(np.linalg.norm(np.cross(*directions)))


def _free_directions(joint: Joint) -> np.ndarray:
    """Unit vectors (k, 3) along which the point of a joint may be chosen."""
    match joint.kind.facets.place:
        case Place.ANYWHERE:
            return np.eye(3)
        case Place.ALONG:
            return joint.motions[0].direction[None]
        case Place.FIXED:
            return np.empty((0, 3))
