"""The axes in which the equations of a chain are written.

Where all turns of a chain are about parallel axes, or about axes through one point, the
frame is laid along them and what is zero is set to zero: three of six equations then
vanish by themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkages.decisions import is_parallel_axis, meets_in_one_point
from linkages.mechanisms.joint import Motion


@dataclass(frozen=True)
class Placement:
    """A frame with its ``origin`` (3,) and unit vectors ``axes`` (3, 3), in rows, in
    which lengths are counted in a ``unit``.

    ``is_planar``: all turns are about the third axis; ``is_spherical``: all are about
    axes through the origin.
    """

    origin: np.ndarray
    axes: np.ndarray
    unit: float
    is_planar: bool = False
    is_spherical: bool = False

    @staticmethod
    def of_chain(motions: Sequence[Motion], unit: float) -> Placement:
        """The frame for a chain of these ``motions``; lengths in the ``unit``."""
        turns = [motion for motion in motions if motion.is_turn]
        if not turns:
            return Placement(np.zeros(3), np.eye(3), unit)
        points = np.array([motion.point for motion in turns])
        directions = np.array([motion.direction for motion in turns])
        origin = points.mean(axis=0)
        sines = np.linalg.norm(np.cross(directions[0], directions), axis=1)
        if np.all(is_parallel_axis(sines)):
            return Placement(origin, axes_along(directions[0]), unit, is_planar=True)
        center = _nearest_point(points, directions)
        distances = np.linalg.norm(np.cross(center - points, directions), axis=1)
        if np.all(meets_in_one_point(distances, unit)):
            return Placement(center, np.eye(3), unit, is_spherical=True)
        return Placement(origin, np.eye(3), unit)

    def direction(self, motion: Motion) -> np.ndarray:
        """The direction (3,) of a motion in these axes."""
        along: np.ndarray = self.axes @ motion.direction
        if not self.is_planar:
            return along
        if is_parallel_axis(float(np.linalg.norm(along[:2]))):
            return np.array([0.0, 0.0, np.sign(along[2])])
        if is_parallel_axis(abs(float(along[2]))):
            along[2] = 0.0
            along /= np.linalg.norm(along)
        return along

    def point(self, place: np.ndarray) -> np.ndarray:
        """A place (3,) in this frame, in its unit."""
        coordinates: np.ndarray = self.axes @ (place - self.origin) / self.unit
        return coordinates

    def point_on_axis(self, motion: Motion) -> np.ndarray:
        """A point (3,) of the axis of a turn in this frame, in its unit."""
        if self.is_spherical:
            return np.zeros(3)
        point = self.point(motion.point)
        if self.is_planar:
            point[2] = 0.0
        return point


def axes_along(direction: np.ndarray) -> np.ndarray:
    """Right-handed unit vectors (3, 3), the third one along ``direction`` (3,)."""
    other = np.eye(3)[np.argmin(np.abs(direction))]
    first = np.cross(other, direction)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(direction, first), direction])


def _nearest_point(points: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """The point (3,) nearest to lines through ``points`` (k, 3) along unit
    ``directions`` (k, 3), by least squares."""
    across = np.eye(3) - directions[:, :, None] * directions[:, None, :]
    feet = np.einsum("kij,kj->ki", across, points)
    solution: np.ndarray = np.linalg.lstsq(
        across.reshape(-1, 3), feet.ravel(), rcond=None
    )[0]
    return solution
