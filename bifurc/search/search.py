"""The steps of a search, and what each of them adds."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from bifurc.decisions import (
    is_at_rest,
    is_hidden_by,
    is_on_the_way,
    is_start_solved,
    may_be_crossed,
    may_be_mobile,
    stops_short,
)
from bifurc.limits import CutOff, Deadline, cut_off_after
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.search.answer.completeness import asks_for_more_starts
from bifurc.search.answer.meeting_points import ends_at
from bifurc.search.branches.branch_examination import BranchExaminer
from bifurc.search.branches.branch_parts import joined_through
from bifurc.search.components import (
    SurfacePoint,
    components_of_seeds,
    cover_components,
    crossings_beside_curves,
    join_samples,
    parts_through,
    recognise_products,
    singular_curve_through,
    singular_points_of,
)
from bifurc.search.findings import Findings, Run
from bifurc.search.near_motion_search import NearMotionSearch
from bifurc.search.path_audit import PathAudit
from bifurc.search.point_search import BRANCH_REACH, SEED_REACH, PointSearch
from bifurc.search.records import (
    PointSighting,
    SingularCurve,
    Start,
    half_branch_starts,
)
from bifurc.search.seed_book import Fate, SeedFate
from bifurc.search.seed_fates import SeedJudge
from bifurc.search.solutions import (
    sharpened,
    solutions_in_bounds,
    with_weak_solutions,
)
from bifurc.search.strands import missing_crossings
from bifurc.search.subdivision import (
    Subdivision,
    audit_of,
    can_be_subdivided,
    refuted_at,
    subdivide,
)
from bifurc.search.tracing import Tracer
from bifurc.seeds import Seeds
from bifurc.settings import SearchSettings
from bifurc.singular.classify import classify_from_nearby
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.point import Kind

log = logging.getLogger(__name__)

TINY = 1e-300  # keeps a slope of zero from being divided by
LOOKS_WHERE_STOPPED = 6  # at ends of starts that reached no solution
LOOKS_WHERE_SLOW = 4  # at ends of starts where |F| still falls
SLOW_REACH = 0.5  # how far from these, over the scale, a singular point may lie
SORTING = 0.3  # of the time that is left, to tell on what seeds lie
ROUNDS_IN_BOXES = 3  # each of them followed up
MOST_TIMES = 16  # as many random starts as are asked for are drawn
LEAST_SAMPLED = 3  # dimension of a component that charts do not cover

# What a step leads to, one after another: starts of branches, which are traced with
# all that hangs on them, and then the seeds of which nothing is known yet, before the
# step goes on.
Starts: TypeAlias = Iterator[Sequence[Start]]


class Search:
    """The search for all branches and singular points of a ``problem``, from the
    ``seeds`` given, or else from its own.

    Each of the `STEPS` adds to the findings of the ``run`` until nothing new comes of
    it. From the end of the budget on a step does nothing, and a step that does not end
    soon is cut off. Where it ``ends_at_surfaces`` it does as soon as there are some. A
    Ctrl-C that the ``deadline`` holds ends the budget. The findings hold
    what is known then.
    """

    def __init__(
        self,
        problem: Problem,
        settings: SearchSettings,
        random_seed: int,
        seeds: Seeds | None,
        progress: Callable[[str, int], None] | None,
        deadline: Deadline,
        ends_at_surfaces: bool = False,
    ):
        self.problem = problem
        self.ends_at_surfaces = ends_at_surfaces
        self.settings = settings
        self.seeds = seeds
        self.random_seed = random_seed
        self.progress = progress
        self.step = ""
        self.findings = Findings(problem)
        self.run = Run(
            problem=problem,
            settings=settings,
            deadline=deadline,
            findings=self.findings,
        )
        self.points = PointSearch(self.run)
        self.examiner = BranchExaminer(self.run, self.points)
        self.near_motions = NearMotionSearch(self.run)
        self.tracer = Tracer(self.run, self.examiner, self.near_motions)
        self.judge = SeedJudge(self.run, self.points, self.tracer)
        self.paths = PathAudit(self.run, self.points, self._add_seeds)

    def take_steps(self) -> None:
        """Take all steps, each until it leads to nothing new."""
        deadline = self.run.deadline
        try:
            with cut_off_after(deadline):
                for step in STEPS:
                    self.step = step.__name__.replace("_", " ")
                    self._tell()
                    for starts in step(self):
                        if self.ends_at_surfaces and self.findings.components.seeds:
                            return
                        self.tracer.branch_off(starts)
                        self.trace_seeds()
                self.near_motions.look()
        except CutOff:
            log.info("a step was cut off at the end of the time")

    def _tell(self) -> None:
        """Say how many forms there are, and which step is taken."""
        if self.progress is not None:
            what = f"forms so far; step: {self.step}"
            self.progress(what, len(self.findings.traced))

    # --- seeds ------------------------------------------------------------------------

    def gather_seeds(self) -> Starts:
        """Take the seeds given, or else those of the problem."""
        seeds = self.seeds
        if seeds is None:
            rng = np.random.default_rng(self.random_seed)
            deadline = self.run.deadline
            seeds = self.problem.seeds(rng, self.settings.starts, deadline)
            if not self.run.is_over:
                seeds = with_weak_solutions(self.problem, seeds)
        self._add_seeds(seeds)
        self._sort_seeds()
        yield []

    def draw_more_starts(self) -> Starts:
        """Draw as many random starts again, as long as some form or assembly was met by
        few of them."""
        more = self.findings.book.seeds.more
        if more is None:
            return
        drawn = self.settings.starts
        while drawn < MOST_TIMES * self.settings.starts and not self.run.is_over:
            if not asks_for_more_starts(self.findings):
                break
            rng = np.random.default_rng([self.random_seed, drawn])
            others = more(rng, drawn, self.run.deadline)
            drawn *= 2
            self._add_seeds(self.findings.book.seeds.and_random(others))
            self._sort_seeds()
            yield []

    def _add_seeds(self, seeds: Seeds) -> None:
        """Take ``seeds``, which begin with those known so far; each new one as near to
        its curve as it can be known."""
        known = self.findings.book.seeds.points
        points = seeds.points[len(known) :]
        values = singular_values(self.problem, points)
        sharp = sharpened(self.problem, points, values)
        values[sharp.moved] = singular_values(self.problem, sharp.points[sharp.moved])
        both = np.concatenate([known, sharp.points])
        self.findings.book.add(replace(seeds, points=both), values)

    def _sort_seeds(self) -> None:
        """Find the seeds that lie on components of dimension 2 and more."""
        book = self.findings.book
        if len(book.seeds.points):
            values = book.values.copy()
            values[self._settle_held()] = np.inf
            share = self.run.deadline.share(SORTING)
            components = components_of_seeds(
                self.problem, book.seeds.points, values, share
            )
            self.findings.set_components(components)

    def _settle_held(self) -> list[int]:
        """List the seeds in a bound that are held there as assemblies, as a sheet that
        cannot fold as it is assigned; their numbers."""
        book, domain = self.findings.book, self.problem.domain
        points = book.seeds.points
        is_open = domain.are_at_bounds(points) & may_be_mobile(book.values[:, -1])
        if domain.is_large:  # nothing else is known of such
            is_open &= [book.seeds.know_isolated(point) for point in points]
        numbers = np.flatnonzero(is_open).tolist()
        held = [number for number in numbers if self.findings.is_held(points[number])]
        for number in held:
            book.settle([number], self.findings.add_assembly(points[number]))
        return held

    def trace_seeds(self) -> None:
        """Trace from every seed that lies on nothing known, and from every half-branch
        that shows up on the way."""
        findings = self.findings
        waiting = findings.book.open_seeds
        matched = 0
        while waiting and not self.run.is_over:
            for branch in list(findings.traced)[matched:]:
                waiting = findings.match_seeds(waiting, branch)
            matched = len(findings.traced)
            self._tell()
            if waiting:
                number = waiting.pop(0)
                findings.book.fates[number] = self.judge.fate_of(number)

    # --- surfaces ---------------------------------------------------------------------

    def cover_surfaces(self) -> Starts:
        """Cover the surfaces with charts, and locate singular points on them."""
        findings, deadline = self.findings, self.run.deadline
        components = findings.components
        seeds, tracing = findings.book.seeds.points, self.settings.tracing
        recognise_products(components, self.problem, seeds, tracing, deadline)
        refused = cover_components(
            components,
            self.problem,
            seeds,
            self.settings.charts,
            deadline,
        )
        findings.book.reopen(refused)
        join_samples(components, self.problem, seeds, deadline)
        yield []
        for point in singular_points_of(self.problem, components, deadline):
            if self.run.is_over:
                break
            yield half_branch_starts(self._sight_on_surface(point).point)

    def _sight_on_surface(self, point: SurfacePoint) -> PointSighting:
        """A singular point of a surface, classified and recorded."""
        sighting = self.points.sight(point.located)
        if point.is_sample and sighting.is_new:
            sample = replace(sighting.point, is_sample=True)
            self.findings.points[sighting.number] = sample
        return sighting

    def trace_singular_curves(self) -> Starts:
        """Trace the curves of singular points on surfaces. Of the points of each, of
        which there is no end, one is listed for all surfaces that meet in it, and none
        where it is on a single one."""
        findings, components = self.findings, self.findings.components
        if not components.has_surfaces:
            return
        for number, point in reversed(list(findings.points.items())):
            is_of_surface = point.kind in (Kind.SURFACE, Kind.CURVE_SAMPLE)
            is_of_surface &= point.dimension == 2
            if not self.run.is_over and is_of_surface:
                self._trace_singular_curve(number)
        deadline = self.run.deadline
        for found in crossings_beside_curves(self.problem, components, deadline):
            u, null_space = found.located.u, found.located.null_space
            rank = self.problem.n - null_space.shape[1]
            parts = parts_through(components, self.problem, u)
            curve = self._singular_curve_through(u, rank)
            if curve is not None and len(parts) == 1:
                components.notes[2].add_curve(curve, parts)
                continue
            sighting = self._sight_on_surface(found)
            if sighting.is_new and sighting.point.kind is Kind.CURVE_SAMPLE:
                self._trace_singular_curve(sighting.number)
        yield []

    def _singular_curve_through(self, u: np.ndarray, rank: int) -> SingularCurve | None:
        """The curve of singular points of a ``rank`` on which one at ``u`` (n,) lies."""
        components, deadline = self.findings.components, self.run.deadline
        tracing = self.settings.tracing
        return singular_curve_through(
            self.problem, components, u, rank, tracing, deadline
        )

    def _trace_singular_curve(self, number: int) -> None:
        """Trace the curve of singular points on which a singular point, given by its
        number, lies."""
        findings, components = self.findings, self.findings.components
        point = findings.points[number]
        parts = parts_through(components, self.problem, point.u)
        curve = self._singular_curve_through(point.u, point.rank)
        if curve is None or not parts:
            if point.is_sample:
                components.notes[2].unfollowed.append(parts)
            return
        is_new = components.notes[2].add_curve(curve, parts)
        if is_new and len(parts) > 1:
            # digits that show isolated points do not show a curve, which is known now
            sample = replace(point, is_sample=True, is_confirmed=True)
            findings.points[number] = sample
        else:
            findings.forget_point(number, SeedFate(Fate.ON_COMPONENT, 2))

    # --- where starts stop ------------------------------------------------------------

    def look_where_starts_stop(self) -> Starts:
        """Look for singular points where starts end short of a solution, about nothing
        that is known: beside an isolated point of high order F is so flat that they do,
        and beside one in a narrow valley of |F| they come down too slowly."""
        if not self.problem.accuracy.is_exact or self.problem.n < 2:
            return
        findings = self.findings
        seeds = findings.book.seeds
        order = np.argsort(seeds.gaps, kind="stable")
        ends, gaps = seeds.missed[order], seeds.gaps[order]
        is_inside = self.problem.domain.are_inside(ends)
        is_near = is_inside & is_on_the_way(gaps)
        looks = 0
        for k in np.flatnonzero(is_near):
            if self.run.is_over:
                return
            if findings.is_known_about(ends[k], BRANCH_REACH, SEED_REACH):
                continue
            looks += 1
            sighting = None
            if looks <= LOOKS_WHERE_STOPPED:
                sighting = self.points.near(ends[k], 2, BRANCH_REACH)
            if sighting is not None:
                yield half_branch_starts(sighting.point)
            elif stops_short(float(gaps[k])):
                findings.gaps_of_stops.append(float(gaps[k]))
        if self.run.is_over:
            return
        is_slow = is_inside & ~is_near
        is_slow[is_slow] = ~is_at_rest(self._slopes(ends[is_slow]))
        for end in ends[is_slow][:LOOKS_WHERE_SLOW]:
            is_known = findings.is_known_about(end, BRANCH_REACH, SEED_REACH)
            if self.run.is_over or is_known:
                continue
            sighting = self.points.near(end, 2, SLOW_REACH)
            if sighting is not None:
                yield half_branch_starts(sighting.point)

    def _slopes(self, ends: np.ndarray) -> np.ndarray:
        """The slopes (k,) of |F| at ends (k, n) of starts, over the size of F' there."""
        values = self.problem.residuals(ends)
        matrices = self.problem.jacobians(ends)
        sizes = np.linalg.norm(values, axis=1) * np.linalg.norm(matrices, axis=(1, 2))
        products = np.einsum("km,kmn->kn", values, matrices)
        slopes: np.ndarray = np.linalg.norm(products, axis=1) / (sizes + TINY)
        return slopes

    def look_at_bounds(self) -> Starts:
        """Take solutions in single bounds for seeds, where nothing is known: of a curve
        or a surface of which only a corner is in the region random starts end outside."""
        findings, problem = self.findings, self.problem
        if findings.components.seeds or self.run.is_over:
            return
        points = solutions_in_bounds(problem, np.random.default_rng(0))
        if len(points):
            points = points[~findings.are_on_branches(points)]
        if len(points):
            self._add_seeds(findings.book.seeds.with_constructed(points))
            self._sort_seeds()
            yield []

    # --- what doubles mistake ---------------------------------------------------------

    def separate_points(self) -> Starts:
        """Look again, from nearer by, at singular points with others next to them; those
        that doubles do not separate are one."""
        points = self.findings.points
        starts: list[Start] = []
        hidden: list[tuple[int, int]] = []
        for number, point in points.items():
            other, apart = self.findings.nearest_point(number)
            if self.run.is_over or not apart < point.radius or point.dimension > 1:
                continue
            closer = classify_from_nearby(self.problem, point, 0.5 * apart)
            if closer is None:
                next_to = points[other]
                is_same = is_hidden_by(apart, point.error + next_to.error)
                if is_same or next_to.is_confirmed > point.is_confirmed:
                    hidden.append((number, other))
                continue
            points[number] = closer
            starts += half_branch_starts(closer)
        self.findings.merge_points(hidden)
        yield starts

    def join_branches(self) -> Starts:
        """Take two branches that stall at a point which a single branch passes for one,
        and forget what stalled on the way along another one."""
        findings = self.findings
        findings.forget_parts()
        for point in findings.points.as_they_come():
            if self.run.is_over or point.kind is not Kind.RANK_DROP:
                continue
            ends = [
                (number, traced.branch, s)
                for number, traced in findings.traced.items()
                for s in ends_at(self.problem, traced.branch, point)
            ]
            if len(ends) != 2:
                continue
            (one, before, s), (other, after, t) = ends
            if one == other:
                s, t = max(s, t), min(s, t)
            joined = joined_through(self.problem, point, (before, s), (after, t))
            if joined is not None:
                examined = self.examiner.examine(joined)
                findings.replace_branches(one, other, examined.traced)
        yield []

    def look_for_missing_crossings(self) -> Starts:
        """Look for the crossings that must be next to singular points, by where the
        branches enter and leave discs about these."""
        findings = self.findings
        if findings.components.seeds:
            return
        points = list(findings.points.values())
        is_any = False
        for missing in missing_crossings(self.problem, points, findings.branches):
            is_any = True
            if self.run.is_over:
                return
            sighting = self.points.near(missing.place, 2, BRANCH_REACH)
            if sighting is not None and sighting.is_new:
                yield half_branch_starts(sighting.point)
        if not is_any:
            findings.set_all_crossings()

    def mend_at_germs(self) -> Starts:
        """Trace the branches again that do not follow the germs of singular points."""
        if self.findings.germs and not self.run.is_over:
            # what it needs takes long to import
            from bifurc.search.branches.germ_mending import GermMender

            yield GermMender(self.run, self.examiner).mend()

    # --- audit ------------------------------------------------------------------------

    def audit_branches(self) -> Starts:
        """Hold the branches against the problem's audit, and take what it leads to for
        seeds."""
        findings = self.findings
        judge = findings.book.seeds.audit
        while judge is not None and findings.awaits_audit and not self.run.is_over:
            seconds = self.run.deadline.left if self.settings.count else 0.0
            audit = judge(findings.branches, seconds)
            findings.set_audit(audit)
            solutions, gaps = self.problem.project(audit.starts)
            solutions = self._off_known_components(solutions[is_start_solved(gaps)])
            self._add_seeds(findings.book.seeds.with_constructed(solutions))
            yield []

    def _off_known_components(self, solutions: np.ndarray) -> np.ndarray:
        """Those of the solutions (k, n) that are no more samples of what is known to
        have dimension 3 or more: there, curves through each of them have no end."""
        if max(self.findings.components.seeds, default=0) < LEAST_SAMPLED:
            return solutions
        local = local_dimensions(self.problem, solutions, self.run.deadline)
        return solutions[local.dimension < LEAST_SAMPLED]

    def count_isolated(self) -> Starts:
        """Take all isolated solutions of as many polynomials as unknowns for seeds."""
        yield from self.paths.count_isolated()

    def count_curves(self) -> Starts:
        """Take points on all real parts of the curves of polynomials for seeds."""
        yield from self.paths.count_curves()

    def audit_in_boxes(self) -> Starts:
        """Divide the bounds of exact equations into boxes, and trace the arcs that show
        up there, until all are known or nothing new comes of it."""
        findings = self.findings
        is_asked = self.settings.boxes > 0 and findings.book.seeds.audit is None
        if not is_asked or findings.components.seeds or self.run.is_over:
            return
        ranks = {traced.profile.rank for traced in findings.traced.values()}
        if not ranks <= {self.problem.n - 1} or not can_be_subdivided(self.problem):
            return
        for _ in range(ROUNDS_IN_BOXES):
            division = self._divided(self.settings.boxes)
            if division.is_complete:
                findings.set_audit(audit_of(division))
                return
            known = self._known()
            yield from self._follow_up(division)
            if self.run.is_over or self._known() == known:
                break
            # what is new has not been through the steps before
            yield from self.separate_points()
            yield from self.join_branches()
            yield from self.mend_at_germs()
        for number, s in self._divided(0).refuted:
            findings.traced[number] = refuted_at(findings.traced[number], s)

    def _known(self) -> list[object]:
        """All branches and singular points that are known now."""
        findings = self.findings
        return [*findings.traced.values(), *findings.points.values()]

    def _divided(self, boxes: int) -> Subdivision:
        """The bounds divided into so many ``boxes`` at most, with what is known now."""
        branches, points = self.findings.branches, self.findings.points.values()
        division = subdivide(self.problem, branches, list(points), boxes)
        numbers = list(self.findings.traced)
        refuted = [(numbers[index], s) for index, s in division.refuted]
        return replace(division, refuted=tuple(refuted))

    def _follow_up(self, division: Subdivision) -> Starts:
        """Trace what a subdivision found, and look at what it left; what it refuted is
        forgotten where others take its place. What lies on a bound, or by rounding beyond
        it, may be the end of a curve that is known inside."""
        findings = self.findings
        domain = self.problem.domain
        is_within = domain.excess(division.found) < -domain.slack
        starts = [*zip(division.found, is_within.tolist(), strict=True)]
        starts += [(point, False) for point in division.seeds]
        for point, is_new in starts:
            if not self.run.is_over:
                yield self.tracer.trace(Start(point), is_new).starts
        findings.forget_covered([number for number, _ in division.refuted])
        values = singular_values(self.problem, division.left)[:, self.problem.n - 2]
        for place in division.left[may_be_crossed(values)]:
            sighting = self.points.near(place, 2, BRANCH_REACH)
            if sighting is not None and sighting.is_new:
                yield half_branch_starts(sighting.point)
        yield []


STEPS: tuple[Callable[[Search], Starts], ...] = (
    Search.gather_seeds,
    Search.draw_more_starts,
    Search.look_where_starts_stop,
    Search.look_at_bounds,
    Search.cover_surfaces,
    Search.trace_singular_curves,
    Search.look_for_missing_crossings,
    Search.separate_points,
    Search.join_branches,
    Search.mend_at_germs,
    Search.audit_branches,
    Search.count_isolated,
    Search.audit_in_boxes,
    Search.count_curves,
)
