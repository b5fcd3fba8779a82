"""Mechanisms in world files of the CUIK suite (Porta, Ros, Thomas and Torras 2014).

A world gives links and, for every joint, points in the frames of the two links that it
joins: no configuration. Angles are in rad. Obstacles, collisions and dynamics are left
out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
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
    frame_of,
    read_end,
    read_links,
    read_point,
    read_transforms,
    rotation,
    skip_appearance,
    skip_dynamics,
)
from linkages.formats.cuik_tokens import Cursor, tokens_of
from linkages.mechanisms.joint import JointKind, Limits, Vector
from linkages.values import GeometryError, quoted

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
    if not world.joints:
        raise GeometryError("[JOINTS]", "missing", "a section with joints")
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
        case "OBSTACLES" | "COLLISIONS":
            _skip_section(cursor)
        case "EQUATIONS":
            world.notes.append("left out: equations besides those of the joints")
            _skip_section(cursor)
        case "INCLUDE":
            allowed = "no part of a world that is read; put all links in one file"
            raise GeometryError(f"line {section.line}", "[INCLUDE]", allowed)
        case _:
            allowed = "[CONSTANTS], [LINKS], [JOINTS], [OBSTACLES] or [COLLISIONS]"
            raise GeometryError(f"line {section.line}", f"[{section.text}]", allowed)


def _skip_section(cursor: Cursor) -> None:
    while not cursor.is_at_section:
        cursor.next()


def _read_constants(cursor: Cursor) -> None:
    while not cursor.is_at_section:
        if cursor.is_word("print") and cursor.ahead(1) != ":=":
            cursor.next()
            cursor.name("the name of a constant")
            continue
        line = cursor.token.line
        name = cursor.name("the name of a constant")
        if name in cursor.constants:
            raise GeometryError(f"line {line}", quoted(name), "given once")
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
    if word in NOT_TAKEN:
        allowed = "a joint of a mechanism of rigid bodies"
        value = f"{word}, {NOT_TAKEN[word]},"
        raise GeometryError(f"joint on line {line}", value, allowed)
    if word not in _READERS:
        allowed = f"one of {', '.join(_READERS)}"
        raise GeometryError(f"joint on line {line}", quoted(word), allowed)
    name = f"J{len(world.joints) + 1}"
    if word in NAMED and cursor.token.text != ":":
        name = cursor.name("the name of a joint")
    cursor.expect(":")
    _READERS[word](cursor, world, name)


def _read_link(cursor: Cursor, world: _World) -> Link:
    line = cursor.token.line
    name = cursor.name("the name of a link")
    if name not in world.links:
        allowed = f"one of the links {', '.join(world.links)}"
        raise GeometryError(f"line {line}", quoted(name), allowed)
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


def _read_two_sides(cursor: Cursor, world: _World, has_axis: bool) -> list[_Side]:
    return [_read_side(cursor, world, has_axis) for _ in range(2)]


def _bodies(sides: list[_Side]) -> tuple[str, str]:
    return sides[0].link.name, sides[1].link.name


def _axis_frames(sides: list[_Side], name: str) -> tuple[np.ndarray, np.ndarray]:
    what = f"joint {name}"
    first, second = (frame_of(s.points[0], s.points[1], what) for s in sides)
    return first, second


def _read_revolute(cursor: Cursor, world: _World, name: str) -> None:
    """The angle is 0 where the vectors from the second points of the axis to the
    reference points coincide."""
    sides = _read_two_sides(cursor, world, has_axis=True)
    frames = _axis_frames(sides, name)
    limits: tuple[Limits | None, ...] = ()
    has_range = cursor.take("range")
    if has_range:
        limits = (_read_range(cursor, name),)
    if has_range or cursor.take("reference"):
        if cursor.token.text in ("(", "+"):
            frames = _referred(cursor, sides, name)
        else:
            world.notes.append(f"left out: the range of joint {name}, without a zero")
            limits = ()
    _skip_options(cursor)
    world.joints.append(_turn(name, _bodies(sides), frames, limits))


def _turn(
    name: str,
    bodies: tuple[str, str],
    frames: tuple[np.ndarray, np.ndarray],
    limits: tuple[Limits | None, ...],
) -> BodyJoint:
    """A turn within ``limits``, or without; a rigid joint where there is a single
    value."""
    pair = limits[0] if limits else None
    if pair is None or pair[0] < pair[1]:
        is_whole = pair is not None and pair[1] - pair[0] >= FULL_TURN
        given = () if is_whole else limits
        return BodyJoint(name, JointKind.REVOLUTE, bodies, frames, limits=given)
    first = frames[0] @ rotation((0.0, 0.0, 1.0), pair[0])
    return BodyJoint(name, JointKind.RIGID, bodies, (first, frames[1]))


def _referred(
    cursor: Cursor, sides: list[_Side], name: str
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
        if is_along or length == 0.0:
            allowed = "a point that is not on the axis"
            raise GeometryError(f"reference of joint {name}", "on its axis", allowed)
        frames.append(frame_along(start, along, across))
    return frames[0], frames[1]


def _read_range(cursor: Cursor, name: str) -> Limits:
    line = cursor.token.line
    low, high = cursor.row("[]", 2)
    if not low <= high:
        allowed = "a smaller number and a larger one"
        raise GeometryError(
            f"range of joint {name} on line {line}", [low, high], allowed
        )
    return (low, high)


def _read_prismatic(cursor: Cursor, world: _World, name: str) -> None:
    """Both links have the same orientation; the slide is from the first point of one to
    that of the other."""
    sides = _read_two_sides(cursor, world, has_axis=True)
    first, second = _axis_frames(sides, name)
    second[:3, :3] = first[:3, :3]
    cursor.expect("range")
    limits = _read_range(cursor, name)
    _skip_options(cursor)
    bodies = _bodies(sides)
    world.joints.append(_slide(name, bodies, (first, second), limits))


def _slide(
    name: str,
    bodies: tuple[str, str],
    frames: tuple[np.ndarray, np.ndarray],
    limits: Limits,
) -> BodyJoint:
    """A slide within ``limits``; a rigid joint where there is a single value."""
    if limits[0] < limits[1]:
        return BodyJoint(name, JointKind.PRISMATIC, bodies, frames, limits=(limits,))
    first = frames[0] @ translation((0.0, 0.0, limits[0]))
    return BodyJoint(name, JointKind.RIGID, bodies, (first, frames[1]))


def _read_spherical(cursor: Cursor, world: _World, name: str) -> None:
    sides = _read_two_sides(cursor, world, has_axis=False)
    if cursor.take("range"):
        world.notes.append(f"left out: the range of the spherical joint {name}")
        cursor.row("[]", 1)
        while cursor.token.text in ("(", "+"):
            read_end(cursor, (0.0, 0.0, 0.0))
    _skip_options(cursor)
    first, second = (translation(side.points[0]) for side in sides)
    joint = BodyJoint(name, JointKind.SPHERICAL, _bodies(sides), (first, second))
    world.joints.append(joint)


def _read_universal(cursor: Cursor, world: _World, name: str) -> None:
    """The axes are at right angles."""
    sides = _read_two_sides(cursor, world, has_axis=True)
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
    world.joints.append(BodyJoint(name, JointKind.UNIVERSAL, _bodies(sides), frames))


def _read_fix(cursor: Cursor, world: _World, name: str) -> None:
    """The transform is the pose of the second link in the first one."""
    first, second = _read_link(cursor, world), _read_link(cursor, world)
    frames = read_transforms(cursor), np.eye(4)
    bodies = first.name, second.name
    world.joints.append(BodyJoint(name, JointKind.RIGID, bodies, frames))


def _read_rod(cursor: Cursor, world: _World, name: str) -> None:
    """A body between two spherical joints, with a length."""
    sides = _read_two_sides(cursor, world, has_axis=False)
    line = cursor.token.line
    cursor.expect("length")
    length = cursor.number()
    if not length > 0:
        raise GeometryError(f"length of {name} on line {line}", length, "positive")
    _skip_options(cursor)
    world.extra_bodies.append(name)
    ends = translation((0.0, 0.0, 0.0)), translation((length, 0.0, 0.0))
    _add_ends(world, name, sides, (name, name), ends)


def _read_leg(cursor: Cursor, world: _World, name: str) -> None:
    """Two bodies with a slide between two spherical joints; the slide is their
    distance."""
    sides = _read_two_sides(cursor, world, has_axis=False)
    line = cursor.token.line
    cursor.expect("range")
    limits = _read_range(cursor, name)
    if not limits[0] >= 0 or not limits[1] > 0:
        allowed = "lengths, which are positive"
        raise GeometryError(f"range of {name} on line {line}", list(limits), allowed)
    _skip_options(cursor)
    bodies = f"{name}.1", f"{name}.2"
    world.extra_bodies += bodies
    frames = np.eye(4), np.eye(4)
    world.joints.append(_slide(name, bodies, frames, limits))
    _add_ends(world, name, sides, bodies, frames)


def _add_ends(
    world: _World,
    name: str,
    sides: list[_Side],
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
    while not cursor.is_at_section and not _is_at_joint(cursor):
        if cursor.is_word("avoid"):
            cursor.next()
            cursor.expect("limits")
            if cursor.token.kind == "number":
                cursor.number()
        elif cursor.is_word(*NUMBERS):
            cursor.next()
            cursor.number()
        elif not skip_appearance(cursor) and not skip_dynamics(cursor):
            cursor.refuse("an option of a joint, or the next joint")


def _is_at_joint(cursor: Cursor) -> bool:
    return ":" in (cursor.ahead(1), cursor.ahead(2)) and cursor.token.kind == "word"


_READERS: dict[str, Callable[[Cursor, _World, str], None]] = {
    "revolute": _read_revolute,
    "prismatic": _read_prismatic,
    "spherical": _read_spherical,
    "universal": _read_universal,
    "fix": _read_fix,
    "sph_sph": _read_rod,
    "sph_prs_sph": _read_leg,
}
