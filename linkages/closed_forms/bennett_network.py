"""The network of four Bennett linkages of Song (2013), section 5.4, in closed form.

Joint 0 stands in the middle, with links c, b, d, a to the joints 2, 4, 6, 8; around run
the links 12 = a, 23 = b, 34 = c, 45 = d, 56 = b, 67 = a, 78 = d, 81 = c. The Bennett
linkages are A (0, 2, 1, 8), B (0, 4, 3, 2), C (0, 6, 5, 4), D (0, 8, 7, 6).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkages.loop import Loop

__all__ = ["RING_LINKS", "angle_for", "inner_angle", "ring_angles", "ring_loop"]

RING_LINKS = ("a", "b", "c", "d", "b", "a", "d", "c")
PAIRS = (("a", "c"), ("c", "b"), ("b", "d"), ("d", "a"))  # links of A, B, C, D


def ring_loop(twists: Mapping[str, float], scale: float = 1.0) -> Loop:
    """The loop of the joints 1 to 8, from the twists (rad) of the basic links, each
    ``scale`` times the sine of its twist long."""
    return Loop(
        tuple(scale * float(np.sin(twists[letter])) for letter in RING_LINKS),
        tuple(twists[letter] for letter in RING_LINKS),
        (0.0,) * 8,
        "Bennett network",
    )


def _constant(twists: Mapping[str, float], part: int) -> float:
    """K of the Bennett linkage number ``part``, from 0 for A: m of its two twists."""
    x, y = (twists[letter] for letter in PAIRS[part])
    return float(np.sin((x + y) / 2) / np.sin((x - y) / 2))


def inner_angle(twists: Mapping[str, float], part: int, odd: float) -> float:
    """The angle v (rad) of the Bennett linkage number ``part`` at joint 0, from that at
    its odd joint: v = 2 atan(K / tan(p/2))."""
    k = _constant(twists, part)
    return float(2 * np.arctan2(k * np.cos(odd / 2), np.sin(odd / 2)))


def angle_for(twists: Mapping[str, float], part: int, inner: float) -> float:
    """The angle (rad) at the odd joint of a Bennett linkage, from that at joint 0."""
    k = _constant(twists, part)
    return float(2 * np.arctan2(k * np.cos(inner / 2), np.sin(inner / 2)))


def ring_angles(
    twists: Mapping[str, float], first: float, third: float, fifth: float
) -> np.ndarray:
    """The angles (8,), rad, of the joints 1 to 8 from those of the joints 1, 3 and 5.

    Each Bennett linkage turns by itself. The odd angles sum up to nothing, and every
    even one is pi less the v of the linkage before it and plus that of the next: a lock
    at an odd joint holds one v, a lock at an even one the difference of two neighbours.
    """
    odd = np.array([first, third, fifth, -(first + third + fifth)])
    inner = np.array([inner_angle(twists, i, angle) for i, angle in enumerate(odd)])
    out = np.empty(8)
    out[0::2] = odd
    out[1::2] = np.pi - inner + np.roll(inner, -1)
    return out
