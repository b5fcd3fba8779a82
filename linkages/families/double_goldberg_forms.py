"""The four forms of the double-Goldberg 6R linkages, told apart by their closed forms.

With t_i = tan(theta_i/2), the constructive Forms I and II have theta6 = -theta3, t1 t2
= k_d, t4 t5 = k_b and theta1 + theta2 + theta4 + theta5 = 0, the non-constructive Forms
III and IV have theta6 = theta3, t1 t2 = K_d, t4 t5 = K_b and theta1 - theta2 = theta4 -
theta5, both modulo 2 pi. Each pair is one curve in t1 and t4,

    t4 + k'/t4 = slope (t1 + k/t1),

with two real circuits. A circuit passes through two of its four flat configurations,
where t1 and t4 are 0 or infinite, and that tells the two forms of a pair apart:
- Form I holds the plus root next to theta1 = pi in Song 2013, eq. (5.2.4), for the WDG, and next to theta1
  = -pi in eq. (5.2.7) for the DSG. Wherever the printed switching of roots describes one smooth circuit, it
  is this one.
- Form III is the circuit through t1 = t4 = 0, where it meets Form I of the special linkages.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from linkages.entry import FormPattern

__all__ = ["patterns", "special_patterns"]

Function = Callable[[np.ndarray], np.ndarray]
SPECIAL_TOLERANCE = 1e-9
I, II = "Form I (constructive 6R)", "Form II (constructive 6R)"
III, IV = "Form III (non-constructive 6R)", "Form IV (non-constructive 6R)"


def _ratio(x: float, y: float) -> float:
    return math.sin((x + y) / 2) / math.sin((x - y) / 2)


def _constructive(sign: int, alpha: float, gamma: float, x: float) -> float:
    """t_i t_j of the joints on either side of link x, in Forms I and II."""
    return _ratio(x, alpha) * _ratio(x, sign * gamma)


def _non_constructive(sign: int, alpha: float, gamma: float, x: float) -> float:
    """t_i t_j of the joints on either side of link x, in Forms III and IV."""
    g = sign * gamma
    total, part = math.sin(alpha) + math.sin(g), math.sin(x)
    return -(total + part + math.sin(alpha + g + x)) / (
        total - part + math.sin(alpha + g - x)
    )


def _products(sign: int, k_d: float, k_b: float) -> Function:
    """Residuals of theta6 = -sign theta3, the angle sum, t1 t2 = k_d and t4 t5 = k_b,
    without poles."""

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.asarray(theta) / 2
        s, c = np.sin(h), np.cos(h)
        closing = h[..., 0] + sign * h[..., 1] + sign * (h[..., 3] + sign * h[..., 4])
        rows = [
            np.sin(h[..., 5] + sign * h[..., 2]),
            np.sin(closing),
            (s[..., 0] * s[..., 1] - k_d * c[..., 0] * c[..., 1]) / math.hypot(1, k_d),
            (s[..., 3] * s[..., 4] - k_b * c[..., 3] * c[..., 4]) / math.hypot(1, k_b),
        ]
        return np.stack(rows, axis=-1)

    return residual


def _circuit(
    k: float, k_other: float, slope: float, t1_infinite: bool, t4_infinite: bool
) -> Function:
    """A function that is not negative on one circuit of the curve and not positive on
    the other.

    The one circuit passes through the flat configuration where t1 and t4 are infinite
    or 0, as said. Where t1 (or t4) never meets its other root k/t1 it stays the larger
    or the smaller of the pair along a circuit; where both products are negative, the
    signs of t1 and t4 agree, or not.
    """
    if k < 0 and k_other < 0:
        sign = math.copysign(1.0, slope) * (1 if t1_infinite == t4_infinite else -1)
        return lambda theta: sign * np.sin(theta[..., 0]) * np.sin(theta[..., 3])
    t1_is_split = k_other > 0 and (
        k < 0 or math.sqrt(k_other) > abs(slope) * math.sqrt(k)
    )
    i, infinite = (0, t1_infinite) if t1_is_split else (3, t4_infinite)
    sign = 1.0 if infinite else -1.0
    return lambda theta: sign * (np.cos(theta[..., i + 1]) - np.cos(theta[..., i]))


def _both(base: Function, inside: Function, side: int) -> Function:
    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        outside = np.maximum(0.0, -side * inside(theta))
        return np.concatenate([base(theta), outside[..., None]], axis=-1)

    return residual


def _non_constructive_patterns(
    sign: int, alpha: float, beta: float, gamma: float, delta: float
) -> tuple[FormPattern, ...]:
    k_d, k_b = (_non_constructive(sign, alpha, gamma, x) for x in (delta, beta))
    base = _products(-1, k_d, k_b)
    # with t2 and t5 negated this is the curve of the module's head, of products -k_d
    # and -k_b
    inside = _circuit(
        -k_d, -k_b, (1 + k_b) / (1 + k_d), t1_infinite=False, t4_infinite=False
    )
    return FormPattern(III, _both(base, inside, +1)), FormPattern(
        IV, _both(base, inside, -1)
    )


def patterns(
    sign: int, alpha: float, beta: float, gamma: float, delta: float
) -> tuple[FormPattern, ...]:
    """The four forms of the WDG (``sign`` +1) or the DSG (-1) with these twists, rad.

    Empty when two of the basic links are alike, where the ratios of Song 2013, eq.
    (5.2.3), are infinite.
    """
    if min(abs(x - y) for x in (beta, delta) for y in (alpha, gamma)) < 1e-12:
        return ()
    gap = math.tan(alpha / 2) * math.tan(gamma / 2) - math.tan(beta / 2) * math.tan(
        delta / 2
    )
    if abs(gap) < SPECIAL_TOLERANCE:
        return special_patterns(sign, alpha, beta, delta)
    k_d, k_b = (_constructive(sign, alpha, gamma, x) for x in (delta, beta))
    base = _products(+1, k_d, k_b)
    # where tan(theta4/2) tends on the plus root as theta1 tends to pi (WDG), or to -pi
    # (DSG)
    t4_infinite = k_b < 1
    if sign < 0:
        m1, m3 = _ratio(beta, alpha), _ratio(delta, alpha)
        m4, m6 = _ratio(delta, gamma), _ratio(beta, gamma)
        t4_infinite = (m6 - m1) * m4 * (m4 - m3) > 0
    inside = _circuit(
        k_d, k_b, (1 - k_b) / (k_d - 1), t1_infinite=True, t4_infinite=t4_infinite
    )
    constructive = (
        FormPattern(I, _both(base, inside, +1)),
        FormPattern(II, _both(base, inside, -1)),
    )
    return constructive + _non_constructive_patterns(sign, alpha, beta, gamma, delta)


def special_patterns(
    sign: int, alpha: float, beta: float, delta: float
) -> tuple[FormPattern, ...]:
    """The four forms under tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2), for
    `patterns`.

    The curve of Forms I and II falls apart. WDG: theta4 = -theta1 in Form I, the
    Bennett form with theta3 = theta6 = 0, and theta5 = -theta1 in Form II. DSG: theta1
    + theta5 = pi in Form I, and theta1 + theta4 = pi in Form II, the Bennett form with
    theta3 = theta6 = pi.
    """
    gamma = 2 * math.atan(
        math.tan(beta / 2) * math.tan(delta / 2) / math.tan(alpha / 2)
    )
    if min(abs(x - y) for x in (beta, delta) for y in (alpha, gamma)) < 1e-12:
        return ()
    base = _products(+1, *(_constructive(sign, alpha, gamma, x) for x in (delta, beta)))
    zero = np.sin if sign > 0 else np.cos

    def with_partner(partner: int, bennett: bool) -> Function:
        def residual(theta: np.ndarray) -> np.ndarray:
            h = np.asarray(theta) / 2
            rows = [zero(h[..., 0] + h[..., partner])]
            if bennett:
                rows += [zero(h[..., 2]), zero(h[..., 5])]
            return np.concatenate([base(theta), np.stack(rows, axis=-1)], axis=-1)

        return residual

    if sign > 0:
        pair = (
            FormPattern("Form I (Bennett 4R)", with_partner(3, True)),
            FormPattern(II, with_partner(4, False)),
        )
    else:
        pair = (
            FormPattern(I, with_partner(4, False)),
            FormPattern("Form II (Bennett 4R)", with_partner(3, True)),
        )
    return pair + _non_constructive_patterns(sign, alpha, beta, gamma, delta)
