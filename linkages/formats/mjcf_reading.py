"""Mechanisms in MJCF, the files of MuJoCo (Todorov, Erez and Tassa 2012).

Bodies stand in a tree, in the configuration qpos0. Loops are closed by <equality>: one
<connect> between two bodies is a spherical joint, two are a revolute joint, more of
them or a <weld> join the bodies rigidly. Several joints of a body follow each other;
those that make a cylindrical, a universal, a planar or a helical joint are read as
such. Equality of two joints couples them. Actuators say which joints motors drive, also
through fixed tendons. Masses and shapes are left out.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from linkages.decisions import is_one_anchor
from linkages.files.mechanism_file import MANY_TURNS
from linkages.formats.assembly import (
    Assembly,
    BodyJoint,
    frame_along,
    in_bodies,
    listed,
    translation,
)
from linkages.formats.composites import (
    Axis,
    AxisCoupling,
    joints_of_axes,
)
from linkages.formats.exact_poses import (
    ExactPlace,
    ExactPose,
    Origin,
)
from linkages.formats.mjcf_poses import (
    AT_REST,
    Settings,
    pose_of,
    read_settings,
    rotation_of_quaternion,
)
from linkages.formats.names import TakenNames, first_new, numbered
from linkages.formats.xml_tree import Element
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import JointKind, Limits
from linkages.values import GeometryError, quoted, require

WORLD = "world"
NOT_READ = ("include", "attach", "replicate", "composite", "flexcomp")
COUPLINGS = ("tendon", "flex", "flexvert", "flexstrain", "distance")
TINY = 1e-300  # of coordinates that are all 0
NUMBERED = re.compile(r"\.\d+$")


@dataclass(eq=False)
class _Body:
    """A body that may move: its ``name``, and the ``frame`` (4, 4) at qpos0 in which
    its joints are written."""

    name: str
    frame: np.ndarray


_Placed: TypeAlias = tuple[_Body, ExactPose]


@dataclass
class _Model:
    """What was read so far. ``elements`` leads from every <body>, and ``sites`` from
    every <site>, to the `_Body` that it is rigid with and its pose in the world,
    ``labels`` from every axis to the label of the variable that it is. Places are
    counted from the ``origin``; ``places`` are those of all joints, off by ``rounding``
    at most."""

    settings: Settings
    taken: TakenNames
    origin: Origin
    bodies: list[_Body] = field(default_factory=list)
    elements: dict[str, _Placed] = field(default_factory=dict)
    sites: dict[str, _Placed] = field(default_factory=dict)
    places: list[ExactPlace] = field(default_factory=list)
    rounding: float = 0.0
    axes: dict[str, Axis] = field(default_factory=dict)
    chains: list[tuple[_Body, _Body, list[Axis]]] = field(default_factory=list)
    joints: list[BodyJoint] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    locks: dict[str, float] = field(default_factory=dict)
    couplings: dict[str, AxisCoupling] = field(default_factory=dict)
    labels: dict[str, str] = field(default_factory=dict)

    def point(self, pose: ExactPose) -> np.ndarray:
        """The place (3,) of a pose at which a joint is, which is kept in mind."""
        self.places.append(pose.place)
        self.rounding = max(self.rounding, pose.rounding)
        return pose.matrix()[:3, 3]


def read_mjcf(root: Element, name: str) -> Assembly:
    """The assembly that an MJCF model describes; raises `GeometryError`."""
    for element in root.children:
        if element.tag in NOT_READ:
            _refuse_element(element)
    model = _read_model(root, Origin())
    origin = Origin.near(model.places)
    rounding = 0.0
    if origin.place is not None:
        model = _read_model(root, origin)
        rounding = model.rounding
    poses = {body.name: body.frame for body in model.bodies}
    motors = _motors(root, model)
    return Assembly(
        root.attributes.get("model", name),
        tuple(body.name for body in model.bodies),
        tuple(model.joints),
        poses,
        tuple(model.notes),
        model.origin.vector,
        rounding,
        motors,
    )


def _read_model(root: Element, origin: Origin) -> _Model:
    """What an MJCF model describes, with places that are counted from an origin."""
    model = _Model(read_settings(root), TakenNames(root), origin)
    world = _Body(WORLD, origin.frame(origin.pose))
    model.bodies.append(world)
    model.elements[WORLD] = (world, origin.pose)
    for worldbody in root.all("worldbody"):
        _read_children(worldbody, world, origin.pose, None, model)
    for equality in root.all("equality"):
        _read_couplings(equality, model)
    _add_chains(model)
    for equality in root.all("equality"):
        _read_closures(equality, model)
    return model


def _refuse_element(element: Element) -> None:
    allowed = "left out; put the whole model in one file"
    raise GeometryError(f"line {element.line}", f"<{element.tag}>", allowed)


# --- the tree of bodies ---------------------------------------------------------------


def _read_children(
    element: Element,
    body: _Body,
    pose: ExactPose,
    childclass: str | None,
    model: _Model,
) -> None:
    """Read the bodies, frames and sites in an element at ``pose`` in the world, which
    belongs to ``body``."""
    for child in element.children:
        if child.tag in NOT_READ:
            _refuse_element(child)
        elif child.tag == "site":
            site = model.settings.attributes(child, childclass)
            place = pose @ pose_of(site, model.settings)
            model.sites[site.attributes.get("name", "")] = (body, place)
        elif child.tag == "frame":
            inner = child.attributes.get("childclass", childclass)
            place = pose @ pose_of(child, model.settings)
            _read_children(child, body, place, inner, model)
        elif child.tag == "body":
            _read_body(child, body, pose, childclass, model)


def _read_body(
    element: Element,
    parent: _Body,
    pose: ExactPose,
    childclass: str | None,
    model: _Model,
) -> None:
    """Read a body and what is in it; without joints it is one with its parent."""
    childclass = element.attributes.get("childclass", childclass)
    name = element.attributes.get("name")
    if name is None:
        numbers = itertools.count(len(model.elements))
        name = first_new((f"body{number}" for number in numbers), model.taken.bodies)
    element.check_new(name, model.elements)
    pose = pose @ pose_of(element, model.settings)
    joints = [
        model.settings.attributes(joint, childclass)
        for joint in element.all("joint", "freejoint")
    ]
    body = parent
    if joints:
        body = _Body(name, model.origin.frame(pose))
        model.bodies.append(body)
    model.elements[name] = (body, pose)
    is_free = any(
        joint.tag == "freejoint" or joint.attributes.get("type") == "free"
        for joint in joints
    )
    if joints and not is_free:
        axes = [_read_axis(joint, pose, model) for joint in joints]
        model.chains.append((parent, body, axes))
    _read_children(element, body, pose, childclass, model)


def _read_axis(joint: Element, pose: ExactPose, model: _Model) -> Axis:
    """A joint of a body at ``pose``."""
    kind = joint.choice("type", ("hinge", "slide", "ball"), "hinge")
    name = joint.attributes.get("name")
    if name is None:
        numbers = itertools.count(len(model.axes) + 1)
        name = first_new((f"J{number}" for number in numbers), model.taken.joints)
    joint.check_new(name, model.axes)
    point = ExactPose.at(joint.numbers("pos", (3,)) or AT_REST)
    direction = np.array(joint.numbers("axis", (3,)) or (0.0, 0.0, 1.0))
    is_axis = kind == "ball" or bool(np.any(direction))
    value = quoted(joint.attributes.get("axis"))
    joint.require(is_axis, "axis", value, "of a length other than zero")
    unit = model.settings.angle_unit if kind == "hinge" else 1.0
    limits = _read_limits(joint, kind, unit, model.settings)
    low, high = limits or (0.0, 0.0)
    is_in_radians = kind == "hinge" and unit == 1.0
    if is_in_radians and max(-low, high) > MANY_TURNS:
        model.notes.append(
            f"joint {name} is limited from {low:g} to {high:g} rad, more than two "
            'turns; if that is in degrees, write angle="degree"'
        )
    if kind == "ball" and limits is not None:
        limits = None
        model.notes.append(f"left out: the range of the ball joint {name}")
    place_of = model.origin.place_of_slide if kind == "slide" else model.point
    place = place_of(pose @ point)
    model.axes[name] = Axis(name, kind, place, pose.rotation @ direction, limits)
    return model.axes[name]


def _read_limits(
    joint: Element, kind: str, unit: float, settings: Settings
) -> Limits | None:
    """The limits of a joint, from where it is at qpos0; None where MuJoCo does not
    limit it. Raises `GeometryError` where MuJoCo refuses the range."""
    limited = joint.choice("limited", ("true", "false", "auto"), "auto")
    # a range that is not given is 0 0 for MuJoCo
    low, high = joint.numbers("range", (2,)) or (0.0, 0.0)
    is_limited = limited == "true"
    if limited == "auto":
        is_said = settings.has_auto_limits or not (low or high)
        allowed = 'with `limited`, as the compiler says autolimits="false"'
        joint.require(is_said, "range", [low, high], allowed)
        is_limited = low < high
    if not is_limited:
        return None
    allowed = "0 and the largest angle of a ball"
    joint.require(kind != "ball" or not low, "range", [low, high], allowed)
    allowed = "a smaller number and a larger one"
    joint.require(kind == "ball" or low < high, "range", [low, high], allowed)
    reference = (joint.numbers("ref", (1,)) or [0.0])[0]
    return (unit * (low - reference), unit * (high - reference))


def _add_chains(model: _Model) -> None:
    """Add the joints of the tree, with bodies between several joints of one body."""
    for parent, body, axes in model.chains:
        joints = joints_of_axes(axes, model.couplings, model.locks)
        first = parent
        for number, joint in enumerate(joints, start=1):
            second = body
            if number < len(joints):
                name = first_new(numbered(f"{body.name}.{number}"), model.taken.bodies)
                second = _Body(name, body.frame)
                model.bodies.append(second)
            base, moved = (second, first) if joint.is_reversed else (first, second)
            frames = in_bodies((base.frame, moved.frame), (joint.first, joint.second))
            body_joint = BodyJoint(
                joint.name,
                joint.kind,
                (base.name, moved.name),
                frames,
                cosine=float(joint.first[:3, 2] @ joint.second[:3, 2]),
                pitch=joint.pitch,
                limits=joint.limits,
                locked=joint.locked,
            )
            if len(joint.axes) > 1:
                names = numbered(joint.name, "+".join(joint.axes))
                body_joint = model.taken.named_joint(body_joint, names, joint.axes)
            model.joints.append(body_joint)
            model.labels |= zip(joint.axes, body_joint.labels, strict=True)
            first = second
    _add_couplings(model)


def _add_couplings(model: _Model) -> None:
    """Couple the variables of joints of the tree."""
    coupled: dict[str, Coupling] = {}
    for axis, (to, ratio, offset, element) in model.couplings.items():
        for key, name in (("joint1", axis), ("joint2", to)):
            value = f"{quoted(name)}, a ball joint or the slide of a helical one,"
            allowed = "a hinge or a slide with a variable"
            element.require(name in model.labels, key, value, allowed)
        coupled[model.labels[axis]] = Coupling(model.labels[to], ratio, offset)
    for number, joint in enumerate(model.joints):
        own = {label: coupled[label] for label in joint.labels if label in coupled}
        model.joints[number] = replace(joint, coupled=own)


# --- equality -------------------------------------------------------------------------


def _is_active(element: Element) -> bool:
    return element.choice("active", ("true", "false"), "true") == "true"


def _read_couplings(equality: Element, model: _Model) -> None:
    """Read what is said of joints: one alone is locked, two are coupled. Raises
    `GeometryError` for a coupling that is not linear."""
    for element in equality.children:
        element = model.settings.attributes(element, None, "equality")
        is_read = element.tag not in COUPLINGS or not _is_active(element)
        what = f"equality on line {element.line}"
        allowed = "<connect>, <weld> or <joint>"
        require(is_read, what, f"<{element.tag}>", allowed)
        if element.tag != "joint" or not _is_active(element):
            continue
        first, second = (element.attributes.get(key) for key in ("joint1", "joint2"))
        allowed = f"one of the joints {', '.join(model.axes)}"
        element.require(first in model.axes, "joint1", quoted(first), allowed)
        is_known = second is None or second in model.axes
        element.require(is_known, "joint2", quoted(second), allowed)
        given = element.numbers("polycoef", (1, 2, 3, 4, 5)) or []
        # those that are not given stay at MuJoCo's default
        offset, ratio, *higher = [*given, *(0.0, 1.0, 0.0, 0.0, 0.0)[len(given) :]]
        assert first is not None
        if second is None or (ratio == 0.0 and not any(higher)):
            model.locks[first] = offset
            continue
        value = f"a coupling of joints {first} and {second} that is not linear"
        allowed = "two numbers, and zeros after them"
        element.require(not any(higher), "polycoef", value, allowed)
        is_new = first not in model.couplings
        element.require(is_new, "joint1", quoted(first), "coupled to one joint")
        model.couplings[first] = AxisCoupling(second, ratio, offset, element)


def _read_closures(equality: Element, model: _Model) -> None:
    """Read the joints that close loops."""
    groups: dict[tuple[str, str], list[_Anchor]] = {}
    closures: list[BodyJoint] = []
    for number, element in enumerate(equality.children, start=1):
        element = model.settings.attributes(element, None, "equality")
        if element.tag not in ("connect", "weld") or not _is_active(element):
            continue
        name = element.attributes.get("name", f"{element.tag}{number}")
        if element.tag == "weld":
            weld = _read_weld(element, name, model)
            if weld.bodies[0] != weld.bodies[1]:
                closures.append(weld)
            continue
        anchor = _read_connect(element, name, model)
        if anchor.bodies[0] is anchor.bodies[1]:
            continue  # it holds whatever the joints do
        key = anchor.bodies[0].name, anchor.bodies[1].name
        if key[::-1] in groups:
            anchor = anchor.reversed()
            key = key[::-1]
        groups.setdefault(key, []).append(anchor)
    closures += [_joint_of_anchors(anchors) for anchors in groups.values()]
    for joint in closures:
        _add_closure(joint, model)


def _add_closure(joint: BodyJoint, model: _Model) -> None:
    """Add a joint of an equality, which may have the name of a joint of the tree."""
    named = model.taken.named_joint(joint, numbered(joint.name))
    model.joints.append(named)
    if named.name != joint.name:
        note = f"equality {joint.name} is called {named.name}, as there is such a joint"
        model.notes.append(note)


@dataclass
class _Anchor:
    """A point that two ``bodies`` share: where it is in the world at qpos0 as a point
    of the one and of the other."""

    name: str
    bodies: tuple[_Body, _Body]
    points: tuple[np.ndarray, np.ndarray]

    def reversed(self) -> _Anchor:
        """The anchor with its bodies exchanged."""
        return _Anchor(self.name, self.bodies[::-1], self.points[::-1])


def _read_ends(element: Element, model: _Model) -> tuple[_Placed, _Placed, bool]:
    """What an equality joins, two sites or two bodies; and whether they are sites."""
    are_sites = "site1" in element.attributes or "site2" in element.attributes
    allowed = f"one of the bodies {', '.join(model.elements)}"
    noun, known, default = "body", model.elements, WORLD
    if are_sites:
        allowed = "the name of a site"
        noun, known, default = "site", model.sites, ""
    one = element.reference(f"{noun}1", known, allowed)
    other = element.reference(f"{noun}2", known, allowed, default)
    return known[one], known[other], are_sites


def _read_connect(element: Element, name: str, model: _Model) -> _Anchor:
    (first, one), (second, other), are_sites = _read_ends(element, model)
    if are_sites:
        return _Anchor(name, (first, second), (model.point(one), model.point(other)))
    anchor = element.numbers("anchor", (3,))
    if anchor is None:
        element.refuse("anchor", "missing", "a point in body1, or two sites")
    point = model.point(one @ ExactPose.at(anchor))
    return _Anchor(name, (first, second), (point, point))


def _read_weld(element: Element, name: str, model: _Model) -> BodyJoint:
    """Bodies that are joined as they are at qpos0, or in a given pose."""
    (first, one), (second, other), are_sites = _read_ends(element, model)
    given = None if are_sites else element.numbers("relpose", (7,))
    if given is not None and any(given[3:]):
        turn = rotation_of_quaternion(np.array(given[3:]))
        one = one @ ExactPose.at(given[:3], turn)
    elif not are_sites:
        other = one
    if model.origin.place is not None:
        # the same frames of both, brought near
        near = ExactPose(place=other.inverse().place)
        one, other = one @ near, other @ near
    frames = in_bodies((first.frame, second.frame), (one.matrix(), other.matrix()))
    return BodyJoint(name, JointKind.RIGID, (first.name, second.name), frames)


def _joint_of_anchors(anchors: list[_Anchor]) -> BodyJoint:
    """The joint that two bodies have when they share these points."""
    first, second = anchors[0].bodies
    places = [np.array([a.points[side] for a in anchors]) for side in (0, 1)]
    kind, columns = _kind_of_points(places[0])
    frames = []
    for points in places:
        frame = translation(points[0])
        if kind is JointKind.REVOLUTE:
            frame = frame_along(points[0], points[columns[0]] - points[0])
        elif kind is JointKind.RIGID:
            across, other = (points[column] - points[0] for column in columns)
            frame = frame_along(points[0], np.cross(across, other), across)
        frames.append(frame)
    own = in_bodies((first.frame, second.frame), frames)
    # "J.1" and "J.2" are "J" together
    stems = {NUMBERED.sub("", anchor.name) for anchor in anchors}
    is_one = len(anchors) > 1 and len(stems) == 1
    name = stems.pop() if is_one else anchors[0].name
    return BodyJoint(name, kind, (first.name, second.name), own)


def _kind_of_points(points: np.ndarray) -> tuple[JointKind, tuple[int, ...]]:
    """The kind of a joint that shares ``points`` (k, 3), and the numbers of those that,
    with the first one, give its axis or its plane."""
    size = float(np.abs(points).max(initial=TINY))
    gaps = points - points[0]
    distances = np.linalg.norm(gaps, axis=1)
    far = int(np.argmax(distances))
    if is_one_anchor(float(distances[far]), size):
        return JointKind.SPHERICAL, ()
    along = gaps[far] / distances[far]
    across = np.linalg.norm(np.cross(gaps, along), axis=1)
    wide = int(np.argmax(across))
    if is_one_anchor(float(across[wide]), size):
        return JointKind.REVOLUTE, (far,)
    return JointKind.RIGID, (far, wide)


# --- actuators ------------------------------------------------------------------------


def _motors(root: Element, model: _Model) -> tuple[str, ...]:
    """The variables that actuators drive; what others drive is left out by name."""
    tendons = {
        tendon.attributes.get("name", ""): [
            joint.attributes.get("joint", "") for joint in tendon.all("joint")
        ]
        for group in root.all("tendon")
        for tendon in group.all("fixed")
    }
    driven: list[str] = []
    others = []
    for group in root.all("actuator"):
        for number, actuator in enumerate(group.children, start=1):
            own = actuator.attributes
            joint = own.get("joint", own.get("jointinparent", ""))
            axes = [joint] if joint else tendons.get(own.get("tendon", ""), [])
            labels = [model.labels[axis] for axis in axes if axis in model.labels]
            driven += labels
            if not labels:
                others.append(own.get("name", f"{actuator.tag}{number}"))
    if others:
        note = f"left out, as they drive no hinge or slide: actuators {listed(others)}"
        model.notes.append(note)
    return tuple(dict.fromkeys(driven))
