"""Dyads: two bodies in a plane, joined to each other, and each to something that
stands.

Of the three joints each turns or slides; at most two configurations close (Artobolevsky
1975, groups of the second class). What stands leaves a point of a body a circle or a
line, and these meet at two points at most.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_degenerate_dyad
from linkages.mechanisms.joint import Motion
from linkages.structure.placement import axes_along

# of the square of a length, over that of the mechanism: a circle that is touched. It
# costs starts only: what does not close is left out later.
TOUCHING = 1e-9
MISFIT = 1e-5  # of the distance of two joints on a body: they do not fit


class DegenerateDyadError(ArithmeticError):
    """A dyad closes in a whole curve of configurations."""


class PlanePose(NamedTuple):
    """A displacement that takes z to ``turn`` z + ``shift``; ``turn`` is a unit
    number."""

    turn: complex
    shift: complex

    def __call__(self, place: complex) -> complex:
        """Where a place is taken."""
        return self.turn * place + self.shift

    def after(self, other: PlanePose) -> PlanePose:
        """The displacement that does the ``other`` one first."""
        return PlanePose(self.turn * other.turn, self(other.shift))

    def inverse(self) -> PlanePose:
        """The displacement back."""
        return PlanePose(1 / self.turn, -self.shift / self.turn)


AT_REST = PlanePose(1 + 0j, 0j)


class Circle(NamedTuple):
    """A circle."""

    center: complex
    radius: float


class Line(NamedTuple):
    """A line from a ``start`` ``along`` a unit direction."""

    start: complex
    along: complex


class Pivot(NamedTuple):
    """A turning joint: its point in the ``first`` body, or its place on what stands,
    and its point in the ``second`` body."""

    first: complex
    second: complex

    def path(self, point: complex) -> Circle:
        """Where a point of the second body may be."""
        return Circle(self.first, abs(point - self.second))

    def pose(self, point: complex, place: complex) -> PlanePose:
        """The pose of the second body with a point of it in a place on its path."""
        ratio = (place - self.first) / (point - self.second)
        return self.turned(ratio / abs(ratio))

    def turned(self, turn: complex) -> PlanePose:
        """The pose of the second body with this ``turn``."""
        return PlanePose(turn, self.first - turn * self.second)

    def reversed(self) -> Pivot:
        """The joint as the other body sees it."""
        return Pivot(self.second, self.first)


class Rail(NamedTuple):
    """A sliding joint: the pose of the second body in the first one, or on what stands,
    at its ``start``, from which it slides ``along`` a unit direction of that."""

    start: PlanePose
    along: complex

    def path(self, point: complex) -> Line:
        """Where a point of the second body may be."""
        return Line(self.start(point), self.along)

    def pose(self, point: complex, place: complex) -> PlanePose:
        """The pose of the second body with a point of it in a place on its path."""
        return PlanePose(self.start.turn, place - self.start.turn * point)

    def reversed(self) -> Rail:
        """The joint as the other body sees it."""
        inverse = self.start.inverse()
        return Rail(inverse, -inverse.turn * self.along)


PlaneJoint: TypeAlias = Pivot | Rail
Poses: TypeAlias = list[tuple[PlanePose, PlanePose]]


class PlaneGeometry:
    """Bodies that turn and slide in the plane across ``normal`` (3,); ``size`` is a
    length of the mechanism."""

    has_pins = True  # larger groups are held by pins that have places in the plane
    is_spherical = False

    def __init__(self, normal: np.ndarray, size: float):
        self.normal = normal
        self.size = size
        self.rest = AT_REST
        self._axes = axes_along(normal)[:2]

    def motion(self, motion: Motion, value: float) -> PlanePose:
        """The displacement that a joint variable makes."""
        if not motion.is_turn:
            return PlanePose(1 + 0j, value * self._flat(motion.direction))
        turn = cmath.exp(1j * value * self._sense(motion))
        center = self._flat(motion.point)
        return PlanePose(turn, center - turn * center)

    def value(self, relative: PlanePose, motion: Motion) -> float:
        """The variable, an angle between -pi and pi, that makes a displacement."""
        if motion.is_turn:
            return cmath.phase(relative.turn) * self._sense(motion)
        return (relative.shift / self._flat(motion.direction)).real

    def joint(self, first: PlanePose, second: PlanePose, motion: Motion) -> PlaneJoint:
        """A joint between a body with the pose ``first``, which stands or is in one
        part, and one that has the pose ``second`` in the part that is placed."""
        if motion.is_turn:
            center = self._flat(motion.point)
            return Pivot(first(center), second(center))
        along = first.turn * self._flat(motion.direction)
        return Rail(first.after(second.inverse()), along)

    # --- pins -------------------------------------------------------------------------

    def pin(self, pose: PlanePose, motion: Motion) -> complex:
        """The place of a turning joint of a body with this ``pose``."""
        return pose(self._flat(motion.point)) / self.size

    def held_by_pins(
        self, own: Sequence[complex], there: Sequence[complex]
    ) -> PlanePose:
        """The pose of a body with two places of its ``own`` at others."""
        turn = (there[1] - there[0]) / (own[1] - own[0])
        turn /= abs(turn)
        return PlanePose(turn, self.size * (there[0] - turn * own[0]))

    def _sense(self, motion: Motion) -> float:
        """1 where a turn is about the normal, -1 where it is the other way round."""
        return 1.0 if motion.direction @ self.normal > 0 else -1.0

    def _flat(self, vector: np.ndarray) -> complex:
        """A vector (3,) in the plane."""
        x, y = self._axes @ vector
        return complex(x, y)

    # --- one body and two bodies ------------------------------------------------------

    def close_monad(self, one: PlaneJoint, other: PlaneJoint) -> list[PlanePose]:
        """The poses of a body that two joints hold on what stands; none where they do
        not fit. Raises `DegenerateDyadError`."""
        if isinstance(one, Pivot) and isinstance(other, Pivot):
            gap, own = other.first - one.first, other.second - one.second
            self._require_length(abs(own))
            if abs(abs(gap) - abs(own)) > MISFIT * self.size:
                return []
            return [one.pose(other.second, other.first)]
        if isinstance(one, Rail) and isinstance(other, Rail):
            if abs(one.start.turn - other.start.turn) > MISFIT:
                return []
            (place,) = self._meetings(one.path(0j), other.path(0j))
            return [one.pose(0j, place)]
        if isinstance(one, Pivot):
            one, other = other, one
        assert isinstance(one, Rail) and isinstance(other, Pivot)
        pose = other.turned(one.start.turn)
        beside = ((pose.shift - one.start.shift) / one.along).imag
        return [pose] if abs(beside) <= MISFIT * self.size else []

    def close_dyad(
        self, one: PlaneJoint, middle: PlaneJoint, other: PlaneJoint
    ) -> Poses:
        """The poses of both bodies of a dyad, in every configuration that closes.
        Raises `DegenerateDyadError`."""
        if isinstance(middle, Pivot):
            paths = one.path(middle.first), other.path(middle.second)
            return [
                (one.pose(middle.first, place), other.pose(middle.second, place))
                for place in self._meetings(*paths)
            ]
        if isinstance(one, Rail):
            swapped = self.close_dyad(other, middle.reversed(), one)
            return [(first, second) for second, first in swapped]
        if isinstance(other, Rail):
            first = one.turned(other.start.turn / middle.start.turn)
            path = Line(first.after(middle.start).shift, first.turn * middle.along)
            (place,) = self._meetings(path, other.path(0j))
            return [(first, other.pose(0j, place))]
        return self._sliding(one, middle, other)

    def _sliding(self, one: Pivot, slider: Rail, other: Pivot) -> Poses:
        """The same of two bodies that slide along each other, on two pivots."""
        gap = other.first - one.first
        # the far pivot, as the first body sees it
        circle = Circle(one.second, abs(gap))
        line = slider.path(other.second)
        results = []
        for place in self._meetings(circle, line):
            first = one.pose(place, other.first)
            shift = slider.start.shift + place - line.start
            results.append((first, first.after(PlanePose(slider.start.turn, shift))))
        return results

    def leaves_loose(self, one: PlaneJoint, other: PlaneJoint) -> bool:
        """Whether a body may move on two joints that hold it on what stands."""
        if isinstance(one, Pivot) and isinstance(other, Pivot):
            return self._is_nothing(abs(other.second - one.second))
        return isinstance(one, Rail) and isinstance(other, Rail)

    def may_be_degenerate(
        self, one: PlaneJoint, middle: PlaneJoint, other: PlaneJoint
    ) -> bool:
        """Whether a dyad may close in a whole curve of configurations somewhere; what
        the joints stand on may be anywhere."""
        if isinstance(one, Rail) and isinstance(other, Pivot):
            return self.may_be_degenerate(other, middle.reversed(), one)
        if isinstance(other, Rail):
            if isinstance(one, Rail) or isinstance(middle, Rail):
                return True  # two lines may be one
            # a circle and a line never are, if there is a circle
            return self._is_nothing(abs(middle.first - one.second))
        assert isinstance(one, Pivot)
        if isinstance(middle, Pivot):
            arms = abs(middle.first - one.second), abs(middle.second - other.second)
            return self._is_nothing(min(*arms, abs(arms[0] - arms[1])))
        beside = ((middle.start(other.second) - one.second) / middle.along).imag
        return self._is_nothing(abs(beside))

    # --- circles and lines ------------------------------------------------------------

    def _meetings(self, one: Circle | Line, other: Circle | Line) -> list[complex]:
        """Where two paths meet. Raises `DegenerateDyadError` where they do all along,
        and where a circle about the same point as another path is one point."""
        if isinstance(one, Line):
            if isinstance(other, Circle):
                return self._meetings(other, one)
            return [_crossing(one, other)]
        if isinstance(other, Line):
            return self._on_line(one, other)
        self._require_length(min(one.radius, other.radius))
        gap = other.center - one.center
        distance = abs(gap)
        if self._is_nothing(distance):
            self._require_length(abs(one.radius - other.radius))
            return []
        squares = distance**2 + one.radius**2 - other.radius**2
        along = squares / (2 * distance)
        return [
            one.center + gap / distance * complex(along, height)
            for height in self._roots(one.radius**2 - along**2)
        ]

    def _on_line(self, circle: Circle, line: Line) -> list[complex]:
        """Where a circle meets a line."""
        offset = (line.start - circle.center) / line.along  # in a frame along the line
        if self._is_nothing(circle.radius):
            self._require_length(abs(offset.imag))
            return []
        return [
            circle.center + line.along * complex(root, offset.imag)
            for root in self._roots(circle.radius**2 - offset.imag**2)
        ]

    def _roots(self, square: float) -> list[float]:
        if square < -TOUCHING * self.size**2:
            return []
        root = math.sqrt(max(square, 0.0))
        return [root, -root] if root > 0 else [0.0]

    def _is_nothing(self, length: float) -> bool:
        return is_degenerate_dyad(length / self.size)

    def _require_length(self, length: float) -> None:
        if self._is_nothing(length):
            raise DegenerateDyadError


def _crossing(one: Line, other: Line) -> complex:
    """Where two lines meet. Raises `DegenerateDyadError` where they are parallel."""
    sine = (one.along.conjugate() * other.along).imag
    if is_degenerate_dyad(abs(sine)):
        raise DegenerateDyadError
    way = ((other.start - one.start).conjugate() * other.along).imag / sine
    return one.start + way * one.along
