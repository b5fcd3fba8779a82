"""Evaluation of a piecewise polynomial curve, and the feet of points on it.

What takes one piece is plain Python, what takes a whole curve is compiled. A ``curve``
is (breaks (k + 1,), centers (k,), radii (k,), pieces (k, order + 1, n), travel (n,)) as
in `bifurc.branch.Branch`; travel is what a closed curve gains in one turn, and empty
for an open one. All arrays are contiguous: another memory layout would be compiled
anew.
"""

# numba infers the types of compiled functions
# mypy: allow-untyped-defs, allow-untyped-calls
from __future__ import annotations

import numpy as np
from numba import njit
from numba.extending import register_jitable

__all__ = ["evaluate", "feet", "point_and_slope", "points_on_piece"]


def points_on_piece(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (k, n) of one piece (order + 1, n) at coordinates x (k,) in [-1, 1]."""
    points: np.ndarray = np.vander(x, len(piece), increasing=True) @ piece
    return points


def point_and_slope(piece: np.ndarray, x: float) -> tuple[np.ndarray, np.ndarray]:
    """Point (n,) of one piece (order + 1, n) and its derivative (n,) in the coordinate
    at ``x``."""
    order = len(piece) - 1
    powers = x ** np.arange(order + 1)
    slope = (np.arange(1, order + 1) * powers[:-1]) @ piece[1:]
    return powers @ piece, slope


@register_jitable
def _piece_at(curve, s):
    """Number of turns before arclength ``s``, the piece that holds it, and the
    coordinate on that piece."""
    breaks, centers, radii, _, travel = curve
    turns = np.floor(s / breaks[-1]) if len(travel) else 0.0
    local = s - turns * breaks[-1]
    low, high = 0, len(radii) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if breaks[middle] <= local:
            low = middle
        else:
            high = middle - 1
    return turns, low, (local - centers[low]) / radii[low]


@register_jitable
def _value_and_slope(curve, s, value, slope):
    """Fill u(s) and du/ds, both (n,)."""
    _, _, radii, pieces, travel = curve
    turns, i, x = _piece_at(curve, s)
    order = pieces.shape[1] - 1
    for j in range(len(value)):
        total, rate = pieces[i, order, j], 0.0
        for k in range(order - 1, -1, -1):
            rate = rate * x + total
            total = total * x + pieces[i, k, j]
        value[j], slope[j] = total, rate / radii[i]
        if len(travel):
            value[j] += turns * travel[j]


@njit(cache=True, nogil=True, error_model="numpy")
def evaluate(curve, s, derivative):
    """u(s), or its derivative of the given order in s, (k, n) at arclengths (k,)."""
    _, _, radii, pieces, travel = curve
    order, n = pieces.shape[1] - 1, pieces.shape[2]
    factor = np.ones(order + 1)
    for j in range(derivative):
        for k in range(order + 1):
            factor[k] *= max(k - j, 0)
    out = np.zeros((len(s), n))
    for row in range(len(s)):
        turns, i, x = _piece_at(curve, s[row])
        for k in range(order, derivative - 1, -1):
            for j in range(n):
                out[row, j] = out[row, j] * x + factor[k] * pieces[i, k, j]
        scale = radii[i] ** derivative
        for j in range(n):
            out[row, j] /= scale
            if derivative == 0 and len(travel):
                out[row, j] += turns * travel[j]
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def feet(curve, points, s, reach, periods, iterations):
    """Arclengths (k,) near ``s`` (k,) where the curve is nearest to points (k, n), and
    the distances (k,) there.

    Newton's method with steps of at most ``reach``, distances taken modulo the
    ``periods`` (n,).
    """
    breaks, travel = curve[0], curve[4]
    k, n = points.shape
    at, distances = s.copy(), np.empty(k)
    value, slope = np.empty(n), np.empty(n)
    for row in range(k):
        for iteration in range(iterations + 1):
            _value_and_slope(curve, at[row], value, slope)
            along, speed, distance = 0.0, 0.0, 0.0
            for j in range(n):
                gap = value[j] - points[row, j]
                if np.isfinite(periods[j]):
                    gap -= periods[j] * np.round(gap / periods[j])
                along += gap * slope[j]
                speed += slope[j] * slope[j]
                distance += gap * gap
            distances[row] = np.sqrt(distance)
            if iteration == iterations:
                break
            at[row] -= min(max(along / speed, -reach), reach)
            if len(travel):
                at[row] %= breaks[-1]
            else:
                at[row] = min(max(at[row], 0.0), breaks[-1])
    return at, distances
