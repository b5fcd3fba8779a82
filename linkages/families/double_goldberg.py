"""Wohlhart's double-Goldberg 6R (WDG) and the double-subtractive-Goldberg 6R (DSG),
general and special.

Links 12 and 45 are a + c / alpha + gamma (WDG) or a - c / alpha - gamma (DSG), links 23
and 61 are d / delta, links 34 and 56 are b / beta; all four basic links have one
Bennett ratio and all offsets vanish. This is the convention of Song 2013, eq. (5.2.1);
that of Song and Chen 2012, eq. (5.1), is got by exchanging beta and delta.
"""

from __future__ import annotations

import math
from typing import Any

from linkages.construction.conditions import (
    bennett_length,
    require_equal,
    require_positive,
    require_within,
)
from linkages.construction.numbers import atan, tan
from linkages.entry import Entry, Parameter
from linkages.families.double_goldberg_forms import patterns, special_patterns
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "double_subtractive_goldberg",
    "special_double_subtractive_goldberg",
    "special_wohlhart_double_goldberg",
    "wohlhart_double_goldberg",
]

THESIS = "Song 2013, Kinematic study of overconstrained linkages and design of reconfigurable mechanisms"
PAPER = "Song and Chen 2012, A special Wohlhart's double-Goldberg 6R linkage"


def _loop(
    sign: int,
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any,
    c: Any,
    d: Any,
    name: str,
) -> Loop:
    require_positive("length a", a)
    for which, twist in (
        ("alpha", alpha),
        ("beta", beta),
        ("gamma", gamma),
        ("delta", delta),
    ):
        require_within(f"twist {which}", twist, 0.0, math.pi)
    b = bennett_length("b/beta", beta, b, a, alpha)
    c = bennett_length("c/gamma", gamma, c, a, alpha)
    d = bennett_length("d/delta", delta, d, a, alpha)
    half = ((a + sign * c, alpha + sign * gamma), (d, delta), (b, beta))
    require_positive("length of links 12 and 45", half[0][0])
    order = (*half, half[0], half[2], half[1])
    return Loop(tuple(x for x, _ in order), tuple(y for _, y in order), (0,) * 6, name)


def wohlhart_double_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Wohlhart's double-Goldberg 6R of the links a/alpha, b/beta, c/gamma, d/delta.

    Twists in rad, between 0 and pi; lengths b, c, d follow from the Bennett ratio, and
    are checked when given. Raises `GeometryError` for a ratio that differs. Sources:
    Wohlhart 1991; Song 2013, eqs (5.2.1)-(5.2.5), where the products m1 m2 of (5.2.4)
    and 2 m2 Q of (5.2.5) must be m1 m6 and 2 m6 Q.
    """
    return _loop(+1, a, alpha, beta, gamma, delta, b, c, d, "wohlhart-double-goldberg")


def double_subtractive_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """The double-subtractive-Goldberg 6R of the links a/alpha, b/beta, c/gamma,
    d/delta, with a > c.

    Parameters and errors as in `wohlhart_double_goldberg`. Source: Song 2013, eqs
    (5.2.1), (5.2.6)-(5.2.8).
    """
    return _loop(
        -1, a, alpha, beta, gamma, delta, b, c, d, "double-subtractive-goldberg"
    )


def _special_gamma(alpha: Any, beta: Any, delta: Any, gamma: Any) -> Any:
    """The twist gamma with tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2); a
    given one is checked."""
    expected = tan(beta / 2) * tan(delta / 2)
    if gamma is None:
        return 2 * atan(expected / tan(alpha / 2))
    require_equal(
        "tan(alpha/2) tan(gamma/2)",
        tan(alpha / 2) * tan(gamma / 2),
        expected,
        "tan(beta/2) tan(delta/2)",
    )
    return gamma


def special_wohlhart_double_goldberg(
    a: Any, alpha: Any, beta: Any, delta: Any, gamma: Any = None
) -> Loop:
    """Wohlhart's double-Goldberg 6R with tan(alpha/2) tan(gamma/2) = tan(beta/2)
    tan(delta/2).

    Its Form I is a Bennett linkage of the joints 1, 2, 4, 5. The twist gamma (rad)
    follows, and is checked when given. Sources: Song and Chen 2012, eqs (5.10)-(5.13),
    where m1/m2 of Form II in (5.13) must be m2/tan(theta1/2); Song 2013, eqs (5.2.25),
    (5.2.33).
    """
    gamma = _special_gamma(alpha, beta, delta, gamma)
    return wohlhart_double_goldberg(a, alpha, beta, gamma, delta)


def special_double_subtractive_goldberg(
    a: Any, alpha: Any, beta: Any, delta: Any, gamma: Any = None
) -> Loop:
    """The double-subtractive-Goldberg 6R with tan(alpha/2) tan(gamma/2) = tan(beta/2)
    tan(delta/2).

    Its Form II is a Bennett linkage of the joints 1, 2, 4, 5. The twist gamma (rad)
    follows, and is checked when given. Source: Song 2013, eqs (5.2.25),
    (5.2.33)-(5.2.34), where b must be 1.0572, not 1.5072.
    """
    gamma = _special_gamma(alpha, beta, delta, gamma)
    return double_subtractive_goldberg(a, alpha, beta, gamma, delta)


def _twist(name: str, degrees: float, low: float = 10, high: float = 170) -> Parameter:
    return Parameter(
        name,
        math.radians(degrees),
        "angle",
        f"twist {name} of a basic link",
        math.radians(low),
        math.radians(high),
    )


GENERAL = (
    Parameter(
        "a",
        1.7 * math.sin(math.radians(66)),
        "length",
        "length of the basic link a/alpha",
        0.3,
        3.0,
    ),
    *(
        _twist(*which)
        for which in (("alpha", 66), ("beta", 50), ("gamma", 28), ("delta", 83))
    ),
)
SPECIAL = (
    Parameter("a", 1.0, "length", "length of the basic link a/alpha", 0.3, 3.0),
    *(_twist(*which) for which in (("alpha", 125), ("beta", 60), ("delta", 45))),
)
RATIO = "sin(alpha)/a = sin(beta)/b = sin(gamma)/c = sin(delta)/d, all offsets 0"
TANGENTS = "tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2)"
SUM = "links 12 and 45: a + c, alpha + gamma; 23 and 61: d, delta; 34 and 56: b, beta"
DIFFERENCE = (
    "links 12 and 45: a - c, alpha - gamma; 23 and 61: d, delta; 34 and 56: b, beta"
)
SWITCHING = (
    "Song 2013, eqs (5.2.4), (5.2.5): m1 m2 and m2 Q must be m1 m6 and m6 Q; the switch of the root is at "
    "tan(theta1/2) = sqrt(-m3 m4), and only if m3 m4 < 0"
)

ENTRIES: tuple[Entry, ...] = (
    Entry(
        "wohlhart-double-goldberg",
        "Wohlhart's double-Goldberg 6R linkage",
        f"Wohlhart 1991, Mech. Mach. Theory 26, 659-668; {THESIS}, eqs (5.2.1)-(5.2.5)",
        wohlhart_double_goldberg,
        GENERAL,
        conditions=(SUM, RATIO),
        patterns=lambda a, alpha, beta, gamma, delta: patterns(
            +1, alpha, beta, gamma, delta
        ),
        errata=(SWITCHING,),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 4,
            "bifurcations": 4,
            "components": 1,
        },
    ),
    Entry(
        "double-subtractive-goldberg",
        "Double-subtractive-Goldberg 6R linkage",
        f"{THESIS}, eqs (5.2.1), (5.2.6)-(5.2.8)",
        double_subtractive_goldberg,
        GENERAL,
        conditions=(DIFFERENCE, RATIO),
        patterns=lambda a, alpha, beta, gamma, delta: patterns(
            -1, alpha, beta, gamma, delta
        ),
        errata=("Song 2013, eqs (5.2.13)-(5.2.17): m2 must be m6",),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 4,
            "bifurcations": 4,
            "components": 1,
        },
    ),
    Entry(
        "special-wohlhart-double-goldberg",
        "Special Wohlhart double-Goldberg 6R linkage",
        f"{PAPER}, eqs (5.10)-(5.13); {THESIS}, eqs (5.2.25), (5.2.33)",
        special_wohlhart_double_goldberg,
        SPECIAL,
        conditions=(SUM, RATIO, TANGENTS),
        patterns=lambda a, alpha, beta, delta: special_patterns(+1, alpha, beta, delta),
        errata=(
            "Song and Chen 2012, eq. (5.13), Form II: m1/m2 must be m2/tan(theta1/2)",
            SWITCHING,
        ),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 4,
            "bifurcations": 4,
            "components": 1,
        },
    ),
    Entry(
        "special-double-subtractive-goldberg",
        "Special double-subtractive-Goldberg 6R linkage",
        f"{THESIS}, eqs (5.2.25), (5.2.33)-(5.2.35)",
        special_double_subtractive_goldberg,
        SPECIAL,
        conditions=(DIFFERENCE, RATIO, TANGENTS),
        patterns=lambda a, alpha, beta, delta: special_patterns(-1, alpha, beta, delta),
        errata=("Song 2013, eq. (5.2.34): b = 1.5072 must be 1.0572",),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 4,
            "bifurcations": 4,
            "components": 1,
        },
    ),
)
