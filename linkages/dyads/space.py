"""Dyads in space: two bodies, three joints that turn, about axes that are not parallel.

The axis between both bodies keeps its angles with the axes on which they stand: it lies
on two cones, which meet in two lines at most. In general the bodies do not meet then;
on a sphere and in overconstrained loops they do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_degenerate_dyad
from linkages.dyads.geometry import (
    MISFIT,
    TOUCHING,
    DegenerateDyadError,
)
from linkages.mechanisms.joint import Motion, transforms

# Orthonormal vectors in rows: a sphere is projected from the point opposite to the third
# one, any where no axis is likely to be.
PROJECTED = np.linalg.qr(np.random.default_rng(28).normal(size=(3, 3)))[0]


class SpacePose(NamedTuple):
    """A displacement that takes x (3,) to ``rotation`` (3, 3) x + ``shift`` (3,)."""

    rotation: np.ndarray
    shift: np.ndarray

    def __call__(self, place: np.ndarray) -> np.ndarray:
        """Where a place (3,) is taken."""
        moved: np.ndarray = self.rotation @ place + self.shift
        return moved

    def after(self, other: SpacePose) -> SpacePose:
        """The displacement that does the ``other`` one first."""
        return SpacePose(self.rotation @ other.rotation, self(other.shift))

    def inverse(self) -> SpacePose:
        """The displacement back."""
        back = self.rotation.T
        return SpacePose(back, -back @ self.shift)


class _Line(NamedTuple):
    """A point of an axis, and its direction (3,)."""

    point: np.ndarray
    direction: np.ndarray


class Axis(NamedTuple):
    """A joint: its axis in the ``first`` body, or on what stands, and in the ``second``
    one."""

    first: _Line
    second: _Line


class SpaceGeometry:
    """Bodies that turn about axes in space, on a sphere if all of these pass through a
    ``center`` (3,); ``size`` is a length of the mechanism."""

    is_spherical = True  # where larger groups are held by pins

    def __init__(self, size: float, center: np.ndarray | None = None):
        self.size = size
        self.center = center
        self.rest = SpacePose(np.eye(3), np.zeros(3))

    def motion(self, motion: Motion, value: float) -> SpacePose:
        """The displacement that a joint variable makes."""
        (transform,) = transforms(motion, np.array([value]))
        return SpacePose(transform[:3, :3], transform[:3, 3])

    def value(self, relative: SpacePose, motion: Motion) -> float:
        """The variable, between -pi and pi, that makes a displacement."""
        turn = relative.rotation
        skew = (
            turn[2, 1] - turn[1, 2],
            turn[0, 2] - turn[2, 0],
            turn[1, 0] - turn[0, 1],
        )
        double_sine = float(motion.direction @ skew)
        double_cosine = float(turn[0, 0] + turn[1, 1] + turn[2, 2]) - 1.0
        return math.atan2(double_sine, double_cosine)

    def joint(self, first: SpacePose, second: SpacePose, motion: Motion) -> Axis:
        """A joint between a body with the pose ``first``, which stands or is in one
        part, and one that has the pose ``second`` in the part that is placed."""
        lines = [
            _Line(pose(motion.point), pose.rotation @ motion.direction)
            for pose in (first, second)
        ]
        return Axis(*lines)

    # --- pins on a sphere -------------------------------------------------------------

    @property
    def has_pins(self) -> bool:
        """Whether axes are places on a sphere."""
        return self.center is not None

    def pin(self, pose: SpacePose, motion: Motion) -> complex:
        """The place of the axis of a body with this ``pose`` on the unit sphere, in
        stereographic projection."""
        x, y, z = PROJECTED @ (pose.rotation @ motion.direction)
        return complex(x, y) / float(1.0 + z)

    def held_by_pins(
        self, own: Sequence[complex], there: Sequence[complex]
    ) -> SpacePose:
        """The pose of a body with two places of its ``own`` at others. Raises
        `DegenerateDyadError` where they are one axis."""
        before, after = (
            _frame(*(_on_sphere(place) for place in places)) for places in (own, there)
        )
        rotation = after @ before.T
        center = self.center
        assert center is not None
        return SpacePose(rotation, center - rotation @ center)

    # --- dyads ------------------------------------------------------------------------

    def close_monad(self, one: Axis, other: Axis) -> list[SpacePose]:
        """The poses of a part that two joints hold; none where they do not fit. Raises
        `DegenerateDyadError`."""
        far, own = _between(one.first, other.first), _between(one.second, other.second)
        pose = _placed(one, own, far)
        aside = np.abs(pose(other.second.point) - other.first.point).max()
        turned = pose.rotation @ other.second.direction - other.first.direction
        fits = max(float(aside) / self.size, float(np.abs(turned).max())) <= MISFIT
        return [pose] if fits else []

    def close_dyad(
        self, one: Axis, pin: Axis, other: Axis
    ) -> list[tuple[SpacePose, SpacePose]]:
        """The poses of both parts of a dyad, in every way in which it closes. Raises
        `DegenerateDyadError`, also where its axes are parallel."""
        results = []
        for along in self._directions(one, pin, other):
            first = _placed(one, pin.first.direction, along)
            second = _placed(other, pin.second.direction, along)
            gap = np.abs(first(pin.first.point) - second(pin.second.point)).max()
            if gap <= MISFIT * self.size:
                results.append((first, second))
        return results

    def _directions(self, one: Axis, pin: Axis, other: Axis) -> list[np.ndarray]:
        """Unit vectors (3,) along the axis between both parts."""
        start, end = one.first.direction, other.first.direction
        cosines = _cosines(one, pin, other)
        across = _cross(start, end)
        square = float(across @ across)
        if is_degenerate_dyad(math.sqrt(square)):
            gap = abs(cosines[0] - math.copysign(1.0, start @ end) * cosines[1])
            if is_degenerate_dyad(gap):
                raise DegenerateDyadError
            return []
        between = float(start @ end)
        along = (cosines[0] - between * cosines[1]) * start
        along = (along + (cosines[1] - between * cosines[0]) * end) / square
        height = (1.0 - float(along @ along)) / square
        if height < -TOUCHING:
            return []
        root = math.sqrt(max(height, 0.0))
        roots = (root, -root) if root > 0.0 else (0.0,)
        return [along + sign * across for sign in roots]

    def leaves_loose(self, one: Axis, other: Axis) -> bool:
        """Whether a part may move on two joints that hold it on what stands: they have
        one axis."""
        own = _between(one.second, other.second)
        across = _length(_cross(one.second.direction, own))
        return is_degenerate_dyad(across / max(_length(own), 1e-300))

    def may_be_degenerate(self, one: Axis, pin: Axis, other: Axis) -> bool:
        """Whether a dyad may close in a whole curve of configurations somewhere."""
        first, second = _cosines(one, pin, other)
        first, second = abs(first), abs(second)
        most = min(max(first, second), 1.0)
        sine = math.sqrt(1.0 - most * most)
        return is_degenerate_dyad(min(abs(first - second), sine))


def _on_sphere(place: complex) -> np.ndarray:
    """The unit vector (3,) with this place in the projection."""
    square = abs(place) ** 2
    vector: np.ndarray = (
        np.array([2.0 * place.real, 2.0 * place.imag, 1.0 - square]) / (1.0 + square)
    ) @ PROJECTED
    return vector


def _cosines(one: Axis, pin: Axis, other: Axis) -> tuple[float, float]:
    """Those of the angles between the axes of each body."""
    first = float(one.second.direction @ pin.first.direction)
    second = float(other.second.direction @ pin.second.direction)
    return first, second


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The cross product of two vectors (3,); that of numpy takes ten times as long."""
    ax, ay, az = a
    bx, by, bz = b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _length(vector: np.ndarray) -> float:
    return math.sqrt(float(vector @ vector))


def _placed(axis: Axis, own: np.ndarray, standing: np.ndarray) -> SpacePose:
    """The pose of a body on an axis, with a vector (3,) of its ``own`` as near as can be
    to a ``standing`` one. Raises `DegenerateDyadError` where one is along the axis."""
    frame = _frame(axis.first.direction, standing)
    rotation: np.ndarray = frame @ _frame(axis.second.direction, own).T
    return SpacePose(rotation, axis.first.point - rotation @ axis.second.point)


def _between(one: _Line, other: _Line) -> np.ndarray:
    """A vector (3,) across the first axis that goes with both: the other direction, or,
    where that is the same, the way to the other axis."""
    across = _cross(one.direction, other.direction)
    is_parallel = is_degenerate_dyad(_length(across))
    way: np.ndarray = other.point - one.point
    return way if is_parallel else other.direction


def _frame(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Unit vectors (3, 3), in columns: along the first vector, and across it towards
    the second one."""
    across = second - (second @ first) * first
    length = _length(across)
    if is_degenerate_dyad(length / max(_length(second), 1e-300)):
        raise DegenerateDyadError
    across = across / length
    return np.array([first, across, _cross(first, across)]).T
