"""Equations between numbers as printed, beside the corrected ones."""

from __future__ import annotations

from math import cos, pi, radians, sin

import numpy as np

from linkages.catalogue import entry
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link
from linkages.errata.erratum import Amounts, Erratum


def _special_length() -> Amounts:
    """Equation (5.2.34): b = sin(beta)/sin(alpha), to the four decimals that are
    printed."""
    rounded = round(sin(radians(60)) / sin(radians(125)), 4)
    return Amounts(abs(1.5072 - rounded), abs(1.0572 - rounded))


def _cosine_multipliers() -> Amounts:
    """Equation (5.2.21): the first fraction must stay sin((d+g)/2)/sin((d-g)/2), times
    one; (5.2.22) follows."""
    d = radians(83)
    g = radians(28)
    half_sum = (d + g) / 2
    half_difference = (d - g) / 2
    value = sin(half_sum) / sin(half_difference)
    printed = sin(d + g) / (sin(d) - cos(g))
    corrected = (sin(d) + sin(g)) / sin(d - g)
    second = sin(d + g) / (sin(d) - sin(g)) * cos(half_sum) / cos(half_sum)
    double = 2 * cos(half_sum)
    expected = sin(half_sum) * double / (sin(half_difference) * double)
    left = max(abs(corrected - value), abs(second - expected))
    return Amounts(abs(printed - expected), left)


def _triangle_offset() -> Amounts:
    """Equation (5.3.2): R3 over sin(alpha31) sin(theta3), or over sin(alpha23)
    sin(theta2)."""
    a = 0.9
    alpha = radians(35)
    b = 2.0
    beta = radians(60)
    theta_2 = radians(-70)
    triangle = composite_link(Link(a, alpha), Link(b, beta), theta_2, 0.7)
    d = float(triangle.link.length)
    r3 = -float(triangle.after.offset)
    theta_3 = pi - float(triangle.after.angle)
    mixed = cos(beta) * sin(theta_2) * sin(theta_3) - cos(theta_2) * cos(theta_3)
    top = d * mixed - a - b * cos(theta_2)
    printed = top / (sin(float(triangle.link.twist)) * sin(theta_3))
    corrected = top / (sin(beta) * sin(theta_2))
    return Amounts(abs(abs(printed) - abs(r3)), abs(abs(corrected) - abs(r3)))


def _line_symmetric_bennett() -> Amounts:
    """Equation (5.3.6): cosines or sines with the twist gamma, the second twist being
    gamma - pi."""
    alpha = radians(66)
    gamma = radians(50)
    loop = entry("bennett-lb-2").build(a=1.0, alpha=alpha, beta=gamma)

    def defect(product: float) -> float:
        t = 0.8
        one = 2 * np.arctan(t)
        other = 2 * np.arctan(product / t)
        product_of_all = loop.frames(np.array([one, other, one, other]))[-1]
        return float(np.abs(product_of_all - np.eye(4)).max())

    total = (gamma + alpha) / 2
    difference = (gamma - alpha) / 2
    printed = defect(cos(total) / cos(difference))
    corrected = defect(sin(total) / sin(difference))
    return Amounts(printed, corrected)


def _circle_direction() -> Amounts:
    """Equation (2.3): the pin direction is a unit vector."""
    return Amounts(_direction_length_gap(+1), _direction_length_gap(-1))


def _direction_length_gap(sign: int) -> float:
    """How far the length of the vector is from 1, with this sign of sin(theta)."""
    chi = 0.8
    theta = 0.25
    phi = 0.6
    kappa = 0.3
    zeta = -0.4
    ck = cos(kappa)
    sk = sin(kappa)
    cz = cos(zeta)
    sz = sin(zeta)
    cp = cos(phi)
    sp = sin(phi)
    along = cz * sk * cp + sz * sp
    across = cz * sk * sp - sz * cp
    x = along * cos(theta) + cz * ck * sin(theta)
    up = sign * along * sin(theta) + cz * ck * cos(theta)
    y = cos(chi) * across - sin(chi) * up
    z = sin(chi) * across + cos(chi) * up
    return float(abs(np.sqrt(x * x + y * y + z * z) - 1))


SONG = "Song 2013"
TORI = "Bil and Budniak, Model of 5R spatial linkage in the geometry of tori"

EQUATION_ERRATA: tuple[Erratum, ...] = (
    Erratum(
        SONG,
        "(5.2.34)",
        "special-double-subtractive-goldberg",
        "b = 1.5072",
        "b = 1.0572 (a sin(beta)/sin(alpha))",
        _special_length,
    ),
    Erratum(
        SONG,
        "(5.2.21), (5.2.22)",
        "double-subtractive-goldberg",
        "sin(delta + gamma)/(sin(delta) - cos(gamma))",
        "sin(delta + gamma)/(sin(delta) - sin(gamma)), "
        "the multipliers being cos((delta + gamma)/2)",
        _cosine_multipliers,
    ),
    Erratum(
        SONG,
        "(5.3.2), (5.3.9), (5.3.18)",
        "reconfigurable-bricard-1",
        "R3 over sin(alpha31) sin(theta3)",
        "R3 over sin(alpha23) sin(theta2)",
        _triangle_offset,
    ),
    Erratum(
        SONG,
        "(5.3.6)",
        "reconfigurable-bricard-2",
        "cos((gamma + delta)/2) / cos((gamma - delta)/2)",
        "sin((gamma + delta)/2) / sin((gamma - delta)/2)",
        _line_symmetric_bennett,
    ),
    Erratum(
        TORI,
        "(2.3)",
        "torus-5r-13-plus-plus",
        "+(c_zeta s_kappa c_phi + s_zeta s_phi) s_theta in y and z",
        "- in both rows; then the vector has length 1",
        _circle_direction,
    ),
)
