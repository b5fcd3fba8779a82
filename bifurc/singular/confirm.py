"""A singular point again at fifty digits: how many digits of the double result are
right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import mpmath
import numpy as np

from bifurc.errors import ProblemError
from bifurc.singular.locate import block_slice

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

    ``u`` (n, 1) and ``null_space`` (n, k) are mpmath matrices, ``error`` bounds what
    may be wrong with ``u``, ``residual`` is |F| there. ``distance`` of the double
    result, and ``angle`` (rad) between its null space and this. ``singular_values``
    (n,) of F' at ``u`` in decreasing order; ``nullity`` of them are zero to the
    precision reached.
    """

    u: mpmath.matrix
    null_space: mpmath.matrix
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
        start = mpmath.matrix(point.tolist())
        start_basis = _orthonormal(mpmath.matrix(null_space.tolist()))
        refinement = _Refinement(start.copy(), start_basis.copy())
        precision = mpmath.mpf(10) ** -digits
        refinement.run(derivatives, precision)
        verdict = _judge(derivatives, refinement, precision, mpmath.mpf(magnitude))
        across = refinement.basis * (refinement.basis.T * start_basis)
        return Confirmation(
            u=refinement.u,
            null_space=refinement.basis,
            error=float(verdict.error),
            residual=float(verdict.residual),
            distance=float(mpmath.norm(start - refinement.u)),
            angle=float(mpmath.norm(start_basis - across)),
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
    is set."""

    function: Residual
    step: mpmath.mpf

    def value(self, u: mpmath.matrix) -> mpmath.matrix:
        """F as a column (m, 1)."""
        return mpmath.matrix(list(self.function(list(u))))

    def along(self, u: mpmath.matrix, direction: mpmath.matrix) -> mpmath.matrix:
        """F' times a direction, (m, 1)."""
        h = self.step
        ahead = self.value(u + h * direction)
        behind = self.value(u - h * direction)
        return (ahead - behind) / (2 * h)

    def jacobian(self, u: mpmath.matrix) -> mpmath.matrix:
        """F' (m, n)."""
        n = len(u)
        return _columns([self.along(u, _unit(n, i)) for i in range(n)])

    def bend(self, u: mpmath.matrix, direction: mpmath.matrix) -> mpmath.matrix:
        """F'' times a direction, (m, n)."""
        h = self.step
        ahead = self.jacobian(u + h * direction)
        behind = self.jacobian(u - h * direction)
        return (ahead - behind) / (2 * h)


@dataclass
class _Refinement:
    """The point ``u`` (n, 1), the ``basis`` (n, k) of its null space, and the lengths
    of the ``moves`` that led there."""

    u: mpmath.matrix
    basis: mpmath.matrix
    moves: list[mpmath.mpf] = field(default_factory=list)

    @property
    def last_ratio(self) -> mpmath.mpf:
        """Length of the last move over that of the one before; 0 where there is
        none."""
        if len(self.moves) < 2 or not self.moves[-2]:
            return mpmath.mpf(0)
        return self.moves[-1] / self.moves[-2]

    def run(self, derivatives: Differences, precision: mpmath.mpf) -> None:
        """Take steps of Gauss-Newton until they are below the ``precision``, or too
        long to converge."""
        for _ in range(ITERATIONS):
            matrix, right_side = augmented_system(derivatives, self.u, self.basis)
            self._move(least_squares(matrix, right_side, precision**2))
            if self.moves[-1] < precision or self.moves[-1] > 1:
                break

    def _move(self, step: list[mpmath.mpf]) -> None:
        """Add a step (n + k n,) of the point and of its null space."""
        n, k = self.basis.rows, self.basis.cols
        for i in range(n):
            self.u[i] += step[i]
            for j in range(k):
                self.basis[i, j] += step[n + j * n + i]
        self.basis = _orthonormal(self.basis)
        self.moves.append(mpmath.norm(step[:n]))


def augmented_system(
    derivatives: Differences, u: mpmath.matrix, basis: mpmath.matrix
) -> tuple[mpmath.matrix, mpmath.matrix]:
    """Matrix and right-hand side of a step for the point and its null space."""
    # The columns v_1 ... v_k of V move across V only:
    #
    #     [ F'                            ] [ du   ]     [ F      ]
    #     [ F'' v_1   F'                  ] [ dv_1 ]     [ F' v_1 ]
    #     [   :             ...           ] [  :   ] = - [   :    ]
    #     [ F'' v_k               F'      ] [ dv_k ]     [ F' v_k ]
    #     [           V^T                 ]              [ 0      ]
    #     [                 ...           ]              [ :      ]
    #     [                       V^T     ]              [ 0      ]
    n, k = basis.rows, basis.cols
    jacobian = derivatives.jacobian(u)
    value = derivatives.value(u)
    m = len(value)
    rows = m + k * m + k * k
    matrix = mpmath.zeros(rows, n + k * n)
    right_side = mpmath.zeros(rows, 1)
    matrix[:m, :n] = jacobian
    right_side[:m, 0] = -value
    for j in range(k):
        v = basis[:, j]
        null = block_slice(m, j, m)  # rows of F'' v_j
        across = block_slice(m + k * m, j, k)  # rows of V^T
        column = block_slice(n, j, n)  # columns of dv_j
        matrix[null, :n] = derivatives.bend(u, v)
        matrix[null, column] = jacobian
        right_side[null, 0] = -jacobian * v
        matrix[across, column] = basis.T
    return matrix, right_side


# --- least squares --------------------------------------------------------------------


class _Pivot(NamedTuple):
    """A row of the triangular factor, in the order in which columns are taken.

    The number of the ``column``, its ``length`` (the entry on the diagonal), the other
    entries of the ``row`` by column, and what the orthogonal factor makes of the
    right-hand side.
    """

    column: int
    length: mpmath.mpf
    row: dict[int, mpmath.mpf]
    right_side: mpmath.mpf


def least_squares(
    matrix: mpmath.matrix, right_side: mpmath.matrix, negligible: mpmath.mpf
) -> list[mpmath.mpf]:
    """A least-squares solution by QR with column pivoting; columns that add less than
    the share ``negligible`` of the largest get zero."""
    solution = [mpmath.mpf(0)] * matrix.cols
    pivots = _orthogonalise(matrix, right_side, negligible)
    for place in range(len(pivots) - 1, -1, -1):
        pivot = pivots[place]
        later = [other.column for other in pivots[place + 1 :]]
        total = sum(pivot.row[j] * solution[j] for j in later)
        solution[pivot.column] = (pivot.right_side - total) / pivot.length
    return solution


def _orthogonalise(
    matrix: mpmath.matrix, right_side: mpmath.matrix, negligible: mpmath.mpf
) -> list[_Pivot]:
    """The triangular factor by modified Gram-Schmidt, the longest column first."""
    columns = {j: list(matrix[:, j]) for j in range(matrix.cols)}
    rest = list(right_side)
    pivots: list[_Pivot] = []
    largest = mpmath.mpf(0)
    while columns:
        squares = {j: mpmath.fdot(v, v) for j, v in columns.items()}
        longest = max(squares, key=squares.__getitem__)
        length = mpmath.sqrt(squares[longest])
        largest = max(largest, length)
        if length <= negligible * largest:
            break
        direction = [x / length for x in columns.pop(longest)]
        row: dict[int, mpmath.mpf] = {}
        for j, column in columns.items():
            row[j] = mpmath.fdot(direction, column)
            columns[j] = _without(column, row[j], direction)
        share = mpmath.fdot(direction, rest)
        rest = _without(rest, share, direction)
        pivots.append(_Pivot(longest, length, row, share))
    return pivots


def _without(
    vector: list[mpmath.mpf], share: mpmath.mpf, direction: list[mpmath.mpf]
) -> list[mpmath.mpf]:
    """The vector less ``share`` times a direction."""
    return [x - share * d for x, d in zip(vector, direction, strict=True)]


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
    rank = len(singular_values) - refinement.basis.cols
    misfit = max(singular_values[rank], residual) / magnitude
    if misfit > mpmath.mpf(NOT_ZERO):
        convergence = Convergence.NONE
    else:
        convergence = _judge_moves(refinement, residual / magnitude, precision)
    error = _refinement_error(refinement, convergence, precision)
    zero = magnitude * max(100 * error, mpmath.sqrt(precision))
    nullity = sum(1 for x in singular_values if x <= zero)
    return _Verdict(convergence, error, residual, singular_values, nullity)


def _singular_values(matrix: mpmath.matrix) -> list[mpmath.mpf]:
    """Singular values of a matrix (m, n), n of them, in decreasing order."""
    squares = mpmath.eigsy(matrix.T * matrix, eigvals_only=True)
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


def _unit(n: int, i: int) -> mpmath.matrix:
    """Unit vector (n, 1) number i."""
    out = mpmath.zeros(n, 1)
    out[i] = 1
    return out


def _columns(columns: list[mpmath.matrix]) -> mpmath.matrix:
    """The matrix (n, k) of k columns (n, 1)."""
    out = mpmath.zeros(len(columns[0]), len(columns))
    for j, column in enumerate(columns):
        out[:, j] = column
    return out


def _orthonormal(matrix: mpmath.matrix) -> mpmath.matrix:
    """An orthonormal basis (n, k) of the columns, by Gram and Schmidt."""
    basis: list[mpmath.matrix] = []
    for j in range(matrix.cols):
        column = matrix[:, j]
        for other in basis:
            column = column - other * (other.T * column)[0]
        basis.append(column / mpmath.norm(column))
    return _columns(basis)
