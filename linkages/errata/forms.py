"""Closed forms and equations between numbers as printed, beside the corrected ones:
measures for `linkages.errata.misprints`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import cos, pi, radians, sin
from typing import Any

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.all_forms import closed_forms
from linkages.closed_forms.closed_form import (
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    negative,
    plus,
    reciprocal,
)
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link

__all__ = [
    "circle_direction",
    "compare_closed_forms",
    "cosine_multipliers",
    "inverted_factor",
    "line_symmetric_bennett",
    "printed_denominator",
    "printed_discriminant",
    "printed_second_form",
    "printed_type_one",
    "special_length",
    "triangle_offset",
    "with_constant",
    "with_joints",
]


FIRST, FOURTH = joint(1), joint(4)
(S1, C1), (S4, C4) = FIRST, FOURTH


def _defects(form: ClosedForm, parameters: Mapping[str, float]) -> np.ndarray:
    """Closure defects along the form, at 60 inputs and both roots."""
    loop = entry(form.linkage).build(**parameters)
    inputs = np.linspace(-3.0, 3.0, 60)
    theta = np.concatenate(
        [form.configurations(inputs, parameters, root) for root in form.roots]
    )
    theta = theta[np.isfinite(theta).all(axis=1)]
    gap = np.abs(loop.frames(theta)[:, -1] - np.eye(4))
    gap[:, :3, 3] /= loop.characteristic_length
    return np.asarray(gap.max(axis=(1, 2)))


def compare_closed_forms(
    linkage: str, number: int, change: Callable[[ClosedForm], ClosedForm]
) -> tuple[float, float]:
    """Amounts for the closed form ``number`` of a linkage, and for what ``change``
    makes of it."""
    form, found = closed_forms(linkage)[number], entry(linkage)
    parameters, rng = found.defaults, np.random.default_rng(0)
    printed, corrected = _defects(change(form), parameters), _defects(form, parameters)
    while not len(printed) or not len(corrected):  # no real configuration
        parameters = found.draw(rng)
        printed, corrected = (
            _defects(change(form), parameters),
            _defects(form, parameters),
        )
    return float(np.median(printed)), float(corrected.max())


def with_joints(form: ClosedForm, **pairs: Pair) -> ClosedForm:
    """The form with other pairs for joints, "j3" being the third."""
    angles = list(form.half_tangents)
    for name, pair in pairs.items():
        angles[int(name[1:]) - 1] = (pair,)
    return replace(form, half_tangents=tuple(angles))


def inverted_factor(form: ClosedForm) -> ClosedForm:
    """The form with tan(theta3/2) = m_c tan(theta1/2), the factor upside down."""
    third = (constant("m_c") * S1, C1)
    fifth = minus((0, 1), plus(reciprocal(FIRST, constant("m_a")), third))
    return with_joints(form, j3=third, j5=fifth)


def printed_type_one(form: ClosedForm) -> ClosedForm:
    """The closed form of Type I as printed, with m2, m4 and m6 in the places of m1, m3
    and m4."""
    m2, m4, m6 = (constant(f"m_{k}") for k in (2, 4, 6))
    q = reciprocal(FOURTH, -m2)  # tan(theta4/2) = -m2/Q
    outer = minus(q, reciprocal(FIRST, m2))
    # H Q^2 + (1/m2 + m4) Q - H m2/m4 = 0, H = (m2 - m6 x^2) / ((m2 + m6) x), times m4
    # t4^2 / m2^2
    top, slope = m2 * C1**2 - m6 * S1**2, (1 + m2 * m4) * (m2 + m6) * S1 * C1
    relation = top * (m2 * m4 * C4**2 - S4**2) * m2 - m4 * slope * S4 * C4
    changed = with_joints(
        form,
        j2=(-m2 * C1, m6 * S1),
        j3=plus((1, 0), outer),
        j5=(m4 * S1, C1),
        j6=negative(outer),
    )
    return replace(changed, relation=relation)


def with_constant(form: ClosedForm, **values: Any) -> ClosedForm:
    """The form with further or other constants."""
    return replace(form, constants={**form.constants, **values})


def printed_discriminant(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.4) with 1 - m1 m2 before the root: P comes out by (m1 m6 - m1 m2) /
    (2 m6 Q) too large."""
    changed = with_constant(form, m_2="(u_gamma + u_alpha)/(u_gamma - u_alpha)")
    k_b, k_d = _products()
    q = (k_d - 1) * S1 * C1, S1**2 + k_d * C1**2
    fourth = (
        2 * q[0] * S4 + (k_b - constant("m_ba") * constant("m_2")) * q[1] * C4,
        2 * q[0] * C4,
    )
    return _by_fourth(changed, fourth)


def _by_fourth(form: ClosedForm, fourth: Pair) -> ClosedForm:
    """The form of the double-Goldberg linkage for another pair of joint 4."""
    third = minus(
        plus(
            reciprocal(FIRST, constant("m_da")),
            (fourth[0], constant("m_bc") * fourth[1]),
        ),
        (1, 0),
    )
    return with_joints(
        form,
        j3=third,
        j4=fourth,
        j5=reciprocal(fourth, _products()[0]),
        j6=negative(third),
    )


def _products() -> tuple[Any, Any]:
    return constant("m_ba") * constant("m_bc"), constant("m_da") * constant("m_dc")


def printed_denominator(form: ClosedForm) -> ClosedForm:
    """Equation (5.2.5) with 2 m2 Q for 2 m6 Q: P comes out times m6/m2."""
    changed = with_constant(form, m_2="(u_gamma + u_alpha)/(u_gamma - u_alpha)")
    return _by_fourth(changed, (constant("m_bc") * S4, constant("m_2") * C4))


def printed_second_form(form: ClosedForm) -> ClosedForm:
    """Equation (5.13) with P = m1/m2 for Form II, in the convention of the paper:
    tan(theta4/2) = m4 P."""
    p = constant("m_da") / constant("m_dc")
    third = minus(plus(reciprocal(FIRST, constant("m_da")), (p, 1)), (1, 0))
    fourth, fifth = (constant("m_bc") * p, 1), (constant("m_ba"), p)
    return with_joints(form, j3=third, j4=fourth, j5=fifth, j6=negative(third))


# --- equations between numbers


def special_length() -> tuple[float, float]:
    """Equation (5.2.34): b = sin(beta)/sin(alpha), to the four decimals that are
    printed."""
    rounded = round(sin(radians(60)) / sin(radians(125)), 4)
    return abs(1.5072 - rounded), abs(1.0572 - rounded)


def cosine_multipliers() -> tuple[float, float]:
    """Equation (5.2.21): the first fraction must stay sin((d+g)/2)/sin((d-g)/2), times
    one; (5.2.22) follows."""
    d, g = map(radians, (83, 28))
    value = sin((d + g) / 2) / sin((d - g) / 2)
    printed, corrected = sin(d + g) / (sin(d) - cos(g)), (sin(d) + sin(g)) / sin(d - g)
    also = sin(d + g) / (sin(d) - sin(g)) * cos((d + g) / 2) / cos((d + g) / 2)
    expected = (
        2
        * sin((d + g) / 2)
        * cos((d + g) / 2)
        / (2 * sin((d - g) / 2) * cos((d + g) / 2))
    )
    return abs(printed - expected), max(abs(corrected - value), abs(also - expected))


def triangle_offset() -> tuple[float, float]:
    """Equation (5.3.2): R3 over sin(alpha31) sin(theta3), or over sin(alpha23)
    sin(theta2)."""
    a, alpha, b, beta, r2, theta_2 = (
        0.9,
        radians(35),
        2.0,
        radians(60),
        0.7,
        radians(-70),
    )
    made = composite_link(Link(a, alpha), Link(b, beta), theta_2, r2)
    d, r3, theta_3 = made.link.length, -made.after[0], pi - made.after[1]
    top = (
        d * (cos(beta) * sin(theta_2) * sin(theta_3) - cos(theta_2) * cos(theta_3))
        - a
        - b * cos(theta_2)
    )
    values = [
        top / (sin(made.link.twist) * sin(theta_3)),
        top / (sin(beta) * sin(theta_2)),
    ]
    return min(abs(values[0] - r3), abs(values[0] + r3)), min(
        abs(values[1] - r3), abs(values[1] + r3)
    )


def line_symmetric_bennett() -> tuple[float, float]:
    """Equation (5.3.6): cosines or sines with the twist gamma, the second twist being
    gamma - pi."""
    alpha, gamma = radians(66), radians(50)
    loop = entry("bennett-lb-2").build(a=1.0, alpha=alpha, beta=gamma)

    def defect(product: float) -> float:
        t = 0.8
        one, other = 2 * np.arctan(t), 2 * np.arctan(product / t)
        gap = np.abs(loop.frames(np.array([one, other, one, other]))[-1] - np.eye(4))
        return float(gap.max())

    half, difference = (gamma + alpha) / 2, (gamma - alpha) / 2
    return defect(cos(half) / cos(difference)), defect(sin(half) / sin(difference))


def circle_direction() -> tuple[float, float]:
    """Equation (2.3): the pin direction is a unit vector."""
    chi, theta, phi, kappa, zeta = 0.8, 0.25, 0.6, 0.3, -0.4
    ck, sk, cz, sz, cp, sp = (
        cos(kappa),
        sin(kappa),
        cos(zeta),
        sin(zeta),
        cos(phi),
        sin(phi),
    )
    first, across = cz * sk * cp + sz * sp, cz * sk * sp - sz * cp
    lengths = []
    for sign in (1, -1):
        x = first * cos(theta) + cz * ck * sin(theta)
        z = sign * first * sin(theta) + cz * ck * cos(theta)
        y, z = cos(chi) * across - sin(chi) * z, sin(chi) * across + cos(chi) * z
        lengths.append(abs(np.sqrt(x * x + y * y + z * z) - 1))
    return float(lengths[0]), float(lengths[1])
