"""Misprints in the paper on Wohlhart's symmetric mechanism.

Its joints O1, ..., O6 lie in two planes; O6 is the origin, theta and phi are the angles
of the odd and of the even joints.
"""

from __future__ import annotations

from math import radians
from typing import NamedTuple

import numpy as np

from linkages.errata.equations import path_along
from linkages.errata.erratum import Amounts, largest_gap, median_and_largest

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


def even_plane() -> Amounts:
    """Equation (17): the normal of the plane O2 O4 O6 is at right angles to O6 O2 and
    O6 O4."""
    x, y, _ = _configurations()
    return median_and_largest(
        _gaps_of_normal(np.cos(x) + 1), _gaps_of_normal(np.cos(y) + 1)
    )


def _gaps_of_normal(factor: np.ndarray) -> np.ndarray:
    """Largest products (k,) of the normal, with ``factor`` in C3, and the sides."""
    x, y, joints = _configurations()
    sx = np.sin(x)
    cx = np.cos(x)
    sy = np.sin(y)
    cy = np.cos(y)
    s = SIN_TWIST
    c = COS_TWIST
    area = LENGTH**2
    mixed = sx * cy + cx * sy * c
    product = cx * cy - sx * sy * c
    first = area * sy * s * (mixed - sy * c + sx)
    second = -area * sy * s * (cx + cy + product + 1)
    third = area * (sy * c * (product + cx) + factor * (mixed + sx))
    normal = np.stack([first, second, third], axis=-1)
    sides = joints[:, [1, 3]]
    products = np.einsum("ki,kji->kj", normal, sides)
    return np.asarray(np.abs(products).max(axis=1))


def distance_of_planes() -> Amounts:
    """Equation (29): the distance of O1 from the plane O2 O4 O6."""
    x, y, _ = _configurations()
    twists = np.full_like(y, TWIST)
    printed = _gaps_of_distance(twists, x)
    return median_and_largest(printed, _gaps_of_distance(y, y))


def _gaps_of_distance(other: np.ndarray, first: np.ndarray) -> np.ndarray:
    """What (29) misses with the angle ``other`` beside theta, and ``first`` under the
    root, where O2, O4, O6 span a plane."""
    x, _, joints = _configurations()
    o1, o2, o4, o6 = (joints[:, i] for i in (0, 1, 3, 5))
    normal = np.cross(o2 - o6, o4 - o6)
    size = np.linalg.norm(normal, axis=1)
    height = np.einsum("ki,ki->k", normal, o1 - o6)
    distance = np.abs(height) / size
    sx = np.sin(x / 2)
    cx = np.cos(x / 2)
    so = np.sin(other / 2)
    co = np.cos(other / 2)
    top = np.abs(LENGTH * sx * so * SIN_TWIST)
    mixed = sx * co + cx * so * COS_TWIST
    single = np.sin(first / 2) * SIN_TWIST
    bottom = np.sqrt(single**2 + mixed**2)
    gaps = np.abs(top / bottom - distance)
    is_plane = size > 1e-3
    return np.asarray(gaps[is_plane])


def _unit(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / np.linalg.norm(vector))


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


def line_of_meetings() -> Amounts:
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
        line = _unit(_meeting(axes[6], axes[4]) - _meeting(axes[1], axes[5]))
        n = _printed_direction(x, y)
        printed.append(largest_gap(n, line))
        corrected.append(largest_gap(_unit(n), line))
    return median_and_largest(printed, corrected)


def _printed_direction(x: float, y: float) -> np.ndarray:
    """The vector n (3,) of (25) at theta = ``x``, phi = ``y``."""
    second = -np.sin(x) / (1 - np.cos(x))
    by_x = (np.cos(x) + 1) / np.sin(x) / np.tan(TWIST)
    by_y = (np.cos(y) + 1) / (np.sin(y) * SIN_TWIST)
    return np.array([1, second, by_x + by_y])
