"""Robots in URDF (wiki.ros.org/urdf/XML), with a YAML file beside that closes their loops.

A URDF is a tree of links. The files of example-parallel-robots (Gepetto, LAAS-CNRS) name
pairs of frames that come together, ``closed_loop``, as a whole or in a point, ``type``
"6d" or "3d", the joints that motors drive, ``name_mot``, and joints of another kind than
the URDF has words for, ``joint_name`` with ``joint_type``. A frame is called after a joint,
where it is that of the child, or after a link.

An SRDF has a ``loop_constraint`` for each pair, as example-robot-data (Gepetto, LAAS-CNRS)
writes them: ``frame1``, ``frame2``, and which of x, y, z, roll, pitch and yaw come together,
all of them without a ``mask``.

Without such a file, frames that onshape-to-robot writes close loops, as PlaCo has them:
the origins of ``closing_NAME_1`` and ``closing_NAME_2`` come together, and their third axes
where there are ``closing_NAME_1_z`` and ``closing_NAME_2_z``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations
from typing import Any

import numpy as np

from linkages.formats.assembly import (
    Assembly,
    BodyJoint,
    frame_along,
    listed,
    without_joints,
)
from linkages.formats.xml_tree import Element
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import JointKind, Limits
from linkages.values import GeometryError, checked_list, checked_table, quoted, require

KINDS = {
    "revolute": JointKind.REVOLUTE,
    "continuous": JointKind.REVOLUTE,
    "prismatic": JointKind.PRISMATIC,
    "planar": JointKind.PLANAR,
    "fixed": JointKind.RIGID,
}
FLOATING = "floating"
LIMITED = "revolute", "prismatic"
CLOSURES = {"6d": JointKind.RIGID, "3d": JointKind.SPHERICAL}
OTHER_KINDS = {"SPHERICAL": JointKind.SPHERICAL, "FIXED": JointKind.RIGID}
# the axes of a frame about which a universal joint turns one after the other
UNIVERSAL = {
    f"UJOINT_{'XYZ'[first]}{'XYZ'[second]}": (first, second)
    for first, second in permutations(range(3), 2)
}
# what a mask of an SRDF holds, along and about each axis of the frame
ALONG, ABOUT = ("x", "y", "z"), ("roll", "pitch", "yaw")
BESIDE = "robot.yaml"  # the file with closures, where none is called as the robot is
CLOSING = "closing_"  # how frames are called that onshape-to-robot closes loops with
ALONG_X = (1.0, 0.0, 0.0)  # the axis of a joint that says nothing of it


@dataclass
class _Robot:
    """What was read of a robot: its ``links`` in order, the ``joints``, the link that a
    joint's frame is of, by its name, and ``notes`` on what was left out."""

    links: list[str]
    joints: list[BodyJoint] = field(default_factory=list)
    child_of: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def read_urdf(root: Element, name: str, closures: object = None) -> Assembly:
    """The assembly that <robot> describes, at the zeros of all joints; ``closures`` are
    the content of a YAML file with its loops. Raises `GeometryError`."""
    links = [_name(link) for link in root.all("link")]
    robot = _Robot(links)
    for element in root.all("joint"):
        _add_joint(element, robot)
    poses = _poses(robot)
    content = checked_table("closures", closures or {}, "a table")
    _change_kinds(content, robot)
    for body, link in _close(content, robot).items():
        poses[body] = poses[link]
    if closures is None:
        _close_named(robot)
    motors = _motors(content, robot)
    used = {body for joint in robot.joints for body in joint.bodies}
    lone = [link for link in links if link not in used]
    if lone:
        robot.notes.append(without_joints(lone))
    bodies = tuple(link for link in poses if link in used)
    return Assembly(
        root.attributes.get("name") or name,
        bodies,
        tuple(robot.joints),
        {body: poses[body] for body in bodies},
        tuple(robot.notes),
        motors=motors,
    )


def closures_of_srdf(root: Element) -> dict[str, Any] | None:
    """The closures that an SRDF names, as a YAML file has them; None where there is no
    <loop_constraint>. Raises `GeometryError`."""
    pairs, types = [], []
    for element in root.all("loop_constraint"):
        ends = [element.attributes.get(key) for key in ("frame1", "frame2")]
        allowed = "given with frame1 and frame2"
        element.require(None not in ends, "frame", quoted(ends), allowed)
        pairs.append(ends)
        mask = element.attributes.get("mask", "").split()
        allowed = f"of {', '.join((*ALONG, *ABOUT))}"
        is_known = set(mask) <= {*ALONG, *ABOUT}
        element.require(is_known, "mask", quoted(" ".join(mask)), allowed)
        types.append(mask or "6d")
    return {"closed_loop": pairs, "type": types} if pairs else None


# --- the tree -------------------------------------------------------------------------


def _name(element: Element) -> str:
    name = element.attributes.get("name")
    if not name:
        element.refuse("name", "missing", "a name")
    return name


def _add_joint(element: Element, robot: _Robot) -> None:
    """Enter a joint with its frames in both links."""
    name = _name(element)
    word = element.attributes.get("type", "")
    known = ", ".join((*KINDS, FLOATING))
    is_known = word in KINDS or word == FLOATING
    element.require(is_known, "type", quoted(word), f"one of {known}")
    element.check_new(name, robot.child_of)
    parent, child = (_link(element, tag, robot) for tag in ("parent", "child"))
    robot.child_of[name] = child
    if word == FLOATING:
        robot.notes.append(f"left out, as the base is free: joint {name}")
        return
    # both frames of a joint have the axis as their third one, and coincide at 0
    kind = KINDS[word]
    axis = ALONG_X if kind is JointKind.RIGID else _axis(element)
    turned = frame_along((0.0, 0.0, 0.0), axis)
    frames = (_origin(element) @ turned, turned)
    limits: tuple[Limits | None, ...] = ()
    if word in LIMITED:
        limits = (_limits(element),)
    joint = BodyJoint(name, kind, (parent, child), frames, limits=limits)
    robot.joints.append(replace(joint, coupled=_mimic(element, name)))


def _link(joint: Element, tag: str, robot: _Robot) -> str:
    end = joint.first(tag)
    if end is None:
        joint.refuse(f"<{tag}>", "missing", "a link")
    return end.reference("link", robot.links, f"one of the links {listed(robot.links)}")


def _origin(element: Element) -> np.ndarray:
    """The transform (4, 4) of <origin>: turns about the fixed axes x, y, z."""
    from scipy.spatial.transform import Rotation

    result = np.eye(4)
    origin = element.first("origin")
    if origin is None:
        return result
    turns = origin.numbers("rpy", (3,)) or [0.0, 0.0, 0.0]
    result[:3, :3] = Rotation.from_euler("xyz", turns).as_matrix()
    result[:3, 3] = origin.numbers("xyz", (3,)) or [0.0, 0.0, 0.0]
    return result


def _axis(element: Element) -> Sequence[float]:
    axis = element.first("axis")
    direction = (axis and axis.numbers("xyz", (3,))) or ALONG_X
    allowed = "an axis other than 0"
    element.require(any(direction), "<axis>", "0 0 0", allowed)
    return direction


def _limits(element: Element) -> Limits | None:
    """The ends of <limit>; None where it has none, or no room between them."""
    limit = element.first("limit")
    if limit is None:
        return None
    ends = [limit.numbers(key, (1,)) for key in ("lower", "upper")]
    low, high = (0.0 if end is None else float(end[0]) for end in ends)
    return (low, high) if low < high else None


def _mimic(element: Element, name: str) -> dict[str, Coupling]:
    mimic = element.first("mimic")
    if mimic is None:
        return {}
    leader = mimic.attributes.get("joint")
    if not leader:
        mimic.refuse("joint", "missing", "the name of a joint")
    ratio = (mimic.numbers("multiplier", (1,)) or [1.0])[0]
    offset = (mimic.numbers("offset", (1,)) or [0.0])[0]
    return {name: Coupling(leader, float(ratio), float(offset))}


def _poses(robot: _Robot) -> dict[str, np.ndarray]:
    """The poses (4, 4) of the links where all joints are at 0, those of a link that is
    nobody's child first."""
    children = {joint.bodies[1] for joint in robot.joints}
    poses = {link: np.eye(4) for link in robot.links if link not in children}
    waiting = list(robot.joints)
    while waiting:
        ready = [joint for joint in waiting if joint.bodies[0] in poses]
        if not ready:
            value = f"joints {listed([joint.name for joint in waiting])} in a circle"
            raise GeometryError("<robot>", value, "a tree of links")
        for joint in ready:
            parent, child = joint.bodies
            is_new = child not in poses
            value = f"the child of two joints, one of them {joint.name}"
            require(is_new, f"link {child}", value, "the child of one joint")
            first, second = joint.frames
            poses[child] = poses[parent] @ first @ np.linalg.inv(second)
            waiting.remove(joint)
    return poses


# --- what a YAML file says ------------------------------------------------------------


def _change_kinds(content: Mapping[str, Any], robot: _Robot) -> None:
    """Give joints the kinds that the file names."""
    names = checked_list(
        "joint_name", content.get("joint_name", []), "a list of joints"
    )
    kinds = checked_list("joint_type", content.get("joint_type", []), "a list of types")
    allowed = f"{len(names)}, one a joint"
    is_whole = len(kinds) == len(names)
    require(is_whole, "number of joint_type", len(kinds), allowed)
    numbers = {joint.name: k for k, joint in enumerate(robot.joints)}
    for name, word in zip(names, kinds, strict=True):
        allowed = f"one of {', '.join((*OTHER_KINDS, *UNIVERSAL))}"
        is_known = word in OTHER_KINDS or word in UNIVERSAL
        require(is_known, f"joint_type of {name}", quoted(word), allowed)
        if name not in numbers:
            robot.notes.append(f"left out: joint_type of {name}, which is no joint")
            continue
        joint = replace(robot.joints[numbers[name]], limits=(), coupled={})
        joint = (
            _universal(joint, UNIVERSAL[word])
            if word in UNIVERSAL
            else replace(joint, kind=OTHER_KINDS[word])
        )
        robot.joints[numbers[name]] = joint


def _universal(joint: BodyJoint, axes: tuple[int, int]) -> BodyJoint:
    """The joint that turns about two axes of its frame, by number, first one that is
    fixed in the parent."""
    place = joint.frames[0] @ np.linalg.inv(joint.frames[1])
    first, second = (frame_along((0.0, 0.0, 0.0), np.eye(3)[k]) for k in axes)
    return replace(joint, kind=JointKind.UNIVERSAL, frames=(place @ first, second))


def _close(content: Mapping[str, Any], robot: _Robot) -> dict[str, str]:
    """Add a joint for every pair of frames that come together, or a slide and a joint
    with a body between them; such bodies, with the link whose pose they have."""
    sliders = {}
    pairs = checked_list(
        "closed_loop", content.get("closed_loop", []), "pairs of frames"
    )
    words = checked_list("type", content.get("type", []), "a list of 3d and 6d")
    allowed = f"{len(pairs)}, one a closed loop"
    require(len(words) == len(pairs), "number of type", len(words), allowed)
    for number, (pair, word) in enumerate(zip(pairs, words, strict=True)):
        what = f"closed_loop[{number}]"
        checked_list(what, pair, "two frames", (2,))
        first, second = (_link_of(what, frame, robot) for frame in pair)
        name = "=".join(pair)
        turning, slide = _closing(f"type[{number}]", word, name)
        if slide is not None:
            slider = f"{name}.slider"
            sliders[slider] = first
            robot.joints.append(replace(slide, bodies=(first, slider)))
            first = slider
        robot.joints.append(replace(turning, bodies=(first, second)))
    return sliders


def _closing(what: str, word: object, name: str) -> tuple[BodyJoint, BodyJoint | None]:
    """The joint that a type or a mask names, of bodies to be said, and a slide before it,
    if there is one."""
    if isinstance(word, list):
        return _turning(what, word, name), _slide(what, word, name)
    kind = CLOSURES.get(str(word).lower())
    if kind is None:
        raise GeometryError(what, quoted(word), "3d or 6d")
    return _plain(name, kind), None


def _plain(name: str, kind: JointKind) -> BodyJoint:
    """A joint whose frames are those of its bodies, which are not said yet."""
    return BodyJoint(name, kind, ("", ""), (np.eye(4), np.eye(4)))


def _turning(what: str, mask: Sequence[str], name: str) -> BodyJoint:
    """The joint, of bodies to be said, that turns about the axes that are not in a mask:
    all, one, or none. Where bodies are held in a plane, along two axes and about the
    third, they do not tilt out of it."""
    free = [k for k, word in enumerate(ABOUT) if word not in mask]
    is_in_plane = len(free) == 2 and not {ALONG[k] for k in free}.difference(mask)
    allowed = "a mask with all, two or none of roll, pitch and yaw, or x z pitch"
    require(len(free) != 2 or is_in_plane, what, quoted(" ".join(mask)), allowed)
    if len(free) == 1:
        frame = frame_along((0.0, 0.0, 0.0), np.eye(3)[free[0]])
        return BodyJoint(name, JointKind.REVOLUTE, ("", ""), (frame, frame))
    return _plain(name, JointKind.SPHERICAL if len(free) == 3 else JointKind.RIGID)


def _slide(what: str, mask: Sequence[str], name: str) -> BodyJoint | None:
    """The slide, of bodies to be said, along the axis that is not in a mask; None where
    all are."""
    axes = [k for k, word in enumerate(ALONG) if word not in mask]
    allowed = "a mask with two of x, y and z at least"
    require(len(axes) < 2, what, quoted(" ".join(mask)), allowed)
    if not axes:
        return None
    frame = frame_along((0.0, 0.0, 0.0), np.eye(3)[axes[0]])
    return replace(_plain(f"{name}.slide", JointKind.PRISMATIC), frames=(frame, frame))


def _link_of(what: str, frame: object, robot: _Robot) -> str:
    """The link whose frame is called so, after itself or after the joint that it is the
    child of."""
    if frame in robot.child_of:
        return robot.child_of[str(frame)]
    is_link = frame in robot.links
    require(is_link, what, quoted(frame), "two joints or links of the robot")
    return str(frame)


def _motors(content: Mapping[str, Any], robot: _Robot) -> tuple[str, ...]:
    """The variables that motors drive; names of no joint are said."""
    names = checked_list("name_mot", content.get("name_mot", []), "a list of joints")
    labels = {label for joint in robot.joints for label in joint.labels}
    unknown = [str(name) for name in names if name not in labels]
    if unknown:
        note = f"left out: motors of {listed(unknown)}, which are no joints that move"
        robot.notes.append(note)
    return tuple(name for name in names if name in labels)


# --- what names say -------------------------------------------------------------------


def _close_named(robot: _Robot) -> None:
    """Add a joint for every pair of frames whose names say that they come together."""
    links = set(robot.links)
    closed = []
    for first in robot.links:
        stem = first.removesuffix("_1")
        if stem == first or not stem.startswith(CLOSING):
            continue
        second = f"{stem}_2"
        if second not in links:
            robot.notes.append(f"left out: frame {first}, as there is no {second}")
            continue
        is_hinge = {f"{first}_z", f"{second}_z"} <= links
        kind = JointKind.REVOLUTE if is_hinge else JointKind.SPHERICAL
        frames = (np.eye(4), np.eye(4))
        robot.joints.append(BodyJoint(stem, kind, (first, second), frames))
        closed.append(f"{stem} ({'an axis' if is_hinge else 'a point'})")
    note = f"loops closed by the names of frames, which share: {listed(closed)}"
    if not closed:
        note = (
            "no loop is closed, as a URDF is a tree; name frames that come together in "
            f"{BESIDE} beside it, or with --closures FILE, as closed_loop: "
            "[[frame, frame]], type: [6d], or 3d for a point"
        )
    robot.notes.append(note)
