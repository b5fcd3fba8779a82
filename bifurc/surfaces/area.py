"""Areas of the cells of a complex on a surface, by quadrature.

The edge between two vertices is the curve above the straight line between them in the
plane of one of the two charts, the same for both; along a bound it runs in that. So the
cells divide the surface without gaps. In the plane of its chart a cell consists of
sectors, from the centre to its edges: over each the ratio of areas, from the
derivatives of the graph, is integrated by Gauss's rule along the edge and along the
rays.

The error of every cell comes of the same places, as null rules say it (Berntsen and
Espelid 1991, Error estimation in automatic quadrature routines): the last coefficients in
Legendre polynomials shrink at some rate, and what would come four degrees later at that
rate is taken for the error of a rule that is exact far beyond.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from bifurc.problem import Problem
from bifurc.surfaces.complex import Cells
from bifurc.surfaces.graphs import Graphs, bounds_of
from bifurc.surfaces.polygon import BORDER, FlatCharts

ALONG, RAYS = 6, 5  # nodes along an edge and along a ray
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
    areas, errors, outside = measure.sizes()
    errors += ROUNDING * np.abs(areas)
    errors[cells.chart[cells.misfits()]] = np.inf
    is_outside = ~problem.domain.are_inside(cells.vertices)
    leaving = cells.chart[is_outside[cells.begin]]
    errors[leaving], outside[leaving] = np.inf, areas[leaving]
    return Sizes(areas, np.minimum(errors, np.abs(areas)), outside)


class _Rays(NamedTuple):
    """The ``integrals`` (e, r) of the ratio of areas along rays, of which each edge has r,
    how far off the area is by each but the first, ``errors`` (e, r - 1), and what of it
    lies ``outside`` the bounds (c,)."""

    integrals: np.ndarray
    errors: np.ndarray
    outside: np.ndarray


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

    def sizes(self) -> Sizes:
        """Areas, and errors by the quadrature, by nodes to which the surface was not
        followed and by what lies outside the bounds."""
        nodes, weights = _gauss(ALONG)
        curves, are_known = self._curves(nodes)
        outline = self._outlines(curves)
        places = np.concatenate([[0.0], nodes, [1.0]])
        rates = np.einsum("ij,ejk->eik", _differentiation(places), outline)
        turned = _cross(outline, rates)  # (e, ALONG + 2)
        rays = self._rays(outline[:, :-1], turned[:, 1:-1] * weights)
        at_ends = rays.integrals[self._cells.following, :1]
        sectors = turned * np.concatenate([rays.integrals, at_ends], axis=1)
        errors = self._sums(rays.errors) + BLURRED * rays.outside
        errors += self._sums(_tails(sectors, places)[:, None])
        errors += self._sums(_errors_of_edges(outline, places)[:, None])
        errors[self._cells.chart[~are_known[self._edge]]] = np.inf
        areas = self._sums(sectors[:, 1:-1] * weights)
        return Sizes(areas, errors, rays.outside)

    def _rays(self, ends: np.ndarray, turned: np.ndarray) -> _Rays:
        """The rays from the centres to the beginning and the nodes of each edge, ``ends``
        (e, r, 2), all but the first of each of a weight ``turned`` (e, r - 1)."""
        count = ends.shape[1]
        chart = np.repeat(self._cells.chart, count)
        t, t_weights = _gauss(RAYS)
        flat = ends.reshape(-1, 2)
        points, is_there = self._graphs.part(chart).along(flat, t)
        ratio = self._ratios(chart, points)
        gaps = _fill_cells(ratio, flat[:, None] * t[:, None], is_there, chart)
        gaps = np.maximum(gaps, _tails(ratio, t)[:, None]).reshape(-1, count)[:, 1:]
        ratio = ratio.reshape(-1, count, RAYS)
        weighted = t * t_weights * turned[:, :, None]
        outside = ratio * self._are_outside(points).reshape(ratio.shape)
        outside = outside[:, 1:] * weighted
        outside[self._are_bent(turned)[self._cells.chart]] = 0.0
        return _Rays(
            integrals=ratio @ (t * t_weights),
            errors=gaps * np.abs(weighted).sum(axis=2),
            outside=self._sums(outside.sum(axis=2)),
        )

    def _are_bent(self, turned: np.ndarray) -> np.ndarray:
        """Which cells (c,) are differences of sectors, some of which are turned (e, k)
        backwards, as one beside a bound that bends."""
        are_back = turned.min(axis=1) < 0.0
        are_bent: np.ndarray = self._sums(are_back[:, None]) > 0
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

    def _sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (c,) over each cell of values (e, k) at its edges."""
        sums = values.sum(axis=1)
        return np.bincount(self._cells.chart, sums, minlength=self._count)

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

    def _outlines(self, curves: np.ndarray) -> np.ndarray:
        """Positions (e, k + 2, 2) of the beginning, the nodes and the end of each edge in
        the plane of its chart."""
        cells, n = self._cells, self._problem.n
        is_back = cells.begin > cells.end
        inner = curves[self._edge]
        inner[is_back] = inner[is_back, ::-1]
        begin, end = cells.vertices[cells.begin], cells.vertices[cells.end]
        points = np.concatenate([begin[:, None], inner, end[:, None]], axis=1)
        count = points.shape[1]
        graphs = self._graphs.part(np.repeat(cells.chart, count))
        return graphs.positions(points.reshape(-1, n)).reshape(-1, count, 2)


def _errors_of_edges(outline: np.ndarray, places: np.ndarray) -> np.ndarray:
    """How much area (e,) edges move from one cell to the next where the polynomials
    through their ``outline`` (e, k, 2) at ``places`` (k,) are off."""
    lengths: np.ndarray = np.linalg.norm(outline[:, -1] - outline[:, 0], axis=1)
    off = _tails(np.swapaxes(outline, 1, 2), places)
    return lengths * np.linalg.norm(off, axis=1)


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


def _tails(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """What is left (...) of a smooth function with ``values`` (..., k) at ``places`` (k,)
    four degrees after the polynomial through these, if its coefficients go on to shrink as
    the last four do."""
    basis = legvander(2.0 * places - 1.0, len(places) - 1)
    sizes = np.abs(values @ np.linalg.inv(basis).T)
    last = sizes[..., -2:].max(axis=-1)
    before = sizes[..., -4:-2].max(axis=-1)
    rate = last / np.maximum(before, np.maximum(last, 1e-300))
    tails: np.ndarray = last * rate**2
    return tails


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
