"""Misprints in the paper on Wohlhart's symmetric mechanism.

Its joints O1, ..., O6 lie in two planes; O6 is the origin, theta and phi are the angles
of the odd and of the even joints.
"""

from __future__ import annotations

from math import radians
from typing import NamedTuple

import numpy as np

from linkages.errata.erratum import Amounts, Erratum, median_and_largest
from linkages.errata.matrices import path_along

__all__ = ["MECHANISM_ERRATA"]

TWIST = radians(100)
LENGTH = 1.3
SIN_TWIST, COS_TWIST = np.sin(TWIST), np.cos(TWIST)


class _Configurations(NamedTuple):
    """Angles theta and phi (k,), rad, and joints (k, 6, 3) along the motion."""

    theta: np.ndarray
    phi: np.ndarray
    joints: np.ndarray


def _configurations() -> _Configurations:
    loop, path = path_along("wohlhart-symmetric", a=LENGTH, alpha=TWIST)
    joints = loop.frames(path)[:, 1:7, :3, 3]
    return _Configurations(path[:, 0], path[:, 1], joints)


def _even_plane() -> Amounts:
    """Equation (17): the normal of the plane O2 O4 O6 is at right angles to O6 O2 and
    O6 O4."""
    x, y, joints = _configurations()
    sx, cx = np.sin(x), np.cos(x)
    sy, cy = np.sin(y), np.cos(y)
    s, c = SIN_TWIST, COS_TWIST
    area = LENGTH**2
    first = area * sy * s * (sx * cy + cx * sy * c - sy * c + sx)
    second = -area * sy * s * (cx + cy + cx * cy - sx * sy * c + 1)
    one = sy * c * (cx * cy - sx * sy * c + cx)
    other = sx * cy + cx * sy * c + sx

    def gaps(factor: np.ndarray) -> np.ndarray:
        third = area * (one + factor * other)
        normal = np.stack([first, second, third], axis=-1)
        products = np.einsum("ki,kji->kj", normal, joints[:, [1, 3]])
        return np.asarray(np.abs(products).max(axis=1))

    return median_and_largest(gaps(cx + 1), gaps(cy + 1))


def _distance_of_planes() -> Amounts:
    """Equation (29): the distance of O1 from the plane O2 O4 O6."""
    x, y, joints = _configurations()
    o1, o2, o4, o6 = (joints[:, i] for i in (0, 1, 3, 5))
    normal = np.cross(o2 - o6, o4 - o6)
    size = np.linalg.norm(normal, axis=1)
    distance = np.abs(np.einsum("ki,ki->k", normal, o1 - o6)) / size
    is_plane = size > 1e-3

    def gaps(other: np.ndarray, first: np.ndarray) -> np.ndarray:
        sx, cx = np.sin(x / 2), np.cos(x / 2)
        so, co = np.sin(other / 2), np.cos(other / 2)
        top = np.abs(LENGTH * sx * so * SIN_TWIST)
        mixed = sx * co + cx * so * COS_TWIST
        square = np.sin(first / 2) ** 2 * SIN_TWIST**2 + mixed**2
        return np.asarray(np.abs(top / np.sqrt(square) - distance)[is_plane])

    return median_and_largest(gaps(np.full_like(y, TWIST), x), gaps(y, y))


class _Line(NamedTuple):
    """A joint axis: a point of it, and its direction."""

    point: np.ndarray
    direction: np.ndarray


def _meeting(one: _Line, other: _Line) -> np.ndarray:
    """Where two lines meet."""
    directions = np.stack([one.direction, -other.direction], axis=1)
    gap = other.point - one.point
    along = np.linalg.lstsq(directions, gap, rcond=None)[0]
    return np.asarray(one.point + along[0] * one.direction)


def _line_of_meetings() -> Amounts:
    """Equation (25): n, and n divided by its length, beside the unit vector from O'' to
    O'."""
    loop, path = path_along("wohlhart-symmetric", a=LENGTH, alpha=TWIST)
    printed = []
    corrected = []
    for theta in path:
        x, y = theta[:2]
        if abs(np.sin(x) * np.sin(y)) <= 0.3:
            continue
        frames = loop.frames(theta)
        axes = [_Line(frame[:3, 3], frame[:3, 2]) for frame in frames]
        line = _meeting(axes[6], axes[4]) - _meeting(axes[1], axes[5])
        line = line / np.linalg.norm(line)
        by_x = (np.cos(x) + 1) / np.sin(x) / np.tan(TWIST)
        by_y = (np.cos(y) + 1) / (np.sin(y) * SIN_TWIST)
        n = np.array([1, -np.sin(x) / (1 - np.cos(x)), by_x + by_y])
        printed.append(float(np.abs(n - line).max()))
        corrected.append(float(np.abs(n / np.linalg.norm(n) - line).max()))
    return median_and_largest(printed, corrected)


SOURCE = "Racila and Dahan 2010"

MECHANISM_ERRATA: tuple[Erratum, ...] = (
    Erratum(
        SOURCE,
        "(17)",
        "wohlhart-symmetric",
        "C3 with (cos(theta) + 1)(...)",
        "(cos(phi) + 1)(...)",
        _even_plane,
    ),
    Erratum(
        SOURCE,
        "(25)",
        "wohlhart-symmetric",
        "unit vector n with n_x = 1",
        "n divided by its length",
        _line_of_meetings,
    ),
    Erratum(
        SOURCE,
        "(29)",
        "wohlhart-symmetric",
        "sin(alpha/2), cos(alpha/2) and sin^2(theta/2) sin^2(alpha) under the root",
        "sin(phi/2), cos(phi/2) and sin^2(phi/2) sin^2(alpha)",
        _distance_of_planes,
    ),
)
