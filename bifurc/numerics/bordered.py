"""The bordered matrix [F'; t]: factored once, used for every correction of a piece."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import lapack, qr, solve_triangular
from scipy.sparse import csc_array, issparse, vstack
from scipy.sparse.linalg import splu

__all__ = ["Bordered", "as_dense", "sparse_bordered"]

RANK = 1e-12  # diagonal entries of R below this share of the largest count as zero
# largest entry of the border of a sparse matrix, over the median one of the matrix
BORDER = 1e-3


def as_dense(matrix: Any) -> np.ndarray:
    """A dense or sparse matrix as an array."""
    return np.asarray(matrix.toarray() if issparse(matrix) else matrix, dtype=float)


def sparse_bordered(
    jacobian: Any, tangent: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """The function that solves [F'; t] x = right, (n,) or (n, k), for a sparse F' (n -
    1, n), by sparse LU.

    The border must not become a pivot early, as it would fill the factors: t is scaled
    to a size far below that of F', columns are ordered by minimum degree of A^T + A,
    and a diagonal entry will do as a pivot from a tenth of the largest.
    """
    matrix = csc_array(jacobian)
    weight = (
        BORDER * (float(np.median(np.abs(matrix.data))) or 1.0) / np.abs(tangent).max()
    )
    stacked: Any = vstack([matrix, csc_array(weight * tangent[None])])
    factors = splu(
        csc_array(stacked), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.1
    )

    def solve(right: np.ndarray) -> np.ndarray:
        right = right.copy()
        right[-1] *= weight
        return factors.solve(right)

    return solve


class Bordered:
    """Factorisation of

        [ F' ]   (m, n), dense or sparse
        [ t  ]   (n,)

    Sparse with m = n - 1 by sparse LU, dense with m = n - 1 by LU, otherwise by QR with
    column pivoting, which solves in the least-squares sense whatever the number of
    redundant equations and leaves out what has no rank.
    """

    def __init__(self, jacobian: Any, tangent: np.ndarray):
        m, n = jacobian.shape
        self._rows = m
        self._solve: Callable[[np.ndarray], np.ndarray]
        if issparse(jacobian) and m == n - 1:
            self._solve = sparse_bordered(jacobian, tangent)
            return
        matrix = np.empty((m + 1, n))
        matrix[:-1], matrix[-1] = as_dense(jacobian), tangent
        if m == n - 1:
            factors, order, _ = lapack.dgetrf(
                matrix
            )  # the wrappers of SciPy cost more than a small system
            pivots = np.abs(np.diag(factors))
            if pivots.min() > RANK * pivots.max():
                self._solve = lambda right: lapack.dgetrs(factors, order, right)[0]
                return
        q, r, order = qr(matrix, mode="economic", pivoting=True, check_finite=False)
        diagonal = np.abs(np.diag(r))
        rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))

        def solve(right: np.ndarray) -> np.ndarray:
            out = np.zeros(n)
            out[order[:rank]] = solve_triangular(
                r[:rank, :rank], q[:, :rank].T @ right, check_finite=False
            )
            return out

        self._solve = solve

    def solve(self, residual: np.ndarray, along: float = 0.0) -> np.ndarray:
        """d (n,) with F' d = ``residual`` (m,) and t . d = ``along``, in the
        least-squares sense."""
        right = np.empty(self._rows + 1)
        right[:-1], right[-1] = residual, along
        return self._solve(right)

    def null_vector(self) -> np.ndarray:
        """Unit vector (n,) along d with F' d = 0 and t . d > 0."""
        vector = self.solve(np.zeros(self._rows), 1.0)
        return vector / np.linalg.norm(vector)
