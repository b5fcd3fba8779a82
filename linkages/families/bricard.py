"""The line-symmetric Bricard 6R linkage: general, with zero offsets, and octahedral.

Opposite links and offsets are alike. Forms I and II ("original") have theta_{i+3} =
theta_i; with zero offsets there are also Forms I' and II' ("revised") with theta_{i+3}
= -theta_i.
"""

from __future__ import annotations

import math
from typing import Any

from linkages.construction.conditions import decided
from linkages.entry import Entry, Parameter
from linkages.families.bricard_forms import patterns
from linkages.loop import GeometryError, Loop

__all__ = [
    "ENTRIES",
    "bricard_line_symmetric",
    "bricard_line_symmetric_zero_offset",
    "bricard_octahedral_line_symmetric",
]

SOURCE = "Bricard 1927, Lecons de cinematique; Baker 1980, Mech. Mach. Theory 15, 267-286; Song 2013, "


def bricard_line_symmetric(
    a12: Any,
    a23: Any,
    a34: Any,
    alpha12: Any,
    alpha23: Any,
    alpha34: Any,
    R1: Any,
    R2: Any,
    R3: Any,
) -> Loop:
    """The general line-symmetric Bricard linkage: links 12, 23, 34 and offsets of
    joints 1, 2, 3, twice over.

    Lengths not negative, twists in rad, any offsets. Raises `GeometryError` for a
    negative length. Closed form: Song 2013, eqs (4.2.14)-(4.2.24), where H2 and L2 of
    (4.2.15) must be -R3 c12 s23 s34 and R1 (c12 c23 + c34) + R2 (c23 + c12 c34) + R3 (1
    + c12 c23 c34), c and s being cosines and sines of the twists.
    """
    for name, length in (("a12", a12), ("a23", a23), ("a34", a34)):
        number = decided(length)
        if number is not None and number < 0:
            raise GeometryError(f"length {name}", f"{number:.6g}", "0 or greater")
    return Loop(
        (a12, a23, a34) * 2,
        (alpha12, alpha23, alpha34) * 2,
        (R1, R2, R3) * 2,
        "bricard-line-symmetric",
    )


def bricard_line_symmetric_zero_offset(
    a12: Any, a23: Any, a34: Any, alpha12: Any, alpha23: Any, alpha34: Any
) -> Loop:
    """The line-symmetric Bricard linkage whose offsets vanish (Song 2013, section
    4.4.3); errors as above."""
    return bricard_line_symmetric(a12, a23, a34, alpha12, alpha23, alpha34, 0, 0, 0)


def bricard_octahedral_line_symmetric(
    alpha12: Any, alpha23: Any, alpha34: Any, R1: Any, R2: Any, R3: Any
) -> Loop:
    """The line-symmetric octahedral Bricard linkage: no lengths, opposite twists and
    offsets alike.

    Sources: Bricard 1897; Song 2013, eq. (2.4.16), to which alpha12 = alpha45, alpha23
    = alpha56 and alpha34 = alpha61 must be added: without them the loop is rigid.
    """
    return bricard_line_symmetric(0, 0, 0, alpha12, alpha23, alpha34, R1, R2, R3)


def _number(name: str, kind: str, default: float, low: float, high: float) -> Parameter:
    meaning = {"a": "length of link", "al": "twist of link", "R": "offset of joint"}
    key = "al" if name.startswith("al") else name[0]
    digits = name.lstrip("alphR")
    opposite = (
        str(int(digits) + 33)
        if len(digits) == 2 and digits != "34"
        else {"34": "61"}.get(digits)
    )
    opposite = opposite or str(int(digits) + 3)
    return Parameter(
        name, default, kind, f"{meaning[key]} {digits} and {opposite}", low, high
    )


LENGTHS = tuple(
    _number(n, "length", x, 0.3, 3.0)
    for n, x in (("a12", 2.4), ("a23", 2.9), ("a34", 1.5))
)
TWISTS = tuple(
    _number(n, "angle", math.radians(x), 0.2, math.pi - 0.2)
    for n, x in (("alpha12", 40), ("alpha23", 80), ("alpha34", 130))
)
OFFSETS = tuple(
    _number(n, "length", x, -1.0, 1.0)
    for n, x in (("R1", 0.5), ("R2", 0.55), ("R3", 0.42))
)
LINKS = "a12 = a45, a23 = a56, a34 = a61, alpha12 = alpha45, alpha23 = alpha56, alpha34 = alpha61"
ERRATA = (
    "Song 2013, text of (4.2.1): theta3 = theta1, theta4 = theta2 must be theta4 = theta1, theta5 = theta2",
    "Song 2013, eq. (4.2.15): H2 and L2 are incomplete, see the constructor",
)

ENTRIES: tuple[Entry, ...] = (
    Entry(
        "bricard-line-symmetric",
        "General line-symmetric Bricard 6R linkage",
        SOURCE + "eqs (4.2.1)-(4.2.25)",
        bricard_line_symmetric,
        LENGTHS + TWISTS + OFFSETS,
        conditions=(LINKS, "R1 = R4, R2 = R5, R3 = R6"),
        patterns=patterns,
        errata=ERRATA,
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 2,
            "bifurcations": 0,
            "components": 2,
        },
    ),
    Entry(
        "bricard-line-symmetric-zero-offset",
        "Line-symmetric Bricard 6R linkage with zero offsets",
        SOURCE + "section 4.4.3",
        bricard_line_symmetric_zero_offset,
        LENGTHS + TWISTS,
        conditions=(LINKS, "all offsets 0"),
        patterns=patterns,
        errata=(*ERRATA, "Song 2013, eq. (4.3.8) is missing from the text"),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 4,
            "bifurcations": 4,
            "components": 1,
        },
    ),
    Entry(
        "bricard-octahedral-line-symmetric",
        "Line-symmetric octahedral Bricard 6R linkage",
        "Bricard 1897, J. Pure Appl. Math. 3, 113-150; Song 2013, eq. (2.4.16) and section 4.4.2",
        bricard_octahedral_line_symmetric,
        TWISTS + OFFSETS,
        conditions=(
            "all lengths 0",
            "alpha12 = alpha45, alpha23 = alpha56, alpha34 = alpha61",
            "R_i = R_{i+3}",
        ),
        patterns=lambda alpha12, alpha23, alpha34, R1, R2, R3: patterns(
            0.0, 0.0, 0.0, alpha12, alpha23, alpha34, R1, R2, R3
        ),
        errata=("Song 2013, eq. (2.4.16): the equalities of the twists are missing",),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 1,
            "bifurcations": 0,
            "components": 1,
        },
    ),
)
