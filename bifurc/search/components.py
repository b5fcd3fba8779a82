"""Components of dimension 2 and more in a search: which seeds lie on them, their
charts, their singular points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bifurc.atlas import Surface
from bifurc.limits import Deadline
from bifurc.numerics.null_spaces import NULL, null_spaces
from bifurc.problem import Problem
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.locate import locate_singular_point
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.crossing_sheets import is_on_singular_curve
from bifurc.surfaces.geodesic import entrances
from bifurc.surfaces.walk import reached_charts

__all__ = ["Components", "lies_on", "singular_points_of", "sort_out"]

RADIUS = 0.7  # of the largest charts, over the problem's scale
# singular value, over the median on the surface, below which a singular point is looked
# for
SMALL = 0.2
MOST_POINTS = 200  # singular points of surfaces that are located
# those among them that are samples of curves of singular points, which have no end
MOST_SAMPLES = 24


@dataclass
class Components:
    """Numbers of the seeds on components of dimension 2 and more, by dimension, and
    charts over the surfaces.

    Parts of the charts that do not hang together are surfaces of their own: each but
    the last was finished, as far as its singular points, before the next was begun.
    ``part_of`` (k,) is the part that each seed of dimension 2 belongs to, -1 where none
    is known.
    """

    seeds: dict[int, list[int]] = field(default_factory=dict)
    charts: ChartAtlas | None = None
    part_of: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    notes: dict[int, str] = field(default_factory=dict)  # by the number of the part

    def cover(
        self, problem: Problem, points: np.ndarray, charts: int, deadline: Deadline
    ) -> list[int]:
        """Make up to ``charts`` charts over the surfaces on which those of the seeds
        ``points`` (k, n) lie.

        Where the covering is unfinished, the seeds beside the charts walk over the
        surface to find out which they belong to. Where no chart fits about any seed
        there is no surface: the numbers of these seeds come back.
        """
        on = points[self.seeds.get(2, [])]
        if not len(on) or charts <= 0 or deadline.passed:
            return []
        made = cover_surface(
            problem, on, radius=RADIUS, charts=charts, seconds=deadline.left
        )
        if not len(made):
            return [] if deadline.passed else self.seeds.pop(2)
        self.charts = made
        at = self.charts.chart_at(on)
        if not self.charts.complete:
            at[at < 0] = reached_charts(problem, self.charts, on[at < 0], deadline)
        self.part_of = np.where(at >= 0, self.charts.part[at], -1)
        return []

    def take_note(self, left_out: np.ndarray, on_curves: np.ndarray) -> None:
        """Remember charts at which singular points were not looked for, and charts next
        to curves of them."""
        assert self.charts is not None
        part = self.charts.part
        for k in range(int(part.max()) + 1):
            more, curves = (
                int(np.count_nonzero(part[numbers] == k))
                for numbers in (left_out, on_curves)
            )
            notes = (
                [
                    f"{curves} of its singular points are samples of curves of such points"
                ]
                if curves
                else []
            )
            notes += (
                [f"at {more} places singular points were not looked for"]
                if more
                else []
            )
            self.notes[k] = "; ".join(notes)

    def surfaces(self, points: np.ndarray) -> tuple[Surface, ...]:
        """Connected surfaces as far as there are charts, then what none of them is
        known to hold, by dimension."""
        out: list[Surface] = []
        for dimension, numbers in sorted(self.seeds.items()):
            rest = points[numbers]
            if dimension == 2 and self.charts is not None:
                for k, part in enumerate(self.charts.parts()):
                    on = rest[self.part_of == k]
                    samples = on if len(on) else part.centers[:1]
                    out.append(
                        Surface(2, samples, charts=part, note=self.notes.get(k, ""))
                    )
                rest = rest[self.part_of < 0]
            if len(rest):
                out.append(Surface(dimension, rest))
        return tuple(out)


def sort_out(
    problem: Problem, points: np.ndarray, values: np.ndarray, deadline: Deadline
) -> Components:
    """The seeds ``points`` (k, n) that lie on components of dimension 2 and more;
    ``values`` (k, n) are their singular values. Singular points of surfaces are left
    out: they are looked at one by one."""
    found = Components()
    doubtful = (
        np.flatnonzero(values[:, max(problem.n - 2, 0)] < NULL)
        if problem.n > 1
        else np.empty(0, dtype=int)
    )
    local = local_dimensions(problem, points[doubtful], deadline)
    for dimension in np.unique(local.dimension[local.dimension >= 2]):
        on = (local.dimension == dimension) & (
            (local.nullity == dimension) | (dimension > 2)
        )
        if np.any(on):
            found.seeds[int(dimension)] = doubtful[on].tolist()
    return found


def singular_points_of(
    problem: Problem, components: Components, deadline: Deadline
) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Points of surfaces where the rank of F' is lower than n - 2: each with its null
    space and error, nothing twice.

    They are looked for at the charts where the smallest regular singular value is
    smaller than at all neighbours, and where no chart fits, the clearest first; at most
    `MOST_POINTS`, and `MOST_SAMPLES` of those that form curves. What that leaves out,
    and how many are samples of curves, becomes a note on the surface.
    """
    charts = components.charts
    if charts is None or problem.n < 3:
        return []
    sigma = null_spaces(problem, charts.centers)[0][:, -3]
    lowest = np.full(len(charts), np.inf)
    i, j = charts.neighbours.T
    np.minimum.at(lowest, i, sigma[j])
    np.minimum.at(lowest, j, sigma[i])
    candidates = np.flatnonzero((sigma <= lowest) & (sigma < SMALL * np.median(sigma)))
    candidates = candidates[np.argsort(sigma[candidates], kind="stable")]
    found: list[tuple[np.ndarray, np.ndarray, float]] = []
    on_curves: list[int] = []
    looked_at = 0
    for c in candidates:
        if deadline.passed or len(found) >= MOST_POINTS:
            break
        looked_at += 1
        reach = 4.0 * max(charts.radii[c], 0.05 * problem.scale)
        located = locate_singular_point(problem, charts.centers[c], 3, reach)
        if located is None:
            continue
        on_curve = located[2] > 0.1 * reach or is_on_singular_curve(problem, located)
        point, null_space, error = located
        if (
            on_curve
        ):  # along it there is nothing to locate, and that is all that the error says
            error = min(error, 1e-6 * problem.scale)
        gaps = [
            np.linalg.norm(problem.difference(other, point)) for other, _, _ in found
        ]
        enough = on_curve and len(on_curves) >= MOST_SAMPLES
        if not enough and min(gaps, default=np.inf) > 1e-5 * problem.scale + 10 * error:
            found.append((point, null_space, error))
            on_curves += [int(c)] if on_curve else []
    components.take_note(candidates[looked_at:], np.array(on_curves, dtype=int))
    return found


def lies_on(
    problem: Problem, surfaces: tuple[Surface, ...], point: np.ndarray
) -> tuple[int, ...]:
    """Indices of the surfaces with charts on which a singular point (n,) of dimension 2
    or more lies."""
    return tuple(
        k
        for k, s in enumerate(surfaces)
        if s.charts is not None and len(entrances(problem, s.charts, point))
    )
