"""One piece of a curve, a polynomial in a coordinate from -1 to 1."""

from __future__ import annotations

import numpy as np


def points_on_piece(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (k, n) of one piece (order + 1, n) at coordinates x (k,) in [-1, 1]."""
    points: np.ndarray = np.vander(x, len(piece), increasing=True) @ piece
    return points


def points_on_pieces(pieces: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (p, k, n) of pieces (p, order + 1, n) at coordinates x (p, k), k of
    each."""
    powers = np.vander(x.ravel(), pieces.shape[1], increasing=True)
    points: np.ndarray = powers.reshape(*x.shape, -1) @ pieces
    return points


def point_and_slope(piece: np.ndarray, x: float) -> tuple[np.ndarray, np.ndarray]:
    """Point (n,) of one piece (order + 1, n) and its derivative (n,) in the coordinate
    at ``x``."""
    order = len(piece) - 1
    powers = x ** np.arange(order + 1)
    slope = (np.arange(1, order + 1) * powers[:-1]) @ piece[1:]
    return powers @ piece, slope
