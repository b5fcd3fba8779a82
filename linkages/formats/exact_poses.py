"""Poses with exact places, so that coordinates far from the origin lose no digits.

Files of other programs give places as products of poses. Numbers are taken as the
decimals that are written, sums are exact, and a turn is that of the doubles of its
matrix. Where the joints of a model are far from its origin, they are counted from one
of them (`linkages.mechanisms.origin`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from linkages.coordinates import are_near_origin, spread_of
from linkages.mechanisms.joint import Vector
from linkages.mechanisms.origin import exact_number, rounding_of_number

ExactPlace: TypeAlias = tuple[Fraction, Fraction, Fraction]
ZERO: ExactPlace = (Fraction(0), Fraction(0), Fraction(0))
EPSILON = float(np.finfo(float).eps)
REACH = 8.0  # of the spread of joints: farther away a slide is not drawn


@dataclass(frozen=True, eq=False)
class ExactPose:
    """A ``rotation`` (3, 3) and a ``place``; this may be off by ``rounding``, as
    decimals were doubles, and as matrices are."""

    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    place: ExactPlace = ZERO
    rounding: float = 0.0

    @classmethod
    def at(
        cls, numbers: Sequence[float], rotation: np.ndarray | None = None
    ) -> ExactPose:
        """The pose at three numbers of a file, without a turn where none is given."""
        x, y, z = (exact_number(number) for number in numbers)
        rounding = max(rounding_of_number(number) for number in numbers)
        turn = np.eye(3) if rotation is None else rotation
        return cls(turn, (x, y, z), rounding)

    def __matmul__(self, other: ExactPose) -> ExactPose:
        x, y, z = (
            own + turned
            for own, turned in zip(self.place, self._turned(other.place), strict=True)
        )
        rounding = max(self.rounding, other.rounding, self._lost(other.place))
        return ExactPose(self.rotation @ other.rotation, (x, y, z), rounding)

    def inverse(self) -> ExactPose:
        """The pose that leads back."""
        back = ExactPose(self.rotation.T)
        x, y, z = (-turned for turned in back._turned(self.place))
        rounding = max(self.rounding, back._lost(self.place))
        return ExactPose(back.rotation, (x, y, z), rounding)

    def matrix(self) -> np.ndarray:
        """The transform (4, 4) in doubles."""
        result = np.eye(4)
        result[:3, :3] = self.rotation
        result[:3, 3] = [float(number) for number in self.place]
        return result

    def _turned(self, place: ExactPlace) -> ExactPlace:
        if np.array_equal(self.rotation, np.eye(3)):
            return place
        rows = [[Fraction(entry) for entry in row] for row in self.rotation.tolist()]
        x, y, z = (
            sum((a * b for a, b in zip(row, place, strict=True)), Fraction(0))
            for row in rows
        )
        return (x, y, z)

    def _lost(self, place: ExactPlace) -> float:
        """How far off a place is after a turn, whose entries are rounded."""
        if np.all(np.isin(self.rotation, (-1.0, 0.0, 1.0))):
            return 0.0
        return EPSILON * max(abs(float(number)) for number in place)


@dataclass(frozen=True)
class Origin:
    """The ``place`` in a model from which its places are counted; None where they are
    as they are written. Its joints are no farther from there than ``reach``."""

    place: ExactPlace | None = None
    reach: float = np.inf

    @property
    def pose(self) -> ExactPose:
        """The pose of the model."""
        x, y, z = self.place or ZERO
        return ExactPose(place=(-x, -y, -z))

    @property
    def vector(self) -> Vector:
        """The place in doubles."""
        x, y, z = self.place or ZERO
        return (float(x), float(y), float(z))

    @classmethod
    def near(cls, places: Sequence[ExactPlace]) -> Origin:
        """The origin from which the ``places`` of joints are counted: the first of
        them, where they are far from that of the model beside their own spread."""
        if not places:
            return cls()
        numbers = np.array([[float(number) for number in place] for place in places])
        if are_near_origin(numbers):
            return cls()
        return cls(places[0], REACH * spread_of(numbers))

    def place_of_slide(self, pose: ExactPose) -> np.ndarray:
        """Where a slide at a ``pose`` is drawn (3,): there, or at the origin where that
        is far from all joints."""
        point: np.ndarray = pose.matrix()[:3, 3]
        is_far = float(np.abs(point).max()) > self.reach
        return np.zeros(3) if is_far else point

    def frame(self, pose: ExactPose) -> np.ndarray:
        """The frame (4, 4) in which the joints of a body at a ``pose`` are written: that
        of the body, or, as this may be far from them, the turned one at the origin."""
        if self.place is None:
            return pose.matrix()
        return ExactPose(pose.rotation).matrix()
