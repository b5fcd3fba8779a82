"""Mechanisms in SDFormat 1.5 to 1.11, the files of Gazebo (sdformat.org).

Links are posed in their model, or in what ``relative_to`` names, joints in their child
link. Masses, shapes, sensors and plugins are left out.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

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
from linkages.formats.sdf_couplings import (
    AXES,
    GEARBOX,
    Gearbox,
    with_gearboxes,
    with_mimics,
)
from linkages.formats.xml_tree import Element
from linkages.mechanisms.joint import JointKind, Limits
from linkages.values import quoted

OLDEST, NEWEST = (1, 5), (1, 11)
FRAMES_SINCE = (1, 7)  # relative_to and expressed_in
PITCH_SINCE = (1, 10)  # screw_thread_pitch, in length a turn
WORLD, MODEL = "world", "__model__"
UNLIMITED = 1e16  # SDF's word for no limit
KINDS = {
    "revolute": JointKind.REVOLUTE,
    "continuous": JointKind.REVOLUTE,
    "prismatic": JointKind.PRISMATIC,
    "ball": JointKind.SPHERICAL,
    "universal": JointKind.UNIVERSAL,
    "screw": JointKind.HELICAL,
    "fixed": JointKind.RIGID,
}


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
    version = _version(root)
    worlds = list(root.all("world"))
    models = [m for parent in (root, *worlds) for m in parent.all("model")]
    jointed = [model for model in models if model.first("joint") is not None]
    if len(jointed) != 1:
        names = ", ".join(m.attributes.get("name", "?") for m in jointed) or "none"
        root.refuse("models with joints", names, "one")
    (element,) = jointed
    for tag in ("model", "include"):
        inner = element.first(tag)
        if inner is not None:
            value = f"on line {inner.line}"
            element.refuse(f"<{tag}>", value, "left out; models are not nested")
    model = _Model(element, version, Origin())
    _collect(model)
    rounding = 0.0
    poses_of_joints = [_pose(joint, model) for joint in _joints_with_places(element)]
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


def _joints_with_places(element: Element) -> list[str]:
    """The names of the joints of a model that are at a place."""
    elsewhere = [
        word for word, kind in KINDS.items() if kind.facets.is_point_drawn_only
    ]
    return [
        joint.attributes["name"]
        for joint in element.all("joint")
        if joint.attributes.get("type") not in (*elsewhere, GEARBOX)
    ]


def _version(root: Element) -> tuple[int, int]:
    text = root.attributes.get("version", "")
    match = re.fullmatch(r"(\d+)\.(\d+)", text)
    version = (int(match[1]), int(match[2])) if match else (0, 0)
    if not OLDEST <= version <= NEWEST:
        root.refuse("version", quoted(text), "from 1.5 to 1.11")
    return version


def _read_joints(model: _Model) -> tuple[BodyJoint, ...]:
    """All joints, coupled where they follow others."""
    joints, gearboxes = [], []
    elements = {}
    for element in model.element.all("joint"):
        if element.attributes.get("type") == GEARBOX:
            gearboxes.append(_read_gearbox(element, model))
            continue
        joints.append(_read_joint(element, model))
        elements[element.attributes["name"]] = element
    joints = with_mimics(joints, elements, model.version)
    joints = with_gearboxes(joints, gearboxes, model.frame)
    return with_joints_of_chains(joints, model.frame)


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
    if name in path:
        element.refuse("<pose>", "relative to itself", "relative to another frame")
    own, relative_to = _own_pose(element)
    if relative_to is not None and model.version < FRAMES_SINCE:
        allowed = "left out before version 1.7"
        element.refuse("relative_to", quoted(relative_to), allowed)
    base = relative_to or posed.relative_to
    if base not in model.posed and base not in (MODEL, WORLD):
        _refuse_base(element, base, is_said=relative_to is not None, model=model)
    model.poses[name] = _pose(base, model, (*path, name)) @ own
    return model.poses[name]


def _refuse_base(element: Element, base: str, *, is_said: bool, model: _Model) -> None:
    """Raise `GeometryError` for what a pose is relative to, as ``relative_to`` says or
    as it is for a joint or a frame without that, where there is no such thing."""
    if not is_said and element.tag == "joint":
        allowed = f"world or one of the links {_listed_links(model)}"
        element.refuse("<child>", quoted(base), allowed)
    key = "relative_to" if is_said else "attached_to"
    names = ", ".join(model.posed)
    element.refuse(key, quoted(base), f"one of the links, joints and frames {names}")


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
        if not np.any(turn):
            element.refuse("<pose>", quoted(text), "with a quaternion other than 0")
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
    if word not in KINDS:
        allowed = f"one of {', '.join(KINDS)}, {GEARBOX}"
        element.refuse("type", quoted(word), allowed)
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
        if is_one_direction(float(np.linalg.norm(np.cross(axis, second_axis)))):
            element.refuse("<axis2>", "along <axis>", "another direction")
        other = frame_along(place[:3, 3], second_axis)
        cosine = float(one[:3, 2] @ other[:3, 2])
        limits = (*limits, _limits(element, "axis2", word, model))
    frames = in_bodies((model.frame(first), model.frame(second)), (one, other))
    pitch = _pitch(element, model) if kind is JointKind.HELICAL else None
    return BodyJoint(name, kind, (first, second), frames, cosine, pitch, limits)


def _read_gearbox(element: Element, model: _Model) -> Gearbox:
    first, second, reference = (
        _body(element, tag, model)
        for tag in ("parent", "child", "gearbox_reference_body")
    )
    pose = _pose(element.attributes["name"], model)
    one, other = (_axis(element, tag, pose, model) for tag in AXES)
    return Gearbox(element, reference, (first, second), (one, other))


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
    if not np.any(direction):
        allowed = "of a length other than zero"
        element.refuse(f"<{tag}><xyz>", quoted(text.strip()), allowed)
    rotation = pose.rotation
    expressed = "" if xyz is None else xyz.attributes.get("expressed_in", "")
    if expressed:
        if expressed not in model.posed and expressed not in (MODEL, WORLD):
            allowed = f"one of {', '.join(model.posed)}"
            element.refuse("expressed_in", quoted(expressed), allowed)
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
    if low == high:
        element.refuse("<limit>", [low, high], "a smaller number and a larger one")
    return (low, high)


def _pitch(element: Element, model: _Model) -> float:
    """The advance of a screw in a full turn."""
    new, old = element.first("screw_thread_pitch"), element.first("thread_pitch")
    if new is not None and model.version >= PITCH_SINCE:
        return element.parsed_numbers("<screw_thread_pitch>", new.text, (1,))[0]
    if old is None:
        element.refuse("<thread_pitch>", "missing", "given for a screw")
    turn = element.parsed_numbers("<thread_pitch>", old.text, (1,))[0]
    if turn == 0:
        element.refuse("<thread_pitch>", turn, "other than 0")
    return -2 * math.pi / turn  # rad a length, left-handed
