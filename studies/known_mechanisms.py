"""Mechanisms whose facts are known, and other ways to give a mechanism.

The cases are those of data/mechanisms.json: joints, or points and bars, in one closed
configuration, with counts and mobility, which other programs verified there. None of the
other ways changes what a mechanism does.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from linkages.mechanisms.bars import read_bars
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import FRAMES, Mechanism

__all__ = [
    "WAYS",
    "KnownMechanism",
    "cases",
    "known_mechanisms",
    "mechanism_of_case",
    "moved",
    "rebased",
    "relabelled",
]

DATA = Path(__file__).parents[1] / "data" / "mechanisms.json"
SCALES = (1e-3, 1e3)
FRAME_SEED = 8  # of another frame of coordinates
OFFSET = (5.0, -3.0, 2.0)  # of its origin
LONGER = 3.0  # directions are given by vectors that are no unit vectors


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
    """Joints in another order, with other names, and every other one turned round;
    they are not locked, limited or coupled."""
    joints = []
    for number, joint in enumerate(mechanism.joints[::-1]):
        bodies = tuple(f"body {body}" for body in joint.bodies)
        if number % 2 and len(bodies) == 2:
            bodies = bodies[::-1]
        joints.append(replace(joint, name=f"joint {number}", bodies=bodies))
    return replace(mechanism, joints=tuple(joints))


def rebased(mechanism: Mechanism) -> Mechanism:
    """Another body at rest, which is also the first one, and another body of every
    joint of several the one from which the others are measured."""
    middle = len(mechanism.joints) // 2
    joints = mechanism.joints[middle:] + mechanism.joints[:middle]
    fixed = joints[0].bodies[-1]
    names = {body: body for body in mechanism.bodies}
    for body in mechanism.bodies:
        if body in FRAMES:
            names[body] = f"former {body}"
    names[fixed] = FRAMES[0]
    rebased_joints = []
    for joint in joints:
        bodies = tuple(names[body] for body in joint.bodies)
        rebased_joints.append(replace(joint, bodies=bodies[-1:] + bodies[:-1]))
    return replace(mechanism, joints=tuple(rebased_joints))


def moved(mechanism: Mechanism) -> Mechanism:
    """The same in another frame of coordinates, with other points of the axes and
    directions that are no unit vectors."""
    rng = np.random.default_rng(FRAME_SEED)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation *= np.linalg.det(rotation)
    joints = []
    for joint in mechanism.joints:
        along = np.zeros(3) if joint.direction is None else np.array(joint.direction)
        place = joint.place + rng.normal() * along
        joint = replace(joint, point=_vector(rotation @ place + OFFSET))
        if joint.direction is not None:
            joint = replace(joint, direction=_vector(LONGER * rotation @ along))
        joints.append(joint)
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
