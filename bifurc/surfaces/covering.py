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

from collections import deque
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.binary_forms import unit_vectors
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import (
    cosines_between_planes,
    null_spaces,
    tangent_planes,
)
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.complex import FlatCharts, Polygon, assemble_charts, octagon
from bifurc.surfaces.crossing_sheets import has_uncovered_crossing

# Largest height of the surface above a chart's disk, over its radius.
BEND = 0.12
# The same above a disk in which a solution lies; rounding is allowed for.
STEEPEST, ROUNDING = 2 * BEND, 1e-9
# Distance of that solution from the centre, over the radius.
RIM = 1.1
# Smallest cosine between tangent planes of a chart and the next one; less is another
# sheet.
SMOOTH = 0.9
# Smallest cosine between tangent planes of charts that may be neighbours.
AGREE = 0.8
# Radius of a chart, over that of the one from which it was made, at most.
GROWTH = 1.4
# Radius over the largest one below which no chart is made.
SMALLEST = 1.0 / 64
# Distance of a centre from another one, over the radius there, that is not worth a
# chart.
TOO_CLOSE = 0.2
# Distance, over the largest radius, beyond which a centre was corrected onto another
# sheet.
TOO_FAR = 0.5
# Relative residuals above which a centre, or a point of the disk, is no solution.
SOLVED, SOLVED_ON_DISK = 1e-10, 1e-9
# Cosine between directions that lead to the same place.
TOWARDS = 0.97
# Share of the radius by which a vertex is outside the disk only by rounding, and by
# which it shows a hole at the end.
ON_DISK, HOLE = 1e-9, 1e-3
# Label of the edges along the bounds.
BORDER = -2


def cover_surface(
    problem: Problem,
    seeds: np.ndarray,
    *,
    radius: float = 0.5,
    charts: int = 2000,
    seconds: float = np.inf,
    atlas: ChartAtlas | None = None,
) -> ChartAtlas:
    """Charts over the components of dimension 2 that the regular solutions ``seeds``
    (k, n) lie on.

    ``radius`` is the largest of a chart, in units of the problem's scale: they shrink
    where the surface bends. At most ``charts`` charts are made in at most ``seconds``;
    those of an ``atlas``, of an earlier call, stay and are continued. Raises
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
    outcome = cover.grow(charts, deadline)
    for seed in seeds:
        if outcome is not Covering.COMPLETE:
            break
        if not cover.covers(seed) and cover.start(seed) is Placement.MADE:
            outcome = cover.grow(charts, deadline)
    if outcome is Covering.COMPLETE and cover.has_holes():
        outcome = Covering.SINGULAR
    covering = assemble_charts(problem, cover.charts, outcome)
    if covering.complete and has_uncovered_crossing(problem, covering, AGREE):
        return replace(covering, outcome=Covering.SINGULAR)
    return covering


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
    their centres in its plane, and the ``heights`` (k,) above it."""

    numbers: np.ndarray
    positions: np.ndarray
    heights: np.ndarray


class _Cover:
    """The charts made so far, their polygons in the tangent planes, and the charts
    whose polygons may be open."""

    def __init__(self, problem: Problem, largest: float):
        self._problem = problem
        self._largest = largest  # radius of a chart
        self._centers = np.empty((0, problem.n))
        self._bases = np.empty((0, problem.n, 2))
        self._radii = np.empty(0)
        self._polygons: list[Polygon] = []
        # directions of each chart in which no chart could be made
        self._dead_ends: list[list[np.ndarray]] = []
        self._unfit_places: list[_UnfitPlace] = []
        self._unfit_seeds: list[np.ndarray] = []
        self._open: deque[int] = deque()

    @property
    def charts(self) -> FlatCharts:
        """The charts made so far."""
        return FlatCharts(self._centers, self._bases, self._radii, self._polygons)

    def covers(self, point: np.ndarray) -> bool:
        """Whether a solution (n,) lies in a chart."""
        offset = self._problem.domain.difference(point, self._centers)
        distance = np.linalg.norm(offset, axis=1)
        near = np.flatnonzero(distance < RIM * self._radii)
        bases = self._bases[near]
        y = np.einsum("ki,kij->kj", offset[near], bases)
        in_plane = np.einsum("kij,kj->ki", bases, y)
        height = np.linalg.norm(offset[near] - in_plane, axis=1)
        limit = STEEPEST * np.linalg.norm(y, axis=1) + ROUNDING
        return bool(np.any(height < limit))

    # --- growing ----------------------------------------------------------------------

    def start(self, seed: np.ndarray) -> Placement:
        """Make the first chart of a surface about a regular solution (n,)."""
        _, right = null_spaces(self._problem, seed[None])
        plane = right[0, -2:].T
        placement = self._make(seed, plane, self._largest)
        if placement is Placement.UNFIT:
            self._unfit_seeds.append(seed)
        return placement

    def grow(self, charts: int, deadline: Deadline) -> Covering:
        """Add charts at open vertices until there are none, or until a limit is
        reached."""
        while self._open:
            if deadline.passed:
                return Covering.OUT_OF_TIME
            i = self._open[0]
            y = self._open_vertex(i)
            if y is None:
                self._open.popleft()
                continue
            if len(self._centers) >= charts:
                return Covering.CHART_LIMIT
            direction = y / np.linalg.norm(y)
            step = self._radii[i] * self._bases[i] @ direction
            start = self._centers[i] + step
            placement = self._make(start, self._bases[i], GROWTH * self._radii[i])
            if placement is not Placement.MADE:
                self._dead_ends[i].append(direction)
            if placement is Placement.UNFIT:
                self._unfit_places.append(_UnfitPlace(i, direction))
        return Covering.COMPLETE

    def has_holes(self) -> bool:
        """Whether places at which no chart fits are still uncovered by the charts next
        to them."""
        if any(self._is_hole(place) for place in self._unfit_places):
            return True
        return not all(self.covers(seed) for seed in self._unfit_seeds)

    def _is_hole(self, place: _UnfitPlace) -> bool:
        """Whether the polygon of a chart has a vertex outside the disk there."""
        vertices = self._polygons[place.chart].vertices
        size = np.linalg.norm(vertices, axis=1)
        is_there = vertices @ place.direction >= TOWARDS * size
        is_outside = size > (1.0 + HOLE) * self._radii[place.chart]
        return bool(np.any(is_there & is_outside))

    def _open_vertex(self, i: int) -> np.ndarray | None:
        """The vertex (2,) of polygon i farthest outside the disk, in no direction that
        is a dead end; None if there is none."""
        vertices = self._polygons[i].vertices
        size = np.linalg.norm(vertices, axis=1)
        for k in np.argsort(-size):
            if size[k] <= self._radii[i] * (1.0 + ON_DISK):
                return None
            y: np.ndarray = vertices[k]
            if all(y @ d < TOWARDS * size[k] for d in self._dead_ends[i]):
                return y
        return None

    def _make(self, start: np.ndarray, basis: np.ndarray, radius: float) -> Placement:
        """Make the chart, of at most ``radius``, about the solution above ``start`` in
        the plane ``basis``."""
        centers, gaps = correct_normal(self._problem, start[None], basis[None])
        plane = tangent_planes(self._problem, centers, basis)[0]
        center = centers[0]
        distance = np.linalg.norm(center - start)
        if gaps[0] > SOLVED or distance > TOO_FAR * self._largest:
            return Placement.UNFIT
        if cosines_between_planes(basis, plane)[-1] < SMOOTH:
            return Placement.UNFIT
        if self._is_close_to_a_center(center, plane):
            return Placement.COVERED
        fitting_radius = self._fitting_radius(center, plane, min(radius, self._largest))
        if fitting_radius is None:
            return Placement.UNFIT
        self.add(center, plane, fitting_radius)
        return Placement.MADE

    def _is_close_to_a_center(self, center: np.ndarray, basis: np.ndarray) -> bool:
        """Whether a chart about ``center`` (n,) would be close to another one."""
        overlaps = self._overlaps(center, basis, self._largest)
        distances = np.linalg.norm(overlaps.positions, axis=1)
        close = distances / self._radii[overlaps.numbers] < TOO_CLOSE
        return bool(np.any(close))

    def _fitting_radius(
        self, center: np.ndarray, basis: np.ndarray, radius: float
    ) -> float | None:
        """The largest one up to ``radius`` at which the surface stays close to the disk
        and tangent planes agree; None if too small."""
        circle = unit_vectors(np.pi / 4 * np.arange(8))
        planes = np.broadcast_to(basis, (8, *basis.shape))
        while radius >= SMALLEST * self._largest:
            rim = center + radius * circle @ basis.T
            points, gaps = correct_normal(self._problem, rim, planes)
            height = np.linalg.norm(points - rim, axis=1).max() / radius
            if gaps.max() < SOLVED_ON_DISK and height < BEND:
                planes_there = tangent_planes(self._problem, points, basis)
                cosines = cosines_between_planes(basis, planes_there)
                if cosines[:, -1].min() > AGREE:
                    return radius
            shrink = 0.5
            if np.isfinite(height):
                shrink = float(np.clip(0.9 * BEND / height, 0.5, 0.8))
            radius *= shrink
        return None

    # --- overlaps ---------------------------------------------------------------------

    def add_all(self, atlas: ChartAtlas) -> None:
        """Add the charts of an atlas."""
        for i in range(len(atlas)):
            self.add(atlas.centers[i], atlas.bases[i], float(atlas.radii[i]))

    def add(self, center: np.ndarray, basis: np.ndarray, radius: float) -> None:
        """Add a chart and cut its polygon and those of all charts that overlap it."""
        number = len(self._radii)
        polygon = self._cut_by_bounds(octagon(radius), center, basis)
        overlaps = self._overlaps(center, basis, radius)
        for i, x, height in zip(*overlaps, strict=True):
            other_radius = self._radii[i]
            polygon = _cut(polygon, radius, x, height, other_radius, int(i))
            self._cut_by_chart(int(i), center, radius, number)
        self._centers = np.concatenate([self._centers, center[None]])
        self._bases = np.concatenate([self._bases, basis[None]])
        self._radii = np.append(self._radii, radius)
        self._polygons.append(polygon)
        self._dead_ends.append([])
        self._open.append(number)

    def _cut_by_bounds(
        self, polygon: Polygon, center: np.ndarray, basis: np.ndarray
    ) -> Polygon:
        """The part of a polygon about ``center`` (n,) inside the bounds. What lies
        outside by rounding is not cut off: a surface may run in a bound."""
        domain = self._problem.domain
        low, high = domain.bounds.T
        for sign, rooms in ((-1.0, center - low), (1.0, high - center)):
            for k in np.flatnonzero(np.isfinite(rooms)):
                normal, room = sign * basis[k], max(rooms[k], 0.0)
                farthest = (polygon.vertices @ normal).max(initial=0.0)
                if farthest > room + domain.slack:
                    polygon = polygon.clip(normal, room, BORDER)
        return polygon

    def _cut_by_chart(
        self, i: int, center: np.ndarray, radius: float, label: int
    ) -> None:
        """Cut polygon i where its disk intersects the one about ``center`` (n,)."""
        basis = self._bases[i]
        offset = self._problem.domain.difference(center, self._centers[i])
        x = basis.T @ offset
        height = float(np.linalg.norm(offset - basis @ x))
        polygon = self._polygons[i]
        self._polygons[i] = _cut(polygon, self._radii[i], x, height, radius, label)
        self._open.append(i)

    def _overlaps(
        self, center: np.ndarray, basis: np.ndarray, radius: float
    ) -> _Overlaps:
        """The charts on the same sheet that overlap a disk about ``center`` (n,)."""
        offset = self._problem.domain.difference(self._centers, center)
        distance = np.linalg.norm(offset, axis=1)
        near = np.flatnonzero(distance < radius + self._radii)
        x = offset[near] @ basis
        in_plane = x @ basis.T
        height = np.linalg.norm(offset[near] - in_plane, axis=1)
        # in two disks of radius R that touch, bent by BEND, one centre lies up to 4
        # BEND R above the other's plane
        is_low = height < 3 * BEND * np.maximum(radius, distance[near])
        cosines = cosines_between_planes(self._bases[near], basis)
        same_sheet = is_low & (cosines[:, -1] > AGREE)
        return _Overlaps(near[same_sheet], x[same_sheet], height[same_sheet])


def _cut(
    polygon: Polygon,
    radius: float,
    x: np.ndarray,
    height: float,
    other_radius: float,
    label: int,
) -> Polygon:
    """A polygon cut where its disk of ``radius`` intersects the one about ``x`` (2,),
    of ``other_radius``, whose centre lies at a ``height``."""
    distance = float(np.linalg.norm(x))
    if distance == 0.0:
        return polygon
    bent = distance**2 + 0.5 * height**2
    offset = (bent + radius**2 - other_radius**2) / (2.0 * distance)
    return polygon.clip(x / distance, offset, label)
