"""The double-Goldberg 6R family: mixed Types I to VI, and the twelve linkages of two
equal kinds of 5R.

Two 5R linkages, each a Goldberg or a subtractive Goldberg linkage, are joined on the
link pair a, c or across the Bennett loop a, c. Up to the sign with which c is added,
the links come in six orders.

Closed forms of the mixed ones: Song and Chen (2012), equations (4.8), (4.9), (4.12),
(4.16), (4.17), (4.21), (4.22); Song (2013), section 3.4. Type I is printed with m2 for
m1 and m4, and Type III with the wrong sign of tan(theta4/2). The irrational quantity of
Types I and II is written by t4: Q = -m4/t4 and P = -m3/t4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import Any

import numpy as np

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    joint,
    minus,
    negative,
    only,
    plus,
    ratio,
    reciprocal,
    symbols,
)
from linkages.construction.link import Link, basic_links, joined_chain
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import twist_pairs
from linkages.entry import Guesses
from linkages.entry_table import Model, read_entries
from linkages.families.double_goldberg import (
    constructive_closed_form,
    non_constructive_closed_form,
)
from linkages.families.goldberg_6r import difference_guesses
from linkages.loop import Loop

POSITION = 100


class Order(Enum):
    """The six types, and the order of their links: * takes the sign of the first 5R, +
    that of the second."""

    I = "a*c b d a+c d b"
    II = "a b*c d a+c d b"
    III = "a b*c d+c a d b"
    IV = "a b*c d a d+c b"
    V = "a b*c d c d+a b"
    VI = "a b*c d+a c d b"


@dataclass(frozen=True)
class _Joints:
    """Signs with which the first and the second 5R join their links, and the name."""

    first: int
    second: int
    prefix: str


class Kind(Enum):
    """Of which 5R linkages a member is made."""

    MIXED = _Joints(-1, 1, "mixed-double-goldberg")
    GOLDBERG = _Joints(1, 1, "double-goldberg")
    SUBTRACTIVE = _Joints(-1, -1, "double-subtractive-goldberg")


def double_goldberg_type(
    *parameters: Number,
    order: Order = Order.I,
    kind: Kind = Kind.MIXED,
    **others: Any,
) -> Loop:
    """The double-Goldberg 6R of Type ``order``, I to VI, made of the two 5R linkages of
    ``kind``, with the parameters of `basic_links` and no offsets.

    Source: Song and Chen (2012), tables 2 and 3; Song (2013), tables 3.3.1 and 3.5.3,
    equations (3.4.3) to (3.4.22). The latter's "alpha34 = alpha + gamma" in (3.4.11) is
    alpha45.
    """
    return double_goldberg_chain(basic_links(*parameters, **others), order, kind)


def double_goldberg_chain(links: Mapping[str, Link], order: Order, kind: Kind) -> Loop:
    """The loop of Type ``order`` and ``kind`` of the basic links a, b, c, d, whatever
    their ratios; -c is allowed."""
    signs = {1: "+", -1: "-"}
    text = order.value.replace("+", signs[kind.value.second])
    return joined_chain(text.replace("*", signs[kind.value.first]), links)


# --- closed forms of the mixed linkages


def _ratios() -> dict[str, Number]:
    return {
        "m_1": ratio("beta", "alpha"),
        "m_2": ratio("gamma", "alpha"),
        "m_3": ratio("delta", "alpha"),
        "m_4": ratio("delta", "gamma"),
        "m_6": ratio("beta", "gamma"),
    }


def _form(
    linkage: str,
    order: Order,
    source: str,
    angles: tuple[Pair, ...],
    relation: Number | None = None,
) -> tuple[ClosedForm, ...]:
    form = ClosedForm(
        linkage,
        f"Forms of Type {order.name}",
        source,
        ("alpha", "beta", "gamma", "delta"),
        only(*angles),
        _ratios(),
        relation=relation,
        second=0 if relation is None else 4,
    )
    return (form,)


def _type_one(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    fourth = joint(4)
    s1, c1 = first
    s4, c4 = fourth
    m1, m3, m4, m6 = symbols("m_1 m_3 m_4 m_6")
    q = reciprocal(fourth, -m4)
    outer = plus(q, reciprocal(first, m1))
    # (m1 + m6 x^2) (Q^2 + m4/m3) = (1/m3 - m4) (m1 - m6) x Q, times m3 t4^2 / m4
    top = m1 * c1**2 + m6 * s1**2
    slope = (1 - m3 * m4) * (m1 - m6) * s1 * c1
    relation = top * (m3 * m4 * c4**2 + s4**2) + slope * s4 * c4
    angles = (
        first,
        (m1 * c1, m6 * s1),
        plus(HALF_TURN, outer),
        fourth,
        (m3 * m4 * c4, s4),
        negative(outer),
    )
    source = (
        "Song and Chen 2012, eqs (4.8), (4.9), corrected: t2 = m1/(m6 t1), "
        "t5 = -m3 Q, H = (m1 + m6 t1^2)/..."
    )
    return _form(linkage, Order.I, source, angles, relation)


def _type_two(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    fourth = joint(4)
    s1, c1 = first
    s4, c4 = fourth
    m1, m2, m3, m4 = symbols("m_1 m_2 m_3 m_4")
    p, r = reciprocal(fourth, -m3)
    # m4 x P^2 - (m3 m4 - 1) P + m3 x = 0, times t4^2 / m3
    relation = m3 * m4 * s1 * c4**2 + (m3 * m4 - 1) * s4 * c4 * c1 + s1 * s4**2
    third = (p * s1 - m2 * r * c1, s1 * r + m2 * p * c1)
    square = s1**2 + m1 * m2 * c1**2
    cross = (m1 - m2) * s1 * c1
    sixth = (square * r - cross * p, cross * r + square * p)
    angles = (
        first,
        reciprocal(first, m1),
        third,
        fourth,
        (m3 * m4 * c4, s4),
        sixth,
    )
    return _form(linkage, Order.II, "Song and Chen 2012, eq. (4.12)", angles, relation)


def _type_three(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    m1, m3 = symbols("m_1 m_3")
    angles = (
        first,
        reciprocal(first, m1),
        ZERO,
        (m3 * s1, c1),
        minus(HALF_TURN, first),
        ((1 - m1 * m3) * s1 * c1, m1 * c1**2 + m3 * s1**2),
    )
    source = "Song and Chen 2012, eq. (4.16), with tan(theta4/2) = +m3 tan(theta1/2)"
    return _form(linkage, Order.III, source, angles)


def _type_four(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    m1, m2, m3 = symbols("m_1 m_2 m_3")
    angles = (
        first,
        reciprocal(first, m1),
        (m2 * c1**2 + m3 * s1**2, (m2 * m3 - 1) * s1 * c1),
        minus(HALF_TURN, first),
        (m3 * s1, c1),
        (m1 * m2 * c1**2 + s1**2, (m1 - m2) * s1 * c1),
    )
    return _form(linkage, Order.IV, "Song and Chen 2012, eq. (4.17)", angles)


def _type_five(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    m1, m4 = symbols("m_1 m_4")
    third = (c1, m4 * s1)
    angles = (
        first,
        reciprocal(first, m1),
        third,
        minus(HALF_TURN, first),
        minus(HALF_TURN, third),
        (-m1 * c1, s1),
    )
    return _form(linkage, Order.V, "Song and Chen 2012, eq. (4.21)", angles)


def _type_six(linkage: str) -> tuple[ClosedForm, ...]:
    first = joint(1)
    s1, c1 = first
    m1, m2, m4 = symbols("m_1 m_2 m_4")
    sixth = (
        (m4 * s1**2 + (m1 * m2 * m4 + m1 - m2) * c1**2) * s1,
        ((m1 * m4 - m2 * m4 - 1) * s1**2 - m1 * m2 * c1**2) * c1,
    )
    angles = (
        first,
        reciprocal(first, m1),
        (s1, m2 * c1),
        (m4 * s1, c1),
        minus(HALF_TURN, first),
        sixth,
    )
    return _form(linkage, Order.VI, "Song and Chen 2012, eq. (4.22)", angles)


MIXED_FORMULAS = {
    Order.I: _type_one,
    Order.II: _type_two,
    Order.III: _type_three,
    Order.IV: _type_four,
    Order.V: _type_five,
    Order.VI: _type_six,
}


def _type_one_of_equals(sign: int, linkage: str) -> tuple[ClosedForm, ...]:
    """Type I of two equal 5R linkages is a double-Goldberg linkage with the links b, d
    exchanged."""
    return (
        constructive_closed_form(linkage, sign, exchanged=True),
        non_constructive_closed_form(linkage, sign, exchanged=True),
    )


def _formulas(
    order: Order, kind: Kind
) -> Callable[[str], tuple[ClosedForm, ...]] | None:
    if kind is Kind.MIXED:
        return MIXED_FORMULAS[order]
    if order is Order.I:
        return partial(_type_one_of_equals, kind.value.second)
    return None


# --- first guesses


def _type_one_guesses(kind: Kind, form: np.ndarray) -> Iterator[dict[str, float]]:
    """Links a*c, b, d, a+c, d, b, the two composite ones with the signs of ``kind``."""
    lengths, twists, _ = form
    ratio = lengths[1] / np.sin(twists[1])
    if kind is Kind.MIXED:
        mean = (twists[0] + twists[3]) / 2
        half = (twists[3] - twists[0]) / 2
        pairs = [(mean + turn, (half + turn) % np.pi) for turn in (0, np.pi / 2)]
    else:
        pairs = twist_pairs(twists[0], lengths[0] / ratio, kind.value.second)
    for alpha, gamma in pairs:
        twist = alpha % np.pi
        yield {"alpha": twist, "gamma": gamma, "a": ratio * np.sin(twist)}


def _guesses(order: Order, kind: Kind) -> Guesses | None:
    if order is Order.I:
        return partial(_type_one_guesses, kind)
    if order in (Order.II, Order.III, Order.IV):
        return partial(difference_guesses, "gamma", 1, 5)
    return None


def _name(order: Order, kind: Kind) -> str:
    return f"{kind.value.prefix}-type-{order.name.lower()}"


ENTRIES = read_entries(
    "mixed_double_goldberg",
    {
        _name(order, kind): Model(
            partial(double_goldberg_type, order=order, kind=kind),
            formulas=_formulas(order, kind),
            guesses=_guesses(order, kind),
        )
        for kind in Kind
        for order in Order
    },
)
