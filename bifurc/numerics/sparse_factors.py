"""Sparse LU that keeps its factors sparse, and is accurate all the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import SuperLU

# Share of the largest entry of a column from which on the diagonal one is the pivot: the
# first keeps the factors sparse, the second bounds their growth as far as can be.
PIVOTS = (0.1, 1.0)
ACCURATE = 1e-10  # backward error of a solution: rounding leaves 1e-14


def sparse_factors(matrix: csc_array) -> SuperLU:
    """The LU factors of a square matrix, columns ordered by minimum degree of A^T + A.

    A small diagonal pivot is taken where that saves entries. Along a chain of equations
    the factors may grow by the inverse of it in each of them, until no digit is left: so
    a system is solved, and where its backward error is more than rounding the matrix is
    factored again with the largest pivots. Raises `RuntimeError` for a matrix that is
    exactly singular.
    """
    from scipy.sparse.linalg import splu

    size = float(np.linalg.norm(matrix.data))
    right = np.cos(np.arange(matrix.shape[0]))
    for pivot in PIVOTS:
        try:
            factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=pivot)
        except RuntimeError:
            if pivot == PIVOTS[-1]:
                raise
            continue
        solution = factors.solve(right)
        left = float(np.linalg.norm(matrix @ solution - right))
        if left <= ACCURATE * size * float(np.linalg.norm(solution)):
            break
    return factors
