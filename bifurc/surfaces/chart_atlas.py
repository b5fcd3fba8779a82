"""A surface of solutions, or a component of more dimensions, as an atlas of charts: area,
Euler characteristic, connected parts, and the charts about a point."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bifurc import torus
from bifurc.tables import count_of

if TYPE_CHECKING:
    # it takes longer to import than NumPy, and most maps have no surface
    from scipy.spatial import cKDTree

# Charts near a point, one of which holds it if any does.
NEAREST = 16
# Distance of a chart from a singular point next to it, over its radius, at most.
NEXT_TO = 12.0
MOST_DIGITS = 10  # of an area
# The same, over the distance of the nearest chart.
NEAR_THE_NEAREST = 2.0
# Distance from the centre, over the radius, up to which a chart holds a solution.
RIM = 1.1
# Height of a solution above the plane of a chart that holds it, over the distance in
# the plane, at most, of a surface and of other components; rounding is allowed for.
STEEPEST, STEEPEST_OF_OTHERS, ROUNDING = 0.25, 0.4, 1e-9


class Covering(Enum):
    """Why no more charts were made, with what to do next."""

    COMPLETE = "complete: every part of the surface inside the bounds is covered"
    MISFIT = (
        "complete: but the charts do not fit together everywhere, and how many holes "
        "and handles there are is not known"
    )
    SINGULAR = "incomplete: but for isolated singular points it is covered"
    UNFIT = (
        "incomplete: no chart fits at some places, about which no isolated singular "
        "point is known, or a sheet that is not covered crosses"
    )
    UNDECIDED = (
        "incomplete: at some places sheets lie nearer to one another than can be told "
        "apart, and may be one"
    )
    CHART_LIMIT = (
        "incomplete: the largest number of charts is reached; allow more of them, or a "
        "larger radius"
    )
    OUT_OF_TIME = (
        "incomplete: the time is over; allow more of it and continue from these charts"
    )


@dataclass(frozen=True, eq=False)
class ChartAtlas:
    """A surface of solutions, or a component of dimension d, or several, as charts that
    overlap.

    ``centers`` (c, n) are solutions, ``bases`` (c, n, d) orthonormal bases of the
    tangent planes there, ``radii`` (c,) those of the disks. The polygon of a chart
    lists the ``vertices`` (v, n) around it, solutions that it shares with its
    neighbours; the ``polygons``, with ``polygon_sizes`` (c,) entries each, stand one
    behind the other; their ``areas`` (c,) on the surface are known to within
    ``area_errors`` (c,). ``neighbours`` (p, 2) are the pairs of charts whose polygons have
    an edge in common. Where d is 3 or more, cells are polytopes, which are not kept and
    not measured: there are no vertices, polygons are empty and areas not a number.
    """

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    neighbours: np.ndarray
    vertices: np.ndarray
    polygons: np.ndarray
    polygon_sizes: np.ndarray
    areas: np.ndarray
    area_errors: np.ndarray
    periods: np.ndarray
    outcome: Covering

    def __len__(self) -> int:
        return len(self.centers)

    def __repr__(self) -> str:
        if not self.is_measured:
            charts = count_of(len(self), "chart")
            words = f"{charts} of dimension {self.dimension}"
            return f"ChartAtlas({words}, {self.outcome.name})"
        euler = self.euler_characteristic
        return (
            f"ChartAtlas({count_of(len(self), 'chart')}, {self.outcome.name},\n"
            f"           area {self.area_words}, "
            f"Euler characteristic {'unknown' if euler is None else euler})"
        )

    @property
    def dimension(self) -> int:
        """That of the component."""
        dimension: int = self.bases.shape[-1]
        return dimension

    @property
    def is_measured(self) -> bool:
        """Whether there are areas: those of surfaces."""
        return self.dimension == 2

    @property
    def complete(self) -> bool:
        """Whether the whole surface inside the bounds is covered."""
        return self.outcome in (Covering.COMPLETE, Covering.MISFIT)

    @property
    def is_finished(self) -> bool:
        """Whether it is complete but for isolated singular points."""
        return self.complete or self.outcome is Covering.SINGULAR

    @property
    def is_short_of_charts(self) -> bool:
        """Whether the charts ran out before the surface was covered."""
        return self.outcome is Covering.CHART_LIMIT

    def difference(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """a - b (..., n) with periodic unknowns taken to within half a period of 0."""
        return torus.difference(a, b, self.periods)

    # --- size and shape ---------------------------------------------------------------

    @cached_property
    def triangles(self) -> np.ndarray:
        """Corners (t, 3, n) of flat triangles that follow the surface: from each centre
        to the edges of its polygon.

        The corners are solutions; those of one triangle lie together, across the ends
        of a period where need be.
        """
        edges = self._edges
        tip = self.centers[edges.chart]
        begin = tip + self.difference(self.vertices[edges.begin], tip)
        end = tip + self.difference(self.vertices[edges.end], tip)
        return np.stack([tip, begin, end], axis=1)

    @cached_property
    def triangle_areas(self) -> np.ndarray:
        """Area (t,) of every triangle."""
        a = self.triangles[:, 1] - self.triangles[:, 0]
        b = self.triangles[:, 2] - self.triangles[:, 0]
        aa = np.einsum("ti,ti->t", a, a)
        bb = np.einsum("ti,ti->t", b, b)
        ab = np.einsum("ti,ti->t", a, b)
        gram = aa * bb - ab**2
        areas: np.ndarray = 0.5 * np.sqrt(np.maximum(gram, 0.0))
        return areas

    @cached_property
    def area(self) -> float:
        """Area of the charts, by quadrature over their polygons."""
        return float(self.areas.sum())

    @cached_property
    def area_error(self) -> float:
        """How far the area may be off, by the errors of all polygons."""
        return float(self.area_errors.sum())

    @property
    def area_words(self) -> str:
        """The area as text, with the digits that are sure; of an unfinished covering it
        says that there is more. Empty where it is not measured."""
        if not self.is_measured:
            return ""
        share = max(self.area_error / self.area, 10.0**-MOST_DIGITS)
        digits = max(1, int(-np.log10(share)))
        words = f"{self.area:.{digits}g}"
        return words if self.complete else f"more than {words}"

    @cached_property
    def border(self) -> int:
        """Number of edges that belong to one polygon alone: where surface meets bounds,
        or the covering ends."""
        return int(np.count_nonzero(self._polygons_at_edge == 1))

    @cached_property
    def euler_characteristic(self) -> int | None:
        """Vertices - edges + polygons; None for an incomplete covering, or where
        polygons do not fit together; and of what is no surface."""
        if self.outcome is not Covering.COMPLETE or not self.is_measured:
            return None
        vertices = len(np.unique(self.polygons))
        edges = len(self._polygons_at_edge)
        return vertices - edges + int(np.count_nonzero(self.polygon_sizes))

    # --- connected parts --------------------------------------------------------------

    @cached_property
    def part(self) -> np.ndarray:
        """Number (c,) of the connected surface that each chart belongs to; number 0 has
        most charts."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components

        links = np.ones(len(self.neighbours))
        size = len(self)
        graph = csr_array((links, tuple(self.neighbours.T)), shape=(size, size))
        count, label = connected_components(graph, directed=False)
        sizes = np.bincount(label, minlength=count)
        largest_first = np.argsort(-sizes, kind="stable")
        number: np.ndarray = np.argsort(largest_first)[label]
        return number

    def joined_to(self, chart: int, among: np.ndarray) -> set[int]:
        """Numbers of the charts to which neighbours lead from one, over those ``among``
        (c,) which it is looked for."""
        pairs = self.neighbours[among[self.neighbours].all(axis=1)]
        joined, waiting = {chart}, [chart]
        while waiting:
            here = waiting.pop()
            beside = pairs[(pairs == here).any(axis=1)]
            more = set(beside.ravel().tolist()) - joined
            joined |= more
            waiting += more
        return joined

    def parts(self) -> tuple[ChartAtlas, ...]:
        """The connected surfaces, the one with most charts first."""
        count = int(self.part.max(initial=-1)) + 1
        parts = []
        for k in range(count):
            parts.append(self._only(np.flatnonzero(self.part == k)))
        return tuple(parts)

    def _only(self, charts: np.ndarray) -> ChartAtlas:
        """The atlas of the charts of these numbers (k,) alone."""
        number = np.full(len(self), -1)
        number[charts] = np.arange(len(charts))
        is_inside = np.all(number[self.neighbours] >= 0, axis=1)
        corners = self.polygons[np.repeat(number >= 0, self.polygon_sizes)]
        vertices, renumbered = np.unique(corners, return_inverse=True)
        return ChartAtlas(
            centers=self.centers[charts],
            bases=self.bases[charts],
            radii=self.radii[charts],
            neighbours=number[self.neighbours[is_inside]],
            vertices=self.vertices[vertices],
            polygons=renumbered,
            polygon_sizes=self.polygon_sizes[charts],
            areas=self.areas[charts],
            area_errors=self.area_errors[charts],
            periods=self.periods,
            outcome=self.outcome,
        )

    # --- charts about a point ---------------------------------------------------------

    def chart_at(self, points: np.ndarray) -> np.ndarray:
        """Numbers (k,) of charts in which solutions (k, n) lie, one for each; -1 where
        there is none."""
        order = np.arange(1, min(NEAREST, len(self)) + 1)
        _, near = self._tree.query(self._in_box(points), k=order)
        holds = self._hold(points, near)  # (k, count)
        nearest = np.argmax(holds, axis=1)
        numbers = near[np.arange(len(near)), nearest]
        return np.where(holds.any(axis=1), numbers, -1)

    def covers(self, points: np.ndarray) -> np.ndarray:
        """Which solutions (k, n) lie in a chart (k,)."""
        return self.chart_at(points) >= 0

    def nearest_charts(self, points: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the charts whose centres are nearest to points (k, n)."""
        _, nearest = self._tree.query(self._in_box(points))
        numbers: np.ndarray = nearest
        return numbers

    def charts_about(self, point: np.ndarray) -> np.ndarray:
        """Numbers (k,) of all charts in which a solution (n,) lies."""
        charts = np.arange(len(self))
        holds = self._hold(point[None], charts[None])
        return np.flatnonzero(holds[0])

    def passes_beside(self, point: np.ndarray) -> bool:
        """Whether a chart lies below or above a point (n,): the surface has no hole
        there."""
        offsets = self.difference(point, self.centers)
        along = np.einsum("cij,ci->cj", self.bases, offsets)
        is_within = np.linalg.norm(along, axis=1) < self.radii
        is_near = np.linalg.norm(offsets, axis=1) < 2.0 * self.radii
        return bool(np.any(is_within & is_near))

    def charts_next_to(self, point: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the charts that may be next to a singular point (n,) about
        which there is none.

        As at the tip of a cone: charts are the smaller the nearer they are to it, and
        the hole that they leave is no larger than the largest of them.
        """
        gaps = self.difference(point, self.centers)
        distance = np.linalg.norm(gaps, axis=1)
        farthest = self.radii.max(initial=0.0)
        by_radius = distance < np.minimum(NEXT_TO * self.radii, farthest)
        by_nearest = distance < NEAR_THE_NEAREST * distance.min(initial=np.inf)
        return np.flatnonzero(by_radius & by_nearest)

    def _hold(self, points: np.ndarray, charts: np.ndarray) -> np.ndarray:
        """Whether solutions (k, n) lie in the disks of ``charts`` (k, c), and not well
        above them: (k, c)."""
        bases = self.bases[charts]
        offset = self.difference(points[:, None], self.centers[charts])
        y = np.einsum("kci,kcij->kcj", offset, bases)
        distance = np.linalg.norm(y, axis=2)
        in_plane = np.einsum("kcij,kcj->kci", bases, y)
        height = np.linalg.norm(offset - in_plane, axis=2)
        is_inside = distance < RIM * self.radii[charts]
        steepest = STEEPEST if self.is_measured else STEEPEST_OF_OTHERS
        is_low = height < steepest * distance + ROUNDING
        holds: np.ndarray = is_inside & is_low
        return holds

    @cached_property
    def _tree(self) -> cKDTree:
        """The centres of the charts, for the search of the nearest."""
        from scipy.spatial import cKDTree

        box = torus.tree_box(self.periods)
        return cKDTree(self._in_box(self.centers), boxsize=box)

    def _in_box(self, points: np.ndarray) -> np.ndarray:
        """Points with periodic unknowns taken into [0, period)."""
        return torus.into_box(points, self.periods)

    # --- the complex of polygons ------------------------------------------------------

    @cached_property
    def _edges(self) -> _Edges:
        """The edges of all polygons."""
        chart = np.repeat(np.arange(len(self)), self.polygon_sizes)
        ends = np.cumsum(self.polygon_sizes)
        successor = np.arange(1, len(self.polygons) + 1)
        full = self.polygon_sizes > 0
        successor[ends[full] - 1] = (ends - self.polygon_sizes)[full]
        return _Edges(chart, self.polygons, self.polygons[successor])

    @cached_property
    def _polygons_at_edge(self) -> np.ndarray:
        """To how many polygons (e,) each edge belongs."""
        edges = self._edges
        pairs = np.stack([edges.begin, edges.end], axis=1)
        pairs.sort(axis=1)
        _, counts = np.unique(pairs, axis=0, return_counts=True)
        return counts


class _Edges(NamedTuple):
    """The edges of all polygons one behind the other: number (e,) of the chart, first
    and second vertex (e,)."""

    chart: np.ndarray
    begin: np.ndarray
    end: np.ndarray
