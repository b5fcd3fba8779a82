"""The Goldberg 5R linkage and the subtractive Goldberg 5R linkage.

Both join two Bennett linkages at a common link b/beta: the other links a/alpha and
c/gamma are added, or laid back on each other, in link 23; links 45 and 51 are c/gamma
and a/alpha.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_within,
)
from linkages.entry import Entry, FormPattern, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "goldberg", "subtractive_goldberg"]

SONG = "Song 2013, Kinematic study of overconstrained linkages"


def _loop(
    sign: int, a: Any, alpha: Any, beta: Any, gamma: Any, b: Any, c: Any, name: str
) -> Loop:
    require_positive("length a", a)
    for which, twist in (("alpha", alpha), ("beta", beta), ("gamma", gamma)):
        require_within(f"twist {which}", twist, 0.0, math.pi)
    b = bennett_length("b/beta", beta, b, a, alpha)
    c = bennett_length("c/gamma", gamma, c, a, alpha)
    require_positive("length of link 23", a + sign * c)
    return Loop(
        (b, a + sign * c, b, c, a),
        (beta, alpha + sign * gamma, beta, gamma, alpha),
        (0,) * 5,
        name,
    )


def goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, b: Any = None, c: Any = None
) -> Loop:
    """The Goldberg 5R with links 12, 23, 34, 45, 51: b, a + c, b, c, a, and the twists
    likewise, in rad.

    Lengths b and c follow from the Bennett ratio of a/alpha, and are checked when
    given. Raises `GeometryError` for another ratio. theta1 + theta4 = pi and theta2 +
    theta3 + theta5 = pi. Sources: Goldberg 1943; Song 2013, eqs (2.3.1), (3.2.1),
    (3.2.2); Song and Chen, A family of mixed double-Goldberg 6R linkages, eqs (2.1),
    (2.2).
    """
    return _loop(+1, a, alpha, beta, gamma, b, c, "goldberg-5r")


def subtractive_goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, b: Any = None, c: Any = None
) -> Loop:
    """The subtractive Goldberg 5R with links b, a - c, b, c, a, and the twists
    likewise, in rad; a > c.

    Parameters and errors as in `goldberg`. theta1 + theta4 = 0 and theta2 + theta3 +
    theta5 = 0. Sources: Song and Chen 2011; Song 2013, eqs (3.2.3), (3.2.4), where link
    23 must be a51 - a45 / alpha51 - alpha45 and tan(theta3/2) = tan(theta1/2)
    sin((gamma - beta)/2) / sin((gamma + beta)/2).
    """
    return _loop(-1, a, alpha, beta, gamma, b, c, "subtractive-goldberg-5r")


def _pattern(name: str, sign: int) -> Any:
    zero = np.cos if sign > 0 else np.sin

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.asarray(theta) / 2
        return np.stack(
            [zero(h[..., 0] + h[..., 3]), zero(h[..., 1] + h[..., 2] + h[..., 4])],
            axis=-1,
        )

    return lambda **values: (FormPattern(name, residual),)


PARAMETERS = (
    Parameter(
        "a", 1.7 * math.sin(math.radians(66)), "length", "length of link 51", 0.3, 3.0
    ),
    Parameter(
        "alpha", math.radians(66), "angle", "twist of link 51", 0.15, math.pi - 0.15
    ),
    Parameter(
        "beta",
        math.radians(50),
        "angle",
        "twist of links 12 and 34",
        0.15,
        math.pi - 0.15,
    ),
    Parameter(
        "gamma", math.radians(28), "angle", "twist of link 45", 0.15, math.pi - 0.15
    ),
)
RATIO = "sin(alpha)/a = sin(beta)/b = sin(gamma)/c, all offsets 0"

ENTRIES: tuple[Entry, ...] = (
    Entry(
        "goldberg-5r",
        "Goldberg 5R linkage",
        f"Goldberg 1943; {SONG}, eqs (2.3.1), (3.2.1), (3.2.2)",
        goldberg,
        PARAMETERS,
        conditions=(
            "links 12, 23, 34, 45, 51: b, a + c, b, c, a; twists likewise",
            RATIO,
        ),
        patterns=_pattern("Goldberg form", +1),
        errata=(
            "Song 2013, eq. (3.2.1): sin(alpha12)/a12 stands for the ratios of links 45 and 51 as well",
        ),
        facts={"mobility": 1, "rank": 4, "forms": 1},
    ),
    Entry(
        "subtractive-goldberg-5r",
        "Subtractive Goldberg 5R linkage",
        f"Song and Chen 2011; {SONG}, eqs (3.2.3), (3.2.4)",
        subtractive_goldberg,
        PARAMETERS,
        conditions=(
            "links 12, 23, 34, 45, 51: b, a - c, b, c, a; twists likewise",
            RATIO,
        ),
        patterns=_pattern("subtractive Goldberg form", -1),
        errata=(
            "Song 2013, eq. (3.2.3): a45 - a51 must be a51 - a45 to agree with (3.2.4) and chapter 3",
            "Song 2013, eq. (3.2.4): tan(theta3/2) has its factor inverted",
        ),
        facts={"mobility": 1, "rank": 4, "forms": 1},
    ),
)
