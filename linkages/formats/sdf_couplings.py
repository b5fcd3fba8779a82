"""What SDF says of joints that follow others: ``<mimic>``, and gearboxes.

An axis with ``<mimic>`` is at multiplier * (leader - reference) + offset. A joint of
type ``gearbox`` joins no links: of two links that revolute joints hold on a third one,
the reference, the child turns by -ratio times what the parent turns by.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_one_direction
from linkages.formats.assembly import BodyJoint
from linkages.formats.xml_tree import Element
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import JointKind
from linkages.values import quoted

GEARBOX = "gearbox"
MIMIC_SINCE = (1, 11)
AXES = ("axis", "axis2")


class Gearbox(NamedTuple):
    """A gearbox: its ``element``, the link ``reference``, the two ``links`` that turn
    on it, and the directions (3,) in the model about which their angles are counted."""

    element: Element
    reference: str
    links: tuple[str, str]
    directions: tuple[np.ndarray, np.ndarray]


# --- mimic ----------------------------------------------------------------------------


def with_mimics(
    joints: Sequence[BodyJoint],
    elements: Mapping[str, Element],
    version: tuple[int, int],
) -> list[BodyJoint]:
    """The ``joints`` with what ``<mimic>`` says in their ``elements``, by name; raises
    `GeometryError`."""
    by_name = {joint.name: joint for joint in joints}
    coupled = []
    for joint in joints:
        own: dict[str, Coupling] = {}
        for number, tag in enumerate(AXES):
            axis = elements[joint.name].first(tag)
            mimic = None if axis is None else axis.first("mimic")
            if mimic is None:
                continue
            if version < MIMIC_SINCE:
                mimic.refuse("version", "older", "1.11 for a file with <mimic>")
            if number >= len(joint.labels):
                mimic.refuse(f"<{tag}>", "of no variable", f"left out of {joint.name}")
            own[joint.labels[number]] = _coupling(mimic, by_name)
        coupled.append(replace(joint, coupled=own) if own else joint)
    return coupled


def _coupling(mimic: Element, joints: Mapping[str, BodyJoint]) -> Coupling:
    allowed = f"one of the joints {', '.join(joints)}"
    leader = joints[mimic.reference("joint", joints, allowed)]
    number = AXES.index(mimic.choice("axis", AXES, AXES[0]))
    if number >= len(leader.labels):
        shown = f"{AXES[number]} of {leader.name}"
        mimic.refuse("axis", shown, "an axis that the joint has")
    ratio = _number(mimic, "multiplier", None)
    if ratio == 0.0:
        mimic.refuse("<multiplier>", 0, "other than 0; what stands still is fixed")
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


# --- gearboxes ------------------------------------------------------------------------


def with_gearboxes(
    joints: Sequence[BodyJoint],
    gearboxes: Sequence[Gearbox],
    pose_of: Callable[[str], np.ndarray],
) -> list[BodyJoint]:
    """The ``joints`` with what gearboxes say of them; ``pose_of`` gives the pose (4, 4)
    of a link in the model. Raises `GeometryError`."""
    coupled = {joint.name: dict(joint.coupled) for joint in joints}
    for gearbox in gearboxes:
        hinges = []
        rate = -_number(gearbox.element, "gearbox_ratio", 1.0)
        if rate == 0.0:
            gearbox.element.refuse("<gearbox_ratio>", 0, "other than 0")
        for number in range(len(AXES)):
            hinge, sign = _hinge(gearbox, number, joints, pose_of)
            hinges.append(hinge)
            rate *= sign
        leader, follower = hinges
        if coupled[follower.name]:
            allowed = "a joint that is coupled once"
            gearbox.element.refuse("<child>", f"on joint {follower.name}", allowed)
        coupled[follower.name][follower.name] = Coupling(leader.name, rate)
    return [replace(joint, coupled=coupled[joint.name]) for joint in joints]


def _hinge(
    gearbox: Gearbox,
    number: int,
    joints: Sequence[BodyJoint],
    pose_of: Callable[[str], np.ndarray],
) -> tuple[BodyJoint, float]:
    """The revolute joint that holds a link of a gearbox, by number, on the reference;
    and 1 where its angle is that of the gearbox, -1 where it has the other sign."""
    link, direction = gearbox.links[number], gearbox.directions[number]
    along = direction / np.linalg.norm(direction)
    for joint in joints:
        if joint.kind is not JointKind.REVOLUTE:
            continue
        axis = (pose_of(joint.bodies[0]) @ joint.frames[0])[:3, 2]
        is_along = is_one_direction(float(np.linalg.norm(np.cross(axis, along))))
        if is_along and set(joint.bodies) == {link, gearbox.reference}:
            break
    else:
        value = quoted(gearbox.reference)
        allowed = f"a link that a revolute joint along <{AXES[number]}> joins to {link}"
        gearbox.element.refuse("<gearbox_reference_body>", value, allowed)
    sign = float(np.sign(axis @ along))
    return joint, sign if joint.bodies[1] == link else -sign
