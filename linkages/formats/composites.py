"""Joints that several joints one after the other make together, in MJCF and in SDF.

SDF knows no cylindrical and no planar joint. In files that are written here a joint C is
written as C.turn and C.slide with a link C.turn.link between them, a planar one as C.x,
C.y and C.turn. Read as one again, it has its name, and the mechanism its size and
Grübler's count.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_one_joint
from linkages.formats.assembly import (
    BodyJoint,
    frame_along,
    in_bodies,
    translation,
)
from linkages.formats.xml_tree import Element
from linkages.mechanisms.joint import FACETS, JointKind, Limits

TINY = 1e-300  # of coordinates that are all 0
WHOLE = JointKind.CYLINDRICAL, JointKind.PLANAR
SINGLE = {facets.mjcf: kind for kind, facets in FACETS.items() if facets.mjcf}


class Axis(NamedTuple):
    """A joint of a body at qpos0: its ``kind``, "hinge", "slide" or "ball", and its
    ``point`` (3,) and ``direction`` (3,) in the world."""

    name: str
    kind: str
    point: np.ndarray
    direction: np.ndarray
    limits: Limits | None


class AxisCoupling(NamedTuple):
    """An axis that is ``ratio`` times the axis called ``to``, plus ``offset``, and the
    ``element`` that says so."""

    to: str
    ratio: float
    offset: float
    element: Element


class WorldJoint(NamedTuple):
    """A joint with the frames (4, 4) of both of its bodies, in the world at qpos0;
    ``axes`` are the names of the axes that its variables are."""

    name: str
    kind: JointKind
    first: np.ndarray
    second: np.ndarray
    limits: tuple[Limits | None, ...]
    locked: tuple[float | None, ...]
    axes: tuple[str, ...]
    pitch: float | None = None
    is_reversed: bool = False  # the first frame is in the body, not in its parent


def joints_of_axes(
    axes: list[Axis],
    couplings: MutableMapping[str, AxisCoupling],
    locks: Mapping[str, float],
) -> list[WorldJoint]:
    """The joints that the ``axes`` of a body make, one after the other.

    A coupling of a slide with a hinge on its axis makes a helical joint, and is taken
    out of ``couplings``.
    """
    kinds = [axis.kind for axis in axes]
    if kinds == ["hinge", "slide"] and _is_one_axis(axes[0], axes[1]):
        return [_turn_and_slide(axes[0], axes[1], couplings, locks)]
    if kinds == ["slide", "hinge"] and _is_one_axis(axes[1], axes[0]):
        return [_turn_and_slide(axes[1], axes[0], couplings, locks)]
    if kinds == ["hinge", "hinge"] and _is_universal(axes):
        frames = [frame_along(axis.point, axis.direction) for axis in axes]
        return [_joint(JointKind.UNIVERSAL, axes, locks, frames)]
    if kinds == ["slide", "slide", "hinge"] and _is_plane(axes):
        return [_plane(axes, locks)]
    if kinds == ["hinge", "slide", "slide"]:
        # each the other way round: its variable keeps its value
        inverse = [one._replace(direction=-one.direction) for one in reversed(axes)]
        if _is_plane(inverse):
            return [_plane(inverse, locks)._replace(is_reversed=True)]
    return [_single(axis, locks) for axis in axes]


def _single(axis: Axis, locks: Mapping[str, float]) -> WorldJoint:
    kind = SINGLE[axis.kind]
    frame = translation(axis.point)
    if kind.facets.moves:
        frame = frame_along(axis.point, axis.direction)
    return _joint(kind, [axis], locks, [frame])


def _unit(vector: np.ndarray) -> np.ndarray:
    unit: np.ndarray = vector / np.linalg.norm(vector)
    return unit


def _is_one_axis(turn: Axis, slide: Axis) -> bool:
    """Whether a slide is along the axis of a turn, in the same direction."""
    first, second = _unit(turn.direction), _unit(slide.direction)
    sine = np.linalg.norm(np.cross(first, second))
    return is_one_joint(float(sine)) and bool(first @ second > 0)


def _is_universal(axes: list[Axis]) -> bool:
    first, second = axes
    points = np.array([first.point, second.point])
    size = float(np.abs(points).max(initial=TINY))
    distance = float(np.linalg.norm(points[1] - points[0]))
    sine = np.linalg.norm(np.cross(_unit(first.direction), _unit(second.direction)))
    is_parallel = is_one_joint(float(sine))
    return is_one_joint(distance, size) and not is_parallel


def _is_plane(axes: list[Axis]) -> bool:
    x, y, normal = (_unit(axis.direction) for axis in axes)
    return is_one_joint(float(np.linalg.norm(np.cross(normal, x) - y)))


def _joint(
    kind: JointKind,
    axes: list[Axis],
    locks: Mapping[str, float],
    frames: Sequence[np.ndarray],
    pitch: float | None = None,
) -> WorldJoint:
    """The joint that has the variables of some axes. It is called as their names begin
    before the last point: "J" of "J.turn" and "J.slide"; else by all of them."""
    names = tuple(axis.name for axis in axes)
    moving = axes if kind.facets.moves else []
    stems = {name.rpartition(".")[0] for name in names}
    is_stem = len(names) > 1 and len(stems) == 1 and stems != {""}
    return WorldJoint(
        stems.pop() if is_stem else "+".join(names),
        kind,
        frames[0],
        frames[-1],
        limits=tuple(axis.limits for axis in moving),
        locked=tuple(locks.get(axis.name) for axis in moving),
        axes=tuple(axis.name for axis in moving),
        pitch=pitch,
    )


def _turn_and_slide(
    turn: Axis,
    slide: Axis,
    couplings: MutableMapping[str, AxisCoupling],
    locks: Mapping[str, float],
) -> WorldJoint:
    frames = [frame_along(turn.point, turn.direction)]
    coupling = couplings.get(slide.name)
    if coupling is None or coupling.to != turn.name or coupling.offset:
        return _joint(JointKind.CYLINDRICAL, [turn, slide], locks, frames)
    del couplings[slide.name]
    pitch = 2 * math.pi * coupling.ratio
    return _joint(JointKind.HELICAL, [turn], locks, frames, pitch)


def _plane(axes: list[Axis], locks: Mapping[str, float]) -> WorldJoint:
    x, _, normal = axes
    frame = frame_along(normal.point, normal.direction, x.direction)
    return _joint(JointKind.PLANAR, axes, locks, [frame])


# --- chains ---------------------------------------------------------------------------


def link_behind(label: str) -> str:
    """What the link behind a variable is called in a chain."""
    return f"{label}.link"


def with_joints_of_chains(
    joints: Sequence[BodyJoint], pose_of: Callable[[str], np.ndarray]
) -> tuple[BodyJoint, ...]:
    """The ``joints`` with every chain as the joint that it stands for; ``pose_of`` gives
    the pose (4, 4) of a link. No joint has the links between any more."""
    by_name = {joint.name: joint for joint in joints}
    uses = Counter(body for joint in joints for body in joint.bodies)
    result: dict[str, BodyJoint | None] = dict(by_name)
    for kind in WHOLE:
        first, *_ = kind.facets.parts
        for start in joints:
            stem = start.name.removesuffix(f".{first}")
            names = [f"{stem}.{part}" for part in kind.facets.parts]
            links = [link_behind(name) for name in names[:-1]]
            is_chain = stem not in by_name and all(name in by_name for name in names)
            if not is_chain or any(uses[link] != 2 for link in links):
                continue
            chain = [by_name[name] for name in names]
            whole = _joined(stem, kind, chain, links, pose_of)
            if whole is not None:
                result |= {**dict.fromkeys(names), names[0]: whole}
    return tuple(joint for joint in result.values() if joint is not None)


def _joined(
    name: str,
    kind: JointKind,
    chain: Sequence[BodyJoint],
    links: Sequence[str],
    pose_of: Callable[[str], np.ndarray],
) -> BodyJoint | None:
    """The joint of this kind that a chain across ``links`` makes; None where it makes
    none."""
    base = next((one for one in chain[0].bodies if one != links[0]), "")
    moved = next((one for one in chain[-1].bodies if one != links[-1]), "")
    axes = []
    for joint, pair in zip(chain, pairwise([base, *links, moved]), strict=True):
        word = joint.kind.facets.mjcf
        if set(joint.bodies) != {*pair} or not (word and joint.kind.facets.moves):
            return None
        frame = pose_of(joint.bodies[0]) @ joint.frames[0]
        # the world, which is no child in SDF, may be the body that moves
        sign = 1.0 if joint.bodies == pair else -1.0
        (limits,) = joint.limits
        axes.append(Axis(joint.name, word, frame[:3, 3], sign * frame[:3, 2], limits))
    wholes = joints_of_axes(axes, {}, {})
    if len(wholes) > 1 or wholes[0].kind is not kind or wholes[0].is_reversed:
        return None
    (whole,) = wholes
    poses = pose_of(base), pose_of(moved)
    frames = in_bodies(poses, (whole.first, whole.second))
    coupled = {label: to for joint in chain for label, to in joint.coupled.items()}
    bodies = base, moved
    return BodyJoint(name, kind, bodies, frames, limits=whole.limits, coupled=coupled)
