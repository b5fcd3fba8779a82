"""Convex polygons about the origins of the tangent planes of charts, each of whose edges
knows what made it, and those of overlapping charts put together to one closed
complex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc import torus
from bifurc.numerics.binary_forms import unit_vectors
from bifurc.numerics.corrector import correct_normal
from bifurc.problem import Problem
from bifurc.surfaces.chart_atlas import ChartAtlas, Covering
from bifurc.surfaces.sheet import follow_sheets

OUTLINE = -1  # label of an edge that nothing has cut yet
BORDER = -2  # of one along the first bound; the others follow below it


class Polygon(NamedTuple):
    """Vertices (v, 2), counterclockwise, and the labels (v,) of the edges: edge i runs
    from vertex i to the next one."""

    vertices: np.ndarray
    labels: np.ndarray

    @property
    def is_empty(self) -> bool:
        """Whether nothing is left of it."""
        return len(self.vertices) == 0

    def clip(self, normal: np.ndarray, offset: float, label: int) -> Polygon:
        """The part where ``normal . y <= offset``; the edge along the cut gets
        ``label``.

        The same polygon where the line misses it, an empty one where nothing is left.
        """
        if self.is_empty:
            return self
        height: list[float] = (self.vertices @ normal - offset).tolist()
        if max(height) <= 0.0:
            return self
        if min(height) > 0.0:
            return Polygon(self.vertices[:0], self.labels[:0])
        count = len(height)
        next_height = height[1:] + height[:1]
        edges = range(count)
        leaves = next(i for i in edges if height[i] <= 0.0 < next_height[i])
        enters = next(i for i in edges if next_height[i] <= 0.0 < height[i])
        count_inside = (leaves - enters) % count
        inside = [(enters + 1 + i) % count for i in range(count_inside)]
        begin = self._crossing(leaves, height[leaves], next_height[leaves])
        end = self._crossing(enters, height[enters], next_height[enters])
        new_labels = [label, self.labels[enters]]
        return Polygon(
            np.concatenate([self.vertices[inside], [begin, end]]),
            np.concatenate([self.labels[inside], new_labels]),
        )

    def _crossing(self, edge: int, begin: float, end: float) -> np.ndarray:
        """The point (2,) of an edge on the line, from the heights of its two ends."""
        first = self.vertices[edge]
        last = self.vertices[(edge + 1) % len(self.vertices)]
        point: np.ndarray = first + begin / (begin - end) * (last - first)
        return point


def octagon(radius: float) -> Polygon:
    """The octagon around the circle of ``radius``."""
    angles = np.pi / 4 * (np.arange(8) + 0.5)
    size = radius / np.cos(np.pi / 8)
    return Polygon(size * unit_vectors(angles), np.full(8, OUTLINE))


# Corners of neighbouring polygons closer than this, over their charts' radius, are one
# vertex; and those between the same three charts, or two and a bound.
MERGED, MERGED_OF_SAME = 0.15, 0.7
# Relative residual above which a corner could not be lifted.
SOLVED = 1e-9
# Height over the radius above which a corner was lifted onto another sheet.
TOO_HIGH = 0.5


class FlatCharts(NamedTuple):
    """Charts as they are made: ``centers`` (c, n), ``bases`` (c, n, 2) of the tangent
    planes, ``radii`` (c,) of the disks, whether other sheets ``are_clear`` (c,) of
    them, and c polygons in these planes, whose labels are the numbers of the charts on
    the other side of each edge."""

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    are_clear: np.ndarray
    polygons: list[Polygon]


class _Corners(NamedTuple):
    """The corners of all polygons one behind the other: where they lie on the surface
    (v, n), the number (v,) of the chart to whose polygon each belongs, and that and the
    labels of the two edges there in order (v, 3)."""

    points: np.ndarray
    owner: np.ndarray
    between: np.ndarray


def assemble_charts(
    problem: Problem, charts: FlatCharts, outcome: Covering
) -> ChartAtlas:
    """The atlas of ``charts``, the polygons fitted together.

    Vertices are lifted onto the surface; those of neighbouring charts that nearly
    coincide become one, so that the polygons are the faces of a closed complex although
    each was cut in a plane of its own. Charts of whose polygons the others leave
    nothing are left out.
    """
    charts = _without_empty_polygons(charts)
    neighbours = _neighbours(charts.polygons)
    corners = _lift_corners(problem, charts)
    vertex = _merge_corners(problem, corners, charts.radii, neighbours)
    first_corner = np.unique(vertex, return_index=True)[1]
    distinct = vertex != _previous_vertex(vertex, charts.polygons)
    sizes = np.bincount(corners.owner[distinct], minlength=len(charts.polygons))
    return ChartAtlas(
        centers=charts.centers,
        bases=charts.bases,
        radii=charts.radii,
        neighbours=neighbours,
        vertices=corners.points[first_corner],
        polygons=vertex[distinct],
        polygon_sizes=sizes,
        periods=problem.domain.periods,
        outcome=outcome,
    )


def _without_empty_polygons(charts: FlatCharts) -> FlatCharts:
    """The charts with a polygon, numbered anew."""
    has_polygon = _sizes(charts.polygons) > 0
    if np.all(has_polygon):
        return charts
    number = np.where(has_polygon, np.cumsum(has_polygon) - 1, -1)
    polygons = []
    for vertices, labels in charts.polygons:
        if len(vertices):
            renumbered = np.where(labels >= 0, number[labels], labels)
            polygons.append(Polygon(vertices, renumbered))
    return FlatCharts(
        centers=charts.centers[has_polygon],
        bases=charts.bases[has_polygon],
        radii=charts.radii[has_polygon],
        are_clear=charts.are_clear[has_polygon],
        polygons=polygons,
    )


def _neighbours(polygons: list[Polygon]) -> np.ndarray:
    """Pairs (p, 2) of the numbers of polygons with an edge in common, in order."""
    pairs = set()
    for i, polygon in enumerate(polygons):
        for j in polygon.labels.tolist():
            if j >= 0:
                pairs.add((min(i, j), max(i, j)))
    return np.array(sorted(pairs), dtype=int).reshape(-1, 2)


def _lift_corners(problem: Problem, charts: FlatCharts) -> _Corners:
    """The corners of all polygons, no farther out than the disks, on the surface above
    the tangent planes; in them, where the surface is out of reach."""
    sizes = _sizes(charts.polygons)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    vertices = [polygon.vertices for polygon in charts.polygons]
    y = np.concatenate([np.empty((0, 2)), *vertices])
    radii = charts.radii[owner]
    distance = np.maximum(np.linalg.norm(y, axis=1), 1e-300)
    y *= np.minimum(1.0, radii / distance)[:, None]
    bases = charts.bases[owner]
    flat = charts.centers[owner] + np.einsum("kij,kj->ki", bases, y)
    points, gaps = correct_normal(problem, flat, bases)
    height = np.linalg.norm(points - flat, axis=1)
    is_out_of_reach = (gaps > SOLVED) | (height > TOO_HIGH * radii)
    points[is_out_of_reach] = flat[is_out_of_reach]
    _follow_beside_others(problem, charts, y, owner, points)
    labels = [(q.labels, np.roll(q.labels, 1)) for q in charts.polygons]
    after, before = np.concatenate([np.empty((2, 0), dtype=int), *labels], axis=1)
    between = np.sort(np.stack([owner, after, before], axis=1), axis=1)
    return _Corners(points, owner, between)


def _follow_beside_others(
    problem: Problem,
    charts: FlatCharts,
    positions: np.ndarray,
    owner: np.ndarray,
    points: np.ndarray,
) -> None:
    """Put solutions on the sheets of their charts in the place of those ``points`` (v,
    n) above ``positions`` (v, 2) that belong to charts beside other sheets."""
    corners = np.flatnonzero(~charts.are_clear[owner])
    if not len(corners):
        return
    chart = owner[corners]
    ends, are_reached = follow_sheets(
        problem, charts.centers[chart], charts.bases[chart], positions[corners]
    )
    points[corners[are_reached]] = ends[are_reached]


def _merge_corners(
    problem: Problem, corners: _Corners, radii: np.ndarray, neighbours: np.ndarray
) -> np.ndarray:
    """Number (v,) of the vertex that each corner is: corners that nearly coincide, of
    one polygon or of two neighbours, are one."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    points, owner, _ = corners
    if not len(points):
        return np.empty(0, dtype=int)
    tree = cKDTree(
        torus.into_box(points, problem.domain.periods),
        boxsize=torus.tree_box(problem.domain.periods),
    )
    reach = MERGED_OF_SAME * radii.max()
    i, j = tree.query_pairs(reach, output_type="ndarray").T
    gaps = problem.domain.difference(points[i], points[j])
    distance = np.linalg.norm(gaps, axis=1)
    one, other = owner[i], owner[j]
    distance /= np.minimum(radii[one], radii[other])
    is_adjacent = _are_adjacent(one, other, neighbours, len(radii))
    is_same = np.all(corners.between[i] == corners.between[j], axis=1)
    same = (distance < MERGED_OF_SAME) & is_same
    same |= (distance < MERGED) & is_adjacent
    i, j = i[same], j[same]
    count = len(points)
    graph = csr_array((np.ones(len(i)), (i, j)), shape=(count, count))
    vertex: np.ndarray = connected_components(graph, directed=False)[1]
    return vertex


def _are_adjacent(
    i: np.ndarray, j: np.ndarray, neighbours: np.ndarray, count: int
) -> np.ndarray:
    """Whether the charts ``i`` and ``j`` (k,), of ``count`` in all, are the same or
    neighbours."""
    # a pair of charts (low, high) as one number
    low, high = np.minimum(i, j), np.maximum(i, j)
    pairs = low * count + high
    adjacent = neighbours[:, 0] * count + neighbours[:, 1]
    same = np.arange(count) * (count + 1)
    return np.isin(pairs, np.concatenate([adjacent, same]))


def _previous_vertex(vertex: np.ndarray, polygons: list[Polygon]) -> np.ndarray:
    """The vertex (v,) before each corner, around its polygon."""
    sizes = _sizes(polygons)
    ends = np.cumsum(sizes)
    previous = np.roll(vertex, 1)
    previous[ends - sizes] = vertex[ends - 1]
    return previous


def _sizes(polygons: list[Polygon]) -> np.ndarray:
    """Number (c,) of vertices of each polygon."""
    return np.array([len(polygon.vertices) for polygon in polygons], dtype=int)
