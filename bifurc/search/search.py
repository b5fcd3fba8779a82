"""A search under way: the steps of the method, and what each of them adds."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, lower_rank_direction
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.monitor import Profile, profile_branch, singular_values
from bifurc.decisions import (
    is_mobile,
    is_solution,
    is_stub,
    may_be_crossed,
    may_be_singular,
)
from bifurc.limits import Deadline, HeldInterrupt
from bifurc.problem import Problem
from bifurc.search.canonical_course import canonical_course
from bifurc.search.components import components_of_seeds, singular_points_of
from bifurc.search.findings import Findings, PointSighting, TracedBranch
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.search.settings import SearchSettings
from bifurc.seeds import Seeds
from bifurc.singular.classify import classify_singular_point
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.singular.point import SingularPoint
from bifurc.singular.sphere import is_on_surface

__all__ = ["Limits", "Search", "Start"]

log = logging.getLogger(__name__)

# Singular values are over the problem's magnitude, lengths over its scale.
CLOSED_STUB = 20  # times shorter: a branch that does not stall and is none
BLURRED = 1e-4  # accuracy of a seed where the rank is low: half the digits
SEED_REACH = 1e-2  # how far from a seed its singular point may lie
BRANCH_REACH = 0.05  # how far from a minimum on a branch its singular point may lie
BESIDE_END = np.array([0.0, 0.01, 0.02])  # of a stalled branch: starts for a cusp
CUSP_REACH = 0.2  # how far from there the cusp may lie


class Start(NamedTuple):
    """A solution (n,) to trace a branch from, first to the side of ``direction`` (n,)
    where there is one."""

    point: np.ndarray
    direction: np.ndarray | None = None


class _Trace(NamedTuple):
    """What a start lies on, None for no branch at all, and the starts on the branches
    that leave from there."""

    fate: SeedFate | None
    starts: list[Start]


class _ExaminedBranch(NamedTuple):
    """The number of a branch just recorded, and the starts on the branches through the
    singular points that are new."""

    number: int
    starts: list[Start]


class _Candidate(NamedTuple):
    """A place on a branch to look for a singular point.

    ``looks`` are the arclengths (k,) of the starts, of which the first one that leads
    to a singular point counts. Singular values below ``zero`` count as zero. ``reach``
    is how far away the point may lie, in units of the problem's scale.
    """

    looks: np.ndarray
    zero: float
    reach: float = BRANCH_REACH


@dataclass(frozen=True)
class Limits:
    """Where a search has to stop: the end of its budget, and a Ctrl-C that waits for
    the end of a step."""

    deadline: Deadline
    interrupt: HeldInterrupt


class Search:
    """The search for all branches and singular points of a ``problem``.

    Its steps are called in their order: `gather_seeds`, `sort_seeds`, `trace_seeds`,
    `cover_surfaces`, `audit_branches`. Each adds to the ``findings``. From the end of
    the budget on a step does nothing. A Ctrl-C raises `KeyboardInterrupt` between two
    starts, and the findings hold what is known then.
    """

    def __init__(
        self,
        problem: Problem,
        settings: SearchSettings,
        progress: Callable[[str, int], None] | None = None,
    ):
        self.problem = problem
        self.settings = settings
        self.progress = progress
        self.limits = Limits(Deadline(settings.budget), HeldInterrupt())
        self.findings = Findings(problem)

    @property
    def is_over(self) -> bool:
        """Whether the budget is used up."""
        return self.limits.deadline.passed

    # --- seeds ------------------------------------------------------------------------

    def gather_seeds(self, seeds: Seeds | None, random_seed: int) -> None:
        """Take the ``seeds`` given, or else those of the problem."""
        if seeds is None:
            rng = np.random.default_rng(random_seed)
            seeds = self.problem.seeds(rng, self.settings.starts)
        self.findings.add_seeds(seeds, self._singular_values(seeds.points))
        self.limits.interrupt.check()

    def sort_seeds(self) -> None:
        """Find the seeds that lie on components of dimension 2 and more."""
        findings = self.findings
        points = findings.seeds.points
        if not len(points):
            return
        components = components_of_seeds(
            self.problem, points, findings.seed_values, self.limits.deadline
        )
        findings.set_components(components)

    def trace_seeds(self) -> None:
        """Trace from every seed that lies on nothing known, and from every half-branch
        that shows up on the way."""
        findings = self.findings
        waiting = self._clearest_first(findings.open_seeds)
        matched = 0
        while waiting and not self.is_over:
            for branch in range(matched, len(findings.traced)):
                waiting = findings.match_seeds(waiting, branch)
            matched = len(findings.traced)
            if self.progress is not None:
                self.progress("forms", matched)
            if waiting:
                number = waiting.pop(0)
                findings.fates[number] = self._fate_of_seed(number)
            self.limits.interrupt.check()

    def _clearest_first(self, numbers: list[int]) -> list[int]:
        """The seeds, first those whose curve is far from singular."""
        values = self.findings.seed_values[numbers, max(self.problem.n - 2, 0)]
        order = np.argsort(-values, kind="stable")
        return [numbers[k] for k in order]

    def _fate_of_seed(self, number: int) -> SeedFate:
        """What a seed lies on; the curves there are traced."""
        point = self.findings.seeds.points[number]
        values = self.findings.seed_values[number]
        if not is_mobile(float(values[self.problem.n - 1])):
            return self._rigid_fate(point)
        if may_be_singular(float(values[self.problem.n - 2])):
            fate = self._fate_at_low_rank(point, values)
            if fate is not None:
                return fate
        trace = self._trace(Start(point))
        self._branch_off(trace.starts)
        if trace.fate is None:
            return self._rigid_fate(point)
        return trace.fate

    def _rigid_fate(self, point: np.ndarray) -> SeedFate:
        return SeedFate(Fate.RIGID, self.findings.rigid_assembly(point))

    def _fate_at_low_rank(
        self, point: np.ndarray, values: np.ndarray
    ) -> SeedFate | None:
        """What a seed (n,) lies on where F' has a lower rank than along a curve, or
        nearly; None where nothing is singular there."""
        known = self.findings.point_near(point, BLURRED)
        if known is not None:
            return SeedFate(Fate.AT_SINGULAR_POINT, known.number)
        branch = self.findings.branch_through(point, BLURRED)
        if branch is not None:
            return SeedFate(Fate.ON_FORM, branch)
        direction = lower_rank_direction(self.problem, point)
        if direction is not None:
            return self._trace_lower_rank(point, direction)
        nullity = int(np.count_nonzero(may_be_singular(values)))
        sighting = self._examine(point, nullity, SEED_REACH)
        if sighting is None:
            return None
        self._branch_off(_half_branch_starts(sighting.point))
        return SeedFate(Fate.AT_SINGULAR_POINT, sighting.number)

    # --- branches ---------------------------------------------------------------------

    def _branch_off(self, starts: list[Start]) -> None:
        """Trace the branches through the starts, and everything that hangs on them."""
        queue = list(starts)
        while queue and not self.is_over:
            trace = self._trace(queue.pop())
            queue += trace.starts

    def _trace(self, start: Start) -> _Trace:
        """Trace the branch through a start, unless it is known."""
        findings = self.findings
        number = findings.branch_through(start.point)
        if number is not None:
            return _Trace(SeedFate(Fate.ON_FORM, number), [])
        branch = trace_branch(self.problem, *start, self.settings.tracing)
        is_open = branch.outcome is Outcome.OPEN
        if is_open:
            findings.gaps.append(branch.gap)
        if not self._is_curve(branch):
            log.info("no curve through %s: %s", start.point, branch.outcome.value)
            return _Trace(SeedFate(Fate.NO_SOLUTION) if is_open else None, [])
        # by rounding over a small singular value a start may lie beside its curve
        number = findings.branch_along(branch)
        if number is not None:
            return _Trace(SeedFate(Fate.ON_FORM, number), [])
        examined = self._examine_branch(branch)
        return _Trace(SeedFate(Fate.ON_FORM, examined.number), examined.starts)

    def _trace_lower_rank(self, point: np.ndarray, direction: np.ndarray) -> SeedFate:
        """Trace the curve of lower rank through a point (n,); what may cross it is left
        to other seeds."""
        deflated = Deflated(self.problem)
        branch = trace_branch(deflated, point, direction, self.settings.tracing)
        if not self._is_curve(branch):
            outcome = branch.outcome.value
            log.info("no curve of lower rank through %s: %s", point, outcome)
            return SeedFate(Fate.NO_SOLUTION)
        examined = self._examine_branch(branch)
        return SeedFate(Fate.ON_FORM, examined.number)

    def _is_curve(self, branch: Branch) -> bool:
        """Whether a traced branch is more than the trace of rounding beside a singular
        point."""
        if not len(branch.pieces):
            return False
        unit = self.problem.scale
        if branch.outcome is not Outcome.STALLED:
            unit /= CLOSED_STUB
        return not is_stub(branch.length, unit)

    # --- singular points --------------------------------------------------------------

    def _examine_branch(self, branch: Branch) -> _ExaminedBranch:
        """Record a branch and the singular points on it."""
        branch = canonical_course(self.problem, branch)
        profile = profile_branch(self.problem, branch)
        minima = singular_value_minima(self.problem, branch, profile)
        candidates = _small_minima(*minima) + self._candidate_ends(branch, profile)
        located: list[float] = []
        starts: list[Start] = []
        for candidate in candidates:
            if self.is_over:
                break
            sighting = self._examine_candidate(branch, candidate)
            if sighting is None:
                continue
            located.append(float(candidate.looks[0]))
            if sighting.is_new:
                starts += _half_branch_starts(sighting.point)
        traced = TracedBranch(branch, profile, minima, tuple(located))
        return _ExaminedBranch(self.findings.add_branch(traced), starts)

    def _candidate_ends(self, branch: Branch, profile: Profile) -> list[_Candidate]:
        """The ends of an open branch where a singular point may lie."""
        if branch.closed:
            return []
        if branch.outcome is Outcome.STALLED:
            # It stalls before a cusp or beyond it: how far hangs on rounding, and so
            # does it whether the point is reached from one start.
            offsets = np.minimum(self.problem.scale * BESIDE_END, 0.5 * branch.length)
            stretches = (offsets, branch.length - offsets)
            return [
                _Candidate(looks, 10 * may_be_crossed.threshold, CUSP_REACH)
                for looks in stretches
            ]
        # An end is no minimum, and yet a singular point may lie there.
        ends = np.array([0.0, branch.length])
        values = self._singular_values(branch(ends))[:, profile.rank - 1]
        return [
            _Candidate(end[None], may_be_crossed.threshold)
            for end in ends[may_be_crossed(values)]
        ]

    def _examine_candidate(
        self, branch: Branch, candidate: _Candidate
    ) -> PointSighting | None:
        """The singular point to which the looks of a candidate lead."""
        for arclength in candidate.looks:
            near = branch(arclength)
            known = self.findings.point_at(near, 0.0)
            if known is not None and known.point.dimension == 1:
                return known
            values = self._singular_values(near[None])[0]
            nullity = int(np.count_nonzero(values < candidate.zero))
            if nullity < 2:
                continue
            sighting = self._examine(near, nullity, candidate.reach)
            if sighting is not None:
                return sighting
        return None

    def _examine(
        self, near: np.ndarray, nullity: int, reach: float
    ) -> PointSighting | None:
        """The singular point of a curve at less than ``reach`` scales from a solution
        ``near`` (n,); ``nullity`` is the most likely one."""
        problem = self.problem
        nullities = {max(nullity, 2), 2, 3}
        for k in sorted(nullities, key=lambda k: abs(k - nullity)):
            if k > problem.n:
                continue
            located = locate_singular_point(problem, near, k, reach * problem.scale)
            if located is None:
                continue
            known = self.findings.point_at(located.u, located.error)
            if known is not None and known.point.dimension == 1:
                return known
            if not is_on_surface(problem, located.u):
                return self._sight(located)
        return None

    def _sight(self, located: LocatedPoint) -> PointSighting:
        """The known singular point that a located one is, or a new one, classified."""
        known = self.findings.point_at(located.u, located.error)
        if known is not None:
            return known
        point = classify_singular_point(self.problem, located)
        return self.findings.add_point(point)

    def _singular_values(self, points: np.ndarray) -> np.ndarray:
        """Singular values (k, n) of F' at points (k, n)."""
        if not len(points):
            return np.empty((0, self.problem.n))
        return singular_values(self.problem, points)

    # --- surfaces ---------------------------------------------------------------------

    def cover_surfaces(self) -> None:
        """Cover the surfaces with charts, locate singular points on them, and trace the
        curves that leave there."""
        findings, deadline = self.findings, self.limits.deadline
        components = findings.components
        refused = components.cover(
            self.problem, findings.seeds.points, self.settings.charts, deadline
        )
        findings.reopen_seeds(refused)
        self.trace_seeds()
        for located in singular_points_of(self.problem, components, deadline):
            if self.is_over:
                break
            sighting = self._sight(located)
            self._branch_off(_half_branch_starts(sighting.point))

    # --- audit ------------------------------------------------------------------------

    def audit_branches(self) -> None:
        """Hold the branches against the problem's audit, and trace what it leads to,
        until that is nothing new."""
        findings = self.findings
        judge = findings.seeds.audit
        while judge is not None and findings.awaits_audit and not self.is_over:
            seconds = self.limits.deadline.left if self.settings.prove else 0.0
            audit = judge(findings.branches, seconds)
            findings.set_audit(audit)
            self.limits.interrupt.check()
            solutions, gaps = self.problem.project(audit.starts)
            solutions = solutions[is_solution(gaps)]
            seeds = findings.seeds.with_constructed(solutions)
            findings.add_seeds(seeds, self._singular_values(solutions))
            self.trace_seeds()


def _half_branch_starts(point: SingularPoint) -> list[Start]:
    """Starts on all half-branches of a singular point, a little off it."""
    directions = point.half_branches
    return [Start(point.u + point.radius * along, along) for along in directions]


def _small_minima(arclengths: np.ndarray, values: np.ndarray) -> list[_Candidate]:
    """Minima (k,) of the singular value that may be singular points."""
    candidates = []
    for k in np.flatnonzero(may_be_crossed(values)):
        zero = max(may_be_crossed.threshold, 3 * float(values[k]))
        candidates.append(_Candidate(arclengths[k : k + 1], zero))
    return candidates
