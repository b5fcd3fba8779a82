"""6R linkages of three Bennett loops: serial and L-shape of Goldberg, their
syncopations, Baker's variants.

Twists in rad. Only the length of link a is free: b, c, d follow from the Bennett ratio,
and are checked where they are given. Every offset is zero unless a kink angle brings
one.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ClosedForm,
    constant,
    joint,
    minus,
    negative,
    only,
    plus,
    ratio,
    reciprocal,
)
from linkages.construction.basic_links import EQUAL_RATIOS, length_a, twists_of_links
from linkages.construction.constructions import lock, superpose
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import half_tangents, twists_with
from linkages.construction.spatial_triangle import KinkAngle
from linkages.construction.table_equations import zero_offsets
from linkages.entry import (
    BY_IDENTIFICATION,
    Condition,
    Entry,
    Parameter,
    Relation,
    RelationKind,
)
from linkages.families.goldberg_5r import syncopation_guesses
from linkages.loop import Loop

POSITION = 70
NETWORK = "from the network of Bennett loops of Song 2013, section 5.4"


def serial_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Serial Goldberg 6R: three Bennett loops in a row, links a, c, d in line. Source:
    Goldberg (1943)."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    joined = link_a + link_c + link_d
    return closed_chain(link_b, joined, link_b, link_d, link_c, link_a)


def syncopated_serial_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Syncopated serial Goldberg 6R: a serial one taken from a Bennett loop with sides
    a + c + d and e.

    Raises `GeometryError` for a beta equal to one of the other twists. Source: Goldberg
    (1943), equation (2.4.2) in Song (2013), whose triple product lacks a minus sign.
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    product = (
        half_angle_ratio(alpha, beta)
        * half_angle_ratio(gamma, beta)
        * half_angle_ratio(delta, beta)
    )
    joined = link_a + link_c + link_d
    side = syncopated_link(joined, -product) - link_b
    return closed_chain(side, joined, side, link_d, link_c, link_a)


def l_shape_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """L-shape Goldberg 6R: a Goldberg 5R and a Bennett loop across it on link a.
    Source: Goldberg (1943)."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    first = link_b + link_d
    second = link_a + link_c
    return closed_chain(first, second, link_b, link_c, link_d, link_a)


def syncopated_l_shape_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Syncopated L-shape Goldberg 6R: an L-shape one taken from a Bennett loop with
    sides a + c and e.

    Raises `GeometryError` for a beta equal to alpha or gamma. Source: Goldberg (1943),
    equation (2.4.4) in Song (2013).
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    product = half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, beta)
    joined = link_a + link_c
    link_e = syncopated_link(joined, product)
    first = link_b + link_d - link_e
    third = link_e - link_b
    return closed_chain(first, joined, third, link_c, link_d, link_a)


def serial_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Baker's variant of the serial Goldberg 6R: a, c in line on one side and c, d on
    the other.

    Source: Baker (1993a), equation (2.4.5) in Song (2013).
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    second = link_a + link_c
    fifth = link_c + link_d
    return closed_chain(link_b, second, link_d, link_b, fifth, link_a)


def l_shape_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Baker's variant of the L-shape Goldberg 6R: b, d in line on one side and c, d on
    the other.

    Source: Baker (1993a), equation (2.4.6) in Song (2013).
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d)
    )
    first = link_b + link_d
    fifth = link_c + link_d
    return closed_chain(first, link_a, link_c, link_b, fifth, link_a)


def generalized_serial_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """Serial Goldberg 6R with a, c locked at ``kink_1`` and that link and d at
    ``kink_2``, rad.

    Source: named by Goldberg (1943) and Song (2013), section 2.4.1, without formulas.
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    pair = _kinked_pair(link_a, link_b, link_c, kink_1)
    row = pair.relabelled(4)  # c a b [a.c] b
    third = closed_chain(link_d, link_b, link_d, link_b)
    return lock(superpose(row, third), 5, kink_2).relabelled(2)


def generalized_l_shape_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """L-shape Goldberg 6R with b, d locked at ``kink_2`` and a, c at ``kink_1``, rad.

    Source: named by Goldberg (1943) and Song (2013), section 2.4.1, without formulas.
    """
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    pair = _kinked_pair(link_a, link_b, link_c, kink_1)
    bent = pair.reversed().relabelled(4)
    third = closed_chain(link_d, link_a, link_d, link_a)
    across = lock(superpose(bent, third), 5, kink_2)
    return across.reversed().relabelled(1)


def _kinked_pair(a: Link, b: Link, c: Link, kink: KinkAngle) -> Loop:
    """Two Bennett loops on the link b, a and c locked: links a, b, [a.c], b, c."""
    first = closed_chain(a, b, a, b)
    second = closed_chain(c, b, c, b)
    return lock(superpose(first, second), 4, kink)


# --- closed forms


def _l_shape_variant_formulas() -> tuple[ClosedForm, ...]:
    """Three cells around a common axis, whose joints 2 and 0 are straight: p is the
    angle of a cell at its outer joint, v that at the joint before."""
    p_first = joint(1)
    v_first = reciprocal(p_first, constant("m_a"))
    v_second = minus(v_first, HALF_TURN)
    p_second = reciprocal(v_second, constant("m_b"))
    p_third = negative(plus(p_first, p_second))
    v_third = reciprocal(p_third, constant("m_c"))
    between = plus(minus(HALF_TURN, v_second), v_third)
    form = ClosedForm(
        "l-shape-goldberg-variant-6r",
        "form of three Bennett loops",
        NETWORK,
        ("alpha", "beta", "gamma", "delta"),
        only(p_first, p_second, between, p_third, negative(v_third), v_first),
        {
            "m_a": ratio("delta", "alpha"),
            "m_b": ratio("alpha", "beta"),
            "m_c": ratio("beta", "gamma"),
        },
    )
    return (form,)


def _serial_variant_formulas() -> tuple[ClosedForm, ...]:
    """Three cells in a row, whose joints U1 and V2 are straight."""
    p_first = negative(joint(1))
    v_first = reciprocal(p_first, constant("m_a"))
    v_second = minus(joint(1), HALF_TURN)
    p_second = reciprocal(v_second, constant("m_c"))
    p_third = minus(HALF_TURN, v_second)
    v_third = reciprocal(p_third, constant("m_d"))
    form = ClosedForm(
        "serial-goldberg-variant-6r",
        "form of three Bennett loops",
        NETWORK,
        ("alpha", "beta", "gamma", "delta"),
        only(
            joint(1),
            v_first,
            plus(plus(p_second, v_third), HALF_TURN),
            p_third,
            negative(v_third),
            minus(HALF_TURN, plus(v_first, p_second)),
        ),
        {
            "m_a": ratio("beta", "alpha"),
            "m_c": ratio("beta", "gamma"),
            "m_d": ratio("beta", "delta"),
        },
    )
    return (form,)


# --- first guesses


def difference_guesses(
    name: str, whole: int, part: int, form: np.ndarray
) -> Iterator[dict[str, float]]:
    """The twist ``name`` of a link that is added to, or subtracted from, the link in
    column ``part`` and makes the one in column ``whole``.

    The opposite difference comes too: a link c - b reads b - c where that is longer.
    """
    x = form[1, whole]
    y = form[1, part]
    for twist in (x - y, y - x, x + y):
        yield {name: twist % np.pi}


def _serial_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """A quadratic equation for tan(beta/2), from elementary symmetric functions of the
    other three tangents."""
    others = np.tan(form[1, 3:6] / 2)
    e1 = others.sum()
    e3 = others.prod()
    e2 = (e1**2 - (others**2).sum()) / 2
    for side in half_tangents(form[1, 0]):
        quadratic = [side * (e1 - e3), -(e1 * e2 - e3), side * e3 * (1 - e2)]
        for beta in twists_with(np.roots(quadratic)):
            yield {"beta": beta}


# every 30 degrees, none of them collinear
KINKS = tuple((np.linspace(-np.pi, np.pi, 12, endpoint=False) + 0.01).tolist())
KINK_SCAN = {"kink_1": KINKS, "kink_2": KINKS}


# --- entries


def _parameters(
    alpha: float, beta: float, gamma: float, delta: float
) -> tuple[Parameter, ...]:
    twists = twists_of_links(a=alpha, b=beta, c=gamma, d=delta)
    return length_a(alpha), *twists


def _kink(name: str, degrees: float, links: str) -> Parameter:
    return Parameter.angle(name, degrees, f"angle between {links}", -120, 120)


def _links(order: str) -> Condition:
    text = f"links {order}, twists likewise, R = 0"
    return Condition(text, (zero_offsets(),))


def _case_of(other: str, source: str) -> Relation:
    return Relation(RelationKind.SPECIAL_CASE, other, source)


def _grown_from_5r(detail: str) -> tuple[Relation, ...]:
    """What the serial and the L-shape linkage are to the Goldberg 5R."""
    without = Relation(
        RelationKind.DEGENERATE,
        "goldberg-5r",
        "Goldberg (1943)",
        "delta to 0: its link vanishes",
        vanishing="delta",
    )
    built = Relation(RelationKind.CONSTRUCTED, "goldberg-5r", "Goldberg (1943)", detail)
    return without, built


TYPICAL = _parameters(66, 50, 28, 83)
SLENDER = _parameters(35, 62, 41, 22)
FACTS = {"joints": 6, "mobility": 1}
SONG = "Song (2013), section 5.4"

ENTRIES = (
    Entry(
        "serial-goldberg-6r",
        "Serial Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.1",
        serial_goldberg,
        SLENDER,
        conditions=(EQUAL_RATIOS, _links("b, a+c+d, b, d, c, a")),
        relations=(
            _case_of("generalized-serial-goldberg-6r", "Goldberg (1943)"),
            *_grown_from_5r("a third loop in line"),
        ),
        facts=FACTS,
    ),
    Entry(
        "syncopated-serial-goldberg-6r",
        "Syncopated serial Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.2",
        syncopated_serial_goldberg,
        SLENDER,
        conditions=(
            EQUAL_RATIOS,
            _links("e-b, a+c+d, e-b, d, c, a"),
            Condition("sin(epsilon)/e = sin(alpha+gamma+delta)/(a+c+d)"),
            Condition(
                "m(alpha,beta) m(gamma,beta) m(delta,beta) "
                "= -m(epsilon, alpha+gamma+delta)"
            ),
        ),
        guesses=_serial_guesses,
        errata=(
            "the triple product is printed with + and then leaves the linkage rigid; "
            "it takes -",
        ),
        facts=FACTS,
    ),
    Entry(
        "l-shape-goldberg-6r",
        "L-shape Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.3",
        l_shape_goldberg,
        TYPICAL,
        conditions=(EQUAL_RATIOS, _links("b+d, a+c, b, c, d, a")),
        relations=(
            _case_of("generalized-l-shape-goldberg-6r", "Goldberg (1943)"),
            *_grown_from_5r("a third loop across"),
        ),
        facts=FACTS,
    ),
    Entry(
        "syncopated-l-shape-goldberg-6r",
        "Syncopated L-shape Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.4",
        syncopated_l_shape_goldberg,
        SLENDER,
        conditions=(
            EQUAL_RATIOS,
            _links("b+d-e, a+c, e-b, c, d, a"),
            Condition(
                "sin(epsilon)/e = sin(alpha+gamma)/(a+c), "
                "m(alpha,beta) m(gamma,beta) = m(epsilon, alpha+gamma)"
            ),
        ),
        guesses=syncopation_guesses(side=2, alpha=5, gamma=3),
        relations=(_case_of("generalized-l-shape-goldberg-6r", BY_IDENTIFICATION),),
        facts=FACTS,
    ),
    Entry(
        "serial-goldberg-variant-6r",
        "Variant of the serial Goldberg 6R",
        "Baker (1993a); Song (2013), eq. 2.4.5",
        serial_variant,
        TYPICAL,
        conditions=(EQUAL_RATIOS, _links("b, a+c, d, b, c+d, a")),
        guesses=partial(difference_guesses, "gamma", 1, 5),
        formulas=_serial_variant_formulas,
        relations=(_case_of("generalized-serial-goldberg-variant-6r", SONG),),
        facts=FACTS,
    ),
    Entry(
        "l-shape-goldberg-variant-6r",
        "Variant of the L-shape Goldberg 6R",
        "Baker (1993a); Song (2013), eq. 2.4.6",
        l_shape_variant,
        TYPICAL,
        conditions=(EQUAL_RATIOS, _links("b+d, a, c, b, c+d, a")),
        guesses=partial(difference_guesses, "delta", 0, 3),
        formulas=_l_shape_variant_formulas,
        relations=(_case_of("generalized-l-shape-goldberg-variant-6r", SONG),),
        facts=FACTS,
    ),
    Entry(
        "generalized-serial-goldberg-6r",
        "Serial Goldberg 6R with kink angles",
        "Goldberg (1943)",
        generalized_serial_goldberg,
        (*SLENDER, _kink("kink_1", 25, "a and c"), _kink("kink_2", -40, "c and d")),
        conditions=(
            EQUAL_RATIOS,
            Condition(
                "as the serial linkage, the links a, c, d locked at the two kink "
                "angles and replaced by one"
            ),
        ),
        scan=KINK_SCAN,
        facts=FACTS,
    ),
    Entry(
        "generalized-l-shape-goldberg-6r",
        "L-shape Goldberg 6R with kink angles",
        "Goldberg (1943)",
        generalized_l_shape_goldberg,
        (*TYPICAL, _kink("kink_1", 25, "a and c"), _kink("kink_2", -40, "b and d")),
        conditions=(
            EQUAL_RATIOS,
            Condition(
                "as the L-shape linkage, the pairs a, c and b, d locked at the kink "
                "angles"
            ),
        ),
        scan=KINK_SCAN,
        facts=FACTS,
    ),
)
