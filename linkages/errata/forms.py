"""Closed forms as printed, against the corrected ones: each change makes the printed form
of the right one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import itemgetter
from typing import TypeAlias

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ZERO,
    ClosedForm,
    Pair,
    constant,
    cosine_of,
    joint,
    minus,
    negative,
    plus,
    reciprocal,
    sine_of,
    tangent,
)
from linkages.construction.equations import evaluate
from linkages.errata.erratum import Amounts, median_and_largest
from linkages.families.bricard import LETTERS, closure_equations

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


def with_constants(printed: Mapping[str, str], form: ClosedForm) -> ClosedForm:
    """The form with constants as printed: formulas of the names that `_names` has."""
    names = _names(form)
    values = {name: evaluate(text, names) for name, text in printed.items()}
    return replace(form, constants={**form.constants, **values})


def _names(form: ClosedForm) -> dict[str, object]:
    """What the sources write of the parameters of a closed form: m(alpha, beta), lengths
    and offsets, and the sine s12 and cosine c12 of a twist alpha12."""
    names: dict[str, object] = {"m": lambda x, y: (x + y) / (x - y)}
    names |= {name: constant(name) for name in form.lengths}
    for name in form.angles:
        u = tangent(name)
        number = name.removeprefix("alpha")
        names |= {name: u, f"c{number}": cosine_of(u), f"s{number}": sine_of(u)}
    return names


# --- the Goldberg 5R linkages


def inverted_factor(form: ClosedForm) -> ClosedForm:
    """tan(theta3/2) = m_c tan(theta1/2), the factor upside down."""
    first = joint(1)
    s1, c1 = first
    third = (constant("m_c") * s1, c1)
    fifth = minus(ZERO, plus(reciprocal(first, constant("m_a")), third))
    return _with_joints(form, {3: third, 5: fifth})


# --- the mixed double-Goldberg linkages


def printed_type_one(form: ClosedForm) -> ClosedForm:
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


def negative_fourth(form: ClosedForm) -> ClosedForm:
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


def printed_discriminant(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.4) with 1 - m1 m2 before the root: P comes out by (m1 m6 - m1 m2) /
    (2 m6 Q) too large."""
    changed = with_constants({"m_2": "m(gamma, alpha)"}, form)
    s1, c1 = joint(1)
    s4, c4 = joint(4)
    k_b = constant("m_ba") * constant("m_bc")
    k_d = constant("m_da") * constant("m_dc")
    q_top = (k_d - 1) * s1 * c1
    q_bottom = s1**2 + k_d * c1**2
    excess = k_b - constant("m_ba") * constant("m_2")
    fourth = (2 * q_top * s4 + excess * q_bottom * c4, 2 * q_top * c4)
    return _by_fourth(changed, fourth)


def printed_denominator(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.5) with 2 m2 Q for 2 m6 Q: P comes out times m6/m2."""
    changed = with_constants({"m_2": "m(gamma, alpha)"}, form)
    s4, c4 = joint(4)
    return _by_fourth(changed, (constant("m_bc") * s4, constant("m_2") * c4))


def printed_second_form(form: ClosedForm) -> ClosedForm:
    """Equation (5.13) with P = m1/m2 for Form II, in the convention of the paper:
    tan(theta4/2) = m4 P."""
    p = constant("m_da") / constant("m_dc")
    before = reciprocal(joint(1), constant("m_da"))
    third = minus(plus(before, (p, 1)), HALF_TURN)
    fourth = (constant("m_bc") * p, 1)
    fifth = (constant("m_ba"), p)
    return _with_joints(form, {3: third, 4: fourth, 5: fifth, 6: negative(third)})


# --- the line-symmetric Bricard linkages


def unprimed(form: ClosedForm) -> ClosedForm:
    """The coefficients (4.2.22) in the place of the missing (4.3.8)."""
    names = _names(form)
    lengths, cosines, sines, offsets = (
        itemgetter(*keys.split())(names)
        for keys in ("a12 a23 a34", "c12 c23 c34", "s12 s23 s34", "R1 R2 R3")
    )
    third = closure_equations(lengths, cosines, sines, offsets).third
    values = {
        f"{letter}_3": value for letter, value in zip(LETTERS, third, strict=True)
    }
    return replace(form, constants={**form.constants, **values})
