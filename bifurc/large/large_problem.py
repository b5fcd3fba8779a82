"""A system of many unknowns as its user describes it: F, a sparse F', a solver."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from bifurc.checks import (
    check_callable,
    check_finite,
    check_number,
    check_whole,
    floats_of,
)
from bifurc.decisions import is_derivative
from bifurc.equations.recording import record
from bifurc.errors import ProblemError

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csr_array, sparray
    from scipy.sparse.linalg import LinearOperator

    from bifurc.equations.tape import Tape

Function: TypeAlias = Callable[[np.ndarray], "Sequence[float] | np.ndarray"]
# From a point (n,) to what maps a right-hand side (n - 1,) to the solution (n - 1,), or
# to an approximation of it.
InverseMaker: TypeAlias = (
    "Callable[[np.ndarray], LinearOperator | Callable[[np.ndarray], np.ndarray]]"
)

COMPLEX_STEP = 1e-100  # its square vanishes beside 1, and it costs no digits
DIFFERENCE_STEP = 6e-6  # third root of rounding: best for central differences
STEP_OF_PARAMETER = 1e-10  # least step of the parameter, over it: far above rounding
SHORTER = 1e-2  # a second step, over the first, which shows the error of a difference
SAME = 1e-5  # relative difference up to which two kinds of derivative agree
SAMPLES = 3  # points at which a recording is compared with the function


class LargeProblem:
    """n - 1 equations F(u) = 0 in n unknowns, the last of which is the parameter: of a
    discretised field, as a rule.

    ``function``: (n,) -> (n - 1,). ``bounds`` (low, high) are those of the parameter, or
    (n, 2) those of all unknowns, which may be infinite but for the parameter's; ``size``
    is the typical size of the other unknowns: lengths along a curve are root mean squares
    of them over the size, and the parameter over a quarter of its bounds.

    F' comes from ``jacobian``: (n,) -> (n - 1, n) or (n - 1, n - 1), sparse; from the
    ``pattern`` (n - 1, n) or (n - 1, n - 1) of its entries, by a complex step, or by
    central differences where the function drops imaginary parts, a group of columns at
    once; or, with neither of them, from the recorded function. The column of the
    parameter may be left out of both. `derivatives` says how F' is made.

    ``solver`` makes from a point (n,) the inverse of F' without the parameter's
    column, or an approximation of it (a preconditioner): a scipy `LinearOperator` (n -
    1, n - 1), with `rmatvec` where F' is not symmetric, or a function (n - 1,) -> (n -
    1,). Without one, matrices are factored by sparse LU.

    Raises `ProblemError` for arguments of another kind or shape, and for a function
    that cannot be recorded where nothing else gives F'.
    """

    def __init__(
        self,
        function: Function,
        n: int,
        bounds: Sequence[float] | Sequence[Sequence[float]] | np.ndarray,
        *,
        jacobian: Callable[[np.ndarray], sparray] | None = None,
        pattern: sparray | None = None,
        solver: InverseMaker | None = None,
        size: float = 1.0,
        parameter: str = "p",
    ):
        check_callable("function", function)
        check_whole("n", n, 2)
        for name, given in (("jacobian", jacobian), ("solver", solver)):
            if given is not None:
                check_callable(name, given)
        check_number("size", size)
        if not 0.0 < size < np.inf:
            raise ProblemError("size", size, "positive and finite")
        self.function = function
        self.n = int(n)
        self.region = _checked_region(bounds, self.n)
        self.bounds = self.region[-1]
        self.size = float(size)
        self.parameter = parameter
        self.solver = solver
        self._given = jacobian
        self._groups: np.ndarray | None = None
        self._tape: Tape | None = None
        if jacobian is not None:
            self.derivatives = "given"
        elif pattern is not None:
            self._set_pattern(pattern)
        else:
            self._record()

    def _set_pattern(self, pattern: sparray) -> None:
        """Colour the columns of a pattern."""
        checked = self._checked_matrix("pattern", pattern)
        self._pattern = checked
        self._groups = column_groups(checked)
        count = int(self._groups.max()) + 1
        self._count = count
        self._is_complex = self._lets_complex_through()
        kind = "complex step" if self._is_complex else "central differences"
        self.derivatives = f"{kind} in {count} groups of columns"

    def _record(self) -> None:
        """Record the function; raises `ProblemError` where it cannot be."""
        rng = np.random.default_rng(0)
        points = self.size * rng.uniform(-1.0, 1.0, (SAMPLES, self.n))
        points[:, -1] = rng.uniform(self.bounds[0], self.bounds[1], SAMPLES)
        recording = record(self.function, points)
        if recording.tape is None:
            allowed = (
                "a function, or there must be a pattern of its entries: the equations "
                f"are not recorded, as {recording.reason}"
            )
            raise ProblemError("jacobian", None, allowed)
        if recording.tape.m != self.n - 1:
            self._refuse_length(recording.tape.m)
        self._tape = recording.tape
        self.derivatives = "recorded"

    def with_size(self, size: float) -> LargeProblem:
        """The same problem with another typical size of the unknowns."""
        other = copy(self)
        other.size = size
        return other

    @property
    def is_recorded(self) -> bool:
        """Whether F' comes from the recorded function: it is exact."""
        return self._tape is not None

    # --- values -----------------------------------------------------------------------

    def value(self, point: np.ndarray) -> np.ndarray:
        """F (n - 1,) at a point (n,); raises `ProblemError` for another shape."""
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            value = np.asarray(self.function(point))
        if value.dtype.kind not in "fiu":
            value = floats_of("value of the function", value)
        if value.shape != (self.n - 1,):
            self._refuse_length(value.shape if value.ndim != 1 else len(value))
        return value.astype(float, copy=False)

    def _refuse_length(self, length: object) -> None:
        allowed = f"{self.n - 1}, one less than the {self.n} unknowns"
        raise ProblemError("number of equations", length, allowed)

    def jacobian(self, point: np.ndarray) -> csr_array:
        """F' (n - 1, n) at a point (n,), by rows; raises `ProblemError` where the given
        one has another shape, is not sparse or not finite."""
        if self._given is not None:
            matrix = self._checked_matrix("jacobian", self._given(point), point)
            check_finite("jacobian", matrix.data)
            return matrix
        if self._tape is not None:
            return self._by_tape(point)
        return self._by_groups(point)

    def _checked_matrix(
        self, name: str, matrix: Any, point: np.ndarray | None = None
    ) -> csr_array:
        """A sparse matrix (n - 1, n); the column of the parameter is added where it is
        missing: its derivative at a point (n,), or ones for a pattern."""
        from scipy.sparse import csr_array, hstack, issparse

        rows = self.n - 1
        if not issparse(matrix):
            raise ProblemError(f"type of the {name}", type(matrix), "a sparse matrix")
        if matrix.shape not in ((rows, rows), (rows, self.n)):
            allowed = f"({rows}, {self.n}), or ({rows}, {rows}) without the parameter"
            raise ProblemError(f"shape of the {name}", matrix.shape, allowed)
        if matrix.shape[1] == rows:
            last = np.ones(rows) if point is None else self._by_parameter(point)
            matrix = hstack([matrix, csr_array(last[:, None])])
        return csr_array(matrix)

    def _by_parameter(self, point: np.ndarray) -> np.ndarray:
        """The derivative (n - 1,) of F by the parameter, by central differences."""
        only_parameter = np.zeros(self.n)
        only_parameter[-1] = self._steps(point)[-1]
        change, steps = self._difference(point, only_parameter)
        derivative: np.ndarray = change / steps[-1]
        return derivative

    def _by_tape(self, point: np.ndarray) -> csr_array:
        from scipy.sparse import csr_array

        assert self._tape is not None
        starts, columns = self._tape.compiled.pattern()
        entries = self._tape.compiled.entries(np.ascontiguousarray(point, dtype=float))
        return csr_array((entries, columns, starts), shape=(self.n - 1, self.n))

    # --- derivatives by groups of columns ---------------------------------------------

    def _by_groups(self, point: np.ndarray) -> csr_array:
        """F' from one derivative along each group of columns."""
        from scipy.sparse import csr_array

        assert self._groups is not None
        changes = np.empty((self.n - 1, self._count))
        widths = np.ones(self.n)
        steps = self._steps(point)
        for group in range(self._count):
            in_group = self._groups == group
            along = in_group.astype(float)
            if self._is_complex:
                changes[:, group] = self._complex_step(point, along)
            else:
                changes[:, group], taken = self._difference(point, along * steps)
                widths[in_group] = taken[in_group]
        starts, columns = self._pattern.indptr, self._pattern.indices
        rows = np.repeat(np.arange(self.n - 1), np.diff(starts))
        # columns of a group share no row, so that each has a step of its own
        entries = changes[rows, self._groups[columns]] / widths[columns]
        return csr_array((entries, columns, starts), shape=self._pattern.shape)

    def _complex_step(self, point: np.ndarray, along: np.ndarray) -> np.ndarray:
        value = np.asarray(self.function(point + 1j * COMPLEX_STEP * along))
        return np.imag(value) / COMPLEX_STEP

    def _steps(self, point: np.ndarray) -> np.ndarray:
        """A step (n,) of each unknown for differences: by its size, which for the
        parameter is a quarter of the bounds, however far from 0 they are."""
        sizes = np.maximum(self.size, np.abs(point))
        steps: np.ndarray = DIFFERENCE_STEP * sizes
        by_bounds = DIFFERENCE_STEP * 0.25 * float(np.diff(self.bounds)[0])
        steps[-1] = max(by_bounds, STEP_OF_PARAMETER * abs(float(point[-1])))
        return steps

    def _difference(
        self, point: np.ndarray, steps: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """By how much F (n - 1,) changes along ``steps`` (n,), half the difference of
        both sides; and the steps (n,) that were taken, with their rounding."""
        upper, lower = point + steps, point - steps
        change: np.ndarray = 0.5 * (self.value(upper) - self.value(lower))
        return change, 0.5 * (upper - lower)

    def _lets_complex_through(self) -> bool:
        """Whether a complex step gives what differences give, at a point and along a
        direction of no special kind."""
        rng = np.random.default_rng(0)
        point = self.size * rng.uniform(-1.0, 1.0, self.n)
        point[-1] = rng.uniform(*self.bounds)
        signs = rng.choice([-1.0, 1.0], self.n)
        expected, steps = self._difference(point, signs * self._steps(point))
        try:
            by_complex = self._complex_step(point, steps)
        except (TypeError, ValueError, np.exceptions.ComplexWarning):
            return False
        if by_complex.shape != expected.shape:
            return False
        return bool(_relative_difference(by_complex, expected) < SAME)

    # --- checks -----------------------------------------------------------------------

    def check_start(self, start: object) -> np.ndarray:
        """A start as an array (n,); raises `ProblemError` for another shape, for a
        parameter out of bounds, for values that are not finite there, and for a
        jacobian that is not the derivative."""
        point = floats_of("start", start)  # type: ignore[arg-type]
        if point.shape != (self.n,):
            raise ProblemError("shape of the start", point.shape, f"({self.n},)")
        check_finite("start", point)
        low, high = self.bounds.tolist()
        if not low <= point[-1] <= high:
            allowed = f"between the bounds {low:.10g} and {high:.10g}"
            raise ProblemError("parameter of the start", float(point[-1]), allowed)
        check_finite("value of the function at the start", self.value(point))
        self.check_jacobian(point)
        return point

    def check_jacobian(self, point: np.ndarray) -> None:
        """Raises `ProblemError` where F' at a point (n,) is not the derivative, by more
        than the difference that it is held against is wrong itself."""
        if self.is_recorded:
            return  # exact, and held against the function when it was recorded
        rng = np.random.default_rng(0)
        # of no equal lengths, or entries that are missing could cancel out
        shares = rng.choice([-1.0, 1.0], self.n) * rng.uniform(0.5, 1.0, self.n)
        steps = shares * self._steps(point)
        longer = self._difference(point, steps)[0]
        change, taken = self._difference(point, SHORTER * steps)
        expected = change / SHORTER
        product = self.jacobian(point) @ taken / SHORTER
        error = np.linalg.norm(expected - longer)
        size = np.linalg.norm(expected) + np.linalg.norm(product)
        off = float(np.linalg.norm(product - expected) - error)
        if not is_derivative(off, float(size)) and off > 0.0:
            row = int(np.argmax(np.abs(product - expected)))
            derivative = expected[row] / DIFFERENCE_STEP
            allowed = f"the derivative of the function, {derivative:.6g}"
            name = f"product of row {row} of the jacobian with a random direction"
            raise ProblemError(name, f"{product[row] / DIFFERENCE_STEP:.6g}", allowed)


def _relative_difference(a: np.ndarray, b: np.ndarray) -> float:
    """|a - b| over the size of both."""
    size = np.linalg.norm(a) + np.linalg.norm(b)
    return float(np.linalg.norm(a - b) / size) if size > 0.0 else 0.0


def _checked_region(bounds: object, n: int) -> np.ndarray:
    """The bounds (n, 2) of all unknowns, infinite where only the parameter has some."""
    checked = floats_of("bounds", bounds)  # type: ignore[arg-type]
    region = np.tile([-np.inf, np.inf], (n, 1))
    allowed = "(low, high) of the parameter, finite, with low < high"
    if checked.shape == (2,):
        region[-1] = checked
    elif checked.shape == (n, 2):
        region = checked
        allowed += f", or ({n}, 2) of all unknowns in their order"
    else:
        raise ProblemError("bounds", bounds, f"{allowed}, or ({n}, 2)")
    low, high = region.T
    if not np.all(low < high) or not np.all(np.isfinite(region[-1])):
        raise ProblemError("bounds", bounds, allowed)
    return region


def column_groups(pattern: csr_array) -> np.ndarray:
    """The number of the group (n,) of each column of a pattern (m, n), from 0 on.

    Each column joins the first group in which none shares a row with it, so that one
    evaluation of a function along a group gives all derivatives in its columns (Curtis,
    Powell and Reid 1974).
    """
    from scipy.sparse import csr_array

    entries = np.ones(len(pattern.indices), dtype=np.int32)
    counts = csr_array((entries, pattern.indices, pattern.indptr), shape=pattern.shape)
    sharing = (counts.T @ counts).tocsr()
    groups = np.full(pattern.shape[1], -1)
    for column in range(len(groups)):
        row = slice(sharing.indptr[column], sharing.indptr[column + 1])
        taken = set(groups[sharing.indices[row]].tolist())
        group = 0
        while group in taken:
            group += 1
        groups[column] = group
    return groups
