"""A singular point again at fifty digits: how many digits of the double result are
right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import mpmath
import numpy as np

from bifurc.errors import ProblemError

__all__ = ["Confirmation", "Convergence", "Residual", "confirm_singular_point"]

Residual = Callable[[Sequence[Any]], Sequence[Any]]
"""F over mpmath numbers: n of them in, m out, right to whatever precision is set when it is called."""

ITERATIONS = 40
LINEAR = (
    1e-3  # a step this much shorter than the one before, or less, is linear convergence
)


class Convergence(Enum):
    """How the refinement ended, and what that says of the point."""

    QUADRATIC = "quadratic: a simple singular point, exact to all digits asked for"
    LINEAR = "linear: a singular point of higher order, exact to the stated error only"
    INCONSISTENT = "closure gap: the equations contradict each other; this is the point that violates them least"
    NONE = "none: there is no singular point of this nullity close by"


@dataclass(frozen=True)
class Confirmation:
    """A singular point refined at high precision, beside the double result it was
    refined from.

    ``u`` (n,) and ``null_space`` (n, k) are mpmath matrices, ``error`` bounds what may
    be wrong with ``u``, ``residual`` is |F| there. ``distance`` of the double result,
    and ``angle`` (rad) between its null space and this. ``singular_values`` (n,) of F'
    at ``u`` in decreasing order; ``nullity`` of them are zero to the precision reached.
    """

    u: Any
    null_space: Any
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
        return float(-mpmath.log10(max(self.distance, self.error, 10.0**-self.digits)))


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
        system = _Differences(residual, mpmath.mpf(10) ** -(digits + 5))
        u, basis = (
            mpmath.matrix(point.tolist()),
            _orthonormal(mpmath.matrix(null_space.tolist())),
        )
        moves = _refine(system, u, basis, mpmath.mpf(10) ** -digits)
        return _compare(
            system, u, basis, moves, point, null_space, digits, mpmath.mpf(magnitude)
        )


# --- the iteration ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Differences:
    """F and its derivatives by central differences of ``step``, at the precision that
    is set."""

    function: Residual
    step: Any

    def value(self, u: Any) -> Any:
        """F as a column (m, 1)."""
        return mpmath.matrix(list(self.function(list(u))))

    def along(self, u: Any, direction: Any) -> Any:
        """F' times a direction, (m, 1)."""
        h = self.step
        return (self.value(u + h * direction) - self.value(u - h * direction)) / (2 * h)

    def jacobian(self, u: Any) -> Any:
        """F' (m, n)."""
        return _columns([self.along(u, _unit(len(u), i)) for i in range(len(u))])

    def bend(self, u: Any, direction: Any) -> Any:
        """F'' times a direction, (m, n)."""
        h = self.step
        return (self.jacobian(u + h * direction) - self.jacobian(u - h * direction)) / (
            2 * h
        )


def _refine(system: _Differences, u: Any, basis: Any, goal: Any) -> list[Any]:
    """Gauss-Newton in place on ``u`` (n, 1) and ``basis`` (n, k); the lengths of its
    steps come back."""
    n, k = basis.rows, basis.cols
    moves: list[Any] = []
    for _ in range(ITERATIONS):
        matrix, right = _augmented(system, u, basis)
        step = _least_squares(matrix, right, goal**2)
        for i in range(n):
            u[i] += step[i]
            for j in range(k):
                basis[i, j] += step[n + j * n + i]
        basis[:, :] = _orthonormal(basis)
        moves.append(mpmath.norm(step[:n]))
        if moves[-1] < goal or moves[-1] > 1:
            break
    return moves


def _augmented(system: _Differences, u: Any, basis: Any) -> tuple[Any, Any]:
    """Matrix and right-hand side of a step: rows F', then for every column v of V
    [F''v, F'] and V^T dv = 0."""
    n, k = basis.rows, basis.cols
    jacobian, value = system.jacobian(u), system.value(u)
    m = len(value)
    matrix, right = (
        mpmath.zeros(m + k * (m + k), n + k * n),
        mpmath.zeros(m + k * (m + k), 1),
    )
    matrix[:m, :n], right[:m, 0] = jacobian, -value
    for j in range(k):
        top, across, own = m + j * m, m + k * m + j * k, n + j * n
        matrix[top : top + m, :n] = system.bend(u, basis[:, j])
        matrix[top : top + m, own : own + n] = jacobian
        right[top : top + m, 0] = -jacobian * basis[:, j]
        matrix[across : across + k, own : own + n] = basis.T
    return matrix, right


def _least_squares(matrix: Any, right: Any, negligible: Any) -> list[Any]:
    """A least-squares solution by modified Gram-Schmidt with column pivoting; columns
    that add nothing get zero."""
    count = matrix.cols
    columns, rest = [list(matrix[:, j]) for j in range(count)], list(right)
    chosen: list[
        tuple[int, Any, list[Any], dict[int, Any]]
    ] = []  # column, length, projection of the right-hand side
    left = set(range(count))
    upper: dict[int, dict[int, Any]] = {j: {} for j in range(count)}
    largest = mpmath.mpf(0)
    while left:
        sizes = {j: mpmath.fdot(columns[j], columns[j]) for j in left}
        pivot = max(left, key=lambda j: sizes[j])
        size = mpmath.sqrt(sizes[pivot])
        largest = max(largest, size)
        if size <= negligible * largest:
            break
        left.remove(pivot)
        direction = [x / size for x in columns[pivot]]
        for j in left:
            upper[j][pivot] = mpmath.fdot(direction, columns[j])
            columns[j] = [
                x - upper[j][pivot] * d
                for x, d in zip(columns[j], direction, strict=True)
            ]
        onto = mpmath.fdot(direction, rest)
        rest = [x - onto * d for x, d in zip(rest, direction, strict=True)]
        chosen.append((pivot, size, onto, upper[pivot]))
    solution = [mpmath.mpf(0)] * count
    order = [pivot for pivot, *_ in chosen]
    for place in range(len(chosen) - 1, -1, -1):
        pivot, size, onto, _ = chosen[place]
        solution[pivot] = (
            onto - sum(upper[j][pivot] * solution[j] for j in order[place + 1 :])
        ) / size
    return solution


# --- the verdict --------------------------------------------------------------------------------------


def _compare(
    system: _Differences,
    u: Any,
    basis: Any,
    moves: list[Any],
    point: np.ndarray,
    null_space: np.ndarray,
    digits: int,
    magnitude: Any,
) -> Confirmation:
    """What the refinement says of the double result."""
    jacobian = system.jacobian(u)
    squares = mpmath.eigsy(jacobian.T * jacobian, eigvals_only=True)
    sigma = sorted((mpmath.sqrt(abs(x)) for x in squares), reverse=True)
    residual = mpmath.norm(system.value(u))
    precise = mpmath.mpf(10) ** -digits
    convergence = _judge(
        moves, residual / magnitude, sigma[len(sigma) - basis.cols] / magnitude, precise
    )
    ratio = moves[-1] / moves[-2] if len(moves) > 1 and moves[-2] else mpmath.mpf(0)
    tail = ratio / (1 - ratio) if ratio < 1 else mpmath.inf
    error = max(
        moves[-1]
        * min(tail, 1 if convergence is Convergence.QUADRATIC else mpmath.inf),
        precise,
    )
    before = _orthonormal(mpmath.matrix(null_space.tolist()))
    return Confirmation(
        u=u,
        null_space=basis,
        error=float(error),
        residual=float(residual),
        distance=float(mpmath.norm(mpmath.matrix(point.tolist()) - u)),
        angle=float(mpmath.norm(before - basis * (basis.T * before))),
        singular_values=tuple(float(x) for x in sigma),
        nullity=sum(
            1 for x in sigma if x <= magnitude * max(100 * error, mpmath.sqrt(precise))
        ),
        convergence=convergence,
        iterations=len(moves),
        digits=digits,
    )


def _judge(
    moves: list[Any], residual: Any, largest_zero: Any, precise: Any
) -> Convergence:
    """What the lengths of the steps say, and what is left of F and F' V."""
    shrinking = len(moves) < 2 or moves[-1] < 0.9 * moves[-2] or moves[-1] < precise
    settled = moves[-1] < mpmath.mpf("1e-7")
    if not (shrinking and settled) or max(largest_zero, residual) > mpmath.mpf("1e-6"):
        return Convergence.NONE
    if residual > max(mpmath.sqrt(precise), moves[-1]):
        return Convergence.INCONSISTENT
    quick = moves[-1] < precise and (len(moves) < 2 or moves[-1] <= LINEAR * moves[-2])
    return Convergence.QUADRATIC if quick else Convergence.LINEAR


# --- small matrices -----------------------------------------------------------------------------------


def _unit(n: int, i: int) -> Any:
    out = mpmath.zeros(n, 1)
    out[i] = 1
    return out


def _columns(columns: list[Any]) -> Any:
    out = mpmath.zeros(len(columns[0]), len(columns))
    for j, column in enumerate(columns):
        out[:, j] = column
    return out


def _orthonormal(matrix: Any) -> Any:
    """An orthonormal basis (n, k) of the columns, by Gram and Schmidt."""
    done: list[Any] = []
    for j in range(matrix.cols):
        column = matrix[:, j]
        for other in done:
            column = column - other * (other.T * column)[0]
        done.append(column / mpmath.norm(column))
    return _columns(done)
