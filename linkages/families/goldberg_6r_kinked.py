"""6R linkages that a network of Bennett loops leaves when two of its joints are locked:
Baker's variants with kink angles, and an isomer of the L-shape linkage with kink
angles.

Named by Song (2013), sections 5.4.3 and 5.4.6, without formulas. All are the outer loop
of three or four Bennett loops, a/alpha, b/beta, c/gamma, d/delta of one Bennett ratio,
with two link pairs replaced by one link each. How they move follows from
`linkages.networks.network`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ClosedForm,
    Pair,
    constant,
    cosine_of,
    joint,
    minus,
    negative,
    only,
    plus,
    ratio,
    reciprocal,
    sine_of,
    tangent,
)
from linkages.construction import numbers
from linkages.construction.basic_links import EQUAL_RATIOS, length_a, twists_of_links
from linkages.construction.constructions import lock
from linkages.construction.link import bennett_links, closed_chain
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import kinks
from linkages.construction.spatial_triangle import KinkAngle
from linkages.construction.table_equations import zero_offsets
from linkages.entry import Condition, Entry, Parameter, Relation, RelationKind
from linkages.loop import Loop

POSITION = 75
SOURCE = "Song (2013), section 5.4"


def generalized_l_shape_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """Baker's variant of the L-shape Goldberg 6R with b, d locked at ``kink_1`` and c,
    d at ``kink_2`` (rad, or a `Kink`): links [b d], a, c, b, [c d], a. Source: Song
    (2013), case 2 of section 5.4.3."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    ring = closed_chain(link_d, link_b, link_a, link_c, link_b, link_c, link_d, link_a)
    return lock(lock(ring, 7, kink_2), 2, kink_1)


def generalized_serial_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """Baker's variant of the serial Goldberg 6R with a, c locked at ``kink_1`` and c, d
    at ``kink_2`` (rad, or a `Kink`): links b, [a c], d, b, [c d], a. Source: Song
    (2013), section 5.4.6."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    ring = closed_chain(link_b, link_a, link_c, link_d, link_b, link_d, link_c, link_a)
    return lock(lock(ring, 7, kink_2), 3, kink_1)


def isomerized_l_shape(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """The isomer of the L-shape Goldberg 6R with kink angles: links [b d], [a c], b, d,
    c, a, the pair a, c locked at ``kink_1`` and b, d at ``kink_2`` (rad, or a `Kink`).
    Source: Song (2013), case 3 of section 5.4.3."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    ring = closed_chain(link_d, link_b, link_a, link_c, link_b, link_d, link_c, link_a)
    return lock(lock(ring, 4, kink_1), 2, kink_2)


# --- closed forms


class _Gains(NamedTuple):
    """What the joints before and after a link of two gain, as pairs."""

    before: Pair
    after: Pair


def _composite(
    number: int, first: str, second: str
) -> tuple[_Gains, dict[str, Number]]:
    """The gains of the links with these twists, locked at the kink of this number, and
    the constants in which they are written: the sine of the joint twist, and the
    projections of the spatial triangle."""
    u_1, u_2, u_kink = tangent(first), tangent(second), tangent(f"kink_{number}")
    c_1, s_1 = cosine_of(u_1), sine_of(u_1)
    c_2, s_2 = cosine_of(u_2), sine_of(u_2)
    c_kink, s_kink = cosine_of(u_kink), sine_of(u_kink)
    names = [f"{name}_{number}" for name in ("n", "x", "y", "z", "w")]
    n, x, y, z, w = (constant(name) for name in names)
    x_value = c_kink * s_2 * c_1 + c_2 * s_1
    y_value = s_kink * s_2
    constants = {
        names[1]: x_value,
        names[2]: y_value,
        names[3]: c_kink * s_1 * c_2 + c_1 * s_2,
        names[4]: s_kink * s_1,
        names[0]: numbers.sqrt(x**2 + y**2),
        f"k_{number}": u_kink,
    }
    return _Gains((y, n + x), (w, n + z)), constants


def _kink(number: int) -> Pair:
    return (constant(f"k_{number}"), 1)


def _closed_form(
    linkage: str, joints: Sequence[Pair], constants: Mapping[str, Number]
) -> ClosedForm:
    return ClosedForm(
        linkage,
        "form of the network",
        f"from the network of Bennett loops of {SOURCE}",
        ("alpha", "beta", "gamma", "delta", "kink_1", "kink_2"),
        only(*joints),
        constants,
    )


def _l_shape_formulas() -> tuple[ClosedForm, ...]:
    """Three cells around a common axis, locked at joints 2 and 0: p is the angle of a
    cell at its outer joint, v that at the joint before."""
    b_d, of_first = _composite(1, "delta", "beta")
    c_d, of_second = _composite(2, "gamma", "delta")
    p_1 = minus(joint(1), b_d.before)
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = plus(minus(v_1, HALF_TURN), _kink(1))
    p_2 = reciprocal(v_2, constant("m_b"))
    p_3 = negative(plus(_kink(2), plus(p_1, p_2)))
    v_3 = reciprocal(p_3, constant("m_c"))
    joints = (
        joint(1),
        plus(p_2, b_d.after),
        plus(minus(HALF_TURN, v_2), v_3),
        p_3,
        plus(negative(v_3), c_d.before),
        plus(v_1, c_d.after),
    )
    factors = {
        "m_a": ratio("delta", "alpha"),
        "m_b": ratio("alpha", "beta"),
        "m_c": ratio("beta", "gamma"),
    }
    constants = {**factors, **of_first, **of_second}
    return (_closed_form("generalized-l-shape-goldberg-variant-6r", joints, constants),)


def _serial_formulas() -> tuple[ClosedForm, ...]:
    """Three cells in a row, locked at joints U1 and V2."""
    a_c, of_first = _composite(1, "alpha", "gamma")
    d_c, of_second = _composite(2, "delta", "gamma")
    p_1 = negative(joint(1))
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = minus(minus(_kink(1), p_1), HALF_TURN)
    p_2 = reciprocal(v_2, constant("m_c"))
    p_3 = minus(minus(HALF_TURN, v_2), _kink(2))
    v_3 = reciprocal(p_3, constant("m_d"))
    joints = (
        joint(1),
        plus(v_1, a_c.before),
        plus(plus(plus(p_2, v_3), HALF_TURN), a_c.after),
        p_3,
        plus(negative(v_3), d_c.before),
        plus(minus(HALF_TURN, plus(v_1, p_2)), d_c.after),
    )
    factors = {
        "m_a": ratio("beta", "alpha"),
        "m_c": ratio("beta", "gamma"),
        "m_d": ratio("beta", "delta"),
    }
    constants = {**factors, **of_first, **of_second}
    return (_closed_form("generalized-serial-goldberg-variant-6r", joints, constants),)


def _isomer_formulas() -> tuple[ClosedForm, ...]:
    """Four cells around a common axis, locked at joints 2 and 4."""
    b_d, of_second = _composite(2, "delta", "beta")
    a_c, of_first = _composite(1, "alpha", "gamma")
    p_1 = minus(joint(1), b_d.before)
    v_1 = reciprocal(p_1, constant("m_a"))
    v_2 = plus(minus(v_1, HALF_TURN), _kink(2))
    p_2 = reciprocal(v_2, constant("m_b"))
    v_3 = plus(minus(v_2, HALF_TURN), _kink(1))
    p_3 = reciprocal(v_3, constant("m_c"))
    p_4 = negative(plus(p_1, plus(p_2, p_3)))
    v_4 = reciprocal(p_4, constant("m_d"))
    joints = (
        joint(1),
        plus(plus(p_2, b_d.after), a_c.before),
        plus(p_3, a_c.after),
        plus(minus(HALF_TURN, v_3), v_4),
        p_4,
        plus(minus(HALF_TURN, v_4), v_1),
    )
    factors = {
        "m_a": ratio("delta", "alpha"),
        "m_b": ratio("alpha", "beta"),
        "m_c": ratio("beta", "gamma"),
        "m_d": ratio("gamma", "delta"),
    }
    constants = {**factors, **of_first, **of_second}
    name = "isomerized-generalized-l-shape-goldberg-6r"
    return (_closed_form(name, joints, constants),)


# --- first guesses


def _hidden_twists(
    length: float, twist: float, ratio: float, known: float
) -> Iterator[float]:
    """The other twists of a link made of two, of ``length`` and ``twist``, one of which
    has the twist ``known``: length = ratio (cos x + cos y) tan(twist / 2)."""
    for joined, sign in itertools.product((twist, twist + np.pi), (1, -1)):
        tangent = np.tan(joined / 2)
        if not tangent:
            continue
        cosine = sign * length / (ratio * tangent) - np.cos(known)
        if abs(cosine) < 1:
            yield float(np.arccos(cosine))


def _l_shape_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The twist delta from the lengths of both links that are made of two, and the
    kinks from their twists."""
    lengths, twists, _ = form
    ratio = lengths[1] / np.sin(twists[1])
    beta, gamma = twists[3], twists[2]
    deltas = [
        *_hidden_twists(lengths[0], twists[0], ratio, beta),
        *_hidden_twists(lengths[4], twists[4], ratio, gamma),
    ]
    for delta in deltas:
        first = kinks(beta, delta, twists[0])
        second = kinks(gamma, delta, twists[4])
        for kink_1, kink_2 in itertools.product(first, second):
            yield {"delta": delta, "kink_1": kink_1, "kink_2": kink_2}


def _serial_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """As for the L-shape, for the twist gamma."""
    lengths, twists, _ = form
    ratio = lengths[5] / np.sin(twists[5])
    alpha, delta = twists[5], twists[2]
    gammas = [
        *_hidden_twists(lengths[1], twists[1], ratio, alpha),
        *_hidden_twists(lengths[4], twists[4], ratio, delta),
    ]
    for gamma in gammas:
        first = kinks(alpha, gamma, twists[1])
        second = kinks(gamma, delta, twists[4])
        for kink_1, kink_2 in itertools.product(first, second):
            yield {"gamma": gamma, "kink_1": kink_1, "kink_2": kink_2}


def _isomer_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The kinks from the twists of the links that are made of two."""
    twists = form[1]
    beta, delta, gamma, alpha = twists[2:]
    first = kinks(alpha, gamma, twists[1])
    second = kinks(beta, delta, twists[0])
    for kink_1, kink_2 in itertools.product(first, second):
        yield {"kink_1": kink_1, "kink_2": kink_2}


# --- entries


def _angle(number: int, degrees: float, links: str) -> Parameter:
    meaning = f"angle between {links}"
    return Parameter.angle(f"kink_{number}", degrees, meaning, -120, 120)


def _condition(links: str) -> Condition:
    return Condition(f"links {links}; links in brackets from the spatial triangles")


LINKS = (length_a(66), *twists_of_links(a=66, b=50, c=28, d=83))
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "generalized-serial-goldberg-variant-6r",
        "Variant of the serial Goldberg 6R with kink angles",
        SOURCE,
        generalized_serial_variant,
        (*LINKS, _angle(1, 25, "a and c"), _angle(2, -40, "c and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("b, [a c], d, b, [c d], a"),
            Condition("R1 = R4 = 0", (zero_offsets(1, 4),)),
        ),
        guesses=_serial_guesses,
        formulas=_serial_formulas,
        facts=FACTS,
    ),
    Entry(
        "generalized-l-shape-goldberg-variant-6r",
        "Variant of the L-shape Goldberg 6R with kink angles",
        SOURCE,
        generalized_l_shape_variant,
        (*LINKS, _angle(1, 25, "b and d"), _angle(2, -40, "c and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("[b d], a, c, b, [c d], a"),
            Condition("R3 = R4 = 0", (zero_offsets(3, 4),)),
        ),
        guesses=_l_shape_guesses,
        formulas=_l_shape_formulas,
        facts=FACTS,
    ),
    Entry(
        "isomerized-generalized-l-shape-goldberg-6r",
        "Isomer of the L-shape Goldberg 6R with kink angles",
        SOURCE,
        isomerized_l_shape,
        (*LINKS, _angle(1, 25, "a and c"), _angle(2, -40, "b and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("[b d], [a c], b, d, c, a"),
            Condition("R4 = R5 = R6 = 0", (zero_offsets(4, 5, 6),)),
        ),
        guesses=_isomer_guesses,
        formulas=_isomer_formulas,
        relations=(
            Relation(
                RelationKind.ISOMER,
                "generalized-l-shape-goldberg-6r",
                "Wohlhart (1991b); Song (2013), section 5.4.3",
                "links c and d exchanged",
                joint=5,
            ),
        ),
        facts=FACTS,
    ),
)
