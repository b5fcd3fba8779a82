"""Misprints of the paper on tori: each equation as printed and as corrected, against
its equation (2.2)."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from linkages.errata.erratum import Amounts, largest_gap

SIGMA, CHI, THETA, R, S = 0.7, 0.8, 0.25, 1.5, 0.9
PHIS = (0.6, 2.1, -1.3)


def _rotation(axis: int, angle: float) -> np.ndarray:
    """Rotation matrix about the axis 0, 1 or 2."""
    i = (axis + 1) % 3
    j = (axis + 2) % 3
    out = np.eye(3)
    out[i, i] = out[j, j] = cos(angle)
    out[i, j] = -sin(angle)
    out[j, i] = sin(angle)
    return out


def _point(phi: float) -> np.ndarray:
    """Equation (2.2): the point of the torus at ``phi``, at the fixed angles and radii
    above."""
    forth = S * cos(phi)
    side = S * sin(phi)
    along = forth * cos(THETA) + R
    across = side * cos(CHI) + forth * sin(THETA) * sin(CHI)
    x = along * cos(SIGMA) - across * sin(SIGMA)
    y = along * sin(SIGMA) + across * cos(SIGMA)
    z = side * sin(CHI) - forth * sin(THETA) * cos(CHI)
    return np.array([x, y, z])


def _centre() -> np.ndarray:
    """The centre of the circle, half-way between two opposite points of (2.2)."""
    return np.asarray((_point(0.4) + _point(0.4 + np.pi)) / 2)


def _off_axis(axis: np.ndarray) -> float:
    """Largest |cosine| between ``axis`` and the radii of the circle."""
    products = [axis @ (_point(phi) - _centre()) for phi in PHIS]
    return float(max(abs(product) for product in products) / S)


def surface() -> Amounts:
    """Equation (2.1): r added after or before the turn by sigma."""
    by_sigma = _rotation(2, SIGMA)
    by_chi = _rotation(0, CHI)
    shift = np.array([R, 0, 0])
    printed = corrected = 0.0
    for phi in PHIS:
        on_circle = _rotation(1, THETA) @ _rotation(2, phi) @ np.array([S, 0, 0])
        tilted = by_chi @ on_circle
        point = _point(phi)
        printed = max(printed, largest_gap(by_sigma @ tilted + shift, point))
        corrected = max(corrected, largest_gap(by_sigma @ (tilted + shift), point))
    return Amounts(printed, corrected)


def axis_of_chi() -> Amounts:
    """Before (2.1): the axis of the circle turned by chi about Y, or about X."""
    by_sigma = _rotation(2, SIGMA)
    tilted = _rotation(1, THETA) @ [0, 0, 1]
    printed = by_sigma @ _rotation(1, CHI) @ tilted
    corrected = by_sigma @ _rotation(0, CHI) @ tilted
    return Amounts(_off_axis(printed), _off_axis(corrected))


def centres() -> Amounts:
    """Equation (2.5): the centre without and with its distance r."""
    direction = np.array([cos(SIGMA), sin(SIGMA), 0])
    centre = _centre()
    return Amounts(largest_gap(direction, centre), largest_gap(R * direction, centre))


def axis_of_circle() -> Amounts:
    """Equation (2.6): the direction of the circle's axis."""
    phi = PHIS[0]
    sp = sin(phi)
    cp = cos(phi)
    along = cos(THETA) * cp
    across = cos(CHI) * sp - sin(CHI) * sin(THETA) * cp
    x = along * cos(SIGMA) + across * sin(SIGMA)
    y = along * sin(SIGMA) - across * cos(SIGMA)
    z = -sin(CHI) * sp - cos(CHI) * sin(THETA) * cp
    printed = np.array([x, y, z])
    local_y = -sin(CHI) * cos(THETA)
    local_z = cos(CHI) * cos(THETA)
    local = np.array([sin(THETA), local_y, local_z])
    corrected = _rotation(2, SIGMA) @ local
    return Amounts(_off_axis(printed), _off_axis(corrected))


def carried_centre() -> Amounts:
    """Equation (3.2), R1 = Q4: the origin of torus 4 is the centre of the circle of
    torus 1."""
    shift = np.array([R, 0, 0])
    centre = _centre()
    return Amounts(
        largest_gap(shift, centre), largest_gap(_rotation(2, SIGMA) @ shift, centre)
    )


def circle_direction() -> Amounts:
    """Equation (2.3): the pin direction is a unit vector."""
    return Amounts(_direction_length_gap(+1), _direction_length_gap(-1))


def _direction_length_gap(sign: int) -> float:
    """How far the length of the vector is from 1, with this sign of sin(theta)."""
    kappa = 0.3
    zeta = -0.4
    ck = cos(kappa)
    sk = sin(kappa)
    cz = cos(zeta)
    sz = sin(zeta)
    cp = cos(PHIS[0])
    sp = sin(PHIS[0])
    along = cz * sk * cp + sz * sp
    across = cz * sk * sp - sz * cp
    x = along * cos(THETA) + cz * ck * sin(THETA)
    up = sign * along * sin(THETA) + cz * ck * cos(THETA)
    y = cos(CHI) * across - sin(CHI) * up
    z = sin(CHI) * across + cos(CHI) * up
    return float(abs(np.sqrt(x * x + y * y + z * z) - 1))
