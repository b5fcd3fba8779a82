"""Where the joints of a mechanism are, and how far along each its point may be chosen.

A cylindrical joint may be written as a turn and a slide with a body between them, a
planar one as two slides and a turn. They are one place here, however they are written,
and the bodies between have no length.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkages.decisions import is_parallel_axis
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism

__all__ = ["JointPlace", "joint_places"]

ON_AXIS = 1e-9  # of a distance from the origin: a point that lies on an axis
# freedoms of the point of a joint: along its axis, or anywhere
ALONG = (JointKind.REVOLUTE, JointKind.CYLINDRICAL, JointKind.HELICAL)
ANYWHERE = (JointKind.PRISMATIC, JointKind.PLANAR, JointKind.RIGID)
TURNS = (JointKind.REVOLUTE, JointKind.HELICAL)


@dataclass(frozen=True, eq=False)
class JointPlace:
    """A ``point`` (3,) that stands for joints between ``bodies``, which may move along
    ``free`` unit vectors (k, 3)."""

    bodies: frozenset[str]
    point: np.ndarray
    free: np.ndarray


def joint_places(mechanism: Mechanism) -> list[JointPlace]:
    """The places of all joints, those that make one cylindrical or planar joint
    together as one."""
    chains = _planar_chains(mechanism)
    used = {id(joint) for chain in chains for joint in chain}
    for pair in _cylindrical_pairs(mechanism):
        if not used & {id(joint) for joint in pair}:
            chains.append(pair)
            used |= {id(joint) for joint in pair}
    places = [
        JointPlace(frozenset(joint.bodies), joint.place, _free_directions(joint))
        for joint in mechanism.joints
        if id(joint) not in used
    ]
    return places + [_place_of_chain(chain) for chain in chains]


def _place_of_chain(chain: list[Joint]) -> JointPlace:
    """The place of joints between whose bodies nothing else is: that of the turn, anywhere
    for one in a plane."""
    ends = frozenset(chain[0].bodies)
    for joint in chain[1:]:
        ends ^= frozenset(joint.bodies)
    (turn,) = [joint for joint in chain if joint.kind in TURNS]
    free = np.eye(3) if len(chain) > 2 else _free_directions(turn)
    return JointPlace(ends, turn.place, free)


def _neighbours(mechanism: Mechanism) -> list[list[Joint]]:
    """The two joints of every body that has but two, if they lead on from there to two
    other bodies."""
    pairs = []
    for body in mechanism.bodies:
        joints = [joint for joint in mechanism.joints if body in joint.bodies]
        is_binary = len(joints) == 2 and all(len(one.bodies) == 2 for one in joints)
        if is_binary and set(joints[0].bodies) != set(joints[1].bodies):
            pairs.append(joints)
    return pairs


def _cylindrical_pairs(mechanism: Mechanism) -> list[list[Joint]]:
    """Turns and slides that make a cylindrical joint. Of several turns beside a slide
    it is that whose axis its point lies on, and none where that does not tell."""
    turns_of: dict[str, list[Joint]] = {}
    slides: dict[str, Joint] = {}
    for joints in _neighbours(mechanism):
        for slide, turn in (joints, joints[::-1]):
            if slide.kind is not JointKind.PRISMATIC or turn.kind not in TURNS:
                continue
            if is_parallel_axis(_sine(slide, turn)):
                slides[slide.name] = slide
                turns_of.setdefault(slide.name, []).append(turn)
    pairs = []
    for name, turns in turns_of.items():
        own = turns
        if len(turns) > 1:
            own = [turn for turn in turns if _is_on_axis(slides[name], turn)]
        if len(own) == 1:
            pairs.append([slides[name], own[0]])
    return pairs


def _planar_chains(mechanism: Mechanism) -> list[list[Joint]]:
    """Two slides and a turn across them, in any order, that make a planar joint. Of
    several that share a joint it is that whose slides have their points on the axis, and
    none where that does not tell."""
    chains: list[list[Joint]] = []
    for first, second in combinations(_neighbours(mechanism), 2):
        chain = list({joint.name: joint for joint in first + second}.values())
        if len(chain) == 3 and _is_planar(chain):
            chains.append(chain)
    return [
        chain
        for chain in chains
        if not _rivals(chain, chains)
        or (
            _is_at_its_turn(chain)
            and not any(map(_is_at_its_turn, _rivals(chain, chains)))
        )
    ]


def _rivals(chain: list[Joint], chains: list[list[Joint]]) -> list[list[Joint]]:
    """The other chains that share a joint with one."""
    names = {joint.name for joint in chain}
    return [
        other
        for other in chains
        if other is not chain and names & {joint.name for joint in other}
    ]


def _is_at_its_turn(chain: list[Joint]) -> bool:
    """Whether the slides of a chain have their points on the axis of its turn."""
    (turn,) = [joint for joint in chain if joint.kind in TURNS]
    return all(_is_on_axis(slide, turn) for slide in chain if slide is not turn)


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


def _is_on_axis(slide: Joint, turn: Joint) -> bool:
    """Whether the point that is given for a slide lies on the axis of a turn."""
    if slide.point is None:
        return False
    gap = slide.place - turn.place
    distance = np.linalg.norm(np.cross(gap, turn.motions[0].direction))
    size = max(np.linalg.norm(slide.place), np.linalg.norm(turn.place))
    return bool(distance <= ON_AXIS * size)


def _free_directions(joint: Joint) -> np.ndarray:
    """Unit vectors (k, 3) along which the point of a joint may be chosen."""
    if joint.kind in ANYWHERE:
        return np.eye(3)
    if joint.kind in ALONG:
        return joint.motions[0].direction[None]
    return np.empty((0, 3))
