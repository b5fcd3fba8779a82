"""Interpolation at Chebyshev nodes, with a bound on what it leaves out between them.

What is interpolated is analytic. With the nodes those of T_N, of which the largest is
not 1, an analytic f minus its interpolant of degree N - 1 is

    (1 / 2 pi i) * integral of T_N(x) / T_N(z) f(z) / (z - x) dz    (Hermite's formula)

round an ellipse about [-1, 1]. With rho the sum of its half-axes, a the longer one and
M a bound on |f| there, that is at most 2 a M / ((a - 1) (rho^N - rho^-N)), as |T_N| is
at least (rho^N - rho^-N) / 2 on the ellipse, 2 pi a bounds its length, and a - 1 is its
distance from the interval (Trefethen 2013, chapter 8).
"""

from __future__ import annotations

import numpy as np

__all__ = [
    "CELLS",
    "CELL_EDGES",
    "ERRORS",
    "NODES",
    "NODE_COUNT",
    "TO_COEFFICIENTS",
    "cell_slack",
    "coefficients",
    "largest_between",
    "largest_by_norms",
    "on_cell_edges",
    "on_ellipses",
]

NODE_COUNT = 32  # more than the degree of any piece
# parts of [-1, 1], shorter towards its ends, on which interpolants are judged
CELLS = 192
RHOS = np.array([2.0, 3.0, 4.0, 6.0, 8.0, 12.0])  # ellipses, of which the best counts

_DEGREES = np.arange(NODE_COUNT)
_NODE_ANGLES = np.pi * (_DEGREES[::-1] + 0.5) / NODE_COUNT
_EDGE_ANGLES = np.pi * np.arange(CELLS, -1, -1) / CELLS
NODES = np.cos(_NODE_ANGLES)  # (N,), from -1 to 1
CELL_EDGES = np.cos(_EDGE_ANGLES)  # (CELLS + 1,), from -1 to 1
_TO_EDGES = np.cos(np.outer(_DEGREES, _EDGE_ANGLES))
# (N, N) from values at the nodes to coefficients
TO_COEFFICIENTS = np.cos(np.outer(_DEGREES, _NODE_ANGLES)) * 2.0 / NODE_COUNT
TO_COEFFICIENTS[0] /= 2.0
# how much larger an interpolant may be than at the nodes (Rivlin 1974)
_LEBESGUE = 2.0 / np.pi * np.log(NODE_COUNT) + 1.0
_POWERS = RHOS ** _DEGREES[:, None]
_LONGER_AXES = 0.5 * (RHOS + 1.0 / RHOS)
# (e,) of a bound on the ellipses: how far an interpolant may be off on [-1, 1]
ERRORS = (
    2.0 * _LONGER_AXES / ((_LONGER_AXES - 1.0) * (RHOS**NODE_COUNT - RHOS**-NODE_COUNT))
)


def coefficients(values: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (k, N, q) of the interpolants of values (k, N, q) at the
    nodes."""
    interpolants: np.ndarray = TO_COEFFICIENTS @ values
    return interpolants


def on_ellipses(sizes: np.ndarray) -> np.ndarray:
    """Bounds (k, e) on each ellipse of sums whose coefficients have ``sizes`` (k, j),
    the first j of N."""
    bounds: np.ndarray = sizes @ _POWERS[: sizes.shape[1]]
    return bounds


def on_cell_edges(interpolants: np.ndarray) -> np.ndarray:
    """Values (k, CELLS + 1) of interpolants with coefficients (k, N)."""
    values: np.ndarray = interpolants @ _TO_EDGES
    return values


def cell_slack(interpolants: np.ndarray) -> np.ndarray:
    """How far (k,) an interpolant with coefficients (k, N) may be, within a cell, from
    the line between its values at the edges, as a function of the angle."""
    largest_second_derivative = np.abs(interpolants) @ _DEGREES**2
    slack: np.ndarray = (np.pi / CELLS) ** 2 / 8.0 * largest_second_derivative
    return slack


def largest_between(values: np.ndarray) -> np.ndarray:
    """Bounds (k,) on the norm over [-1, 1] of the interpolants of values (k, N, q)."""
    at_nodes = np.linalg.norm(values, axis=2)
    in_coefficients = np.linalg.norm(coefficients(values), axis=2)
    return largest_by_norms(at_nodes, in_coefficients)


def largest_by_norms(at_nodes: np.ndarray, in_coefficients: np.ndarray) -> np.ndarray:
    """The same bounds (k,) from the norms (k, N) of the values at the nodes and of the
    coefficients: by the largest of those, or by the sum of these."""
    by_nodes = _LEBESGUE * at_nodes.max(axis=1)
    by_sum = in_coefficients.sum(axis=1)
    bounds: np.ndarray = np.minimum(by_nodes, by_sum)
    return bounds
