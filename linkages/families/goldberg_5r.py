"""The other 5R linkages of Goldberg's family: syncopated, generalized, and those of
Myard.

All are made of two Bennett loops with a common link; the plain and the subtractive
Goldberg linkage stand in `linkages.families.goldberg`. Twists in rad. Only the length
of link a is free: the others follow from the Bennett ratio, and are checked where they
are given.
"""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.construction.conditions import require_equal
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import acos, pi_like, sin, sqrt
from linkages.construction.spatial_triangle import composite_link
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "extended_myard",
    "generalized_goldberg",
    "myard_asymmetric",
    "myard_plane_symmetric",
    "syncopated_goldberg",
]


def syncopated_goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, b: Any = None, c: Any = None
) -> Loop:
    """Syncopated Goldberg 5R: a Goldberg 5R taken from a Bennett loop with sides a + c
    and d.

    d/delta follows from the three twists. Source: Goldberg (1943), fig. 2.3.1b and
    equation (2.3.2) in Song (2013); Baker (1979) showed it to be a Goldberg 5R with
    link d - b in place of b.
    """
    a, b, c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    product = half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, beta)
    side = syncopated_link(a + c, product) - b
    return closed_chain(side, a + c, side, c, a)


def generalized_goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, kink: Any, b: Any = None, c: Any = None
) -> Loop:
    """Generalized Goldberg 5R: the links a and c locked at the angle ``kink`` (rad, or
    a `Kink`).

    R2 = R3 is the offset that the composite link brings. Source: Goldberg (1943),
    Wohlhart (1991a); equation (2.3.3) in Song (2013).
    """
    a, b, c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    joined = composite_link(a, c, kink)
    return closed_chain(
        b, joined.link, b, c, a, offsets=(0, joined.before[0], joined.after[0], 0, 0)
    )


def myard_asymmetric(a: Any, alpha: Any, beta: Any, b: Any = None) -> Loop:
    """Asymmetric Myard 5R: the Goldberg 5R of two equal Bennett loops. Source: Myard
    (1931), Baker (1979)."""
    a, b = bennett_links(a, alpha, b=(beta, b))
    return closed_chain(b, a + a, b, a, a)


def extended_myard(
    a: Any, alpha: Any, beta: Any, offset: Any = 0, b: Any = None, alpha34: Any = None
) -> Loop:
    """Extended Myard 5R, plane-symmetric, with R3 = R4 = ``offset``.

    ``alpha34`` follows: cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3 sin(beta)/b)^2). If
    given it is checked. Source: Chen and You (2008a), equation (2.3.5) in Song (2013),
    where alpha34 = pi - 2 alpha is printed for any R3 = R4; that holds for R3 = 0 only.
    Raises `GeometryError`.
    """
    a, b = bennett_links(a, alpha, b=(beta, b))
    pi = pi_like(alpha, beta, offset)
    shear = offset * sin(beta) / b.length
    needed = (
        pi - 2 * alpha if offset == 0 else 2 * acos(sin(alpha) / sqrt(1 + shear**2))
    )
    if alpha34 is not None:
        require_equal("alpha34", alpha34, needed, "which goes with R3 = R4")
    return closed_chain(
        a,
        b,
        Link(0, needed),
        b,
        Link(a.length, pi - alpha),
        offsets=(0, 0, offset, offset, 0),
    )


def myard_plane_symmetric(
    a: Any, alpha: Any, offset: Any = 0, b: Any = None, alpha34: Any = None
) -> Loop:
    """Plane-symmetric Myard 5R: `extended_myard` with right-angled links 23 and 45.

    Source: Myard (1931), equation (2.3.4) in Song (2013) with alpha45 = pi/2 where
    alpha41 is printed.
    """
    return extended_myard(a, alpha, pi_like(a, alpha) / 2, offset, b, alpha34)


def _twist(
    name: str, degrees: float, meaning: str, low: float = 15, high: float = 165
) -> Parameter:
    return Parameter(
        name, radians(degrees), "angle", meaning, radians(low), radians(high)
    )


def _length(degrees: float) -> Parameter:
    return Parameter(
        "a", 1.7 * sin(radians(degrees)), "length", "length of link a", 0.3, 3.0
    )


_ABC = (
    _length(66),
    _twist("alpha", 66, "twist of link a"),
    _twist("beta", 50, "twist of the common link b"),
    _twist("gamma", 28, "twist of link c"),
)
_OFFSET = Parameter("offset", 0.4, "length", "R3 = R4", -0.5, 0.5)
_RATIO = "sin(twist)/length is the same for the links a, b, c"
_MYARD_LINK = (
    _length(35),
    _twist("alpha", 35, "twist of link 12; that of link 51 is pi - alpha", 15, 75),
)
_MYARD_CONDITIONS = (
    "a12 = a51, a23 = a45, a34 = 0, alpha12 + alpha51 = pi, alpha23 = alpha45",
    "sin(alpha12)/a12 = sin(alpha23)/a23",
    "cos(alpha34/2) = sin(alpha12) / sqrt(1 + (R3 sin(alpha23)/a23)^2)",
    "R1 = R2 = R5 = 0, R3 = R4",
)
_MYARD_ERRATUM = (
    "alpha34 = pi - 2 alpha is printed for any R3 = R4; it holds for R3 = R4 = 0 only"
)
_FACTS = {"joints": 5, "mobility": 1}

ENTRIES = (
    Entry(
        "syncopated-goldberg-5r",
        "Syncopated Goldberg 5R",
        "Goldberg (1943); Baker (1979); Song (2013), eq. 2.3.2",
        syncopated_goldberg,
        _ABC,
        (
            _RATIO,
            "a12 = a34 = d - b, a23 = a + c, a45 = c, a51 = a, twists likewise, R = 0",
            "m(alpha, beta) m(gamma, beta) = m(delta, alpha + gamma), m(x, y) = sin((x+y)/2)/sin((x-y)/2)",
            "sin(delta)/d = sin(alpha + gamma)/(a + c)",
        ),
        facts=_FACTS,
    ),
    Entry(
        "generalized-goldberg-5r",
        "Generalized Goldberg 5R",
        "Goldberg (1943); Wohlhart (1991a); Song (2013), eq. 2.3.3",
        generalized_goldberg,
        (
            *_ABC,
            _twist(
                "kink", 40, "angle at which the links a and c are locked", -120, 120
            ),
        ),
        (
            "a12 = a34, alpha12 = alpha34, equal ratio sin(twist)/length of the links 12, 45, 51",
            "cos(alpha23) = cos(alpha45) cos(alpha51) - cos(kink) sin(alpha45) sin(alpha51)",
            "a23 = a12/sin(alpha12) (cos(alpha45) + cos(alpha51)) tan(alpha23/2)",
            "R1 = R4 = R5 = 0",
            "R2 = R3 = a12/sin(alpha12) sin(kink) sin(alpha45) sin(alpha51)/(1 + cos(alpha23))",
        ),
        facts=_FACTS,
    ),
    Entry(
        "myard-plane-symmetric-5r",
        "Plane-symmetric Myard 5R",
        "Myard (1931); Song (2013), eq. 2.3.4",
        myard_plane_symmetric,
        (*_MYARD_LINK, _OFFSET),
        (*_MYARD_CONDITIONS, "alpha23 = pi/2"),
        errata=(_MYARD_ERRATUM, "alpha41 = pi/2 is printed for alpha45"),
        facts=_FACTS,
    ),
    Entry(
        "extended-myard-5r",
        "Extended Myard 5R",
        "Chen and You (2008a); Song (2013), eq. 2.3.5",
        extended_myard,
        (*_MYARD_LINK, _twist("beta", 62, "twist of the links 23 and 45"), _OFFSET),
        _MYARD_CONDITIONS,
        errata=(_MYARD_ERRATUM,),
        facts=_FACTS,
    ),
    Entry(
        "myard-asymmetric-5r",
        "Asymmetric Myard 5R",
        "Myard (1931); Baker (1979)",
        myard_asymmetric,
        (
            _length(28),
            _twist("alpha", 28, "twist of 45 and 51"),
            _twist("beta", 50, "twist of 12 and 34"),
        ),
        ("a Goldberg 5R with a = c, alpha = gamma, R = 0",),
        facts=_FACTS,
    ),
)
