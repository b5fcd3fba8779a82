"""The bordered matrix [F'; t]: factored once, used for every correction of a piece."""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from bifurc import _core
from bifurc.system import Solver, System, jacobian_at

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array, sparray
    from scipy.sparse.linalg import SuperLU

FEW = 16  # unknowns of a small matrix
RANK = 1e-12  # diagonal entries of R below this share of the largest count as zero
# Largest entry of the border of a sparse matrix, over the median one of the matrix; times
# n^2 of n unknowns, as along a chain pivots fall and the border grows by up to n.
BORDER, GROWN = 1e-3, 10.0
# Share of the largest entry of a column from which on the diagonal one is the pivot: the
# first keeps the factors sparse, the second bounds their growth as far as can be.
PIVOTS = (0.1, 1.0)
DENSE = 10.0  # times the root of n: entries of a row or column that comes last
ACCURATE = 1e-10  # backward error of a solution: rounding leaves 1e-14
ROUNDING = 1e-13  # of entries, over the typical one
# Solutions that are so large come of a matrix that counts as exactly singular: the
# square of what comes out must still be a double.
OVERFLOW = 1e100


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


def bordered_at(problem: System, point: np.ndarray, tangent: np.ndarray) -> Bordered:
    """Solutions of systems with F' of a problem at ``point`` (n,), over the magnitude,
    and the row ``tangent`` (n,) under it."""
    shortcuts = problem.shortcuts
    if shortcuts.bordered_solver is not None:
        solver = shortcuts.bordered_solver(point, tangent)
        if solver is not None:
            return Bordered(shortcuts.m, solver)
    return Bordered.factored(jacobian_at(problem, point) / problem.magnitude, tangent)


def _solver(
    jacobian: np.ndarray | sparray, tangent: np.ndarray, is_square: bool
) -> Solver:
    """How systems with the bordered matrix are solved: by the cheapest factorisation
    that holds."""
    if is_square and not isinstance(jacobian, np.ndarray):
        with suppress(RuntimeError):  # "exactly singular": left to QR
            return SparseBordered(jacobian, tangent[None]).solve
    matrix = bordered_matrix(jacobian, tangent)
    by_lu = _lu_solver(matrix) if is_square else None
    return by_lu or _qr_solver(matrix)


# --- dense ------------------------------------------------------------------------------


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


# --- sparse -----------------------------------------------------------------------------


class SparseBordered:
    """Solutions of systems with the square matrix

        [ J  B ]      J (n - 1, n), sparse, B (n - 1, k)
        [ C  0 ]      C (k + 1, n)

    and with its transpose, by sparse LU.

    A border must not become a pivot early, as it would fill the factors: it is scaled to
    a size far below that of J. A matrix that is exactly singular, as at a crossing whose
    numbers are round, raises `RuntimeError`, unless it ``may_be_singular``: then it, or
    one so nearly singular that solutions overflow, is what rounding may have made of it.
    """

    def __init__(
        self,
        jacobian: sparray,
        rows: np.ndarray,
        columns: np.ndarray | None = None,
        may_be_singular: bool = False,
    ):
        from scipy.sparse import csc_array

        if columns is None:
            columns = np.empty((jacobian.shape[0], 0))
        entries = jacobian.tocoo()
        # not of all entries: those of the parameter may vanish along a whole branch
        largest = np.zeros(jacobian.shape[0])
        np.maximum.at(largest, entries.row, np.abs(entries.data))
        typical = float(np.median(largest)) or 1.0
        border = min(BORDER, GROWN / jacobian.shape[1] ** 2) * typical
        self._below = border / np.abs(rows).max(axis=1)
        self._beside = border / np.abs(columns).max(axis=0)
        (i, j), (k, q) = np.nonzero(rows), np.nonzero(columns)
        m, n = jacobian.shape
        values = [entries.data, (self._below * rows.T).T[i, j]]
        values.append((columns * self._beside)[k, q])
        places = (
            np.concatenate([entries.row, m + i, k]),
            np.concatenate([entries.col, j, n + q]),
        )
        size = n + columns.shape[1]
        matrix = csc_array((np.concatenate(values), places), shape=(size, size))
        if may_be_singular:
            self._factors = factors_by_rounding(matrix, typical)
        else:
            self._factors = sparse_factors(matrix)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x, (n + k,) or (n + k, j), with M x = ``right``."""
        right = _weighted(right, self._below)
        return _weighted(self._factors.solve(right), self._beside)

    def solve_transposed(self, right: np.ndarray) -> np.ndarray:
        """x with M^T x = ``right`` (n + k,)."""
        right = _weighted(right, self._beside)
        return _weighted(self._factors.solve(right, trans="T"), self._below)


def _weighted(vectors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """A copy of vectors, (n,) or (n, j), with their last entries times ``weights``."""
    weighted = vectors.copy()
    if len(weights):
        weighted[-len(weights) :] = (weighted[-len(weights) :].T * weights).T
    return weighted


def factors_by_rounding(matrix: csc_array, typical: float) -> SparseFactors:
    """The factors of a matrix with entries of a ``typical`` size; of one that is exactly
    singular, or so nearly that solutions overflow, those of what rounding may have made
    of it."""
    from scipy.sparse import eye_array

    count = matrix.shape[0]
    with suppress(RuntimeError):
        factors = sparse_factors(matrix)
        solution = typical * factors.solve(np.ones(count))
        if np.abs(solution).max() < OVERFLOW:
            return factors
    shift = ROUNDING * typical * eye_array(count)
    return sparse_factors((matrix + shift).tocsc())


class SparseFactors:
    """Solutions of systems with a sparse matrix and its transpose, by the ``factors`` of
    the matrix with rows and columns in another ``order`` (n,)."""

    def __init__(self, factors: SuperLU, order: np.ndarray):
        self._factors = factors
        self._order = order

    def solve(self, right: np.ndarray, trans: str = "N") -> np.ndarray:
        """x, (n,) or (n, j), with M x = ``right``, or M^T x where ``trans`` is "T"."""
        in_order: np.ndarray = self._factors.solve(right[self._order], trans)
        solution: np.ndarray = np.empty_like(in_order)
        solution[self._order] = in_order
        return solution


def sparse_factors(matrix: csc_array) -> SparseFactors:
    """The LU factors of a square matrix, in an order that keeps them sparse.

    A small diagonal pivot is taken where that saves entries. Along a chain of equations
    the factors may grow by the inverse of it in each of them, until no digit is left: so
    a system is solved, and where its backward error is more than rounding the matrix is
    factored again with the largest pivots. Raises `RuntimeError` for a matrix that is
    exactly singular.
    """
    from scipy.sparse.linalg import splu

    size = float(np.linalg.norm(matrix.data))
    right = np.cos(np.arange(matrix.shape[0]))
    starts, rows = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
    order = _sparse_order(starts.tobytes(), rows.tobytes())
    ordered = matrix[order][:, order]
    for pivot in PIVOTS:
        try:
            factors = splu(ordered, permc_spec="NATURAL", diag_pivot_thresh=pivot)
        except RuntimeError:
            if pivot == PIVOTS[-1]:
                raise
            continue
        by_order = SparseFactors(factors, order)
        solution = by_order.solve(right)
        left = float(np.linalg.norm(matrix @ solution - right))
        if left <= ACCURATE * size * float(np.linalg.norm(solution)):
            break
    return by_order


@lru_cache(maxsize=4)
def _sparse_order(starts: bytes, rows: bytes) -> np.ndarray:
    """An order (n,) of the rows and columns of a square matrix with entries in ``rows``
    (e,) by columns, which begin at ``starts`` (n + 1,), int32 both: by minimum degree of
    A^T + A, but what meets nearly all others comes last. Along a curve many matrices have
    one pattern.

    A border among the others would cost n updates of degrees at each of n steps.
    """
    from scipy.sparse import csc_array

    pointers, indices = np.frombuffer(starts, np.int32), np.frombuffer(rows, np.int32)
    n = len(pointers) - 1
    entries = np.ones(len(indices))
    pattern = csc_array((entries, indices, pointers), shape=(n, n))
    degrees = np.maximum(np.diff(pointers), np.bincount(indices, minlength=n))
    is_dense = degrees > max(FEW, DENSE * np.sqrt(n))
    inner = np.flatnonzero(~is_dense)
    by_degree = _by_minimum_degree(pattern[inner][:, inner])
    order = np.concatenate([inner[by_degree], np.flatnonzero(is_dense)])
    order.setflags(write=False)
    return order


def _by_minimum_degree(pattern: csc_array) -> np.ndarray:
    """The order (n,) of a square pattern by minimum degree of A^T + A. SuperLU gives it
    with factors only: here of a regular matrix, of which next to nothing is kept."""
    from scipy.sparse import csc_array, eye_array
    from scipy.sparse.linalg import spilu

    n = pattern.shape[0]
    if not n:
        return np.empty(0, dtype=int)
    regular = csc_array(pattern + 2.0 * n * eye_array(n))
    order: np.ndarray = spilu(regular, 1.0, 1.0, permc_spec="MMD_AT_PLUS_A").perm_c
    return np.argsort(order)
