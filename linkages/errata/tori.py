"""Misprints of the paper on tori: each equation as printed and as corrected, against
its equation (2.2)."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

import numpy as np

__all__ = ["TORI_ROWS"]

Row = tuple[str, str, str, str, str, Callable[[], tuple[float, float]]]
SIGMA, CHI, THETA, R, S = 0.7, 0.8, 0.25, 1.5, 0.9
PHIS = (0.6, 2.1, -1.3)


def _about(axis: int, angle: float) -> np.ndarray:
    """Rotation matrix about the axis 0, 1 or 2."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    out = np.eye(3)
    out[i, i] = out[j, j] = cos(angle)
    out[i, j], out[j, i] = -sin(angle), sin(angle)
    return out


def _point(phi: float) -> np.ndarray:
    """Equation (2.2): the point of the torus at ``phi``, at the fixed angles and radii
    above."""
    along = S * cos(phi) * cos(THETA) + R
    across = S * sin(phi) * cos(CHI) + S * cos(phi) * sin(THETA) * sin(CHI)
    x, y = (
        along * cos(SIGMA) - across * sin(SIGMA),
        along * sin(SIGMA) + across * cos(SIGMA),
    )
    return np.array(
        [x, y, S * sin(phi) * sin(CHI) - S * cos(phi) * sin(THETA) * cos(CHI)]
    )


def _centre() -> np.ndarray:
    """The centre of the circle, half-way between two opposite points of (2.2)."""
    return np.asarray((_point(0.4) + _point(0.4 + np.pi)) / 2)


def _gap(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.abs(x - y).max())


def _off_axis(axis: np.ndarray) -> float:
    """Largest |cosine| between ``axis`` and the radii of the circle."""
    return max(abs(float(axis @ (_point(phi) - _centre()))) / S for phi in PHIS)


def _surface() -> tuple[float, float]:
    sigma, chi, theta = _about(2, SIGMA), _about(0, CHI), _about(1, THETA)
    printed = corrected = 0.0
    for phi in PHIS:
        turned = theta @ _about(2, phi) @ np.array([S, 0, 0])
        printed = max(printed, _gap(sigma @ chi @ turned + [R, 0, 0], _point(phi)))
        corrected = max(
            corrected, _gap(sigma @ (chi @ turned + [R, 0, 0]), _point(phi))
        )
    return printed, corrected


def _axis_of_chi() -> tuple[float, float]:
    sigma, end = _about(2, SIGMA), _about(1, THETA) @ [0, 0, 1]
    return _off_axis(sigma @ _about(1, CHI) @ end), _off_axis(
        sigma @ _about(0, CHI) @ end
    )


def _centres() -> tuple[float, float]:
    direction = np.array([cos(SIGMA), sin(SIGMA), 0])
    return _gap(direction, _centre()), _gap(R * direction, _centre())


def _axis_of_circle() -> tuple[float, float]:
    phi = PHIS[0]
    long = cos(THETA) * cos(phi)
    cross = cos(CHI) * sin(phi) - sin(CHI) * sin(THETA) * cos(phi)
    x, y = (
        long * cos(SIGMA) + cross * sin(SIGMA),
        long * sin(SIGMA) - cross * cos(SIGMA),
    )
    printed = np.array([x, y, -sin(CHI) * sin(phi) - cos(CHI) * sin(THETA) * cos(phi)])
    local = np.array([sin(THETA), -sin(CHI) * cos(THETA), cos(CHI) * cos(THETA)])
    return _off_axis(printed), _off_axis(_about(2, SIGMA) @ local)


def _carried_centre() -> tuple[float, float]:
    """Equation (3.2), R1 = Q4: the origin of torus 4 is the centre of the circle of
    torus 1."""
    shift = np.array([R, 0, 0])
    return _gap(shift, _centre()), _gap(_about(2, SIGMA) @ shift, _centre())


TORI = "Bil and Budniak, Model of 5R spatial linkage in the geometry of tori"
TORI_ROWS: tuple[Row, ...] = (
    (
        TORI,
        "before (2.1)",
        "torus-4r",
        "axis of the circle turned by chi about Y",
        "turned by chi about X",
        _axis_of_chi,
    ),
    (
        TORI,
        "(2.1)",
        "torus-4r",
        "Rz(sigma) Rx(chi) {...} + (r, 0, 0)",
        "Rz(sigma) {Rx(chi) ... + (r, 0, 0)}",
        _surface,
    ),
    (
        TORI,
        "(2.5)",
        "torus-4r",
        "R = (cos(sigma), sin(sigma), 0)",
        "R = r (cos(sigma), sin(sigma), 0)",
        _centres,
    ),
    (
        TORI,
        "(2.6)",
        "torus-4r",
        "Z with cos(phi) and sin(phi), a radius of the circle",
        "Z = Rz(sigma) (sin(theta), -sin(chi) cos(theta), cos(chi) cos(theta))",
        _axis_of_circle,
    ),
    (
        TORI,
        "(3.5), (3.6)",
        "torus-5r-14-plus-plus",
        "... + (r1, 0, 0)",
        "... + r1 (cos(sigma1), sin(sigma1), 0)",
        _carried_centre,
    ),
)
