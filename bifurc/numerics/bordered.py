"""The bordered matrix [F'; t]: factored once, used for every correction of a piece."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bifurc import _core
from bifurc.numerics.sparse_factors import sparse_factors
from bifurc.problem import Problem, Solver

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array, sparray

FEW = 16  # unknowns of a small matrix
RANK = 1e-12  # diagonal entries of R below this share of the largest count as zero
# largest entry of the border of a sparse matrix, over the median one of the matrix
BORDER = 1e-3


def as_dense(matrix: np.ndarray | sparray) -> np.ndarray:
    """A dense or sparse matrix as an array."""
    dense = matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
    return np.asarray(dense, dtype=float)


def bordered_matrix(jacobian: np.ndarray | sparray, border: np.ndarray) -> np.ndarray:
    """The dense matrix (m + 1, n) of F' (m, n) and the row ``border`` (n,) under it."""
    m, n = jacobian.shape
    matrix = np.empty((m + 1, n))
    matrix[:-1] = as_dense(jacobian)
    matrix[-1] = border
    return matrix


class Bordered:
    """Solutions of systems with the matrix

        [ F' ]   (m, n), dense or sparse
        [ t  ]   (n,)

    by a ``solver`` that is at hand, or by the cheapest factorisation that holds.
    """

    def __init__(self, rows: int, solver: Solver):
        self._rows = rows
        self._solve = solver

    @staticmethod
    def factored(jacobian: np.ndarray | sparray, tangent: np.ndarray) -> Bordered:
        """Sparse with m = n - 1 by sparse LU, dense with m = n - 1 by LU, otherwise by
        QR with column pivoting, which solves in the least-squares sense whatever the
        number of redundant equations and leaves out what has no rank."""
        m, n = jacobian.shape
        return Bordered(m, _solver(jacobian, tangent, is_square=m == n - 1))

    def solve(self, residual: np.ndarray, along: float = 0.0) -> np.ndarray:
        """d (n,) with F' d = ``residual`` (m,) and t . d = ``along``, in the
        least-squares sense."""
        right = np.empty(self._rows + 1)
        right[:-1] = residual
        right[-1] = along
        return self._solve(right)

    def null_vector(self) -> np.ndarray:
        """Unit vector (n,) along d with F' d = 0 and t . d > 0."""
        vector = self.solve(np.zeros(self._rows), 1.0)
        unit: np.ndarray = vector / np.linalg.norm(vector)
        return unit


def bordered_at(problem: Problem, point: np.ndarray, tangent: np.ndarray) -> Bordered:
    """Solutions of systems with F' of a problem at ``point`` (n,), over the magnitude,
    and the row ``tangent`` (n,) under it."""
    solver = problem.bordered_solver(point, tangent)
    if solver is not None:
        return Bordered(problem.equation_count, solver)
    return Bordered.factored(problem.jacobian(point) / problem.magnitude, tangent)


def _solver(
    jacobian: np.ndarray | sparray, tangent: np.ndarray, is_square: bool
) -> Solver:
    """How systems with the bordered matrix are solved: by the cheapest factorisation
    that holds."""
    if is_square and not isinstance(jacobian, np.ndarray):
        with suppress(RuntimeError):  # "exactly singular": left to QR
            return sparse_bordered(jacobian, tangent)
    matrix = bordered_matrix(jacobian, tangent)
    by_lu = _lu_solver(matrix) if is_square else None
    return by_lu or _qr_solver(matrix)


def sparse_bordered(jacobian: np.ndarray | sparray, tangent: np.ndarray) -> Solver:
    """The function that solves [F'; t] x = right, (n,) or (n, k), for a sparse F' (n -
    1, n), by sparse LU.

    The border must not become a pivot early, as it would fill the factors: t is scaled
    to a size far below that of F'. Raises `RuntimeError` for a matrix that is exactly
    singular.
    """
    from scipy.sparse import csc_array

    matrix = csc_array(jacobian)
    typical = float(np.median(np.abs(matrix.data))) or 1.0
    weight = BORDER * typical / np.abs(tangent).max()
    stacked = _with_last_row(matrix, weight * tangent)
    factors = sparse_factors(stacked)

    def solve(right: np.ndarray) -> np.ndarray:
        right = right.copy()
        right[-1] *= weight
        solution: np.ndarray = factors.solve(right)
        return solution

    return solve


def _with_last_row(matrix: csc_array, row: np.ndarray) -> csc_array:
    """The matrix (m + 1, n) of a sparse one (m, n) and a dense row (n,) under it: one
    entry more at the end of every column."""
    from scipy.sparse import csc_array

    m, n = matrix.shape
    ends = matrix.indptr[1:]
    entries = np.insert(matrix.data, ends, row)
    rows = np.insert(matrix.indices, ends, m)
    starts = matrix.indptr + np.arange(n + 1, dtype=matrix.indptr.dtype)
    return csc_array((entries, rows, starts), shape=(m + 1, n))


def _lu_solver(matrix: np.ndarray) -> Solver | None:
    """The solver of a square system by LU; None where the matrix is singular.

    LAPACK is called directly: SciPy's wrappers cost more than a small system.
    """
    from scipy.linalg import lapack

    factors, order, _ = lapack.dgetrf(matrix)
    pivots = np.abs(np.diag(factors))
    is_regular = pivots.min() > RANK * pivots.max()
    if not is_regular:
        return None

    def solve(right: np.ndarray) -> np.ndarray:
        solution: np.ndarray
        solution, _ = lapack.dgetrs(factors, order, right)
        return solution

    return solve


def _qr_solver(matrix: np.ndarray) -> Solver:
    """The solver of a system in the least-squares sense, by QR with column pivoting.

    A small matrix is factored anew for every right-hand side, in compiled code: that
    takes less time than one call of SciPy.
    """
    if matrix.shape[1] <= FEW:
        return partial(_core.solve_by_rank, matrix)
    from scipy.linalg import qr, solve_triangular

    q, r, order = qr(matrix, mode="economic", pivoting=True, check_finite=False)
    diagonal = np.abs(np.diag(r))
    rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))
    triangle = r[:rank, :rank]
    range_space = q[:, :rank].T
    independent = order[:rank]

    def solve(right: np.ndarray) -> np.ndarray:
        solution = np.zeros(matrix.shape[1])
        solution[independent] = solve_triangular(
            triangle, range_space @ right, check_finite=False
        )
        return solution

    return solve
