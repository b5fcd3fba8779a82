"""Whether a mechanism moves in a plane or on a sphere."""

from __future__ import annotations

import numpy as np

from linkages.decisions import is_parallel_axis
from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.size import Size
from linkages.structure.placement import Placement


def normal_of_plane(mechanism: Mechanism) -> np.ndarray | None:
    """The unit normal (3,) of the plane in which all bodies move: axes of turns are
    along it, slides across; None where there is no such plane, or more than one."""
    if any(pair.center is not None for pair in mechanism.pairs):
        return None
    motions = [one.motion for one in mechanism.variables if one.locked != 0.0]
    normal = _normal(motions)
    if normal is None:
        return None
    for motion in motions:
        beside = abs(float(motion.direction @ normal))
        if motion.is_turn:
            beside = float(np.linalg.norm(np.cross(motion.direction, normal)))
        if not is_parallel_axis(beside) or (motion.is_turn and motion.advance):
            return None
    return normal


def is_on_sphere(mechanism: Mechanism) -> bool:
    """Whether all joints turn, about axes through one point."""
    variables = mechanism.variables
    motions = [one.motion for one in variables if one.locked != 0.0]
    is_free = any(pair.center is not None for pair in mechanism.pairs)
    if is_free or not all(one.is_turn and one.advance == 0.0 for one in motions):
        return False
    unit = Size(mechanism).characteristic_length
    return Placement.of_chain(motions, unit).is_spherical


def _normal(motions: list[Motion]) -> np.ndarray | None:
    """The direction of the first turn, or that across two slides."""
    for motion in motions:
        if motion.is_turn:
            return motion.direction
    for motion in motions[1:]:
        across = np.cross(motions[0].direction, motion.direction)
        length = float(np.linalg.norm(across))
        if not is_parallel_axis(length):
            return across / length
    return None
