"""The closure of a loop over mpmath numbers: the residual of `linkages.closure.kernels`
at any precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath

from linkages.loop import Loop

__all__ = ["precise_residual"]


def precise_residual(loop: Loop) -> Callable[[Sequence[Any]], list[Any]]:
    """The six closure equations of a loop as a function of its n joint angles (rad),
    mpmath numbers.

    The same equations as `linkages.closure.loop_closure.LoopClosure.residuals`: (2
    sign(q_0) q_v, p / characteristic length), with q the quaternion and p the
    translation of the loop product. Floats in the geometry are taken as exact.
    """
    size = mpmath.mpf(loop.characteristic_length)
    lengths, twists, offsets = (
        [mpmath.mpf(x) for x in v] for v in (loop.lengths, loop.twists, loop.offsets)
    )
    links = [
        (a / size, r / size, mpmath.cos(alpha / 2), mpmath.sin(alpha / 2))
        for a, alpha, r in zip(lengths, twists, offsets, strict=True)
    ]

    def residual(theta: Sequence[Any]) -> list[Any]:
        q = (mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0))
        p = [mpmath.mpf(0)] * 3
        for angle, (length, offset, cosine, sine) in zip(theta, links, strict=True):
            c, s = mpmath.cos(angle / 2), mpmath.sin(angle / 2)
            q = (
                q[0] * c - q[3] * s,
                q[1] * c + q[2] * s,
                q[2] * c - q[1] * s,
                q[3] * c + q[0] * s,
            )
            x, z = _axes(q)
            p = [p[i] + offset * z[i] + length * x[i] for i in range(3)]
            q = (
                q[0] * cosine - q[1] * sine,
                q[1] * cosine + q[0] * sine,
                q[2] * cosine + q[3] * sine,
                q[3] * cosine - q[2] * sine,
            )
        sign = 1 if q[0] >= 0 else -1
        return [2 * sign * q[1], 2 * sign * q[2], 2 * sign * q[3], *p]

    return residual


def _axes(q: tuple[Any, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The first and the third column of the rotation of a unit quaternion."""
    w, x, y, z = q
    first = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
    third = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    return first, third
