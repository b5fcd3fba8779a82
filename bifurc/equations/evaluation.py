"""Values and derivatives of a function: from its tape, or as far as calls of it tell;
and how noisy its values are, by what differences of a high order leave.

Along a line the differences of a smooth function shrink with their order, and those of
noise grow as binomial sums do (Hamming 1971; Moré and Wild 2011, Estimating
computational noise).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import comb
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from bifurc.checks import floats_of
from bifurc.equations.recording import Recording
from bifurc.equations.tape import Tape, rounding_of_constants
from bifurc.errors import ProblemError
from bifurc.numerics.bordered import as_dense
from bifurc.units import Units

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import sparray

COMPLEX_STEP = 1e-100  # its square vanishes beside 1, and it costs no digits
DIFFERENCE_STEP = 6e-6  # third root of rounding: best for central differences of F
VALUE, SHOWN = "value of the function", 4  # unknowns of a place in an error
MADE_BY_ROUNDING = 10.0  # times bounds on the rounding of F
SOLVED_IN_NOISE = 30.0  # times the noise, below which a value is zero
AGREEMENT = 1e-5  # of derivatives by complex step with those by differences
TINY = 1e-300  # keeps a size of zero from being one
SMALLEST_ROW = 1e-5  # over the largest; rounding may make a row of differences below it

# From a point (n,) to F (m,), and to F' (m, n), dense or sparse.
Function: TypeAlias = Callable[[np.ndarray], "Sequence[float] | np.ndarray"]
Jacobian: TypeAlias = "Callable[[np.ndarray], np.ndarray | sparray]"


@dataclass(frozen=True, eq=False)
class Equations:
    """F: R^n -> R^m by a ``function``, of which the ``recording`` is a tape or the
    reason why there is none.

    All values and derivatives come from the tape where there is one, compiled and
    exact. Otherwise F' comes from a ``given_jacobian``, which may make it sparse, by
    complex step or by central differences; ``derivatives`` says which. Values of the
    function may be noisy by ``noise`` (m,), a share ``noise_share`` of what they change by;
    what is within `SOLVED_IN_NOISE` of that is zero, and differences take longer steps.
    """

    function: Function
    given_jacobian: Jacobian | None
    m: int
    recording: Recording
    derivatives: str = ""
    is_sparse: bool = False
    noise: np.ndarray | None = None
    noise_share: float = 0.0

    @property
    def tape(self) -> Tape | None:
        """The tape, where there is one."""
        return self.recording.tape

    def in_units(self, units: Units, tape: Tape | None = None) -> Equations:
        """The same equations, or those on another ``tape``, over unknowns counted in
        ``units``, and weighted by these."""
        own_tape = self.tape if tape is None else tape
        recording = self.recording
        if own_tape is not None:
            in_units = own_tape.in_units(units.origin, units.sizes, units.weights)
            recording = Recording(in_units)

        def function(point: np.ndarray) -> np.ndarray:
            value = self._called(units.outwards(point))
            weighted: np.ndarray = units.weights * np.asarray(value)
            return weighted

        def jacobian(point: np.ndarray) -> np.ndarray | sparray:
            return units.jacobian(self.jacobian_as_given(units.outwards(point)))

        return replace(
            self,
            function=function,
            given_jacobian=None if self.given_jacobian is None else jacobian,
            m=len(units.weights),
            recording=recording,
            noise=None if self.noise is None else units.weights * self.noise,
        )

    def with_derivatives_at(self, probe: np.ndarray, sizes: np.ndarray) -> Equations:
        """The same with F' made as well as can be, by what is seen at a point (n,) of
        unknowns of the ``sizes`` (n,)."""
        is_given = self.tape is None and self.given_jacobian is not None
        is_sparse = is_given and not isinstance(
            self.jacobian_as_given(probe), np.ndarray
        )
        return replace(
            self, derivatives=self._best_way(probe, sizes), is_sparse=is_sparse
        )

    def _best_way(self, probe: np.ndarray, sizes: np.ndarray) -> str:
        """How F' is made: from the recording or as it is given, else by complex step,
        if that agrees with differences at a point.

        A function may also drop imaginary parts without a word.
        """
        if self.tape is not None:
            return "recorded"
        if self.given_jacobian is not None:
            return "given"
        try:
            with warnings.catch_warnings():
                # what drops imaginary parts with a word is found out below
                warnings.simplefilter("ignore", np.exceptions.ComplexWarning)
                by_complex = self.complex_step(probe)
        except (TypeError, ValueError):
            return "central differences"
        by_difference = self.central_difference(probe, sizes)
        if by_complex.shape != by_difference.shape:
            return "central differences"
        errors = np.abs(sizes * (by_complex - by_difference)).max(axis=1)
        rows = sizes_of_rows(sizes * by_difference, self.value(probe))
        is_equal = bool(np.all(errors < AGREEMENT * rows))
        return "complex step" if is_equal else "central differences"

    def value(self, point: np.ndarray) -> np.ndarray:
        """What the function gives at one point (n,), as an array."""
        return floats_of(VALUE, self._called(point))

    def _called(self, point: np.ndarray) -> Any:
        """What the function gives at one point (n,), which it may change; raises
        `ProblemError` for an error that says that the function has no value there."""
        try:
            return self.function(point.copy())
        except ProblemError:  # it says where already
            raise
        except (ValueError, ArithmeticError) as error:
            place = ", ".join(f"{x:.6g}" for x in point[:SHOWN])
            more = ", ..." if len(point) > SHOWN else ""
            what = f"{type(error).__name__} ({error}) at ({place}{more})"
            allowed = "a vector of numbers; nan where it is not defined"
            raise ProblemError(VALUE, what, allowed) from error

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        points = np.atleast_2d(points)
        if self.tape is not None:
            return self.tape.compiled.residuals(
                np.ascontiguousarray(points, dtype=float)
            )
        with np.errstate(all="ignore"):  # beyond the rim of where it is defined
            values = [self._called(point) for point in points]
        exact = np.array(values, dtype=float).reshape(len(points), self.m)
        if self.noise is None:
            return exact
        floor = SOLVED_IN_NOISE * self.noise
        beyond: np.ndarray = exact - np.clip(exact, -floor, floor)
        return beyond

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n), dense."""
        points = np.atleast_2d(points)
        if self.tape is not None:
            return self.tape.compiled.jacobians(
                np.ascontiguousarray(points, dtype=float)
            )
        jacobians = [as_dense(self.jacobian_by_calls(point)) for point in points]
        return np.array(jacobians).reshape(len(points), self.m, points.shape[1])

    def jacobian_by_calls(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,) by calls of what was given; sparse where the
        ``given_jacobian`` makes it so."""
        if self.given_jacobian is not None:
            return self.jacobian_as_given(point)
        with np.errstate(all="ignore"):
            if self.derivatives == "complex step":
                return self.complex_step(point)
            return self.central_difference(point, 1.0 + np.abs(point))

    def jacobian_as_given(self, point: np.ndarray) -> np.ndarray | sparray:
        """What the ``given_jacobian`` is at one point (n,)."""
        assert self.given_jacobian is not None
        jacobian = self.given_jacobian(point.copy())
        is_sparse = hasattr(jacobian, "tocsc")
        return jacobian if is_sparse else np.asarray(jacobian, dtype=float)

    def complex_step(self, point: np.ndarray) -> np.ndarray:
        """F' (m, n) at one point (n,) by complex step."""
        columns = []
        for shifted in point + 1j * COMPLEX_STEP * np.eye(len(point)):
            value = np.asarray(self._called(shifted))
            columns.append(np.imag(value) / COMPLEX_STEP)
        return np.column_stack(columns)

    def central_difference(self, point: np.ndarray, sizes: np.ndarray) -> np.ndarray:
        """F' (m, n) at one point (n,) by central differences, of unknowns of the
        ``sizes`` (n,)."""
        columns = []
        share = max(DIFFERENCE_STEP, self.noise_share ** (1.0 / 3.0))
        for i in range(len(point)):
            step = np.zeros(len(point))
            step[i] = share * sizes[i]
            upper = self.value(point + step)
            lower = self.value(point - step)
            width = 2 * step[i]
            columns.append((upper - lower) / width)
        return np.column_stack(columns)

    def typical_size(
        self, points: np.ndarray, sizes: Sequence[float], scale: float
    ) -> float:
        """The median of the ``sizes`` (k,) of F' at points (k, n), without those that are
        not finite, and without those that rounding of F makes over a length ``scale``:
        F may be constant in a part of the region. 1 where nothing is left."""
        known = np.array(sizes)
        counts = np.isfinite(known)
        if self.tape is not None:
            points = np.ascontiguousarray(points, dtype=float)
            low, high = self.tape.compiled.value_bounds(points, points)
            widths = np.nan_to_num(np.linalg.norm(high - low, axis=1), posinf=0.0)
            is_rounding = known * scale <= MADE_BY_ROUNDING * widths
            counts &= ~is_rounding | bool(np.all(is_rounding | ~counts))
        return (float(np.median(known[counts])) if counts.any() else 0.0) or 1.0

    @property
    def coefficient_rounding(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """How far off F (m,) at a point (n,) is where its coefficients are rounded to
        doubles; None where it is not recorded."""
        tape = self.tape
        return None if tape is None else partial(rounding_of_constants, tape)


def sizes_of_rows(derivatives: np.ndarray, values: np.ndarray) -> np.ndarray:
    """By how much each equation (m,) changes over the sizes of the unknowns, given what
    it changes by (..., m, n) and its values (..., m); no less than what rounding of all
    of them may look like."""
    changes = np.abs(derivatives).max(axis=-1)
    rows = changes.reshape(-1, changes.shape[-1]).max(axis=0)
    largest = max(float(rows.max()), float(np.abs(values).max()), TINY)
    sizes: np.ndarray = rows + SMALLEST_ROW * largest
    return sizes


VALUES = 13  # along each line
ORDERS = range(5, 10)  # of differences that are compared
LONG, SHORT = 1e-3, 1e-4  # steps between values, over the size of the region
# What differences over long and over short steps leave is smooth where the first is so
# many times larger: it falls with the power of the order. Of steps in the values, as
# rounding makes them, short ones see a part.
SMOOTH = 1e4


def noise_of(
    function: Callable[[np.ndarray], np.ndarray],
    points: np.ndarray,
    sizes: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray | None:
    """The standard deviation (m,) of what is not smooth in the values (m,) of a
    ``function`` of unknowns of the ``sizes`` (n,) about points (k, n); None where too
    few of these are finite."""
    estimates = []
    for point in points:
        heading = rng.normal(size=len(point))
        heading /= np.linalg.norm(heading)
        over_long = _along(function, point, LONG * sizes * heading)
        over_short = _along(function, point, SHORT * sizes * heading)
        if over_long is not None and over_short is not None:
            # values that do not change at all are rounded ones
            is_smooth = (over_long > SMOOTH * over_short) & (over_short > 0.0)
            estimates.append(np.where(is_smooth, over_short, over_long))
    if not estimates:
        return None
    return np.median(estimates, axis=0)


def _along(
    function: Callable[[np.ndarray], np.ndarray], point: np.ndarray, step: np.ndarray
) -> np.ndarray | None:
    """The noise (m,) of values a ``step`` (n,) apart about a point (n,); None where one
    of them is not finite."""
    places = np.arange(VALUES) - VALUES // 2
    differences = np.array([function(point + k * step) for k in places])
    if not np.all(np.isfinite(differences)):
        return None
    by_order = []
    for order in range(1, max(ORDERS) + 1):
        differences = np.diff(differences, axis=0)
        if order in ORDERS:
            # the variance of a difference of noise is that many times its own
            squares = np.mean(differences**2, axis=0) / comb(2 * order, order)
            by_order.append(np.sqrt(squares))
    lowest: np.ndarray = np.min(by_order, axis=0)
    return lowest
