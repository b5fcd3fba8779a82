"""Bricard's trihedral and revised line-symmetric 6R, and the linkages of Altmann and
Wohlhart near them."""

from __future__ import annotations

from functools import partial
from math import radians
from typing import Any

from linkages.construction.conditions import require_equal, require_positive
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import pi_like, sqrt
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "altmann",
    "revised_line_symmetric",
    "trihedral",
    "wohlhart_hybrid",
]


def revised_line_symmetric(
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
    """Revised general line-symmetric Bricard 6R: opposite links equal, opposite offsets
    negative.

    Lengths and offsets in one unit, twists in rad. Source: Mavroidis and Roth (1995);
    equation (2.4.19) in Song (2013).
    """
    half = Link(a12, alpha12), Link(a23, alpha23), Link(a34, alpha34)
    return closed_chain(*half, *half, offsets=(R1, R2, R3, -R1, -R2, -R3))


def trihedral(
    a12: Any,
    a23: Any,
    a34: Any,
    a45: Any,
    a56: Any,
    a61: Any = None,
    alternating: bool = True,
) -> Loop:
    """Trihedral Bricard 6R: right-angled links, of ``alternating`` sign or all +pi/2,
    without offsets.

    ``a61`` follows from a12^2 + a34^2 + a56^2 = a23^2 + a45^2 + a61^2 and is checked if
    given. Raises `GeometryError`. Source: Bricard (1927); equation (2.4.15) in Song
    (2013) for alternating twists.
    """
    square = a12**2 + a34**2 + a56**2 - a23**2 - a45**2
    require_positive("a12^2 + a34^2 + a56^2 - a23^2 - a45^2", square)
    if a61 is not None:
        require_equal("a61^2", a61**2, square, "a12^2 + a34^2 + a56^2 - a23^2 - a45^2")
    a61 = sqrt(square) if a61 is None else a61
    right = pi_like(a12, a23, a34, a45, a56) / 2
    other = -right if alternating else right
    lengths = (a12, a23, a34, a45, a56, a61)
    return closed_chain(
        *(Link(a, right if i % 2 == 0 else other) for i, a in enumerate(lengths))
    )


def altmann(a12: Any, a34: Any) -> Loop:
    """Altmann's 6R: a line-symmetric Bricard linkage with right angles and a23 = a56 =
    0.

    Source: Altmann (1954), Baker (1993b); equation (2.4.21) in Song (2013).
    """
    right = pi_like(a12, a34) / 2
    twists = (right, right, right, -right, right, -right)
    return closed_chain(
        *(Link(a, t) for a, t in zip((a12, 0, a34) * 2, twists, strict=True))
    )


def wohlhart_hybrid(
    a12: Any,
    a23: Any,
    a45: Any,
    alpha12: Any,
    alpha23: Any,
    alpha45: Any,
    R2: Any,
    R4: Any,
    R6: Any = None,
) -> Loop:
    """Wohlhart's hybrid 6R: three plane-symmetric link pairs 61-12, 23-34, 45-56 with a
    common transversal.

    Lengths and offsets in one unit, twists in rad; R6 = -R2 - R4 is checked if given.
    Raises `GeometryError`. Source: Wohlhart (1987); equation (2.4.22) in Song (2013)
    has the pairs 12-23, 34-45, 56-61, which does not go with its offsets.
    """
    if R6 is not None:
        require_equal("R6", R6, -R2 - R4, "-(R2 + R4)")
    a, b, c = Link(a12, alpha12), Link(a23, alpha23), Link(a45, alpha45)
    b_back, c_back, a_back = (Link(link.length, -link.twist) for link in (b, c, a))
    offsets = (0, R2, 0, R4, 0, -R2 - R4)
    return closed_chain(a, b, b_back, c, c_back, a_back, offsets=offsets)


def _lengths(**values: float) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(k, v, "length", f"length {k}", 0.5, 1.6) for k, v in values.items()
    )


def _twists(**degrees: float) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(
            k,
            radians(v),
            "angle",
            f"twist of link {k[5:]}",
            radians(-165 if v < 0 else 15),
            radians(-15 if v < 0 else 165),
        )
        for k, v in degrees.items()
    )


def _offsets(**values: float) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(k, v, "length", f"offset {k}", -0.5, 0.5) for k, v in values.items()
    )


_TRIHEDRAL = tuple(
    Parameter(name, value, "length", f"length {name}", low, low + 0.3)
    for name, value, low in (
        ("a12", 1.0, 0.95),
        ("a23", 0.7, 0.65),
        ("a34", 1.1, 0.95),
        ("a45", 0.9, 0.65),
        ("a56", 0.8, 0.7),
    )
)
_SQUARES = "a12^2 + a34^2 + a56^2 = a23^2 + a45^2 + a61^2"
_FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "bricard-line-symmetric-revised",
        "Revised general line-symmetric Bricard 6R",
        "Mavroidis and Roth (1995); Song (2013), eq. 2.4.19",
        revised_line_symmetric,
        (
            *_lengths(a12=1.0, a23=0.8, a34=1.25),
            *_twists(alpha12=50, alpha23=77, alpha34=110),
            *_offsets(R1=0.3, R2=-0.45, R3=0.6),
        ),
        (
            "a12 = a45, a23 = a56, a34 = a61, twists likewise",
            "R1 = -R4, R2 = -R5, R3 = -R6",
        ),
        facts=_FACTS,
    ),
    Entry(
        "bricard-trihedral",
        "Trihedral Bricard 6R",
        "Bricard (1927); Baker (1980); Song (2013), eq. 2.4.15",
        trihedral,
        _TRIHEDRAL,
        (
            _SQUARES,
            "alpha12 = alpha34 = alpha56 = pi/2, alpha23 = alpha45 = alpha61 = -pi/2",
            "R = 0",
        ),
        facts=_FACTS,
    ),
    Entry(
        "bricard-trihedral-equal-twists",
        "Trihedral Bricard 6R with equal twists",
        "variant of Bricard (1927) found by closure",
        partial(trihedral, alternating=False),
        _TRIHEDRAL,
        (_SQUARES, "all twists pi/2", "R = 0"),
        facts=_FACTS,
    ),
    Entry(
        "altmann",
        "Altmann's 6R",
        "Altmann (1954); Baker (1993b); Song (2013), eq. 2.4.21",
        altmann,
        _lengths(a12=1.0, a34=1.4),
        (
            "a12 = a45, a34 = a61, a23 = a56 = 0",
            "alpha12 = alpha23 = alpha34 = alpha56 = pi/2, alpha45 = alpha61 = -pi/2, R = 0",
        ),
        facts=_FACTS,
    ),
    Entry(
        "wohlhart-hybrid",
        "Wohlhart's hybrid 6R",
        "Wohlhart (1987); Song (2013), eq. 2.4.22",
        wohlhart_hybrid,
        (
            *_lengths(a12=1.0, a23=0.8, a45=1.25),
            *_twists(alpha12=-50, alpha23=77, alpha45=110),
            *_offsets(R2=0.4, R4=0.3),
        ),
        (
            "a61 = a12, a23 = a34, a45 = a56, alpha61 = -alpha12, alpha34 = -alpha23, alpha56 = -alpha45",
            "R1 = R3 = R5 = 0, R2 + R4 + R6 = 0",
        ),
        errata=(
            "the pairs 12-23, 34-45, 56-61 are printed; with R2 + R4 + R6 = 0 they are 61-12, 23-34, 45-56",
        ),
        facts=_FACTS,
    ),
)
