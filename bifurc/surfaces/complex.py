"""The polygons of charts that overlap put together to one closed complex."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.problem import Problem
from bifurc.surfaces.graphs import Graphs, bounds_of
from bifurc.surfaces.polygon import BORDER, FlatCharts, Polygon
from bifurc.surfaces.sheet import SOLVED
from bifurc.system import relative_gaps

# Corners of neighbouring polygons closer than this, over their charts' radius, are one
# vertex; and those between the same three charts, or two and a bound.
MERGED, MERGED_OF_SAME = 0.15, 0.7
# Height over the radius above which a corner was lifted onto another sheet.
TOO_HIGH = 0.5
# Length of an edge that can be given up, over the smallest radius of its charts, and how
# often such are looked for.
SHORT, ROUNDS = 1.0, 4


class _Corners(NamedTuple):
    """The corners of all polygons one behind the other: where they lie on the surface
    (v, n), the number (v,) of the chart to whose polygon each belongs, the positions
    (v, 2) in its plane, it and the labels of the two edges there in order (v, 3), and
    whether the surface was followed there (v,)."""

    points: np.ndarray
    owner: np.ndarray
    positions: np.ndarray
    between: np.ndarray
    is_there: np.ndarray


class Cells(NamedTuple):
    """Polygons fitted together: ``vertices`` (v, n), whether they ``are_off_bounds`` (v,)
    on which they should lie, and the ``bases`` (c, n, 2) of the planes of all charts; and
    one behind the other around each polygon the edges, each with the number of its
    ``chart`` (e,), the vertices where it begins and ``end``s (e,), and its ``label``
    (e,)."""

    vertices: np.ndarray
    are_off_bounds: np.ndarray
    bases: np.ndarray
    chart: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    label: np.ndarray

    def part(self, edges: np.ndarray) -> Cells:
        """These with some of the ``edges`` (e,) alone."""
        return Cells(*self[:3], *(column[edges] for column in self[3:]))

    @property
    def pairs(self) -> np.ndarray:
        """The two vertices (e, 2) of each edge, the lower number first."""
        return np.sort(np.stack([self.begin, self.end], axis=1), axis=1)

    @property
    def following(self) -> np.ndarray:
        """Number (e,) of the edge after each one around its polygon."""
        first = np.searchsorted(self.chart, self.chart)
        end = np.searchsorted(self.chart, self.chart, side="right")
        next_one = np.arange(1, len(self.chart) + 1)
        after: np.ndarray = np.where(next_one < end, next_one, first)
        return after

    def misfits(self) -> np.ndarray:
        """Which edges (e,) do not fit: one inside the bounds that not just two polygons
        have, on its two sides, one about a vertex where polygons meet that are not one
        fan, and one that begins at a vertex off its bounds."""
        _, edge, sizes = np.unique(
            self.pairs, axis=0, return_inverse=True, return_counts=True
        )
        is_border = (sizes[edge] == 1) & (self.label <= BORDER)
        order = np.argsort(edge, kind="stable")
        order = order[sizes[edge[order]] == 2]
        one, other = order[0::2], order[1::2]
        is_back = self.begin[one] == self.end[other]
        has_two_sides = is_back != self._are_mirrored(one, other)
        one, other, is_back = (x[has_two_sides] for x in (one, other, is_back))
        is_shared = np.zeros(len(edge), dtype=bool)
        is_shared[one] = is_shared[other] = True
        is_wrong = (self._fans(one, other, is_back) > 1) | self.are_off_bounds
        misfits: np.ndarray = ~(is_border | is_shared) | is_wrong[self.begin]
        return misfits

    def _are_mirrored(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Whether the planes of the charts of edges (k,) and (k,) turn opposite ways."""
        bases = self.bases[self.chart[one]], self.bases[self.chart[other]]
        turns = np.linalg.det(np.einsum("kij,kil->kjl", *bases))
        are_mirrored: np.ndarray = turns < 0.0
        return are_mirrored

    def _fans(
        self, one: np.ndarray, other: np.ndarray, is_back: np.ndarray
    ) -> np.ndarray:
        """How many fans of polygons meet at each vertex (v,); ``one`` (k,) and ``other``
        (k,) are the numbers of edges that are twins, of which one ``is_back`` (k,) if
        it runs against the other."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components

        count = len(self.chart)
        after = self.following
        # edges that leave the same vertex: one of each polygon about it
        at_begin = np.where(is_back, after[other], other)
        at_end = np.where(is_back, other, after[other])
        i, j = np.concatenate([one, after[one]]), np.concatenate([at_begin, at_end])
        graph = csr_array((np.ones(len(i)), (i, j)), shape=(count, count))
        _, fan = connected_components(graph, directed=False)
        vertices = np.unique(np.stack([self.begin, fan], axis=1), axis=0)[:, 0]
        fans: np.ndarray = np.bincount(vertices, minlength=len(self.vertices))
        return fans


def fitted_cells(problem: Problem, charts: FlatCharts) -> Cells:
    """The polygons of ``charts`` fitted together, none of which is empty.

    Vertices are lifted onto the surface; those of neighbouring charts that nearly
    coincide become one, so that the polygons are the faces of a closed complex although
    each was cut in a plane of its own. Those on bounds are moved there.
    """
    corners = _lift_corners(problem, charts)
    neighbours = neighbours_of(charts.polygons)
    vertex = _merge_corners(problem, corners, charts.radii, neighbours)
    cells, first = _cells_between(vertex, corners, charts)
    for _ in range(ROUNDS):
        crowded = _crowded_pairs(problem, charts, cells)
        if not len(crowded):
            break
        vertex = _joined(len(cells.vertices), crowded)[vertex]
        cells, first = _cells_between(vertex, corners, charts)
    _move_onto_bounds(problem, charts, cells, corners, first)
    return cells


def _cells_between(
    vertex: np.ndarray, corners: _Corners, charts: FlatCharts
) -> tuple[Cells, np.ndarray]:
    """The cells whose ``corners`` are the vertices of these numbers (v,), and the number
    of the corner whose place each vertex takes."""
    following = _next_vertex(vertex, charts.polygons)
    leaves = vertex != following
    order = np.argsort(~corners.is_there, kind="stable")
    first = order[np.unique(vertex[order], return_index=True)[1]]
    labels = np.concatenate([np.empty(0, int), *(q.labels for q in charts.polygons)])
    cells = Cells(
        vertices=corners.points[first],
        are_off_bounds=np.zeros(len(first), dtype=bool),
        bases=charts.bases,
        chart=corners.owner[leaves],
        begin=vertex[leaves],
        end=following[leaves],
        label=labels[leaves],
    )
    return cells, first


def _crowded_pairs(problem: Problem, charts: FlatCharts, cells: Cells) -> np.ndarray:
    """Pairs of vertices (k, 2) between which edges of more than two polygons run that
    are short for all of them, inside the bounds: where four charts meet almost in a
    point, each two that lie opposite may hold the other two apart."""
    pairs, edge, sizes = np.unique(
        cells.pairs, axis=0, return_inverse=True, return_counts=True
    )
    gaps = problem.domain.difference(*np.swapaxes(cells.vertices[pairs], 0, 1))
    lengths = np.linalg.norm(gaps, axis=1)
    smallest = np.full(len(pairs), np.inf)
    np.minimum.at(smallest, edge, charts.radii[cells.chart])
    is_at_bound = np.zeros(len(cells.vertices), dtype=bool)
    is_at_bound[pairs[edge[cells.label <= BORDER]]] = True
    is_inside = ~is_at_bound[pairs].any(axis=1)
    crowded: np.ndarray = pairs[(sizes > 2) & (lengths < SHORT * smallest) & is_inside]
    return crowded


def _joined(count: int, pairs: np.ndarray) -> np.ndarray:
    """New numbers of ``count`` vertices, those of the pairs (k, 2) being one."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    graph = csr_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(count, count))
    number: np.ndarray = connected_components(graph, directed=False)[1]
    return number


def _move_onto_bounds(
    problem: Problem,
    charts: FlatCharts,
    cells: Cells,
    corners: _Corners,
    first: np.ndarray,
) -> None:
    """Move vertices at which edges along bounds end to these, over the surface, and note
    where there is no such place. ``first`` (v,) are the numbers of corners at the
    vertices."""
    on_bound = np.zeros((len(cells.vertices), 2 * problem.n), dtype=bool)
    along = bounds_of(cells.label, problem.n)
    np.logical_or.at(on_bound, cells.begin, along)
    np.logical_or.at(on_bound, cells.end, along)
    moved = np.flatnonzero(on_bound.any(axis=1))
    corner = first[moved]
    graph = Graphs(problem, charts).part(corners.owner[corner])
    points, is_there = graph.onto_bounds(corners.positions[corner], on_bound[moved])
    cells.vertices[moved[is_there]] = points[is_there]
    cells.are_off_bounds[moved[~is_there]] = True


def without_empty_polygons(charts: FlatCharts) -> FlatCharts:
    """The charts with a polygon, numbered anew."""
    has_polygon = _sizes(charts.polygons) > 0
    if np.all(has_polygon):
        return charts
    number = np.where(has_polygon, np.cumsum(has_polygon) - 1, -1)
    polygons = []
    for vertices, labels in charts.polygons:
        if len(vertices):
            renumbered = labels.copy()
            is_inner = labels >= 0  # others are bounds
            renumbered[is_inner] = number[labels[is_inner]]
            polygons.append(Polygon(vertices, renumbered))
    return FlatCharts(
        centers=charts.centers[has_polygon],
        bases=charts.bases[has_polygon],
        radii=charts.radii[has_polygon],
        are_clear=charts.are_clear[has_polygon],
        polygons=polygons,
    )


def neighbours_of(polygons: list[Polygon]) -> np.ndarray:
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
    graphs = Graphs(problem, charts).part(owner)
    points, is_there = graphs.above(y)
    flat = graphs.flat(y)
    height = np.linalg.norm(points - flat, axis=1)
    is_solved = relative_gaps(problem, points) <= SOLVED
    is_out_of_reach = ~is_solved | (height > TOO_HIGH * radii)
    points[is_out_of_reach] = flat[is_out_of_reach]
    between = _between(owner, charts.polygons)
    return _Corners(points, owner, y, between, is_there)


def _between(owner: np.ndarray, polygons: list[Polygon]) -> np.ndarray:
    """The charts and bounds (v, 3), in order, that meet at the corners of polygons,
    each of a chart (v,)."""
    labels = [(polygon.labels, np.roll(polygon.labels, 1)) for polygon in polygons]
    after, before = np.concatenate([np.empty((2, 0), dtype=int), *labels], axis=1)
    between: np.ndarray = np.sort(np.stack([owner, after, before], axis=1), axis=1)
    return between


def _merge_corners(
    problem: Problem, corners: _Corners, radii: np.ndarray, neighbours: np.ndarray
) -> np.ndarray:
    """Number (v,) of the vertex that each corner is: corners that nearly coincide, of
    one polygon or of two neighbours, are one, but for the ends of an edge along a bound
    between two others: that corner of the region is not cut off."""
    points, owner = corners.points, corners.owner
    i, j = _corners_of_pairs(owner, len(radii), neighbours)
    gaps = problem.domain.difference(points[i], points[j])
    distance = np.linalg.norm(gaps, axis=1)
    distance /= np.minimum(radii[owner[i]], radii[owner[j]])
    is_same = np.all(corners.between[i] == corners.between[j], axis=1)
    is_nested = _are_nested(corners.between, problem.n, i, j)
    is_one = (distance < MERGED) & is_nested | (is_same & (distance < MERGED_OF_SAME))
    return _joined(len(points), np.stack([i[is_one], j[is_one]], axis=1))


def _are_nested(
    between: np.ndarray, n: int, i: np.ndarray, j: np.ndarray
) -> np.ndarray:
    """Whether of two corners (p,) and (p,), each ``between`` three charts and bounds (v,
    3), one lies on all bounds of the other."""
    on_bounds = bounds_of(between.ravel(), n).reshape(*between.shape, 2 * n)
    one, other = on_bounds[i].any(axis=1), on_bounds[j].any(axis=1)
    are_nested: np.ndarray = np.all(one <= other, axis=1) | np.all(other <= one, axis=1)
    return are_nested


def _corners_of_pairs(
    owner: np.ndarray, count: int, neighbours: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Every two corners (p,) and (p,) of the same polygon or of two neighbours, of the
    polygons of ``count`` charts to which they belong (v,)."""
    sizes = np.bincount(owner, minlength=count)
    first = np.cumsum(sizes) - sizes
    own = np.arange(count)
    one = np.concatenate([own, neighbours[:, 0]])
    other = np.concatenate([own, neighbours[:, 1]])
    counts = sizes[one] * sizes[other]
    pair = np.repeat(np.arange(len(one)), counts)
    number = np.arange(len(pair)) - np.repeat(np.cumsum(counts) - counts, counts)
    place, place_in_other = np.divmod(number, sizes[other][pair])
    i, j = first[one][pair] + place, first[other][pair] + place_in_other
    return i[j > i], j[j > i]


def _next_vertex(vertex: np.ndarray, polygons: list[Polygon]) -> np.ndarray:
    """The vertex (v,) after each corner, around its polygon."""
    sizes = _sizes(polygons)
    ends = np.cumsum(sizes)
    following = np.roll(vertex, -1)
    following[ends - 1] = vertex[ends - sizes]
    return following


def _sizes(polygons: list[Polygon]) -> np.ndarray:
    """Number (c,) of vertices of each polygon."""
    return np.array([len(polygon.vertices) for polygon in polygons], dtype=int)
