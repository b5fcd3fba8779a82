"""Components of dimension 2 and more in a search: which seeds lie on them, their charts,
their singular points.

All along a curve of singular points on a surface F' has one rank, lower than on the
surface about it. That F = 0 and that F' has no higher rank are equations of which the
curve is a regular solution (`bifurc.curves.deflation`): it is traced like a form.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Surface
from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import trace_branch
from bifurc.curves.deflation import RankDeflated
from bifurc.decisions import (
    closes_to_rounding,
    is_same_point,
    may_be_null,
    may_be_singular,
)
from bifurc.limits import Deadline
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.singular.dimension import local_dimensions
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.singular.point import SingularPoint
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.covering import cover_surface
from bifurc.surfaces.crossing_sheets import is_on_singular_curve
from bifurc.surfaces.geodesic import entrances
from bifurc.surfaces.walk import reached_charts
from bifurc.tables import count_of

WHOLE = (Outcome.CLOSED, Outcome.LEFT_REGION)


class SingularCurve(NamedTuple):
    """A ``branch`` all along which F' has a ``rank``."""

    branch: Branch
    rank: int

    def holds(self, problem: Problem, point: SingularPoint) -> bool:
        """Whether a singular point is one of the curve."""
        if point.rank != self.rank:
            return False
        places, are_solved = RankDeflated(problem, self.rank).next_to(point.u[None])
        distance, _ = self.branch.nearest(places)
        return bool(are_solved[0] and is_same_point(distance[0], problem.domain.scale))


def singular_curve_through(
    problem: Problem, point: SingularPoint, tracing: TraceSettings, deadline: Deadline
) -> SingularCurve | None:
    """The curve of singular points of one rank on which a singular point lies; None
    where it lies on none that is regular and can be followed to its end."""
    if problem.domain.is_large or deadline.passed:
        return None
    deflated = RankDeflated(problem, point.rank)
    places, are_solved = deflated.next_to(point.u[None])
    if not are_solved[0]:
        return None
    local = local_dimensions(deflated, places, deadline)
    if local.dimension[0] != 1 or local.nullity[0] != 1 or not local.regular[0]:
        return None
    branch = trace_branch(deflated, places[0], settings=tracing, deadline=deadline)
    if branch.outcome not in WHOLE:
        return None
    return SingularCurve(branch, point.rank)


def describe_curves(curves: Sequence[SingularCurve]) -> str:
    """How many of them there are of every rank, empty where there is none."""
    kinds = Counter((curve.rank, curve.branch.closed) for curve in curves)
    parts = []
    for (rank, closed), count in sorted(kinds.items()):
        noun = "closed curve" if closed else "open curve"
        parts.append(f"singular points of rank {rank} form {count_of(count, noun)}")
    return "; ".join(parts)


SHAKY = "F' has a lower rank all over it"
RADIUS = 0.7  # of the largest charts, over the problem's scale
# Singular value, over the median on the surface, below which a singular point is looked
# for.
SMALL = 0.2
MOST_POINTS = 200  # singular points of surfaces that are located
# Those among them that are samples of curves of singular points, which have no end.
MOST_SAMPLES = 24
NULLITY = 3  # of F' at a singular point of a surface
# Distance from a chart's centre at which its singular point is looked for: over the
# chart's radius, which counts as no smaller than a share of the problem's scale.
REACH = 4.0
SMALLEST_RADIUS = 0.05
# Of the reach: a point that is located no better lies on a curve of such points.
BLURRED = 0.1
# Along such a curve there is nothing to locate, and that is all that the error says:
# the error across it, over the scale, is at most this.
ACROSS = 1e-6
# Distance, over the scale, and over the error of a point, below which two singular points
# of surfaces are one.
APART, ERRORS = 1e-5, 10
# How far beside a singular point of such a surface it is looked for, over the scale, and
# how often.
PROBE, PROBES = 1e-2, 3
ON_CURVES = "singular points are samples of curves of such points"
UNEXAMINED = "its singular points, and where forms meet it, are not looked for"
# the same where curves of singular points were reached by chance
UNEXAMINED_ELSE = "others, and where forms meet it, are not looked for"


@dataclass
class Components:
    """Numbers of the seeds on components of dimension 2 and more, by dimension, and
    charts over the surfaces. The seeds ``on_shaky`` surfaces, on which F' has a lower
    rank everywhere, are apart where one deflation does not make them regular: charts do
    not fit there.

    Parts of the charts that do not hang together are surfaces of their own: each but
    the last was finished, as far as its singular points, before the next was begun.
    ``part_of`` (k,) is the part that each seed of dimension 2 belongs to, -1 where none
    is known. ``notes`` say what is known of a part, by its number. ``deflated`` is the
    problem with which surfaces are corrected to along which F' has a lower rank; seeds
    of dimension 2 lie on such surfaces then, and ``curves`` are those of singular points
    on them, by the part of the charts, -1 where there are no charts.
    """

    seeds: dict[int, list[int]] = field(default_factory=dict)
    on_shaky: list[int] = field(default_factory=list)
    charts: ChartAtlas | None = None
    part_of: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    notes: dict[int, str] = field(default_factory=dict)
    deflated: RankDeflated | None = None
    curves: dict[int, list[SingularCurve]] = field(default_factory=dict)

    def cover(
        self, problem: Problem, points: np.ndarray, charts: int, deadline: Deadline
    ) -> list[int]:
        """Numbers of the seeds that turn out to lie on no surface: no chart fits about
        any of them.

        Up to ``charts`` charts are made over the surfaces on which those of the seeds
        ``points`` (k, n) lie. Where the covering is unfinished, the seeds beside the
        charts walk over the surface to find out which they belong to.
        """
        samples = self._samples(points, 2)
        if not len(samples) or charts <= 0 or deadline.passed:
            return []
        if self.deflated is not None:
            problem = self.deflated
        covering = cover_surface(
            problem, samples, radius=RADIUS, charts=charts, seconds=deadline.left
        )
        if len(covering):
            self.charts = covering
            chart = covering.chart_at(samples)
            # also beside charts that are complete: where surfaces cross they leave slivers
            beside = chart < 0
            chart[beside] = reached_charts(problem, covering, samples[beside], deadline)
            self.part_of = np.where(chart >= 0, covering.part[chart], -1)
            return []
        return [] if deadline.passed else self.seeds.pop(2)

    def _samples(self, points: np.ndarray, dimension: int) -> np.ndarray:
        """The seeds (k, n) of a dimension, as exact as can be known."""
        samples = points[self.seeds.get(dimension, [])]
        if self.deflated is None or dimension != 2 or not len(samples):
            return samples
        return self.deflated.project(samples)[0]

    def take_note(self, left_out: np.ndarray, on_curves: np.ndarray) -> None:
        """Remember charts at which singular points were not looked for, and charts next
        to curves of them."""
        assert self.charts is not None
        part = self.charts.part
        for k in range(int(part.max()) + 1):
            samples = int(np.count_nonzero(part[on_curves] == k))
            places = int(np.count_nonzero(part[left_out] == k))
            words = []
            if samples:
                words.append(f"{samples} of its {ON_CURVES}")
            if places:
                words.append(f"at {places} places singular points were not looked for")
            self.notes[k] = "; ".join(words)

    def parts_through(self, problem: Problem, point: np.ndarray) -> list[int]:
        """The parts of the charts on which a singular point (n,) lies; -1 alone where
        there are no charts."""
        if self.charts is None:
            return [-1]
        return [
            k
            for k, part in enumerate(self.charts.parts())
            if len(entrances(problem, part, point))
        ]

    def _note_of_lower_rank(self, part: int) -> str:
        """What is known of a part along which F' has a lower rank; -1: of seeds without
        charts."""
        parts = [SHAKY]
        words = describe_curves(self.curves.get(part, []))
        if words:
            parts.append(words)
        if part >= 0:
            parts.append(UNEXAMINED_ELSE if words else UNEXAMINED)
        return "; ".join(parts)

    @property
    def off_charts(self) -> int:
        """How many seeds of dimension 2 lie on none of the charts, nor are joined to
        any, although all surfaces on which charts fit are covered."""
        if self.charts is None or not self.charts.complete:
            return 0
        return int(np.count_nonzero(self.part_of < 0))

    def surfaces(self, points: np.ndarray) -> tuple[Surface, ...]:
        """Connected surfaces as far as there are charts, then what none of them is
        known to hold, by dimension; seeds `off_charts` show no surface."""
        surfaces: list[Surface] = []
        if self.on_shaky:
            surfaces.append(Surface(2, points[self.on_shaky], note=SHAKY))
        for dimension in sorted(self.seeds):
            samples = self._samples(points, dimension)
            if dimension == 2 and self.charts is not None:
                surfaces += self._charted_surfaces(self.charts, samples)
                samples = samples[(self.part_of < 0) & (not self.charts.complete)]
            if len(samples):
                is_shaky = dimension == 2 and self.deflated is not None
                note = self._note_of_lower_rank(-1) if is_shaky else ""
                surfaces.append(Surface(dimension, samples, note=note))
        return tuple(surfaces)

    def _charted_surfaces(
        self, charts: ChartAtlas, samples: np.ndarray
    ) -> list[Surface]:
        """The surfaces that charts cover, with those of the samples (k, n) on them."""
        surfaces = []
        for k, part in enumerate(charts.parts()):
            on_part = samples[self.part_of == k]
            if not len(on_part):
                on_part = part.centers[:1]
            note = self.notes.get(k, "")
            if self.deflated is not None:
                note = self._note_of_lower_rank(k)
            surfaces.append(Surface(2, on_part, charts=part, note=note))
        return surfaces


def components_of_seeds(
    problem: Problem, points: np.ndarray, values: np.ndarray, deadline: Deadline
) -> Components:
    """The components that those of the seeds ``points`` (k, n) lie on about which the
    solutions are of dimension 2 and more.

    ``values`` (k, n) are the singular values at the seeds. Singular points of surfaces
    are left out: they are looked at one by one.
    """
    components = Components()
    if problem.n < 2:
        return components
    doubtful = np.flatnonzero(may_be_null(values[:, problem.n - 2]))
    local = local_dimensions(problem, points[doubtful], deadline)
    for dimension in np.unique(local.dimension[local.dimension >= 2]):
        is_regular = (local.nullity == dimension) | (dimension > 2)
        numbers = doubtful[(local.dimension == dimension) & is_regular]
        if len(numbers):
            components.seeds[int(dimension)] = numbers.tolist()
    if 2 not in components.seeds and not problem.domain.is_large:
        deflated = RankDeflated(problem, problem.n - NULLITY)
        # about these fewer solutions may lie than fill the null space
        is_open = (local.nullity == NULLITY) & (local.dimension < NULLITY)
        numbers = doubtful[is_open]
        on_surfaces = _are_on_surfaces(deflated, points[numbers], deadline)
        if np.any(on_surfaces):
            rest = np.setdiff1d(doubtful, numbers[on_surfaces])
            singular = rest[may_be_singular(values[rest, problem.n - NULLITY - 1])]
            is_next = _are_next_to_surfaces(deflated, points[singular], deadline)
            numbers = np.concatenate([numbers[on_surfaces], singular[is_next]])
            components.seeds[2] = numbers.tolist()
            components.deflated = deflated
    if components.deflated is None:
        on_shaky = (local.dimension == 2) & local.shaky
        components.on_shaky = doubtful[on_shaky].tolist()
    return components


def _are_on_surfaces(
    deflated: RankDeflated, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Whether solutions (k,) next to ``points`` (k, n) lie on surfaces along which F'
    has the lower rank of the ``deflated`` problem, and no lower one."""
    on_surfaces = np.zeros(len(points), dtype=bool)
    if not len(points) or deadline.passed:
        return on_surfaces
    solutions, are_solved = deflated.next_to(points)
    local = local_dimensions(deflated, solutions[are_solved], deadline)
    is_surface = (local.dimension == 2) & (local.nullity == 2) & local.regular
    on_surfaces[are_solved] = is_surface
    return on_surfaces


def _are_next_to_surfaces(
    deflated: RankDeflated, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Whether singular solutions ``points`` (k, n) have solutions beside them, as far as
    a probe goes, that lie on such surfaces."""
    is_next = np.zeros(len(points), dtype=bool)
    rng = np.random.default_rng(0)
    for _ in range(PROBES):
        steps = rng.normal(size=points.shape)
        steps *= PROBE * deflated.domain.scale / np.linalg.norm(steps, axis=1)[:, None]
        ends, gaps = deflated.project(points + steps)
        beside = np.linalg.norm(deflated.domain.difference(ends, points), axis=1)
        is_near = closes_to_rounding(gaps) & (
            beside < 2 * PROBE * deflated.domain.scale
        )
        waiting = np.flatnonzero(is_near & ~is_next)
        is_next[waiting] = _are_on_surfaces(deflated, ends[waiting], deadline)
    return is_next


def singular_points_of(
    problem: Problem, components: Components, deadline: Deadline
) -> list[LocatedPoint]:
    """Points of surfaces where the rank of F' is lower than n - 2, nothing twice.

    They are looked for at the charts where the smallest regular singular value is
    smaller than at all neighbours, the clearest first; at most `MOST_POINTS`, and
    `MOST_SAMPLES` of those that form curves. What that leaves out, and how many are
    samples of curves, becomes a note on the surface.
    """
    charts = components.charts
    if charts is None or problem.n < NULLITY or components.deflated is not None:
        return []
    candidates = _lowest_charts(problem, charts)
    points: list[LocatedPoint] = []
    curve_charts: list[int] = []
    looked_at = 0
    for chart in candidates:
        if deadline.passed or len(points) >= MOST_POINTS:
            break
        looked_at += 1
        reach = REACH * max(charts.radii[chart], SMALLEST_RADIUS * problem.domain.scale)
        point = locate_singular_point(problem, charts.centers[chart], NULLITY, reach)
        if point is None:
            continue
        is_blurred = point.error > BLURRED * reach
        is_on_curve = is_blurred or is_on_singular_curve(problem, point)
        if is_on_curve:
            point = point._replace(
                error=min(point.error, ACROSS * problem.domain.scale)
            )
        is_one_more = is_on_curve and len(curve_charts) >= MOST_SAMPLES
        if is_one_more or _is_listed(problem, points, point):
            continue
        points.append(point)
        if is_on_curve:
            curve_charts.append(chart)
    components.take_note(candidates[looked_at:], np.array(curve_charts, dtype=int))
    return points


def _lowest_charts(problem: Problem, charts: ChartAtlas) -> np.ndarray:
    """Numbers (k,) of the charts at which the smallest regular singular value is small
    and smaller than at all neighbours, the smallest first."""
    sigma = singular_values(problem, charts.centers)[:, -NULLITY]
    lowest_beside = np.full(len(charts), np.inf)
    one, other = charts.neighbours.T
    np.minimum.at(lowest_beside, one, sigma[other])
    np.minimum.at(lowest_beside, other, sigma[one])
    is_small = sigma < SMALL * np.median(sigma)
    numbers = np.flatnonzero((sigma <= lowest_beside) & is_small)
    return numbers[np.argsort(sigma[numbers], kind="stable")]


def _is_listed(
    problem: Problem, points: list[LocatedPoint], point: LocatedPoint
) -> bool:
    """Whether a point is one of those in a list."""
    unit = (
        APART * problem.domain.scale + ERRORS * point.error
    ) / is_same_point.threshold
    gaps = [problem.domain.difference(other.u, point.u) for other in points]
    return any(is_same_point(float(np.linalg.norm(gap)), unit) for gap in gaps)


def surfaces_through(
    problem: Problem, surfaces: tuple[Surface, ...], point: np.ndarray
) -> tuple[int, ...]:
    """Indices of the surfaces with charts on which a singular point (n,) of dimension 2
    or more lies."""
    return tuple(
        index
        for index, surface in enumerate(surfaces)
        if surface.charts is not None and len(entrances(problem, surface.charts, point))
    )
