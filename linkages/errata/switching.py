"""Misprints in the switching of the roots of the double-Goldberg linkages, and m2 for
m6 in their special conditions, and Appendix C on the first reconfigurable linkage.

At a switch of the square root the curve must go on: the measure is the gap between the
angles theta4, as |sin| of half their difference, on both sides of the input where the
print, or the correction, changes the root.
"""

from __future__ import annotations

from math import atan, nan, radians, sin, sqrt, tan
from typing import NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import CompositeLink, composite_link
from linkages.errata.erratum import Amounts
from linkages.families.bricard import LETTERS, closure_equations

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


def place() -> Amounts:
    """Switch at sqrt(m3 m4); or at sqrt(-m3 m4) where that is real, and nowhere
    else."""
    m = _ratios(PLAIN)
    place = sqrt(m.m3 * m.m4)
    printed = _gap(PLAIN, place, -1, 1)
    without = _gap(PLAIN, place, 1, 1)
    at_pole = _gap(CROSSING, _pole(), -1, 1)
    return Amounts(printed, max(without, at_pole))


def ranges() -> Amounts:
    """The plus root below and above 2 atan(q), as the printed ranges say; or above
    alone."""
    pole = _pole()
    return Amounts(_gap(CROSSING, pole, 1, 1), _gap(CROSSING, pole, -1, 1))


def paper_place() -> Amounts:
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


def constant_angle() -> Amounts:
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


def critical_input() -> Amounts:
    """Appendix B, Case 3: m6 - m1 tan(theta1/2)^2 at the input where its sign is said
    to change."""
    m = _special_ratios(radians(70), radians(125), radians(120))
    printed = atan(sqrt(m.m2 / m.m1))
    corrected = 2 * atan(sqrt(m.m6 / m.m1))
    return Amounts(
        abs(m.m6 - m.m1 * tan(printed / 2) ** 2),
        abs(m.m6 - m.m1 * tan(corrected / 2) ** 2),
    )


# --- Appendix C, on the first reconfigurable linkage

FIRST = "reconfigurable-bricard-1"


def _triangle() -> CompositeLink:
    """The spatial triangle on its links 12 and 23."""
    values = entry(FIRST).defaults
    a = Link(values["a"], values["alpha"])
    b = Link(values["b"], values["beta"])
    return composite_link(a, b, values["kink"], values["r2"])


def _kink() -> float:
    """The angle theta2' of the Bennett form, rad."""
    return entry(FIRST).defaults["kink"]


def _coefficients() -> dict[str, float]:
    """The coefficients (C6), by their letters."""
    lengths, twists, offsets = (row[:3] for row in entry(FIRST).build().arrays)
    c12, c23, c34 = np.cos(twists)
    s12, s23, s34 = np.sin(twists)
    a12, a23, a34 = lengths
    r1, r2, r3 = offsets
    second = closure_equations(
        (a12, a23, a34), (c12, c23, c34), (s12, s23, s34), (r1, r2, r3)
    ).second
    out = {}
    for letter, value in zip(LETTERS, second, strict=True):
        out[letter] = float(value)
    return out


def _left(t: float, first: int, third: int) -> float:
    """What (C7) leaves at the two bifurcations with tan(theta2/2) = ``t``; ``first``
    and ``third`` are the signs of the terms in (C8)."""
    k = _coefficients()

    def term(x: str, y: str, z: str) -> float:
        one = k[x] + first * k[y]
        other = k[x] + third * k[y]
        return one * t * t + 2 * k[z] * t + other

    by_sine = term("A", "F", "E")
    by_cosine = term("B", "H", "G")
    free = term("L", "D", "C")
    theta_1 = -float(_triangle().before.angle)
    gaps = []
    for x in (theta_1, theta_1 + np.pi):
        gaps.append(abs(by_sine * np.sin(x) + by_cosine * np.cos(x) + free))
    return float(max(gaps))


def equal_angles() -> Amounts:
    """Equation (C3): theta2 of the bifurcations by tan(theta2/2) = tan(theta2'), or
    theta2 = theta2'."""
    kink = _kink()
    return Amounts(_left(np.tan(kink), -1, 1), _left(np.tan(kink / 2), -1, 1))


def third_terms() -> Amounts:
    """Equation (C8): differences, or sums, in the third terms."""
    t = np.tan(_kink() / 2)
    return Amounts(_left(t, -1, -1), _left(t, -1, 1))


def asymmetric_ratio() -> Amounts:
    """Equation (5.3.18): sin(alpha34)/a34 beside the fraction, by the angle theta1' of
    the triangle."""
    lengths, twists, offsets = entry(FIRST).build().arrays
    x = np.pi - float(_triangle().before.angle)
    sin_x = np.sin(x)
    cos_x = np.cos(x)
    sin_k = np.sin(_kink())
    cos_k = np.cos(_kink())
    c12, c23 = np.cos(twists[:2])
    s12, s23 = np.sin(twists[:2])
    top = s23 * sin_k * sin_x - c23 * s12 * cos_x - c12 * cos_k * s23 * cos_x
    bottom = (
        lengths[1] * (c12 * sin_x * sin_k - cos_x * cos_k)
        - lengths[0] * cos_x
        - offsets[1] * s12 * sin_x
    )
    fraction = top / bottom
    ratio = np.sin(twists[2]) / lengths[2]
    return Amounts(float(abs(-ratio - fraction)), float(abs(ratio - fraction)))
