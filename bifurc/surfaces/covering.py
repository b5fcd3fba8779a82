"""Components of dimension 2 and more, covered by charts in their tangent planes
(Henderson 2002).

Every chart is a disk in a tangent plane and a polygon about its centre, cut by the line
through the intersection with each chart that overlaps it. A vertex of the polygon
outside the disk shows that the surface is not covered there: its direction leads to the
centre of the next chart. The surface is covered when no vertex is outside. In more
dimensions disks are balls, polygons polytopes and lines planes; nothing else changes
until the charts are measured, which those of surfaces alone are.

M. E. Henderson 2002, Multiple parameter continuation: computing implicitly defined
k-manifolds, Int. J. Bifurcation and Chaos 12, 451-476. In its formula for the cutting
line the distance in the tangent plane is corrected for the bend of the surface, so that
both charts are cut along the same line up to fourth order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc import _core, torus
from bifurc.decisions import is_null
from bifurc.domain import Domain
from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.corrector import compiled_equations
from bifurc.numerics.null_spaces import null_spaces
from bifurc.problem import Problem
from bifurc.surfaces.area import Sizes, cell_sizes
from bifurc.surfaces.beside_bounds import disk_beside_bounds, turns_back
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.complex import (
    Cells,
    fitted_cells,
    neighbours_of,
    without_empty_polygons,
)
from bifurc.surfaces.crossing_sheets import has_uncovered_crossing
from bifurc.surfaces.disk import OF_OTHERS, OF_SURFACES, Disk, TangentPlane
from bifurc.surfaces.other_sheets import solutions_across
from bifurc.surfaces.polygon import BORDER, FlatCharts, Polygon
from bifurc.surfaces.sheet import SOLVED, follow_sheets
from bifurc.surfaces.singular_places import SingularPlaces

# Largest height above a disk at which a solution lies in it, over the distance in its
# plane and the bend that disks may have; rounding is allowed for.
STEEPEST, ROUNDING = 2.0, 1e-9
# Distance of that solution from the centre, over the radius.
RIM = 1.1
# Radius over the largest one below which no chart is made next to a singular point, and
# how far from that, over this radius.
SMALLEST, NEXT_TO = 1.0 / 64, 16.0
# The same beside a bound that only just cuts the surface.
SMALLEST_BESIDE_BOUNDS = 1.0 / 256
# Radius over the scale below which no chart is made at all: the size of a neck.
TINIEST = 1e-8
# Radius of a chart that is too large among others, over what it was, and how often that
# is looked at.
SMALLER, MENDING = 0.7, 6
# In how many rounds areas are measured; in one only where more would not be worth while.
ROUNDS, UNFINISHED = 3, (Covering.CHART_LIMIT, Covering.OUT_OF_TIME)
# Distance, over the scale, below which the end of a ray is a solution that is known.
SAME = 1e-7
# Work for a chart beside other sheets, to which all those about it have to be told apart,
# over that for another one, in more than two dimensions.
UNCLEAR = 4
# Pairs of charts of which it is not known whether they are on one sheet, at most.
MOST_UNDECIDED = 20

Placement = _core.Placement
COVERS: dict[int, type[_core.Cover] | type[_core.Cover3]] = {
    2: _core.Cover,
    3: _core.Cover3,
    4: _core.Cover4,
    5: _core.Cover5,
}
MOST_DIMENSIONS = max(COVERS)  # of a component that charts are made over


def cover_surface(
    problem: Problem,
    seeds: np.ndarray,
    *,
    radius: float = 0.5,
    charts: int = 2000,
    seconds: float = np.inf,
    atlas: ChartAtlas | None = None,
    metric: np.ndarray | None = None,
) -> ChartAtlas:
    """Charts over the components of dimension 2 that the regular solutions ``seeds``
    (k, n) lie on.

    ``radius`` is the largest of a chart, in units of the problem's scale: they shrink
    where the surface bends. At most ``charts`` charts are made in at most ``seconds``;
    those of an ``atlas``, of an earlier call, stay and are continued. Areas are taken
    after the unknowns are multiplied by ``metric`` (n,), by 1 unless given. Raises
    `ProblemError` for seeds of a wrong shape and limits that are not positive.
    """
    seeds = np.asarray(seeds, dtype=float)
    _check(problem, seeds, radius=radius, charts=charts, seconds=seconds)
    deadline = Deadline(seconds)
    cover = _Cover(problem, radius * problem.domain.scale, 2)
    if atlas is not None:
        cover.add_all(atlas)
    unit = np.ones(problem.n) if metric is None else metric
    covering = _covering(cover, lambda: cover.finish(seeds, charts, deadline), unit)
    if covering.is_finished and has_uncovered_crossing(
        problem, covering, cover.fit.agree
    ):
        return replace(covering, outcome=Covering.UNFIT)
    return covering


def cover_component(
    problem: Problem,
    seeds: np.ndarray,
    dimension: int,
    *,
    radius: float = 1.2,
    charts: int = 2000,
    seconds: float = np.inf,
) -> ChartAtlas:
    """Charts over the components of a ``dimension`` up to `MOST_DIMENSIONS` that the
    regular solutions ``seeds`` (k, n) lie on, as `cover_surface` makes them; they are
    not measured. ``charts`` is for those that are far from other sheets; any other one
    counts as `UNCLEAR` of them. Raises `ProblemError` as that does, and for other dimensions.
    """
    seeds = np.asarray(seeds, dtype=float)
    _check(problem, seeds, radius=radius, charts=charts, seconds=seconds)
    if dimension not in COVERS:
        raise ProblemError("dimension", dimension, f"2 to {MOST_DIMENSIONS}")
    # no farther than periods tell on which side of a centre another one is
    largest = min(radius * problem.domain.scale, problem.domain.periods.min() / 4)
    cover = _Cover(problem, largest, dimension)
    outcome = cover.finish(seeds, charts, Deadline(seconds))
    covering = cover.unmeasured(outcome)
    if covering.is_finished and has_uncovered_crossing(
        problem, covering, cover.fit.agree
    ):
        return replace(covering, outcome=Covering.UNFIT)
    return covering


def _check(problem: Problem, seeds: np.ndarray, **limits: float) -> None:
    if seeds.ndim != 2 or seeds.shape[1] != problem.n:
        raise ProblemError("shape of the seeds", seeds.shape, f"(k, {problem.n})")
    for name, value in limits.items():
        if not value > 0:
            raise ProblemError(name, value, "positive")


def _covering(
    cover: _Cover, finish: Callable[[], Covering], metric: np.ndarray
) -> ChartAtlas:
    """The charts that ``finish`` ends with, their polygons fitted together and measured
    in ``metric`` (n,): where that does not go well they are made smaller first. Where
    that makes it worse, those before are taken."""
    fits = [_Fit(finish(), *cover.cells())]
    for _ in range(MENDING):
        fit = fits[-1]
        if fit.outcome is not Covering.COMPLETE:
            break
        if not np.any(fit.misfits):
            fit = fits[-1] = fit.measured(cover.problem, metric)
        too_large = fit.too_large()
        if not len(too_large):
            break
        cover.shrink(fit.charts, too_large)
        fits.append(_Fit(finish(), *cover.cells()))
    best = min(fits, key=_Fit.fault).measured(cover.problem, metric)
    return best.atlas(cover.problem)


class _Fit(NamedTuple):
    """Charts with the ``outcome`` of covering a surface with them, their polygons fitted
    together to ``cells``, and the ``sizes`` of these, None before they are measured."""

    outcome: Covering
    charts: FlatCharts
    cells: Cells
    sizes: Sizes | None = None

    @property
    def misfits(self) -> np.ndarray:
        """Which edges (e,) do not fit."""
        return self.cells.misfits()

    def measured(self, problem: Problem, metric: np.ndarray) -> _Fit:
        """The same with sizes: rough ones where part of the surface is missing."""
        if self.sizes is not None:
            return self
        rounds = 1 if self.outcome in UNFINISHED else ROUNDS
        sizes = cell_sizes(problem, self.charts, self.cells, metric, rounds)
        return self._replace(sizes=sizes)

    def too_large(self) -> np.ndarray:
        """Numbers (k,) of the charts that are larger than others where polygons do not
        fit together; where they do, of those that leave the bounds, or whose areas are
        not known well enough."""
        if self.sizes is not None:
            is_large = self.sizes.are_vague() | (self.sizes.outside != 0.0)
            return np.flatnonzero(is_large)
        numbers = set()
        for vertex in np.unique(self.cells.begin[self.misfits]):
            about = self.cells.chart[self.cells.begin == vertex]
            numbers.add(int(about[np.argmax(self.charts.radii[about])]))
        return np.array(sorted(numbers))

    def fault(self) -> tuple[bool, int, float]:
        """What is wrong, the less the better: that it is not complete, how many edges do
        not fit, and the error of the area."""
        is_unfinished = self.outcome is not Covering.COMPLETE
        error = np.inf if self.sizes is None else float(self.sizes.errors.sum())
        return is_unfinished, int(np.count_nonzero(self.misfits)), error

    def atlas(self, problem: Problem) -> ChartAtlas:
        """The charts, with what is known of them once they are measured."""
        charts, cells, sizes = self.charts, self.cells, self.sizes
        assert sizes is not None
        outcome = self.outcome
        does_not_fit = np.any(self.misfits) or np.any(sizes.outside)
        if outcome is Covering.COMPLETE and does_not_fit:
            outcome = Covering.MISFIT
        return ChartAtlas(
            centers=charts.centers,
            bases=charts.bases,
            radii=charts.radii,
            neighbours=neighbours_of(charts.polygons),
            vertices=cells.vertices,
            polygons=cells.begin,
            polygon_sizes=np.bincount(cells.chart, minlength=len(charts.radii)),
            areas=sizes.areas,
            area_errors=sizes.errors,
            periods=problem.domain.periods,
            outcome=outcome,
        )


class _Candidate(NamedTuple):
    """A solution ``center`` (n,) about which a chart is wanted, of at most the radius
    ``largest``, with its tangent plane, ``basis`` (n, d) and ``normal`` (n,) across the
    surface, and the disk that fits it."""

    placement: _core.Placement
    center: np.ndarray
    basis: np.ndarray
    normal: np.ndarray
    largest: float
    radius: float
    is_clear: bool
    height: float


class _Cut(NamedTuple):
    """The half-space ``normal`` (d,) . y <= ``offset`` of a tangent plane, and the
    ``label`` of the edge along it."""

    normal: np.ndarray
    offset: float
    label: int


class _Charts(NamedTuple):
    """The ``centers`` (c, n) of charts, the ``bases`` (c, n, d) of their planes, their
    ``radii`` (c,), and whether other sheets ``are_clear`` of them (c,): what lies in such
    a chart is on its sheet."""

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    are_clear: np.ndarray


class _Cover:
    """The charts made so far over components of a ``dimension`` d, their polygons in
    the tangent planes, and the charts whose polygons may be open."""

    def __init__(self, problem: Problem, largest: float, dimension: int):
        self.problem = problem
        self.dimension = dimension
        self.fit = OF_SURFACES if dimension == 2 else OF_OTHERS
        self._largest = largest  # radius of a chart
        # how many pairs of charts could not be told to be on one sheet or on two
        self._undecided = 0
        self._singular_places = SingularPlaces(problem, dimension)
        self._forget_charts()

    def _forget_charts(self) -> None:
        """Begin without charts."""
        domain = self.problem.domain
        self._front = COVERS[self.dimension](
            compiled_equations(self.problem),
            domain.scale,
            domain.periods,
            np.ascontiguousarray(domain.bounds),
            agree=self.fit.agree,
            smooth=self.fit.smooth,
            largest=self._largest,
            smallest=SMALLEST * self._largest,
            bend=self.fit.bend,
            flat=self.fit.flat,
            negligible=is_null.threshold,
        )
        self._unfit_seeds: list[np.ndarray] = []
        # number of charts from which other sheets have been looked for
        self._looked_from = 0

    def cells(self) -> tuple[FlatCharts, Cells]:
        """The charts made so far but for those of whose polygons the others leave
        nothing, and their polygons fitted together."""
        assert isinstance(self._front, _core.Cover)
        count = len(self._front)
        polygons = [Polygon(*self._front.polygon(i)) for i in range(count)]
        charts = without_empty_polygons(FlatCharts(*self._charts(), polygons))
        return charts, fitted_cells(self.problem, charts)

    def unmeasured(self, outcome: Covering) -> ChartAtlas:
        """The charts made so far, but for those of whose cells nothing is left, as the
        ``outcome`` of covering components of dimension 3 and more."""
        assert not isinstance(self._front, _core.Cover)
        facets = [self._front.facets(i) for i in range(len(self._front))]
        has_cell = np.array([len(own) > 0 for own in facets], dtype=bool)
        charts = self._charts()
        unknown = np.full(np.count_nonzero(has_cell), np.nan)
        return ChartAtlas(
            centers=charts.centers[has_cell],
            bases=charts.bases[has_cell],
            radii=charts.radii[has_cell],
            neighbours=_neighbours_by(facets, has_cell),
            vertices=np.empty((0, self.problem.n)),
            polygons=np.empty(0, dtype=int),
            polygon_sizes=np.zeros(len(unknown), dtype=int),
            areas=unknown,
            area_errors=unknown,
            periods=self.problem.domain.periods,
            outcome=outcome,
        )

    def shrink(self, charts: FlatCharts, too_large: np.ndarray) -> None:
        """Make the charts of these numbers (k,) smaller, and cut all polygons anew."""
        radii = charts.radii.copy()
        radii[too_large] *= SMALLER
        self._forget_charts()
        for i, radius in enumerate(radii.tolist()):
            disk = Disk(radius, bool(charts.are_clear[i]))
            self.add(self._plane(charts.centers[i], charts.bases[i]), disk)

    def _charts(self, first: int = 0) -> _Charts:
        """The charts from this number on."""
        return _Charts(*self._front.charts(first, len(self._front) - first))

    @property
    def has_charts_to_look_from(self) -> bool:
        """Whether there are charts that other sheets may be near, from which none was
        looked for."""
        return not np.all(self._charts(self._looked_from).are_clear)

    def are_covered(self, points: np.ndarray) -> np.ndarray:
        """Which solutions (k, n) lie in a chart, and on its sheet (k,)."""
        charts = self._charts()
        point, chart, y = self._charts_under(points, charts)
        are_covered = np.zeros(len(points), dtype=bool)
        is_clear = charts.are_clear[chart]
        are_covered[point[is_clear]] = True
        is_open = ~is_clear & ~are_covered[point]
        point, chart, y = point[is_open], chart[is_open], y[is_open]
        planes = charts.bases[chart]
        centers = charts.centers[chart]
        ends, are_reached = follow_sheets(self.problem, centers, planes, y)
        on_sheet = ~are_reached | self._are_same(ends, points[point], planes)
        are_covered[point[on_sheet]] = True
        return are_covered

    def _charts_under(
        self, points: np.ndarray, charts: _Charts
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Numbers (p,) of solutions (k, n), and of charts (p,) in whose disks they lie or
        little above them, with the positions (p, d) there."""
        domain = self.problem.domain
        farthest = RIM * charts.radii.max(initial=0.0)
        point, chart = _pairs_within(domain, points, charts.centers, farthest)
        offset = domain.difference(points[point], charts.centers[chart])
        is_near = np.linalg.norm(offset, axis=1) < RIM * charts.radii[chart]
        point, chart, offset = point[is_near], chart[is_near], offset[is_near]
        y = np.einsum("ki,kij->kj", offset, charts.bases[chart])
        in_plane = np.einsum("kij,kj->ki", charts.bases[chart], y)
        height = np.linalg.norm(offset - in_plane, axis=1)
        steepest = STEEPEST * self.fit.bend
        is_low = height < steepest * np.linalg.norm(y, axis=1) + ROUNDING
        return point[is_low], chart[is_low], y[is_low]

    def _are_same(
        self, ends: np.ndarray, points: np.ndarray, planes: np.ndarray
    ) -> np.ndarray:
        """Whether the ends (k, n) of rays in ``planes`` (k, n, d) are solutions (k, n)
        or (n,). Off the surface redundant equations contradict one another, and their
        least squares move an end a little along it."""
        gaps = self.problem.domain.difference(points, ends)
        along = np.einsum("kij,ki->kj", planes, gaps)
        across = gaps - np.einsum("kij,kj->ki", planes, along)
        moved = np.linalg.norm(along, axis=1) + SAME * self.problem.domain.scale
        same: np.ndarray = np.linalg.norm(across, axis=1) < moved
        return same

    # --- growing ----------------------------------------------------------------------

    def finish(self, seeds: np.ndarray, charts: int, deadline: Deadline) -> Covering:
        """Cover the surfaces of solutions (k, n), and those next to them."""
        outcome = self.grow(charts, deadline)
        if outcome is Covering.COMPLETE:
            outcome = self.spread(seeds, charts, deadline)
        while outcome is Covering.COMPLETE and self.has_charts_to_look_from:
            outcome = self.spread(self.look_across(), charts, deadline)
        if outcome is not Covering.COMPLETE:
            return outcome
        outcome = self.judge()
        return (
            self.fill_holes(charts, deadline) if outcome is Covering.UNFIT else outcome
        )

    def fill_holes(self, charts: int, deadline: Deadline) -> Covering:
        """Cover what is next to places to which no chart led, from there: a chart that is
        made for itself need not agree with the one that leads to it."""
        ends, gaps = self.problem.project(self._front.holes())
        for end in ends[gaps < SOLVED]:
            self._start(end)
        outcome = self.grow(charts, deadline)
        return self.judge() if outcome is Covering.COMPLETE else outcome

    def spread(self, seeds: np.ndarray, charts: int, deadline: Deadline) -> Covering:
        """Cover the surfaces of those of the regular solutions (k, n) that lie in no
        chart."""
        waiting = seeds[~self.are_covered(seeds)]
        outcome = Covering.COMPLETE
        while len(waiting) and outcome is Covering.COMPLETE:
            seed, waiting = waiting[0], waiting[1:]
            if self._start(seed):
                outcome = self.grow(charts, deadline)
                waiting = waiting[~self.are_covered(waiting)]
        return outcome

    def _start(self, seed: np.ndarray) -> bool:
        """Make the first chart of a surface about a regular solution (n,), if one fits
        and is wanted."""
        _, right = null_spaces(self.problem, seed[None])
        plane = np.ascontiguousarray(right[0, -self.dimension :].T)
        candidate = _Candidate(*self._front.candidate(seed, plane, self._largest))
        placement = self._placed(candidate)
        if placement is Placement.UNFIT:
            self._unfit_seeds.append(seed)
        return placement is Placement.FITS

    def look_across(self) -> np.ndarray:
        """Solutions (k, n) on other sheets, next to charts from which none were looked
        for."""
        charts = self._charts(self._looked_from)
        self._looked_from = len(self._front)
        some = ~charts.are_clear
        found = solutions_across(
            self.problem, charts.centers[some], charts.bases[some], charts.radii[some]
        )
        is_told = found.distances > SAME * self.problem.domain.scale
        self._undecided += int(np.count_nonzero(~is_told))
        return found.points[is_told]

    def grow(self, charts: int, deadline: Deadline) -> Covering:
        """Add charts at open vertices until there are none, or until a limit is
        reached."""
        most = self._most_charts(charts)
        while True:
            undecided = MOST_UNDECIDED - self._undecided
            growth, doubt = self._front.grow(most, undecided, deadline.left)
            if growth is _core.Growth.CHART_LIMIT:
                before, most = most, self._most_charts(charts)
                if most > before:
                    continue
            if doubt is None:
                return Covering[growth.name]
            candidate, chart, direction = doubt
            placement = self._placed(_Candidate(*candidate))
            if placement is not Placement.FITS:
                is_unfit = placement is Placement.UNFIT
                self._front.refuse(chart, direction, is_unfit)

    def _most_charts(self, charts: int) -> int:
        """How many there may be for now, with work for so many: of no surface, the fewer
        the more of those made are beside other sheets."""
        if self.dimension == 2:
            return charts
        are_clear = self._charts().are_clear
        work = len(are_clear) + (UNCLEAR - 1) * np.count_nonzero(~are_clear)
        return len(are_clear) + max(charts - int(work), 0) // UNCLEAR

    def judge(self) -> Covering:
        """What is known when no more charts are wanted: places at which none fits may
        still be uncovered by the charts next to them."""
        seeds = np.array(self._unfit_seeds).reshape(-1, self.problem.n)
        holes = [*seeds[~self.are_covered(seeds)], *self._front.holes()]
        if not all(self._has_a_reason(hole) for hole in holes):
            return Covering.UNFIT
        if self._undecided + self._front.undecided:
            return Covering.UNDECIDED
        return Covering.SINGULAR if holes else Covering.COMPLETE

    def _has_a_reason(self, hole: np.ndarray) -> bool:
        """Whether an isolated singular point lies next to a place (n,)."""
        reach = NEXT_TO * SMALLEST * self._largest
        place = self._singular_places.next_to(hole, reach)
        return place is not None and not place.is_on_curve

    def _placed(self, candidate: _Candidate) -> _core.Placement:
        """What becomes of a candidate that has to be looked at; the chart is made if one
        fits."""
        if candidate.placement in (Placement.COVERED, Placement.UNFIT):
            return candidate.placement
        plane = TangentPlane(candidate.center, candidate.basis, candidate.normal)
        disk: Disk | None = Disk(*candidate[-3:])
        if candidate.placement is Placement.TIGHT:
            disk = self._small_disk(plane, candidate.largest)
        if disk is None:
            return Placement.UNFIT
        smallest = min(disk.radius, SMALLEST_BESIDE_BOUNDS * self._largest)
        disk = disk_beside_bounds(self.problem, plane, disk, smallest)
        self.add(plane, disk)
        return Placement.FITS

    def _small_disk(self, plane: TangentPlane, radius: float) -> Disk | None:
        """A disk of at most ``radius`` that is smaller than usual: only where no singular
        point is the reason, as in a neck."""
        small = SMALLEST * self._largest
        if self._singular_places.next_to(plane.center, NEXT_TO * small) is not None:
            return None
        tiniest = TINIEST * self.problem.domain.scale
        disk = self._front.disk(*plane, min(radius, small), tiniest)
        return None if disk is None else Disk(*disk)

    # --- adding -----------------------------------------------------------------------

    def add_all(self, atlas: ChartAtlas) -> None:
        """Add the charts of an atlas."""
        for i in range(len(atlas)):
            disk = Disk(float(atlas.radii[i]), is_clear=False)
            self.add(self._plane(atlas.centers[i], atlas.bases[i]), disk)

    def _plane(self, center: np.ndarray, basis: np.ndarray) -> TangentPlane:
        """The plane of a chart that was made before."""
        return TangentPlane(center, basis, np.zeros(self.problem.n))

    def add(self, plane: TangentPlane, disk: Disk) -> None:
        """Add a chart and cut its polygon and those of all charts that overlap it."""
        cuts = self._cuts_by_bounds(plane, disk.radius)
        normals = np.array([cut.normal for cut in cuts]).reshape(-1, self.dimension)
        offsets = np.array([cut.offset for cut in cuts], dtype=float)
        labels = np.array([cut.label for cut in cuts], dtype=int)
        self._front.add(plane.center, plane.basis, *disk, normals, offsets, labels)

    def _cuts_by_bounds(self, plane: TangentPlane, radius: float) -> list[_Cut]:
        """What cuts the polygon of a chart to its part inside the bounds. What lies
        outside by rounding is not cut off: a surface may run in a bound, or touch it."""
        domain, center, basis = self.problem.domain, plane.center, plane.basis
        cuts: list[_Cut] = []
        # of a cube about a ball, and of an octagon no more
        farthest_vertex = radius * math.sqrt(self.dimension)
        if np.all(np.abs(domain.bounds - center[:, None]) > farthest_vertex):
            return cuts
        low, high = domain.bounds.T
        for side, rooms in enumerate((center - low, high - center)):
            sign = 2.0 * side - 1.0
            for k in np.flatnonzero(np.isfinite(rooms)):
                normal, room = sign * basis[k], max(rooms[k], 0.0)
                farthest = farthest_vertex * float(np.linalg.norm(normal))
                if farthest > room + domain.slack and not turns_back(
                    self.problem, plane, radius, int(k), sign
                ):
                    cuts.append(_Cut(normal, room, BORDER - 2 * int(k) - side))
        return cuts


def _pairs_within(
    domain: Domain, points: np.ndarray, centers: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (p,) of points (k, n), and of centers (c, n) that are within ``reach``."""
    from scipy.spatial import cKDTree

    box = torus.tree_box(domain.periods)
    tree = cKDTree(torus.into_box(centers, domain.periods), boxsize=box)
    in_box = torus.into_box(points, domain.periods)
    near = tree.query_ball_point(in_box, reach, return_sorted=True)
    point = np.repeat(np.arange(len(points)), [len(own) for own in near])
    chart = np.concatenate([np.empty(0, dtype=int), *near]).astype(int)
    return point, chart


def _neighbours_by(facets: Sequence[np.ndarray], has_cell: np.ndarray) -> np.ndarray:
    """Pairs (p, 2) of charts, those alone numbered that have a cell (c,), by the labels
    of the ``facets`` of their cells."""
    own = np.repeat(np.arange(len(facets)), [len(labels) for labels in facets])
    other = np.concatenate([np.empty(0, dtype=int), *facets])
    pairs = np.sort(np.stack([own, other], axis=1)[other >= 0], axis=1)
    pairs = pairs[has_cell[pairs].all(axis=1)]
    number = np.cumsum(has_cell) - 1
    neighbours: np.ndarray = np.unique(number[pairs], axis=0)
    return neighbours
