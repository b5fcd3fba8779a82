"""Which of the equations are solved: those whose derivative has the smallest inverse."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from flint import arb_mat


def floats_of(matrix: arb_mat) -> np.ndarray:
    """The middles of a matrix of balls."""
    return np.array([[float(x.mid()) for x in row] for row in matrix.tolist()])


def best_rows(
    jacobian: np.ndarray,
    others: np.ndarray,
    present: Sequence[int] = (),
    gain: float = 1.0,
) -> list[int]:
    """Rows (r,) of a matrix (6, n) that make with ``others`` (n - r, n) the square matrix
    with the smallest inverse; those ``present`` unless another choice is better by the
    factor ``gain``."""
    count = jacobian.shape[1] - len(others)
    sizes = {}
    for rows in combinations(range(len(jacobian)), count):
        sizes[rows] = _size_of_inverse(np.vstack([jacobian[list(rows)], others]), count)
    best = min(sizes, key=lambda rows: sizes[rows])
    if tuple(present) in sizes and sizes[tuple(present)] < gain * sizes[best]:
        return list(present)
    return list(best)


def _size_of_inverse(matrix: np.ndarray, count: int) -> float:
    """The norm of the columns of the inverse that belong to the first rows."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.inf
    return float(np.abs(inverse[:, :count]).sum(axis=1).max())
