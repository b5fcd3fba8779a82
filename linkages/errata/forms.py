"""Closed forms as printed, beside the corrected ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from linkages.catalogue import entry
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
from linkages.construction.numbers import Number
from linkages.errata.erratum import Amounts, Erratum, median_and_largest

Change: TypeAlias = Callable[[ClosedForm], ClosedForm]
INPUTS = 60  # input angles along a form


def _defects(form: ClosedForm, parameters: Mapping[str, float]) -> np.ndarray:
    """Closure defects along the form, at all inputs and both roots."""
    loop = entry(form.linkage).build(**parameters)
    inputs = np.linspace(-3.0, 3.0, INPUTS)
    paths = [form.configurations(inputs, parameters, root) for root in form.roots]
    theta = np.concatenate(paths)
    theta = theta[np.isfinite(theta).all(axis=1)]
    product = loop.frames(theta)[:, -1]
    gap = np.abs(product - np.eye(4))
    gap[:, :3, 3] /= loop.characteristic_length
    return np.asarray(gap.max(axis=(1, 2)))


def compare_closed_forms(linkage: str, number: int, change: Change) -> Amounts:
    """Amounts for the closed form ``number`` of a linkage, and for what ``change``
    makes of it."""
    owner = entry(linkage)
    form = owner.closed_forms[number]
    misprint = change(form)
    parameters = owner.defaults
    rng = np.random.default_rng(0)
    while True:
        printed = _defects(misprint, parameters)
        corrected = _defects(form, parameters)
        if len(printed) and len(corrected):
            return median_and_largest(printed, corrected)
        parameters = owner.draw(rng)  # no real configuration


def _with_joints(form: ClosedForm, pairs: Mapping[int, Pair]) -> ClosedForm:
    """The form with other pairs for joints, by their numbers from 1."""
    angles = list(form.half_tangents)
    for number, pair in pairs.items():
        angles[number - 1] = (pair,)
    return replace(form, half_tangents=tuple(angles))


def with_constants(form: ClosedForm, **values: Number) -> ClosedForm:
    """The form with further or other constants."""
    return replace(form, constants={**form.constants, **values})


# --- the Goldberg 5R linkages


def _inverted_factor(form: ClosedForm) -> ClosedForm:
    """tan(theta3/2) = m_c tan(theta1/2), the factor upside down."""
    first = joint(1)
    s1, c1 = first
    third = (constant("m_c") * s1, c1)
    fifth = minus(ZERO, plus(reciprocal(first, constant("m_a")), third))
    return _with_joints(form, {3: third, 5: fifth})


def _other_twist(form: ClosedForm) -> ClosedForm:
    """m2 for m1."""
    return with_constants(form, m_a=ratio("alpha", "gamma"))


def _other_signs(form: ClosedForm) -> ClosedForm:
    """m2 for m3, and the sign of m4."""
    m_a = -ratio("gamma", "alpha")
    return with_constants(form, m_a=m_a, m_c=ratio("beta", "gamma"))


# --- the mixed double-Goldberg linkages


def _printed_type_one(form: ClosedForm) -> ClosedForm:
    """Type I with m2, m4 and m6 in the places of m1, m3 and m4."""
    first = joint(1)
    fourth = joint(4)
    s1, c1 = first
    s4, c4 = fourth
    m2, m4, m6 = (constant(f"m_{k}") for k in (2, 4, 6))
    q = reciprocal(fourth, -m2)  # tan(theta4/2) = -m2/Q
    outer = minus(q, reciprocal(first, m2))
    # H Q^2 + (1/m2 + m4) Q - H m2/m4 = 0, H = (m2 - m6 x^2) / ((m2 + m6) x), times m4
    # t4^2 / m2^2
    top = m2 * c1**2 - m6 * s1**2
    slope = (1 + m2 * m4) * (m2 + m6) * s1 * c1
    relation = top * (m2 * m4 * c4**2 - s4**2) * m2 - m4 * slope * s4 * c4
    pairs = {
        2: (-m2 * c1, m6 * s1),
        3: plus(HALF_TURN, outer),
        5: (m4 * s1, c1),
        6: negative(outer),
    }
    return replace(_with_joints(form, pairs), relation=relation)


def _negative_fourth(form: ClosedForm) -> ClosedForm:
    """Type III with the wrong sign of tan(theta4/2)."""
    s1, c1 = joint(1)
    return _with_joints(form, {4: (-constant("m_3") * s1, c1)})


# --- the double-Goldberg linkages


def _by_fourth(form: ClosedForm, fourth: Pair) -> ClosedForm:
    """The form of the double-Goldberg linkage for another pair of joint 4."""
    before = reciprocal(joint(1), constant("m_da"))
    after = (fourth[0], constant("m_bc") * fourth[1])
    third = minus(plus(before, after), HALF_TURN)
    fifth = reciprocal(fourth, constant("m_ba") * constant("m_bc"))
    return _with_joints(form, {3: third, 4: fourth, 5: fifth, 6: negative(third)})


def _printed_discriminant(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.4) with 1 - m1 m2 before the root: P comes out by (m1 m6 - m1 m2) /
    (2 m6 Q) too large."""
    changed = with_constants(form, m_2=ratio("gamma", "alpha"))
    s1, c1 = joint(1)
    s4, c4 = joint(4)
    k_b = constant("m_ba") * constant("m_bc")
    k_d = constant("m_da") * constant("m_dc")
    q_top = (k_d - 1) * s1 * c1
    q_bottom = s1**2 + k_d * c1**2
    excess = k_b - constant("m_ba") * constant("m_2")
    fourth = (2 * q_top * s4 + excess * q_bottom * c4, 2 * q_top * c4)
    return _by_fourth(changed, fourth)


def _printed_denominator(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.5) with 2 m2 Q for 2 m6 Q: P comes out times m6/m2."""
    changed = with_constants(form, m_2=ratio("gamma", "alpha"))
    s4, c4 = joint(4)
    return _by_fourth(changed, (constant("m_bc") * s4, constant("m_2") * c4))


def _printed_second_form(form: ClosedForm) -> ClosedForm:
    """Equation (5.13) with P = m1/m2 for Form II, in the convention of the paper:
    tan(theta4/2) = m4 P."""
    p = constant("m_da") / constant("m_dc")
    before = reciprocal(joint(1), constant("m_da"))
    third = minus(plus(before, (p, 1)), HALF_TURN)
    fourth = (constant("m_bc") * p, 1)
    fifth = (constant("m_ba"), p)
    return _with_joints(form, {3: third, 4: fourth, 5: fifth, 6: negative(third)})


def _erratum(
    source: str,
    equation: str,
    linkage: str,
    printed: str,
    corrected: str,
    change: Change,
    number: int = 0,
) -> Erratum:
    """The misprint by which ``change`` makes the closed form ``number``."""
    measure = partial(compare_closed_forms, linkage, number, change)
    return Erratum(source, equation, linkage, printed, corrected, measure)


SONG = "Song 2013"
BOTH = "Song 2013; Song and Chen 2012 (mixed)"
SPECIAL = "Song and Chen 2012 (special)"

FORM_ERRATA: tuple[Erratum, ...] = (
    _erratum(
        BOTH,
        "(3.2.4); (2.4)",
        "subtractive-goldberg-5r",
        "tan(theta3/2) = m(alpha45, alpha12) tan(theta1/2)",
        "tan(theta3/2) = tan(theta1/2) / m(alpha45, alpha12)",
        _inverted_factor,
    ),
    _erratum(
        BOTH,
        "(3.4.4); (4.4)",
        "subtractive-goldberg-5r",
        "tan(theta2/2) = -m2 / tan(theta1/2)",
        "tan(theta2/2) = -m1 / tan(theta1/2), and -1/m6 for 1/m6 in tan(theta3/2)",
        _other_twist,
    ),
    _erratum(
        BOTH,
        "(3.4.5); (4.5)",
        "goldberg-5r",
        "tan(theta2/2) = -m2 / tan(theta1/2), +m4 in tan(theta3/2)",
        "tan(theta2/2) = -m3 / tan(theta1/2), -m4 in tan(theta3/2)",
        _other_signs,
    ),
    _erratum(
        BOTH,
        "(3.4.8), (3.4.9); (4.8), (4.9)",
        "mixed-double-goldberg-type-i",
        "t2 = -m2/(m6 x), t4 = -m2/Q, t5 = m4 x, H = (m2 - m6 x^2)/((m2 + m6) x)",
        "t2 = m1/(m6 x), t4 = -m4/Q, t5 = -m3 Q, H = (m1 + m6 x^2)/((m1 - m6) x)",
        _printed_type_one,
    ),
    _erratum(
        BOTH,
        "(3.4.16); (4.16)",
        "mixed-double-goldberg-type-iii",
        "tan(theta4/2) = -m3 tan(theta1/2)",
        "tan(theta4/2) = m3 tan(theta1/2)",
        _negative_fourth,
    ),
    _erratum(
        SONG,
        "(5.2.4)",
        "wohlhart-double-goldberg",
        "(1 - m1 m2) + sqrt(...)",
        "(1 - m1 m6) + sqrt(...)",
        _printed_discriminant,
    ),
    _erratum(
        SONG,
        "(5.2.5)",
        "wohlhart-double-goldberg",
        "denominator 2 m2 Q",
        "denominator 2 m6 Q",
        _printed_denominator,
    ),
    _erratum(
        SPECIAL,
        "(5.13)",
        "special-wohlhart-double-goldberg",
        "Form II: P = m1/m2",
        "Form II: P = m2/tan(theta1/2)",
        _printed_second_form,
        number=1,
    ),
)
