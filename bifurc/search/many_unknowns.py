"""Equations of many unknowns and a parameter: the curves through solutions at some of its
values, and those that branch off where these cross, as an atlas.

A problem, the number of its parameter and a random seed go in; what comes out is an atlas
with its diagram. All matrices are sparse (`bifurc.large`). No search looks everywhere: what
starts do not reach, and what leaves no crossing, is in doubt.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from bifurc.atlas import Atlas, Provenance
from bifurc.branch import Outcome
from bifurc.decisions import is_same_point, is_solution
from bifurc.errors import ProblemError
from bifurc.isometry import Course
from bifurc.large.large_branch import LargeBranch
from bifurc.large.large_problem import LargeProblem
from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.trace_large_branch import (
    LargeSettings,
    solution_at_parameter,
    trace_large_branch,
)
from bifurc.limits import CutOff, Deadline, cut_off_after, until
from bifurc.problem import Problem
from bifurc.search.answer.curves_of_many import Courses, Reach, atlas_of_curves
from bifurc.search.own_units.restated import restated_branch
from bifurc.settings import TraceSettings
from bifurc.system import jacobian_at, relative_gaps
from bifurc.units import Units

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import csc_array

MANY = 300  # unknowns beyond which a search with dense matrices takes minutes
AT_VALUES = 5  # of the parameter, evenly from bound to bound, starts are made
FIELDS = 5  # that starts have there: 0, the middle, two that are even, and a random one
ASIDE = 0.1  # arclength from a crossing to the start on another curve
VALUES = 3  # smallest singular values that are watched
EIGENVALUES = 12  # next to 0 that are watched where the equations are rates
TRACING_SHARE = 0.4  # of the time, for following a curve; the rest to look at it
# How curves are followed, and again where they stall: closely, and as closely as rounding
# of a hundred thousand unknowns lets. Lengths are in sizes of the field.
TRACINGS = [
    TraceSettings(
        order=order, tolerance=tolerance, shortest=1e-7, longest=1.0, max_length=100.0
    )
    for order, tolerance in ((8, 1e-8), (6, 1e-6))
]
SEEN = np.array([0.25, 0.5, 0.75])  # shares of a curve by which it is known again


def has_many_unknowns(problem: Problem, index: int) -> bool:
    """Whether curves of a problem are found by sparse matrices, unknown number ``index``
    being the parameter: it has many unknowns, one equation fewer, few entries in F', no
    periods, and no rim."""
    domain = problem.domain
    shortcuts = problem.shortcuts
    is_large = problem.n > MANY and shortcuts.jacobian is not None
    is_plain = domain.rim is None and not np.any(np.isfinite(domain.periods))
    has_bounds = bool(np.isfinite(domain.bounds[index]).all())
    return is_large and is_plain and has_bounds and _equations(problem) == problem.n - 1


def _equations(problem: Problem) -> int:
    middle = problem.domain.bounds.mean(axis=1)
    return len(problem.residuals(middle[None])[0])


def explore_many_unknowns(
    problem: Problem,
    index: int,
    provenance: Provenance,
    deadline: Deadline,
    *,
    is_flow: bool,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """The atlas, with its diagram along unknown number ``index``, of a problem that
    `has_many_unknowns`; Hopf points are looked for where it ``is_flow``."""
    search = CurveSearch(
        problem, OrderedProblem.of(problem, index, is_flow), deadline, is_flow
    )
    is_cut_off = False
    try:
        with cut_off_after(deadline):
            for _ in search.steps(np.random.default_rng(provenance.seed)):
                if progress is not None:
                    progress("curves so far", len(search.branches))
    except CutOff:
        is_cut_off = True
    provenance = provenance.at_end(deadline, is_cut_off)
    ordered = search.ordered
    courses = [ordered.course(branch) for branch in search.branches]
    found = Courses(
        problem,
        index,
        search.branches,
        courses,
        ordered.outwards,
        ordered.directions,
    )
    reach = Reach(search.starts, search.reached, search.left)
    return atlas_of_curves(found, reach, provenance)


# --- units ----------------------------------------------------------------------------


@dataclass(frozen=True)
class OrderedProblem:
    """A problem as one of the ``order`` (n,) of unknowns with the parameter last, in
    ``units``."""

    problem: LargeProblem
    order: np.ndarray
    units: Units

    @staticmethod
    def of(problem: Problem, index: int, is_flow: bool) -> OrderedProblem:
        """Unknowns in quarters of their bounds, the parameter as it is. Rates are those
        of these unknowns; other equations are counted by their rows of F'."""
        domain = problem.domain
        order = np.append(np.delete(np.arange(problem.n), index), index)
        units = _units(problem, order, is_flow)
        sizes = units.sizes
        back = np.argsort(order)

        def function(point: np.ndarray) -> np.ndarray:
            outer = units.outwards(point[back])
            value: np.ndarray = units.weights * problem.residuals(outer[None])[0]
            return value

        def jacobian(point: np.ndarray) -> csc_array:
            outer = jacobian_at(problem, units.outwards(point[back]))
            return units.jacobian(outer)[:, order]

        region = (domain.bounds / sizes[:, None])[order]
        name = domain.names[index]
        large = LargeProblem(
            function, problem.n, region, jacobian=jacobian, parameter=name
        )
        return OrderedProblem(large, order, units)

    def inwards(self, point: np.ndarray) -> np.ndarray:
        """A point (n,) of the user."""
        counted: np.ndarray = self.units.inwards(point)[self.order]
        return counted

    def outwards(self, points: np.ndarray) -> np.ndarray:
        """Points (..., n) as the user counts them."""
        return self.units.outwards(points[..., np.argsort(self.order)])

    def directions(self, vectors: np.ndarray) -> np.ndarray:
        """Unit vectors (k, n) of the user along vectors (k, n)."""
        return self.units.directions(vectors[:, np.argsort(self.order)])

    def course(self, branch: LargeBranch) -> Course:
        """A curve in the user's unknowns."""
        back = np.argsort(self.order)
        pieces = np.ascontiguousarray(branch.branch.pieces[:, :, back])
        sizes = self.units.sizes * branch.units.sizes[back]
        units = replace(branch.units, sizes=sizes)
        return restated_branch(
            replace(branch.branch, pieces=pieces), units, branch.branch.periods
        )


def _units(problem: Problem, order: np.ndarray, is_flow: bool) -> Units:
    """Those of the unknowns, the last of the ``order`` (n,) as it is, and of the
    equations."""
    domain = problem.domain
    widths = 0.25 * np.diff(domain.bounds)[:, 0]
    assumed = np.broadcast_to(domain.has_assumed_bounds, domain.bounds.shape)
    sizes = np.where(assumed.any(axis=1), domain.scale, widths)
    sizes[order[-1]] = 1.0
    sizes = 2.0 ** np.round(np.log2(sizes))
    weights = 1.0 / sizes[order[:-1]]
    if not is_flow:
        weights = _weights_of_rows(problem, sizes)
    return Units(np.zeros(problem.n), sizes, weights)


def _weights_of_rows(problem: Problem, sizes: np.ndarray) -> np.ndarray:
    """One over the sizes (m,) of the rows of F' in the middle of the bounds, 1 where
    that is no number."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import norm

    middle = problem.domain.bounds.mean(axis=1)
    rows = norm(jacobian_at(problem, middle) @ diags_array(sizes), axis=1)
    is_known = np.isfinite(rows) & (rows > 0.0)
    return 2.0 ** -np.round(np.log2(np.where(is_known, rows, 1.0)))


# --- curves ---------------------------------------------------------------------------


@dataclass
class CurveSearch:
    """The ``branches`` that are found, from how many starts, and how many of these
    ``reached`` a solution; ``left``: crossings of which other curves are not followed."""

    problem: Problem
    ordered: OrderedProblem
    deadline: Deadline
    is_flow: bool
    branches: list[LargeBranch] = field(default_factory=list)
    starts: int = 0
    reached: int = 0
    left: int = 0

    def steps(self, rng: np.random.Generator) -> Iterator[None]:
        """Look at one start after the other, and follow what leaves crossings."""
        for start in self._starts(rng):
            if self.deadline.passed:
                return
            self.starts += 1
            solution = self._solution(start)
            if solution is None:
                continue
            self.reached += 1
            if not self._is_known(solution[None]):
                self._follow(solution)
                yield from self._branch_off(len(self.branches) - 1)
            yield

    def _starts(self, rng: np.random.Generator) -> Iterator[np.ndarray]:
        """Points (n,) within the bounds, at values of the parameter."""
        low, high = self.ordered.problem.region[:-1].T
        first, last = self.ordered.problem.bounds.tolist()
        even = rng.uniform(0.0, 1.0, FIELDS - 3)
        fields = [np.clip(0.0, low, high), 0.5 * (low + high)]
        fields += [low + share * (high - low) for share in even]
        fields.append(rng.uniform(low, high))
        for one in fields:
            for value in np.linspace(first, last, AT_VALUES):
                yield np.append(one, value)

    def _solution(self, start: np.ndarray) -> np.ndarray | None:
        """The solution (n,) within the bounds with the parameter of a start (n,), None
        where Newton's method leads to none."""
        large = self.ordered.problem
        try:
            with np.errstate(all="ignore"):
                scaled = ScaledProblem(large, start)
                inner = scaled.own_units.inwards(start)
                solution = solution_at_parameter(scaled, inner)
                gap = float(relative_gaps(scaled, solution[None])[0])
        except (ProblemError, RuntimeError, np.linalg.LinAlgError):
            return None
        if not is_solution(gap) or not scaled.domain.are_inside(solution[None])[0]:
            return None
        return scaled.own_units.outwards(solution)

    def _is_known(self, points: np.ndarray) -> bool:
        """Whether all points (k, n) lie on one of the branches."""
        for branch in self.branches:
            distances, _ = branch.branch.nearest(branch.units.inwards(points))
            if np.all(is_same_point(distances)):
                return True
        return False

    def _follow(self, start: np.ndarray, direction: np.ndarray | None = None) -> bool:
        """Add the curve through a start (n,), unless it is known; whether there is one
        that was not."""
        branch = None
        for tracing in TRACINGS:
            try:
                # of the time that is left, so that what is on a curve is looked at, too
                with until(self.deadline.share(TRACING_SHARE)):
                    branch = self._traced(start, direction, tracing)
            except (ProblemError, RuntimeError):
                continue
            if branch.outcome is not Outcome.STALLED:
                break
        if branch is None or not branch.length > 0.0:
            return False
        samples = [branch(share * branch.length) for share in SEEN]
        if self._is_known(np.array(samples)):
            return False
        self.branches.append(branch)
        return True

    def _traced(
        self, start: np.ndarray, direction: np.ndarray | None, tracing: TraceSettings
    ) -> LargeBranch:
        settings = LargeSettings(
            tracing=tracing,
            values=VALUES,
            both_ways=True,
            eigenvalues=EIGENVALUES if self.is_flow else 0,
        )
        return trace_large_branch(self.ordered.problem, start, direction, settings)

    def _branch_off(self, number: int) -> Iterator[None]:
        """Follow the other curves at crossings of a branch and of those that come of
        it."""
        waiting = [(number, point) for point in self.branches[number].crossings]
        while waiting:
            number, point = waiting.pop(0)
            for direction in point.directions[1:]:
                if self.deadline.passed:
                    self.left += 1
                    break
                yield
                if self._follow(point.u + ASIDE * direction, direction):
                    number = len(self.branches) - 1
                    waiting += [(number, one) for one in self.branches[-1].crossings]
