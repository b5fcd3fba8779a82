"""The variables of joints, as the frames of their bodies stand."""

from __future__ import annotations

import math

import numpy as np

from linkages.formats.assembly import Assembly, BodyJoint
from linkages.mechanisms.joint import JointKind, Limits, Move

FULL_TURN = 2 * math.pi
ROUNDING = 1e-9  # rad, of an angle at the end of its limits


def joint_values(
    joint: BodyJoint, first: np.ndarray, second: np.ndarray
) -> list[float]:
    """The variables that may have limits, at the places of the frames (4, 4)."""
    if joint.kind is JointKind.UNIVERSAL:
        return [0.0, 0.0]
    gap = second[:3, 3] - first[:3, 3]
    values = []
    for number, move in enumerate(joint.kind.facets.moves):
        if move is Move.TURN:
            values.append(_angle(joint, number, first, second))
        else:
            values.append(float(first[:3, move.value] @ gap))
    return values


def limits_left(assembly: Assembly, poses: np.ndarray) -> dict[str, float]:
    """The variables, by label, that are outside their limits at ``poses`` (b, 4, 4), with
    their values."""
    left: dict[str, float] = {}
    for joint in assembly.joints:
        values = joint_values(joint, *assembly.placed(joint, poses))
        rows = zip(joint.labels, joint.limits, values, strict=False)
        for label, pair, value in rows:
            if pair is not None and not _is_within(pair, value):
                left[label] = value
    return left


def _angle(
    joint: BodyJoint, number: int, first: np.ndarray, second: np.ndarray
) -> float:
    """The turn from the first frame to the second one, from -pi to pi, or, where only
    that is within the limits of variable ``number``, full turns away."""
    cosine = first[:3, 0] @ second[:3, 0]
    sine = first[:3, 1] @ second[:3, 0]
    angle = math.atan2(sine, cosine)
    limits = joint.limits[number] if joint.limits else None
    if limits is None or _is_within(limits, angle):
        return angle
    middle = (limits[0] + limits[1]) / 2
    turned = angle + FULL_TURN * round((middle - angle) / FULL_TURN)
    return turned if _is_within(limits, turned) else angle


def _is_within(limits: Limits, angle: float) -> bool:
    """Whether an angle is within limits, but for rounding."""
    return limits[0] - ROUNDING <= angle <= limits[1] + ROUNDING
