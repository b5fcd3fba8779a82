"""The closure of a loop over mpmath numbers: the residual of `linkages.closure.kernels`
at any precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import mpmath

from linkages.kinematics import Number
from linkages.loop import Loop


class Quaternion(NamedTuple):
    """The unit quaternion w + x i + y j + z k of a rotation."""

    w: Number
    x: Number
    y: Number
    z: Number

    def turned_about_x(self, cosine: Number, sine: Number) -> Quaternion:
        """The rotation, and after it one about its own x axis, by cosine and sine of
        half the angle."""
        w, x, y, z = self
        return Quaternion(
            w * cosine - x * sine,
            x * cosine + w * sine,
            y * cosine + z * sine,
            z * cosine - y * sine,
        )

    def turned_about_z(self, cosine: Number, sine: Number) -> Quaternion:
        """The rotation, and after it one about its own z axis, by cosine and sine of
        half the angle."""
        w, x, y, z = self
        return Quaternion(
            w * cosine - z * sine,
            x * cosine + y * sine,
            y * cosine - x * sine,
            z * cosine + w * sine,
        )

    def x_axis(self) -> tuple[Number, Number, Number]:
        """The first column of the rotation."""
        w, x, y, z = self
        return 1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)

    def z_axis(self) -> tuple[Number, Number, Number]:
        """The third column of the rotation."""
        w, x, y, z = self
        return 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)


class Link(NamedTuple):
    """A link: length and offset in characteristic lengths, cosine and sine of half its
    twist."""

    length: Number
    offset: Number
    cosine: Number
    sine: Number


def precise_residual(loop: Loop) -> Callable[[Sequence[Number]], list[Number]]:
    """The six closure equations of a loop as a function of its n joint angles (rad),
    mpmath numbers.

    The same equations as `linkages.closure.loop_closure.LoopClosure.residuals`: (2
    sign(q_0) q_v, p / characteristic length), with q the quaternion and p the
    translation of the loop product. Floats in the geometry are taken as exact.
    """
    links = _links(loop)

    def residual(theta: Sequence[Number]) -> list[Number]:
        zero = mpmath.mpf(0)
        rotation = Quaternion(mpmath.mpf(1), zero, zero, zero)
        translation = [zero, zero, zero]
        for angle, link in zip(theta, links, strict=True):
            half = angle / 2
            rotation = rotation.turned_about_z(mpmath.cos(half), mpmath.sin(half))
            x_axis = rotation.x_axis()
            z_axis = rotation.z_axis()
            for k in range(3):
                along = translation[k] + link.offset * z_axis[k]
                translation[k] = along + link.length * x_axis[k]
            rotation = rotation.turned_about_x(link.cosine, link.sine)
        sign = 1 if rotation.w >= 0 else -1
        vector = (rotation.x, rotation.y, rotation.z)
        return [*(2 * sign * part for part in vector), *translation]

    return residual


def _links(loop: Loop) -> list[Link]:
    size = mpmath.mpf(loop.characteristic_length)
    links = []
    for i in range(loop.n):
        length = mpmath.mpf(loop.lengths[i]) / size
        offset = mpmath.mpf(loop.offsets[i]) / size
        half_twist = mpmath.mpf(loop.twists[i]) / 2
        cosine, sine = mpmath.cos(half_twist), mpmath.sin(half_twist)
        links.append(Link(length, offset, cosine, sine))
    return links
