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

from bifurc._core import Chebyshev

NODE_COUNT = 32  # more than the degree of any piece
# parts of [-1, 1], shorter towards its ends, on which interpolants are judged
CELLS = 192
RHOS = np.array([2.0, 3.0, 4.0, 6.0, 8.0, 12.0])  # ellipses, of which the best counts

_DEGREES = np.arange(NODE_COUNT)
_NODE_ANGLES = np.pi * (_DEGREES[::-1] + 0.5) / NODE_COUNT
_EDGE_ANGLES = np.pi * np.arange(CELLS, -1, -1) / CELLS
NODES = np.cos(_NODE_ANGLES)  # (N,), from -1 to 1
CELL_EDGES = np.cos(_EDGE_ANGLES)  # (CELLS + 1,), from -1 to 1
# (N, N) from values at the nodes to coefficients
_TO_COEFFICIENTS = np.cos(np.outer(_DEGREES, _NODE_ANGLES)) * 2.0 / NODE_COUNT
_TO_COEFFICIENTS[0] /= 2.0
_LONGER_AXES = 0.5 * (RHOS + 1.0 / RHOS)
# (e,) of a bound on the ellipses: how far an interpolant may be off on [-1, 1]
ERRORS = (
    2.0 * _LONGER_AXES / ((_LONGER_AXES - 1.0) * (RHOS**NODE_COUNT - RHOS**-NODE_COUNT))
)
CHEBYSHEV = Chebyshev(
    to_coefficients=_TO_COEFFICIENTS,
    to_edges=np.cos(np.outer(_DEGREES, _EDGE_ANGLES)),
    powers=RHOS ** _DEGREES[:, None],
    errors=ERRORS,
    # how much larger an interpolant may be than at the nodes (Rivlin 1974)
    lebesgue=2.0 / np.pi * np.log(NODE_COUNT) + 1.0,
    # linear interpolation over a cell, by the second derivative in the angle
    bend=(np.pi / CELLS) ** 2 / 8.0,
)
