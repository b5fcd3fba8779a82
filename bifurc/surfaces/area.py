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
    lie ``outside`` the bounds (c,)."""

    areas: np.ndarray
    errors: np.ndarray
    outside: np.ndarray


def cell_sizes(
    problem: Problem, charts: FlatCharts, cells: Cells, metric: np.ndarray
) -> Sizes:
    """The areas of the cells of ``charts``, lengths being taken after the unknowns are
    multiplied by ``metric`` (n,).

    The error of a cell whose edges do not fit those of its neighbours, or over which
    the surface is not followed everywhere, is its whole area; where one leaves the
    bounds a few times the area outside, as far as nodes show it, is added.
    """
    measure = _Measure(problem, charts, cells, metric)
    areas, errors, outside = measure.sizes(*ORDERS[0])
    coarse, *_ = measure.sizes(*ORDERS[1])
    errors += np.abs(areas - coarse) + ROUNDING * np.abs(areas)
    errors[cells.chart[cells.misfits()]] = np.inf
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
        cells = self._cells
        nodes, weights = _gauss(along)
        curves, are_known = self._curves(nodes)
        corners, rates = self._outlines(curves, nodes)
        turned = _cross(corners, rates) * weights  # (e, along)
        t, t_weights = _gauss(rays)
        chart = np.repeat(cells.chart, along)
        ends = self._graphs.part(chart)
        points, is_there = ends.along(corners.reshape(-1, 2), t)
        points = points.reshape(-1, self._problem.n)
        plane = (t * t_weights) * turned.reshape(-1, 1)
        ratio = self._ratios(np.repeat(chart, rays), points).reshape(plane.shape)
        positions = corners.reshape(-1, 1, 2) * t[:, None]
        errors = np.zeros(self._count)
        for cell in np.unique(chart[~is_there.all(axis=1)]):
            own = (chart == cell)[:, None]
            gap = _fill(ratio, positions, own & is_there, own & ~is_there)
            errors[cell] = gap * np.abs(plane[own & ~is_there]).sum()
        errors[cells.chart[~are_known[self._edge]]] = np.inf
        areas = self._sums(chart, (ratio * plane).sum(axis=1))
        # a cell beside a bound that bends is the difference of sectors
        is_bent = self._sums(cells.chart, turned.min(axis=1) < 0.0) > 0
        is_inside = self._problem.domain.are_inside(points).reshape(plane.shape)
        is_inside |= is_bent[chart, None]
        outside = self._sums(chart, (ratio * plane * ~is_inside).sum(axis=1))
        return Sizes(areas, errors + BLURRED * outside, outside)

    def _ratios(self, chart: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Areas on the surface at its points (k, n) over those in the planes of charts
        (k,)."""
        slopes = self._graphs.part(chart).slopes(points) * self._metric[:, None]
        ratios: np.ndarray = np.sqrt(np.linalg.det(np.swapaxes(slopes, 1, 2) @ slopes))
        return ratios

    def _sums(self, chart: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Sums (c,) of values (k,), each of a ``chart`` (k,)."""
        return np.bincount(chart, values, minlength=self._count)

    def _curves(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (u, k, n) of all edges, from the vertex of the lower number on, and
        whether they are known (u,): between those to which the surface was followed
        others are interpolated."""
        cells, n = self._cells, self._problem.n
        begin, end = cells.vertices[self._pairs.T]
        chord = self._problem.domain.difference(end, begin)
        points = begin[:, None] + nodes[:, None] * chord[:, None]
        shape = points.shape
        graphs = self._graphs.part(np.repeat(cells.chart[self._first], len(nodes)))
        positions = graphs.positions(points.reshape(-1, n))
        points, is_there = graphs.above(positions)
        label = np.repeat(cells.label[self._first], len(nodes))
        border = np.flatnonzero(label <= BORDER)
        charts = np.repeat(cells.chart[self._first], len(nodes))[border]
        points[border], is_there[border] = self._graphs.part(charts).onto_bounds(
            positions[border], bounds_of(label[border], n)
        )
        points, is_there = points.reshape(shape), is_there.reshape(shape[:2])
        are_known = is_there.all(axis=1)
        for k in np.flatnonzero(~are_known & (cells.label[self._first] > BORDER)):
            there = is_there[k]
            if there.sum() >= FEWEST_ON_EDGE:
                places = np.concatenate([[0.0], nodes[there], [1.0]])
                known = np.concatenate([begin[k, None], points[k, there], end[k, None]])
                offsets = self._problem.domain.difference(known, begin[k])
                through = np.linalg.solve(np.vander(places), offsets)
                at = np.vander(nodes[~there], len(places))
                points[k, ~there] = begin[k] + at @ through
                are_known[k] = True
        return points, are_known

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


def _fill(
    ratio: np.ndarray, positions: np.ndarray, known: np.ndarray, lost: np.ndarray
) -> float:
    """Put values of the polynomial that fits the ``known`` ratios (k, s) of one cell,
    at ``positions`` (k, s, 2), in the place of those ``lost``, and how far off they may
    be; infinitely where too few are known."""
    y = positions[known]
    if len(y) < 2 * len(POWERS):
        return np.inf
    size = np.abs(y).max()
    terms = np.prod((y / size)[:, None] ** POWERS, axis=2)
    values = ratio[known]
    fit = np.linalg.lstsq(terms, values, rcond=None)[0]
    at = np.prod((positions[lost] / size)[:, None] ** POWERS, axis=2)
    ratio[lost] = at @ fit
    return float(np.abs(terms @ fit - values).max())


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
