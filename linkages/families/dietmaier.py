"""Dietmaier's 6R, with the condition on the link ratios and the offsets put right."""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.construction.conditions import decided, require_equal
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import cos, sin
from linkages.entry import Entry, Parameter
from linkages.loop import GeometryError, Loop

__all__ = ["ENTRIES", "dietmaier"]


def dietmaier(
    a12: Any,
    alpha12: Any,
    alpha61: Any,
    alpha34: Any,
    alpha45: Any,
    length: Any,
    twist: Any,
    R2: Any,
    R3: Any,
    a61: Any = None,
    a34: Any = None,
    a45: Any = None,
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
    second = cos(alpha34) + cos(alpha45)
    if decided(second) == 0:
        raise GeometryError("cos(alpha34) + cos(alpha45)", 0, "different from 0")
    needed = a12 / sin(alpha12) * (cos(alpha12) + cos(alpha61)) * sin(alpha34) / second
    if a34 is not None:
        require_equal("a34", a34, needed, "from the condition on the cosines")
    link34, link45 = bennett_links(
        needed if a34 is None else a34, alpha34, a45=(alpha45, a45)
    )
    free = Link(length, twist)
    return closed_chain(
        link12, free, link34, link45, free, link61, offsets=(0, R2, R3, 0, R3, R2)
    )


ENTRIES = (
    Entry(
        "dietmaier",
        "Dietmaier's 6R",
        "Dietmaier (1995b); Song (2013), eq. 2.4.12",
        dietmaier,
        (
            Parameter(
                "a12", 1.7 * sin(radians(50)), "length", "length of link 12", 0.3, 3.0
            ),
            *(
                Parameter(
                    name,
                    radians(value),
                    "angle",
                    f"twist of link {name[-2:]}",
                    radians(15),
                    radians(85),
                )
                for name, value in (
                    ("alpha12", 50),
                    ("alpha61", 75),
                    ("alpha34", 35),
                    ("alpha45", 62),
                )
            ),
            Parameter(
                "length", 1.13, "length", "length of the free links 23 and 56", 0.3, 2.0
            ),
            Parameter(
                "twist",
                radians(73),
                "angle",
                "twist of the free links 23 and 56",
                radians(15),
                radians(165),
            ),
            Parameter("R2", 0.31, "length", "offset R2", -0.5, 0.5),
            Parameter("R3", -0.47, "length", "offset R3", -0.5, 0.5),
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
