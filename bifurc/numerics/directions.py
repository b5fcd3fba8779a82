"""Directions in a plane, and angles between planes."""

from __future__ import annotations

import numpy as np


def unit_vectors(angles: np.ndarray) -> np.ndarray:
    """Unit vectors (k, 2) of the plane at angles (k,)."""
    vectors = np.empty((len(angles), 2))
    vectors[:, 0] = np.cos(angles)
    vectors[:, 1] = np.sin(angles)
    return vectors


def cosines_between_planes(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Cosines (..., d), decreasing, of the principal angles between spaces with
    orthonormal bases (..., n, d)."""
    products = np.swapaxes(one, -1, -2) @ other
    cosines: np.ndarray = np.linalg.svd(products, compute_uv=False)
    return cosines
