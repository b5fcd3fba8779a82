"""Misprints in the switching of the roots of the double-Goldberg linkages, and m2 for
m6 in their special conditions.

At a switch of the square root the curve must go on: the measure is the gap between the
angles theta4, as |sin| of half their difference, on both sides of the input where the
print, or the correction, changes the root.
"""

from __future__ import annotations

from math import atan, nan, radians, sin, sqrt, tan
from typing import NamedTuple

import numpy as np

from linkages.errata.erratum import Amounts, Erratum

NEAR = 1e-13  # rad, from the input where the root changes


class Twists(NamedTuple):
    """Twists of the basic links, rad."""

    alpha: float
    beta: float
    gamma: float
    delta: float


class Ratios(NamedTuple):
    """m1, m2, m3, m4, m6 of (3.4.1)."""

    m1: float
    m2: float
    m3: float
    m4: float
    m6: float


def _twists(*degrees: float) -> Twists:
    return Twists(*(radians(x) for x in degrees))


# m3 m4 < 0 and m1 m6 < 0: full turns through a pole of Q
CROSSING = _twists(66, 40, 28, 50)
PLAIN = _twists(66, 50, 28, 83)  # m3 m4 > 0: Q has no pole


def _m(x: float, y: float) -> float:
    return sin((x + y) / 2) / sin((x - y) / 2)


def _ratios(twists: Twists) -> Ratios:
    alpha, beta, gamma, delta = twists
    return Ratios(
        _m(beta, alpha),
        _m(gamma, alpha),
        _m(delta, alpha),
        _m(delta, gamma),
        _m(beta, gamma),
    )


def _fourth(twists: Twists, theta_1: float, root: int) -> float:
    """theta4 by (5.2.2), (5.2.4) with 1 - m1 m6 throughout; nan where there is none."""
    m = _ratios(twists)
    k = m.m3 * m.m4
    product = m.m1 * m.m6
    t = tan(theta_1 / 2)
    q = (k - 1) * t / (k + t * t)
    square = (1 - product) ** 2 - 4 * product * q * q
    if square < 0:
        return nan
    p = ((1 - product) + root * sqrt(square)) / (2 * m.m6 * q)
    return 2 * atan(m.m6 * p)


def _gap(twists: Twists, t: float, below: int, above: int) -> float:
    """Gap of theta4 at tan(theta1/2) = ``t`` between the root ``below`` and the root
    ``above``."""
    at = 2 * atan(t)
    before = _fourth(twists, at - NEAR, below)
    after = _fourth(twists, at + NEAR, above)
    return abs(sin((before - after) / 2))


def _pole() -> float:
    """tan(theta1/2) at the pole of Q, sqrt(-m3 m4)."""
    m = _ratios(CROSSING)
    return sqrt(-m.m3 * m.m4)


def _place() -> Amounts:
    """Switch at sqrt(m3 m4); or at sqrt(-m3 m4) where that is real, and nowhere
    else."""
    m = _ratios(PLAIN)
    place = sqrt(m.m3 * m.m4)
    printed = _gap(PLAIN, place, -1, 1)
    without = _gap(PLAIN, place, 1, 1)
    at_pole = _gap(CROSSING, _pole(), -1, 1)
    return Amounts(printed, max(without, at_pole))


def _ranges() -> Amounts:
    """The plus root below and above 2 atan(q), as the printed ranges say; or above
    alone."""
    pole = _pole()
    return Amounts(_gap(CROSSING, pole, 1, 1), _gap(CROSSING, pole, -1, 1))


def _paper_place() -> Amounts:
    """The modulus of Song and Chen's q, which is imaginary, beside sqrt(-m1 m2); b and
    d have changed places there."""
    alpha, beta, gamma, delta = CROSSING
    m1 = _m(delta, alpha)
    m2 = _m(delta, gamma)
    m3 = _m(beta, alpha)
    m4 = _m(beta, gamma)
    top = (m2 + m3) - m2 * m3 * (m1 + m4)
    bottom = m1 * m4 * (m2 + m3) - (m1 + m4)
    place = abs(m1) * sqrt(abs(top / bottom))
    printed = _gap(CROSSING, place, -1, 1)
    return Amounts(printed, _gap(CROSSING, sqrt(-m1 * m2), -1, 1))


# --- m2 for m6


def _special_ratios(alpha: float, beta: float, gamma: float) -> Ratios:
    """The ratios with delta by tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2)."""
    delta = 2 * atan(tan(alpha / 2) * tan(gamma / 2) / tan(beta / 2))
    return _ratios(Twists(alpha, beta, gamma, delta))


def _constant_angle() -> Amounts:
    """Equations (5.2.13) to (5.2.15) and (5.2.17) on the special linkage: the least
    that the print leaves of one, the largest that the correction leaves."""
    m = _special_ratios(radians(125), radians(60), radians(14))
    printed = _left_by(m, m.m2)
    corrected = _left_by(m, m.m6)
    return Amounts(min(printed), max(*corrected, abs(m.m4 + m.m1)))


def _left_by(m: Ratios, printed: float) -> list[float]:
    """What the equations leave with ``printed`` in the place of m6."""
    t = 0.7
    fourth = m.m4 * t
    q = (m.m3 + fourth * t) / ((m.m4 - m.m3) * t)
    difference = printed - m.m1
    slope = difference * q
    root = np.emath.sqrt(slope**2 - 4 * m.m1 * printed)
    one = abs(fourth - (slope + root) / 2)
    other = abs(fourth - (slope - root) / 2)
    products = m.m3 * m.m4 * difference - m.m1 * printed * (m.m4 - m.m3)
    return [
        float(min(one, other)),
        abs(difference - (m.m4 - m.m3)),
        abs(products),
        abs(m.m3 + printed),
    ]


def _critical_input() -> Amounts:
    """Appendix B, Case 3: m6 - m1 tan(theta1/2)^2 at the input where its sign is said
    to change."""
    m = _special_ratios(radians(70), radians(125), radians(120))
    printed = atan(sqrt(m.m2 / m.m1))
    corrected = 2 * atan(sqrt(m.m6 / m.m1))
    return Amounts(
        abs(m.m6 - m.m1 * tan(printed / 2) ** 2),
        abs(m.m6 - m.m1 * tan(corrected / 2) ** 2),
    )


SONG = "Song 2013"
SPECIAL_PAPER = "Song and Chen 2012 (special)"
WDG = "wohlhart-double-goldberg"
DSG = "special-double-subtractive-goldberg"

SWITCHING_ERRATA: tuple[Erratum, ...] = (
    Erratum(
        SONG,
        "(5.2.4), (5.2.5)",
        WDG,
        "the root changes at q = sqrt(m3 m4)",
        "at q = sqrt(-m3 m4), and only if m3 m4 < 0",
        _place,
    ),
    Erratum(
        SONG,
        "(5.2.4), (5.2.5)",
        WDG,
        "-pi <= theta1 < 2 atan(q), -2 atan(q) <= theta1 < pi",
        "-pi <= theta1 < -2 atan(q), 2 atan(q) <= theta1 < pi",
        _ranges,
    ),
    Erratum(
        SPECIAL_PAPER,
        "(5.4), (5.5)",
        WDG,
        "q = abs(m1) sqrt(...) is imaginary; the amount is for its modulus",
        "q = sqrt(-m1 m2), and only if m1 m2 < 0",
        _paper_place,
    ),
    Erratum(
        SONG,
        "(5.2.13)-(5.2.15), (5.2.17)",
        DSG,
        "m2, as in m3 = -m2",
        "m6, as in m3 = -m6",
        _constant_angle,
    ),
    Erratum(
        SONG,
        "Appendix B, Case 3",
        DSG,
        "limits at atan(sqrt(m2/m1))",
        "limits at 2 atan(sqrt(m6/m1))",
        _critical_input,
    ),
)
