"""The closure of a loop over mpmath numbers: the residual of `Closure` at
any precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mpmath
import numpy as np

from linkages.closure.motors import IDENTITY, Motor, product, translation, turn
from linkages.kinematics import Number
from linkages.loop import Loop

X_AXIS, Z_AXIS = np.eye(3)[[0, 2]]
ORIGIN = np.zeros(3)


def precise_residual(loop: Loop) -> Callable[[Sequence[Number]], list[Number]]:
    """The six closure equations of a loop as a function of its n joint angles (rad),
    mpmath numbers.

    The same equations as `linkages.closure.loop_parts.ScrewSystem.residuals`: (2
    sign(q_0) q_v, p / characteristic length), with q the quaternion and p the
    translation of the loop product. Floats in the geometry are taken as exact.
    """
    size = mpmath.mpf(loop.characteristic_length)
    offsets = [mpmath.mpf(offset) / size for offset in loop.offsets]
    links = [
        _turn(X_AXIS, twist, mpmath.mpf(length) / size)
        for length, twist in zip(loop.lengths, loop.twists, strict=True)
    ]

    def residual(theta: Sequence[Number]) -> list[Number]:
        motor = IDENTITY
        for angle, offset, link in zip(theta, offsets, links, strict=True):
            joint = _turn(Z_AXIS, angle, offset)
            motor = product(motor, product(joint, link))
        sign = 1 if motor.real[0] >= 0 else -1
        return [*(2 * sign * part for part in motor.real[1:]), *translation(motor)]

    return residual


def _turn(axis: np.ndarray, angle: Number, advance: Number) -> Motor:
    """The turn by an ``angle`` (rad) about an axis (3,) through the origin."""
    half = mpmath.mpf(angle) / 2
    return turn(axis, ORIGIN, mpmath.cos(half), mpmath.sin(half), advance)
