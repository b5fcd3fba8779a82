"""Closed forms of the mixed double-Goldberg 6R linkages, Types I to VI.

Song and Chen (2012), equations (4.8), (4.9), (4.12), (4.16), (4.17), (4.21), (4.22);
Song (2013), section 3.4. Type I is printed with m2 for m1 and m4, and Type III with the
wrong sign of tan(theta4/2). The irrational quantity of Types I and II is written by t4:
Q = -m4/t4 and P = -m3/t4.
"""

from __future__ import annotations

from typing import Any

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    negative,
    plus,
    ratio,
    reciprocal,
)

__all__ = ["FORMS"]

FIRST, FOURTH = joint(1), joint(4)
M1, M2, M3, M4, M6 = (constant(f"m_{k}") for k in (1, 2, 3, 4, 6))
RATIOS = {
    "m_1": ratio("beta", "alpha"),
    "m_2": ratio("gamma", "alpha"),
    "m_3": ratio("delta", "alpha"),
    "m_4": ratio("delta", "gamma"),
    "m_6": ratio("beta", "gamma"),
}
(S1, C1), (S4, C4) = FIRST, FOURTH


def _form(
    order: str, source: str, angles: tuple[tuple[Pair, ...], ...], relation: Any = None
) -> ClosedForm:
    return ClosedForm(
        f"mixed-double-goldberg-type-{order}",
        "Forms of Type " + order.upper(),
        source,
        ("alpha", "beta", "gamma", "delta"),
        angles,
        RATIOS,
        relation=relation,
        second=4 if relation is not None else 0,
    )


def _type_one() -> ClosedForm:
    q = reciprocal(FOURTH, -M4)
    outer = plus(q, reciprocal(FIRST, M1))
    # (m1 + m6 x^2) (Q^2 + m4/m3) = (1/m3 - m4) (m1 - m6) x Q, times m3 t4^2 / m4
    top, slope = M1 * C1**2 + M6 * S1**2, (1 - M3 * M4) * (M1 - M6) * S1 * C1
    relation = top * (M3 * M4 * C4**2 + S4**2) + slope * S4 * C4
    angles = (
        FIRST,
        (M1 * C1, M6 * S1),
        plus(HALF_TURN, outer),
        FOURTH,
        (M3 * M4 * C4, S4),
        negative(outer),
    )
    source = "Song and Chen 2012, eqs (4.8), (4.9), corrected: t2 = m1/(m6 t1), t5 = -m3 Q, H = (m1 + m6 t1^2)/..."
    return _form("i", source, tuple((pair,) for pair in angles), relation)


def _type_two() -> ClosedForm:
    p = reciprocal(FOURTH, -M3)
    # m4 x P^2 - (m3 m4 - 1) P + m3 x = 0, times t4^2 / m3
    relation = M3 * M4 * S1 * C4**2 + (M3 * M4 - 1) * S4 * C4 * C1 + S1 * S4**2
    third = (p[0] * S1 - M2 * p[1] * C1, S1 * p[1] + M2 * p[0] * C1)
    square, cross = S1**2 + M1 * M2 * C1**2, (M1 - M2) * S1 * C1
    sixth = (square * p[1] - cross * p[0], cross * p[1] + square * p[0])
    angles = FIRST, reciprocal(FIRST, M1), third, FOURTH, (M3 * M4 * C4, S4), sixth
    return _form(
        "ii",
        "Song and Chen 2012, eq. (4.12)",
        tuple((pair,) for pair in angles),
        relation,
    )


def _rational(order: str, source: str, *others: Pair) -> ClosedForm:
    angles = FIRST, reciprocal(FIRST, M1), *others
    return _form(order, source, tuple((pair,) for pair in angles))


REST = minus(HALF_TURN, FIRST)
_V_THIRD = (C1, M4 * S1)
_VI_SIXTH = (
    (M4 * S1**2 + (M1 * M2 * M4 + M1 - M2) * C1**2) * S1,
    ((M1 * M4 - M2 * M4 - 1) * S1**2 - M1 * M2 * C1**2) * C1,
)

FORMS: tuple[ClosedForm, ...] = (
    _type_one(),
    _type_two(),
    _rational(
        "iii",
        "Song and Chen 2012, eq. (4.16), with tan(theta4/2) = +m3 tan(theta1/2)",
        ZERO,
        (M3 * S1, C1),
        REST,
        ((1 - M1 * M3) * S1 * C1, M1 * C1**2 + M3 * S1**2),
    ),
    _rational(
        "iv",
        "Song and Chen 2012, eq. (4.17)",
        (M2 * C1**2 + M3 * S1**2, (M2 * M3 - 1) * S1 * C1),
        REST,
        (M3 * S1, C1),
        (M1 * M2 * C1**2 + S1**2, (M1 - M2) * S1 * C1),
    ),
    _rational(
        "v",
        "Song and Chen 2012, eq. (4.21)",
        _V_THIRD,
        REST,
        minus(HALF_TURN, _V_THIRD),
        (-M1 * C1, S1),
    ),
    _rational(
        "vi",
        "Song and Chen 2012, eq. (4.22)",
        (S1, M2 * C1),
        (M4 * S1, C1),
        REST,
        _VI_SIXTH,
    ),
)
