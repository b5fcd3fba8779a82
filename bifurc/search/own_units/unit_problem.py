"""A function's equations in units of their own: what a search works on.

The sizes of the unknowns are those of the region in which solutions are, not those of
the bounds: a curve far smaller than its bounds is looked for about where it is. The
equations count by their gradients there. So a search sees the same numbers whatever the
user's units are; `bifurc.search.own_units.restated` takes its answer back into these.

Large systems, and classes that answer some question in a way of their own, have all
their unknowns counted in one unit, that of their scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

import numpy as np

from bifurc.curves.continuation import trace_branch
from bifurc.decisions import (
    is_factor_of_form,
    is_far_smaller,
    is_flat_equation,
    is_on_the_way,
    is_seen_through_rounding,
    may_repeat_factors,
)
from bifurc.domain import Domain
from bifurc.equations.differentiation import with_gradients
from bifurc.equations.evaluation import Equations
from bifurc.equations.factors import Factors, polynomial_factors, written_factors
from bifurc.equations.polynomials import READINGS, Reading
from bifurc.equations.recording import Recording
from bifurc.equations.rims import NO_RIMS, Rims
from bifurc.equations.system import LARGEST_DENSE
from bifurc.equations.tape import Tape, TapeWriter, real_values
from bifurc.function_problem import (
    PROBES,
    EquationProblem,
    FunctionProblem,
    accuracy_of,
)
from bifurc.limits import (
    CutOff,
    Deadline,
    current_deadline,
    cut_off_after,
    is_time_over,
    made_in_time,
)
from bifurc.numerics.singular_values import values_of
from bifurc.problem import Problem
from bifurc.search.own_units.restated import restated_branch
from bifurc.seeding import random_seeds
from bifurc.seeds import Audit, Seeds
from bifurc.settings import TraceSettings
from bifurc.system import Accuracy, Curvature, PreciseResidual
from bifurc.units import Units

if TYPE_CHECKING:
    import mpmath

    from bifurc.atlas import JsonObject
    from bifurc.branch import Branch

STARTS, STARTS_OF_CALLABLE = 100, 24  # from which it is seen where solutions are
ROUNDS = 40  # in which the region shrinks to them
MARGIN = 0.25  # of what solutions span, on either side of them
CLOSE = 0.5  # share of a region that has shrunk which solutions then span
WIDEST_MIX = 32.0  # sizes that differ by no more are taken for one
# Share of the bounds below which solutions that lie so near to each other are one point.
POINT = 1e-10
OFF_CENTER = 4.0  # widths from zero from which on an unknown is counted from its middle
HIGHEST, MOST_EQUATIONS = 6, 60  # multiplicity that is looked for, and equations
FEWEST = 5  # ends of starts by which a multiplicity is told
FEWEST_FLAT = 2  # of them, where F' is flat, for which factors are looked for
DIGITS = 40
PLACES = np.linspace(0.05, 0.95, 9)  # shares of a form at which factors are evaluated
TINY = 1e-300  # keeps a gradient of zero from being divided by
REGULAR = 1e-6  # smallest regular singular value at an end that is where it belongs
ROUNDING = 1e-14  # all that is left of a singular value that is zero along a curve
OF_CURVES = 1e-4  # the same: at points of higher order where starts stop it is 2e-6
# What a class may answer in its own way: in its own units only, or in any one unit.
OF_EQUATIONS = (
    "residuals",
    "jacobians",
    "shortcuts",
    "march",
    "project",
    "project_to_sphere",
)
OF_ONE_UNIT = ("hessians", "seeds", "curvature")
CURVES = 3  # that are followed out of a region that has shrunk
SAMPLES = 200  # of each of them
WAY_OUT = 1e5  # scales that it is followed for
BEYOND = 0.5  # widths of the region by which it then leaves it
OUTER = 0.1  # share of the ends of starts that may lie elsewhere than the rest


class Simplified(NamedTuple):
    """Equations with the solutions of those of a user and a smaller multiplicity: on the
    ``tape`` in place of F stand its different ``factors``, each once, and after them the
    derivatives that vanish with all of them, up to an ``order`` of derivation less
    one."""

    tape: Tape
    factors: Factors
    order: int = 1


class UnitProblem(EquationProblem):
    """The equations of a function in ``units``, with solutions looked for in the
    ``region`` (n, 2) besides the bounds of the ``problem``; both in the user's units.
    Without a region the scale and the magnitude are those of the problem, whose units
    then have one size.

    Where solutions are multiple ones, the equations are the ``simplified`` ones.
    """

    def __init__(
        self,
        problem: FunctionProblem,
        units: Units,
        region: np.ndarray | None = None,
        simplified: Simplified | None = None,
    ):
        self.problem = problem
        self.simplified = simplified
        self.own_units = units
        self.tape = problem.equations.tape if simplified is None else simplified.tape
        self.equations = problem.equations.in_units(units, self.tape)
        own_region = _first_region(problem) if region is None else region
        self.region = units.inwards(own_region.T).T
        size = float(units.sizes[0])
        scale = problem.domain.scale / size
        if region is not None:
            scale = float(np.median(np.diff(self.region, axis=1))) / 4.0
        self.domain = self._own_domain(scale)
        self.accuracy = self._own_accuracy()
        magnitude = size * problem.magnitude
        if region is not None:
            points, matrices = self._matrices()
            sizes = [float(np.linalg.norm(matrix, ord=2)) for matrix in matrices]
            magnitude = self.equations.typical_size(points, sizes, scale)
        self._take_magnitude(magnitude, self.region)

    def _own_domain(self, scale: float) -> Domain:
        """The domain of the problem in these units. Curves may go on far beyond the
        region to which random starts lead: up to a quarter of the widest bounds."""
        outer, units = self.problem.domain, self.own_units
        bounds = units.inwards(outer.bounds.T).T
        widths = np.diff(bounds, axis=1)[:, 0]
        widest = float(widths[np.isfinite(widths)].max(initial=0.0))
        return replace(
            outer,
            periods=outer.periods / units.sizes,
            bounds=bounds,
            scale=scale,
            reach=max(1.0, widest / 4.0 / scale),
            rim=self._beyond_rims if self._rims else None,
        )

    @property
    def _rims(self) -> Rims:
        """The rims of the user's equations that the simplified ones do not have."""
        return NO_RIMS if self.simplified is None else self.simplified.factors.rims

    def _depths(self, points: np.ndarray) -> np.ndarray:
        """How far inside every rim (k, r) points (k, n) are."""
        return self._rims.depths(self.own_units.outwards(points), self.own_units.sizes)

    def _beyond_rims(self, points: np.ndarray) -> np.ndarray:
        """How far beyond a rim (k,) points (k, n) are; some are not defined beyond
        others."""
        beyond: np.ndarray = -np.fmin.reduce(self._depths(points), axis=1)
        return np.where(np.isnan(beyond), -np.inf, beyond)

    def tapes_on_rims(self) -> Iterator[Tape]:
        """The equations together with each of the rims, in these units."""
        tape = self.equations.tape
        if tape is None or self._rims.tape is None:
            return
        units = self.own_units
        ones = np.ones(self._rims.tape.m)
        rims = self._rims.tape.in_units(units.origin, units.sizes, ones)
        writer = TapeWriter(self.n)
        of_equations, of_rims = tape.write_on(writer), rims.write_on(writer)
        outputs = [of_equations[slot] for slot in tape.outputs.tolist()]
        for slot in rims.outputs.tolist():
            yield writer.tape([*outputs, of_rims[slot]])

    def labels_along(self, branch: Branch) -> JsonObject:
        """What is to be said of a ``branch`` in these units besides: the rims on which
        it lies."""
        if not self._rims:
            return {}
        depths = np.abs(self._depths(branch(branch.length * PLACES)))
        distances = np.median(depths, axis=0).tolist()
        texts = self._rims.texts(self.domain.names)
        scale = self.domain.scale
        on = [
            text
            for distance, text in zip(distances, texts, strict=True)
            if is_factor_of_form(distance, scale)
        ]
        return {"rims": on} if on else {}

    def _own_accuracy(self) -> Accuracy:
        """What is known of the accuracy of these equations, from that of the problem."""
        outer, units = self.problem.accuracy, self.own_units
        own = accuracy_of(self.equations)
        rounding = own.coefficient_rounding
        outer_rounding = outer.coefficient_rounding
        if self.simplified is None and outer_rounding is not None:

            def rounding(point: np.ndarray) -> np.ndarray:
                own: np.ndarray = units.weights * outer_rounding(units.outwards(point))
                return own

        has_own_hessian = _has_own(self.problem, "hessians")
        return replace(
            own,
            derivatives=outer.derivatives,
            equations=outer.equations,
            coefficient_rounding=rounding,
            hessian_error=outer.hessian_error if has_own_hessian else own.hessian_error,
        )

    def multiplicity_along(self, branch: Branch) -> int:
        """How often the user's equations are solved all along a ``branch`` in these
        units: the product over them of the powers of the factors that vanish there, 1
        where they are independent there all the same."""
        if self.simplified is None or self._are_independent_along(branch):
            return 1
        return self.simplified.order * math.prod(self._powers_along(branch).values())

    def _are_independent_along(self, branch: Branch) -> bool:
        """Whether the user's equations have rank n - 1 along a ``branch`` in these
        units, but for singular points: two factors of one vanish there, say, and others
        tell its place."""
        points = self.own_units.outwards(branch(branch.length * PLACES))
        matrices = self.problem.equations.jacobians(points) * self.own_units.sizes
        anywhere = self.own_units.outwards(self._matrices()[0])
        others = self.problem.equations.jacobians(anywhere) * self.own_units.sizes
        rows = np.median(np.linalg.norm(others, axis=2), axis=0)
        values = values_of(matrices / (rows[:, None] + TINY))
        if values.shape[1] < self.n - 1:
            return False
        return bool(np.median(values[:, self.n - 2]) > REGULAR)

    def _powers_along(self, branch: Branch) -> dict[int, int]:
        """The sum of the powers of the factors that vanish all along a ``branch`` in
        these units, by their equation."""
        assert self.simplified is not None
        factors = self.simplified.factors
        places = branch(branch.length * PLACES)
        points = np.ascontiguousarray(self.own_units.outwards(places))
        values = np.abs(factors.tape.compiled.residuals(points))
        slopes = factors.tape.compiled.jacobians(points) * self.own_units.sizes
        lengths = np.linalg.norm(slopes, axis=2)
        distances = np.median(values / (lengths + TINY), axis=0)  # (k,)
        powers: dict[int, int] = {}
        for number, row in enumerate(factors.rows):
            if is_factor_of_form(float(distances[number]), self.domain.scale):
                powers[row] = powers.get(row, 0) + factors.powers[number]
        return powers

    def sheets_beside(self, branch: Branch, rank: int) -> float:
        """How far from each other, over the scale, several curves would be that were taken
        for one, a ``branch`` in these units along which equations are zero with their
        derivatives, or F' has a lower ``rank`` than n - 1; 0 where there are none.

        It is what the user's equations miss along it in the directions in which F' does
        not change them, in many digits and with their numbers as decimals, or no less
        than rounding where they are not recorded.
        """
        lost = self.n - 1 - rank
        if lost > 1 or (lost == 0 and self.multiplicity_along(branch) == 1):
            return 0.0
        points = self.own_units.outwards(branch(branch.length * PLACES[::4]))
        tape, orders = self._multiple_equations(branch)
        equations = replace(self.problem.equations, recording=Recording(tape))
        scale = self.problem.domain.scale
        anywhere = self.own_units.outwards(self._matrices()[0])
        slopes = np.linalg.norm(equations.jacobians(anywhere), axis=2)
        is_defined = np.isfinite(slopes).all(axis=1)
        units = np.median(slopes[is_defined], axis=0) * scale + TINY
        missed = self._missed(equations, points) / units
        matrices = equations.jacobians(points) * scale / units[:, None]
        is_defined = np.isfinite(matrices).all(axis=(1, 2))
        orders = (lost + 1) * orders
        return _unseen(missed[is_defined], matrices[is_defined], orders)

    def _multiple_equations(self, branch: Branch) -> tuple[Tape | None, np.ndarray]:
        """The user's equations, or where these have roots their factors, and the powers
        (m,) of what vanishes all along a ``branch`` in each."""
        tape = self.problem.equations.tape
        if self.simplified is None:
            return tape, np.ones(self.problem.equations.m, dtype=int)
        powers = self._powers_along(branch)
        if tape is None or not self.simplified.factors.are_plain:
            tape, powers = self.simplified.factors.radical(), {}
        order = self.simplified.order
        return tape, np.array([order * powers.get(row, 1) for row in range(tape.m)])

    def _missed(self, equations: Equations, points: np.ndarray) -> np.ndarray:
        """By how much user's ``equations`` miss zero (k, m) at points (k, n)."""
        tape = equations.tape
        if tape is None:
            floor = np.finfo(float).eps * self.problem.magnitude
            missed: np.ndarray = np.maximum(np.abs(equations.residuals(points)), floor)
            return missed
        precise = self.problem.precise_residual()
        is_given = tape is self.problem.equations.tape
        if is_given and self.problem.has_exact_constants and precise is not None:
            return _in_many_digits(precise, points, tape.m)
        import mpmath  # it takes longer to import than a small problem to solve

        def over(reading: Reading) -> PreciseResidual:
            def number_of(constant: float) -> mpmath.mpf:
                ratio = reading(constant)
                return mpmath.mpf(ratio.numerator) / ratio.denominator

            return partial(tape.over, library=mpmath, number_of=number_of)

        read = [_in_many_digits(over(one), points, tape.m) for one in READINGS]
        nearest = np.argmin([np.abs(values).max(axis=0) for values in read], axis=0)
        return np.array(np.choose(nearest, read))

    def _matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Random points (k, n) of the region where F' is finite, and F' (k, m, n)."""
        rng = np.random.default_rng(0)
        points = rng.uniform(self.region[:, 0], self.region[:, 1], (PROBES, self.n))
        with np.errstate(all="ignore"):
            matrices = self.jacobians(points)
        is_finite = np.isfinite(matrices).all(axis=(1, 2))
        return points[is_finite], matrices[is_finite]

    def precise_residual(self) -> PreciseResidual | None:
        """F over mpmath numbers, from that of the user's problem."""
        if self.simplified is not None:
            return super().precise_residual()
        precise = self.problem.precise_residual()
        if precise is None:
            return None
        units = self.own_units

        def residual(unknowns: Sequence[mpmath.mpf]) -> list[mpmath.mpf]:
            pairs = zip(units.origin, units.sizes, unknowns, strict=True)
            restated = [float(c) + float(d) * v for c, d, v in pairs]
            values = precise(restated)
            weights = units.weights.tolist()
            return [w * value for w, value in zip(weights, values, strict=True)]

        return residual

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""
        if not _has_own(self.problem, "hessians"):
            return super().hessians(points)
        units = self.own_units
        by_sizes = units.sizes[:, None] * units.sizes
        own = self.problem.hessians(units.outwards(points))
        hessians: np.ndarray = units.weights[:, None, None] * by_sizes * own
        return hessians

    @property
    def curvature(self) -> Curvature | None:
        """Bounds on F'', where the problem has them."""
        outer = self.problem.curvature
        if outer is None:
            return None
        size = float(self.own_units.sizes[0])
        return Curvature(
            bound=size * outer.bound,
            at_complex_points=lambda reach: (
                size * outer.at_complex_points(size * reach)
            ),
            residual=outer.residual / size,
        )

    # --- seeds ------------------------------------------------------------------------

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Solutions reached from ``count`` random starts, half of them from the region
        where that is smaller than the bounds, as far as there is time for them before the
        ``deadline``; or those that the problem has in a way of its own."""
        if _has_own(self.problem, "seeds"):
            return self.seeds_inwards(self.problem.seeds(rng, count, deadline))
        # the bounds, and on a circle the region
        bounds = self.domain.bounds
        box = np.where(np.isinf(bounds), self.region, bounds)
        if np.allclose(box, self.region):
            return random_seeds(self, rng, count, self.region, deadline)
        near = random_seeds(self, rng, count - count // 2, self.region, deadline)
        anywhere = random_seeds(self, rng, count // 2, box, deadline)
        return near.and_random(anywhere)

    def seeds_inwards(self, seeds: Seeds) -> Seeds:
        """Seeds of the user in these units; an audit of theirs, and what shifts
        curves, see the user's."""
        units, judge = self.own_units, seeds.audit

        def audit(branches: Sequence[Branch], seconds: float) -> Audit:
            assert judge is not None
            periods = self.problem.domain.periods
            own = [restated_branch(one, units, periods).branch for one in branches]
            verdict = judge(own, seconds)
            return replace(verdict, starts=units.inwards(verdict.starts))

        def home(samples: np.ndarray) -> np.ndarray:
            assert seeds.home is not None
            return np.asarray(seeds.home(units.outwards(samples)) / units.sizes)

        def more(rng: np.random.Generator, count: int, deadline: Deadline) -> Seeds:
            assert seeds.more is not None
            return self.seeds_inwards(seeds.more(rng, count, deadline))

        return replace(
            seeds,
            points=units.inwards(seeds.points),
            gaps=seeds.gaps * self.problem.magnitude / self.magnitude,
            missed=units.inwards(seeds.missed),
            audit=None if judge is None else audit,
            home=None if seeds.home is None else home,
            more=None if seeds.more is None else more,
        )

    @property
    def is_blurred(self) -> bool:
        """Whether rounding of an equation hides its solutions in the region."""
        tape = self.equations.tape
        if tape is None:
            return False
        rng = np.random.default_rng(0)
        points = rng.uniform(self.region[:, 0], self.region[:, 1], (PROBES, self.n))
        low, high = tape.compiled.value_bounds(points, points)
        largest = np.nanmax(np.maximum(np.abs(low), np.abs(high)), axis=0)
        rounding = np.nanmedian(high - low, axis=0)
        return not np.all(is_seen_through_rounding(rounding, largest + TINY))

    def ends(self, count: int) -> np.ndarray:
        """Points (k, n), in the user's units, at which ``count`` random starts in the
        region end: solutions, or where most reach none points on the way to them; of
        fewer starts where the time is over before."""
        ends = self.all_ends(count)
        sharp = self._is_sharp(ends)
        if 2 * np.count_nonzero(sharp) > len(ends):
            ends = ends[sharp]
        return self.own_units.outwards(ends)

    def all_ends(self, count: int) -> np.ndarray:
        """The same in these units, also those beside others that are far from
        singular."""
        rng = np.random.default_rng(1)
        seeds = random_seeds(self, rng, count, self.region)
        near = seeds.missed[is_on_the_way(seeds.gaps)]
        if len(seeds.points) > len(near):
            near = near[:0]
        return np.concatenate([seeds.points, near])

    def _is_sharp(self, points: np.ndarray) -> np.ndarray:
        """Which of the ends (k, n) of starts are far from singular, and so where they
        belong; others are spread by what a residual leaves open."""
        if not len(points) or self.n < 2:
            return np.ones(len(points), dtype=bool)
        values = values_of(self.jacobians(points))
        if values.shape[1] < self.n - 1:
            return np.zeros(len(points), dtype=bool)
        return values[:, self.n - 2] > REGULAR * self.magnitude


def in_own_units(problem: Problem) -> UnitProblem | None:
    """The equations of a function in units of their own; None for any other problem,
    and where they are in such units as they stand. What is not known of their solutions
    when the time is over does not count."""
    if not is_of_equations(problem) or problem.domain.rim is not None:
        return None
    own = None
    if has_no_own_answers(problem) and problem.n <= LARGEST_DENSE:
        own = _in_units_of_solutions(problem)
    if own is None:
        own = made_in_time(lambda: _in_one_unit(problem, _unit_of(problem)))
    if own is None:
        return None
    units = own.own_units
    has_gained = np.any(units.origin) or own.simplified is not None
    has_sizes = np.any(units.sizes != 1.0) or np.any(units.weights != 1.0)
    return own if has_gained or has_sizes or _unit_of(problem) != 1.0 else None


def sheets_beside(problem: Problem, branch: Branch, rank: int) -> float:
    """`UnitProblem.sheets_beside` of any problem; 0 where it is none of equations."""
    if isinstance(problem, UnitProblem):
        return problem.sheets_beside(branch, rank)
    if not is_of_equations(problem):
        return 0.0
    return _in_one_unit(problem, 1.0).sheets_beside(branch, rank)


def _in_many_digits(precise: PreciseResidual, points: np.ndarray, m: int) -> np.ndarray:
    """F (k, m) at points (k, n) by a ``precise`` residual; 0 where it is not real, at
    points that rounding takes beyond a rim."""
    import mpmath  # it takes longer to import than a small problem to solve

    values = np.zeros((len(points), m))
    with mpmath.workdps(DIGITS):
        for row, point in zip(values, points, strict=True):
            unknowns = [mpmath.mpf(float(x)) for x in point]
            with suppress(ValueError):
                row[:] = [float(value) for value in real_values(precise(unknowns))]
    return values


def _unseen(missed: np.ndarray, matrices: np.ndarray, orders: np.ndarray) -> float:
    """How far from a curve solutions are by what equations miss (k, m) at its points, in
    the directions in which F' (k, m, n) does not change them; the ``orders`` (m,) are
    the powers of the distance that they grow with."""
    is_finite = np.isfinite(matrices).all(axis=(1, 2))
    left, sigma, _ = np.linalg.svd(matrices[is_finite])
    largest = 0.0
    for values, vectors, sizes in zip(
        missed[is_finite], left.swapaxes(1, 2), sigma, strict=True
    ):
        is_flat = np.ones(len(vectors), dtype=bool)
        is_flat[: len(sizes)] = is_flat_equation(sizes)
        for vector in vectors[is_flat]:
            order = orders[np.abs(vector).argmax()]
            largest = max(largest, float(abs(vector @ values) ** (1.0 / order)))
    return largest


def is_of_equations(problem: Problem) -> TypeGuard[FunctionProblem]:
    """Whether a problem is the equations of a function, and nothing else."""
    return isinstance(problem, FunctionProblem) and not any(
        _has_own(problem, name) for name in OF_EQUATIONS
    )


def has_no_own_answers(problem: FunctionProblem) -> bool:
    """Whether a class of equations answers nothing about them in a way of its own."""
    return not any(_has_own(problem, name) for name in OF_ONE_UNIT)


def _in_one_unit(problem: FunctionProblem, unit: float) -> UnitProblem:
    """The equations with all unknowns counted in one unit."""
    sizes, weights = np.full(problem.n, unit), np.ones(problem.equations.m)
    return UnitProblem(problem, Units(np.zeros(problem.n), sizes, weights))


def _has_own(problem: FunctionProblem, name: str) -> bool:
    """Whether the class of a problem has a method of its own of this ``name``."""
    return getattr(type(problem), name) is not getattr(FunctionProblem, name)


def _unit_of(problem: FunctionProblem) -> float:
    """The power of 2 next to the scale."""
    return float(2.0 ** round(math.log2(problem.domain.scale)))


def _in_units_of_solutions(problem: FunctionProblem) -> UnitProblem | None:
    """The equations in units of the region where random starts end, as far as that is
    known when the time is over; None where nothing is known by then."""
    known: UnitProblem | None = None
    try:
        with cut_off_after(current_deadline()):
            for own in _closer_and_closer(problem):
                known = own
                if is_time_over():
                    break
    except CutOff:
        pass
    return known


def _closer_and_closer(problem: FunctionProblem) -> Iterator[UnitProblem]:
    """The equations in units of the region where random starts end, each time closer to
    what they are in the end."""
    whole = _first_region(problem)
    region, is_point = whole, np.zeros(problem.n, bool)
    count = STARTS if problem.recording.tape else STARTS_OF_CALLABLE
    simplified = _with_written_factors(problem)
    own = _problem_on(problem, region, simplified)
    for _ in range(ROUNDS):
        yield own
        closer = _region_of(problem, own.ends(count), region, is_point)
        if closer is None:
            break
        if simplified is None and region is whole:
            # starts seem to shrink to a line along which an equation is a square
            simplified = _with_repeated_factors(own)
            if simplified is not None:
                own = _problem_on(problem, region, simplified)
                continue
        # what shrinks without end is a point, and looked at from where it is
        is_point |= _is_point(closer, whole)
        closer = np.where(is_point[:, None], whole, closer)
        there = _problem_on(problem, closer, simplified)
        if there.is_blurred:
            break
        region, own = closer, there
    else:
        own = _problem_on(problem, whole, simplified)
    if not np.array_equal(region, whole):
        region = _widened(own, region, is_point)
        own = _problem_on(problem, region, simplified)
        yield own
    own = _deflated(own)
    # what a residual leaves open about a multiple solution is smaller than any curve
    if not np.array_equal(region, whole) and not _has_curves(own, ROUNDING):
        own = _deflated(_problem_on(problem, whole, simplified))
    yield own


def _is_point(region: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Which unknowns (n,) a ``region`` (n, 2) of the ``whole`` has only one value of."""
    extents = np.maximum(np.diff(whole, axis=1)[:, 0], np.abs(region).max(axis=1))
    is_point: np.ndarray = np.diff(region, axis=1)[:, 0] < POINT * extents
    return is_point


def in_one_size(own: UnitProblem) -> UnitProblem:
    """The same in units in which all unknowns have one size."""
    size = float(np.exp2(np.round(np.median(np.log2(own.own_units.sizes)))))
    sizes = np.full(own.n, size)
    units = replace(own.own_units, sizes=sizes)
    region = own.own_units.outwards(own.region.T).T
    return UnitProblem(own.problem, units, region, own.simplified)


# --- where solutions are --------------------------------------------------------------


def _first_region(problem: Problem) -> np.ndarray:
    """The bounds (n, 2), those of one period on a circle."""
    is_circle = np.isinf(problem.domain.bounds).all(axis=1)
    low, high = np.where(is_circle[:, None], 0.0, problem.domain.bounds).T
    middles = 0.5 * (low + high)
    half = 0.5 * np.where(is_circle, problem.domain.periods, high - low)
    return np.column_stack([middles - half, middles + half])


def _region_of(
    problem: Problem, ends: np.ndarray, region: np.ndarray, is_point: np.ndarray
) -> np.ndarray | None:
    """The part of a ``region`` (n, 2) that holds the ``ends`` (k, n) of starts, where
    that is far smaller; None where it is not. The unknowns that are a point (n,) are
    left as they are."""
    if not len(ends):
        return None
    widths = np.diff(region, axis=1)[:, 0]
    low, high = ends.min(axis=0), ends.max(axis=0)
    spans = high - low
    whole = np.diff(_first_region(problem), axis=1)[:, 0]
    is_free = ~np.isfinite(problem.domain.periods) & ~is_point
    # what has shrunk already is fitted closely, or sizes would differ by the last round
    is_shrunk = widths < 0.5 * whole
    unit = np.where(is_shrunk, CLOSE / is_far_smaller.threshold, 1.0)
    is_constant = spans <= POINT * np.maximum(widths, np.abs(ends).max(axis=0))
    is_small = is_free & is_far_smaller(spans, unit * widths) & ~is_constant
    if not np.any(is_small):
        return None
    margins = MARGIN * spans
    closer = np.column_stack([low - margins, high + margins])
    closer = np.clip(closer, problem.domain.bounds[:, :1], problem.domain.bounds[:, 1:])
    return np.where(is_small[:, None], closer, region)


def _widened(own: UnitProblem, region: np.ndarray, is_point: np.ndarray) -> np.ndarray:
    """A ``region`` (n, 2) that has shrunk, or more of the bounds in the unknowns in
    which curves through it leave it: random starts may end on a small part of a long
    curve only. The unknowns that are a point (n,) are left as they are."""
    finite = np.isfinite(own.problem.domain.bounds).all(axis=1)
    settings = TraceSettings(max_length=WAY_OUT)
    for start in own.ends(STARTS)[:CURVES]:
        branch = trace_branch(own, own.own_units.inwards(start), settings=settings)
        if not len(branch.pieces):
            continue
        samples = own.own_units.outwards(branch.sample(SAMPLES))
        low, high = samples.min(axis=0), samples.max(axis=0)
        widths = np.diff(region, axis=1)[:, 0]
        leaves = np.maximum(region[:, 0] - low, high - region[:, 1]) > BEYOND * widths
        is_wider = leaves & finite & ~is_point
        hull = np.column_stack(
            [np.minimum(region[:, 0], low), np.maximum(region[:, 1], high)]
        )
        region = np.where(is_wider[:, None], hull, region)
    return region


# --- multiplicity ---------------------------------------------------------------------


def _with_written_factors(problem: FunctionProblem) -> Simplified | None:
    """The equations with every factor once, and without roots that are zero; None where
    they are written so, and where they are not recorded."""
    tape = problem.recording.tape
    if tape is None or problem.n < 2:
        return None
    factors = written_factors(tape)
    if not factors.are_plain:
        # what a root leaves may be a square, along which starts seem to shrink to a point
        rows = sorted(set(factors.rows))
        region = _first_region(problem)
        factors = polynomial_factors(tape, rows, region)
    return Simplified(factors.radical(), factors) if factors.are_simpler else None


def _deflated(own: UnitProblem) -> UnitProblem:
    """The same without what is left of multiplicity: polynomials whose gradients vanish
    at some solutions by their different factors, and with the derivatives of the
    equations whose gradients still vanish at all solutions, where that leaves curves of
    full rank."""
    flatness = _flatness(own)
    factors = _factors_where_flat(own, flatness)
    if factors is None:
        return own
    region = own.own_units.outwards(own.region.T).T
    if factors.are_simpler:
        simplified = Simplified(factors.radical(), factors)
        own = _problem_on(own.problem, region, simplified)
        flatness = _flatness(own)
    return _with_derivatives(own, factors, flatness)


def _with_repeated_factors(own: UnitProblem) -> Simplified | None:
    """The equations with every factor once; None where none is repeated that is seen."""
    factors = _factors_where_flat(own, _flatness(own))
    if factors is None or not factors.are_simpler:
        return None
    return Simplified(factors.radical(), factors)


def _factors_where_flat(own: UnitProblem, flatness: np.ndarray) -> Factors | None:
    """The factors of the equations, by the ``flatness`` (k, m) of these; None where none
    is flat at several solutions."""
    tape = own.problem.recording.tape
    is_flat = may_repeat_factors(flatness)
    rows = np.flatnonzero(np.count_nonzero(is_flat, axis=0) >= FEWEST_FLAT)
    if tape is None or not len(rows):
        return None
    region = own.own_units.outwards(own.region.T).T
    return polynomial_factors(tape, rows.tolist(), region)


def _with_derivatives(
    own: UnitProblem, factors: Factors, flatness: np.ndarray
) -> UnitProblem:
    """The same with the derivatives of the equations whose gradients vanish at all
    solutions, where that leaves curves of full rank; the ``flatness`` (k, m) is that of
    its equations, and the ``factors`` are those that they are made of."""
    assert own.tape is not None
    region = own.own_units.outwards(own.region.T).T
    tape, deflated = own.tape, own
    begin, order = 0, 1
    while order < HIGHEST and tape.m <= MOST_EQUATIONS:
        if not len(flatness):
            break
        rule = np.quantile(flatness[:, begin:], 1.0 - OUTER, axis=0)
        flat = (begin + np.flatnonzero(is_flat_equation(rule))).tolist()
        if not flat:
            break
        begin = tape.m
        tape = with_gradients(tape, flat)
        order += 1
        simplified = Simplified(tape, factors, order)
        deflated = _problem_on(own.problem, region, simplified)
        flatness = _flatness(deflated)
    return deflated if order > 1 and _has_curves(deflated) else own


def _flatness(own: UnitProblem) -> np.ndarray:
    """Lengths (k, m) of the gradients of the equations where random starts end, over
    those elsewhere; k is 0 where too few end anywhere, and of what is not recorded."""
    if own.tape is None or own.n < 2:
        return np.empty((0, own.equations.m))
    ends = own.all_ends(STARTS)
    _, typical = own._matrices()
    if len(ends) < FEWEST or not len(typical):
        return np.empty((0, own.equations.m))
    usual = np.median(np.linalg.norm(typical, axis=2), axis=0)
    lengths = np.linalg.norm(own.jacobians(ends), axis=2)
    # an equation that is constant everywhere is not flat at solutions in particular
    return np.where(usual > 0.0, lengths / (usual + TINY), np.inf)


def _has_curves(own: UnitProblem, zero: float = OF_CURVES) -> bool:
    """Whether the solutions that random starts reach lie on curves of full rank, as a
    rule; where there are fewer equations, on components of their full rank. A singular
    value over the smallest regular one is ``zero`` below that."""
    seeds = random_seeds(own, np.random.default_rng(1), STARTS, own.region)
    if len(seeds.points) < FEWEST:
        return False
    matrices = own.jacobians(seeds.points) / own.magnitude
    values = values_of(matrices)
    rank = min(values.shape[1], own.n - 1)
    regular = np.median(values[:, rank - 1])
    left = np.median(values[:, rank]) if values.shape[1] > rank else 0.0
    return bool(regular > OF_CURVES and left < zero * regular)


def _problem_on(
    problem: FunctionProblem,
    region: np.ndarray,
    simplified: Simplified | None = None,
) -> UnitProblem:
    """The problem, or its ``simplified`` equations where they are given, in the units
    that a ``region`` (n, 2) gives."""
    sizes = np.diff(region, axis=1)[:, 0] / 4.0
    if sizes.max() <= WIDEST_MIX * sizes.min():
        sizes = np.full(problem.n, np.median(sizes))
    sizes = np.exp2(np.round(np.log2(sizes)))
    middles = region.mean(axis=1)
    is_off = np.abs(middles) > OFF_CENTER * np.diff(region, axis=1)[:, 0]
    is_arc = np.isfinite(problem.domain.periods) & np.isfinite(
        problem.domain.bounds
    ).all(axis=1)
    origin = np.where(is_off | is_arc, middles, 0.0)
    rows = problem.equations.m if simplified is None else simplified.tape.m
    units = Units(origin, sizes, np.ones(rows))
    own = UnitProblem(problem, units, region, simplified)
    weights = _weights(own)
    if np.all(weights == 1.0):
        return own
    weighted = replace(units, weights=weights)
    return UnitProblem(problem, weighted, region, simplified)


def _weights(own: UnitProblem) -> np.ndarray:
    """Powers of 2 (m,) that make the gradients of the equations about as long as each
    other; ones where they are."""
    _, matrices = own._matrices()
    ones = np.ones(own.equations.m)
    if not len(matrices) or own.equations.m == 1:
        return ones
    lengths = np.median(np.linalg.norm(matrices, axis=2), axis=0)
    is_counted = lengths > 0.0
    if not np.any(is_counted):
        return ones
    counted = lengths[is_counted]
    if counted.max() <= WIDEST_MIX * counted.min():
        return ones
    ones[is_counted] = np.exp2(-np.round(np.log2(counted)))
    return ones
