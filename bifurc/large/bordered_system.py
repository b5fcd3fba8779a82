"""Systems with a sparse matrix that is bordered by a few columns and rows:

    [ J  B ]      J (n - 1, n), B (n - 1, k)
    [ C  0 ]      C (k + 1, n)

With the parameter's column b of J = [A b] it is A with 1 + k columns and as many rows
around it. By sparse LU of the whole; or, with a solver for A, by GMRES, preconditioned
by block elimination with that solver. So the solver may be approximate, and a nearly
singular A, as at every fold, costs iterations and no digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from bifurc.errors import ProblemError
from bifurc.numerics.sparse_factors import sparse_factors

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array, csr_array
    from scipy.sparse.linalg import SuperLU

# largest entry of the borders of a factored matrix, over the median one of the matrix
BORDER = 1e-3
# What is left of a system by GMRES, in the unit of solutions and as a share of this one:
# where points are located, and for a step of Newton's method on the way.
EXACT, ROUGH = 1e-10, 1e-5
UNSOLVED = 1e-3  # the same: from here on a system is not solved
ROUNDING = 1e-13  # of entries, over the typical one
# Solutions that are so large come of a matrix that counts as exactly singular: the
# square of what comes out must still be a double.
OVERFLOW = 1e100
KRYLOV_DIMENSION, CYCLES = 40, 6

Map: TypeAlias = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Inverse:
    """Maps right-hand sides (n - 1,) to solutions, or near them, with A and with its
    transpose."""

    solve: Map
    solve_transposed: Map


class BorderedSystem(Protocol):
    """Solutions (n + k,) of the bordered system and of its transpose."""

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x with M x = ``right`` (n + k,)."""
        ...

    def solve_transposed(self, right: np.ndarray) -> np.ndarray:
        """x with M^T x = ``right`` (n + k,)."""
        ...


def bordered_system(
    jacobian: csr_array,
    rows: np.ndarray,
    columns: np.ndarray | None = None,
    inverse: Inverse | None = None,
    accuracy: float = EXACT,
) -> BorderedSystem:
    """The system with ``jacobian`` (n - 1, n), ``rows`` (k + 1, n) under it and
    ``columns`` (n - 1, k) beside it; by the ``inverse`` of A where there is one, to an
    ``accuracy``.

    A system that GMRES does not solve raises `ProblemError`, unless the accuracy is no
    better than `ROUGH`: Newton's method then goes on with what there is.
    """
    if columns is None:
        columns = np.empty((jacobian.shape[0], 0))
    if inverse is None:
        return _Factored(jacobian, rows, columns)
    return _Iterated(jacobian, rows, columns, inverse, accuracy)


# --- by sparse LU ---------------------------------------------------------------------


class _Factored:
    """The bordered matrix by sparse LU.

    A border must not become a pivot early, as it would fill the factors: it is scaled to
    a size far below that of J.
    """

    def __init__(self, jacobian: csr_array, rows: np.ndarray, columns: np.ndarray):
        from scipy.sparse import csr_array, hstack, vstack

        k = columns.shape[1]
        # not of all entries: those of the parameter may vanish along a whole branch
        largest = abs(jacobian).max(axis=1).toarray()
        typical = float(np.median(largest)) or 1.0
        self._below = _border_weights(rows, typical, axis=1)
        self._beside = _border_weights(columns, typical, axis=0)
        under = csr_array(self._below[:, None] * rows)
        above = hstack([jacobian, csr_array(columns * self._beside)])
        below = hstack([under, csr_array((k + 1, k))])
        matrix = vstack([above, below]).tocsc()
        self._factors = _factors_of(matrix, typical)

    def solve(self, right: np.ndarray) -> np.ndarray:
        right = self._weighted(right, self._below)
        return self._weighted(self._factors.solve(right), self._beside)

    def solve_transposed(self, right: np.ndarray) -> np.ndarray:
        right = self._weighted(right, self._beside)
        return self._weighted(self._factors.solve(right, trans="T"), self._below)

    @staticmethod
    def _weighted(vector: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """A copy of a vector with its last entries times ``weights``."""
        weighted = vector.copy()
        if len(weights):
            weighted[-len(weights) :] *= weights
        return weighted


def _factors_of(matrix: csc_array, typical: float) -> SuperLU:
    """The factors of a matrix; of one that is exactly singular, as at a crossing whose
    numbers are round, or so nearly that solutions overflow, those of what rounding may
    have made of it."""
    from scipy.sparse import eye_array

    count = matrix.shape[0]
    try:
        factors = sparse_factors(matrix)
    except RuntimeError:
        factors = None
    if factors is not None:
        solution = typical * factors.solve(np.ones(count))
        if np.abs(solution).max() < OVERFLOW:
            return factors
    shift = ROUNDING * typical * eye_array(count)
    return sparse_factors((matrix + shift).tocsc())


def _border_weights(border: np.ndarray, typical: float, axis: int) -> np.ndarray:
    """Factors that bring the largest entry of each row or column of a border to a small
    share of the typical entry of the matrix."""
    weights: np.ndarray = BORDER * typical / np.abs(border).max(axis=axis)
    return weights


# --- by a solver and GMRES ------------------------------------------------------------


class _Iterated:
    """The bordered matrix by GMRES with block elimination as preconditioner."""

    def __init__(
        self,
        jacobian: csr_array,
        rows: np.ndarray,
        columns: np.ndarray,
        inverse: Inverse,
        accuracy: float,
    ):
        m, n = jacobian.shape
        beside = np.column_stack([jacobian[:, [m]].toarray(), columns])
        corner = np.column_stack([rows[:, m], np.zeros((len(rows), columns.shape[1]))])
        below = rows[:, :m]
        self._plain = _BlockElimination(inverse.solve, beside, below, corner)
        self._transposed = _BlockElimination(
            inverse.solve_transposed, below.T, beside.T, corner.T
        )
        self._jacobian, self._transposed_jacobian = jacobian, jacobian.T
        self._rows, self._columns, self._n = rows, columns, n
        self._accuracy = accuracy

    def solve(self, right: np.ndarray) -> np.ndarray:
        return _by_gmres(self._product, self._plain, right, self._accuracy)

    def solve_transposed(self, right: np.ndarray) -> np.ndarray:
        return _by_gmres(
            self._transposed_product, self._transposed, right, self._accuracy
        )

    def _product(self, x: np.ndarray) -> np.ndarray:
        above = self._jacobian @ x[: self._n] + self._columns @ x[self._n :]
        return np.concatenate([above, self._rows @ x[: self._n]])

    def _transposed_product(self, y: np.ndarray) -> np.ndarray:
        m = self._n - 1
        first = self._transposed_jacobian @ y[:m] + self._rows.T @ y[m:]
        return np.concatenate([first, self._columns.T @ y[:m]])


class _BlockElimination:
    """Solutions of [A E; C D] x = right by the inverse of A, or near them where that is
    approximate.

    With V = A^-1 E: x2 = (D - C V)^-1 (g - C A^-1 f) and x1 = A^-1 f - V x2.
    """

    def __init__(
        self, solve: Map, beside: np.ndarray, below: np.ndarray, corner: np.ndarray
    ):
        self._solve, self._beside = solve, beside
        self._below, self._corner = below, corner
        self._eliminated: np.ndarray | None = None

    def __call__(self, right: np.ndarray) -> np.ndarray:
        m = len(self._beside)
        if self._eliminated is None:
            parts = [self._solve(column) for column in self._beside.T]
            self._eliminated = np.column_stack(parts)
            self._schur = self._corner - self._below @ self._eliminated
        first = self._solve(right[:m])
        rest = right[m:] - self._below @ first
        second, *_ = np.linalg.lstsq(self._schur, rest, rcond=None)
        return np.concatenate([first - self._eliminated @ second, second])


def _by_gmres(
    product: Map, precondition: Map, right: np.ndarray, accuracy: float
) -> np.ndarray:
    """The solution of a system by GMRES on the preconditioned one.

    What is left is measured in the unit of solutions, so that neither the scale of the
    equations nor their condition counts.
    """
    from scipy.sparse.linalg import LinearOperator, gmres

    size = len(right)
    operator = LinearOperator(
        (size, size), lambda x: precondition(product(x)), dtype=float
    )
    solution = precondition(right)
    left = np.inf
    for _ in range(CYCLES):
        correction = precondition(right - product(solution))
        left = _share(correction, solution)
        if left <= accuracy:
            return solution
        change, _ = gmres(
            operator,
            correction,
            rtol=max(0.3 * accuracy / left, 1e-14),
            restart=KRYLOV_DIMENSION,
            maxiter=1,
        )
        solution = solution + change
    if accuracy < ROUGH and not left <= UNSOLVED:
        allowed = (
            f"below {UNSOLVED} after {CYCLES} cycles of GMRES with the solver: "
            "it must be nearer to the inverse of the jacobian without the parameter"
        )
        raise ProblemError("error of a linear system", f"{left:.3g}", allowed)
    return solution


def _share(part: np.ndarray, whole: np.ndarray) -> float:
    size = float(np.linalg.norm(whole))
    return float(np.linalg.norm(part)) / size if size > 0.0 else 0.0
