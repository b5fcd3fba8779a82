"""The doubly collapsible octahedral Bricard 6R, from the hexagon into which it
collapses."""

from __future__ import annotations

from typing import Any

from linkages.construction.conditions import decided
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import acos, atan2, cos, pi_like, sin, sqrt
from linkages.entry import Entry, Parameter
from linkages.loop import GeometryError, Loop

__all__ = ["ENTRIES", "doubly_collapsible_octahedral"]

Point = tuple[Any, Any]


def doubly_collapsible_octahedral(
    x1: Any, y1: Any, x2: Any, y2: Any, radius_1: Any, radius_2: Any
) -> Loop:
    """Doubly collapsible octahedral Bricard 6R: all lengths zero, axes along the sides
    of a plane hexagon.

    From A = (x1, y1) and A' = (x2, y2) the tangents to the circle of ``radius_1`` about
    the origin meet in B and B', those to ``radius_2`` in C and C'; the joints 1 to 6
    lie along C'A, AB, BC, CA', A'B', B'C', the last one reversed, so that R1 R3 R5 + R2
    R4 R6 = 0. Raises `GeometryError` if a point lies within a circle. Source: Bricard
    (1897); equation (2.4.18) in Song (2013) is that product alone, which is necessary
    and not sufficient.
    """
    first, opposite = (x1, y1), (x2, y2)
    (b, b_opposite), (c, c_opposite) = (
        _corners(first, opposite, r) for r in (radius_1, radius_2)
    )
    corners = (c_opposite, first, b, c, opposite, b_opposite)
    sides = [_difference(corners[(i + 1) % 6], corners[i]) for i in range(6)]
    offsets = [sqrt(x * x + y * y) for x, y in sides]
    twists = []
    for i, (x, y) in enumerate(sides):
        u, v = sides[(i + 1) % 6]
        twists.append(acos((x * u + y * v) / (offsets[i] * offsets[(i + 1) % 6])))
    pi = pi_like(*twists)
    offsets[5], twists[4], twists[5] = -offsets[5], twists[4] - pi, twists[5] - pi
    return closed_chain(*(Link(0, twist) for twist in twists), offsets=offsets)


def _corners(first: Point, opposite: Point, radius: Any) -> tuple[Point, Point]:
    """The two meeting points, neither on one tangent with the other, of the tangents
    from two points."""
    (a, a_other), (b, b_other) = _normals(first, radius), _normals(opposite, radius)
    return _meet(a_other, b, radius), _meet(a, b_other, radius)


def _normals(point: Point, radius: Any) -> tuple[Any, Any]:
    """Directions (rad) of the normals of the two tangents from ``point`` to the circle
    about the origin."""
    distance = sqrt(point[0] ** 2 + point[1] ** 2)
    size, reach = decided(radius), decided(distance)
    if size is not None and reach is not None and not reach > size > 0:
        raise GeometryError(
            "radius of a circle",
            size,
            f"between 0 and {reach}, the distance of a corner",
        )
    middle, half = atan2(point[1], point[0]), acos(radius / distance)
    return middle + half, middle - half


def _meet(one: Any, other: Any, radius: Any) -> Point:
    """Where the tangents with normals at the angles ``one`` and ``other`` meet."""
    middle, half = (one + other) / 2, (one - other) / 2
    return radius * cos(middle) / cos(half), radius * sin(middle) / cos(half)


def _difference(p: Point, q: Point) -> Point:
    return p[0] - q[0], p[1] - q[1]


ENTRIES = (
    Entry(
        "bricard-octahedral-doubly-collapsible",
        "Doubly collapsible octahedral Bricard 6R",
        "Bricard (1897); Baker (1980); Song (2013), eq. 2.4.18",
        doubly_collapsible_octahedral,
        (
            Parameter(
                "x1", 2.3, "length", "first coordinate of the corner A", 1.8, 2.8
            ),
            Parameter(
                "y1", 0.4, "length", "second coordinate of the corner A", 0.1, 0.8
            ),
            Parameter(
                "x2", -1.1, "length", "first coordinate of the corner A'", -1.6, -0.9
            ),
            Parameter(
                "y2", 1.9, "length", "second coordinate of the corner A'", 1.5, 2.3
            ),
            Parameter(
                "radius_1",
                0.7,
                "length",
                "radius of the circle that AB, A'B', A'B, AB' touch",
                0.5,
                0.8,
            ),
            Parameter(
                "radius_2",
                1.1,
                "length",
                "radius of the circle that AC, A'C', A'C, AC' touch",
                0.95,
                1.3,
            ),
        ),
        (
            "all lengths zero; offsets and twists are sides and turns of the hexagon A B C A' B' C'",
            "AB, A'B', A'B, AB' touch one circle, AC, A'C', A'C, AC' another one about the same centre",
        ),
        errata=(
            "R1 R3 R5 + R2 R4 R6 = 0 is printed as the only condition; it is necessary, not sufficient",
        ),
        facts={"joints": 6, "mobility": 1},
    ),
)
