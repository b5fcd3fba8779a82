"""Mechanisms in SDFormat 1.5 to 1.11, the files of Gazebo (sdformat.org).

Links are posed in their model, or in what ``relative_to`` names, joints in their child
link. Masses, shapes, sensors and plugins are left out.

An axis with ``<mimic>`` is at multiplier * (leader - reference) + offset. A joint of
type ``gearbox`` joins no links: of two links that revolute joints hold on a third one,
the reference, the child turns by -ratio times what the parent turns by.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_one_direction
from linkages.formats.assembly import (
    Assembly,
    BodyJoint,
    frame_along,
    in_bodies,
    without_joints,
)
from linkages.formats.composites import with_joints_of_chains
from linkages.formats.exact_poses import ExactPose, Origin
from linkages.formats.xml_tree import Element
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import DRAWN_ONLY, FACETS, JointKind, Limits
from linkages.values import quoted

OLDEST, NEWEST = (1, 5), (1, 11)
FRAMES_SINCE = (1, 7)  # relative_to and expressed_in
PITCH_SINCE = (1, 10)  # screw_thread_pitch, in length a turn
GEARBOX = "gearbox"
MIMIC_SINCE = (1, 11)
AXES = ("axis", "axis2")
WORLD, MODEL = "world", "__model__"
UNLIMITED = 1e16  # SDF's word for no limit
KINDS = {word: kind for kind, facets in FACETS.items() for word in facets.sdf}


class _Gearbox(NamedTuple):
    """A gearbox: its ``element``, the link ``reference``, the two ``links`` that turn
    on it, and the directions (3,) in the model about which their angles are counted."""

    element: Element
    reference: str
    links: tuple[str, str]
    directions: tuple[np.ndarray, np.ndarray]


@dataclass
class _Posed:
    """A link, a frame or a joint: its ``element``, and what its pose is relative to
    where the file does not say."""

    element: Element
    relative_to: str


@dataclass
class _Model:
    """A model while it is read: what has a pose, by name, and the poses in the model
    that are known. Places are counted from the ``origin``; ``notes`` say what was left
    out."""

    element: Element
    version: tuple[int, int]
    origin: Origin
    posed: dict[str, _Posed] = field(default_factory=dict)
    poses: dict[str, ExactPose] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def frame(self, body: str) -> np.ndarray:
        """The frame (4, 4) in which the joints of a body are written."""
        return self.origin.frame(_pose(body, self))


def read_sdf(root: Element, name: str) -> Assembly:
    """The assembly that the one model of an SDF file describes; raises
    `GeometryError`."""
    text = root.attributes.get("version", "")
    match = re.fullmatch(r"(\d+)\.(\d+)", text)
    version = (int(match[1]), int(match[2])) if match else (0, 0)
    is_read = OLDEST <= version <= NEWEST
    root.require(is_read, "version", quoted(text), "from 1.5 to 1.11")
    worlds = list(root.all("world"))
    models = [m for parent in (root, *worlds) for m in parent.all("model")]
    jointed = [model for model in models if model.first("joint") is not None]
    names = ", ".join(m.attributes.get("name", "?") for m in jointed) or "none"
    root.require(len(jointed) == 1, "models with joints", names, "one")
    (element,) = jointed
    for inner in (*element.all("model"), *element.all("include")):
        value = f"on line {inner.line}"
        element.refuse(f"<{inner.tag}>", value, "left out; models are not nested")
    model = _Model(element, version, Origin())
    _collect(model)
    rounding = 0.0
    elsewhere = [word for word, kind in KINDS.items() if kind in DRAWN_ONLY]
    poses_of_joints = [
        _pose(joint.attributes["name"], model)
        for joint in element.all("joint")
        if joint.attributes.get("type") not in (*elsewhere, GEARBOX)
    ]
    origin = Origin.near([pose.place for pose in poses_of_joints])
    if origin.place is not None:
        model = _Model(element, version, origin)
        _collect(model)
        rounding = max(pose.rounding for pose in poses_of_joints)
    joints = _read_joints(model)
    links = [link.attributes["name"] for link in model.element.all("link")]
    joined = {body for joint in joints for body in joint.bodies}
    bodies = tuple(body for body in (WORLD, *links) if body in joined)
    # the links inside chains that are one joint have joints in the file
    in_file = {
        _body(joint, tag, model)
        for joint in model.element.all("joint")
        for tag in ("parent", "child")
    }
    loose = [link for link in links if link not in in_file]
    if loose:
        model.notes.append(without_joints(loose))
    return Assembly(
        model.element.attributes.get("name", name),
        bodies,
        joints,
        {body: model.frame(body) for body in bodies},
        origin=model.origin.vector,
        rounding=rounding,
        notes=tuple(model.notes),
    )


def _read_joints(model: _Model) -> tuple[BodyJoint, ...]:
    """All joints, coupled where they follow others."""
    joints: dict[str, BodyJoint] = {}
    gearboxes = []
    for element in model.element.all("joint"):
        if element.attributes.get("type") == GEARBOX:
            gearboxes.append(_read_gearbox(element, model))
        else:
            joints[element.attributes["name"]] = _read_joint(element, model)
    coupled = {name: _mimics(joint, joints, model) for name, joint in joints.items()}
    for gearbox in gearboxes:
        leader, follower, rate = _geared(gearbox, joints, model)
        is_free = not coupled[follower]
        allowed = "a joint that is coupled once"
        gearbox.element.require(is_free, "<child>", f"on joint {follower}", allowed)
        coupled[follower] = {follower: Coupling(leader, rate)}
    followers = [replace(one, coupled=coupled[name]) for name, one in joints.items()]
    return with_joints_of_chains(followers, model.frame)


# --- poses ----------------------------------------------------------------------------


def _collect(model: _Model) -> None:
    """Enter every link, frame and joint of the model by name."""
    for element in model.element.all("link", "frame", "joint"):
        name = element.attributes.get("name")
        if not name:
            element.refuse("name", "missing", "a name")
        element.check_new(name, (*model.posed, WORLD, MODEL))
        relative_to = MODEL
        if element.tag == "joint":
            relative_to = _link_name(element, "child")
        elif element.tag == "frame":
            relative_to = element.attributes.get("attached_to", MODEL) or MODEL
        model.posed[name] = _Posed(element, relative_to)


def _link_name(joint: Element, tag: str) -> str:
    child = joint.first(tag)
    if child is None or not child.text.strip():
        joint.refuse(f"<{tag}>", "missing", "the name of a link")
    return child.text.strip()


def _pose(name: str, model: _Model, path: tuple[str, ...] = ()) -> ExactPose:
    """The pose of a link, a frame or a joint in the model."""
    if name == MODEL:
        return model.origin.pose
    if name == WORLD:
        return model.origin.pose @ _own_pose(model.element)[0].inverse()
    if name in model.poses:
        return model.poses[name]
    posed = model.posed[name]
    element = posed.element
    allowed = "relative to another frame"
    element.require(name not in path, "<pose>", "relative to itself", allowed)
    own, relative_to = _own_pose(element)
    is_allowed = relative_to is None or model.version >= FRAMES_SINCE
    allowed = "left out before version 1.7"
    element.require(is_allowed, "relative_to", quoted(relative_to), allowed)
    base = relative_to or posed.relative_to
    key = "attached_to" if relative_to is None else "relative_to"
    allowed = f"one of the links, joints and frames {', '.join(model.posed)}"
    if relative_to is None and element.tag == "joint":
        key = "<child>"
        allowed = f"world or one of the links {_listed_links(model)}"
    is_known = base in model.posed or base in (MODEL, WORLD)
    element.require(is_known, key, quoted(base), allowed)
    model.poses[name] = _pose(base, model, (*path, name)) @ own
    return model.poses[name]


def _listed_links(model: _Model) -> str:
    return ", ".join(link.attributes["name"] for link in model.element.all("link"))


def _own_pose(element: Element) -> tuple[ExactPose, str | None]:
    """The transform in <pose>, and what it says that it is relative to."""
    from scipy.spatial.transform import Rotation

    child = element.first("pose")
    if child is None:
        return ExactPose(), None
    relative_to = child.attributes.get("relative_to") or None
    text = child.text.strip()
    kind = child.choice("rotation_format", ("euler_rpy", "quat_xyzw"), "euler_rpy")
    if not text:
        return ExactPose(), relative_to
    count = 6 if kind == "euler_rpy" else 7
    numbers = element.parsed_numbers("<pose>", text, (count,))
    rotation = None
    turn = np.array(numbers[3:])
    if kind == "quat_xyzw":
        allowed = "with a quaternion other than 0"
        element.require(bool(np.any(turn)), "<pose>", quoted(text), allowed)
        rotation = Rotation.from_quat(turn).as_matrix()
    elif np.any(turn):
        if child.attributes.get("degrees") in ("true", "1"):
            turn = np.radians(turn)
        rotation = Rotation.from_euler("xyz", turn).as_matrix()
    return ExactPose.at(numbers[:3], rotation), relative_to


# --- joints ---------------------------------------------------------------------------


def _read_joint(element: Element, model: _Model) -> BodyJoint:
    """A joint with its frames in both links."""
    name = element.attributes["name"]
    word = element.attributes.get("type", "")
    allowed = f"one of {', '.join(KINDS)}, {GEARBOX}"
    element.require(word in KINDS, "type", quoted(word), allowed)
    kind = KINDS[word]
    first, second = (_body(element, tag, model) for tag in ("parent", "child"))
    pose = _pose(name, model)
    place = pose.matrix()
    if kind is JointKind.PRISMATIC:
        place[:3, 3] = model.origin.place_of_slide(pose)
    elif kind is JointKind.RIGID:
        place = model.origin.frame(pose)  # any frame of both bodies will do
    one = other = place
    limits: tuple[Limits | None, ...] = ()
    if kind not in (JointKind.SPHERICAL, JointKind.RIGID):
        axis = _axis(element, "axis", pose, model)
        one = other = frame_along(place[:3, 3], axis)
        limits = (_limits(element, "axis", word, model),)
    cosine = 0.0
    if kind is JointKind.UNIVERSAL:
        second_axis = _axis(element, "axis2", pose, model)
        is_along = is_one_direction(float(np.linalg.norm(np.cross(axis, second_axis))))
        element.require(not is_along, "<axis2>", "along <axis>", "another direction")
        other = frame_along(place[:3, 3], second_axis)
        cosine = float(one[:3, 2] @ other[:3, 2])
        limits = (*limits, _limits(element, "axis2", word, model))
    frames = in_bodies((model.frame(first), model.frame(second)), (one, other))
    pitch = _pitch(element, model) if kind is JointKind.HELICAL else None
    return BodyJoint(name, kind, (first, second), frames, cosine, pitch, limits)


def _read_gearbox(element: Element, model: _Model) -> _Gearbox:
    first, second, reference = (
        _body(element, tag, model)
        for tag in ("parent", "child", "gearbox_reference_body")
    )
    pose = _pose(element.attributes["name"], model)
    one, other = (_axis(element, tag, pose, model) for tag in AXES)
    return _Gearbox(element, reference, (first, second), (one, other))


def _body(joint: Element, tag: str, model: _Model) -> str:
    """The link that a joint names, or that the frame is attached to that it names."""
    name = _link_name(joint, tag)
    seen: set[str] = set()
    while name != WORLD:
        posed = model.posed.get(name)
        if posed is None or name in seen:
            allowed = f"world or one of the links {_listed_links(model)}"
            joint.refuse(f"<{tag}>", quoted(name), allowed)
        if posed.element.tag == "link":
            break
        seen.add(name)
        name = posed.relative_to
    return name


def _axis(element: Element, tag: str, pose: ExactPose, model: _Model) -> np.ndarray:
    """The direction (3,) of an axis in the model."""
    axis = element.first(tag)
    if axis is None:
        element.refuse(f"<{tag}>", "missing", "given for a joint of this type")
    xyz = axis.first("xyz")
    text = "0 0 1" if xyz is None else xyz.text
    direction = np.array(element.parsed_numbers(f"<{tag}><xyz>", text, (3,)))
    is_direction = bool(np.any(direction))
    allowed = "of a length other than zero"
    element.require(is_direction, f"<{tag}><xyz>", quoted(text.strip()), allowed)
    rotation = pose.rotation
    expressed = "" if xyz is None else xyz.attributes.get("expressed_in", "")
    if expressed:
        is_known = expressed in model.posed or expressed in (MODEL, WORLD)
        allowed = f"one of {', '.join(model.posed)}"
        element.require(is_known, "expressed_in", quoted(expressed), allowed)
        rotation = _pose(expressed, model).rotation
    flag = axis.first("use_parent_model_frame")
    if flag is not None and flag.text.strip() in ("1", "true"):
        rotation = np.eye(3)
    turned: np.ndarray = rotation @ direction
    return turned


def _limits(element: Element, tag: str, word: str, model: _Model) -> Limits | None:
    """The limits of an axis, None where there are none, or one end is open."""
    axis = element.first(tag)
    limit = None if axis is None else axis.first("limit")
    if limit is None or word == "continuous":
        return None
    ends = []
    for key, default in (("lower", -UNLIMITED), ("upper", UNLIMITED)):
        child = limit.first(key)
        text = str(default) if child is None else child.text.strip()
        if text.lower().lstrip("+-") in ("inf", "infinity"):
            return None
        ends.append(element.parsed_numbers(f"<{key}>", text, (1,))[0])
    low, high = ends
    if min(-low, high) >= UNLIMITED or low <= -UNLIMITED or high >= UNLIMITED:
        return None
    if low > high:  # SDF's other word for no limit
        name = element.attributes["name"]
        model.notes.append(
            f"left out: the limits of joint {name}, {low:g} to {high:g}: a lower end "
            "above the upper one is no limit in SDF"
        )
        return None
    allowed = "a smaller number and a larger one"
    element.require(low != high, "<limit>", [low, high], allowed)
    return (low, high)


def _pitch(element: Element, model: _Model) -> float:
    """The advance of a screw in a full turn."""
    new, old = element.first("screw_thread_pitch"), element.first("thread_pitch")
    if new is not None and model.version >= PITCH_SINCE:
        return _number(element, "screw_thread_pitch", None)
    if old is None:
        element.refuse("<thread_pitch>", "missing", "given for a screw")
    turn = _number(element, "thread_pitch", None)
    element.require(turn != 0, "<thread_pitch>", turn, "other than 0")
    return -2 * math.pi / turn  # rad a length, left-handed


# --- couplings ------------------------------------------------------------------------


def _mimics(
    joint: BodyJoint, joints: Mapping[str, BodyJoint], model: _Model
) -> dict[str, Coupling]:
    """What ``<mimic>`` says of the variables of a joint, by their labels."""
    element = model.posed[joint.name].element
    coupled = {}
    for number, tag in enumerate(AXES):
        axis = element.first(tag)
        mimic = None if axis is None else axis.first("mimic")
        if mimic is None:
            continue
        if model.version < MIMIC_SINCE:
            mimic.refuse("version", "older", "1.11 for a file with <mimic>")
        if number >= len(joint.labels):
            mimic.refuse(f"<{tag}>", "of no variable", f"left out of {joint.name}")
        coupled[joint.labels[number]] = _coupling(mimic, joints)
    return coupled


def _coupling(mimic: Element, joints: Mapping[str, BodyJoint]) -> Coupling:
    allowed = f"one of the joints {', '.join(joints)}"
    leader = joints[mimic.reference("joint", joints, allowed)]
    number = AXES.index(mimic.choice("axis", AXES, AXES[0]))
    shown = f"{AXES[number]} of {leader.name}"
    is_axis = number < len(leader.labels)
    mimic.require(is_axis, "axis", shown, "an axis that the joint has")
    ratio = _number(mimic, "multiplier", None)
    allowed = "other than 0; what stands still is fixed"
    mimic.require(ratio != 0.0, "<multiplier>", 0, allowed)
    offset = _number(mimic, "offset", 0.0) - ratio * _number(mimic, "reference", 0.0)
    return Coupling(leader.labels[number], ratio, offset)


def _number(element: Element, tag: str, default: float | None) -> float:
    """The number in a child of this tag."""
    child = element.first(tag)
    if child is not None:
        return element.parsed_numbers(f"<{tag}>", child.text, (1,))[0]
    if default is None:
        element.refuse(f"<{tag}>", "missing", "a number")
    return default


def _geared(
    gearbox: _Gearbox, joints: Mapping[str, BodyJoint], model: _Model
) -> tuple[str, str, float]:
    """The joints that hold the links of a gearbox, and how much the second one turns
    for a turn of the first one."""
    rate = -_number(gearbox.element, "gearbox_ratio", 1.0)
    gearbox.element.require(rate != 0.0, "<gearbox_ratio>", 0, "other than 0")
    (first, sign), (second, other) = (
        _hinge(gearbox, number, joints.values(), model) for number in range(len(AXES))
    )
    return first, second, rate * sign * other


def _hinge(
    gearbox: _Gearbox, number: int, joints: Iterable[BodyJoint], model: _Model
) -> tuple[str, float]:
    """The revolute joint that holds a link of a gearbox, by number, on the reference;
    and 1 where its angle is that of the gearbox, -1 where it has the other sign."""
    link, direction = gearbox.links[number], gearbox.directions[number]
    along = direction / np.linalg.norm(direction)
    for joint in joints:
        if joint.kind is not JointKind.REVOLUTE:
            continue
        axis = (model.frame(joint.bodies[0]) @ joint.frames[0])[:3, 2]
        is_along = is_one_direction(float(np.linalg.norm(np.cross(axis, along))))
        if is_along and set(joint.bodies) == {link, gearbox.reference}:
            break
    else:
        value = quoted(gearbox.reference)
        allowed = f"a link that a revolute joint along <{AXES[number]}> joins to {link}"
        gearbox.element.refuse("<gearbox_reference_body>", value, allowed)
    sign = float(np.sign(axis @ along))
    return joint.name, sign if joint.bodies[1] == link else -sign
