"""Problems of which nothing is known but F and F', and those from a Python callable."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc.checks import check_callable, floats_of
from bifurc.decisions import (
    is_bearable_noise,
    is_derivative,
    is_free_of_noise,
    is_period,
    is_solved_from_afar,
    is_whole_circle,
)
from bifurc.equations.recording import Recording, record
from bifurc.equations.system import ScaledTape
from bifurc.equations.tape import rounding_of_constants
from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.bordered import as_dense
from bifurc.numerics.collocation import march_by_collocation
from bifurc.numerics.corrector import (
    project_by_least_squares,
    project_to_sphere_by_newton,
)
from bifurc.numerics.noise import noise_of
from bifurc.problem import (
    March,
    MarchSettings,
    NodeCorrector,
    PreciseResidual,
    Problem,
    SphereProjection,
)
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import sparray

PROBES = 7  # points at which a function is tried out and its derivatives are measured
MOST_TRIALS = (
    2000  # points at which it is tried where it is defined on little of the box
)
CHECKS = 20  # more points at which a recording is compared with the function
LARGEST_COMPARED = 200  # unknowns up to which a given derivative is compared
START_SIZES = (1.0, 1e3, 1e-3, 1e6, 1e-6)  # of starts for unknowns without bounds
FARTHEST = 100.0  # over the size of solutions, bounds where none are given
AT_ONCE = 14  # pieces by collocation in one march
SOLVED_IN_NOISE = 30.0  # times the noise, below which a value is zero
NOISE_PROBES = 5  # points about which noise is measured
COMPLEX_STEP = 1e-100  # its square vanishes beside 1, and it costs no digits
DIFFERENCE_STEP = 6e-6  # third root of rounding: best for central differences of F
HESSIAN_STEP = 1e-5  # the same for F'
TINY = 1e-300  # keeps what is zero from being divided by
NOT_RECORDED = Recording(None, "not asked for")
EXACT_HESSIAN = 1e-14  # how far off, over a bound on it, rounding leaves an exact F''


class NumericalProblem(Problem):
    """A problem that gives `residuals` and `jacobians`, and nothing else: second
    derivatives by differences, pieces by collocation, solutions by least squares.

    Where it has its equations as a ``scaled_tape``, these come of that: exact
    derivatives, pieces by Taylor series, and all in compiled code as far as that is
    fast.
    """

    scaled_tape: ScaledTape | None = None
    _step_of_hessian: float = HESSIAN_STEP

    def jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,), sparse where a tape of many unknowns is."""
        if self.scaled_tape is not None:
            return self.scaled_tape.jacobian(point)
        return super().jacobian(point)

    def precise_residual(self) -> PreciseResidual | None:
        """F over mpmath numbers where there is a tape; its constants are the doubles that
        it computes with. Raises `ValueError` where F is not real."""
        return None if self.scaled_tape is None else self.scaled_tape.precise_residual

    def valley_corrector(self) -> NodeCorrector | None:
        """What corrects points at the nodes of a piece of the valley along which the
        equations are nearly solved, where the tape is small."""
        if self.scaled_tape is None or not self.scaled_tape.is_small:
            return None
        return self.scaled_tape.valley_points_at_nodes

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,): exact by the tape, else by central
        differences of F'."""
        if self.scaled_tape is not None:
            return self.scaled_tape.hessian(point)
        steps = self._step_of_hessian * (1.0 + np.abs(point))
        shifts = np.diag(steps)
        upper = self.jacobians(point + shifts)
        lower = self.jacobians(point - shifts)
        widths = 2 * steps[:, None, None]
        by_unknown = (upper - lower) / widths
        hessian = np.moveaxis(by_unknown, 0, -1)
        transposed = np.swapaxes(hessian, 1, 2)
        symmetric: np.ndarray = 0.5 * (hessian + transposed)
        return symmetric

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Pieces of the curve from ``start`` (n,) along ``tangent`` (n,): Taylor series
        of the tape, else by collocation, no more than `AT_ONCE`, as they do not end
        where the curve does."""
        if self.scaled_tape is not None and self.scaled_tape.is_marched:
            return self.scaled_tape.march(start, tangent, settings)
        few = replace(settings, count=min(settings.count, AT_ONCE))
        return march_by_collocation(self, start, tangent, few)

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each, by least squares."""
        if self.scaled_tape is not None and self.scaled_tape.is_marched:
            return self.scaled_tape.project(starts)
        return project_by_least_squares(self, starts)

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions near starts (k, n) at distance ``radius`` from ``center`` (n,), by
        Newton's method."""
        if self.scaled_tape is not None and self.scaled_tape.is_small:
            return self.scaled_tape.project_to_sphere(starts, center, radius)
        return project_to_sphere_by_newton(self, starts, center, radius)

    def seeds(self, rng: np.random.Generator, count: int) -> Seeds:
        """Solutions reached from ``count`` random starts."""
        return random_seeds(self, rng, count)

    def seeds_until(
        self, rng: np.random.Generator, count: int, deadline: Deadline
    ) -> Seeds:
        """The same, from as many of the starts as there is time for before the
        ``deadline``; all where a class has seeds in a way of its own."""
        is_own = getattr(self.seeds, "__func__", None) is not NumericalProblem.seeds
        if is_own:
            return self.seeds(rng, count)
        return random_seeds(self, rng, count, deadline=deadline)


class EquationProblem(NumericalProblem):
    """The equations of a ``function``: (n,) -> (m,), of which the ``recording`` is a tape
    or the reason why there is none.

    All values and derivatives come from the tape where there is one, compiled and exact.
    Otherwise F' comes from ``jacobian``: (n,) -> (m, n), dense or sparse, where given,
    else by complex step or by central differences; ``derivatives`` says which.
    """

    def __init__(
        self,
        function: Callable[[np.ndarray], Sequence[float] | np.ndarray],
        jacobian: Callable[[np.ndarray], np.ndarray | sparray] | None,
        recording: Recording = NOT_RECORDED,
        rows: int = 0,
    ):
        self._function = function
        self._jacobian = jacobian
        self.recording = recording
        self._rows = rows
        self.noise = np.zeros(rows)
        self._step_of_differences = DIFFERENCE_STEP

    def _take_noise(self, noise: np.ndarray, unit: float | np.ndarray) -> None:
        """Take the values of the function to be noisy (m,), in a ``unit`` of them: what
        is within `SOLVED_IN_NOISE` of that is zero, and differences take longer steps."""
        self.noise = noise
        self.noise_share = float((noise / unit).max())
        longer = self.noise_share ** (1.0 / 3.0)
        self._step_of_differences = max(DIFFERENCE_STEP, longer)
        of_slopes = self.noise_share / self._step_of_differences
        self._step_of_hessian = max(HESSIAN_STEP, of_slopes ** (1.0 / 3.0))

    def _take_magnitude(
        self, magnitude: float, region: np.ndarray | None = None
    ) -> None:
        """Take F' to be of this ``magnitude``; solutions are looked for in a ``region``
        (n, 2), that of the bounds unless given."""
        self.magnitude = magnitude
        tape = self.recording.tape
        if tape is not None:
            self.hessian_error = EXACT_HESSIAN
            self.is_exact = True
            self.scaled_tape = ScaledTape(
                tape, magnitude, self.scale, self.bounds, self.periods, region
            )

    # --- values and derivatives -------------------------------------------------------

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        points = np.atleast_2d(points)
        if self.scaled_tape is not None:
            return self.scaled_tape.residuals(points)
        function = self._function  # called thousands of times a curve
        with np.errstate(all="ignore"):  # beyond the rim of where it is defined
            values = [function(point) for point in points]
        exact = np.array(values, dtype=float).reshape(len(points), self._rows)
        if not np.any(self.noise):
            return exact
        floor = SOLVED_IN_NOISE * self.noise
        beyond: np.ndarray = exact - np.clip(exact, -floor, floor)
        return beyond

    def jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,), sparse where the given ``jacobian`` makes it so,
        or the recording of many unknowns."""
        if self.scaled_tape is not None:
            return super().jacobian(point)
        if self._jacobian is not None:
            return self._given_jacobian(point)
        with np.errstate(all="ignore"):
            if self.derivatives == "complex step":
                return self._complex_step(point)
            return self._central_difference(point)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n), dense."""
        points = np.atleast_2d(points)
        if self.scaled_tape is not None:
            return self.scaled_tape.jacobians(points)
        jacobians = [as_dense(self.jacobian(point)) for point in points]
        return np.array(jacobians).reshape(len(points), self._rows, self.n)

    def coefficient_rounding(self, point: np.ndarray) -> np.ndarray:
        """How far off F (m,) at a point (n,) is where its coefficients are rounded to
        doubles; 0 where it is not recorded."""
        tape = self.recording.tape
        if tape is None:
            return super().coefficient_rounding(point)
        return rounding_of_constants(tape, point)

    def _given_jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        assert self._jacobian is not None
        jacobian = self._jacobian(point)
        is_sparse = hasattr(jacobian, "tocsc")
        return jacobian if is_sparse else np.asarray(jacobian, dtype=float)

    def _complex_step(self, point: np.ndarray) -> np.ndarray:
        columns = []
        for shifted in point + 1j * COMPLEX_STEP * np.eye(self.n):
            value = np.asarray(self._function(shifted))
            columns.append(np.imag(value) / COMPLEX_STEP)
        return np.column_stack(columns)

    def _central_difference(self, point: np.ndarray) -> np.ndarray:
        columns = []
        for i in range(self.n):
            step = np.zeros(self.n)
            step[i] = self._step_of_differences * (1.0 + abs(point[i]))
            upper = self._value(point + step)
            lower = self._value(point - step)
            width = 2 * step[i]
            columns.append((upper - lower) / width)
        return np.column_stack(columns)

    def _value(self, point: np.ndarray) -> np.ndarray:
        """F (m,) at one point (n,)."""
        return floats_of("value of the function", self._function(point))


class _FirstPoints(NamedTuple):
    """Random ``points`` (k, n) within the bounds, and ``probes`` (j, n) where a function
    has finite values."""

    points: np.ndarray
    probes: np.ndarray


class FunctionProblem(EquationProblem):
    """A problem from a plain Python callable ``function``: (n,) -> (m,).

    The function is called once with arguments that record what is done with them. Where
    that succeeds, and the recording is equal to the function at random points, all
    values and derivatives come from it, compiled and exact; a function that changes
    afterwards is not noticed. `recording` holds it, or the reason why there is none;
    ``is_recorded=False`` does without.

    Otherwise derivatives come from ``jacobian``: (n,) -> (m, n), dense or sparse, where
    given, else by complex step where the function lets complex numbers through, else by
    central differences. ``derivatives`` says which.

    ``bounds`` (n, 2) is the region from which `explore` draws starts and in which
    curves are followed. An unknown with a period among the ``periods`` (n,) is a circle
    where its bounds are one period or more apart, or infinite; bounds that are closer
    are limits on the circle. An unknown without bounds or a period is followed as far
    as a hundred times the size of the solutions that are reached from starts about 0;
    `bounds` holds what was taken. Raises `ProblemError` for bounds out of order, for a function
    that gives no finite vector, for a ``jacobian`` that is not its derivative, and for
    a period that is none of the function.
    """

    def __init__(
        self,
        function: Callable[[np.ndarray], Sequence[float] | np.ndarray],
        bounds: Sequence[Sequence[float]],
        *,
        jacobian: Callable[[np.ndarray], np.ndarray | sparray] | None = None,
        names: Sequence[str] | None = None,
        units: Sequence[str] | None = None,
        periods: Sequence[float] | None = None,
        is_recorded: bool = True,
    ):
        check_callable("function", function)
        if jacobian is not None:
            check_callable("jacobian", jacobian)
        super().__init__(function, jacobian)
        self._set_unknowns(bounds, names, units, periods)
        points, probes = self._first_points()
        self._rows = len(self._value(probes[0]))
        self.noise = np.zeros(self._rows)
        if is_recorded:
            self.recording = record(function, points)
        self._measure_noise(probes)
        self._measure(probes)
        self._check_periods(probes)
        self._settle_open_bounds()

    def _set_unknowns(
        self,
        bounds: Sequence[Sequence[float]],
        names: Sequence[str] | None,
        units: Sequence[str] | None,
        periods: Sequence[float] | None,
    ) -> None:
        """Take the unknowns as the user describes them; raises `ProblemError`."""
        self.bounds = _checked_bounds(bounds)
        n = len(self.bounds)
        default_names = [f"u{i + 1}" for i in range(n)]
        self.names = _checked_texts("names", default_names if names is None else names)
        self.units = _checked_texts("units", [""] * n if units is None else units)
        if len(set(self.names)) < len(self.names):
            raise ProblemError("names", self.names, "all different")
        self.periods = np.full(n, np.inf)
        if periods is not None:
            self.periods = floats_of("periods", periods)
        self._check_lengths(n)
        self.bounds = _without_limits_of_circles(self.bounds, self.periods)
        low, high = self._finite_bounds
        self.scale = float(np.median(high - low)) / 4.0

    @property
    def _finite_bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends (n,); where the bounds are infinite, half a period about
        0, or from -1 to 1, or as far from the other end as that is from 0 and 1 more."""
        low, high = self.bounds.T
        half = np.where(np.isfinite(self.periods), 0.5 * self.periods, 1.0)
        from_high = np.where(np.isfinite(high), np.minimum(-half, 2 * high - 1), -half)
        low = np.where(np.isfinite(low), low, from_high)
        from_low = np.where(np.isfinite(low), np.maximum(half, 2 * low + 1), half)
        return low, np.where(np.isfinite(high), high, from_low)

    def _first_points(self) -> _FirstPoints:
        """Points at which the equations are looked at; many are tried where a function
        is defined on a small part of the bounds only.

        Raises `ProblemError` as `_probes_with_value` does.
        """
        points = self._random_points()
        probes = points[:PROBES]
        with np.errstate(all="ignore"):
            values = [self._value(probe) for probe in probes]
        if any(np.all(np.isfinite(value)) for value in values):
            return _FirstPoints(points, self._probes_with_value(probes))
        trials = self._probes_with_value(self._random_points(MOST_TRIALS))
        return _FirstPoints(trials[: PROBES + CHECKS], trials[:PROBES])

    def _random_points(self, count: int = PROBES + CHECKS) -> np.ndarray:
        """Points (k, n) within the bounds at which the equations are looked at."""
        rng = np.random.default_rng(0)
        low, high = self._finite_bounds
        return rng.uniform(low, high, (count, self.n))

    def _settle_open_bounds(self) -> None:
        """Take the scale of unknowns without bounds or a period, and bounds for them,
        from solutions that are reached from starts about 0."""
        is_open = ~np.isfinite(self.bounds) & ~np.isfinite(self.periods)[:, None]
        if not np.any(is_open):
            return
        size = self._size_of_solutions(is_open.any(axis=1))
        known_ends = self.bounds[np.isfinite(self.bounds) & is_open[:, ::-1]]
        size = max(size, float(np.abs(known_ends).max(initial=0.0)))
        half = np.where(np.isfinite(self.periods), 0.5 * self.periods, size)
        about_zero = half[:, None] * np.array([-1.0, 1.0])
        low, high = np.where(np.isfinite(self.bounds), self.bounds, about_zero).T
        self.scale = float(np.median(high - low)) / 4.0
        self.bounds = np.where(is_open, FARTHEST * about_zero, self.bounds)
        self.has_assumed_bounds = is_open
        rng = np.random.default_rng(0)
        points = rng.uniform(low, high, (PROBES, self.n))
        self._measure(self._probes_with_value(points))

    def _size_of_solutions(self, is_open: np.ndarray) -> float:
        """The typical size of the open unknowns (n,) at solutions, 1 where none are
        found."""
        starts = self._random_points()
        for size in START_SIZES:
            sized = np.where(is_open, size * starts, starts)
            with np.errstate(all="ignore"):
                points, _ = self.project(sized)
            sizes = np.abs(points[:, is_open]).max(axis=1)
            residuals = np.linalg.norm(self.residuals(points), axis=1)
            slopes = np.linalg.norm(self.jacobians(points), axis=(1, 2))
            is_solved = is_solved_from_afar(residuals, slopes * sizes)
            if np.any(is_solved & (sizes > 0.0)):
                return float(np.median(sizes[is_solved]))
        return 1.0

    def _measure(self, probes: np.ndarray) -> None:
        """Choose how F' is made, check it at the probes (k, n), and take its typical
        size."""
        self._take_magnitude(1.0)
        self.equations = str(self.recording)
        if self.noise_share:
            noise = f"{self.noise_share:.1e} of what they change by"
            self.equations += f"; its values are noisy to {noise}"
        with np.errstate(all="ignore"):
            self.derivatives = self._choose_derivatives(probes[0])
        with np.errstate(all="ignore"):
            for probe in probes:
                self._check_jacobian(probe)
            sizes = [_spectral_norm(self.jacobian(probe)) for probe in probes]
        known = [size for size in sizes if math.isfinite(size)]
        if not known:
            allowed = "finite somewhere inside the bounds"
            raise ProblemError("derivative of the function", np.nan, allowed)
        self._take_magnitude(float(np.median(known)) or 1.0)

    def _measure_noise(self, probes: np.ndarray) -> None:
        """See how noisy the values are about the probes (k, n), where they are not
        recorded; raises `ProblemError` where there is too much of it."""
        if self.recording.tape is not None or self.n > LARGEST_COMPARED:
            return
        rng = np.random.default_rng(0)
        with np.errstate(all="ignore"):
            noise = noise_of(self._value, probes[:NOISE_PROBES], self.scale, rng)
            values = np.array([self._value(probe) for probe in probes])
        if noise is None:
            return
        changes = np.ptp(values, axis=0) + np.abs(values).min(axis=0) + TINY
        share = float((noise / changes).max())
        if is_free_of_noise(share):
            return
        if not is_bearable_noise(share):
            allowed = (
                f"at most {is_bearable_noise.threshold:.0e} of what they change by within "
                "the bounds, so that solutions can be told"
            )
            what = "noise of the values of the function"
            raise ProblemError(what, f"{share:.1e}", allowed)
        self._take_noise(noise, changes)

    # --- derivatives ------------------------------------------------------------------

    def _choose_derivatives(self, probe: np.ndarray) -> str:
        """How F' is made: from the recording or as it is given, else by complex step,
        if that agrees with differences at a point.

        A function may also drop imaginary parts without a word.
        """
        if self.scaled_tape is not None:
            return "recorded"
        if self._jacobian is not None:
            return "given"
        try:
            by_complex = self._complex_step(probe)
        except (TypeError, ValueError, np.exceptions.ComplexWarning):
            return "central differences"
        by_difference = self._central_difference(probe)
        if by_complex.shape != by_difference.shape:
            return "central differences"
        error = np.abs(by_complex - by_difference).max()
        size = 1.0 + np.abs(by_difference).max()
        return "complex step" if error < 1e-5 * size else "central differences"

    # --- checks -----------------------------------------------------------------------

    def _check_lengths(self, n: int) -> None:
        """Raise `ProblemError` unless there is a name, a unit and a positive period for
        each unknown."""
        sizes = {
            "names": len(self.names),
            "units": len(self.units),
            "periods": len(self.periods),
        }
        for what, size in sizes.items():
            if size != n:
                raise ProblemError(
                    f"number of {what}", size, f"{n}, the number of bounds"
                )
        if not np.all(self.periods > 0):
            allowed = "positive, inf where an unknown has none"
            raise ProblemError("periods", self.periods.tolist(), allowed)

    def _probes_with_value(self, probes: np.ndarray) -> np.ndarray:
        """Those of the probes (k, n) where the function gives a finite vector.

        Raises `ProblemError` where it gives no vector, vectors of several lengths, or
        none that is finite.
        """
        with np.errstate(all="ignore"):
            values = [self._value(probe) for probe in probes]
        for value in values:
            if value.ndim != 1 or not len(value):
                allowed = "a vector of finite numbers"
                raise ProblemError("value of the function", value, allowed)
        lengths = sorted({len(value) for value in values})
        if len(lengths) > 1:
            allowed = "one number at all points"
            raise ProblemError("number of equations", lengths, allowed)
        is_finite = np.isfinite(values).all(axis=1)
        if not np.any(is_finite):
            allowed = (
                "a vector of finite numbers somewhere inside the bounds; it is at none "
                f"of {len(probes)} random points"
            )
            raise ProblemError("value of the function", values[0], allowed)
        finite: np.ndarray = probes[is_finite]
        return finite

    def _check_periods(self, probes: np.ndarray) -> None:
        """Raise `ProblemError` unless the equations are the same one period on from the
        probes (k, n), but for their signs, or a constant more: that of an equation
        between angles, as u_1 = 2 u_2 is."""
        for i in np.flatnonzero(np.isfinite(self.periods)):
            period = float(self.periods[i])
            shift = np.zeros(self.n)
            shift[i] = period
            with np.errstate(all="ignore"):
                here, there = self.residuals(probes), self.residuals(probes + shift)
                slopes = np.abs(self.jacobians(probes)[:, :, i])
            sizes = np.maximum(np.abs(here), np.abs(there)) + slopes * period + TINY
            change = there - here
            known = np.where(np.isfinite(change), change, np.nan)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # columns without a number
                constant = np.nanmedian(known, axis=0)
            gaps = np.minimum(
                _largest_known(np.abs(change - constant) / sizes),
                _largest_known(np.abs(here + there) / sizes),
            )
            row = int(np.argmax(gaps))
            if is_period(float(gaps[row])):
                continue
            at = int(np.nanargmax(np.abs(known[:, row])))
            allowed = (
                f"a period of the function: equation {row + 1} is "
                f"{here[at, row]:.6g} at {probes[at]} and {there[at, row]:.6g} one "
                "period on"
            )
            raise ProblemError(f"period of {self.names[i]}", period, allowed)

    def _check_jacobian(self, probe: np.ndarray) -> None:
        """Raise `ProblemError` unless F' has its shape and is finite at a probe (n,),
        and agrees with the recording or with differences where it is given."""
        shape = (len(self._value(probe)), self.n)
        jacobian = as_dense(self.jacobian(probe))
        if self._jacobian is not None:
            jacobian = as_dense(self._given_jacobian(probe))
        if jacobian.shape != shape:
            raise ProblemError("shape of the jacobian", jacobian.shape, str(shape))
        if self._jacobian is not None and not np.all(np.isfinite(jacobian)):
            raise ProblemError("jacobian", jacobian, "finite")
        if self._jacobian is None or self.n > LARGEST_COMPARED:
            return
        expected = self._central_difference(probe)
        origin = "by differences"
        if self.scaled_tape is not None:
            expected = self.scaled_tape.jacobians(probe[None])[0]
            origin = "as recorded"
        if not np.all(np.isfinite(expected)):
            return  # at the rim of where the function is defined
        gaps = np.abs(jacobian - expected)
        if not is_derivative(float(gaps.max()), 1.0 + float(np.abs(expected).max())):
            row, column = np.unravel_index(np.argmax(gaps), gaps.shape)
            allowed = (
                f"the derivative of the function, {expected[row, column]:.6g} "
                f"{origin} at {probe}"
            )
            name = f"jacobian[{row}, {column}]"
            raise ProblemError(name, jacobian[row, column], allowed)


def _largest_known(values: np.ndarray) -> np.ndarray:
    """The largest finite number of every column of values (k, m), 0 where there is
    none."""
    known = np.where(np.isfinite(values), values, 0.0)
    largest: np.ndarray = known.max(axis=0)
    return largest


def _checked_bounds(bounds: Sequence[Sequence[float]]) -> np.ndarray:
    """The bounds as an array (n, 2)."""
    checked = floats_of("bounds", bounds)
    allowed = "rows of (low, high) with low < high"
    if checked.ndim != 2 or checked.shape[1] != 2:
        raise ProblemError("bounds", checked.tolist(), allowed)
    low, high = checked.T
    if not np.all(low < high):
        raise ProblemError("bounds", checked.tolist(), allowed)
    return checked


def _without_limits_of_circles(bounds: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """The bounds (n, 2), infinite for unknowns that may go all round their circle."""
    low, high = bounds.T
    periodic = np.isfinite(periods)
    missing = np.full(len(periods), np.inf)
    missing[periodic] = periods[periodic] - (high[periodic] - low[periodic])
    unit = np.where(periodic, periods, 1.0)
    is_circle = periodic & is_whole_circle(missing, unit)
    return np.where(is_circle[:, None], [-np.inf, np.inf], bounds)


def _checked_texts(name: str, texts: Sequence[str]) -> tuple[str, ...]:
    """The ``texts`` as a tuple; raises `ProblemError` for anything but texts."""
    is_row = isinstance(texts, Sequence) and not isinstance(texts, str)
    if not is_row or not all(isinstance(text, str) for text in texts):
        raise ProblemError(name, repr(texts), "texts, one for each unknown")
    return tuple(texts)


def _spectral_norm(matrix: np.ndarray | sparray) -> float:
    """Largest singular value of a dense matrix; for a sparse one the bound sqrt(|A|_1
    |A|_inf)."""
    if isinstance(matrix, np.ndarray):
        return float(np.linalg.norm(matrix, ord=2))
    from scipy.sparse import csc_array

    sizes: np.ndarray | sparray = abs(csc_array(matrix))
    largest_column = sizes.sum(axis=0).max()
    largest_row = sizes.sum(axis=1).max()
    return float(np.sqrt(largest_column * largest_row))
