"""The Goldberg 5R linkage and the subtractive Goldberg 5R linkage.

Both join two Bennett linkages at a common link b/beta: the other links a/alpha and
c/gamma are added, or laid back on each other, in link 23; links 45 and 51 are c/gamma
and a/alpha.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    only,
    plus,
    reciprocal,
    tangent,
)
from linkages.construction.conditions import (
    bennett_length,
    require_different,
    require_positive,
    require_within,
)
from linkages.construction.numbers import Number
from linkages.construction.table_equations import zero_offsets
from linkages.entry import (
    Condition,
    Entry,
    FormPattern,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
from linkages.loop import Loop

POSITION = 40
SONG = "Song 2013, Kinematic study of overconstrained linkages"
SUM, DIFFERENCE = +1, -1  # how a and c are joined


def _loop(
    sign: int,
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None,
    c: Number | None,
    name: str,
) -> Loop:
    require_positive("length a", a)
    require_within("twist alpha", alpha, 0.0, math.pi)
    require_within("twist beta", beta, 0.0, math.pi)
    require_within("twist gamma", gamma, 0.0, math.pi)
    b = bennett_length("b/beta", beta, b, a, alpha)
    c = bennett_length("c/gamma", gamma, c, a, alpha)
    joined = a + sign * c
    require_positive("length of link 23", joined)
    if sign < 0:
        require_different("twist gamma", gamma, alpha, "alpha, whose link it cancels")
    lengths = (b, joined, b, c, a)
    twists = (beta, alpha + sign * gamma, beta, gamma, alpha)
    return Loop(lengths, twists, (0,) * 5, name)


def goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """The Goldberg 5R with links 12, 23, 34, 45, 51: b, a + c, b, c, a, and the twists
    likewise, in rad.

    Lengths b and c follow from the Bennett ratio of a/alpha, and are checked when
    given. Raises `GeometryError` for another ratio. theta1 + theta4 = pi and theta2 +
    theta3 + theta5 = pi. Sources: Goldberg 1943; Song 2013, eqs (2.3.1), (3.2.1),
    (3.2.2); Song and Chen, A family of mixed double-Goldberg 6R linkages, eqs (2.1),
    (2.2).
    """
    return _loop(SUM, a, alpha, beta, gamma, b, c, "goldberg-5r")


def subtractive_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """The subtractive Goldberg 5R with links b, a - c, b, c, a, and the twists
    likewise, in rad; a > c.

    Parameters and errors as in `goldberg`. theta1 + theta4 = 0 and theta2 + theta3 +
    theta5 = 0. Sources: Song and Chen 2011; Song 2013, eqs (3.2.3), (3.2.4), where link
    23 must be a51 - a45 / alpha51 - alpha45 and tan(theta3/2) = tan(theta1/2)
    sin((gamma - beta)/2) / sin((gamma + beta)/2).
    """
    return _loop(DIFFERENCE, a, alpha, beta, gamma, b, c, "subtractive-goldberg-5r")


# --- forms and closed forms


def _pattern(name: str, sign: int) -> Callable[..., tuple[FormPattern, ...]]:
    zero = np.cos if sign > 0 else np.sin

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.moveaxis(np.asarray(theta) / 2, -1, 0)
        opposite = zero(h[0] + h[3])
        others = zero(h[1] + h[2] + h[4])
        return np.stack([opposite, others], axis=-1)

    return lambda **values: (FormPattern(name, residual),)


def goldberg_closed_form(
    linkage: str,
    sign: int,
    alpha: Number,
    beta: Number,
    gamma: Number,
    angles: tuple[str, ...],
    constants: Mapping[str, Number],
) -> ClosedForm:
    """The closed form of the links b, a + ``sign`` c, b, c, a with the half tangents
    ``alpha``, ``beta``, ``gamma``.

    ``angles`` are the parameters of the linkage that it depends on, ``constants`` those
    in which the half tangents are written. Song (2013), equations (3.2.2) and (2.2) of
    Song and Chen (2012); for the difference (3.2.4) and (2.4), where the factor of
    tan(theta3/2) is printed inverted.
    """
    first = joint(1)
    s_1, c_1 = first
    m_c = constant("m_c")
    second = reciprocal(first, constant("m_a"))
    third: Pair
    if sign > 0:
        name = "Goldberg form"
        source = "(3.2.2)"
        third = (m_c * s_1, c_1)
        rest = HALF_TURN
    else:
        name = "subtractive Goldberg form"
        source = "(3.2.4), the factor of tan(theta3/2) inverted"
        third = (s_1, m_c * c_1)
        rest = ZERO
    fourth = minus(rest, first)
    fifth = minus(rest, plus(second, third))
    factors = {
        "m_a": (alpha + beta) / (alpha - beta),
        "m_c": (gamma + beta) / (gamma - beta),
    }
    return ClosedForm(
        linkage,
        name,
        "Song 2013, eq. " + source,
        angles,
        only(first, second, third, fourth, fifth),
        {**constants, **factors},
    )


def _formulas(linkage: str, sign: int) -> Callable[[], tuple[ClosedForm, ...]]:
    names = ("alpha", "beta", "gamma")

    def formulas() -> tuple[ClosedForm, ...]:
        alpha, beta, gamma = (tangent(name) for name in names)
        form = goldberg_closed_form(linkage, sign, alpha, beta, gamma, names, {})
        return (form,)

    return formulas


# --- entries


def _twist(name: str, degrees: float, meaning: str) -> Parameter:
    default = math.radians(degrees)
    return Parameter(name, default, ParameterKind.ANGLE, meaning, 0.15, math.pi - 0.15)


def _links(sign: str) -> Condition:
    return Condition(
        f"links 12, 23, 34, 45, 51: b, a {sign} c, b, c, a; twists likewise"
    )


LENGTH = 1.7 * math.sin(math.radians(66))
PARAMETERS = (
    Parameter.length("a", LENGTH, "length of link 51", 0.3, 3.0),
    _twist("alpha", 66, "twist of link 51"),
    _twist("beta", 50, "twist of links 12 and 34"),
    _twist("gamma", 28, "twist of link 45"),
)
RATIO = Condition(
    "sin(alpha)/a = sin(beta)/b = sin(gamma)/c, all offsets 0", (zero_offsets(),)
)
FACTS = {"mobility": 1, "rank": 4, "forms": 1}

ENTRIES: tuple[Entry, ...] = (
    Entry(
        "goldberg-5r",
        "Goldberg 5R linkage",
        f"Goldberg 1943; {SONG}, eqs (2.3.1), (3.2.1), (3.2.2)",
        goldberg,
        PARAMETERS,
        conditions=(_links("+"), RATIO),
        patterns=_pattern("Goldberg form", SUM),
        formulas=_formulas("goldberg-5r", SUM),
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE,
                "generalized-goldberg-5r",
                "Song (2013), eq. 2.3.3",
            ),
            Relation(
                RelationKind.DEGENERATE,
                "bennett",
                "Goldberg (1943)",
                "gamma to 0: its link vanishes",
                vanishing="gamma",
            ),
            Relation(
                RelationKind.CONSTRUCTED,
                "bennett",
                "Goldberg (1943)",
                "summation of two loops",
            ),
        ),
        errata=(
            "Song 2013, eq. (3.2.1): sin(alpha12)/a12 stands for the ratios of links "
            "45 and 51 as well",
        ),
        facts=FACTS,
    ),
    Entry(
        "subtractive-goldberg-5r",
        "Subtractive Goldberg 5R linkage",
        f"Song and Chen 2011; {SONG}, eqs (3.2.3), (3.2.4)",
        subtractive_goldberg,
        PARAMETERS,
        conditions=(_links("-"), RATIO),
        patterns=_pattern("subtractive Goldberg form", DIFFERENCE),
        formulas=_formulas("subtractive-goldberg-5r", DIFFERENCE),
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE,
                "generalized-goldberg-5r",
                "Song (2013), eq. 2.3.3",
            ),
            Relation(
                RelationKind.CONSTRUCTED,
                "bennett",
                "Song and Chen (2011)",
                "subtraction of two loops",
            ),
        ),
        errata=(
            "Song 2013, eq. (3.2.3): a45 - a51 must be a51 - a45 to agree with (3.2.4) "
            "and chapter 3",
            "Song 2013, eq. (3.2.4): tan(theta3/2) has its factor inverted",
        ),
        facts=FACTS,
    ),
)
