"""Dietmaier's 6R, with the condition on the link ratios and the offsets put right."""

from __future__ import annotations

import math

from linkages.construction.conditions import require_different, require_equal
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import Number, cos, sin
from linkages.construction.table_equations import (
    TableNumbers,
    equal_links,
    equal_offsets,
    equation,
    zero_offsets,
)
from linkages.entry import Condition, Entry, Parameter
from linkages.loop import Loop

POSITION = 150


def dietmaier(
    a12: Number,
    alpha12: Number,
    alpha61: Number,
    alpha34: Number,
    alpha45: Number,
    length: Number,
    twist: Number,
    R2: Number,
    R3: Number,
    a61: Number | None = None,
    a34: Number | None = None,
    a45: Number | None = None,
) -> Loop:
    """Dietmaier's 6R: two links of one Bennett ratio at joint 1, two of another at
    joint 4, 23 equal to 56.

    Twists in rad; ``length`` and ``twist`` are those of the links 23 and 56; R2 = R6,
    R3 = R5. The other lengths follow and are checked if given: a12/sin(alpha12) (cos
    alpha12 + cos alpha61) = a34/sin(alpha34) (cos alpha34 + cos alpha45). Raises
    `GeometryError`. Source: Dietmaier (1995b); equation (2.4.12) in Song (2013) has
    sin/a for a/sin and offsets R1 = R5, R2 = R4, which leaves the linkage rigid.
    """
    link12, link61 = bennett_links(a12, alpha12, a61=(alpha61, a61))
    first = cos(alpha12) + cos(alpha61)
    second = cos(alpha34) + cos(alpha45)
    name = "cos(alpha34) + cos(alpha45)"
    require_different(name, second, 0, "supplementary twists")
    length34 = a12 / sin(alpha12) * first * sin(alpha34) / second
    if a34 is not None:
        require_equal("a34", a34, length34, "from the condition on the cosines")
        length34 = a34
    link34, link45 = bennett_links(length34, alpha34, a45=(alpha45, a45))
    free = Link(length, twist)
    links = (link12, free, link34, link45, free, link61)
    return closed_chain(*links, offsets=(0, R2, R3, 0, R3, R2))


# --- conditions


def _ratio(t: TableNumbers, link: int) -> float:
    return math.sin(t.alpha(link)) / t.a(link)


def _first_ratio_gap(t: TableNumbers) -> float:
    """sin(alpha12)/a12 = sin(alpha61)/a61."""
    return _ratio(t, 12) - _ratio(t, 61)


def _second_ratio_gap(t: TableNumbers) -> float:
    """sin(alpha34)/a34 = sin(alpha45)/a45."""
    return _ratio(t, 34) - _ratio(t, 45)


def _cosines_gap(t: TableNumbers) -> float:
    """The condition on the cosines, see `dietmaier`."""
    return _scaled_cosines(t, 12, 61) - _scaled_cosines(t, 34, 45)


def _scaled_cosines(t: TableNumbers, link: int, other: int) -> float:
    """a/sin(alpha) of ``link`` times the sum of both cosines."""
    twist = t.alpha(link)
    total = math.cos(twist) + math.cos(t.alpha(other))
    return t.a(link) / math.sin(twist) * total


# --- entry


def _twist(link: int, degrees: float) -> Parameter:
    return Parameter.angle(f"alpha{link}", degrees, f"twist of link {link}", 15, 85)


LENGTH = 1.7 * math.sin(math.radians(50))

ENTRIES = (
    Entry(
        "dietmaier",
        "Dietmaier's 6R",
        "Dietmaier (1995b); Song (2013), eq. 2.4.12",
        dietmaier,
        (
            Parameter.length("a12", LENGTH, "length of link 12", 0.3, 3.0),
            _twist(12, 50),
            _twist(61, 75),
            _twist(34, 35),
            _twist(45, 62),
            Parameter.length(
                "length", 1.13, "length of the free links 23 and 56", 0.3, 2.0
            ),
            Parameter.angle("twist", 73, "twist of the free links 23 and 56", 15, 165),
            Parameter.length("R2", 0.31, "offset R2", -0.5, 0.5),
            Parameter.length("R3", -0.47, "offset R3", -0.5, 0.5),
        ),
        conditions=(
            Condition(
                "sin(alpha12)/a12 = sin(alpha61)/a61, "
                "sin(alpha34)/a34 = sin(alpha45)/a45",
                (equation(_first_ratio_gap), equation(_second_ratio_gap)),
            ),
            Condition("a23 = a56, alpha23 = alpha56", (equal_links((23, 56)),)),
            Condition(
                "a12/sin(alpha12) (cos alpha12 + cos alpha61) "
                "= a34/sin(alpha34) (cos alpha34 + cos alpha45)",
                (equation(_cosines_gap),),
            ),
            Condition(
                "R1 = R4 = 0, R2 = R6, R3 = R5",
                (zero_offsets(1, 4), equal_offsets((2, 6), (3, 5))),
            ),
        ),
        errata=(
            "sin(alpha)/a is printed for a/sin(alpha) in the condition on the cosines",
            "R1 = R5, R2 = R4, R3 = R6 = 0 is printed for the offsets",
        ),
        facts={"joints": 6, "mobility": 1},
    ),
)
