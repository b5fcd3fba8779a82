"""Misprints in the switching of the roots of the double-Goldberg linkages, and m2 for
m6 in their special conditions.

At a switch of the square root the curve must go on: the measure is the gap between the
angles theta4, as |sin| of half their difference, on both sides of the input where the
print, or the correction, changes the root.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atan, radians, sin, sqrt, tan

import numpy as np

__all__ = ["SWITCHING_ROWS"]

Row = tuple[str, str, str, str, str, Callable[[], tuple[float, float]]]
NEAR = 1e-13
CROSSING = tuple(
    map(radians, (66, 40, 28, 50))
)  # m3 m4 < 0 and m1 m6 < 0: full turns through a pole of Q
PLAIN = tuple(map(radians, (66, 50, 28, 83)))  # m3 m4 > 0: Q has no pole


def _m(x: float, y: float) -> float:
    return sin((x + y) / 2) / sin((x - y) / 2)


def _products(twists: tuple[float, ...]) -> tuple[float, float, float]:
    """m3 m4, m1 m6 and m6 of (5.2.3) for alpha, beta, gamma, delta."""
    alpha, beta, gamma, delta = twists
    return (
        _m(delta, alpha) * _m(delta, gamma),
        _m(beta, alpha) * _m(beta, gamma),
        _m(beta, gamma),
    )


def _fourth(twists: tuple[float, ...], theta_1: float, root: int) -> float:
    """theta4 by (5.2.2), (5.2.4) with 1 - m1 m6 throughout; nan where there is none."""
    k, product, m6 = _products(twists)
    t = tan(theta_1 / 2)
    q = (k - 1) * t / (k + t * t)
    square = (1 - product) ** 2 - 4 * product * q * q
    if square < 0:
        return float("nan")
    return float(2 * atan(m6 * ((1 - product) + root * sqrt(square)) / (2 * m6 * q)))


def _gap(twists: tuple[float, ...], t: float, roots: tuple[int, int]) -> float:
    """Gap of theta4 at tan(theta1/2) = ``t`` between the first root below and the
    second above."""
    at = 2 * atan(t)
    return abs(
        sin(
            (
                _fourth(twists, at - NEAR, roots[0])
                - _fourth(twists, at + NEAR, roots[1])
            )
            / 2
        )
    )


def _place() -> tuple[float, float]:
    """Switch at sqrt(m3 m4); or at sqrt(-m3 m4) where that is real, and nowhere
    else."""
    printed = sqrt(_products(PLAIN)[0])
    pole = sqrt(-_products(CROSSING)[0])
    return _gap(PLAIN, printed, (-1, 1)), max(
        _gap(PLAIN, printed, (1, 1)), _gap(CROSSING, pole, (-1, 1))
    )


def _ranges() -> tuple[float, float]:
    """The plus root below and above 2 atan(q), as the printed ranges say; or above
    alone."""
    pole = sqrt(-_products(CROSSING)[0])
    return _gap(CROSSING, pole, (1, 1)), _gap(CROSSING, pole, (-1, 1))


def _paper_place() -> tuple[float, float]:
    """The modulus of Song and Chen's q, which is imaginary, beside sqrt(-m1 m2); b and
    d have changed places there."""
    alpha, beta, gamma, delta = CROSSING
    m1, m2, m3, m4 = (_m(x, y) for x in (delta, beta) for y in (alpha, gamma))
    top, bottom = (m2 + m3) - m2 * m3 * (m1 + m4), m1 * m4 * (m2 + m3) - (m1 + m4)
    printed = abs(m1) * sqrt(abs(top / bottom))
    return _gap(CROSSING, printed, (-1, 1)), _gap(CROSSING, sqrt(-m1 * m2), (-1, 1))


# --- m2 for m6


def _special(alpha: float, beta: float, gamma: float) -> tuple[float, ...]:
    """m1, m2, m3, m4, m6 of (3.4.1) with delta by tan(alpha/2) tan(gamma/2) =
    tan(beta/2) tan(delta/2)."""
    delta = 2 * atan(tan(alpha / 2) * tan(gamma / 2) / tan(beta / 2))
    return (
        _m(beta, alpha),
        _m(gamma, alpha),
        _m(delta, alpha),
        _m(delta, gamma),
        _m(beta, gamma),
    )


def _constant_angle() -> tuple[float, float]:
    """Equations (5.2.13) to (5.2.15) and (5.2.17) on the special linkage: the largest
    of what they leave."""
    m1, m2, m3, m4, m6 = _special(radians(125), radians(60), radians(14))
    t = 0.7
    q, out = (m3 + m4 * t * t) / ((m4 - m3) * t), []
    for m in (m2, m6):
        root = np.emath.sqrt((m - m1) ** 2 * q * q - 4 * m1 * m)
        equation = min(
            abs(m4 * t - ((m - m1) * q + sign * root) / 2) for sign in (1, -1)
        )
        pair = abs((m - m1) - (m4 - m3)), abs(m3 * m4 * (m - m1) - m1 * m * (m4 - m3))
        out.append([float(equation), *pair, abs(m3 + m)])
    return min(out[0]), max(*out[1], abs(m4 + m1))


def _critical_input() -> tuple[float, float]:
    """Appendix B, Case 3: m6 - m1 tan(theta1/2)^2 at the input where its sign is said
    to change."""
    m1, m2, _, _, m6 = _special(radians(70), radians(125), radians(120))
    printed, corrected = atan(sqrt(m2 / m1)), 2 * atan(sqrt(m6 / m1))
    return abs(m6 - m1 * tan(printed / 2) ** 2), abs(m6 - m1 * tan(corrected / 2) ** 2)


SONG, WDG, DSG = (
    "Song 2013",
    "wohlhart-double-goldberg",
    "special-double-subtractive-goldberg",
)
SWITCHING_ROWS: tuple[Row, ...] = (
    (
        SONG,
        "(5.2.4), (5.2.5)",
        WDG,
        "the root changes at q = sqrt(m3 m4)",
        "at q = sqrt(-m3 m4), and only if m3 m4 < 0",
        _place,
    ),
    (
        SONG,
        "(5.2.4), (5.2.5)",
        WDG,
        "-pi <= theta1 < 2 atan(q), -2 atan(q) <= theta1 < pi",
        "-pi <= theta1 < -2 atan(q), 2 atan(q) <= theta1 < pi",
        _ranges,
    ),
    (
        "Song and Chen 2012 (special)",
        "(5.4), (5.5)",
        WDG,
        "q = abs(m1) sqrt(...) is imaginary; the amount is for its modulus",
        "q = sqrt(-m1 m2), and only if m1 m2 < 0",
        _paper_place,
    ),
    (
        SONG,
        "(5.2.13)-(5.2.15), (5.2.17)",
        DSG,
        "m2, as in m3 = -m2",
        "m6, as in m3 = -m6",
        _constant_angle,
    ),
    (
        SONG,
        "Appendix B, Case 3",
        DSG,
        "limits at atan(sqrt(m2/m1))",
        "limits at 2 atan(sqrt(m6/m1))",
        _critical_input,
    ),
)
