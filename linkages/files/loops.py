"""Mechanisms as tables of Denavit and Hartenberg, a table a loop, that share joints.

Every loop is a `Loop` in one closed configuration. The first one stands where it is;
each further one is placed by the joints that it shares with those before it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.closure.system import ClosureSystem
from linkages.decisions import is_parallel_axis, meets_in_one_point
from linkages.files.figures import check_joined_names, joined_name
from linkages.files.misfits import closed_near
from linkages.loop import Loop
from linkages.mechanisms.joint import Joint, JointKind, Motion, transforms
from linkages.mechanisms.mechanism import Mechanism
from linkages.values import (
    SOME,
    GeometryError,
    check_keys,
    checked_list,
    checked_number,
    checked_table,
    quoted,
    require,
)

Table: TypeAlias = Mapping[str, Any]

NUMBERS = ("lengths", "twists", "offsets", "configuration")
KEYS = ("joints", *NUMBERS, "links", "turn", "shift")


class Axis(NamedTuple):
    """A joint axis: a ``point`` (3,) and a unit vector ``direction`` (3,)."""

    point: np.ndarray
    direction: np.ndarray

    def moved(self, pose: np.ndarray) -> Axis:
        """The axis after a displacement (4, 4)."""
        point = pose[:3, :3] @ self.point + pose[:3, 3]
        return Axis(point, pose[:3, :3] @ self.direction)


class _Link(NamedTuple):
    """A link after a joint: its ``name``, and the joints that it is called after; None
    where the file names it."""

    name: str
    ends: tuple[str, str] | None = None


@dataclass(frozen=True, eq=False)
class _Ring:
    """A loop as it was given: what it is called in messages, the names of its joints
    and of the links after them, and the frames (n, 4, 4) of its joints in its
    configuration."""

    what: str
    joints: tuple[str, ...]
    links: tuple[_Link, ...]
    frames: np.ndarray
    size: float
    turn: float
    shift: float

    def axis(self, joint: str) -> Axis:
        """The axis of a joint, by name, in the loop's own frame."""
        frame = self.frames[self.joints.index(joint)]
        return Axis(frame[:3, 3], frame[:3, 2])


def read_loops(tables: object, name: str, unit: float) -> Mechanism:
    """The mechanism of the tables ``[[loops]]`` of a file, angles in a ``unit`` in rad.

    Raises `GeometryError` for what makes no loop, loops that do not close, that share
    nothing with those before, or whose shared joints are at different places.
    """
    given = checked_list("loops", tables, "tables [[loops]]", SOME)
    rings: list[_Ring] = []
    for number, table in enumerate(given, start=1):
        names = [link.name for ring in rings for link in ring.links]
        rings.append(_read_ring(f"loops[{number}]", table, unit, names))
    ends = [link.ends for ring in rings for link in ring.links if link.ends]
    check_joined_names("link", ends)
    return Mechanism(_joints(rings, _placed_axes(rings)), name)


def _joints(rings: Sequence[_Ring], axes: Mapping[str, Axis]) -> tuple[Joint, ...]:
    """A revolute joint for every axis, between all links that meet there."""
    bodies: dict[str, list[str]] = {}
    for ring in rings:
        for number, joint in enumerate(ring.joints):
            both = (ring.links[number - 1].name, ring.links[number].name)
            here = bodies.setdefault(joint, [])
            here += [link for link in both if link not in here]
    joints = []
    for name, names in bodies.items():
        point, direction = (tuple(vector.tolist()) for vector in axes[name])
        kind = JointKind.REVOLUTE
        joints.append(Joint(name, kind, tuple(names), point, direction))
    return tuple(joints)


# --- placing --------------------------------------------------------------------------


def _placed_axes(rings: Sequence[_Ring]) -> dict[str, Axis]:
    """The axes of all joints, by name, in the frame of the first loop."""
    axes: dict[str, Axis] = {}
    normals: dict[str, np.ndarray] = {}
    for ring in rings:
        pose = _pose(ring, axes, normals)
        for number, joint in enumerate(ring.joints):
            axis = ring.axis(joint).moved(pose)
            if joint in axes:
                _check_same(ring, joint, axis, axes[joint])
            else:
                axes[joint] = axis
                normals[joint] = pose[:3, :3] @ _normal(ring, number)
    return axes


def _normal(ring: _Ring, number: int) -> np.ndarray:
    """The unit vector (3,) of the common normal of a joint, from 0, and the next one:
    the first axis of the next frame."""
    following = ring.frames[(number + 1) % len(ring.frames)]
    vector: np.ndarray = following[:3, 0]
    return vector


def _pose(
    ring: _Ring, axes: Mapping[str, Axis], normals: Mapping[str, np.ndarray]
) -> np.ndarray:
    """The displacement (4, 4) that brings a loop to its place."""
    if not axes:
        _check_placed(ring, "the first loop stands where it is")
        return np.eye(4)
    shared = [joint for joint in ring.joints if joint in axes]
    allowed = f"such that one is a joint of a loop before: {', '.join(axes)}"
    is_shared = bool(shared)
    require(is_shared, f"joints of {ring.what}", list(ring.joints), allowed)
    first = shared[0]
    for second in shared[1:]:
        here = _frame_of(ring.axis(first), ring.axis(second))
        there = _frame_of(axes[first], axes[second])
        if here is not None and there is not None:
            _check_placed(ring, f"joints {first} and {second} place the loop")
            return np.asarray(there @ np.linalg.inv(here))
    axis = axes[first]
    # turned about the axis and shifted along it, as the table says
    there = _frame(*axis, normals[first])
    screw = Motion(True, axis.direction, axis.point)
    there = transforms(screw, np.array([ring.turn]))[0] @ there
    there[:3, 3] += ring.shift * axis.direction
    here = _frame(*ring.axis(first), _normal(ring, ring.joints.index(first)))
    pose: np.ndarray = there @ np.linalg.inv(here)
    return pose


def _check_placed(ring: _Ring, reason: str) -> None:
    """Refuse a turn or a shift of a loop that has its place without them."""
    turn = float(np.degrees(ring.turn))
    for key, value, unit in (("turn", turn, " degrees"), ("shift", ring.shift, "")):
        shown = f"{value:.10g}{unit}"
        what = f"{key} of {ring.what}"
        require(value == 0.0, what, shown, f"left out, as {reason}")


def _frame_of(first: Axis, second: Axis) -> np.ndarray | None:
    """The frame (4, 4) on the first axis at its common normal with the second one; of
    parallel axes at the point of the first one. None for axes that coincide."""
    across = np.cross(first.direction, second.direction)
    gap = second.point - first.point
    sine = float(np.linalg.norm(across))
    if not is_parallel_axis(sine):
        along = float(np.cross(gap, second.direction) @ across) / sine**2
        foot = first.point + along * first.direction
        return _frame(foot, first.direction, across / sine)
    normal = gap - (gap @ first.direction) * first.direction
    distance = float(np.linalg.norm(normal))
    if meets_in_one_point(distance, float(np.linalg.norm(gap)) or 1.0):
        return None
    return _frame(first.point, first.direction, normal / distance)


def _frame(origin: np.ndarray, third: np.ndarray, first: np.ndarray) -> np.ndarray:
    """The frame (4, 4) with this origin, third and first axes (3,)."""
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 2] = first, third
    frame[:3, 1] = np.cross(third, first)
    frame[:3, 3] = origin
    return frame


def _check_same(ring: _Ring, joint: str, axis: Axis, placed: Axis) -> None:
    """A joint that loops share has one axis."""
    cosine = float(np.clip(axis.direction @ placed.direction, -1.0, 1.0))
    sine = float(np.linalg.norm(np.cross(axis.direction, placed.direction)))
    gap = np.cross(axis.point - placed.point, placed.direction)
    distance = float(np.linalg.norm(gap))
    is_along = cosine > 0 and is_parallel_axis(sine)
    if is_along and meets_in_one_point(distance, ring.size):
        return
    angle = float(np.degrees(np.arctan2(sine, cosine)))
    value = f"{distance:.6g} and {angle:.6g} degrees beside that of the loops before"
    raise GeometryError(f"axis of joint {joint} in {ring.what}", value, "the same")


# --- one table ------------------------------------------------------------------------


def _read_ring(what: str, table: object, unit: float, known: Sequence[str]) -> _Ring:
    table = checked_table(what, table, "a table")
    check_keys(f"key of {what}", table, KEYS)
    joints = _names(f"joints of {what}", table.get("joints"))
    rows = {key: _row(f"{key} of {what}", table.get(key), joints) for key in NUMBERS}
    loop = Loop(
        tuple(rows["lengths"]),
        tuple(unit * twist for twist in rows["twists"]),
        tuple(rows["offsets"]),
        what,
    )
    given = unit * np.array(rows["configuration"])
    shown = np.degrees(given).round(6).tolist()
    far = f"{shown} degrees, from which a gap of {{:.3g}} is left,; near a closed one"
    where = f"configuration of {what}"
    angles = closed_near(ClosureSystem(loop), where, given, joints, far)
    return _Ring(
        what,
        joints,
        _links(what, table.get("links"), joints, known),
        loop.frames(angles)[:-1],
        loop.characteristic_length,
        unit * checked_number(f"turn of {what}", table.get("turn", 0.0)),
        checked_number(f"shift of {what}", table.get("shift", 0.0)),
    )


def _names(what: str, given: object) -> tuple[str, ...]:
    names = checked_list(what, given, "a list of names")
    for name in names:
        is_name = isinstance(name, str) and name.strip() != ""
        require(is_name, what, quoted(name), "names, texts in quotes")
        require(names.count(name) == 1, what, quoted(name), "given once")
    return tuple(names)


def _row(what: str, given: object, joints: tuple[str, ...]) -> list[float]:
    allowed = f"a list of {len(joints)} numbers, one for each joint"
    if not isinstance(given, list):
        value = "a missing key" if given is None else quoted(given)
        raise GeometryError(what, value, allowed)
    is_whole = len(given) == len(joints)
    require(is_whole, f"number of {what}", len(given), f"{len(joints)}")
    return [checked_number(f"{what}[{k}]", one) for k, one in enumerate(given, start=1)]


def _links(
    what: str, given: object, joints: tuple[str, ...], known: Sequence[str]
) -> tuple[_Link, ...]:
    """The links after every joint, called as given, or by the joints at their ends, the
    same for the same two."""
    if given is not None:
        names = _names(f"links of {what}", given)
        allowed = f"{len(joints)}, one after each joint"
        is_whole = len(names) == len(joints)
        require(is_whole, f"number of links of {what}", len(names), allowed)
        return tuple(_Link(name) for name in names)
    links = []
    for number, joint in enumerate(joints):
        following = joints[(number + 1) % len(joints)]
        is_reverse = joined_name(following, joint) in known
        ends = (following, joint) if is_reverse else (joint, following)
        links.append(_Link(joined_name(*ends), ends))
    return tuple(links)
