"""Displacements as homogeneous transforms, in the user's unit."""

from __future__ import annotations

import numpy as np

from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Mechanism


def transforms(motion: Motion, values: np.ndarray) -> np.ndarray:
    """The transforms (k, 4, 4) of an elementary motion by ``values`` (k,), in rad or
    the user's unit."""
    result = np.tile(np.eye(4), (len(values), 1, 1))
    if not motion.is_turn:
        result[:, :3, 3] = values[:, None] * motion.direction
        return result
    rotation = turns(motion.direction, values)
    result[:, :3, :3] = rotation
    advance = (motion.advance * values)[:, None] * motion.direction
    result[:, :3, 3] = motion.point - rotation @ motion.point + advance
    return result


def turns(direction: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Rotations (k, 3, 3) about a unit vector (3,) by ``angles`` (k,)."""
    x, y, z = direction
    turned = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.outer(direction, direction)
    cosines, sines = np.cos(angles)[:, None, None], np.sin(angles)[:, None, None]
    rotations: np.ndarray = along + cosines * (np.eye(3) - along) + sines * turned
    return rotations


def displacement_of(mechanism: Mechanism, pair: int) -> np.ndarray:
    """The displacement (4, 4) of the moved body of a pair whose variables are all
    locked."""
    result = np.eye(4)
    for number in mechanism.pairs[pair].variables:
        variable = mechanism.variables[number]
        assert variable.locked is not None
        result = result @ transforms(variable.motion, np.array([variable.locked]))[0]
    return result
