"""The steps of a search, and what each of them adds."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import Deflated, RankDeflated, lower_rank_direction
from bifurc.curves.misclosure import largest_misclosure
from bifurc.decisions import (
    closes_to_rounding,
    is_at_rest,
    is_beside_singular,
    is_hidden_by,
    is_on_the_way,
    is_plainly_closed_curve,
    is_solution,
    is_start_solved,
    is_stub,
    is_weakly_isolated,
    may_be_crossed,
    may_be_mobile,
    may_be_shaky,
    may_be_singular,
    may_nearly_move,
    stops_short,
)
from bifurc.limits import Deadline, HeldInterrupt
from bifurc.numerics.blur import blur_along, distance_to_singular
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.assembly import polished
from bifurc.search.branch_examination import BranchExaminer, ExaminedBranch
from bifurc.search.certification import finer_settings, may_be_mended
from bifurc.search.components import components_of_seeds, singular_points_of
from bifurc.search.findings import NO_DOUBT, Findings
from bifurc.search.joining import joined_through
from bifurc.search.meeting_points import ends_at
from bifurc.search.more_starts import asks_for_more_starts
from bifurc.search.near_motion_search import NearMotionSearch
from bifurc.search.point_search import BRANCH_REACH, SEED_REACH, PointSearch
from bifurc.search.run import Run
from bifurc.search.seed_fates import Fate, SeedFate
from bifurc.search.singular_curves import singular_curve_through
from bifurc.search.start import Start, half_branch_starts
from bifurc.search.subdivision import Subdivision, can_be_subdivided, subdivide
from bifurc.search.subdivision_audit import audit_of, refuted_at
from bifurc.search.weak_seeds import sharpened, with_weak_solutions
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from bifurc.singular.classify import classify_from_nearby
from bifurc.singular.point import Kind

log = logging.getLogger(__name__)

# Singular values are over the problem's magnitude, lengths over its scale.
LEAVING_STUB = 20  # times shorter: a branch that leaves the bounds and is none
# A curve is traced at a misclosure a little above what it may have: the largest one
# along it, measured afterwards, decides.
LENIENT = 4.0 * is_solution.threshold
BLURRED = 1e-4  # accuracy of a seed where the rank is low: half the digits, at worst
TINY = 1e-300  # keeps a singular value of zero from being divided by
LOOKS_WHERE_STOPPED = 6  # at ends of starts that reached no solution
LOOKS_WHERE_SLOW = 4  # at ends of starts where |F| still falls
SLOW_REACH = 0.5  # how far from these, over the scale, a singular point may lie
NULLITY_OF_SHAKY = 3  # all along a curve that one deflation of the rank makes regular
MOST_MOVES = 3  # of a solution to the curve that is listed for its own
SAMPLES = 256  # of a curve, by which it is told how far it is moved
ROUNDS_IN_BOXES = 3  # each of them followed up
MOST_TIMES = 16  # as many random starts as are asked for are drawn
LOOKS_ALONG = 5  # on a branch, for a rank that is lower all along it


class _Trace(NamedTuple):
    """What a start lies on, None for no branch at all, and the starts on the branches
    that leave from there."""

    fate: SeedFate | None
    starts: list[Start]


class Search:
    """The search for all branches and singular points of a ``problem``.

    Its steps are called in their order: `gather_seeds`, `sort_seeds`, `trace_seeds`,
    `draw_more_starts`, `look_where_starts_stop`, `cover_surfaces`,
    `trace_singular_curves`, `separate_points`, `join_branches`, `mend_at_germs`,
    `audit_branches`, `audit_in_boxes`, and `near_motions.look`. Each
    adds to the findings of the ``run``. From the end of the budget on a step does
    nothing. A Ctrl-C ends the budget, and then raises `KeyboardInterrupt` between two
    starts or at the end of the block; the findings hold what is known then.
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
        self.findings = Findings(problem)
        interrupt = HeldInterrupt()
        self.run = Run(
            problem=problem,
            settings=settings,
            deadline=(deadline or Deadline(settings.budget)).or_at(interrupt),
            interrupt=interrupt,
            findings=self.findings,
        )
        self.points = PointSearch(self.run)
        self.examiner = BranchExaminer(self.run, self.points)
        self.near_motions = NearMotionSearch(self.run)

    # --- seeds ------------------------------------------------------------------------

    def gather_seeds(self, seeds: Seeds | None, random_seed: int) -> None:
        """Take the ``seeds`` given, or else those of the problem."""
        if seeds is None:
            rng = np.random.default_rng(random_seed)
            deadline = self.run.deadline
            seeds = self.problem.seeds_until(rng, self.settings.starts, deadline)
            if not self.run.is_over:
                seeds = with_weak_solutions(self.problem, seeds)
        self._add_seeds(seeds, 0)
        self.run.interrupt.check()

    def draw_more_starts(self, random_seed: int) -> None:
        """Draw as many random starts again, and trace what they reach, as long as some
        form or assembly was met by few of them."""
        more = self.findings.seeds.more
        if more is None:
            return
        drawn = self.settings.starts
        while drawn < MOST_TIMES * self.settings.starts and not self.run.is_over:
            if not asks_for_more_starts(self.findings):
                break
            rng = np.random.default_rng([random_seed, drawn])
            others = more(rng, drawn, self.run.deadline)
            drawn *= 2
            known = self.findings.seeds
            self._add_seeds(known.and_random(others), len(known.points))
            self.sort_seeds()
            self.trace_seeds()

    def _add_seeds(self, seeds: Seeds, known: int) -> None:
        """Add the ``seeds`` after the first ``known`` ones, each as near to its curve
        as it can be known."""
        points = seeds.points[known:]
        values = singular_values(self.problem, points)
        sharp = sharpened(self.problem, points, values)
        values[sharp.moved] = singular_values(self.problem, sharp.points[sharp.moved])
        both = np.concatenate([seeds.points[:known], sharp.points])
        self.findings.add_seeds(replace(seeds, points=both), values)

    def sort_seeds(self) -> None:
        """Find the seeds that lie on components of dimension 2 and more."""
        findings = self.findings
        points = findings.seeds.points
        if not len(points):
            return
        components = components_of_seeds(
            self.problem, points, findings.seed_values, self.run.deadline
        )
        findings.set_components(components)

    def trace_seeds(self) -> None:
        """Trace from every seed that lies on nothing known, and from every half-branch
        that shows up on the way."""
        findings = self.findings
        waiting = self._clearest_first(findings.open_seeds)
        matched = 0
        while waiting and not self.run.is_over:
            for branch in range(matched, len(findings.traced)):
                waiting = findings.match_seeds(waiting, branch)
            matched = len(findings.traced)
            if self.progress is not None:
                self.progress("forms", matched)
            if waiting:
                number = waiting.pop(0)
                findings.fates[number] = self._fate_of_seed(number)
            self.run.interrupt.check()

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
        fate = self._fate_on_shaky_curve(point, values)
        if fate is not None:
            return fate
        if self._may_be_singular(point, values):
            fate = self._fate_at_low_rank(point, values)
            if fate is not None:
                return fate
        trace = self._trace(Start(self._moved_home(point)))
        self._branch_off(trace.starts)
        if trace.fate is None:
            return self._fate_of_assembly(point)
        return trace.fate

    def _moved_home(self, point: np.ndarray) -> np.ndarray:
        """A solution (n,) on the curve that is listed for the one through ``point``
        (n,), where curves are the same but for shifts."""
        home = self.findings.seeds.home
        if home is None:
            return point
        for _ in range(MOST_MOVES):
            if self.findings.branch_through(point) is not None:
                break
            tracing = self.settings.tracing
            branch = trace_branch(
                self.problem, point, None, tracing, LENIENT, self.run.deadline
            )
            if not self._is_curve(branch):
                break
            samples = branch.sample(SAMPLES)
            shift = home(samples)
            if not np.any(shift):
                break
            shifted = samples + shift
            inmost = int(np.argmin(self.problem.excess(shifted)))
            solutions, gaps = self.problem.project(shifted[[inmost]])
            if not is_start_solved(float(gaps[0])):
                break
            point = solutions[0]
        return point

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
        blurred = findings.point_hidden_at(point)
        if blurred is not None:
            return SeedFate(Fate.AT_SINGULAR_POINT, blurred.number)
        solution = polished(self.problem, point)
        place = (solution.point, solution.stiffness, solution.hidden)
        known = findings.rigid_at(*place)
        if known is not None:
            return SeedFate(Fate.RIGID, known)
        if is_weakly_isolated(solution.stiffness):
            shaky = self.points.at_assembly(solution.point)
            if shaky is not None:
                return SeedFate(Fate.AT_SINGULAR_POINT, shaky)
        near = None
        if self.settings.near_motions and may_nearly_move(solution.stiffness):
            near = self.near_motions.through(point)
        if near is None or solution.is_isolated:
            return SeedFate(Fate.RIGID, findings.rigid_assembly(*place))
        return SeedFate(Fate.ON_NEAR_MOTION, near)

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
        hidden = self.findings.point_hidden_at(point)
        if hidden is not None:
            return SeedFate(Fate.AT_SINGULAR_POINT, hidden.number)
        direction = lower_rank_direction(self.problem, point)
        if direction is not None:
            fate = self._trace_lower_rank(point, direction)
            if fate.fate is Fate.ON_FORM:
                return fate
        nullity = int(np.count_nonzero(may_be_singular(values)))
        sighting = self.points.near(point, nullity, SEED_REACH)
        if sighting is None:
            return None
        self._branch_off(half_branch_starts(sighting.point))
        # points that were found on these branches may have changed its number
        known = self.findings.point_at(sighting.point.u, sighting.point.error)
        if known is None:
            known = self.findings.point_hidden_at(point)
        return None if known is None else SeedFate(Fate.AT_SINGULAR_POINT, known.number)

    def _fate_on_shaky_curve(
        self, point: np.ndarray, values: np.ndarray
    ) -> SeedFate | None:
        """The curve that a seed (n,) lies on where F' has rank n - 3 all along it; None
        where it has not."""
        n = self.problem.n
        nullity = int(np.count_nonzero(may_be_singular(values)))
        if nullity != NULLITY_OF_SHAKY or self.problem.is_large:
            return None
        number = self.findings.branch_through(point, self._blur_of_seed(values))
        if number is not None:
            return SeedFate(Fate.ON_FORM, number)
        deflated = RankDeflated(self.problem, n - NULLITY_OF_SHAKY)
        solutions, are_solved = deflated.next_to(point[None])
        last = singular_values(deflated, solutions)[0, n - 2]
        if not are_solved[0] or may_be_singular(float(last)):
            return None
        branch = trace_branch(
            deflated,
            solutions[0],
            settings=self.settings.tracing,
            deadline=self.run.deadline,
        )
        if not self._is_curve(branch):
            return None
        number = self.findings.branch_along(branch)
        if number is None:
            misclosure = largest_misclosure(self.problem, branch)
            examined = self.examiner.examine(branch, misclosure)
            number = self.findings.add_branch(examined.traced)
            self._branch_off(examined.starts)
        return SeedFate(Fate.ON_FORM, number)

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
        while queue and not self.run.is_over:
            trace = self._trace(queue.pop())
            queue += trace.starts

    def _trace(self, start: Start, is_new: bool = False) -> _Trace:
        """Trace the branch through a start, unless it is known; where the start ``is_new``
        it is not one of those along which it seems to run."""
        findings = self.findings
        number = findings.branch_through(start.point)
        if number is not None:
            return _Trace(SeedFate(Fate.ON_FORM, number), [])
        tracing, deadline = self.settings.tracing, self.run.deadline
        branch = trace_branch(self.problem, *start, tracing, LENIENT, deadline)
        is_open = branch.outcome is Outcome.OPEN
        if is_open:
            findings.gaps.append(branch.gap)
        if not self._is_curve(branch):
            log.info("no curve through %s: %s", start.point, branch.outcome.value)
            return _Trace(SeedFate(Fate.NO_SOLUTION) if is_open else None, [])
        # by rounding over a small singular value a start may lie beside its curve
        number = None if is_new else findings.branch_along(branch)
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
            near = self.near_motions.through(start.point)
            if near is not None:
                return _Trace(SeedFate(Fate.ON_NEAR_MOTION, near), [])
        examined = self.examiner.examine(branch, misclosure)
        if examined.traced.is_refused and may_be_mended(self.problem, examined.traced):
            examined = self._trace_finer(start, examined)
            number = findings.branch_along(examined.traced.branch)
        if number is None:
            number = findings.add_branch(examined.traced)
        return _Trace(SeedFate(Fate.ON_FORM, number), examined.starts)

    def _trace_finer(self, start: Start, coarse: ExaminedBranch) -> ExaminedBranch:
        """The branch through a start, traced again until its certificate holds, or the
        one of which least is refused; with the starts that all of them led to."""
        best = coarse.traced
        starts = coarse.starts
        for settings in finer_settings(self.settings.tracing):
            if self.run.is_over:
                break
            deadline = self.run.deadline
            branch = trace_branch(self.problem, *start, settings, LENIENT, deadline)
            if not self._is_curve(branch):
                continue
            misclosure = largest_misclosure(self.problem, branch)
            finer = self.examiner.examine(branch, misclosure)
            starts += finer.starts
            if finer.traced.doubt < best.doubt:
                best = finer.traced
            if best.doubt == NO_DOUBT:
                break
        return ExaminedBranch(best, starts)

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
        tracing, deadline = self.settings.tracing, self.run.deadline
        branch = trace_branch(deflated, point, direction, tracing, deadline=deadline)
        if not self._is_curve(branch):
            outcome = branch.outcome.value
            log.info("no curve of lower rank through %s: %s", point, outcome)
            return SeedFate(Fate.NO_SOLUTION)
        misclosure = largest_misclosure(self.problem, branch)
        examined = self.examiner.examine(branch, misclosure)
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
        if branch.outcome is Outcome.STALLED:
            return not is_stub(branch.length, unit)
        unit /= LEAVING_STUB
        if not is_stub(branch.length, unit):
            return True
        # what is short between two bounds is an arc of the longer curve beyond them
        is_long = not is_stub(branch.trusted_length, unit)
        return is_long and self._enters_bounds(branch)

    def _enters_bounds(self, branch: Branch) -> bool:
        """Whether a branch lies within the bounds by more than rounding somewhere, and
        does not only touch them from outside."""
        depths = -self.problem.excess(branch.sample(SAMPLES))
        return float(depths.max()) > self.problem.slack

    # --- surfaces ---------------------------------------------------------------------

    def cover_surfaces(self) -> None:
        """Cover the surfaces with charts, locate singular points on them, and trace the
        curves that leave there."""
        findings, deadline = self.findings, self.run.deadline
        components = findings.components
        refused = components.cover(
            self.problem, findings.seeds.points, self.settings.charts, deadline
        )
        findings.reopen_seeds(refused)
        self.trace_seeds()
        for located in singular_points_of(self.problem, components, deadline):
            if self.run.is_over:
                break
            sighting = self.points.sight(located)
            self._branch_off(half_branch_starts(sighting.point))

    def trace_singular_curves(self) -> None:
        """Trace the curves of singular points on surfaces along which F' has a lower
        rank; points of them, of which there is no end, are listed no longer."""
        components = self.findings.components
        if components.deflated is None:
            return
        for number in range(len(self.findings.points) - 1, -1, -1):
            point = self.findings.points[number]
            if self.run.is_over or point.kind is not Kind.SURFACE:
                continue
            parts = components.parts_through(self.problem, point.u)
            if len(parts) != 1:
                continue  # surfaces meet there
            curves = components.curves.setdefault(parts[0], [])
            if not any(curve.holds(self.problem, point) for curve in curves):
                curve = singular_curve_through(
                    self.problem, point, self.settings.tracing, self.run.deadline
                )
                if curve is None:
                    continue
                curves.append(curve)
            self.findings.forget_on_surface(number)

    # --- where starts stop ------------------------------------------------------------

    def look_where_starts_stop(self) -> None:
        """Look for singular points where starts end short of a solution, about nothing
        that is known: beside an isolated point of high order F is so flat that they do,
        and beside one in a narrow valley of |F| they come down too slowly."""
        findings = self.findings
        if not self.problem.is_exact or self.problem.n < 2:
            return
        missed = findings.seeds.missed
        is_inside = self.problem.are_inside(missed)
        is_near = is_inside & is_on_the_way(findings.seeds.gaps)
        self._look_at_ends(missed[is_near], findings.seeds.gaps[is_near])
        is_slow = is_inside & ~is_near
        is_slow[is_slow] = ~is_at_rest(self._slopes(missed[is_slow]))
        ends = missed[is_slow]
        order = np.argsort(findings.seeds.gaps[is_slow], kind="stable")
        for end in ends[order[:LOOKS_WHERE_SLOW]]:
            if not self.run.is_over and not self._is_about_known(end):
                self._look_at(end, SLOW_REACH)

    def _look_at_ends(self, ends: np.ndarray, gaps: np.ndarray) -> None:
        """Look at ends (k, n) of starts with small ``gaps`` (k,); those that lead to
        nothing are noted."""
        looks = 0
        for k in np.argsort(gaps, kind="stable"):
            if self.run.is_over:
                break
            if self._is_about_known(ends[k]):
                continue
            looks += 1
            is_looked_at = looks <= LOOKS_WHERE_STOPPED
            if is_looked_at and self._look_at(ends[k], BRANCH_REACH):
                continue
            if stops_short(float(gaps[k])):
                self.findings.gaps_of_stops.append(float(gaps[k]))

    def _look_at(self, end: np.ndarray, reach: float) -> bool:
        """Whether a singular point is at less than ``reach`` scales from the end (n,) of
        a start; what leaves there is traced."""
        sighting = self.points.near(end, 2, reach)
        if sighting is None:
            return False
        self._branch_off(half_branch_starts(sighting.point))
        return True

    def _slopes(self, ends: np.ndarray) -> np.ndarray:
        """The slopes (k,) of |F| at ends (k, n) of starts, over the size of F' there."""
        values = self.problem.residuals(ends)
        matrices = self.problem.jacobians(ends)
        sizes = np.linalg.norm(values, axis=1) * np.linalg.norm(matrices, axis=(1, 2))
        products = np.einsum("km,kmn->kn", values, matrices)
        slopes: np.ndarray = np.linalg.norm(products, axis=1) / (sizes + TINY)
        return slopes

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
            if self.run.is_over or not apart < point.radius or point.dimension > 1:
                continue
            closer = classify_from_nearby(self.problem, point, 0.5 * apart)
            if closer is None:
                next_to = findings.points[other]
                is_same = is_hidden_by(apart, point.error + next_to.error)
                if is_same or next_to.is_confirmed > point.is_confirmed:
                    hidden.append((number, other))
                continue
            findings.points[number] = closer
            starts += half_branch_starts(closer)
        findings.merge_points(hidden)
        self._branch_off(starts)

    def mend_at_germs(self) -> None:
        """Trace the branches again that do not follow the germs of singular points."""
        if not self.findings.germs or self.run.is_over:
            return
        # what it needs takes long to import
        from bifurc.search.germ_mending import GermMender

        starts = GermMender(self.run, self.examiner).mend()
        self._branch_off(starts)
        self.trace_seeds()

    def join_branches(self) -> None:
        """Take two branches that stall at a point which a single branch passes for one,
        and forget what stalled on the way along another one."""
        self.findings.forget_parts()
        for point in self.findings.points:
            if self.run.is_over or point.kind is not Kind.RANK_DROP:
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
                examined = self.examiner.examine(joined, misclosure)
                self.findings.replace_branches(one, other, examined.traced)

    # --- audit ------------------------------------------------------------------------

    def audit_branches(self) -> None:
        """Hold the branches against the problem's audit, and trace what it leads to,
        until that is nothing new."""
        findings = self.findings
        judge = findings.seeds.audit
        while judge is not None and findings.awaits_audit and not self.run.is_over:
            seconds = self.run.deadline.left if self.settings.prove else 0.0
            audit = judge(findings.branches, seconds)
            findings.set_audit(audit)
            self.run.interrupt.check()
            solutions, gaps = self.problem.project(audit.starts)
            solutions = solutions[is_start_solved(gaps)]
            known = len(findings.seeds.points)
            self._add_seeds(findings.seeds.with_constructed(solutions), known)
            self.trace_seeds()

    def audit_in_boxes(self) -> None:
        """Divide the bounds of exact equations into boxes, and trace the arcs that show
        up there, until all are known or nothing new comes of it."""
        findings = self.findings
        is_asked = self.settings.boxes > 0 and findings.seeds.audit is None
        if not is_asked or findings.components.seeds or self.run.is_over:
            return
        are_curves = all(t.profile.rank == self.problem.n - 1 for t in findings.traced)
        if not are_curves or not can_be_subdivided(self.problem):
            return
        for _ in range(ROUNDS_IN_BOXES):
            division = self._divided(self.settings.boxes)
            if division.is_complete:
                findings.set_audit(audit_of(division))
                return
            known = (*findings.traced, *findings.points)
            self._follow_up(division)
            is_changed = (*findings.traced, *findings.points) != known
            if self.run.is_over or not is_changed:
                break
            # what is new has not been through the steps before
            self.separate_points()
            self.join_branches()
            self.mend_at_germs()
        for number, s in self._divided(0).refuted:
            findings.traced[number] = refuted_at(findings.traced[number], s)

    def _divided(self, boxes: int) -> Subdivision:
        """The bounds divided into so many ``boxes`` at most, with what is known now."""
        return subdivide(
            self.problem,
            self.findings.branches,
            self.findings.points,
            boxes,
            self.run.is_over_now,
        )

    def _follow_up(self, division: Subdivision) -> None:
        """Trace what a subdivision found, and look at what it left; what it refuted is
        forgotten where others take its place."""
        findings = self.findings
        refuted = [findings.traced[number] for number, _ in division.refuted]
        for point in division.found:
            if not self.run.is_over:
                self._branch_off(self._trace(Start(point), is_new=True).starts)
        for point in division.seeds:
            if not self.run.is_over:
                self._branch_off(self._trace(Start(point)).starts)
        findings.forget_covered(refuted)
        values = singular_values(self.problem, division.left)[:, self.problem.n - 2]
        for place in division.left[may_be_crossed(values)]:
            sighting = self.points.near(place, 2, BRANCH_REACH)
            if sighting is not None and sighting.is_new:
                self._branch_off(half_branch_starts(sighting.point))
        self.trace_seeds()
        self.run.interrupt.check()
