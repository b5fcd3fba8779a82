"""Mechanisms in world files of the CUIK suite (Porta, Ros, Thomas and Torras 2014).

A world gives links and, for every joint, points in the frames of the two links that it
joins: no configuration. Angles are in rad. Obstacles, collisions and dynamics are left
out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from linkages.decisions import is_one_direction
from linkages.formats.assembly import (
    Assembly,
    BodyJoint,
    frame_along,
    translation,
    without_joints,
)
from linkages.formats.cuik_links import (
    Link,
    read_end,
    read_links,
    read_point,
    read_transforms,
    rotation,
    skip_details,
)
from linkages.formats.cuik_tokens import Cursor, tokens_of
from linkages.mechanisms.joint import JointKind, Limits, Vector
from linkages.values import GeometryError, quoted, require

NAMED = ("sph_sph", "sph_prs_sph")
NOT_TAKEN = {
    "crevolute": "a revolute joint coupled to another one",
    "in_patch": "a point on a curved patch",
    "spring": "a spring",
    "xyspring": "a spring in a plane",
    "c_cable": "a cable",
    "c_spring": "a spring",
    "c_leg": "a strut of a tensegrity",
}
FULL_TURN = 6.283  # a range so wide is none
NUMBERS = (
    *("velocity", "acceleration", "torque", "force", "effort", "cost", "friction"),
    *("damping", "radius", "length", "granularity", "mass"),
)


@dataclass
class _World:
    """What was read so far."""

    folder: Path
    links: dict[str, Link] = field(default_factory=dict)
    extra_bodies: list[str] = field(default_factory=list)
    joints: list[BodyJoint] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read_world(text: str, name: str, folder: Path) -> Assembly:
    """The assembly that the ``text`` of a world describes; bodies in files of their own
    are looked for in ``folder``. Raises `GeometryError` with the line."""
    cursor = Cursor(tokens_of(text))
    world = _World(folder)
    while cursor.token.kind != "end":
        _read_section(cursor, world)
    require(bool(world.joints), "[JOINTS]", "missing", "a section with joints")
    bodies = (*world.links, *world.extra_bodies)
    joined = {body for joint in world.joints for body in joint.bodies}
    loose = [body for body in bodies if body not in joined]
    if loose:
        world.notes.append(without_joints(loose))
    notes = tuple(dict.fromkeys(world.notes))
    return Assembly(name, bodies, tuple(world.joints), notes=notes)


def _read_section(cursor: Cursor, world: _World) -> None:
    if cursor.token.kind != "section":
        cursor.refuse("a section such as [LINKS]")
    section = cursor.next()
    match section.text:
        case "CONSTANTS":
            _read_constants(cursor)
        case "LINKS":
            read_links(cursor, world.folder, world.links)
        case "JOINTS":
            while not cursor.is_at_section:
                _read_joint(cursor, world)
        case "OBSTACLES" | "COLLISIONS" | "EQUATIONS":
            if section.text == "EQUATIONS":
                world.notes.append("left out: equations besides those of the joints")
            while not cursor.is_at_section:
                cursor.next()
        case "INCLUDE":
            allowed = "no part of a world that is read; put all links in one file"
            raise GeometryError(f"line {section.line}", "[INCLUDE]", allowed)
        case _:
            allowed = "[CONSTANTS], [LINKS], [JOINTS], [OBSTACLES] or [COLLISIONS]"
            raise GeometryError(f"line {section.line}", f"[{section.text}]", allowed)


def _read_constants(cursor: Cursor) -> None:
    while not cursor.is_at_section:
        if cursor.is_word("print") and cursor.ahead(1) != ":=":
            cursor.next()
            cursor.name("the name of a constant")
            continue
        line = cursor.token.line
        name = cursor.name("the name of a constant")
        is_new = name not in cursor.constants
        require(is_new, f"line {line}", quoted(name), "given once")
        cursor.expect(":=")
        cursor.constants[name] = cursor.number()


# --- joints ---------------------------------------------------------------------------


@dataclass
class _Side:
    """A link of a joint and the points (3,) that the joint has in it."""

    link: Link
    points: list[Vector]


def _read_joint(cursor: Cursor, world: _World) -> None:
    line = cursor.token.line
    word = cursor.name("a joint").lower()
    what = f"joint on line {line}"
    allowed = "a joint of a mechanism of rigid bodies"
    value = f"{word}, {NOT_TAKEN.get(word)},"
    require(word not in NOT_TAKEN, what, value, allowed)
    require(word in _READERS, what, quoted(word), f"one of {', '.join(_READERS)}")
    name = f"J{len(world.joints) + 1}"
    if word in NAMED and cursor.token.text != ":":
        name = cursor.name("the name of a joint")
    cursor.expect(":")
    _READERS[word](cursor, world, name)


def _read_link(cursor: Cursor, world: _World) -> Link:
    line = cursor.token.line
    name = cursor.name("the name of a link")
    allowed = f"one of the links {', '.join(world.links)}"
    require(name in world.links, f"line {line}", quoted(name), allowed)
    return world.links[name]


def _read_side(cursor: Cursor, world: _World, has_axis: bool) -> _Side:
    """A link and the point of the joint in it, or two points of its axis."""
    link = _read_link(cursor, world)
    points = [_point_of(cursor, link)]
    if has_axis:
        if cursor.token.kind == "number":
            points.append(_point_of(cursor, link))
        else:
            points.append(read_end(cursor, points[0]))
    return _Side(link, points)


def _point_of(cursor: Cursor, link: Link) -> Vector:
    """A point, or the number of a point of the link: "2", or "1:2" with its shape."""
    if cursor.token.kind != "number":
        return read_point(cursor)
    what = f"{link.name} on line {cursor.token.line}"
    shape, number = 0, _whole(cursor)
    if cursor.take(":"):
        shape, number = number, _whole(cursor)
    return link.point(shape, number, what)


def _whole(cursor: Cursor) -> int:
    if not cursor.token.text.isdigit():
        cursor.refuse("the number of a point")
    return int(cursor.next().text)


def _read_sides(
    cursor: Cursor, world: _World, has_axis: bool
) -> tuple[tuple[_Side, _Side], tuple[str, str]]:
    """Both sides of a joint, and the names of their links."""
    first, second = (_read_side(cursor, world, has_axis) for _ in range(2))
    return (first, second), (first.link.name, second.link.name)


def _axis_frames(sides: Iterable[_Side], name: str) -> tuple[np.ndarray, np.ndarray]:
    frames = []
    for side in sides:
        first, second = side.points
        direction = np.subtract(second, first)
        is_axis = bool(np.any(direction))
        value = [first, second]
        require(is_axis, f"axis of joint {name}", value, "two different points")
        frames.append(frame_along(first, direction))
    return frames[0], frames[1]


def _within(joint: BodyJoint, limits: Limits) -> BodyJoint:
    """The joint within ``limits``; a rigid one where they are a single value."""
    if limits[0] < limits[1]:
        return replace(joint, limits=(limits,))
    first, second = joint.frames
    if joint.kind is JointKind.REVOLUTE:
        motion = rotation((0.0, 0.0, 1.0), limits[0])
    else:
        motion = translation((0.0, 0.0, limits[0]))
    frames = first @ motion, second
    return replace(joint, kind=JointKind.RIGID, frames=frames)


def _read_revolute(cursor: Cursor, world: _World, name: str) -> None:
    """The angle is 0 where the vectors from the second points of the axis to the
    reference points coincide."""
    sides, bodies = _read_sides(cursor, world, has_axis=True)
    frames = _axis_frames(sides, name)
    limits = _read_range(cursor, name) if cursor.take("range") else None
    if limits is not None or cursor.take("reference"):
        if cursor.token.text in ("(", "+"):
            frames = _referred(cursor, sides, name)
        else:
            world.notes.append(f"left out: the range of joint {name}, without a zero")
            limits = None
    _skip_options(cursor)
    joint = BodyJoint(name, JointKind.REVOLUTE, bodies, frames)
    if limits is not None and limits[1] - limits[0] < FULL_TURN:
        joint = _within(joint, limits)
    world.joints.append(joint)


def _referred(
    cursor: Cursor, sides: Iterable[_Side], name: str
) -> tuple[np.ndarray, np.ndarray]:
    """The frames of an axis with their first axes towards the points that stand
    here."""
    frames = []
    for side in sides:
        start, end = (np.array(point) for point in side.points)
        reference = np.array(read_end(cursor, side.points[0])) - start
        along = (end - start) / np.linalg.norm(end - start)
        across = reference - (reference @ along) * along
        length = float(np.linalg.norm(reference))
        is_along = is_one_direction(float(np.linalg.norm(across)), length)
        is_beside = not is_along and length != 0.0
        allowed = "a point that is not on the axis"
        require(is_beside, f"reference of joint {name}", "on its axis", allowed)
        frames.append(frame_along(start, along, across))
    return frames[0], frames[1]


def _read_range(cursor: Cursor, name: str) -> Limits:
    line = cursor.token.line
    low, high = cursor.row("[]", 2)
    what = f"range of joint {name} on line {line}"
    require(low <= high, what, [low, high], "a smaller number and a larger one")
    return (low, high)


def _read_prismatic(cursor: Cursor, world: _World, name: str) -> None:
    """Both links have the same orientation; the slide is from the first point of one to
    that of the other."""
    sides, bodies = _read_sides(cursor, world, has_axis=True)
    first, second = _axis_frames(sides, name)
    second[:3, :3] = first[:3, :3]
    cursor.expect("range")
    limits = _read_range(cursor, name)
    _skip_options(cursor)
    joint = BodyJoint(name, JointKind.PRISMATIC, bodies, (first, second))
    world.joints.append(_within(joint, limits))


def _read_spherical(cursor: Cursor, world: _World, name: str) -> None:
    sides, bodies = _read_sides(cursor, world, has_axis=False)
    if cursor.take("range"):
        world.notes.append(f"left out: the range of the spherical joint {name}")
        cursor.row("[]", 1)
        while cursor.token.text in ("(", "+"):
            read_end(cursor, (0.0, 0.0, 0.0))
    _skip_options(cursor)
    first, second = (translation(side.points[0]) for side in sides)
    world.joints.append(BodyJoint(name, JointKind.SPHERICAL, bodies, (first, second)))


def _read_universal(cursor: Cursor, world: _World, name: str) -> None:
    """The axes are at right angles."""
    sides, bodies = _read_sides(cursor, world, has_axis=True)
    if cursor.is_word("range", "reference"):
        world.notes.append(f"left out: the range of the universal joint {name}")
        cursor.next()
    while cursor.token.text in ("[", "(", "+"):
        if cursor.token.text == "[":
            _read_range(cursor, name)
        else:
            read_end(cursor, (0.0, 0.0, 0.0))
    _skip_options(cursor)
    frames = _axis_frames(sides, name)
    world.joints.append(BodyJoint(name, JointKind.UNIVERSAL, bodies, frames))


def _read_fix(cursor: Cursor, world: _World, name: str) -> None:
    """The transform is the pose of the second link in the first one."""
    first, second = _read_link(cursor, world), _read_link(cursor, world)
    frames = read_transforms(cursor), np.eye(4)
    bodies = first.name, second.name
    world.joints.append(BodyJoint(name, JointKind.RIGID, bodies, frames))


def _read_rod(cursor: Cursor, world: _World, name: str) -> None:
    """A body between two spherical joints, with a length."""
    sides, _ = _read_sides(cursor, world, has_axis=False)
    line = cursor.token.line
    cursor.expect("length")
    length = cursor.number()
    require(length > 0, f"length of {name} on line {line}", length, "positive")
    _skip_options(cursor)
    world.extra_bodies.append(name)
    ends = translation((0.0, 0.0, 0.0)), translation((length, 0.0, 0.0))
    _add_ends(world, name, sides, (name, name), ends)


def _read_leg(cursor: Cursor, world: _World, name: str) -> None:
    """Two bodies with a slide between two spherical joints; the slide is their
    distance."""
    sides, _ = _read_sides(cursor, world, has_axis=False)
    line = cursor.token.line
    cursor.expect("range")
    limits = _read_range(cursor, name)
    are_lengths = limits[0] >= 0 and limits[1] > 0
    what = f"range of {name} on line {line}"
    require(are_lengths, what, list(limits), "lengths, which are positive")
    _skip_options(cursor)
    bodies = f"{name}.1", f"{name}.2"
    world.extra_bodies += bodies
    frames = np.eye(4), np.eye(4)
    joint = BodyJoint(name, JointKind.PRISMATIC, bodies, frames)
    world.joints.append(_within(joint, limits))
    _add_ends(world, name, sides, bodies, frames)


def _add_ends(
    world: _World,
    name: str,
    sides: Iterable[_Side],
    bodies: tuple[str, str],
    ends: tuple[np.ndarray, np.ndarray],
) -> None:
    """Add the spherical joints between links and the bodies of a rod or a leg."""
    for number, side in enumerate(sides):
        joint = BodyJoint(
            f"{name}.{side.link.name}.{number + 1}",
            JointKind.SPHERICAL,
            (side.link.name, bodies[number]),
            (translation(side.points[0]), ends[number]),
        )
        world.joints.append(joint)


def _skip_options(cursor: Cursor) -> None:
    """Go on behind what says how a joint looks and what it can bear."""
    while not cursor.is_at_section:
        is_colon_near = ":" in (cursor.ahead(1), cursor.ahead(2))
        if is_colon_near and cursor.token.kind == "word":
            return  # the next joint
        if cursor.is_word("avoid"):
            cursor.next()
            cursor.expect("limits")
            if cursor.token.kind == "number":
                cursor.number()
        elif cursor.is_word(*NUMBERS):
            cursor.next()
            cursor.number()
        elif not skip_details(cursor):
            cursor.refuse("an option of a joint, or the next joint")


_READERS: dict[str, Callable[[Cursor, _World, str], None]] = {
    "revolute": _read_revolute,
    "prismatic": _read_prismatic,
    "spherical": _read_spherical,
    "universal": _read_universal,
    "fix": _read_fix,
    "sph_sph": _read_rod,
    "sph_prs_sph": _read_leg,
}
