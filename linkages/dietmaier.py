"""Dietmaier's 6R, with the condition on the link ratios and the offsets put right."""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.entry import Entry, Parameter
from linkages.link import Link, bennett_links, closed_chain
from linkages.loop import GeometryError, Loop
from linkages.numbers import cos

__all__ = ["ENTRIES", "dietmaier"]


def dietmaier(
    alpha12: Any,
    alpha61: Any,
    alpha34: Any,
    alpha45: Any,
    scale: Any,
    length: Any,
    twist: Any,
    r2: Any,
    r3: Any,
    second_scale: Any = None,
) -> Loop:
    """Dietmaier's 6R: two links of one Bennett ratio at joint 1, two of another at joint 4, 23 equal to 56.

    Twists in rad; ``scale`` is length / sin(twist) of the links 61, 12. That of the links 34, 45 follows,
    and is checked if given as ``second_scale``: scale (cos alpha12 + cos alpha61) = second_scale (cos alpha34
    + cos alpha45). R2 = R6, R3 = R5. Raises `GeometryError`. Source: Dietmaier (1995b); equation (2.4.12) in
    Song (2013) has sin/a for a/sin and offsets R1 = R5, R2 = R4, which leaves the linkage rigid.
    """
    here, there = cos(alpha12) + cos(alpha61), cos(alpha34) + cos(alpha45)
    if abs(float(there)) < 1e-12:
        raise GeometryError("cos(alpha34) + cos(alpha45)", float(there), "different from 0")
    other = scale * here / there if second_scale is None else second_scale
    gap = float(scale * here - other * there)
    if abs(gap) > 1e-9 * abs(float(scale)):
        raise GeometryError(
            "a12/sin(alpha12) (cos alpha12 + cos alpha61) - a34/sin(alpha34) (cos alpha34 + cos alpha45)", gap, "0"
        )
    link12, link61 = bennett_links(scale, alpha12, alpha61)
    link34, link45 = bennett_links(other, alpha34, alpha45)
    free = Link(length, twist)
    return closed_chain(link12, free, link34, link45, free, link61, offsets=(0, r2, r3, 0, r3, r2))


ENTRIES = (
    Entry(
        "dietmaier-6r",
        "Dietmaier's 6R",
        "Dietmaier (1995b); Song (2013), eq. 2.4.12",
        dietmaier,
        (
            *(
                Parameter(name, radians(value), "angle", f"twist of link {name[-2:]}", radians(15), radians(85))
                for name, value in (("alpha12", 50), ("alpha61", 75), ("alpha34", 35), ("alpha45", 62))
            ),
            Parameter("scale", 1.7, "length", "length / sin(twist) of the links 61 and 12", 0.5, 3.0),
            Parameter("length", 1.13, "length", "length of the free links 23 and 56", 0.3, 2.0),
            Parameter("twist", radians(73), "angle", "twist of the free links 23 and 56", radians(15), radians(165)),
            Parameter("r2", 0.31, "length", "offset R2", -0.5, 0.5),
            Parameter("r3", -0.47, "length", "offset R3", -0.5, 0.5),
        ),
        (
            "sin(alpha12)/a12 = sin(alpha61)/a61, sin(alpha34)/a34 = sin(alpha45)/a45",
            "a23 = a56, alpha23 = alpha56",
            "a12/sin(alpha12) (cos alpha12 + cos alpha61) = a34/sin(alpha34) (cos alpha34 + cos alpha45)",
            "R1 = R4 = 0, R2 = R6, R3 = R5",
        ),
        errata=(
            "sin(alpha)/a is printed for a/sin(alpha) in the condition on the cosines",
            "R1 = R5, R2 = R4, R3 = R6 = 0 is printed for the offsets",
        ),
        facts={"joints": 6, "mobility": 1},
    ),
)
