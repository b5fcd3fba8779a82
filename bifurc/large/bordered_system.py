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
from bifurc.numerics.bordered import SparseBordered

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csr_array

# What is left of a system by GMRES, in the unit of solutions and as a share of this one:
# where points are located, and for a step of Newton's method on the way.
EXACT, ROUGH = 1e-10, 1e-5
UNSOLVED = 1e-3  # the same: from here on a system is not solved
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
    if inverse is None:
        return SparseBordered(jacobian, rows, columns, may_be_singular=True)
    if columns is None:
        columns = np.empty((jacobian.shape[0], 0))
    return _Iterated(jacobian, rows, columns, inverse, accuracy)


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
