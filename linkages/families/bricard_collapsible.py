"""The doubly collapsible octahedral Bricard 6R, from the hexagon into which it
collapses."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from linkages.construction.conditions import decided, require_different
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, acos, atan2, cos, pi_like, sin, sqrt
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop
from linkages.values import GeometryError

POSITION = 180


@dataclass(frozen=True)
class Point:
    """A point of the plane of the hexagon."""

    x: Number
    y: Number

    def __sub__(self, other: Point) -> Point:
        return Point(self.x - other.x, self.y - other.y)

    def dot(self, other: Point) -> Number:
        """Scalar product."""
        return self.x * other.x + self.y * other.y

    @property
    def norm(self) -> Number:
        """Distance from the origin."""
        return sqrt(self.x**2 + self.y**2)


def doubly_collapsible_octahedral(
    x1: Number, y1: Number, x2: Number, y2: Number, radius_1: Number, radius_2: Number
) -> Loop:
    """Doubly collapsible octahedral Bricard 6R: all lengths zero, axes along the sides
    of a plane hexagon.

    From A = (x1, y1) and A' = (x2, y2) the tangents to the circle of ``radius_1`` about
    the origin meet in B and B', those to ``radius_2`` in C and C'; the joints 1 to 6
    lie along C'A, AB, BC, CA', A'B', B'C', the last one reversed, so that R1 R3 R5 + R2
    R4 R6 = 0. Raises `GeometryError` if a point lies within a circle, if tangents are
    parallel, and for a hexagon with a side of no length. Source: Bricard (1897);
    equation (2.4.18) in Song (2013) is that product alone, which is necessary and not
    sufficient.
    """
    a = Point(x1, y1)
    a_opposite = Point(x2, y2)
    b, b_opposite = _corners(a, a_opposite, radius_1)
    c, c_opposite = _corners(a, a_opposite, radius_2)
    corners = (c_opposite, a, b, c, a_opposite, b_opposite)
    sides = []
    for i, corner in enumerate(corners):
        sides.append(corners[(i + 1) % 6] - corner)
    offsets = [side.norm for side in sides]
    perimeter: Number = 0
    for offset in offsets:
        perimeter = perimeter + offset
    for i, offset in enumerate(offsets, start=1):
        name = f"side {i} of the hexagon"
        require_different(name, offset, 0, "a point", scale=perimeter)
    twists = []
    for i, side in enumerate(sides):
        following = sides[(i + 1) % 6]
        cosine = side.dot(following) / (offsets[i] * offsets[(i + 1) % 6])
        twists.append(_angle_of(cosine))
    pi = pi_like(*twists)
    offsets[5] = -offsets[5]
    twists[4] = twists[4] - pi
    twists[5] = twists[5] - pi
    return closed_chain(*(Link(0, twist) for twist in twists), offsets=offsets)


def _angle_of(cosine: Number) -> Number:
    """The angle of sides that may lie in line, where the cosine may pass 1 by
    rounding."""
    value = decided(cosine)
    if value is not None and abs(value) > 1:
        return acos(cosine / abs(value))
    return acos(cosine)


class _Normals(NamedTuple):
    """Directions (rad) of the normals of the two tangents from a point to a circle."""

    left: Number
    right: Number


def _corners(first: Point, opposite: Point, radius: Number) -> tuple[Point, Point]:
    """The two meeting points, neither on one tangent with the other, of the tangents
    from two points."""
    a = _normals(first, radius)
    b = _normals(opposite, radius)
    return _meet(a.right, b.left, radius), _meet(a.left, b.right, radius)


def _normals(point: Point, radius: Number) -> _Normals:
    """The normals of the tangents from ``point`` to the circle about the origin."""
    distance = point.norm
    size = decided(radius)
    reach = decided(distance)
    if size is not None and reach is not None and not reach > size > 0:
        allowed = f"between 0 and {reach}, the distance of a corner"
        raise GeometryError("radius of a circle", size, allowed)
    middle = atan2(point.y, point.x)
    half = acos(radius / distance)
    return _Normals(middle + half, middle - half)


def _meet(one: Number, other: Number, radius: Number) -> Point:
    """Where the tangents with normals at the angles ``one`` and ``other`` meet."""
    middle = (one + other) / 2
    cosine = cos((one - other) / 2)
    name = "cosine of half the angle between the tangents"
    require_different(name, cosine, 0, "parallel tangents")
    return Point(radius * cos(middle) / cosine, radius * sin(middle) / cosine)


# --- first guesses: the offsets are the sides of the hexagon C' A B C A' B', the twists
# its turns, modulo pi and in either sense

LOOSE = 0.05  # of the perimeter: a hexagon that misses itself by more is not one
SMALL_LENGTH = 1e-3  # of the longest side: a table with longer links is another linkage
TRIED = 8  # hexagons, those that close best


def _guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Corners and radii, of all choices of the turns those laid out that close."""
    lengths, twists, offsets = form
    sides = np.abs(offsets)
    if lengths.max() > SMALL_LENGTH * sides.max() or sides.min() == 0:
        return
    turns = [(t, t - np.pi, -t, np.pi - t) for t in twists[:5]]
    choices = np.array(list(itertools.product(*turns)))
    start = np.zeros((len(choices), 1))
    heading = np.concatenate([start, np.cumsum(choices, axis=1)], axis=1)
    steps = sides * np.exp(1j * heading)
    gaps = np.abs(steps.sum(axis=1)) / sides.sum()
    for k in np.argsort(gaps)[:TRIED]:
        if gaps[k] < LOOSE:
            walk = np.cumsum(steps[k])[:5]
            yield from _guesses_by_hexagon(walk)


def _guesses_by_hexagon(walk: np.ndarray) -> Iterator[dict[str, float]]:
    """Parameters for the corners A, B, C, A', B', from C' at the origin.

    The centre of the circles lies on a bisector of the sides that meet at A and one of
    those that meet at A'.
    """
    a, b, c, a_opposite, b_opposite = walk
    for sense, opposite_sense in itertools.product((1, 1j), repeat=2):
        # bisectors of the angle at A between AB and AB', and at A' between A'B and A'B'
        first = sense * _bisector(b - a, b_opposite - a)
        sides = b - a_opposite, b_opposite - a_opposite
        second = opposite_sense * _bisector(*sides)
        cross = (np.conj(first) * second).imag
        if abs(cross) < 1e-9:
            continue
        along = (np.conj(a_opposite - a) * second).imag / cross
        centre = a + first * along
        p = a - centre
        q = a_opposite - centre
        for mirror in (1, -1):
            yield {
                "x1": float(p.real),
                "y1": mirror * float(p.imag),
                "x2": float(q.real),
                "y2": mirror * float(q.imag),
                "radius_1": _distance(centre, a, b),
                "radius_2": _distance(centre, a, c),
            }


def _bisector(u: complex, v: complex) -> complex:
    total = u / abs(u) + v / abs(v)
    return total / abs(total) if abs(total) > 1e-9 else 1j * u / abs(u)


def _distance(point: complex, first: complex, second: complex) -> float:
    """Distance of a point from the line through two others."""
    side = second - first
    return float(abs((np.conj(side) * (point - first)).imag) / abs(side))


ENTRIES = read_entries(
    "bricard_collapsible",
    {
        "bricard-octahedral-doubly-collapsible": Model(
            doubly_collapsible_octahedral, guesses=_guesses
        )
    },
)
