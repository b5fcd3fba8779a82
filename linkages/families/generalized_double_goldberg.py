"""Two generalized Goldberg 5R linkages on their common link pair: Wohlhart's
double-Goldberg 6R with kink angles.

The pair a, c turns alike in both, so that its ends may be bridged at any kink angle on
either side. Kinks 0, 0 give Wohlhart's linkage without offsets, pi, pi the
double-subtractive one, pi, 0 the mixed Type I; equal kinks give a linkage of Mavroidis
and Roth with R2 = R3 = -R5 = -R6.
"""

from __future__ import annotations

from math import radians, sin
from typing import Any

from linkages.construction.constructions import superpose
from linkages.entry import Entry, Parameter
from linkages.families.goldberg_5r import generalized_goldberg
from linkages.loop import Loop

__all__ = ["ENTRIES", "generalized_double_goldberg"]


def generalized_double_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    kink_1: Any,
    kink_2: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Links b, [a c], b, d, [a c], d, the pair a, c locked at ``kink_1`` and at
    ``kink_2`` (rad, or a `Kink`).

    Twists in rad; the lengths b, c, d follow from the Bennett ratio and are checked if
    given. Raises `GeometryError`. Source: Wohlhart (1991a), for equal kinks.
    """
    first = generalized_goldberg(a, alpha, beta, gamma, kink_1, b, c)
    second = generalized_goldberg(a, alpha, delta, gamma, kink_2, d, c)
    return superpose(first, second, shared=2)


ENTRIES = (
    Entry(
        "generalized-double-goldberg",
        "Wohlhart's double-Goldberg 6R with kink angles",
        "Wohlhart (1991a)",
        generalized_double_goldberg,
        (
            Parameter(
                "a", 1.7 * sin(radians(66)), "length", "length of link a", 0.3, 3.0
            ),
            *(
                Parameter(
                    name,
                    radians(value),
                    "angle",
                    f"twist of link {link}",
                    radians(15),
                    radians(110),
                )
                for name, value, link in (
                    ("alpha", 66, "a"),
                    ("beta", 50, "b"),
                    ("gamma", 28, "c"),
                    ("delta", 83, "d"),
                )
            ),
            *(
                Parameter(
                    f"kink_{k}",
                    radians(v),
                    "angle",
                    f"angle of a and c in the 5R with link {side}",
                    radians(-90),
                    radians(90),
                )
                for k, v, side in ((1, 40, "b"), (2, -25, "d"))
            ),
        ),
        (
            "sin(twist)/length is the same for the links a, b, c, d",
            "links 12 = 34 = b and 45 = 61 = d; links 23 and 56 and their offsets from the spatial triangles of a, c",
            "R1 = R4 = 0",
        ),
        facts={"joints": 6, "mobility": 1},
    ),
)
