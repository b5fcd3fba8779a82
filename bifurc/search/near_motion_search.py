"""The search for near motions, curves along which a system is nearly solved, and how
nearly it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bifurc.curves.misclosure import NearMotionTrace
from bifurc.curves.near_motion import near_surfaces, trace_near_motion
from bifurc.decisions import closes_to_rounding, is_same_point, nearly_closes
from bifurc.limits import Deadline
from bifurc.numerics.corrector import limited
from bifurc.numerics.singular_values import factors_of, singular_values
from bifurc.problem import Problem
from bifurc.search.branches.canonical_course import canonical_course
from bifurc.search.findings import Run
from bifurc.search.seed_book import SeedFate
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds
from bifurc.system import relative_gaps, relative_jacobians, relative_residuals

STEPS = 12
LONGEST = 0.5  # step, over the problem's scale
# Singular value, over the largest, below which no step is taken along its direction.
FLAT = 1e-6
SAMPLES = 256  # of a near motion, by which it is told how far it is moved
WORK_AT_ONCE = 1e6  # points between two looks at the clock, times n^3


def closure_gap(
    problem: Problem, seeds: Seeds, gaps: Sequence[float], deadline: Deadline
) -> float:
    """Median residual, over the magnitude, along the valley in which the system is
    nearly solved; 0 where every start solves it.

    It is taken over the random starts that missed, as many as there is time for before
    the ``deadline``, and over the ``gaps`` of starts that could not be corrected; after
    the deadline it is what the starts themselves leave.
    """
    residuals = seeds.gaps
    if len(seeds.missed) and not deadline.passed:
        lowest = valley_points(problem, seeds.missed, deadline)
        residuals = np.maximum(
            relative_gaps(problem, lowest), seeds.gaps[: len(lowest)]
        )
    everywhere = np.concatenate([residuals, gaps])
    return float(np.median(everywhere)) if len(everywhere) else 0.0


def valley_points(
    problem: Problem, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Points (k, n) in the valley below the first of points (j, n) that do not solve
    the system, as many as there is time for before the ``deadline``, a few in any case.

    Gauss-Newton steps of rank n - 1 run down to the valley in which the system is
    nearly solved but not along it, so that an isolated solution at its end does not
    hide the gap. Points of a large problem stay where they are when the time is over.
    """
    at_once = max(1, int(WORK_AT_ONCE / problem.n**3))
    lowest = []
    for begin in range(0, len(points), at_once):
        part = points[begin : begin + at_once]
        for _ in range(STEPS):
            if problem.domain.is_large and deadline.passed:
                break
            part = part - limited(
                _steps_across(problem, part), LONGEST * problem.domain.scale
            )
        lowest.append(part)
        if deadline.passed:
            break
    return np.concatenate(lowest) if lowest else points


def _steps_across(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Gauss-Newton steps (k, n) of rank n - 1, to be subtracted."""
    across = problem.n - 1
    residuals = relative_residuals(problem, points)
    jacobians = relative_jacobians(problem, points)
    left, sigma, right = factors_of(jacobians, full_matrices=False)
    is_steep = sigma > FLAT * sigma[:, :1]
    is_steep[:, across:] = False
    inverse = np.zeros_like(sigma)
    inverse[is_steep] = 1.0 / sigma[is_steep]
    components = np.einsum("kmj,km->kj", left, residuals)
    steps: np.ndarray = np.einsum("kji,kj->ki", right, inverse * components)
    return steps


SAME_STARTS = 200  # from which every search looks for near motions
FRUITLESS = 4  # of those on no known near motion that in a row led to nothing new


class NearMotionSearch:
    """The search for near motions in a ``run``: `look` has starts of its own, `through`
    has that of a caller."""

    def __init__(self, run: Run):
        self.run = run
        self.problem = run.problem
        self.findings = run.findings
        # near motions that are listed elsewhere, where shifts lead from these to them
        self._elsewhere: list[NearMotionTrace] = []

    def through(self, point: np.ndarray) -> SeedFate | None:
        """That of a seed on the near motion through a point (n,), which is traced if it is
        new; None where there is none."""
        fate = self.findings.near_motion_through(point)
        if fate is not None or not len(self._not_on_known(point[None])):
            return fate
        near = self._traced(point)
        if near is None:
            return None
        shift = self.findings.shift_home(near.branch.sample(SAMPLES))
        if np.any(shift):
            # where limits cut it off, the one that is listed may be longer
            self._elsewhere.append(near)
            start = near.branch(np.array([0.5 * near.branch.length])) + shift
            fate = self.findings.near_motion_through(start[0])
            near = self._traced(start[0]) if fate is None else None
            if near is None:
                return fate
        near = replace(near, branch=canonical_course(self.problem, near.branch))
        return self.findings.add_near_motion(near)

    def _traced(self, point: np.ndarray) -> NearMotionTrace | None:
        """The near motion through a point (n,); None where there is nothing, or a form
        runs there."""
        tracing, deadline = self.run.settings.tracing, self.run.deadline
        near = trace_near_motion(self.problem, point, tracing, deadline)
        is_one = near is not None and not closes_to_rounding(near.misclosure)
        return near if is_one else None

    def look(self) -> None:
        """Trace the near motions next to where starts end that miss, where nothing
        moves.

        Besides the random starts of the search there are always the same ones, so that
        what they reach does not depend on its seed.
        """
        findings = self.findings
        components = findings.components
        is_on_component = bool(components.seeds or components.on_shaky)
        is_mobile = bool(findings.traced) or is_on_component
        is_asked = self.run.settings.near_motions
        if is_mobile or not is_asked or not len(findings.book.seeds.missed):
            return
        if self.run.is_over:
            return
        points = self._nearly_closed(findings.book.seeds.missed)
        if not len(points) or self.run.is_over:
            return
        rng, deadline = np.random.default_rng(0), self.run.deadline
        same = random_seeds(self.problem, rng, SAME_STARTS, deadline=deadline)
        always = self._nearly_closed(np.concatenate([same.points, same.missed]))
        if self.run.is_over:
            return
        surfaces, is_left = near_surfaces(self.problem, always)
        findings.near_surfaces += surfaces
        if surfaces:
            _, is_open = near_surfaces(self.problem, points)
            points = points[is_open]
        self._trace(always[is_left])
        self._trace(points)

    def _trace(self, waiting: np.ndarray) -> None:
        """Trace the near motions through points (k, n), first those through points that
        are far from singular."""
        waiting = self.findings.moved_home(waiting)
        values = singular_values(self.problem, waiting)[:, max(self.problem.n - 2, 0)]
        waiting = waiting[np.argsort(-values, kind="stable")]
        waiting = self._not_on_known(waiting)
        findings = self.findings
        fruitless = 0
        while len(waiting) and fruitless < FRUITLESS and not self.run.is_over:
            first = waiting[0]
            known = len(findings.near_motions) + len(findings.short_stretches)
            self.through(first)
            found = len(findings.near_motions) + len(findings.short_stretches)
            fruitless = fruitless + 1 if found == known else 0
            offsets = self.problem.domain.difference(waiting, first)
            apart = np.linalg.norm(offsets, axis=1)
            waiting = waiting[~is_same_point(apart, self.problem.domain.scale)]
            waiting = self._not_on_known(waiting)

    def _not_on_known(self, points: np.ndarray) -> np.ndarray:
        """Those of the points (k, n) that lie on no known near motion or short
        stretch."""
        findings = self.findings
        known = (*findings.near_motions.values(), *findings.short_stretches)
        for near in (*known, *self._elsewhere):
            if len(points):
                points = points[~near.runs_through(self.problem, points)]
        return points

    def _nearly_closed(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n) within the bounds in the valleys below points (j, n), where the
        system is nearly solved, below as many as there is time for."""
        lowest = valley_points(self.problem, points, self.run.deadline)
        is_near = nearly_closes(relative_gaps(self.problem, lowest))
        near: np.ndarray = lowest[is_near & self.problem.domain.are_inside(lowest)]
        return near
