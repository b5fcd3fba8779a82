"""A surface of solutions as an atlas of charts: area, Euler characteristic, connected
parts and paths."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

__all__ = ["ChartAtlas", "Covering"]

NEAREST = 16  # charts near a point, one of which holds it if any does
# distance of a chart from a singular point next to it, over its radius, at most
BESIDE = 12.0


class Covering(Enum):
    """Why no more charts were made, with what to do next."""

    COMPLETE = "complete: every part of the surface inside the bounds is covered"
    SINGULAR = (
        "incomplete: no chart fits at some places, or a sheet that is not covered crosses; "
        "look for singular points of the surface there"
    )
    CHART_LIMIT = "incomplete: the largest number of charts is reached; allow more of them, or a larger radius"
    OUT_OF_TIME = (
        "incomplete: the time is over; allow more of it and continue from these charts"
    )


@dataclass(frozen=True)
class ChartAtlas:
    """A surface of solutions, or several, as charts that overlap.

    ``centers`` (c, n) are solutions, ``bases`` (c, n, 2) orthonormal bases of the
    tangent planes there, ``radii`` (c,) those of the disks. The polygon of a chart
    lists the ``vertices`` (v, n) around it, solutions that it shares with its
    neighbours; the ``polygons``, with ``polygon_sizes`` (c,) entries each, stand one
    behind the other. ``neighbours`` (p, 2) are the pairs of charts whose polygons have
    an edge in common.
    """

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    neighbours: np.ndarray
    vertices: np.ndarray
    polygons: np.ndarray
    polygon_sizes: np.ndarray
    periods: np.ndarray
    outcome: Covering

    def __len__(self) -> int:
        return len(self.centers)

    @property
    def complete(self) -> bool:
        """Whether the whole surface inside the bounds is covered."""
        return self.outcome is Covering.COMPLETE

    @cached_property
    def triangles(self) -> np.ndarray:
        """Corners (t, 3, n) of flat triangles that follow the surface: from each centre
        to the edges of its polygon.

        The corners are solutions; those of one triangle lie together, across the ends
        of a period where need be.
        """
        owner, first, second = self._edges
        corners = self.centers[owner]
        sides = [
            corners + self.apart(self.vertices[v], corners) for v in (first, second)
        ]
        return np.stack([corners, *sides], axis=1)

    @cached_property
    def area(self) -> float:
        """Area of the triangles: below that of a surface all covered by a share of
        (radius x curvature)^2 / 8."""
        return float(self.triangle_areas.sum())

    @cached_property
    def triangle_areas(self) -> np.ndarray:
        """Area (t,) of every triangle."""
        a, b = (self.triangles[:, k] - self.triangles[:, 0] for k in (1, 2))
        gram = (
            np.einsum("ti,ti->t", a, a) * np.einsum("ti,ti->t", b, b)
            - np.einsum("ti,ti->t", a, b) ** 2
        )
        return 0.5 * np.sqrt(np.maximum(gram, 0.0))

    @cached_property
    def border(self) -> int:
        """Number of edges that belong to one polygon alone: where surface meets bounds,
        or the covering ends."""
        return int(np.count_nonzero(self._edge_counts == 1))

    @cached_property
    def euler_characteristic(self) -> int | None:
        """Vertices - edges + polygons; None for an incomplete covering, or where
        polygons do not fit together."""
        counts = self._edge_counts
        if not self.complete or np.any(counts > 2):
            return None
        return len(np.unique(self._edges[1])) - len(counts) + len(self.centers)

    @cached_property
    def part(self) -> np.ndarray:
        """Number (c,) of the connected surface that each chart belongs to; number 0 has
        most charts."""
        count, label = connected_components(
            csr_array(
                (np.ones(len(self.neighbours)), tuple(self.neighbours.T)),
                shape=(len(self),) * 2,
            ),
            directed=False,
        )
        return np.argsort(
            np.argsort(-np.bincount(label, minlength=count), kind="stable")
        )[label]

    def parts(self) -> tuple[ChartAtlas, ...]:
        """The connected surfaces, the one with most charts first."""
        return tuple(
            self._only(np.flatnonzero(self.part == k))
            for k in range(int(self.part.max(initial=-1)) + 1)
        )

    def chart_at(self, points: np.ndarray) -> np.ndarray:
        """Numbers (k,) of charts in which solutions (k, n) lie, one for each; -1 where
        there is none."""
        count = min(NEAREST, len(self))
        near = self._tree.query(self._in_box(points), k=np.arange(1, count + 1))[
            1
        ]  # (k, count)
        inside = self._inside(points, near)
        return np.where(
            inside.any(axis=1),
            near[np.arange(len(near)), np.argmax(inside, axis=1)],
            -1,
        )

    def nearest(self, points: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the charts whose centres are nearest to points (k, n)."""
        return self._tree.query(self._in_box(points))[1]

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which solutions (k, n) lie in a chart (k,)."""
        return self.chart_at(points) >= 0

    # --- charts about a point ----------------------------------------------------------------------------------------

    def holding(self, point: np.ndarray) -> np.ndarray:
        """Numbers (k,) of all charts in which a solution (n,) lies."""
        return np.flatnonzero(self._inside(point[None], np.arange(len(self))[None])[0])

    def beside(self, point: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the charts that may be next to a singular point (n,) about
        which there is none.

        As at the tip of a cone: charts are the smaller the nearer they are to it.
        """
        distance = np.linalg.norm(self.apart(point, self.centers), axis=1)
        return np.flatnonzero(
            (distance < BESIDE * self.radii)
            & (distance < 2.0 * distance.min(initial=np.inf))
        )

    def apart(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """a - b with periodic unknowns taken to within half a period of zero."""
        gap = a - b
        periodic = np.isfinite(self.periods)
        gap[..., periodic] -= self.periods[periodic] * np.round(
            gap[..., periodic] / self.periods[periodic]
        )
        return gap

    def _inside(self, points: np.ndarray, charts: np.ndarray) -> np.ndarray:
        """Whether solutions (k, n) lie in the disks of ``charts`` (k, c), and not well
        above them: (k, c)."""
        away = self.apart(points[:, None], self.centers[charts])
        y = np.einsum("kci,kcij->kcj", away, self.bases[charts])
        size = np.linalg.norm(y, axis=2)
        height = np.linalg.norm(
            away - np.einsum("kcij,kcj->kci", self.bases[charts], y), axis=2
        )
        return (size < 1.1 * self.radii[charts]) & (height < 0.25 * size + 1e-9)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(
            self._in_box(self.centers),
            boxsize=np.where(np.isfinite(self.periods), self.periods, 0.0),
        )

    def _in_box(self, points: np.ndarray) -> np.ndarray:
        """Points with periodic unknowns taken into [0, period)."""
        periodic = np.isfinite(self.periods)
        out = points.copy()
        out[:, periodic] %= self.periods[periodic]
        out[:, periodic] = np.where(
            out[:, periodic] >= self.periods[periodic], 0.0, out[:, periodic]
        )
        return out

    # --- the complex of polygons ----------------------------------------------------------------------

    @cached_property
    def _edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Chart (e,), first and second vertex (e,) of every edge of every polygon."""
        owner = np.repeat(np.arange(len(self.centers)), self.polygon_sizes)
        ends = np.cumsum(self.polygon_sizes)
        following = np.arange(1, len(self.polygons) + 1)
        full = self.polygon_sizes > 0
        following[ends[full] - 1] = (ends - self.polygon_sizes)[full]
        return owner, self.polygons, self.polygons[following]

    @cached_property
    def _edge_counts(self) -> np.ndarray:
        """To how many polygons each edge belongs."""
        _, first, second = self._edges
        pairs = np.sort(np.stack([first, second], axis=1), axis=1)
        return np.unique(pairs, axis=0, return_counts=True)[1]

    def _only(self, charts: np.ndarray) -> ChartAtlas:
        """The atlas of these charts alone."""
        number = np.full(len(self.centers), -1)
        number[charts] = np.arange(len(charts))
        inside = np.all(number[self.neighbours] >= 0, axis=1)
        polygons = self.polygons[np.repeat(number >= 0, self.polygon_sizes)]
        used, renumbered = np.unique(polygons, return_inverse=True)
        return ChartAtlas(
            self.centers[charts],
            self.bases[charts],
            self.radii[charts],
            number[self.neighbours[inside]],
            self.vertices[used],
            renumbered,
            self.polygon_sizes[charts],
            self.periods,
            self.outcome,
        )
