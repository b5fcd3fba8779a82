"""A singular point again at fifty digits: how many digits of the double result are
right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import mpmath
import numpy as np

from bifurc.errors import ProblemError

Residual = Callable[[Sequence[mpmath.mpf]], Sequence[mpmath.mpf]]
"""F over mpmath numbers: n of them in, m out, right to whatever precision is set when
it is called."""

ITERATIONS = 40
# A step this much shorter than the one before, or less, is linear convergence.
LINEAR = 1e-3
# A step longer than this share of the one before does not converge.
STALLED = 0.9
# Length of the last step above which the refinement has not settled.
UNSETTLED = "1e-7"
# Residual and singular values, over the magnitude, that may be zero at most.
NOT_ZERO = "1e-6"


class Convergence(Enum):
    """How the refinement ended, and what that says of the point."""

    QUADRATIC = "quadratic: a simple singular point, exact to all digits asked for"
    LINEAR = "linear: a singular point of higher order, exact to the stated error only"
    INCONSISTENT = (
        "closure gap: the equations contradict each other; this is the point that "
        "violates them least"
    )
    NONE = "none: there is no singular point of this nullity close by"


@dataclass(frozen=True)
class Confirmation:
    """A singular point refined at high precision, compared with the double result from
    which it was refined.

    ``u`` (n,) and ``null_space`` (n, k) are arrays of mpmath numbers, ``error`` bounds what
    may be wrong with ``u``, ``residual`` is |F| there. ``distance`` of the double
    result, and ``angle`` (rad) between its null space and this. ``singular_values``
    (n,) of F' at ``u`` in decreasing order; ``nullity`` of them are zero to the
    precision reached.
    """

    u: np.ndarray
    null_space: np.ndarray
    error: float
    residual: float
    distance: float
    angle: float
    singular_values: tuple[float, ...]
    nullity: int
    convergence: Convergence
    iterations: int
    digits: int

    @property
    def agreeing_digits(self) -> float:
        """Digits after the point that the double result has right; no more than the
        refinement itself has."""
        doubt = max(self.distance, self.error, 10.0**-self.digits)
        return float(-mpmath.log10(doubt))


def confirm_singular_point(
    residual: Residual,
    point: np.ndarray,
    null_space: np.ndarray,
    digits: int = 50,
    magnitude: float = 1.0,
) -> Confirmation:
    """The singular point next to ``point`` (n,), with a null space of as many
    dimensions as ``null_space`` (n, k) has.

    ``magnitude`` is the typical size of F', as in `bifurc.problem.Problem`: singular
    values are zero in relation to it.

    Gauss-Newton on F(u) = 0, F'(u) V = 0, with columns of V moved across V only, as
    `bifurc.singular.locate` does in doubles. The derivatives are central differences at
    three times the digits, which makes them exact to the digits asked for. Least
    squares are solved by QR with column pivoting, so that redundant equations are
    welcome. Raises `ProblemError` for ``digits`` out of range.
    """
    if not 20 <= digits <= 1000:
        raise ProblemError("digits", digits, "from 20 to 1000")
    with mpmath.workdps(3 * digits + 30):
        derivatives = Differences(residual, mpmath.mpf(10) ** -(digits + 5))
        start = as_precise(point)
        start_basis = _orthonormal(as_precise(null_space))
        precision = mpmath.mpf(10) ** -digits
        refinement = _refine(derivatives, start, start_basis, precision)
        u, basis = refinement.u, refinement.basis
        verdict = _judge(derivatives, refinement, precision, mpmath.mpf(magnitude))
        turned = start_basis - basis @ (basis.T @ start_basis)
        return Confirmation(
            u=u,
            null_space=basis,
            error=float(verdict.error),
            residual=float(verdict.residual),
            distance=float(mpmath.norm(start - u)),
            angle=float(mpmath.norm(turned.ravel())),
            singular_values=tuple(float(x) for x in verdict.singular_values),
            nullity=verdict.nullity,
            convergence=verdict.convergence,
            iterations=len(refinement.moves),
            digits=digits,
        )


# --- the iteration --------------------------------------------------------------------


@dataclass(frozen=True)
class Differences:
    """F and its derivatives by central differences of ``step``, at the precision that
    is set, as arrays of mpmath numbers."""

    function: Residual
    step: mpmath.mpf

    def value(self, u: np.ndarray) -> np.ndarray:
        """F (m,)."""
        return np.array(list(self.function(list(u))), dtype=object)

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """F' (m, n)."""
        units = np.eye(len(u), dtype=int).astype(object)
        return np.column_stack([self._along(self.value, u, unit) for unit in units])

    def bend(self, u: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """F'' times a direction, (m, n)."""
        return self._along(self.jacobian, u, direction)

    def _along(
        self,
        function: Callable[[np.ndarray], np.ndarray],
        u: np.ndarray,
        direction: np.ndarray,
    ) -> np.ndarray:
        """The derivative of a function along a direction (n,)."""
        h = self.step
        change = function(u + h * direction) - function(u - h * direction)
        derivative: np.ndarray = change / (2 * h)
        return derivative


class _Refinement(NamedTuple):
    """The point ``u`` (n,), the ``basis`` (n, k) of its null space, and the lengths of
    the ``moves`` that led there."""

    u: np.ndarray
    basis: np.ndarray
    moves: list[mpmath.mpf]

    @property
    def last_ratio(self) -> mpmath.mpf:
        """Length of the last move over that of the one before; 0 where there is
        none."""
        if len(self.moves) < 2 or not self.moves[-2]:
            return mpmath.mpf(0)
        return self.moves[-1] / self.moves[-2]


def _refine(
    derivatives: Differences, u: np.ndarray, basis: np.ndarray, precision: mpmath.mpf
) -> _Refinement:
    """Steps of Gauss-Newton until they are below the ``precision``, or too long to
    converge."""
    moves: list[mpmath.mpf] = []
    for _ in range(ITERATIONS):
        du, dv = gauss_newton_step(derivatives, u, basis, precision**2)
        u, basis = u + du, _orthonormal(basis + dv)
        moves.append(mpmath.norm(du))
        if moves[-1] < precision or moves[-1] > 1:
            break
    return _Refinement(u, basis, moves)


def gauss_newton_step(
    derivatives: Differences, u: np.ndarray, basis: np.ndarray, negligible: mpmath.mpf
) -> tuple[np.ndarray, np.ndarray]:
    """The step (n,) of a point and that (n, k) of the ``basis`` of its null space, where
    what is less than the share ``negligible`` of the largest is rounding."""
    bends = [derivatives.bend(u, vector) for vector in basis.T]
    value, jacobian = derivatives.value(u), derivatives.jacobian(u)
    step = _least_squares(*_augmented_system(value, jacobian, bends, basis), negligible)
    n, k = basis.shape
    return step[:n], step[n:].reshape(k, n).T


def _augmented_system(
    residual: np.ndarray,
    jacobian: np.ndarray,
    bends: Sequence[np.ndarray],
    basis: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and right-hand side of a step for a point and the ``basis`` (n, k) of its
    null space, from F (m,), F' (m, n) and F'' v (m, n) for each vector of that."""
    # The columns v_1 ... v_k of V move across V only:
    #
    #     [ F'                            ] [ du   ]     [ F      ]
    #     [ F'' v_1   F'                  ] [ dv_1 ]     [ F' v_1 ]
    #     [   :             ...           ] [  :   ] = - [   :    ]
    #     [ F'' v_k               F'      ] [ dv_k ]     [ F' v_k ]
    #     [           V^T                 ]              [ 0      ]
    #     [                 ...           ]              [ :      ]
    #     [                       V^T     ]              [ 0      ]
    n, k = basis.shape
    m = len(jacobian)
    rows = m + k * m + k * k
    matrix = np.zeros((rows, n + k * n), dtype=jacobian.dtype)
    right_side = np.zeros(rows, dtype=jacobian.dtype)
    matrix[:m, :n] = jacobian
    right_side[:m] = -residual
    for j, bend in enumerate(bends):
        null = _block(m, j, m)  # rows of F'' v_j
        across = _block(m + k * m, j, k)  # rows of V^T
        column = _block(n, j, n)  # columns of dv_j
        matrix[null, :n] = bend
        matrix[null, column] = jacobian
        right_side[null] = -jacobian @ basis[:, j]
        matrix[across, column] = basis.T
    return matrix, right_side


def _block(begin: int, number: int, size: int) -> slice:
    """Block of a ``number`` among blocks of one ``size``, the first of which is at
    ``begin``."""
    start = begin + number * size
    return slice(start, start + size)


def _least_squares(
    matrix: np.ndarray, right_side: np.ndarray, negligible: mpmath.mpf
) -> np.ndarray:
    """A least-squares solution (n,) by QR with column pivoting (modified Gram-Schmidt,
    the longest column first); columns that add less than the share ``negligible`` of the
    largest get zero."""
    n = matrix.shape[1]
    table = np.column_stack([matrix, right_side])
    left = list(range(n))
    pivots: list[tuple[int, np.ndarray]] = []
    largest = mpmath.mpf(0)
    while left:
        squares = np.sum(table[:, left] ** 2, axis=0)
        longest = left.pop(int(np.argmax(squares)))
        length = mpmath.sqrt(max(squares))
        largest = max(largest, length)
        if length <= negligible * largest:
            break
        direction = table[:, longest] / length
        row = direction @ table
        pivots.append((longest, row))
        others = [*left, n]
        table[:, others] -= np.outer(direction, row[others])
    solution = np.zeros(n, dtype=object)
    for column, row in reversed(pivots):
        solution[column] = (row[n] - row[:n] @ solution) / row[column]
    return solution


# --- the verdict ----------------------------------------------------------------------


class _Verdict(NamedTuple):
    """What the refinement and the equations at its end say of the point."""

    convergence: Convergence
    error: mpmath.mpf
    residual: mpmath.mpf
    singular_values: list[mpmath.mpf]
    nullity: int


def _judge(
    derivatives: Differences,
    refinement: _Refinement,
    precision: mpmath.mpf,
    magnitude: mpmath.mpf,
) -> _Verdict:
    """How the refinement converged, how exact it is, and the rank of F' at its end."""
    singular_values = _singular_values(derivatives.jacobian(refinement.u))
    residual = mpmath.norm(derivatives.value(refinement.u))
    rank = len(singular_values) - refinement.basis.shape[1]
    misfit = max(singular_values[rank], residual) / magnitude
    if misfit > mpmath.mpf(NOT_ZERO):
        convergence = Convergence.NONE
    else:
        convergence = _judge_moves(refinement, residual / magnitude, precision)
    error = _refinement_error(refinement, convergence, precision)
    zero = magnitude * max(100 * error, mpmath.sqrt(precision))
    nullity = sum(1 for x in singular_values if x <= zero)
    return _Verdict(convergence, error, residual, singular_values, nullity)


def _singular_values(matrix: np.ndarray) -> list[mpmath.mpf]:
    """Singular values of a matrix (m, n), n of them, in decreasing order."""
    gram = mpmath.matrix((matrix.T @ matrix).tolist())
    squares = mpmath.eigsy(gram, eigvals_only=True)
    values = [mpmath.sqrt(abs(x)) for x in squares]
    return sorted(values, reverse=True)


def _judge_moves(
    refinement: _Refinement, residual: mpmath.mpf, precision: mpmath.mpf
) -> Convergence:
    """What the lengths of the steps say, and the ``residual`` over the magnitude."""
    moves = refinement.moves
    last = moves[-1]
    is_first = len(moves) < 2
    is_shrinking = is_first or last < STALLED * moves[-2] or last < precision
    if not is_shrinking or last >= mpmath.mpf(UNSETTLED):
        return Convergence.NONE
    if residual > max(mpmath.sqrt(precision), last):
        return Convergence.INCONSISTENT
    if last < precision and (is_first or last <= LINEAR * moves[-2]):
        return Convergence.QUADRATIC
    return Convergence.LINEAR


def _refinement_error(
    refinement: _Refinement, convergence: Convergence, precision: mpmath.mpf
) -> mpmath.mpf:
    """A bound of the error: the rest of the geometric series of the steps, the last
    step where convergence was quadratic, and the precision at least."""
    ratio = refinement.last_ratio
    tail = ratio / (1 - ratio) if ratio < 1 else mpmath.inf
    if convergence is Convergence.QUADRATIC:
        tail = min(tail, 1)
    return max(refinement.moves[-1] * tail, precision)


# --- small matrices -------------------------------------------------------------------


def as_precise(values: np.ndarray) -> np.ndarray:
    """The same numbers in mpmath."""
    numbers = [mpmath.mpf(float(value)) for value in values.ravel()]
    return np.array(numbers, dtype=object).reshape(values.shape)


def _orthonormal(matrix: np.ndarray) -> np.ndarray:
    """An orthonormal basis (n, k) of the columns, by Gram and Schmidt."""
    basis: list[np.ndarray] = []
    for column in matrix.T:
        for other in basis:
            column = column - other * (other @ column)
        basis.append(column / mpmath.norm(column))
    return np.column_stack(basis)
