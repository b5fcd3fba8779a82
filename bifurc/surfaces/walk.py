"""Which solutions outside the charts of a surface are joined to them: each walks over
the surface to a chart."""

from __future__ import annotations

import numpy as np

from bifurc.limits import Deadline
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import (
    cosines_between_planes,
    null_spaces,
    tangent_planes,
)
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas

WALKS, STEPS = 6, 100
# Length of a step, over the radius of a chart.
LONGEST, SHORTEST = 0.5, 1e-3
# Growth of the length after a step that was taken, and after one that was not.
LONGER, SHORTER = 1.3, 0.5
# Smallest cosine between the tangent planes before and after a step on one sheet.
SMOOTH = 0.8
# Height of the surface above a step, over its length, at most.
HIGH = 0.3
# Relative residual above which the end of a step is no solution.
SOLVED = 1e-10
# Distance in the plane from a goal, over its radius, at which a walker outside its
# chart is above or below it, on another sheet.
ABOVE_GOAL = 0.3
CHUNK = 256  # walkers between two looks at the clock


def reached_charts(
    problem: Problem, charts: ChartAtlas, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Numbers (k,) of the charts that regular solutions (k, n) come to on the surface;
    -1 where no walk arrives.

    The first walk goes towards the nearest chart, the others each towards one drawn at
    random. That none arrives is no proof that there is no way: a walk ends before an
    obstacle.
    """
    rng = np.random.default_rng(0)
    arrival = np.full(len(points), -1)
    for attempt in range(WALKS):
        walkers = np.flatnonzero(arrival < 0)
        goals = None
        if attempt:
            goals = rng.integers(len(charts), size=len(walkers))
        for begin in range(0, len(walkers), CHUNK):
            if deadline.passed:
                return arrival
            part = slice(begin, begin + CHUNK)
            own_goals = None if goals is None else goals[part]
            numbers = walkers[part]
            walk = _Walk(problem, charts, points[numbers], own_goals)
            arrival[numbers] = walk.run()
    return arrival


class _Walk:
    """Walkers on the surface, each on its way to a chart.

    ``at`` (k, n) they are, in the tangent ``planes`` (k, n, d), with the longest step
    ``length`` (k,) that they try next; ``goals`` (k,) are the numbers of the charts
    they walk to, None where each walks to the nearest. ``arrival`` (k,) is the number
    of the chart in which a walker arrived, -1 before.
    """

    def __init__(
        self,
        problem: Problem,
        charts: ChartAtlas,
        points: np.ndarray,
        goals: np.ndarray | None,
    ):
        self.problem = problem
        self.charts = charts
        self.goals = goals
        _, right = null_spaces(problem, points)
        self.at = points.copy()
        self.planes = np.swapaxes(right[:, -charts.dimension :], 1, 2)
        self.longest = LONGEST * charts.radii.max()
        self.shortest = SHORTEST * charts.radii.max()
        self.length = np.full(len(points), self.longest)
        self.arrival = np.full(len(points), -1)

    def run(self) -> np.ndarray:
        """Where the walkers (k,) arrive; -1 for those that do not."""
        walkers = np.arange(len(self.at))
        for _ in range(STEPS):
            self.arrival[walkers] = self.charts.chart_at(self.at[walkers])
            has_arrived = self.arrival[walkers] >= 0
            has_stopped = self.length[walkers] <= self.shortest
            walkers = walkers[~has_arrived & ~has_stopped]
            if not len(walkers):
                break
            self._step(walkers)
        return self.arrival

    def _step(self, walkers: np.ndarray) -> None:
        """One step of the walkers of these numbers, or a shorter length where that
        fails."""
        at, planes = self.at[walkers], self.planes[walkers]
        nearest = self.charts.nearest_charts(at)
        goal = nearest if self.goals is None else self.goals[walkers]
        offset = self.charts.difference(self.charts.centers[goal], at)
        direction = np.einsum("kij,klj,kl->ki", planes, planes, offset)
        distance = np.linalg.norm(direction, axis=1)
        # small where singular points are near
        local = LONGEST * self.charts.radii[nearest]
        longest = np.minimum(self.length[walkers], local)
        share = np.minimum(1.0, longest / (distance + 1e-300))
        step = direction * share[:, None]

        ends, new_planes, is_taken = stepped(self.problem, at, planes, step)
        self.at[walkers[is_taken]] = ends[is_taken]
        self.planes[walkers[is_taken]] = new_planes[is_taken]
        longer = np.minimum(LONGER * self.length[walkers], self.longest)
        self.length[walkers] = np.where(is_taken, longer, SHORTER * longest)
        is_above_goal = distance < ABOVE_GOAL * self.charts.radii[goal]
        self.length[walkers[is_above_goal]] = 0.0


def stepped(
    problem: Problem, at: np.ndarray, planes: np.ndarray, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The ends (k, n) of ``steps`` (k, n) in the tangent spaces ``planes`` (k, n, d) of
    solutions ``at`` (k, n), corrected, with the tangent spaces there, and which of them
    (k,) stay on the sheet and inside the region."""
    ends, gaps = correct_normal(problem, at + steps, planes)
    new_planes = tangent_planes(problem, ends, planes)
    is_flat = cosines_between_planes(planes, new_planes)[:, -1] > SMOOTH
    is_near = _is_near(ends - at - steps, steps)
    is_inside = problem.domain.are_inside(ends)
    return ends, new_planes, (gaps < SOLVED) & is_inside & is_flat & is_near


def _is_near(heights: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Whether the ends of steps (k, n) were corrected by ``heights`` (k, n) that are
    small against them."""
    height = np.linalg.norm(heights, axis=1)
    length = np.linalg.norm(steps, axis=1)
    near: np.ndarray = height < HIGH * length
    return near
