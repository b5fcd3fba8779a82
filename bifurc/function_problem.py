"""Problems of which nothing is known but F and F', and those from a Python callable."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

import numpy as np

from bifurc.checks import UnknownName, check_callable, check_type, floats_of, name_of
from bifurc.decisions import (
    can_be_followed_in_noise,
    is_bearable_noise,
    is_derivative,
    is_free_of_noise,
    is_period,
    is_plain_in_noise,
    is_solved_from_afar,
    is_whole_circle,
)
from bifurc.domain import Domain
from bifurc.equations.evaluation import Equations, noise_of, sizes_of_rows
from bifurc.equations.recording import Recording, record
from bifurc.equations.smoothed import smoothed
from bifurc.equations.system import CompiledSystem, ScaledTape
from bifurc.equations.tape import Tape
from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.bordered import as_dense
from bifurc.numerics.collocation import PLAIN_RULES, march_by_collocation
from bifurc.numerics.corrector import (
    project_by_least_squares,
    project_to_sphere_by_newton,
)
from bifurc.problem import Problem
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds
from bifurc.system import (
    NO_SHORTCUTS,
    Accuracy,
    March,
    MarchSettings,
    PreciseResidual,
    Shortcuts,
    SphereProjection,
    jacobian_at,
)

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import sparray

Bounds: TypeAlias = Sequence[Sequence[float]] | Mapping[UnknownName, Sequence[float]]

PROBES = 7  # points at which a function is tried out and its derivatives are measured
MOST_TRIALS = (
    2000  # points at which it is tried where it is defined on little of the box
)
CHECKS = 20  # more points at which a recording is compared with the function
LARGEST_COMPARED = 200  # unknowns up to which a given derivative is compared
START_SIZES = (1.0, 1e3, 1e-3, 1e6, 1e-6)  # of starts for unknowns without bounds
FARTHEST = 100.0  # over the size of solutions, bounds where none are given
NOISE_PROBES = 5  # points about which noise is measured
DEVIATIONS = 4.0  # of noise by which the values at one point differ at most, as a rule
HESSIAN_STEP = 1e-5  # third root of rounding: best for central differences of F'
TINY = 1e-300  # keeps what is zero from being divided by
NOT_RECORDED = Recording(None, "not asked for")
# how far off F'' is over a bound on it: an exact one by rounding, and by differences
EXACT_HESSIAN, HESSIAN_ERROR = 1e-14, 1e-6


class NumericalProblem(Problem):
    """A problem that gives its ``domain``, `residuals` and `jacobians`, and nothing else:
    second derivatives by differences, pieces by collocation, solutions by least squares.

    Where it has its equations ``compiled``, these come of that: exact derivatives, pieces
    by Taylor series, and all in compiled code as far as that is fast.
    """

    compiled: CompiledSystem | None = None
    rules = PLAIN_RULES  # of pieces that are made by collocation

    @property
    def shortcuts(self) -> Shortcuts:
        """What compiled code does in one call."""
        return NO_SHORTCUTS if self.compiled is None else self.compiled.shortcuts

    def precise_residual(self) -> PreciseResidual | None:
        """F over mpmath numbers where it is compiled; the constants of a tape are the
        doubles that it computes with. Raises `ValueError` where F is not real."""
        return None if self.compiled is None else self.compiled.precise_residual

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n): exact where they are compiled, else by central
        differences of F'."""
        if self.compiled is not None:
            return self.compiled.hessians(points)
        return np.array([self._hessian_by_differences(point) for point in points])

    def _hessian_by_differences(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,)."""
        size = max(HESSIAN_STEP, self.accuracy.noise ** (2.0 / 9.0))
        steps = size * (1.0 + np.abs(point))
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
        where it is compiled, else by collocation, no more than `AT_ONCE`, as they do not end
        where the curve does."""
        if self.compiled is not None and self.compiled.is_marched:
            return self.compiled.march(start, tangent, settings)
        return march_by_collocation(self, start, tangent, settings, self.rules)

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each, by least squares."""
        if self.compiled is not None and self.compiled.is_marched:
            return self.compiled.project(starts)
        return project_by_least_squares(self, starts)

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions near starts (k, n) at distance ``radius`` from ``center`` (n,), by
        Newton's method."""
        if self.compiled is not None and self.compiled.is_small:
            return self.compiled.project_to_sphere(starts, center, radius)
        return project_to_sphere_by_newton(self, starts, center, radius)

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Solutions reached from ``count`` random starts, or from as many of them as
        there is time for before a ``deadline``."""
        return random_seeds(self, rng, count, deadline=deadline)


class EquationProblem(NumericalProblem):
    """The problem of ``equations``: all values and derivatives come from their tape where
    there is one, compiled and exact."""

    equations: Equations

    def _take_magnitude(
        self, magnitude: float, region: np.ndarray | None = None
    ) -> None:
        """Take F' to be of this ``magnitude``; solutions are looked for in a ``region``
        (n, 2), that of the bounds unless given."""
        self.magnitude = magnitude
        tape = self.equations.tape
        if tape is not None:
            self.compiled = ScaledTape(tape, magnitude, self.domain, region)

    def tapes_on_rims(self) -> Iterable[Tape]:
        """The equations together with each of the rims that end the region."""
        return ()

    @property
    def recording(self) -> Recording:
        """What came of recording the equations."""
        return self.equations.recording

    @property
    def shortcuts(self) -> Shortcuts:
        """What a tape does in one call; F' where it is given as a sparse matrix."""
        if self.compiled is None and self.equations.is_sparse:
            return Shortcuts(jacobian=self.equations.jacobian_as_given)
        return super().shortcuts

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self.equations.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n), dense."""
        return self.equations.jacobians(points)


class _FirstPoints(NamedTuple):
    """Random ``points`` (k, n) within the bounds, and ``probes`` (j, n) where a function
    has finite values."""

    points: np.ndarray
    probes: np.ndarray


@dataclass(frozen=True)
class _OfAllUnknowns:
    """A ``function`` of unknowns (n,) and parameters, each a number, as one of all."""

    function: Callable[..., Any]
    n: int

    def __call__(self, point: np.ndarray) -> Any:
        return self.function(point[: self.n], *point[self.n :])


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
    `bounds` holds what was taken. Bounds, units and periods may be given by the names of
    the unknowns, and a symbol of sympy stands for its name.

    With the bounds of ``parameters`` by their names the function is F(u, p, ...) of
    unknowns u (n,) and one number for each parameter, and so is a ``jacobian``, with
    derivatives (m, n + q) by the unknowns and then the parameters. They are unknowns of
    the problem as the others are, behind these.

    Raises `ProblemError` for bounds out of order, for a function that gives no finite
    vector, for a ``jacobian`` that is not its derivative, and for a period that is none
    of the function.

    >>> import bifurc, numpy as np
    >>> problem = bifurc.FunctionProblem(
    ...     lambda u, p: [p * np.exp(u[0]) - u[0]], {"x": (0, 5)}, parameters={"p": (0, 1)}
    ... )
    >>> str(problem.recording)
    'recorded (3 operations)'
    >>> (fold,) = bifurc.explore(problem, parameter="p").diagram.folds
    >>> fold.u.round(9).tolist()  # at x = 1 and p = 1/e
    [1.0, 0.367879441]
    """

    has_exact_constants = False  # they are the doubles that the function computes with

    def __init__(
        self,
        function: Callable[..., Sequence[float] | np.ndarray],
        bounds: Bounds,
        *,
        parameters: Mapping[UnknownName, Sequence[float]] | None = None,
        jacobian: Callable[..., np.ndarray | sparray] | None = None,
        names: Sequence[UnknownName] | None = None,
        units: Sequence[str] | Mapping[UnknownName, str] | None = None,
        periods: Sequence[float] | Mapping[UnknownName, float] | None = None,
        is_recorded: bool = True,
    ):
        check_callable("function", function)
        if jacobian is not None:
            check_callable("jacobian", jacobian)
        self.domain = _described_domain(bounds, names, units, periods, parameters)
        if parameters:
            n = self.n - len(parameters)
            function = _OfAllUnknowns(function, n)
            jacobian = jacobian and _OfAllUnknowns(jacobian, n)
        self.equations = Equations(function, jacobian, 0, NOT_RECORDED)
        points, probes = self._first_points()
        m = len(self.equations.value(probes[0]))
        recording = self._recorded(points) if is_recorded else NOT_RECORDED
        self.equations = replace(self.equations, m=m, recording=recording)
        self._measure_noise(probes)
        self._measure(probes)
        self._check_periods(probes)
        self._settle_open_bounds()

    def _recorded(self, points: np.ndarray) -> Recording:
        """What came of recording the function, compared with it at points (k, n)."""
        return record(self.equations.function, points)

    def _first_points(self) -> _FirstPoints:
        """Points at which the equations are looked at; many are tried where a function
        is defined on a small part of the bounds only.

        Raises `ProblemError` as `_probes_with_value` does.
        """
        points = self._random_points()
        probes = points[:PROBES]
        with np.errstate(all="ignore"):
            values = [self.equations.value(probe) for probe in probes]
        if any(np.all(np.isfinite(value)) for value in values):
            return _FirstPoints(points, self._probes_with_value(probes))
        trials = self._probes_with_value(self._random_points(MOST_TRIALS))
        return _FirstPoints(trials[: PROBES + CHECKS], trials[:PROBES])

    def _random_points(self, count: int = PROBES + CHECKS) -> np.ndarray:
        """Points (k, n) within the bounds at which the equations are looked at."""
        rng = np.random.default_rng(0)
        low, high = _finite_bounds(self.domain)
        return rng.uniform(low, high, (count, self.n))

    def _settle_open_bounds(self) -> None:
        """Take the scale of unknowns without bounds or a period, and bounds for them,
        from solutions that are reached from starts about 0."""
        bounds, periods = self.domain.bounds, self.domain.periods
        is_open = ~np.isfinite(bounds) & ~np.isfinite(periods)[:, None]
        if not np.any(is_open):
            return
        size = self._size_of_solutions(is_open.any(axis=1))
        known_ends = bounds[np.isfinite(bounds) & is_open[:, ::-1]]
        size = max(size, float(np.abs(known_ends).max(initial=0.0)))
        half = np.where(np.isfinite(periods), 0.5 * periods, size)
        about_zero = half[:, None] * np.array([-1.0, 1.0])
        near = np.where(np.isfinite(bounds), bounds, about_zero)
        self.domain = replace(
            self.domain,
            bounds=np.where(is_open, FARTHEST * about_zero, bounds),
            scale=_quarter_of_width(near),
            has_assumed_bounds=is_open,
        )
        rng = np.random.default_rng(0)
        points = rng.uniform(near[:, 0], near[:, 1], (PROBES, len(near)))
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
        with np.errstate(all="ignore"):
            sizes = _sizes_within(self.domain)
            self.equations = self.equations.with_derivatives_at(probes[0], sizes)
            self.accuracy = accuracy_of(self.equations)
            self._check_jacobian(probes, sizes)
            norms = [_spectral_norm(jacobian_at(self, probe)) for probe in probes]
        if not np.any(np.isfinite(norms)):
            allowed = "finite somewhere inside the bounds"
            raise ProblemError("derivative of the function", np.nan, allowed)
        magnitude = self.equations.typical_size(probes, norms, self.domain.scale)
        self._take_magnitude(magnitude)

    def _measure_noise(self, probes: np.ndarray) -> None:
        """See how noisy the values are about the probes (k, n), where they are not
        recorded; raises `ProblemError` where there is too much of it."""
        if self.equations.tape is not None or self.n > LARGEST_COMPARED:
            return
        rng, value = np.random.default_rng(0), self.equations.value
        sizes = _sizes_within(self.domain)
        with np.errstate(all="ignore"):
            before = np.array([value(probe) for probe in probes])
            noise = noise_of(value, probes[:NOISE_PROBES], sizes, rng)
            values = np.array([value(probe) for probe in probes])
        if noise is not None:
            drift = np.abs(values - before).max(axis=0) / DEVIATIONS
            noise = np.maximum(noise, drift)
        if noise is not None:
            self._live_with(noise, values)

    def _live_with(self, noise: np.ndarray, values: np.ndarray) -> None:
        """Take the equations in ``noise`` (m,) for what can be done with them, given
        ``values`` (k, m); raises `ProblemError` where that is nothing."""
        changes = np.ptp(values, axis=0) + np.abs(values).min(axis=0) + TINY
        share = float((noise / changes).max())
        if is_free_of_noise(share):
            return
        self.equations = replace(self.equations, noise=noise, noise_share=share)
        if is_plain_in_noise(share):
            return
        tape = self._smoothed(noise) if is_bearable_noise(share) else None
        if tape is not None:
            smooth = Recording(tape, "a polynomial next to its values")
            self.equations = replace(self.equations, recording=smooth, noise=None)
        elif not can_be_followed_in_noise(share):
            allowed = (
                f"at most {can_be_followed_in_noise.threshold:.0e} of what they change by "
                f"within the bounds, or {is_bearable_noise.threshold:.0e} where there is a "
                "polynomial next to them, so that solutions can be told"
            )
            what = "noise of the values of the function"
            raise ProblemError(what, f"{share:.1e}", allowed)

    def _smoothed(self, noise: np.ndarray) -> Tape | None:
        """Polynomials next to values that are noisy by ``noise`` (m,), where there are
        some."""
        domain = self.domain
        is_box = np.isfinite(domain.bounds).all() and np.isinf(domain.periods).all()
        if not is_box or self.equations.given_jacobian is not None:
            return None
        return smoothed(self.equations.value, domain.bounds, noise)

    # --- checks -----------------------------------------------------------------------

    def _probes_with_value(self, probes: np.ndarray) -> np.ndarray:
        """Those of the probes (k, n) where the function gives a finite vector.

        Raises `ProblemError` where it gives no vector, vectors of several lengths, or
        none that is finite.
        """
        with np.errstate(all="ignore"):
            values = [self.equations.value(probe) for probe in probes]
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
        return probes[is_finite]

    def _check_periods(self, probes: np.ndarray) -> None:
        """Raise `ProblemError` unless the equations are the same one period on from the
        probes (k, n), but for their signs, or a constant more: that of an equation
        between angles, as u_1 = 2 u_2 is."""
        for i in np.flatnonzero(np.isfinite(self.domain.periods)):
            period = float(self.domain.periods[i])
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
            raise ProblemError(f"period of {self.domain.names[i]}", period, allowed)

    def _check_jacobian(self, probes: np.ndarray, sizes: np.ndarray) -> None:
        """Raise `ProblemError` unless F' has its shape and is finite at the probes (k, n),
        and agrees with the recording or with differences where it is given; the unknowns
        have the ``sizes`` (n,)."""
        if self.equations.given_jacobian is None:
            return
        if self.n > LARGEST_COMPARED:
            for probe in probes:
                self._jacobian_as_given(probe)
            return
        given = [self._jacobian_as_given(probe) for probe in probes]
        values = [self.equations.value(probe) for probe in probes]
        origin, expected = self._jacobians_without_given(probes, sizes)
        is_known = np.isfinite(expected).all(axis=(1, 2))  # else at the rim of F
        if not np.any(is_known):
            return
        rows = sizes_of_rows(sizes * expected[is_known], np.array(values))
        for number in np.flatnonzero(is_known):
            gaps = np.abs(given[number] - expected[number])
            shares = gaps * sizes / rows[:, None]
            if not is_derivative(float(shares.max())):
                row, column = np.unravel_index(np.argmax(shares), shares.shape)
                name = f"jacobian[{row}, {column}]"
                right = f"{expected[number][row, column]:.6g} {origin}"
                allowed = f"the derivative of the function, {right} at {probes[number]}"
                raise ProblemError(name, given[number][row, column], allowed)

    def _jacobians_without_given(
        self, probes: np.ndarray, sizes: np.ndarray
    ) -> tuple[str, np.ndarray]:
        """F' (k, m, n) at the probes (k, n) as recorded, else by differences, and which of
        these."""
        if self.equations.tape is not None:
            return "as recorded", self.jacobians(probes)
        by_differences = self.equations.central_difference
        return "by differences", np.array([by_differences(p, sizes) for p in probes])

    def _jacobian_as_given(self, probe: np.ndarray) -> np.ndarray:
        """F' (m, n) as it is given at a probe (n,); raises `ProblemError` where it has
        another shape, or is not finite."""
        jacobian = as_dense(self.equations.jacobian_as_given(probe))
        shape = (self.equations.m, self.n)
        if jacobian.shape != shape:
            raise ProblemError("shape of the jacobian", jacobian.shape, str(shape))
        if not np.all(np.isfinite(jacobian)):
            raise ProblemError("jacobian", jacobian, "finite")
        return jacobian


def accuracy_of(equations: Equations) -> Accuracy:
    """How exactly the equations are known."""
    is_recorded = equations.tape is not None
    origin = str(equations.recording)
    if equations.noise_share:
        noise = f"{equations.noise_share:.1e} of what they change by"
        origin += f"; its values are noisy to {noise}"
    return Accuracy(
        derivatives=equations.derivatives,
        equations=origin,
        noise=equations.noise_share,
        is_exact=is_recorded and not equations.noise_share,
        coefficient_rounding=equations.coefficient_rounding,
        hessian_error=EXACT_HESSIAN if is_recorded else HESSIAN_ERROR,
    )


# --- the unknowns ---------------------------------------------------------------------


def _described_domain(
    bounds: Bounds,
    names: Sequence[UnknownName] | None,
    units: Sequence[str] | Mapping[UnknownName, str] | None,
    periods: Sequence[float] | Mapping[UnknownName, float] | None,
    parameters: Mapping[UnknownName, Sequence[float]] | None,
) -> Domain:
    """The unknowns as the user describes them, and behind them the parameters; raises
    `ProblemError`."""
    domain = _domain_of_unknowns(bounds, names, units, periods)
    if parameters is not None:
        domain = _with_parameters(domain, parameters)
    if len(set(domain.names)) < len(domain.names):
        raise ProblemError("names", domain.names, "all different")
    finite = np.column_stack(_finite_bounds(domain))
    return replace(domain, scale=_quarter_of_width(finite))


def _domain_of_unknowns(
    bounds: Bounds,
    names: Sequence[UnknownName] | None,
    units: Sequence[str] | Mapping[UnknownName, str] | None,
    periods: Sequence[float] | Mapping[UnknownName, float] | None,
) -> Domain:
    """The unknowns without parameters."""
    if names is None and isinstance(bounds, Mapping):
        names = list(bounds)
    given_names = () if names is None else _checked_texts("names", names)
    ends = _checked_bounds(_in_order("bounds", bounds, given_names))
    n = len(ends)
    own_names = given_names if names is not None else _default_names(n)
    given_units = [""] * n if units is None else units
    own_units = _checked_texts("units", _in_order("units", given_units, own_names, ""))
    given_periods = np.full(n, np.inf) if periods is None else periods
    own_periods = floats_of(
        "periods", _in_order("periods", given_periods, own_names, np.inf)
    )
    sizes = {
        "names": len(own_names),
        "units": len(own_units),
        "periods": len(own_periods),
    }
    for what, size in sizes.items():
        if size != n:
            allowed = f"{n}, the number of bounds"
            raise ProblemError(f"number of {what}", size, allowed)
    if not np.all(own_periods > 0):
        allowed = "positive, inf where an unknown has none"
        raise ProblemError("periods", own_periods.tolist(), allowed)
    ends = _without_limits_of_circles(ends, own_periods)
    return Domain(own_names, own_units, own_periods, ends)


def _with_parameters(
    domain: Domain, parameters: Mapping[UnknownName, Sequence[float]]
) -> Domain:
    """A domain with parameters behind its unknowns, by their names with their bounds."""
    check_type("parameters", parameters, dict)
    if not parameters:
        return domain
    names = _checked_texts("names of the parameters", list(parameters))
    bounds = _checked_bounds(list(parameters.values()), "bounds of the parameters")
    q = len(names)
    return Domain(
        domain.names + names,
        domain.units + ("",) * q,
        np.append(domain.periods, np.full(q, np.inf)),
        np.concatenate([domain.bounds, bounds]),
    )


def _default_names(n: int) -> tuple[str, ...]:
    return tuple(f"u{i + 1}" for i in range(n))


def _in_order(what: str, given: Any, names: Sequence[str], usual: object = None) -> Any:
    """What is ``given`` by the names of unknowns in the order of these, with what is
    ``usual`` for those left out; anything but a dictionary as it is. Raises
    `ProblemError` for a name that is none of them, and for one that must not be left
    out."""
    if not isinstance(given, Mapping):
        return given
    by_name = {name_of(key): value for key, value in given.items()}
    for name in by_name:
        if name not in names:
            allowed = f"one of the unknowns {', '.join(names)}"
            raise ProblemError(what, repr(name), allowed)
    for name in names:
        if name not in by_name and usual is None:
            raise ProblemError(f"{what}[{name!r}]", "missing", "given")
    return [by_name.get(name, usual) for name in names]


def _quarter_of_width(bounds: np.ndarray) -> float:
    """The typical size of unknowns within finite bounds (n, 2)."""
    low, high = bounds.T
    return float(np.median(high - low)) / 4.0


def _sizes_within(domain: Domain) -> np.ndarray:
    """The typical size (n,) of each of the unknowns of a domain."""
    low, high = _finite_bounds(domain)
    sizes: np.ndarray = 0.25 * (high - low)
    return sizes


def _finite_bounds(domain: Domain) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends (n,); where the bounds are infinite, half a period about
    0, or from -1 to 1, or as far from the other end as that is from 0 and 1 more."""
    low, high = domain.bounds.T
    half = np.where(np.isfinite(domain.periods), 0.5 * domain.periods, 1.0)
    from_high = np.where(np.isfinite(high), np.minimum(-half, 2 * high - 1), -half)
    low = np.where(np.isfinite(low), low, from_high)
    from_low = np.where(np.isfinite(low), np.maximum(half, 2 * low + 1), half)
    return low, np.where(np.isfinite(high), high, from_low)


def _largest_known(values: np.ndarray) -> np.ndarray:
    """The largest finite number of every column of values (k, m), 0 where there is
    none."""
    known = np.where(np.isfinite(values), values, 0.0)
    largest: np.ndarray = known.max(axis=0)
    return largest


def _checked_bounds(
    bounds: Sequence[Sequence[float]], what: str = "bounds"
) -> np.ndarray:
    """The bounds as an array (n, 2)."""
    checked = floats_of(what, bounds)
    allowed = "rows of (low, high) with low < high, -inf or inf where there is no bound"
    if checked.ndim != 2 or checked.shape[1] != 2:
        raise ProblemError(what, checked.tolist(), allowed)
    low, high = checked.T
    if not np.all(low < high):
        raise ProblemError(what, checked.tolist(), allowed)
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


def _checked_texts(name: str, given: Sequence[UnknownName]) -> tuple[str, ...]:
    """What is ``given`` as texts; raises `ProblemError` for anything but texts, and symbols
    that stand for them."""
    is_row = isinstance(given, Sequence) and not isinstance(given, str)
    texts = tuple(name_of(one) for one in given) if is_row else ()
    if not is_row or not all(isinstance(text, str) for text in texts):
        raise ProblemError(name, repr(given), "texts, one for each unknown")
    return cast(tuple[str, ...], texts)


def _spectral_norm(matrix: np.ndarray | sparray) -> float:
    """Largest singular value of a dense matrix, nan where it is not finite; for a sparse
    or a large one the bound sqrt(|A|_1 |A|_inf)."""
    if isinstance(matrix, np.ndarray):
        if not np.all(np.isfinite(matrix)):
            return np.nan
        if max(matrix.shape) <= LARGEST_COMPARED:
            return float(np.linalg.norm(matrix, ord=2))
        sizes: np.ndarray | sparray = abs(matrix)
    else:
        from scipy.sparse import csc_array

        sizes = abs(csc_array(matrix))
    largest_column = sizes.sum(axis=0).max()
    largest_row = sizes.sum(axis=1).max()
    return float(np.sqrt(largest_column * largest_row))
