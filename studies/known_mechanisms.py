"""Mechanisms whose facts are known, and other ways to give a mechanism.

The cases are those of data/mechanisms.json: joints, or points and bars, in one closed
configuration, with counts and mobility, which other programs verified there. None of the
other ways changes what a mechanism does.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from linkages import Joint, JointKind, Mechanism
from linkages.files.bars import read_bars
from linkages.mechanisms.mechanism import FRAMES

DATA = Path(__file__).parents[1] / "data" / "mechanisms.json"
SCALES = (1e-3, 1e3)
FRAME_SEED = 8  # of another frame of coordinates
OFFSET = (5.0, -3.0, 2.0)  # of its origin
LONGER = 3.0  # directions are given by vectors that are no unit vectors
# joints whose variables change their sign, and no more, with their bodies exchanged
WITH_OTHER_SIGN = (
    JointKind.REVOLUTE,
    JointKind.PRISMATIC,
    JointKind.CYLINDRICAL,
    JointKind.HELICAL,
    JointKind.SPHERICAL,
    JointKind.RIGID,
)


@dataclass(frozen=True)
class KnownMechanism:
    """A mechanism, its ``mobility`` and the ``nullity`` of F' in the configuration in
    which it is given."""

    mechanism: Mechanism
    mobility: int
    nullity: int


@cache
def cases() -> dict[str, dict[str, Any]]:
    """All cases as they are in the file, by name."""
    content = json.loads(DATA.read_text(encoding="utf-8"))
    return {case["name"]: case for case in content["cases"]}


def mechanism_of_case(case: dict[str, Any]) -> Mechanism:
    """The mechanism of a case."""
    if "bars" in case:
        return read_bars(case, case["name"])
    joints = tuple(Joint(**joint) for joint in case["joints"])
    return Mechanism(joints, case["name"])


def known_mechanisms() -> dict[str, KnownMechanism]:
    """All cases as mechanisms with what is known of them, by name."""
    return {
        name: KnownMechanism(mechanism_of_case(case), case["mobility"], case["nullity"])
        for name, case in cases().items()
    }


# --- other ways to give a mechanism ---------------------------------------------------


def relabelled(mechanism: Mechanism) -> Mechanism:
    """Joints in another order, with other names, and every other one turned round."""
    turned = _turned_round(mechanism, mechanism.joints[1::2])
    joints = []
    labels: dict[str, str] = {}
    for number, joint in enumerate(turned.joints[::-1]):
        bodies = tuple(f"body {body}" for body in joint.bodies)
        other = replace(joint, name=f"joint {number}", bodies=bodies)
        labels |= zip(joint.labels, other.labels, strict=True)
        joints.append(other)
    return replace(turned, joints=tuple(_renamed(joint, labels) for joint in joints))


def _renamed(joint: Joint, labels: Mapping[str, str]) -> Joint:
    """The joint with couplings to variables by their new labels."""
    coupled = tuple(
        None if one is None else replace(one, to=labels[one.to])
        for one in joint.coupled
    )
    return replace(joint, coupled=coupled)


def rebased(mechanism: Mechanism) -> Mechanism:
    """Another body at rest, which is also the first one, joints turned round, and
    another body of every joint of several the one from which the others are measured,
    where these have no limits, locks or couplings."""
    turned = _turned_round(mechanism, mechanism.joints)
    middle = len(mechanism.joints) // 2
    joints = turned.joints[middle:] + turned.joints[:middle]
    fixed = joints[0].bodies[0]
    names = {body: body for body in mechanism.bodies}
    for body in mechanism.bodies:
        if body in FRAMES:
            names[body] = f"former {body}"
    names[fixed] = FRAMES[0]
    rebased_joints = []
    for joint in joints:
        bodies = tuple(names[body] for body in joint.bodies)
        if len(bodies) > 2 and not _is_held(joint):
            bodies = bodies[-1:] + bodies[:-1]
        rebased_joints.append(replace(joint, bodies=bodies))
    return replace(turned, joints=tuple(rebased_joints))


def _is_held(joint: Joint) -> bool:
    """Whether values of a joint have limits, are locked or follow others."""
    values = (*joint.limits, *joint.locked, *joint.coupled)
    return any(value is not None for value in values)


def _turned_round(mechanism: Mechanism, joints: Sequence[Joint]) -> Mechanism:
    """The mechanism with some joints the other way round, those of two bodies whose
    variables then have the other sign."""
    factors: dict[str, float] = {}
    turned = []
    names = {joint.name for joint in joints}
    for joint in mechanism.joints:
        is_turned = len(joint.bodies) == 2 and joint.kind in WITH_OTHER_SIGN
        is_turned = is_turned and joint.name in names
        factors |= dict.fromkeys(joint.labels, -1.0 if is_turned else 1.0)
        bodies = joint.bodies[::-1] if is_turned else joint.bodies
        turned.append(replace(joint, bodies=bodies))
    return mechanism.with_values_times(turned, factors)


def moved(mechanism: Mechanism) -> Mechanism:
    """The same in another frame of coordinates, with other points of the axes and
    directions that are no unit vectors."""
    rng = np.random.default_rng(FRAME_SEED)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    joints = []
    for joint in mechanism.joints:
        along = np.zeros(3) if joint.direction is None else np.array(joint.direction)
        step = rng.normal() * along
        if joint.kind is JointKind.UNIVERSAL:
            step = np.zeros(3)  # its axes meet at one point
        place = _vector(rotation @ (joint.place + step) + OFFSET)
        changes: dict[str, Any] = {"point": place}
        for key in ("direction", "second_direction"):
            vector = getattr(joint, key)
            if vector is not None:
                changes[key] = _vector(LONGER * rotation @ np.array(vector))
            elif key == "second_direction" and joint.kind is JointKind.PLANAR:
                # where none is given, the first slide hangs on the frame
                changes[key] = _vector(rotation @ joint.motions[0].direction)
        joints.append(replace(joint, **changes))
    return replace(mechanism, joints=tuple(joints))


def _vector(values: np.ndarray) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z


def _scaled(factor: float) -> Callable[[Mechanism], Mechanism]:
    return lambda mechanism: mechanism.scaled(factor)


WAYS: dict[str, Callable[[Mechanism], Mechanism]] = {
    "relabelled": relabelled,
    "re-based": rebased,
    "moved": moved,
    "mirrored": Mechanism.mirrored,
    **{f"scaled by {factor:g}": _scaled(factor) for factor in SCALES},
}
