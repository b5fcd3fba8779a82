"""Plane-symmetric Bricard 6R linkages: general, revised and octahedral."""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.construction.conditions import decided, require_equal
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import acos, cos, pi_like, sin
from linkages.entry import Entry, Parameter
from linkages.loop import GeometryError, Loop

__all__ = [
    "ENTRIES",
    "plane_symmetric",
    "plane_symmetric_octahedral",
    "revised_plane_symmetric",
]


def plane_symmetric(
    a12: Any,
    a23: Any,
    a34: Any,
    alpha12: Any,
    alpha23: Any,
    alpha34: Any,
    R2: Any,
    R3: Any,
) -> Loop:
    """General plane-symmetric Bricard 6R; lengths and offsets in one unit, twists in
    rad.

    alpha12 + alpha61 = alpha34 + alpha45 = pi, alpha23 + alpha56 = 0, R2 = R6, R3 = R5.
    Source: Bricard (1927); equation (2.4.14) in Song (2013) has alpha23 + alpha56 = pi,
    which with these offsets is rigid.
    """
    pi = pi_like(alpha12, alpha23, alpha34)
    ahead = Link(a12, alpha12), Link(a23, alpha23), Link(a34, alpha34)
    behind = Link(a34, pi - alpha34), Link(a23, -alpha23), Link(a12, pi - alpha12)
    return closed_chain(*ahead, *behind, offsets=(0, R2, R3, 0, R3, R2))


def revised_plane_symmetric(
    a12: Any,
    a23: Any,
    a34: Any,
    alpha12: Any,
    alpha23: Any,
    alpha34: Any,
    R2: Any,
    R3: Any,
) -> Loop:
    """Revised general plane-symmetric Bricard 6R: opposite twists, R2 = -R6, R3 = -R5.

    Lengths and offsets in one unit, twists in rad. Source: Mavroidis and Roth (1995);
    equation (2.4.20) in Song (2013). It is `plane_symmetric` with the axes 2 and 6
    reversed on one side.
    """
    ahead = Link(a12, alpha12), Link(a23, alpha23), Link(a34, alpha34)
    behind = (Link(link.length, -link.twist) for link in reversed(ahead))
    return closed_chain(*ahead, *behind, offsets=(0, R2, R3, 0, -R3, -R2))


def plane_symmetric_octahedral(
    alpha12: Any,
    alpha23: Any,
    alpha34: Any,
    alpha45: Any,
    alpha61: Any,
    R1: Any,
    alpha56: Any = None,
) -> Loop:
    """Plane-symmetric octahedral Bricard 6R: all lengths zero, offsets from ``R1`` and
    the twists (rad).

    ``alpha56`` follows from R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6
    cos(alpha56) and is checked if given. Raises `GeometryError`. Source: Bricard
    (1927); equation (2.4.17) in Song (2013) lacks that condition and is rigid without
    it.
    """
    ahead, behind = sin(alpha12 + alpha34), sin(alpha45 + alpha61)
    R2, R3 = -R1 * sin(alpha34) / ahead, R1 * sin(alpha12) / ahead
    R5, R6 = R1 * sin(alpha61) / behind, -R1 * sin(alpha45) / behind
    base = R2**2 + R3**2 + 2 * R2 * R3 * cos(alpha23)
    cosine = (base - R5**2 - R6**2) / (2 * R5 * R6)
    value = decided(cosine)
    if value is not None and abs(value) > 1:
        raise GeometryError(
            "cos(alpha56)", value, "between -1 and 1; these twists do not close"
        )
    needed = acos(cosine)
    if alpha56 is not None:
        require_equal("cos(alpha56)", cos(alpha56), cosine, "for the other twists")
    twists = (
        alpha12,
        alpha23,
        alpha34,
        alpha45,
        needed if alpha56 is None else alpha56,
        alpha61,
    )
    return closed_chain(
        *(Link(0, twist) for twist in twists), offsets=(R1, R2, R3, -R1, R5, R6)
    )


def _length(name: str, value: float, low: float = 0.3, high: float = 2.0) -> Parameter:
    return Parameter(
        name,
        value,
        "length",
        f"{'offset' if name[0] == 'R' else 'length'} {name}",
        low,
        high,
    )


def _twist(name: str, value: float, low: float = 15, high: float = 165) -> Parameter:
    return Parameter(
        name, value, "angle", f"twist of link {name[5:]}", radians(low), radians(high)
    )


_HALF = (
    *(
        _length(name, value)
        for name, value in (("a12", 1.0), ("a23", 0.8), ("a34", 1.25))
    ),
    *(
        _twist(f"alpha{k}", radians(value))
        for k, value in ((12, 50), (23, 77), (34, 110))
    ),
    _length("R2", -0.45, -0.5, 0.5),
    _length("R3", 0.6, -0.5, 0.5),
)
_FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "bricard-plane-symmetric",
        "General plane-symmetric Bricard 6R",
        "Bricard (1927); Baker (1980); Song (2013), eq. 2.4.14",
        plane_symmetric,
        _HALF,
        (
            "a12 = a61, a23 = a56, a34 = a45",
            "alpha12 + alpha61 = pi, alpha23 + alpha56 = 0, alpha34 + alpha45 = pi",
            "R1 = R4 = 0, R2 = R6, R3 = R5",
        ),
        errata=("alpha23 + alpha56 = pi is printed; it is 0 with R2 = R6, R3 = R5",),
        facts=_FACTS,
    ),
    Entry(
        "bricard-plane-symmetric-revised",
        "Revised general plane-symmetric Bricard 6R",
        "Mavroidis and Roth (1995); Song (2013), eq. 2.4.20",
        revised_plane_symmetric,
        _HALF,
        (
            "a12 = a61, a23 = a56, a34 = a45",
            "alpha12 + alpha61 = alpha23 + alpha56 = alpha34 + alpha45 = 0",
            "R1 = R4 = 0, R2 = -R6, R3 = -R5",
        ),
        facts=_FACTS,
    ),
    Entry(
        "bricard-octahedral-plane-symmetric",
        "Plane-symmetric octahedral Bricard 6R",
        "Bricard (1897, 1927); Baker (1980); Song (2013), eq. 2.4.17",
        plane_symmetric_octahedral,
        (
            _twist("alpha12", 2.1898919226139584, 115, 130),
            _twist("alpha23", 0.9447166986444288, 45, 65),
            _twist("alpha34", 2.258845335456913, 120, 135),
            _twist("alpha45", 0.8086507372666255, 42, 50),
            _twist("alpha61", 0.5933371007764807, 32, 36),
            _length("R1", 1.936892176093739, 1.0, 3.0),
        ),
        (
            "all lengths zero, R4 = -R1",
            "R2 = -R1 sin(alpha34)/sin(alpha12+alpha34), R3 = R1 sin(alpha12)/sin(alpha12+alpha34)",
            "R5 = R1 sin(alpha61)/sin(alpha45+alpha61), R6 = -R1 sin(alpha45)/sin(alpha45+alpha61)",
            "R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6 cos(alpha56)",
        ),
        errata=(
            "the condition on alpha23 and alpha56 is missing in print; without it the loop is rigid",
        ),
        facts=_FACTS,
    ),
)
