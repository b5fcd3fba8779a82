"""Waldron's hybrid 6R: two Bennett loops, of any ratios, with a joint axis in
common."""

from __future__ import annotations

from math import radians, sin
from typing import Any

from linkages.construction.constructions import share_joint
from linkages.construction.link import bennett_links, closed_chain
from linkages.construction.spatial_triangle import Kink
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "waldron_collinear", "waldron_hybrid"]


def waldron_hybrid(
    a: Any,
    alpha: Any,
    beta: Any,
    c: Any,
    gamma: Any,
    delta: Any,
    kink_1: Any,
    kink_2: Any,
    shift: Any,
    b: Any = None,
    d: Any = None,
) -> Loop:
    """Waldron's hybrid 6R of the Bennett loops a, b and c, d: links b, a, [b d], c, d,
    [c a].

    Twists in rad; the lengths b and d follow from the two Bennett ratios, and are
    checked if given; the links b, d are locked at ``kink_1`` and c, a at ``kink_2``
    (rad, or a `Kink`); ``shift`` is the distance of the loops along the common axis.
    Source: Waldron (1968); Baker (1993a) for the geometry.
    """
    a, b = bennett_links(a, alpha, b=(beta, b))
    c, d = bennett_links(c, gamma, d=(delta, d))
    return share_joint(
        closed_chain(a, b, a, b), closed_chain(d, c, d, c), kink_1, kink_2, shift
    )


def waldron_collinear(
    a: Any,
    alpha: Any,
    beta: Any,
    c: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    d: Any = None,
) -> Loop:
    """Waldron's hybrid 6R without offsets: b and d folded upon each other, a and c in
    line.

    Links b, a, b - d, c, d, a + c. Source: Yu and Baker (1981); section 2.4.6 in Song
    (2013).
    """
    return waldron_hybrid(
        a, alpha, beta, c, gamma, delta, Kink.FOLDED, Kink.STRAIGHT, 0, b, d
    )


def _twist(name: str, degrees: float, link: str) -> Parameter:
    return Parameter(
        name,
        radians(degrees),
        "angle",
        f"twist of link {link}",
        radians(15),
        radians(110),
    )


_LOOPS = (
    Parameter("a", 1.7 * sin(radians(35)), "length", "length of link a", 0.3, 3.0),
    _twist("alpha", 35, "a"),
    _twist("beta", 62, "b"),
    Parameter("c", 1.25 * sin(radians(81)), "length", "length of link c", 0.3, 3.0),
    _twist("gamma", 81, "c"),
    _twist("delta", 48, "d"),
)
_RATIOS = "sin(alpha)/a = sin(beta)/b and sin(gamma)/c = sin(delta)/d"

ENTRIES = (
    Entry(
        "waldron-hybrid",
        "Waldron's hybrid 6R of two Bennett loops",
        "Waldron (1968); Baker (1993a); Song (2013), section 2.4.5",
        waldron_hybrid,
        (
            *_LOOPS,
            Parameter(
                "kink_1",
                radians(25),
                "angle",
                "angle between b and d",
                radians(-120),
                radians(120),
            ),
            Parameter(
                "kink_2",
                radians(-70),
                "angle",
                "angle between c and a",
                radians(-120),
                radians(120),
            ),
            Parameter(
                "shift", 0.37, "length", "distance along the common axis", -1.0, 1.0
            ),
        ),
        (
            _RATIOS,
            "links 34 and 61 and the offsets R1, R3, R4, R6 from the spatial triangles",
            "R2 = R5 = 0",
        ),
        facts={"joints": 6, "mobility": 1},
    ),
    Entry(
        "waldron-collinear",
        "Waldron's hybrid 6R with collinear links",
        "Waldron (1968); Yu and Baker (1981); Song (2013), section 2.4.6",
        waldron_collinear,
        _LOOPS,
        (_RATIOS, "links b, a, b-d, c, d, a+c, twists likewise, R = 0"),
        facts={"joints": 6, "mobility": 1},
    ),
)
