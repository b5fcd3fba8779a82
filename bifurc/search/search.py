"""A search under way: the steps of the method, and what each of them adds."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, lower_rank_direction
from bifurc.curves.minima import singular_value_minima
from bifurc.curves.misclosure import largest_misclosure
from bifurc.curves.monitor import Profile, profile_branch
from bifurc.curves.near_motion import trace_near_motion
from bifurc.curves.near_surface import near_surfaces
from bifurc.decisions import (
    closes_to_rounding,
    is_beside_singular,
    is_deep_place,
    is_hidden_by,
    is_on_the_way,
    is_passed,
    is_plainly_closed_curve,
    is_precise_enough,
    is_same_point,
    is_singular_to_rounding,
    is_solution,
    is_start_solved,
    is_stub,
    is_weakly_isolated,
    may_be_crossed,
    may_be_mobile,
    may_be_shaky,
    may_be_singular,
    may_nearly_move,
    nearly_closes,
    stops_short,
)
from bifurc.limits import Deadline, HeldInterrupt
from bifurc.numerics.blur import blur_along, distance_to_singular
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.assembly import polished
from bifurc.search.canonical_course import canonical_course
from bifurc.search.certification import certificate_of, finer_settings, may_be_mended
from bifurc.search.closure_gap import valley_points
from bifurc.search.components import components_of_seeds, singular_points_of
from bifurc.search.findings import NO_DOUBT, Findings, PointSighting, TracedBranch
from bifurc.search.joining import joined_through
from bifurc.search.meeting_points import ends_at
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.search.settings import SearchSettings
from bifurc.search.weak_seeds import sharpened, with_weak_solutions
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds
from bifurc.singular.classify import classify_from_nearby, classify_singular_point
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.singular.point import Kind, SingularPoint
from bifurc.singular.sphere import is_on_surface

if TYPE_CHECKING:
    from bifurc.singular.germ import Germ

__all__ = ["Limits", "Search", "Start"]

log = logging.getLogger(__name__)

# Singular values are over the problem's magnitude, lengths over its scale.
LEAVING_STUB = 20  # times shorter: a branch that leaves the bounds and is none
# A curve is traced at a misclosure a little above what it may have: the largest one
# along it, measured afterwards, decides.
LENIENT = 4.0 * is_solution.threshold
SAME_STARTS = 200  # from which every search looks for near motions
FRUITLESS = 4  # of those on no known near motion that in a row led to nothing new
BLURRED = 1e-4  # accuracy of a seed where the rank is low: half the digits, at worst
TINY = 1e-300  # keeps a singular value of zero from being divided by
SEED_REACH = 1e-2  # how far from a seed its singular point may lie
BRANCH_REACH = 0.05  # how far from a minimum on a branch its singular point may lie
ABOUT = 16  # nodes before and after a deep place that are not lower: those of a piece
BESIDE = 3 * ABOUT  # and among which some are far higher, as a whole piece may be flat
LOOKS_WHERE_STOPPED = 6  # at ends of starts that reached no solution
LOOKS_ALONG = 5  # on a branch, for a rank that is lower all along it
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
    """A branch with what was seen along it, and the starts on the branches through the
    singular points that are new."""

    traced: TracedBranch
    starts: list[Start]


class _Candidate(NamedTuple):
    """A place on a branch to look for a singular point.

    ``looks`` are the arclengths (k,) of the starts, of which the first one that leads
    to a singular point counts. Singular values below ``zero`` count as zero. ``reach``
    is how far away the point may lie, in units of the problem's scale. Where there
    ``must_be`` one, none that is located is said to be missing.
    """

    looks: np.ndarray
    zero: float
    reach: float = BRANCH_REACH
    must_be: bool = False


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
        deadline: Deadline | None = None,
    ):
        self.problem = problem
        self.settings = settings
        self.progress = progress
        until = Deadline(settings.budget) if deadline is None else deadline
        self.limits = Limits(until, HeldInterrupt())
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
            deadline = self.limits.deadline
            seeds = self.problem.seeds_until(rng, self.settings.starts, deadline)
            if not self.is_over:
                seeds = with_weak_solutions(self.problem, seeds)
        self._add_seeds(seeds, 0)
        self.limits.interrupt.check()

    def _add_seeds(self, seeds: Seeds, known: int) -> None:
        """Add the ``seeds`` after the first ``known`` ones, each as near to its curve
        as it can be known."""
        points = seeds.points[known:]
        values = self._singular_values(points)
        sharp = sharpened(self.problem, points, values)
        values[sharp.moved] = self._singular_values(sharp.points[sharp.moved])
        both = np.concatenate([seeds.points[:known], sharp.points])
        self.findings.add_seeds(replace(seeds, points=both), values)

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
        if not may_be_mobile(float(values[self.problem.n - 1])):
            return self._fate_of_assembly(point)
        near = self.findings.near_motion_through(point)
        if near is not None:
            return SeedFate(Fate.ON_NEAR_MOTION, near)
        if self._may_be_singular(point, values):
            fate = self._fate_at_low_rank(point, values)
            if fate is not None:
                return fate
        trace = self._trace(Start(point))
        self._branch_off(trace.starts)
        if trace.fate is None:
            return self._fate_of_assembly(point)
        return trace.fate

    def _may_be_singular(self, point: np.ndarray, values: np.ndarray) -> bool:
        """Whether a seed (n,) may be a singular point: a singular value is small there,
        and not just as small as it is all around."""
        if not may_be_singular(float(values[self.problem.n - 2])):
            return False
        return is_beside_singular(distance_to_singular(self.problem, point))

    def _fate_of_assembly(self, point: np.ndarray) -> SeedFate:
        """What a seed (n,) lies on that cannot move: a near motion, or nothing but
        itself.

        On a near motion only what is stiff enough to be told from its neighbours is an
        assembly of its own, besides those where the misclosure passes zero.
        """
        findings = self.findings
        solution = polished(self.problem, point)
        place = (solution.point, solution.stiffness, solution.hidden)
        known = findings.rigid_at(*place)
        if known is not None:
            return SeedFate(Fate.RIGID, known)
        if is_weakly_isolated(solution.stiffness):
            shaky = self._shaky_assembly(solution.point)
            if shaky is not None:
                return SeedFate(Fate.AT_SINGULAR_POINT, shaky)
        near = None
        if self.settings.near_motions and may_nearly_move(solution.stiffness):
            near = self._near_motion_through(point)
        if near is None or solution.is_isolated:
            return SeedFate(Fate.RIGID, findings.rigid_assembly(*place))
        return SeedFate(Fate.ON_NEAR_MOTION, near)

    def _shaky_assembly(self, point: np.ndarray) -> int | None:
        """The number of the isolated singular point at which solutions next to
        ``point`` (n,) come together, as far as rounding tells; None where there is
        none."""
        reach = SEED_REACH * self.problem.scale
        located = locate_singular_point(self.problem, point, 1, reach)
        if located is None:
            return None
        gap = float(self.problem.gaps(located.u[None])[0])
        if not closes_to_rounding(gap):
            return None  # beside two that rounding tells apart
        sighting = self._sight(located)
        return sighting.number if sighting.point.kind is Kind.ISOLATED else None

    def _near_motion_through(self, point: np.ndarray) -> int | None:
        """The number of the near motion through a point (n,), which is traced if it is
        new; None where there is none."""
        number = self.findings.near_motion_through(point)
        if number is not None:
            return number
        if self.findings.is_on_short_stretch(point):
            return None
        near = trace_near_motion(self.problem, point, self.settings.tracing)
        if near is None or closes_to_rounding(near.misclosure):
            return None  # nothing, or a form runs there
        near = replace(near, branch=canonical_course(self.problem, near.branch))
        return self.findings.add_near_motion(near)

    def look_for_near_motions(self) -> None:
        """Trace the near motions next to where starts end that miss, where nothing
        moves.

        Besides the random starts of the search there are always the same ones, so that
        what they reach does not depend on its seed.
        """
        findings = self.findings
        is_mobile = bool(findings.traced) or bool(findings.components.seeds)
        is_asked = self.settings.near_motions
        if is_mobile or not is_asked or not len(findings.seeds.missed):
            return
        if self.is_over:
            return
        points = self._nearly_closed(findings.seeds.missed)
        if not len(points) or self.is_over:
            return
        rng, deadline = np.random.default_rng(0), self.limits.deadline
        same = random_seeds(self.problem, rng, SAME_STARTS, deadline=deadline)
        always = self._nearly_closed(np.concatenate([same.points, same.missed]))
        if self.is_over:
            return
        surfaces, is_left = near_surfaces(self.problem, always)
        findings.near_surfaces += surfaces
        if surfaces:
            _, is_open = near_surfaces(self.problem, points)
            points = points[is_open]
        self._trace_near_motions(always[is_left])
        self._trace_near_motions(points)

    def _trace_near_motions(self, waiting: np.ndarray) -> None:
        """Trace the near motions through points (k, n), first those through points that
        are far from singular."""
        values = self._singular_values(waiting)[:, max(self.problem.n - 2, 0)]
        waiting = waiting[np.argsort(-values, kind="stable")]
        waiting = self._not_on_near_motions(waiting)
        findings = self.findings
        fruitless = 0
        while len(waiting) and fruitless < FRUITLESS and not self.is_over:
            first = waiting[0]
            known = len(findings.near_motions) + len(findings.short_stretches)
            self._near_motion_through(first)
            found = len(findings.near_motions) + len(findings.short_stretches)
            fruitless = fruitless + 1 if found == known else 0
            offsets = self.problem.difference(waiting, first)
            apart = np.linalg.norm(offsets, axis=1)
            waiting = waiting[~is_same_point(apart, self.problem.scale)]
            waiting = self._not_on_near_motions(waiting)
            self.limits.interrupt.check()

    def _not_on_near_motions(self, points: np.ndarray) -> np.ndarray:
        """Those of the points (k, n) that lie on no known near motion or short
        stretch."""
        findings = self.findings
        for near in findings.near_motions + findings.short_stretches:
            if len(points):
                points = points[~near.runs_through(self.problem, points)]
        return points

    def _nearly_closed(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) in the valleys below points (j, n), where the system is nearly
        solved, below as many as there is time for."""
        lowest = valley_points(self.problem, points, self.limits.deadline)
        is_near = nearly_closes(self.problem.gaps(lowest))
        return lowest[is_near]

    def _fate_at_low_rank(
        self, point: np.ndarray, values: np.ndarray
    ) -> SeedFate | None:
        """What a seed (n,) lies on where F' has a lower rank than along a curve, or
        nearly; None where nothing is singular there."""
        within = self._blur_of_seed(values)
        known = self.findings.point_near(point, within)
        if known is not None:
            return SeedFate(Fate.AT_SINGULAR_POINT, known.number)
        branch = self.findings.branch_through(point, within)
        if branch is not None:
            return SeedFate(Fate.ON_FORM, branch)
        direction = lower_rank_direction(self.problem, point)
        if direction is not None:
            fate = self._trace_lower_rank(point, direction)
            if fate.fate is Fate.ON_FORM:
                return fate
        nullity = int(np.count_nonzero(may_be_singular(values)))
        sighting = self._examine(point, nullity, SEED_REACH)
        if sighting is None:
            return None
        self._branch_off(_half_branch_starts(sighting.point))
        return SeedFate(Fate.AT_SINGULAR_POINT, sighting.number)

    def _blur_of_seed(self, values: np.ndarray) -> float:
        """How far, over the scale, a seed with singular values (n,) may lie from where
        it belongs: what its residual leaves open in the weakest direction, and no more
        where sheets lie near to each other."""
        weakest = float(values[self.problem.n - 2]) * self.problem.scale
        return min(BLURRED, is_start_solved.threshold / max(weakest, TINY))

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
        branch = trace_branch(self.problem, *start, self.settings.tracing, LENIENT)
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
        fate = self._retrace_lower_rank(branch)
        if fate is not None:
            return _Trace(fate, [])
        misclosure = largest_misclosure(self.problem, branch)
        has_failed = branch.outcome is Outcome.STALLED
        if not is_solution(misclosure) or (
            has_failed and not closes_to_rounding(misclosure)
        ):
            near = self._near_motion_through(start.point)
            if near is not None:
                return _Trace(SeedFate(Fate.ON_NEAR_MOTION, near), [])
        examined = self._examine_branch(branch, misclosure)
        if examined.traced.is_refused and may_be_mended(self.problem, examined.traced):
            examined = self._trace_finer(start, examined)
            number = findings.branch_along(examined.traced.branch)
        if number is None:
            number = findings.add_branch(examined.traced)
        return _Trace(SeedFate(Fate.ON_FORM, number), examined.starts)

    def _trace_finer(self, start: Start, coarse: _ExaminedBranch) -> _ExaminedBranch:
        """The branch through a start, traced again until its certificate holds, or the
        one of which least is refused; with the starts that all of them led to."""
        best = coarse.traced
        starts = coarse.starts
        for settings in finer_settings(self.settings.tracing):
            if self.is_over:
                break
            branch = trace_branch(self.problem, *start, settings, LENIENT)
            if not self._is_curve(branch):
                continue
            misclosure = largest_misclosure(self.problem, branch)
            finer = self._examine_branch(branch, misclosure)
            starts += finer.starts
            if finer.traced.doubt < best.doubt:
                best = finer.traced
            if best.doubt == NO_DOUBT:
                break
        return _ExaminedBranch(best, starts)

    def _retrace_lower_rank(self, branch: Branch) -> SeedFate | None:
        """Trace a branch again where F' has a lower rank all along it, as it was
        corrected to half the digits only; None where it has not."""
        if self.problem.n < 2:
            return None
        # not at its ends: what is traced from a bound may leave there at once
        inner = np.linspace(0.0, branch.length, LOOKS_ALONG + 2)[1:-1]
        points = branch(inner)
        values = singular_values(self.problem, points)
        if not np.all(may_be_shaky(values[:, self.problem.n - 2])):
            return None
        clearest = np.argmax(values[:, self.problem.n - 3])
        direction = lower_rank_direction(self.problem, points[clearest])
        if direction is None:
            return None
        fate = self._trace_lower_rank(points[clearest], direction)
        return fate if fate.fate is Fate.ON_FORM else None

    def _trace_lower_rank(self, point: np.ndarray, direction: np.ndarray) -> SeedFate:
        """Trace the curve of lower rank through a point (n,); what may cross it is left
        to other seeds."""
        deflated = Deflated(self.problem)
        branch = trace_branch(deflated, point, direction, self.settings.tracing)
        if not self._is_curve(branch):
            outcome = branch.outcome.value
            log.info("no curve of lower rank through %s: %s", point, outcome)
            return SeedFate(Fate.NO_SOLUTION)
        misclosure = largest_misclosure(self.problem, branch)
        examined = self._examine_branch(branch, misclosure)
        return SeedFate(Fate.ON_FORM, self.findings.add_branch(examined.traced))

    def _is_curve(self, branch: Branch) -> bool:
        """Whether a traced branch is more than the trace of rounding beside a singular
        point."""
        if not len(branch.pieces):
            return False
        if branch.closed:
            blur = blur_along(self.problem, branch) * self.problem.scale
            return is_plainly_closed_curve(blur, branch.length)
        unit = self.problem.scale
        if branch.outcome is not Outcome.STALLED:
            unit /= LEAVING_STUB
        return not is_stub(branch.length, unit)

    # --- singular points --------------------------------------------------------------

    def _examine_branch(self, branch: Branch, misclosure: float) -> _ExaminedBranch:
        """Look for the singular points on a branch with a ``misclosure``, and certify
        it between them."""
        branch = canonical_course(self.problem, branch)
        profile = profile_branch(self.problem, branch)
        minima = singular_value_minima(self.problem, branch, profile)
        candidates = []
        if profile.rank:  # where F' vanishes all along nothing of it tells places apart
            candidates = _small_minima(*minima)
            candidates += _deep_places(profile, minima[0])
            candidates += self._candidate_ends(branch, profile)
        located: list[float] = []
        passes: list[float] = []
        missing: list[float] = []
        starts: list[Start] = []
        for candidate in candidates:
            if self.is_over:
                break
            place = float(candidate.looks[0])
            sighting = self._examine_candidate(branch, candidate, misclosure)
            if sighting is None:
                if candidate.must_be:
                    missing.append(place)
                continue
            located.append(place)
            if self._is_at(branch, place, sighting.point):
                passes.append(place)
            if sighting.is_new:
                starts += _half_branch_starts(sighting.point)
        certificate = None
        if self.settings.certify:
            certificate = certificate_of(self.problem, branch, profile, passes)
        traced = TracedBranch(
            branch=branch,
            profile=profile,
            minima=minima,
            located=tuple(located),
            misclosure=misclosure,
            blur=blur_along(self.problem, branch),
            passes=tuple(passes),
            missing=tuple(missing),
            certificate=certificate,
        )
        return _ExaminedBranch(traced, starts)

    def _is_at(self, branch: Branch, s: float, point: SingularPoint) -> bool:
        """Whether a branch passes a singular point at arclength ``s``, and not only
        near it."""
        gap = self.problem.difference(branch(s), point.u)
        beside = float(np.linalg.norm(gap)) - point.error
        return is_passed(beside, self.problem.scale)

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
        self, branch: Branch, candidate: _Candidate, misclosure: float
    ) -> PointSighting | None:
        """The singular point to which the looks of a candidate lead, on a branch with a
        ``misclosure``."""
        for arclength in candidate.looks:
            near = branch(arclength)
            known = self.findings.point_seen_from(near)
            if known is not None and known.point.dimension == 1:
                return known
            values = self._singular_values(near[None])[0]
            nullity = int(np.count_nonzero(values < candidate.zero))
            if nullity < 2:
                continue
            sighting = self._examine(near, nullity, candidate.reach, misclosure)
            if sighting is not None:
                return sighting
        return None

    def _examine(
        self, near: np.ndarray, nullity: int, reach: float, misclosure: float = 0.0
    ) -> PointSighting | None:
        """The singular point of a curve at less than ``reach`` scales from a solution
        ``near`` (n,); ``nullity`` is the most likely one."""
        problem = self.problem
        nullities = {max(nullity, 2), 2, 3}
        for k in sorted(nullities, key=lambda k: abs(k - nullity)):
            if k > problem.n:
                continue
            located = locate_singular_point(
                problem, near, k, reach * problem.scale, misclosure
            )
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
        located, germ = self._in_more_digits(located)
        known = self.findings.point_at(located.u, located.error)
        if known is not None:
            return known
        point = classify_singular_point(self.problem, located, germ=germ)
        return self.findings.add_point(point)

    def _in_more_digits(
        self, located: LocatedPoint
    ) -> tuple[LocatedPoint, Germ | None]:
        """The located point, in more digits where these tell more, and the germ of the
        curves there, where the exact equations give it."""
        is_open = not is_precise_enough(located.error, self.problem.scale)
        if not (is_open and self.problem.is_exact):
            return located, None
        # mpmath takes longer to import than an ordinary search
        from bifurc.singular.germ import germ_at, placed_at
        from bifurc.singular.precise_location import precisely_located

        germ = germ_at(self.problem, located)
        if germ is None and not self.is_over:
            located = precisely_located(self.problem, located)
            germ = germ_at(self.problem, located)
        return (located if germ is None else placed_at(located, germ)), germ

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

    # --- where starts stop ------------------------------------------------------------

    def look_where_starts_stop(self) -> None:
        """Look for singular points where starts end short of a solution, about nothing
        that is known: beside an isolated point of high order F is so flat that they do."""
        findings = self.findings
        if not self.problem.is_exact or self.problem.n < 2:
            return
        low, high = self.problem.bounds.T
        missed = findings.seeds.missed
        is_inside = np.all((missed >= low) & (missed <= high), axis=1)
        near = is_inside & is_on_the_way(findings.seeds.gaps)
        gaps = findings.seeds.gaps[near]
        ends = missed[near]
        looks = 0
        for k in np.argsort(gaps, kind="stable"):
            if self.is_over:
                break
            if self._is_about_known(ends[k]):
                continue
            sighting = None
            if looks < LOOKS_WHERE_STOPPED:
                looks += 1
                sighting = self._examine(ends[k], 2, BRANCH_REACH)
            if sighting is not None:
                self._branch_off(_half_branch_starts(sighting.point))
            elif stops_short(float(gaps[k])):
                findings.gaps_of_stops.append(float(gaps[k]))

    def _is_about_known(self, point: np.ndarray) -> bool:
        """Whether a branch, a singular point or an assembly is next to a point (n,)."""
        findings = self.findings
        if findings.point_near(point, BRANCH_REACH) is not None:
            return True
        if findings.branch_through(point, SEED_REACH) is not None:
            return True
        return findings.rigid_within(point, BRANCH_REACH)

    # --- points next to each other ----------------------------------------------------

    def separate_points(self) -> None:
        """Look again, from nearer by, at singular points with others next to them; those
        that doubles do not separate are one."""
        findings = self.findings
        starts: list[Start] = []
        hidden: list[tuple[int, int]] = []
        for number, point in enumerate(findings.points):
            other, apart = findings.nearest_point(number)
            if self.is_over or not apart < point.radius or point.dimension > 1:
                continue
            closer = classify_from_nearby(self.problem, point, 0.5 * apart)
            if closer is None:
                next_to = findings.points[other]
                is_same = is_hidden_by(apart, point.error + next_to.error)
                if is_same or next_to.is_confirmed > point.is_confirmed:
                    hidden.append((number, other))
                continue
            findings.points[number] = closer
            starts += _half_branch_starts(closer)
        findings.merge_points(hidden)
        self._branch_off(starts)

    def join_branches(self) -> None:
        """Take two branches that stall at a point which a single branch passes for one,
        and forget what stalled on the way along another one."""
        self.findings.forget_parts()
        for point in self.findings.points:
            if self.is_over or point.kind is not Kind.RANK_DROP:
                continue
            ends = [
                (number, s)
                for number, branch in enumerate(self.findings.branches)
                for s in ends_at(self.problem, branch, point)
            ]
            if len(ends) != 2:
                continue
            (one, s), (other, t) = ends
            if one == other:
                s, t = max(s, t), min(s, t)
            branches = self.findings.branches
            joined = joined_through(
                self.problem, point, (branches[one], s), (branches[other], t)
            )
            if joined is not None:
                misclosure = largest_misclosure(self.problem, joined)
                examined = self._examine_branch(joined, misclosure)
                self.findings.replace_branches(one, other, examined.traced)

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
            solutions = solutions[is_start_solved(gaps)]
            known = len(findings.seeds.points)
            self._add_seeds(findings.seeds.with_constructed(solutions), known)
            self.trace_seeds()


def _half_branch_starts(point: SingularPoint) -> list[Start]:
    """Starts on all half-branches of a singular point, a little off it."""
    directions = point.half_branches
    return [Start(point.u + point.radius * along, along) for along in directions]


def _deep_places(profile: Profile, minima: np.ndarray) -> list[_Candidate]:
    """Nodes of a profile where the singular value is far smaller than a little before
    and a little after, and no minimum (k,) is near.

    Beside a surface that value is so small all along that its slope is lost in
    rounding, by which minima are found.
    """
    values = profile.smallest.ravel()
    arclengths = profile.arclength.ravel()
    candidates = []
    for k in np.flatnonzero(_are_lowest(values) & may_be_crossed(values)):
        before = values[max(k - BESIDE, 0) : k].max(initial=0.0)
        after = values[k + 1 : k + 1 + BESIDE].max(initial=0.0)
        beside = arclengths[max(k - 1, 0) : k + 2]
        is_found = (minima >= beside[0]) & (minima <= beside[-1])
        is_deep = is_deep_place(float(values[k]), float(min(before, after)))
        if is_deep and not np.any(is_found):
            candidate = _Candidate(
                looks=arclengths[k : k + 1],
                zero=may_be_crossed.threshold,
                must_be=bool(is_singular_to_rounding(values[k])),
            )
            candidates.append(candidate)
    return candidates


def _are_lowest(values: np.ndarray) -> np.ndarray:
    """Which of a row of values (k,) are the lowest of those about them; of equal ones
    the last."""
    walls = np.full(ABOUT, np.inf)
    windows = sliding_window_view(np.concatenate([walls, values, walls]), 2 * ABOUT + 1)
    is_lowest = np.all(values[:, None] <= windows, axis=1)
    next_values = np.append(values[1:], np.inf)
    lowest: np.ndarray = is_lowest & (values < next_values)
    return lowest


def _small_minima(arclengths: np.ndarray, values: np.ndarray) -> list[_Candidate]:
    """Minima (k,) of the singular value that may be singular points."""
    candidates = []
    for k in np.flatnonzero(may_be_crossed(values)):
        zero = max(may_be_crossed.threshold, 3 * float(values[k]))
        candidates.append(_Candidate(arclengths[k : k + 1], zero))
    return candidates
