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

import numpy as np

from bifurc.errors import ProblemError
from bifurc.limits import Deadline
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import null_spaces, tangent_planes
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.complex import assemble_charts
from bifurc.surfaces.crossing_sheets import has_uncovered_crossing
from bifurc.surfaces.polygon import clip, octagon

__all__ = ["cover_surface"]

BEND = 0.12  # largest height of the surface above a chart's disk, over its radius
# smallest cosine between tangent planes of a chart and the next one; less is another
# sheet
SMOOTH = 0.9
AGREE = 0.8  # smallest cosine between tangent planes of charts that may be neighbours
SMALLEST = 1.0 / 64  # radius over the largest one below which no chart is made
TOWARDS = 0.97  # cosine from which a vertex lies in a given direction
# share of a radius by which a vertex outside the disk shows a hole at the end
GAP = 1e-3
BORDER = -2  # label of the edges along the bounds


def cover_surface(
    problem: Problem,
    seeds: np.ndarray,
    *,
    radius: float = 0.5,
    charts: int = 2000,
    seconds: float = np.inf,
    known: ChartAtlas | None = None,
) -> ChartAtlas:
    """Charts over the components of dimension 2 that the regular solutions ``seeds``
    (k, n) lie on.

    ``radius`` is the largest of a chart, in units of the problem's scale: they shrink
    where the surface bends. At most ``charts`` charts are made in at most ``seconds``;
    ``known`` charts, of an earlier call, are kept and continued. Raises `ProblemError`
    for seeds of a wrong shape and limits that are not positive.
    """
    seeds = np.asarray(seeds, dtype=float)
    if seeds.ndim != 2 or seeds.shape[1] != problem.n:
        raise ProblemError("shape of the seeds", seeds.shape, f"(k, {problem.n})")
    for name, value in (("radius", radius), ("charts", charts), ("seconds", seconds)):
        if not value > 0:
            raise ProblemError(name, value, "positive")
    cover = _Cover(problem, radius * problem.scale)
    if known is not None:
        for center, basis, size in zip(
            known.centers, known.bases, known.radii, strict=True
        ):
            cover.add(center, basis, float(size))
    deadline = Deadline(seconds)
    outcome = cover.grow(charts, deadline)
    for seed in seeds:
        if outcome is not Covering.COMPLETE:
            break
        if not cover.holds(seed) and cover.start(seed):
            outcome = cover.grow(charts, deadline)
    if outcome is Covering.COMPLETE and cover.has_holes():
        outcome = Covering.SINGULAR
    made = assemble_charts(
        problem,
        cover.centers,
        cover.bases,
        cover.radii,
        cover.polygons,
        cover.labels,
        outcome,
    )
    if made.complete and has_uncovered_crossing(problem, made, AGREE):
        return replace(made, outcome=Covering.SINGULAR)
    return made


class Placement(Enum):
    """What became of a place at which a chart was wanted."""

    MADE = "there is a chart now"
    COVERED = "charts cover it already, although the polygon does not show it"
    UNFIT = "no chart fits there: others may cover it later, else it is a hole"


class _Cover:
    """The charts made so far, their polygons in the tangent planes, and the charts
    whose polygons may be open.

    ``dead`` lists for each chart the directions in which no chart could be made,
    ``unfit`` those (chart, direction) in which none fits, ``lost`` the seeds about
    which none fits.
    """

    def __init__(self, problem: Problem, largest: float):
        self.problem, self.largest = problem, largest
        self.centers = np.empty((0, problem.n))
        self.bases = np.empty((0, problem.n, 2))
        self.radii = np.empty(0)
        self.polygons: list[np.ndarray] = []
        self.labels: list[np.ndarray] = []
        self.dead: list[list[np.ndarray]] = []
        self.unfit: list[tuple[int, np.ndarray]] = []
        self.lost: list[np.ndarray] = []
        self.open: deque[int] = deque()

    # --- growing --------------------------------------------------------------------------------------

    def grow(self, charts: int, deadline: Deadline) -> Covering:
        """Add charts at open vertices until there are none, or until a limit is
        reached."""
        while self.open:
            if deadline.passed:
                return Covering.OUT_OF_TIME
            i = self.open[0]
            y = self._open_vertex(i)
            if y is None:
                self.open.popleft()
                continue
            if len(self.centers) >= charts:
                return Covering.CHART_LIMIT
            direction = y / np.linalg.norm(y)
            center = self.centers[i] + self.radii[i] * self.bases[i] @ direction
            placement = self._make(center, self.bases[i], 1.4 * self.radii[i])
            if placement is not Placement.MADE:
                self.dead[i].append(direction)
            if placement is Placement.UNFIT:
                self.unfit.append((i, direction))
        return Covering.COMPLETE

    def start(self, seed: np.ndarray) -> bool:
        """Make the first chart of a surface about a regular solution (n,)."""
        _, right = null_spaces(self.problem, seed[None])
        placement = self._make(seed, right[0, -2:].T, self.largest)
        if placement is Placement.UNFIT:
            self.lost.append(seed)
        return placement is Placement.MADE

    def has_holes(self) -> bool:
        """Whether places at which no chart fits are still uncovered by the charts
        beside."""
        for i, direction in self.unfit:
            size = np.linalg.norm(self.polygons[i], axis=1)
            there = self.polygons[i] @ direction >= TOWARDS * size
            if np.any(there & (size > (1.0 + GAP) * self.radii[i])):
                return True
        return not all(self.holds(seed) for seed in self.lost)

    def _open_vertex(self, i: int) -> np.ndarray | None:
        """A vertex (2,) of polygon i outside the disk, in no direction known to lead
        nowhere; None if there is none."""
        size = np.linalg.norm(self.polygons[i], axis=1)
        for k in np.argsort(-size):
            if size[k] <= self.radii[i] * (1.0 + 1e-9):
                return None
            y = self.polygons[i][k]
            if all(y @ d < TOWARDS * size[k] for d in self.dead[i]):
                return y
        return None

    def _make(self, start: np.ndarray, basis: np.ndarray, radius: float) -> Placement:
        """Make the chart, of at most ``radius``, about the solution above ``start`` in
        the plane ``basis``."""
        center, gap = correct_normal(self.problem, start[None], basis[None])
        turned = tangent_planes(self.problem, center, basis)[0]
        if gap[0] > 1e-10 or np.linalg.norm(center[0] - start) > 0.5 * self.largest:
            return Placement.UNFIT
        if np.linalg.svd(basis.T @ turned, compute_uv=False)[-1] < SMOOTH:
            return Placement.UNFIT
        near, x, _ = self._neighbours(center[0], turned, self.largest)
        if len(near) and np.min(np.linalg.norm(x, axis=1) / self.radii[near]) < 0.2:
            return Placement.COVERED
        radius = self._fitting_radius(center[0], turned, min(radius, self.largest))
        if radius == 0.0:
            return Placement.UNFIT
        self.add(center[0], turned, radius)
        return Placement.MADE

    def _fitting_radius(
        self, center: np.ndarray, basis: np.ndarray, radius: float
    ) -> float:
        """The largest one up to ``radius`` at which the surface stays close to the disk
        and tangent planes agree; 0 if too small."""
        while radius >= SMALLEST * self.largest:
            angles = np.pi / 4 * np.arange(8)
            flat = (
                center
                + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1) @ basis.T
            )
            points, gaps = correct_normal(
                self.problem, flat, np.broadcast_to(basis, (8, *basis.shape))
            )
            height = np.linalg.norm(points - flat, axis=1).max() / radius
            if gaps.max() < 1e-9 and height < BEND:
                turned = tangent_planes(self.problem, points, basis)
                if (
                    np.linalg.svd(basis.T @ turned, compute_uv=False)[:, -1].min()
                    > AGREE
                ):
                    return radius
            radius *= (
                float(np.clip(0.9 * BEND / height, 0.5, 0.8))
                if np.isfinite(height)
                else 0.5
            )
        return 0.0

    # --- overlaps -------------------------------------------------------------------------------------

    def add(self, center: np.ndarray, basis: np.ndarray, radius: float) -> None:
        """Add a chart and cut its polygon and those of all charts that overlap it."""
        new = len(self.radii)
        vertices, labels = octagon(radius)
        for low_high, sign in ((0, -1.0), (1, 1.0)):
            for k in np.flatnonzero(np.isfinite(self.problem.bounds[:, low_high])):
                room = sign * (self.problem.bounds[k, low_high] - center[k])
                if len(vertices):
                    vertices, labels = clip(
                        vertices, labels, sign * basis[k], max(room, 0.0), BORDER
                    )
        near, x, height = self._neighbours(center, basis, radius)
        for i, own, h in zip(near, x, height, strict=True):
            vertices, labels = _cut(
                vertices, labels, own, h, radius, self.radii[i], int(i)
            )
            back = self.problem.difference(center, self.centers[i])
            theirs = self.bases[i].T @ back
            h = float(np.linalg.norm(back - self.bases[i] @ theirs))
            self.polygons[i], self.labels[i] = _cut(
                self.polygons[i], self.labels[i], theirs, h, self.radii[i], radius, new
            )
            self.open.append(int(i))
        self.centers = np.concatenate([self.centers, center[None]])
        self.bases = np.concatenate([self.bases, basis[None]])
        self.radii = np.append(self.radii, radius)
        self.polygons.append(vertices)
        self.labels.append(labels)
        self.dead.append([])
        self.open.append(new)

    def _neighbours(
        self, center: np.ndarray, basis: np.ndarray, radius: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Numbers (k,) of the charts that overlap a disk on the same sheet, where they
        lie in its plane (k, 2), and how high (k,) above it."""
        away = self.problem.difference(self.centers, center)
        distance = np.linalg.norm(away, axis=1)
        near = np.flatnonzero(distance < radius + self.radii)
        x = away[near] @ basis
        height = np.linalg.norm(away[near] - x @ basis.T, axis=1)
        cosines = np.linalg.svd(
            np.swapaxes(self.bases[near], 1, 2) @ basis, compute_uv=False
        )[:, -1]
        # in two disks of radius R that touch, bent by BEND, one centre lies up to 4
        # BEND R above the other's plane
        same = (height < 3 * BEND * np.maximum(radius, distance[near])) & (
            cosines > AGREE
        )
        return near[same], x[same], height[same]

    def holds(self, point: np.ndarray) -> bool:
        """Whether a solution (n,) lies in a chart."""
        away = self.problem.difference(point, self.centers)
        near = np.flatnonzero(np.linalg.norm(away, axis=1) < 1.1 * self.radii)
        y = np.einsum("ki,kij->kj", away[near], self.bases[near])
        height = np.linalg.norm(
            away[near] - np.einsum("kij,kj->ki", self.bases[near], y), axis=1
        )
        return bool(np.any(height < 2 * BEND * np.linalg.norm(y, axis=1) + 1e-9))


def _cut(
    vertices: np.ndarray,
    labels: np.ndarray,
    x: np.ndarray,
    height: float,
    radius: float,
    other: float,
    label: int,
) -> tuple[np.ndarray, np.ndarray]:
    """A polygon cut where the disks of ``radius`` about 0 and of radius ``other`` about
    ``x`` intersect."""
    distance = float(np.linalg.norm(x))
    if not len(vertices) or distance == 0.0:
        return vertices, labels
    offset = (distance**2 + 0.5 * height**2 + radius**2 - other**2) / (2.0 * distance)
    return clip(vertices, labels, x / distance, offset, label)
