"""Components of dimension 2, covered by charts in their tangent planes (Henderson
2002).

Every chart is a disk in a tangent plane and a polygon about its centre, cut by the line
through the intersection with each chart that overlaps it. A vertex of the polygon
outside the disk shows that the surface is not covered there: its direction leads to the
centre of the next chart. The surface is covered when no vertex is outside.

M. E. Henderson 2002, Multiple parameter continuation: computing implicitly defined
k-manifolds, Int. J. Bifurcation and Chaos 12, 451-476. In its formula for the cutting
line the distance in the tangent plane is corrected for the bend of the surface, so that
both charts are cut along the same line up to fourth order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.corrector import correct_normal
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
from bifurc.surfaces.disk import (
    AGREE,
    BEND,
    Disk,
    TangentPlane,
    fitting_disk,
    tangent_plane_at,
)
from bifurc.surfaces.other_sheets import solutions_across
from bifurc.surfaces.polygon import BORDER, FlatCharts, Polygon, octagon
from bifurc.surfaces.sheet import follow_sheets
from bifurc.surfaces.singular_places import SingularPlaces

# Largest height above a disk at which a solution lies in it, over the distance in its
# plane; rounding is allowed for.
STEEPEST, ROUNDING = 2 * BEND, 1e-9
# Distance of that solution from the centre, over the radius.
RIM = 1.1
# Smallest cosine between tangent planes of a chart and the next one; less is another
# sheet.
SMOOTH = 0.9
# Radius of a chart, over that of the one from which it was made, at most.
GROWTH = 1.4
# Radius over the largest one below which no chart is made next to a singular point, and
# how far from that, over this radius.
SMALLEST, NEXT_TO = 1.0 / 64, 16.0
# The same beside a bound that only just cuts the surface.
SMALLEST_BESIDE_BOUNDS = 1.0 / 256
# Radius over the scale below which no chart is made at all: the size of a neck.
TINIEST = 1e-8
# Radius of a chart that is too large among others, over what it was, how often that is
# looked at, and the error of an area that is known well enough, over it.
SMALLER, MENDING, WELL_KNOWN = 0.7, 4, 1e-7
# Distance of a centre from another one, over the radius there, that is not worth a
# chart.
TOO_CLOSE = 0.2
# Distance, over the radius, beyond which a centre was corrected onto another sheet.
TOO_FAR = 0.5
# Relative residual above which a centre is no solution.
SOLVED = 1e-10
# Cosine between directions that lead to the same place.
TOWARDS = 0.97
# Share of the radius by which a vertex is outside the disk only by rounding, and by
# which it shows a hole at the end.
ON_DISK, HOLE = 1e-9, 1e-3
# Distance, over the scale, below which the end of a ray is a solution that is known.
SAME = 1e-7
# Pairs of charts of which it is not known whether they are on one sheet, at most.
MOST_UNDECIDED = 20


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
    if seeds.ndim != 2 or seeds.shape[1] != problem.n:
        raise ProblemError("shape of the seeds", seeds.shape, f"(k, {problem.n})")
    for name, value in (("radius", radius), ("charts", charts), ("seconds", seconds)):
        if not value > 0:
            raise ProblemError(name, value, "positive")
    deadline = Deadline(seconds)
    cover = _Cover(problem, radius * problem.domain.scale)
    if atlas is not None:
        cover.add_all(atlas)
    unit = np.ones(problem.n) if metric is None else metric
    covering = _covering(cover, lambda: cover.finish(seeds, charts, deadline), unit)
    if covering.is_finished and has_uncovered_crossing(problem, covering, AGREE):
        return replace(covering, outcome=Covering.UNFIT)
    return covering


def _covering(
    cover: _Cover, finish: Callable[[], Covering], metric: np.ndarray
) -> ChartAtlas:
    """The charts that ``finish`` ends with, their polygons fitted together and measured
    in ``metric`` (n,): where that does not go well they are made smaller first."""
    outcome = finish()
    flat, cells, sizes = _measured(cover, metric)
    for _ in range(MENDING):
        too_large = _too_large(flat, cells, sizes)
        if outcome is not Covering.COMPLETE or not len(too_large):
            break
        cover.shrink(flat, too_large)
        outcome = finish()
        flat, cells, sizes = _measured(cover, metric)
    does_not_fit = np.any(cells.misfits()) or np.any(sizes.outside)
    if outcome is Covering.COMPLETE and does_not_fit:
        outcome = Covering.MISFIT
    return ChartAtlas(
        centers=flat.centers,
        bases=flat.bases,
        radii=flat.radii,
        neighbours=neighbours_of(flat.polygons),
        vertices=cells.vertices,
        polygons=cells.begin,
        polygon_sizes=np.bincount(cells.chart, minlength=len(flat.radii)),
        areas=sizes.areas,
        area_errors=sizes.errors,
        periods=cover.problem.domain.periods,
        outcome=outcome,
    )


def _measured(cover: _Cover, metric: np.ndarray) -> tuple[FlatCharts, Cells, Sizes]:
    """The charts, their polygons fitted together, and the sizes of these."""
    flat, cells = cover.cells()
    return flat, cells, cell_sizes(cover.problem, flat, cells, metric)


def _too_large(charts: FlatCharts, cells: Cells, sizes: Sizes) -> np.ndarray:
    """Numbers (k,) of the charts that are larger than others where polygons do not fit
    together; where they do, of those whose areas are not known well enough."""
    misfits = cells.misfits()
    if not np.any(misfits):
        share = sizes.errors / max(sizes.areas.sum(), 1e-300)
        is_large = (share.sum() > WELL_KNOWN) & (share > WELL_KNOWN / len(share))
        return np.flatnonzero(is_large | (sizes.outside != 0.0))
    numbers = set()
    for vertex in np.unique(cells.begin[misfits]):
        about = cells.chart[cells.begin == vertex]
        numbers.add(int(about[np.argmax(charts.radii[about])]))
    return np.array(sorted(numbers))


class Placement(Enum):
    """What became of a place at which a chart was wanted."""

    MADE = "there is a chart now"
    COVERED = "charts cover it already, although the polygon does not show it"
    UNFIT = "no chart fits there: others may cover it later, else it is a hole"


class _UnfitPlace(NamedTuple):
    """A direction (2,) in the plane of a chart in which no chart fits."""

    chart: int
    direction: np.ndarray


class _Overlaps(NamedTuple):
    """Charts that overlap a disk: their ``numbers`` (k,), the ``positions`` (k, 2) of
    their centres in its plane, and the ``heights`` (k,) above it, their ``radii`` (k,),
    and whether other sheets ``are_clear`` of them (k,)."""

    numbers: np.ndarray
    positions: np.ndarray
    heights: np.ndarray
    radii: np.ndarray
    are_clear: np.ndarray

    def part(self, rows: np.ndarray) -> _Overlaps:
        """The charts ``rows`` of these."""
        return _Overlaps(*(column[rows] for column in self))


class _Charts(NamedTuple):
    """The ``centers`` (c, n) of charts, the ``bases`` (c, n, 2) of their planes, their
    ``radii`` (c,), and whether other sheets ``are_clear`` of them (c,): what lies in such
    a chart is on its sheet."""

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    are_clear: np.ndarray


class _Cover:
    """The charts made so far, their polygons in the tangent planes, and the charts
    whose polygons may be open."""

    def __init__(self, problem: Problem, largest: float):
        self.problem = problem
        self._largest = largest  # radius of a chart
        # how many pairs of charts could not be told to be on one sheet or on two
        self._undecided = 0
        self._singular_places = SingularPlaces(problem)
        self._forget_charts()

    def _forget_charts(self) -> None:
        """Begin without charts."""
        # in two disks of radius R that touch, bent by BEND, one centre lies up to 4
        # BEND R above the other's plane
        self._front = _core.Front(
            self.problem.domain.periods,
            height=3 * BEND,
            agree=AGREE,
            on_disk=ON_DISK,
            towards=TOWARDS,
        )
        self._unfit_places: list[_UnfitPlace] = []
        self._unfit_seeds: list[np.ndarray] = []
        # number of charts from which other sheets have been looked for
        self._looked_from = 0

    def cells(self) -> tuple[FlatCharts, Cells]:
        """The charts made so far but for those of whose polygons the others leave
        nothing, and their polygons fitted together."""
        count = len(self._front)
        polygons = [Polygon(*self._front.polygon(i)) for i in range(count)]
        charts = without_empty_polygons(FlatCharts(*self._charts(), polygons))
        return charts, fitted_cells(self.problem, charts)

    def shrink(self, charts: FlatCharts, too_large: np.ndarray) -> None:
        """Make the charts of these numbers (k,) smaller, and cut all polygons anew."""
        radii = charts.radii.copy()
        radii[too_large] *= SMALLER
        self._forget_charts()
        for i, radius in enumerate(radii.tolist()):
            disk = Disk(radius, bool(charts.are_clear[i]))
            self.add(charts.centers[i], charts.bases[i], disk)

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
        little above them, with the positions (p, 2) there."""
        offset = self.problem.domain.difference(points[:, None], charts.centers)
        distance = np.linalg.norm(offset, axis=2)
        point, chart = np.nonzero(distance < RIM * charts.radii)
        offset = offset[point, chart]
        y = np.einsum("ki,kij->kj", offset, charts.bases[chart])
        in_plane = np.einsum("kij,kj->ki", charts.bases[chart], y)
        height = np.linalg.norm(offset - in_plane, axis=1)
        is_low = height < STEEPEST * np.linalg.norm(y, axis=1) + ROUNDING
        return point[is_low], chart[is_low], y[is_low]

    def _are_same(
        self, ends: np.ndarray, points: np.ndarray, planes: np.ndarray
    ) -> np.ndarray:
        """Whether the ends (k, n) of rays in ``planes`` (k, n, 2) are solutions (k, n)
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
        return self.judge() if outcome is Covering.COMPLETE else outcome

    def spread(self, seeds: np.ndarray, charts: int, deadline: Deadline) -> Covering:
        """Cover the surfaces of those of the regular solutions (k, n) that lie in no
        chart."""
        waiting = seeds[~self.are_covered(seeds)]
        outcome = Covering.COMPLETE
        while len(waiting) and outcome is Covering.COMPLETE:
            seed, waiting = waiting[0], waiting[1:]
            if self._start(seed) is Placement.MADE:
                outcome = self.grow(charts, deadline)
                waiting = waiting[~self.are_covered(waiting)]
        return outcome

    def _start(self, seed: np.ndarray) -> Placement:
        """Make the first chart of a surface about a regular solution (n,)."""
        _, right = null_spaces(self.problem, seed[None])
        plane = right[0, -2:].T
        placement = self._make(seed, plane, self._largest)
        if placement is Placement.UNFIT:
            self._unfit_seeds.append(seed)
        return placement

    def look_across(self) -> np.ndarray:
        """Solutions (k, n) on other sheets, next to charts from which none were looked
        for."""
        charts = self._charts(self._looked_from)
        self._looked_from = len(self._front)
        some = ~charts.are_clear
        return solutions_across(
            self.problem, charts.centers[some], charts.bases[some], charts.radii[some]
        )

    def grow(self, charts: int, deadline: Deadline) -> Covering:
        """Add charts at open vertices until there are none, or until a limit is
        reached."""
        while (place := self._front.next_open()) is not None:
            if deadline.passed:
                return Covering.OUT_OF_TIME
            if self._undecided > MOST_UNDECIDED:
                return Covering.UNDECIDED
            if len(self._front) >= charts:
                return Covering.CHART_LIMIT
            i, direction = place
            placement = self._make_next(i, direction)
            if placement is not Placement.MADE:
                self._front.add_dead_end(i, direction)
            if placement is Placement.UNFIT:
                self._unfit_places.append(_UnfitPlace(i, direction))
        return Covering.COMPLETE

    def judge(self) -> Covering:
        """What is known when no more charts are wanted: places at which none fits may
        still be uncovered by the charts next to them."""
        seeds = np.array(self._unfit_seeds).reshape(-1, self.problem.n)
        holes = list(seeds[~self.are_covered(seeds)])
        holes += [self._above(p) for p in self._unfit_places if self._is_hole(p)]
        if not all(self._has_a_reason(hole) for hole in holes):
            return Covering.UNFIT
        if self._undecided:
            return Covering.UNDECIDED
        return Covering.SINGULAR if holes else Covering.COMPLETE

    def _above(self, place: _UnfitPlace) -> np.ndarray:
        """Where on the rim of a chart (n,) no other one fits."""
        i, direction = place
        (center,), (basis,), (radius,), _ = self._front.charts(i, 1)
        above: np.ndarray = center + radius * basis @ direction
        return above

    def _has_a_reason(self, hole: np.ndarray) -> bool:
        """Whether an isolated singular point lies next to a place (n,)."""
        reach = NEXT_TO * SMALLEST * self._largest
        place = self._singular_places.next_to(hole, reach)
        return place is not None and not place.is_on_curve

    def _is_hole(self, place: _UnfitPlace) -> bool:
        """Whether the polygon of a chart has a vertex outside the disk there."""
        vertices, _ = self._front.polygon(place.chart)
        size = np.linalg.norm(vertices, axis=1)
        is_there = vertices @ place.direction >= TOWARDS * size
        *_, (radius,), _ = self._front.charts(place.chart, 1)
        is_outside = size > (1.0 + HOLE) * radius
        return bool(np.any(is_there & is_outside))

    def _make_next(self, i: int, direction: np.ndarray) -> Placement:
        """Make the chart about the solution above the rim of chart i, in a direction
        (2,)."""
        (center,), (basis,), (radius,), (is_clear,) = self._front.charts(i, 1)
        start = center + radius * basis @ direction
        if is_clear:
            centers, gaps = correct_normal(self.problem, start[None], basis[None])
            is_there = gaps[0] < SOLVED
        else:
            rim = (radius * direction)[None]
            centers, are_reached = follow_sheets(
                self.problem, center[None], basis[None], rim
            )
            is_there = are_reached[0]
        distance = np.linalg.norm(centers[0] - start)
        if not is_there or distance > TOO_FAR * radius:
            return Placement.UNFIT
        return self._make(centers[0], basis, GROWTH * radius)

    def _make(self, center: np.ndarray, basis: np.ndarray, radius: float) -> Placement:
        """Make the chart, of at most ``radius``, about a solution (n,) with a tangent
        plane next to ``basis``."""
        tangent_plane, cosine = tangent_plane_at(self.problem, center, basis)
        plane = tangent_plane.basis
        if cosine < SMOOTH:
            return Placement.UNFIT
        if self._is_close_to_a_center(center, plane):
            return Placement.COVERED
        disk = self._disk(tangent_plane, radius)
        if disk is None:
            return Placement.UNFIT
        smallest = min(disk.radius, SMALLEST_BESIDE_BOUNDS * self._largest)
        disk = disk_beside_bounds(self.problem, tangent_plane, disk, smallest)
        self.add(center, plane, disk)
        return Placement.MADE

    def _disk(self, plane: TangentPlane, radius: float) -> Disk | None:
        """The disk of a chart, of at most ``radius``: a small one only where no
        singular point is the reason, as in a neck."""
        small = SMALLEST * self._largest
        disk = fitting_disk(self.problem, plane, min(radius, self._largest), small)
        if disk is not None:
            return disk
        if self._singular_places.next_to(plane.center, NEXT_TO * small) is not None:
            return None
        tiniest = TINIEST * self.problem.domain.scale
        return fitting_disk(self.problem, plane, min(radius, small), tiniest)

    def _is_close_to_a_center(self, center: np.ndarray, basis: np.ndarray) -> bool:
        """Whether a chart about ``center`` (n,) would be close to another one."""
        near = self._near_charts(center, basis, self._largest)
        distances = np.linalg.norm(near.positions, axis=1)
        close = near.part(distances / near.radii < TOO_CLOSE)
        same = self._on_sheet(center, basis, is_clear=True, near=close)
        return len(same.numbers) > 0

    # --- overlaps ---------------------------------------------------------------------

    def add_all(self, atlas: ChartAtlas) -> None:
        """Add the charts of an atlas."""
        for i in range(len(atlas)):
            disk = Disk(float(atlas.radii[i]), is_clear=False)
            self.add(atlas.centers[i], atlas.bases[i], disk)

    def add(self, center: np.ndarray, basis: np.ndarray, disk: Disk) -> None:
        """Add a chart and cut its polygon and those of all charts that overlap it."""
        radius = disk.radius
        plane = TangentPlane(center, basis, np.zeros(self.problem.n))
        polygon = self._cut_by_bounds(octagon(radius), plane, radius)
        near = self._near_charts(center, basis, radius)
        others = self._on_sheet(center, basis, disk.is_clear, near)
        charts = others.numbers, others.positions, others.heights
        self._front.add(center, basis, radius, disk.is_clear, *polygon, *charts)

    def _cut_by_bounds(
        self, polygon: Polygon, plane: TangentPlane, radius: float
    ) -> Polygon:
        """The part of a polygon inside the bounds. What lies outside by rounding is not
        cut off: a surface may run in a bound, or touch it."""
        domain, center, basis = self.problem.domain, plane.center, plane.basis
        farthest_vertex = np.linalg.norm(polygon.vertices, axis=1).max()
        if np.all(np.abs(domain.bounds - center[:, None]) > farthest_vertex):
            return polygon
        low, high = domain.bounds.T
        for side, rooms in enumerate((center - low, high - center)):
            sign = 2.0 * side - 1.0
            for k in np.flatnonzero(np.isfinite(rooms)):
                normal, room = sign * basis[k], max(rooms[k], 0.0)
                farthest = (polygon.vertices @ normal).max(initial=0.0)
                if farthest > room + domain.slack and not turns_back(
                    self.problem, plane, radius, int(k), sign
                ):
                    label = BORDER - 2 * int(k) - side
                    polygon = polygon.clip(normal, room, label)
        return polygon

    def _near_charts(
        self, center: np.ndarray, basis: np.ndarray, radius: float
    ) -> _Overlaps:
        """The charts that overlap a disk about ``center`` (n,), or lie above it."""
        return _Overlaps(*self._front.overlaps(center, basis, radius))

    def _on_sheet(
        self, center: np.ndarray, basis: np.ndarray, is_clear: bool, near: _Overlaps
    ) -> _Overlaps:
        """Those of the charts whose centres are on the sheet of the solution ``center``
        (n,): above its plane ``basis`` the sheet leads to them."""
        is_open = ~(near.are_clear & is_clear)
        if not np.any(is_open):
            return near
        numbers = near.numbers[is_open]
        starts = np.tile(center, (len(numbers), 1))
        planes = np.tile(basis, (len(numbers), 1, 1))
        ends, are_reached = follow_sheets(
            self.problem, starts, planes, near.positions[is_open]
        )
        is_same = self._are_same(ends, self._charts().centers[numbers], planes)
        self._undecided += int(np.count_nonzero(~are_reached))
        is_on_sheet = np.ones(len(near.numbers), dtype=bool)
        is_on_sheet[is_open] = ~are_reached | is_same
        return near.part(is_on_sheet)
