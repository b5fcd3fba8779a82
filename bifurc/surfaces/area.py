"""Areas of the cells of a complex on a surface, by quadrature.

The edge between two vertices is the curve above the straight line between them in the
plane of one of the two charts, the same for both; along a bound it runs in that. So the
cells divide the surface without gaps. In the plane of its chart a cell consists of
sectors, from the centre to its edges: over each the ratio of areas, from the
derivatives of the graph, is integrated by Gauss's rule along the edge and along the
rays. The error of every cell is the change from a rule of lower order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from bifurc.problem import Problem
from bifurc.surfaces.complex import Cells
from bifurc.surfaces.graphs import Graphs, bounds_of
from bifurc.surfaces.polygon import BORDER, FlatCharts

# Nodes along an edge and along a ray, of the rule and of the lower one.
ORDERS = ((6, 5), (5, 4))
# Error of an area by rounding, over it.
ROUNDING = 1e-13
# Points of an edge that others are interpolated between, at least, and powers of the
# position in the polynomial that stands for the ratio of areas where the surface was
# not followed.
FEWEST_ON_EDGE = 3
POWERS = np.array([(i, j) for i in range(6) for j in range(6 - i)])
# Error of the area outside the bounds, in a cell that leaves them, over it.
BLURRED = 3.0


class Sizes(NamedTuple):
    """The ``areas`` (c,) of cells, their ``errors`` (c,), and what of them is seen to
    lie ``outside`` the bounds (c,), all of one with a vertex there."""

    areas: np.ndarray
    errors: np.ndarray
    outside: np.ndarray


def cell_sizes(
    problem: Problem, charts: FlatCharts, cells: Cells, metric: np.ndarray
) -> Sizes:
    """The areas of the cells of ``charts``, lengths being taken after the unknowns are
    multiplied by ``metric`` (n,).

    The error of a cell whose edges do not fit those of its neighbours, with a vertex
    outside the bounds, or over which the surface is not followed everywhere, is its
    whole area; where one leaves the bounds a few times the area outside, as far as
    nodes show it, is added.
    """
    measure = _Measure(problem, charts, cells, metric)
    areas, errors, outside = measure.sizes(*ORDERS[0])
    coarse, *_ = measure.sizes(*ORDERS[1])
    errors += np.abs(areas - coarse) + ROUNDING * np.abs(areas)
    errors[cells.chart[cells.misfits()]] = np.inf
    is_outside = ~problem.domain.are_inside(cells.vertices)
    leaving = cells.chart[is_outside[cells.begin]]
    errors[leaving], outside[leaving] = np.inf, areas[leaving]
    return Sizes(areas, np.minimum(errors, np.abs(areas)), outside)


class _Measure:
    """The edges and sectors of cells, each edge taken once."""

    def __init__(
        self, problem: Problem, charts: FlatCharts, cells: Cells, metric: np.ndarray
    ):
        self._problem = problem
        self._cells = cells
        self._metric = metric
        self._count = len(charts.radii)
        self._graphs = Graphs(problem, charts)
        pairs, first, edge = np.unique(
            cells.pairs, axis=0, return_index=True, return_inverse=True
        )
        self._pairs, self._first, self._edge = pairs, first, edge

    def sizes(self, along: int, rays: int) -> Sizes:
        """Areas with so many nodes along edges and along rays, and errors by nodes to
        which the surface was not followed and by what lies outside the bounds."""
        nodes, weights = _gauss(along)
        curves, are_known = self._curves(nodes)
        corners, rates = self._outlines(curves, nodes)
        turned = _cross(corners, rates) * weights  # (e, along)
        t, t_weights = _gauss(rays)
        plane = (t * t_weights) * turned.reshape(-1, 1)
        chart = np.repeat(self._cells.chart, along)
        ends = corners.reshape(-1, 2)
        points, is_there = self._graphs.part(chart).along(ends, t)
        ratio = self._ratios(chart, points)
        positions = corners.reshape(-1, 1, 2) * t[:, None]
        gaps = _fill_cells(ratio, positions, is_there, chart)
        parts = ratio * plane
        is_outside = self._are_outside(points) & ~self._are_bent(turned)[chart, None]
        outside = self._sums(chart, parts * is_outside)
        errors = self._sums(chart, gaps * np.abs(plane)) + BLURRED * outside
        errors[self._cells.chart[~are_known[self._edge]]] = np.inf
        return Sizes(self._sums(chart, parts), errors, outside)

    def _are_bent(self, turned: np.ndarray) -> np.ndarray:
        """Which cells (c,) are differences of sectors, some of which are turned (e, k)
        backwards, as one beside a bound that bends."""
        are_back = turned.min(axis=1) < 0.0
        are_bent: np.ndarray = self._sums(self._cells.chart, are_back[:, None]) > 0
        return are_bent

    def _are_outside(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, s, n) lie outside the bounds (k, s)."""
        flat = points.reshape(-1, self._problem.n)
        are_outside: np.ndarray = ~self._problem.domain.are_inside(flat)
        return are_outside.reshape(points.shape[:2])

    def _ratios(self, chart: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Areas on the surface at its points (k, s, n), over those in the planes of
        charts (k,): (k, s)."""
        graphs = self._graphs.part(np.repeat(chart, points.shape[1]))
        slopes = graphs.slopes(points.reshape(-1, self._problem.n))
        slopes *= self._metric[:, None]
        squares = np.linalg.det(np.swapaxes(slopes, 1, 2) @ slopes)
        ratios: np.ndarray = np.sqrt(squares).reshape(points.shape[:2])
        return ratios

    def _sums(self, chart: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Sums (c,) of values (k, s), each row of a ``chart`` (k,)."""
        return np.bincount(chart, values.sum(axis=1), minlength=self._count)

    def _curves(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (u, k, n) of all edges, from the vertex of the lower number on, and
        whether they are known (u,): between those to which the surface was followed
        others are interpolated."""
        cells, n, count = self._cells, self._problem.n, len(nodes)
        begin, end = cells.vertices[self._pairs.T]
        chord = self._problem.domain.difference(end, begin)
        points = begin[:, None] + nodes[:, None] * chord[:, None]
        shape = points.shape
        chart = np.repeat(cells.chart[self._first], count)
        graphs = self._graphs.part(chart)
        positions = graphs.positions(points.reshape(-1, n))
        points, is_there = graphs.above(positions)
        label = np.repeat(cells.label[self._first], count)
        border = np.flatnonzero(label <= BORDER)
        points[border], is_there[border] = self._graphs.part(chart[border]).onto_bounds(
            positions[border], bounds_of(label[border], n)
        )
        points = points.reshape(shape)
        return points, self._fill_edges(points, is_there.reshape(shape[:2]), nodes)

    def _fill_edges(
        self, points: np.ndarray, is_there: np.ndarray, nodes: np.ndarray
    ) -> np.ndarray:
        """Interpolate ``points`` (u, k, n) of edges that are not there, inside the
        bounds, and whether all are known then (u,)."""
        are_known = is_there.all(axis=1)
        is_inner = self._cells.label[self._first] > BORDER
        can_be_filled = is_inner & (is_there.sum(axis=1) >= FEWEST_ON_EDGE)
        for k in np.flatnonzero(~are_known & can_be_filled):
            begin, end = self._cells.vertices[self._pairs[k]]
            points[k] = self._between(points[k], is_there[k], nodes, (begin, end))
        are_filled: np.ndarray = are_known | can_be_filled
        return are_filled

    def _between(
        self,
        points: np.ndarray,
        are_known: np.ndarray,
        nodes: np.ndarray,
        ends: tuple[np.ndarray, np.ndarray],
    ) -> np.ndarray:
        """Points (k, n) at ``nodes`` (k,) of the polynomial through those of them that
        ``are_known`` (k,) and through both ``ends`` (n,)."""
        places = np.concatenate([[0.0], nodes[are_known], [1.0]])
        known = np.concatenate([ends[0][None], points[are_known], ends[1][None]])
        offsets = self._problem.domain.difference(known, ends[0])
        through = np.linalg.solve(np.vander(places), offsets)
        between: np.ndarray = ends[0] + np.vander(nodes, len(places)) @ through
        return between

    def _outlines(
        self, curves: np.ndarray, nodes: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Positions (e, k, 2) of the nodes of each edge in the plane of its chart, and
        their derivatives along it (e, k, 2)."""
        cells, n = self._cells, self._problem.n
        is_back = cells.begin > cells.end
        inner = curves[self._edge]
        inner[is_back] = inner[is_back, ::-1]
        begin, end = cells.vertices[cells.begin], cells.vertices[cells.end]
        points = np.concatenate([begin[:, None], inner, end[:, None]], axis=1)
        count = points.shape[1]
        graphs = self._graphs.part(np.repeat(cells.chart, count))
        outline = graphs.positions(points.reshape(-1, n)).reshape(-1, count, 2)
        places = np.concatenate([[0.0], nodes, [1.0]])
        rates = np.einsum("ij,ejk->eik", _differentiation(places), outline)
        return outline[:, 1:-1], rates[:, 1:-1]


def _fill_cells(
    ratio: np.ndarray, positions: np.ndarray, is_there: np.ndarray, chart: np.ndarray
) -> np.ndarray:
    """Put values of a polynomial that fits the others in the place of ratios (k, s)
    that are not there, and how far off they may be (k, 1).

    The rays (k,), with ``positions`` (k, s, 2), are those of cells of a ``chart`` (k,)
    each, and every cell has a polynomial. Where too few are known it is infinite.
    """
    gaps = np.zeros((len(chart), 1))
    for cell in np.unique(chart[~is_there.all(axis=1)]):
        own = np.flatnonzero(chart == cell)
        known = is_there[own]
        y = positions[own] / np.abs(positions[own]).max()
        terms = np.prod(y[:, :, None] ** POWERS, axis=3)
        gaps[own] = np.inf
        if known.sum() >= 2 * len(POWERS):
            values = ratio[own]
            fit = np.linalg.lstsq(terms[known], values[known], rcond=None)[0]
            ratio[own] = np.where(known, values, terms @ fit)
            misses = np.abs(terms[known] @ fit - values[known]).max()
            gaps[own] = np.where(known.all(axis=1, keepdims=True), 0.0, misses)
    return gaps


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights (count,) of Gauss's rule from 0 to 1."""
    nodes, weights = leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def _differentiation(places: np.ndarray) -> np.ndarray:
    """The matrix (k, k) that takes values at ``places`` (k,) to the derivatives there of
    the polynomial through them (Berrut and Trefethen 2004)."""
    gaps = places[:, None] - places + np.eye(len(places))
    weights = 1.0 / gaps.prod(axis=1)
    matrix: np.ndarray = weights / weights[:, None] / gaps
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The determinants (...) of vectors (..., 2)."""
    cross: np.ndarray = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return cross
