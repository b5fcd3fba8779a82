"""Distances of straight segments, many at a time."""

from __future__ import annotations

import numpy as np

TINY = 1e-300  # a square of a length that is none


def distances_by_ends(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distances (...) of segments (..., 2, 3), each given by its two ends."""
    return segment_distances(
        first[..., 0, :], first[..., 1, :], second[..., 0, :], second[..., 1, :]
    )


def segment_distances(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> np.ndarray:
    """Distances (...) of the segments from a to b and from c to d, each (..., 3); a
    segment may be a point.

    Ericson 2005, Real-Time Collision Detection, section 5.1.9: the nearest point of the
    first line, kept on the segment; the nearest to that of the second; and back, which
    also serves parallel segments, for which any point will do at first.
    """
    along, other, gap = b - a, d - c, a - c
    square, other_square = _dot(along, along), np.maximum(_dot(other, other), TINY)
    product = _dot(along, other)
    gap_along, gap_other = _dot(gap, along), _dot(gap, other)
    # divided early: fourth powers of lengths leave the range of doubles
    slope = product / other_square
    fraction = _share(slope * gap_other - gap_along, square - slope * product)
    other_fraction = _share(product * fraction + gap_other, other_square)
    fraction = _share(product * other_fraction - gap_along, square)
    between = gap + fraction[..., None] * along - other_fraction[..., None] * other
    distances: np.ndarray = np.sqrt(_dot(between, between))
    return distances


def _dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The products (...) of vectors (..., 3)."""
    products: np.ndarray = np.einsum("...i,...i", first, second)
    return products


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """The fractions (...), between 0 and 1, that parts are of a whole."""
    positive = np.maximum(whole, TINY)
    shares: np.ndarray = np.clip(part, 0.0, positive) / positive
    return shares
