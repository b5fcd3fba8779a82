"""Components of dimension 2 and more in a search: which seeds lie on them, their charts, their singular points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bifurc.atlas import Surface
from bifurc.charts import cover_surface
from bifurc.deadline import Deadline
from bifurc.dimension import NULL, local_dimensions, null_spaces
from bifurc.geodesic import entrances
from bifurc.problem import Problem
from bifurc.singular import locate_singular_point
from bifurc.surface import ChartAtlas

__all__ = ["Components", "lies_on", "singular_points_of", "sort_out"]

RADIUS = 0.7  # of the largest charts, over the problem's scale
SMALL = 0.2  # singular value, over the median on the surface, below which a singular point is looked for
MOST_POINTS = 24  # singular points of surfaces that are located; where they form curves there is no end to them


@dataclass
class Components:
    """Numbers of the seeds on components of dimension 2 and more, by dimension, and charts over the surfaces."""

    seeds: dict[int, list[int]] = field(default_factory=dict)
    charts: ChartAtlas | None = None

    def cover(self, problem: Problem, points: np.ndarray, charts: int, deadline: Deadline) -> None:
        """Make up to ``charts`` charts over the surfaces on which those of the seeds ``points`` (k, n) lie."""
        on = points[self.seeds.get(2, [])]
        if len(on) and charts > 0 and not deadline.passed:
            self.charts = cover_surface(problem, on, radius=RADIUS, charts=charts, seconds=deadline.left)

    def surfaces(self, points: np.ndarray) -> tuple[Surface, ...]:
        """Connected surfaces of dimension 2 as far as there are charts, then what no chart covers, by dimension."""
        out: list[Surface] = []
        for dimension, numbers in sorted(self.seeds.items()):
            rest = points[numbers]
            for part in self.charts.parts() if dimension == 2 and self.charts is not None else ():
                on = part.holds(rest)
                out.append(Surface(2, rest[on] if np.any(on) else part.centers[:1], charts=part))
                rest = rest[~on]
            if len(rest):
                out.append(Surface(dimension, rest))
        return tuple(out)


def sort_out(problem: Problem, points: np.ndarray, values: np.ndarray, deadline: Deadline) -> Components:
    """The seeds ``points`` (k, n) that lie on components of dimension 2 and more; ``values`` (k, n) are their
    singular values. Singular points of surfaces are left out: they are looked at one by one."""
    found = Components()
    doubtful = np.flatnonzero(values[:, max(problem.n - 2, 0)] < NULL) if problem.n > 1 else np.empty(0, dtype=int)
    local = local_dimensions(problem, points[doubtful], deadline)
    for dimension in np.unique(local.dimension[local.dimension >= 2]):
        on = (local.dimension == dimension) & ((local.nullity == dimension) | (dimension > 2))
        if np.any(on):
            found.seeds[int(dimension)] = doubtful[on].tolist()
    return found


def singular_points_of(
    problem: Problem, charts: ChartAtlas, deadline: Deadline
) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Points of surfaces where the rank of F' is lower than n - 2: each with its null space and error, nothing twice.

    They are looked for at the charts where the smallest regular singular value is smaller than at all neighbours, and
    where no chart fits. At most `MOST_POINTS`, the clearest first.
    """
    sigma = null_spaces(problem, charts.centers)[0][:, -3] if problem.n > 2 else np.empty(0)
    if not len(sigma):
        return []
    lowest = np.full(len(charts), np.inf)
    i, j = charts.neighbours.T
    np.minimum.at(lowest, i, sigma[j])
    np.minimum.at(lowest, j, sigma[i])
    candidates = np.flatnonzero((sigma <= lowest) & (sigma < SMALL * np.median(sigma)))
    found: list[tuple[np.ndarray, np.ndarray, float]] = []
    for c in candidates[np.argsort(sigma[candidates], kind="stable")]:
        if deadline.passed or len(found) >= MOST_POINTS:
            break
        reach = 4.0 * max(charts.radii[c], 0.05 * problem.scale)
        located = locate_singular_point(problem, charts.centers[c], 3, reach)
        if located is None:
            continue
        gaps = [np.linalg.norm(problem.difference(other, located[0])) for other, _, _ in found]
        if min(gaps, default=np.inf) > 1e-5 * problem.scale + 10 * located[2]:
            found.append(located)
    return found


def lies_on(surfaces: tuple[Surface, ...], point: np.ndarray) -> tuple[int, ...]:
    """Indices of the surfaces with charts on which a singular point (n,) of dimension 2 or more lies."""
    return tuple(k for k, s in enumerate(surfaces) if s.charts is not None and len(entrances(s.charts, point)))
