"""The other 5R linkages of Goldberg's family: syncopated, generalized, and those of
Myard.

All are made of two Bennett loops with a common link; the plain and the subtractive
Goldberg linkage stand in `linkages.families.goldberg`. Twists in rad. Only the length
of link a is free: the others follow from the Bennett ratio, and are checked where they
are given.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin, sqrt, tan

import numpy as np

from linkages.closed_forms.closed_form import ClosedForm, constant, ratio, tangent
from linkages.construction import numbers
from linkages.construction.basic_links import length_a
from linkages.construction.conditions import require_different, require_equal
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import Number, pi_like
from linkages.construction.possible_angles import half_tangents, kinks, twists_with
from linkages.construction.spatial_triangle import KinkAngle, composite_link
from linkages.construction.table_equations import (
    TableNumbers,
    equal_lengths,
    equal_links,
    equal_offsets,
    equal_twists,
    equation,
    supplementary_twists,
    twists_of_value,
    zero_lengths,
    zero_offsets,
)
from linkages.entry import (
    BY_IDENTIFICATION,
    Condition,
    Entry,
    Guesses,
    Parameter,
    Relation,
    RelationKind,
)
from linkages.families.goldberg import goldberg_closed_form
from linkages.loop import Loop

POSITION = 50


def syncopated_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """Syncopated Goldberg 5R: a Goldberg 5R taken from a Bennett loop with sides a + c
    and d.

    d/delta follows from the three twists. Raises `GeometryError` where that loop does
    not exist: for beta equal to alpha or gamma. Source: Goldberg (1943), fig. 2.3.1b
    and equation (2.3.2) in Song (2013); Baker (1979) showed it to be a Goldberg 5R with
    link d - b in place of b.
    """
    link_a, link_b, link_c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    product = half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, beta)
    joined = link_a + link_c
    side = syncopated_link(joined, product) - link_b
    return closed_chain(side, joined, side, link_c, link_a)


def generalized_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    kink: KinkAngle,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """Generalized Goldberg 5R: the links a and c locked at the angle ``kink`` (rad, or
    a `Kink`).

    R2 = R3 is the offset that the composite link brings. Source: Goldberg (1943),
    Wohlhart (1991a); equation (2.3.3) in Song (2013).
    """
    link_a, link_b, link_c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    joined = composite_link(link_a, link_c, kink)
    offsets = (0, joined.before.offset, joined.after.offset, 0, 0)
    return closed_chain(link_b, joined.link, link_b, link_c, link_a, offsets=offsets)


def myard_asymmetric(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """Asymmetric Myard 5R: the Goldberg 5R of two equal Bennett loops. Source: Myard
    (1931), Baker (1979)."""
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    return closed_chain(link_b, link_a + link_a, link_b, link_a, link_a)


def extended_myard(
    a: Number,
    alpha: Number,
    beta: Number,
    offset: Number = 0,
    b: Number | None = None,
    alpha34: Number | None = None,
) -> Loop:
    """Extended Myard 5R, plane-symmetric, with R3 = R4 = ``offset``.

    ``alpha34`` follows: cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3 sin(beta)/b)^2). If
    given it is checked. Source: Chen and You (2008a), equation (2.3.5) in Song (2013),
    where alpha34 = pi - 2 alpha is printed for any R3 = R4; that holds for R3 = 0 only.
    Raises `GeometryError`.
    """
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    half_turn = pi_like(alpha, beta, offset)
    middle = _middle_twist(alpha, beta, offset, link_b, half_turn)
    if alpha34 is not None:
        require_equal("alpha34", alpha34, middle, "which goes with R3 = R4")
    last = Link(link_a.length, half_turn - alpha)
    offsets = (0, 0, offset, offset, 0)
    return closed_chain(link_a, link_b, Link(0, middle), link_b, last, offsets=offsets)


def _middle_twist(
    alpha: Number, beta: Number, offset: Number, b: Link, half_turn: Number
) -> Number:
    """alpha34 of the extended Myard linkage."""
    if offset == 0:
        return half_turn - 2 * alpha
    require_different("length of link b", b.length, 0, "which holds no offset", scale=0)
    shear = offset * numbers.sin(beta) / b.length
    return 2 * numbers.acos(numbers.sin(alpha) / numbers.sqrt(1 + shear**2))


def myard_plane_symmetric(
    a: Number,
    alpha: Number,
    offset: Number = 0,
    b: Number | None = None,
    alpha34: Number | None = None,
) -> Loop:
    """Plane-symmetric Myard 5R: `extended_myard` with right-angled links 23 and 45.

    Source: Myard (1931), equation (2.3.4) in Song (2013) with alpha45 = pi/2 where
    alpha41 is printed.
    """
    right_angle = pi_like(a, alpha) / 2
    return extended_myard(a, alpha, right_angle, offset, b, alpha34)


# --- closed forms


def _syncopated_formulas() -> tuple[ClosedForm, ...]:
    """The link b of the Goldberg 5R is the difference of d and b, with half tangent
    u_side."""
    alpha, beta, gamma = (tangent(name) for name in ("alpha", "beta", "gamma"))
    p = constant("p")
    u_delta = constant("u_delta")
    constants = {
        "p": ratio("alpha", "beta") * ratio("gamma", "beta"),
        "u_delta": (p + 1) / (p - 1) * (alpha + gamma) / (1 - alpha * gamma),
        "u_side": (u_delta - beta) / (1 + u_delta * beta),
    }
    form = goldberg_closed_form(
        "syncopated-goldberg-5r",
        +1,
        alpha,
        constant("u_side"),
        gamma,
        ("alpha", "beta", "gamma"),
        constants,
    )
    return (form,)


def _myard_formulas() -> tuple[ClosedForm, ...]:
    alpha = tangent("alpha")
    beta = tangent("beta")
    form = goldberg_closed_form(
        "myard-asymmetric-5r", +1, alpha, beta, alpha, ("alpha", "beta"), {}
    )
    return (form,)


# --- first guesses


def syncopation_guesses(side: int, alpha: int, gamma: int) -> Guesses:
    """The twist beta by tan(beta/2) tan((delta - beta)/2) = tan(alpha/2) tan(gamma/2).

    The arguments are columns of the table: of the link delta - beta, of a and of c.
    """

    def guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
        twists = form[1]
        product = np.tan(twists[alpha] / 2) * np.tan(twists[gamma] / 2)
        for half_tangent in half_tangents(twists[side]):
            other = product / half_tangent if half_tangent else np.inf
            for beta in twists_with(other):
                yield {"beta": beta}

    return guesses


def _kink_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    twists = form[1]
    for kink in kinks(twists[4], twists[3], twists[1]):
        yield {"kink": kink}


# --- conditions


def _ratio_gap(t: TableNumbers) -> float:
    """sin(alpha12)/a12 = sin(alpha23)/a23."""
    first = sin(t.alpha(12)) / t.a(12)
    second = sin(t.alpha(23)) / t.a(23)
    return first - second


def _middle_gap(t: TableNumbers) -> float:
    """cos(alpha34/2) = sin(alpha12) / sqrt(1 + (R3 sin(alpha23)/a23)^2)."""
    shear = t.R(3) * sin(t.alpha(23)) / t.a(23)
    left = cos(t.alpha(34) / 2)
    right = sin(t.alpha(12)) / sqrt(1 + shear**2)
    return left - right


def _joined_length_gap(t: TableNumbers) -> float:
    """a23 = a12/sin(alpha12) (cos(alpha45) + cos(alpha51)) tan(alpha23/2)."""
    sum_of_cosines = cos(t.alpha(45)) + cos(t.alpha(51))
    scale = t.a(12) / sin(t.alpha(12))
    return t.a(23) - scale * sum_of_cosines * tan(t.alpha(23) / 2)


RATIO = Condition("sin(twist)/length is the same for the links a, b, c")
MYARD_CONDITIONS = (
    Condition(
        "a12 = a51, a23 = a45, a34 = 0, alpha12 + alpha51 = pi, alpha23 = alpha45",
        (
            equal_lengths((12, 51), (23, 45)),
            zero_lengths(34),
            supplementary_twists((12, 51)),
            equal_twists((23, 45)),
        ),
    ),
    Condition("sin(alpha12)/a12 = sin(alpha23)/a23", (equation(_ratio_gap),)),
    Condition(
        "cos(alpha34/2) = sin(alpha12) / sqrt(1 + (R3 sin(alpha23)/a23)^2)",
        (equation(_middle_gap),),
    ),
    Condition(
        "R1 = R2 = R5 = 0, R3 = R4", (zero_offsets(1, 2, 5), equal_offsets((3, 4)))
    ),
)


# --- entries


def _twist(
    name: str, degrees: float, meaning: str, low: float = 15, high: float = 165
) -> Parameter:
    return Parameter.angle(name, degrees, meaning, low, high)


ABC = (
    length_a(66),
    _twist("alpha", 66, "twist of link a"),
    _twist("beta", 50, "twist of the common link b"),
    _twist("gamma", 28, "twist of link c"),
)
OFFSET = Parameter.length("offset", 0.4, "R3 = R4", -0.5, 0.5)
MYARD_LINK = (
    length_a(35),
    _twist("alpha", 35, "twist of link 12; that of link 51 is pi - alpha", 15, 75),
)
MYARD_ERRATUM = (
    "alpha34 = pi - 2 alpha is printed for any R3 = R4; it holds for R3 = R4 = 0 only"
)
FACTS = {"joints": 5, "mobility": 1}

ENTRIES = (
    Entry(
        "syncopated-goldberg-5r",
        "Syncopated Goldberg 5R",
        "Goldberg (1943); Baker (1979); Song (2013), eq. 2.3.2",
        syncopated_goldberg,
        ABC,
        conditions=(
            RATIO,
            Condition(
                "a12 = a34 = d - b, a23 = a + c, a45 = c, a51 = a, "
                "twists likewise, R = 0",
                (zero_offsets(),),
            ),
            Condition(
                "m(alpha, beta) m(gamma, beta) = m(delta, alpha + gamma), "
                "m(x, y) = sin((x+y)/2)/sin((x-y)/2)"
            ),
            Condition("sin(delta)/d = sin(alpha + gamma)/(a + c)"),
        ),
        formulas=_syncopated_formulas,
        guesses=syncopation_guesses(side=0, alpha=4, gamma=3),
        relations=(Relation(RelationKind.SAME, "goldberg-5r", "Baker (1979)"),),
        facts=FACTS,
    ),
    Entry(
        "generalized-goldberg-5r",
        "Generalized Goldberg 5R",
        "Goldberg (1943); Wohlhart (1991a); Song (2013), eq. 2.3.3",
        generalized_goldberg,
        (
            *ABC,
            _twist(
                "kink", 40, "angle at which the links a and c are locked", -120, 120
            ),
        ),
        conditions=(
            Condition(
                "a12 = a34, alpha12 = alpha34, equal ratio sin(twist)/length "
                "of the links 12, 45, 51",
                (equal_links((12, 34)),),
            ),
            Condition(
                "cos(alpha23) = cos(alpha45) cos(alpha51) "
                "- cos(kink) sin(alpha45) sin(alpha51)"
            ),
            Condition(
                "a23 = a12/sin(alpha12) (cos(alpha45) + cos(alpha51)) tan(alpha23/2)",
                (equation(_joined_length_gap),),
            ),
            Condition("R1 = R4 = R5 = 0", (zero_offsets(1, 4, 5),)),
            Condition(
                "R2 = R3 = a12/sin(alpha12) sin(kink) sin(alpha45) sin(alpha51)"
                "/(1 + cos(alpha23))"
            ),
        ),
        guesses=_kink_guesses,
        relations=(
            Relation(
                RelationKind.CONSTRUCTED,
                "bennett",
                "Wohlhart (1991a)",
                "two loops, links locked at a kink angle",
            ),
        ),
        facts=FACTS,
    ),
    Entry(
        "myard-plane-symmetric-5r",
        "Plane-symmetric Myard 5R",
        "Myard (1931); Song (2013), eq. 2.3.4",
        myard_plane_symmetric,
        (*MYARD_LINK, OFFSET),
        conditions=(
            *MYARD_CONDITIONS,
            Condition("alpha23 = pi/2", (twists_of_value(pi / 2, 23),)),
        ),
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE, "extended-myard-5r", "Chen and You (2008a)"
            ),
        ),
        errata=(MYARD_ERRATUM, "alpha41 = pi/2 is printed for alpha45"),
        facts=FACTS,
    ),
    Entry(
        "extended-myard-5r",
        "Extended Myard 5R",
        "Chen and You (2008a); Song (2013), eq. 2.3.5",
        extended_myard,
        (*MYARD_LINK, _twist("beta", 62, "twist of the links 23 and 45"), OFFSET),
        conditions=MYARD_CONDITIONS,
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE, "generalized-goldberg-5r", BY_IDENTIFICATION
            ),
        ),
        errata=(MYARD_ERRATUM,),
        facts=FACTS,
    ),
    Entry(
        "myard-asymmetric-5r",
        "Asymmetric Myard 5R",
        "Myard (1931); Baker (1979)",
        myard_asymmetric,
        (
            length_a(28),
            _twist("alpha", 28, "twist of 45 and 51"),
            _twist("beta", 50, "twist of 12 and 34"),
        ),
        conditions=(
            Condition(
                "a Goldberg 5R with a = c, alpha = gamma, R = 0", (zero_offsets(),)
            ),
        ),
        formulas=_myard_formulas,
        relations=(Relation(RelationKind.SPECIAL_CASE, "goldberg-5r", "Baker (1979)"),),
        facts=FACTS,
    ),
)
