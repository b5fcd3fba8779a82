"""Dyads: two bodies in a plane, joined to each other, and each to something that
stands.

Of the three joints each turns or slides; at most two configurations close (Artobolevsky
1975, groups of the second class). Where a circle meets a circle or a line, it is at two
points or at none.
"""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple, TypeAlias

import numpy as np

from linkages.decisions import is_degenerate_dyad
from linkages.dyads.poses import AT_REST, PlanePose
from linkages.mechanisms.joint import Motion

# of the square of a length, over that of the mechanism: a circle that is touched. It
# costs starts only: what does not close is left out later.
TOUCHING = 1e-9
MISFIT = 1e-5  # of the distance of two joints on a body: they do not fit


class Pivot(NamedTuple):
    """A turning joint on what stands: its ``place`` there, and its point ``local`` in
    the body."""

    place: complex
    local: complex


class Rail(NamedTuple):
    """A sliding joint on what stands: the ``pose`` of the body from which it slides
    ``along`` a unit direction."""

    pose: PlanePose
    along: complex


class Pin(NamedTuple):
    """A turning joint between both bodies: its points in them."""

    first: complex
    second: complex


class Slider(NamedTuple):
    """A sliding joint between both bodies: the ``pose`` of the second one in the first,
    from which it slides ``along`` a unit direction of the first."""

    pose: PlanePose
    along: complex


End: TypeAlias = Pivot | Rail
Middle: TypeAlias = Pin | Slider
Poses: TypeAlias = list[tuple[PlanePose, PlanePose]]


class DegenerateDyadError(ArithmeticError):
    """A dyad closes in a whole curve of configurations."""


class PlaneGeometry:
    """Bodies that turn and slide in the plane across ``normal`` (3,); ``size`` is a
    length of the mechanism."""

    def __init__(self, normal: np.ndarray, size: float):
        self.normal = normal
        self.size = size
        self.rest = AT_REST
        other = np.eye(3)[np.argmin(np.abs(normal))]
        first = np.cross(other, normal)
        first /= np.linalg.norm(first)
        self._axes = np.array([first, np.cross(normal, first)])

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

    def end(self, pose: PlanePose, own: PlanePose, motion: Motion) -> End:
        """A joint on a standing body with this ``pose``, of a body that has the pose
        ``own`` in the part that is placed."""
        if motion.is_turn:
            center = self._flat(motion.point)
            return Pivot(pose(center), own(center))
        along = pose.turn * self._flat(motion.direction)
        return Rail(pose.after(own.inverse()), along)

    def middle(self, first: PlanePose, second: PlanePose, motion: Motion) -> Middle:
        """A joint between bodies that have these poses in two parts."""
        if motion.is_turn:
            center = self._flat(motion.point)
            return Pin(first(center), second(center))
        along = first.turn * self._flat(motion.direction)
        return Slider(first.after(second.inverse()), along)

    def close_monad(self, one: End, other: End) -> list[PlanePose]:
        """As the function of this name."""
        return close_monad(one, other, self.size)

    def close_dyad(self, one: End, middle: Middle, other: End) -> Poses:
        """As the function of this name."""
        return close_dyad(one, middle, other, self.size)

    def may_be_degenerate(self, one: End, middle: Middle, other: End) -> bool:
        """As the function of this name."""
        return may_be_degenerate(one, middle, other, self.size)

    def _sense(self, motion: Motion) -> float:
        """1 where a turn is about the normal, -1 where it is the other way round."""
        return 1.0 if motion.direction @ self.normal > 0 else -1.0

    def _flat(self, vector: np.ndarray) -> complex:
        """A vector (3,) in the plane."""
        x, y = self._axes @ vector
        return complex(x, y)


# --- one body -------------------------------------------------------------------------


def close_monad(one: End, other: End, size: float) -> list[PlanePose]:
    """The poses of a body that two joints hold on what stands; none where they do not
    fit. ``size`` is a length of the mechanism. Raises `DegenerateDyadError`."""
    if isinstance(one, Pivot) and isinstance(other, Pivot):
        gap, own = other.place - one.place, other.local - one.local
        if is_degenerate_dyad(abs(own) / size):
            raise DegenerateDyadError
        if abs(abs(gap) - abs(own)) > MISFIT * size:
            return []
        return [_placed(gap / own / abs(gap / own), one)]
    if isinstance(one, Rail) and isinstance(other, Rail):
        if abs(one.pose.turn - other.pose.turn) > MISFIT:
            return []
        start, end = one.pose.shift, other.pose.shift
        where = _meeting(start, one.along, end, other.along)
        return [PlanePose(one.pose.turn, where)]
    if isinstance(one, Pivot):
        one, other = other, one
    assert isinstance(one, Rail) and isinstance(other, Pivot)
    pose = _placed(one.pose.turn, other)
    beside = ((pose.shift - one.pose.shift) / one.along).imag
    return [pose] if abs(beside) <= MISFIT * size else []


def _placed(turn: complex, pivot: Pivot) -> PlanePose:
    """The pose of a body with this ``turn`` on a pivot."""
    return PlanePose(turn, pivot.place - turn * pivot.local)


# --- two bodies -----------------------------------------------------------------------


def close_dyad(one: End, middle: Middle, other: End, size: float) -> Poses:
    """The poses of both bodies of a dyad, in every configuration that closes. ``size``
    is a length of the mechanism. Raises `DegenerateDyadError`."""
    if isinstance(one, Rail) and isinstance(other, Pivot):
        swapped = close_dyad(other, _reversed(middle), one, size)
        return [(first, second) for second, first in swapped]
    if isinstance(middle, Pin):
        return _pinned(one, middle, other, size)
    return _sliding(one, middle, other, size)


def _reversed(middle: Middle) -> Middle:
    """The joint as the other body sees it."""
    if isinstance(middle, Pin):
        return Pin(middle.second, middle.first)
    inverse = middle.pose.inverse()
    return Slider(inverse, -inverse.turn * middle.along)


def _pinned(one: End, pin: Pin, other: End, size: float) -> Poses:
    if isinstance(one, Pivot) and isinstance(other, Pivot):
        arms = pin.first - one.local, pin.second - other.local
        if is_degenerate_dyad(min(abs(arms[0]), abs(arms[1])) / size):
            raise DegenerateDyadError  # a body on one axis turns freely
        places = _circles(one.place, abs(arms[0]), other.place, abs(arms[1]), size)
        return [
            (
                _placed(_unit((place - one.place) / arms[0]), one),
                _placed(_unit((place - other.place) / arms[1]), other),
            )
            for place in places
        ]
    assert isinstance(other, Rail)
    start = other.pose(pin.second)
    if isinstance(one, Rail):
        place = _meeting(one.pose(pin.first), one.along, start, other.along)
        first = PlanePose(one.pose.turn, place - one.pose.turn * pin.first)
        second = PlanePose(other.pose.turn, place - other.pose.turn * pin.second)
        return [(first, second)]
    arm = pin.first - one.local
    results = []
    for place in _circle_and_line(one.place, abs(arm), start, other.along, size):
        second = PlanePose(other.pose.turn, other.pose.shift + place - start)
        results.append((_placed(_unit((place - one.place) / arm), one), second))
    return results


def _sliding(one: End, slider: Slider, other: End, size: float) -> Poses:
    assert isinstance(one, Pivot)
    if isinstance(other, Rail):
        first = _placed(other.pose.turn / slider.pose.turn, one)
        start = first.after(slider.pose).shift
        along = first.turn * slider.along
        where = _meeting(start, along, other.pose.shift, other.along)
        return [(first, PlanePose(other.pose.turn, where))]
    gap = other.place - one.place
    start = slider.pose(other.local)  # the far pivot, as the first body sees it
    results = []
    places = _circle_and_line(one.local, abs(gap), start, slider.along, size)
    for place in places:
        first = _placed(_unit(gap / (place - one.local)), one)
        slid = PlanePose(slider.pose.turn, slider.pose.shift + place - start)
        second = first.after(slid)
        results.append((first, second))
    return results


def may_be_degenerate(one: End, middle: Middle, other: End, size: float) -> bool:
    """Whether a dyad may close in a whole curve of configurations somewhere; what the
    joints stand on may be anywhere."""
    if isinstance(one, Rail) and isinstance(other, Pivot):
        return may_be_degenerate(other, _reversed(middle), one, size)
    if isinstance(other, Rail):
        if isinstance(one, Rail) or isinstance(middle, Slider):
            return True  # two lines may be one
        # a circle and a line never are, if there is a circle
        return is_degenerate_dyad(abs(middle.first - one.local) / size)
    assert isinstance(one, Pivot)
    if isinstance(middle, Pin):
        arms = abs(middle.first - one.local), abs(middle.second - other.local)
        least = min(*arms, abs(arms[0] - arms[1]))
        return is_degenerate_dyad(least / size)
    beside = ((middle.pose(other.local) - one.local) / middle.along).imag
    return is_degenerate_dyad(abs(beside) / size)


# --- circles and lines ----------------------------------------------------------------


def _unit(number: complex) -> complex:
    return number / abs(number)


def _circles(
    one: complex, first: float, other: complex, second: float, size: float
) -> list[complex]:
    """Where circles about two places, of these radii, meet."""
    gap = other - one
    distance = abs(gap)
    if is_degenerate_dyad(distance / size):
        if is_degenerate_dyad(abs(first - second) / size):
            raise DegenerateDyadError
        return []
    along = (distance**2 + first**2 - second**2) / (2 * distance)
    return [
        one + gap / distance * complex(along, height)
        for height in _roots(first**2 - along**2, size)
    ]


def _circle_and_line(
    center: complex, radius: float, start: complex, along: complex, size: float
) -> list[complex]:
    """Where a circle meets a line from a ``start`` along a unit direction."""
    offset = (start - center) / along  # in a frame along the line
    if is_degenerate_dyad(radius / size):
        if is_degenerate_dyad(abs(offset.imag) / size):
            raise DegenerateDyadError
        return []
    return [
        center + along * complex(root, offset.imag)
        for root in _roots(radius**2 - offset.imag**2, size)
    ]


def _roots(square: float, size: float) -> list[float]:
    if square < -TOUCHING * size**2:
        return []
    root = math.sqrt(max(square, 0.0))
    return [root, -root] if root > 0 else [0.0]


def _meeting(start: complex, along: complex, end: complex, other: complex) -> complex:
    """Where two lines meet."""
    sine = (along.conjugate() * other).imag
    if is_degenerate_dyad(abs(sine)):
        raise DegenerateDyadError
    way = ((end - start).conjugate() * other).imag / sine
    return start + way * along
