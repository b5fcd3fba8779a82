"""Wohlhart's symmetric mechanism as a translator: two parallel planes of joints, their
distance, and the strokes.

Joint centres O1 to O6, links of length a, twists alpha and -alpha in turn, odd angles
theta and even ones phi. The input-output equation (15) of Racila and Dahan (2010) is a
square: it says that

    cos(theta/2) cos(phi/2) - cos(alpha) sin(theta/2) sin(phi/2) = 1/2 or -1/2,

the cosine law of a spherical triangle with sides theta/2 and phi/2 and a third side of
60 or 120 degrees. With half the sum and half the difference of the angles it is linear
in two cosines, from which every stroke follows; and the root in their equation (29),
once corrected, is always sqrt(3)/2.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from linkages.families.wohlhart import wohlhart_symmetric
from linkages.values import GeometryError

THIRD = np.pi / 3


class Stroke(StrEnum):
    """One of the two ways from the flat configuration theta = 0 to the next flat one."""

    # The way on which the planes stay closer.
    SHORT = "short"
    # The way on which they move further apart.
    LONG = "long"


class StrokeAngles(NamedTuple):
    """The odd angles theta (k,) and the even ones phi (k,), rad, along a stroke."""

    theta: np.ndarray
    phi: np.ndarray


def stroke_angles(alpha: float, stroke: Stroke, count: int = 181) -> StrokeAngles:
    """``count`` configurations along a stroke of the mechanism with twist ``alpha``
    (rad).

    Both strokes start at theta = 0. The short one ends at theta = 120 degrees and phi =
    0; the long one too for alpha up to 120 degrees, and at theta = 240 and phi = 360
    degrees beyond. Raises `GeometryError` for a twist that is not between 0 and pi.
    """
    if not 0 < alpha < np.pi:
        raise GeometryError("twist alpha", alpha, "between 0 and pi")
    if alpha < np.pi / 2:  # the mirror image: phi changes its sign
        theta, phi = stroke_angles(np.pi - alpha, stroke, count)
        return StrokeAngles(theta, -phi)
    c = np.cos(alpha)
    if stroke is Stroke.SHORT:
        half_sum = np.linspace(-THIRD, THIRD, count)
        half_gap = _arc_cosine((1 - (1 + c) * np.cos(half_sum)) / (1 - c))
    elif alpha <= 2 * THIRD:
        half_gap = np.linspace(-THIRD, THIRD, count)
        half_sum = _arc_cosine((1 - (1 - c) * np.cos(half_gap)) / (1 + c))
    else:
        half_sum = np.linspace(THIRD, 5 * THIRD, count)
        half_gap = -_arc_cosine((1 - (1 + c) * np.cos(half_sum)) / (1 - c))
    return StrokeAngles(half_sum + half_gap, half_sum - half_gap)


def _arc_cosine(cosine: np.ndarray) -> np.ndarray:
    """The angle (k,), 0 to pi, of a cosine that rounding may have taken beyond 1."""
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def contact_angle(alpha: float) -> float | None:
    """The angle theta (rad) on the long stroke at which O2, O4 and O6 coincide, so that
    thin links touch; None for twists between 60 and 120 degrees, where they never
    do."""
    if THIRD < alpha < 2 * THIRD:
        return None
    sine = 0.5 / abs(float(np.cos(alpha)))
    return float(2 * np.arcsin(min(sine, 1.0)))


def plane_distance(
    theta: np.ndarray, phi: np.ndarray, alpha: float, a: float = 1.0
) -> np.ndarray:
    """Distance H (k,) of the planes O1 O3 O5 and O2 O4 O6, in the unit of ``a``.

    Equation (29), corrected, with its root, which is constant along the motion.
    """
    product = np.sin(theta / 2) * np.sin(phi / 2) * np.sin(alpha)
    return np.asarray(2 * a / np.sqrt(3) * np.abs(product))


def slide(theta: np.ndarray, a: float = 1.0) -> np.ndarray:
    """How far b (k,) the joints O1, O3, O5 have slid towards their centre, equation
    (28), in the unit of ``a``."""
    return np.asarray(2 * a / np.sqrt(3) * (1 - np.cos(theta / 2)))


def _frames(theta: np.ndarray, phi: np.ndarray, alpha: float, a: float) -> np.ndarray:
    """Frames (k, 6, 4, 4) of the joints O1 to O6 in the frame of the paper."""
    frames = wohlhart_symmetric(a, alpha).frames(np.stack([theta, phi] * 3, axis=-1))
    return np.asarray(frames[..., 1:, :, :])


def joint_centres(
    theta: np.ndarray, phi: np.ndarray, alpha: float, a: float = 1.0
) -> np.ndarray:
    """Joint centres O1 to O6 (k, 6, 3) in the frame of the paper: O6 in the origin, O5
    at (-a, 0, 0)."""
    return _frames(theta, phi, alpha, a)[..., :3, 3]


def joint_axes(
    theta: np.ndarray, phi: np.ndarray, alpha: float, a: float = 1.0
) -> np.ndarray:
    """Unit directions (k, 6, 3) of the axes through O1 to O6, in the same frame."""
    return _frames(theta, phi, alpha, a)[..., :3, 2]


def meeting_points(
    theta: np.ndarray, phi: np.ndarray, alpha: float, a: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Where the even axes meet, O' (k, 3), and where the odd axes meet, O'' (k, 3): the
    equations (22) and (23). Infinite where phi or theta is 0."""
    even_height = a * (np.cos(phi) + 1) / (np.sin(phi) * np.sin(alpha))
    zero = np.zeros_like(even_height)
    even = np.stack([zero, zero, even_height], axis=-1)
    across = a * np.sin(theta) / (1 - np.cos(theta))
    height = -a * (np.cos(theta) + 1) / (np.sin(theta) * np.tan(alpha))
    odd = np.stack([zero - a, across, height], axis=-1)
    return even, odd


def upright(points: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Points (m, 3) in the new disposition: the plane O1 O3 O5 of ``centres`` (6, 3)
    level, its middle in the origin, O1 on the x axis, O2, O4, O6 above."""
    odd = centres[[0, 2, 4]]
    middle = odd.mean(axis=0)
    x = odd[0] - middle
    x = x / np.linalg.norm(x)
    normal = np.cross(odd[1] - odd[0], odd[2] - odd[0])
    normal = normal / np.linalg.norm(normal)
    if normal @ (centres[[1, 3, 5]].mean(axis=0) - middle) < 0:
        normal = -normal
    axes = np.stack([x, np.cross(normal, x), normal])
    return np.asarray((points - middle) @ axes.T)
