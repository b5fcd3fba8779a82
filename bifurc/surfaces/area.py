"""Areas of the cells of a complex on a surface, by quadrature.

The edge between two vertices is the curve above the straight line between them in the
plane of one of the two charts, the same for both; along a bound it runs in that. So the
cells divide the surface without gaps. In the plane of its chart a cell consists of
sectors, from the centre to its edges. The graph above a disk is a polynomial
(`bifurc.surfaces.patches`), and the ratio of areas is another one: over rays it is
integrated exactly, along edges by Gauss's rule.

The error of every cell comes of the same places, as null rules say it (Berntsen and
Espelid 1991, Error estimation in automatic quadrature routines): the last coefficients in
orthogonal polynomials shrink at some rate, and what would come next at that rate is taken
for the error.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from bifurc.problem import Problem
from bifurc.surfaces.complex import Cells
from bifurc.surfaces.graphs import Graphs, bounds_of
from bifurc.surfaces.patches import Patches
from bifurc.surfaces.polygon import BORDER, FlatCharts

# Degree of the polynomials that stand for the surface, and nodes along an edge, at first
# and where an area is not known well then.
RULES = ((10, 6), (14, 10), (18, 13))
# Error of an area that is known well enough, over it.
WELL_KNOWN = 1e-7
# Error of an area by rounding, over it.
ROUNDING = 1e-11
# Distance from the bounds, over the radius, from which on no cell leaves them, and places
# along a ray at which it is seen.
FAR, RAYS = 2.0, 5
# Error of the area outside the bounds, in a cell that leaves them, over it.
BLURRED = 3.0


class Sizes(NamedTuple):
    """The ``areas`` (c,) of cells, their ``errors`` (c,), and what of them is seen to
    lie ``outside`` the bounds (c,), all of one with a vertex there."""

    areas: np.ndarray
    errors: np.ndarray
    outside: np.ndarray

    def are_vague(self) -> np.ndarray:
        """Of which cells (c,) the area is not known well enough, nor that of all."""
        share = self.errors / max(self.areas.sum(), 1e-300)
        is_known = share.sum() <= WELL_KNOWN
        are_vague: np.ndarray = (share > WELL_KNOWN / max(len(share), 1)) & ~is_known
        return are_vague

    def with_part(self, others: Sizes, among: np.ndarray) -> Sizes:
        """These, but for the cells ``among`` (c,) which those of others are put."""
        columns = zip(others, self, strict=True)
        return Sizes(*(np.where(among, other, own) for other, own in columns))


def cell_sizes(
    problem: Problem,
    charts: FlatCharts,
    cells: Cells,
    metric: np.ndarray,
    rounds: int,
) -> Sizes:
    """The areas of the cells of ``charts``, lengths being taken after the unknowns are
    multiplied by ``metric`` (n,).

    The error of a cell whose edges do not fit those of its neighbours, with a vertex
    outside the bounds, or over which the surface is not followed everywhere, is its
    whole area; where one leaves the bounds a few times the area outside, as far as
    nodes show it, is added. Cells whose areas are not known well are measured with more
    nodes, in up to so many ``rounds``.
    """
    every = np.ones(len(charts.radii), dtype=bool)
    degree, along = RULES[0]
    sizes = _Measure(problem, charts, cells, metric, every, degree).sizes(along)
    for degree, along in RULES[1:rounds]:
        among = sizes.are_vague()
        if not np.any(among):
            break
        finer = _Measure(problem, charts, cells, metric, among, degree).sizes(along)
        sizes = sizes.with_part(finer, among)
    areas, errors, outside = sizes
    errors += ROUNDING * np.abs(areas)
    errors[cells.chart[cells.misfits()]] = np.inf
    is_outside = ~problem.domain.are_inside(cells.vertices)
    leaving = cells.chart[is_outside[cells.begin]]
    errors[leaving], outside[leaving] = np.inf, areas[leaving]
    return Sizes(areas, np.minimum(errors, np.abs(areas)), outside)


def _reaches(problem: Problem, charts: FlatCharts, cells: Cells) -> np.ndarray:
    """How far (c,) cells reach from the centres of their charts."""
    corners = cells.vertices[cells.begin]
    positions = Graphs(problem, charts, cells.chart).positions(corners)
    reaches = np.zeros(len(charts.radii))
    np.maximum.at(reaches, cells.chart, np.linalg.norm(positions, axis=1))
    return reaches


class _Measure:
    """The edges and sectors of the cells ``among`` (c,) all, each edge taken once: it is
    the curve above the plane of the first of all cells that have it. Polynomials of a
    ``degree`` stand for the surface."""

    def __init__(
        self,
        problem: Problem,
        charts: FlatCharts,
        cells: Cells,
        metric: np.ndarray,
        among: np.ndarray,
        degree: int,
    ):
        self._problem = problem
        self._charts = charts
        self._count = len(charts.radii)
        pairs, first, edge = np.unique(
            cells.pairs, axis=0, return_index=True, return_inverse=True
        )
        is_own = among[cells.chart]
        own, self._edge = np.unique(edge[is_own], return_inverse=True)
        self._cells = cells.part(is_own)
        self._pairs = pairs[own]
        self._chart, self._label = cells.chart[first[own]], cells.label[first[own]]
        numbers = np.union1d(self._cells.chart, self._chart)
        reaches = _reaches(problem, charts, cells)[numbers]
        self._patches = Patches(problem, charts, numbers, reaches, degree)
        self._row = np.searchsorted(numbers, self._cells.chart)
        self._row_of_curve = np.searchsorted(numbers, self._chart)
        self._ratios = self._patches.ratios(metric)

    def sizes(self, along: int) -> Sizes:
        """Areas, and errors by the quadrature and by what lies outside the bounds, with so
        many nodes ``along`` an edge."""
        nodes, weights = _gauss(along)
        places = np.concatenate([[0.0], nodes, [1.0]])
        curves, are_known = self._curves(nodes)
        outline = self._outlines(curves)
        rates = np.einsum("ij,ejk->eik", _differentiation(places), outline)
        turned = _cross(outline, rates)  # (e, along + 2)
        over_rays = self._patches.over_rays(self._row, outline, self._ratios.terms)
        sectors = turned * over_rays
        inside = turned[:, 1:-1] * weights
        outside = self._outside(outline[:, 1:-1], inside)
        off = 0.5 * self._ratios.errors[self._row] * np.abs(inside).sum(axis=1)
        off += _tails(sectors, places) + _errors_of_edges(outline, places)
        off[~are_known[self._edge]] = np.inf
        areas = self._sums((sectors[:, 1:-1] * weights).sum(axis=1))
        return Sizes(areas, self._sums(off) + BLURRED * outside, outside)

    def _outside(self, ends: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """What of the area of cells lies outside the bounds (c,), as places on rays to
        ``ends`` (e, r, 2) of a weight ``turned`` (e, r) show it."""
        some = np.flatnonzero(self._may_be_outside(turned))
        t, t_weights = _gauss(RAYS)
        flat = ends[some, :, None] * t[:, None]  # (e, r, t, 2)
        flat = flat.reshape(len(some), ends.shape[1] * RAYS, 2)
        points = self._patches.lifted(self._row[some], flat)
        is_inside = self._problem.domain.are_inside(points.reshape(-1, self._problem.n))
        ratios = self._patches.values(self._row[some], flat, self._ratios.terms)
        ratios[is_inside.reshape(ratios.shape)] = 0.0
        weights = (turned[some, :, None] * (t * t_weights)).reshape(ratios.shape)
        sums = np.zeros(len(turned))
        sums[some] = (ratios * weights).sum(axis=1)
        return self._sums(sums)

    def _may_be_outside(self, turned: np.ndarray) -> np.ndarray:
        """Which edges (e,) are those of cells next to bounds; none of cells that are
        differences of sectors, some of which are ``turned`` (e, r) backwards, as one beside
        a bound that bends."""
        is_back = (turned.min(axis=1) < 0.0).astype(float)
        is_bent = self._sums(is_back)[self._cells.chart] > 0.0
        bounds = self._problem.domain.bounds
        rooms = np.abs(bounds - self._patches.centers[:, :, None]).min(axis=(1, 2))
        is_next = (rooms < FAR * self._patches.radii)[self._row]
        may_be: np.ndarray = is_next & ~is_bent
        return may_be

    def _sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (c,) over each cell of values (e,) at its edges."""
        return np.bincount(self._cells.chart, values, minlength=self._count)

    def _curves(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (u, k, n) of all edges, from the vertex of the lower number on, and
        whether they are known (u,)."""
        begin, end = self._cells.vertices[self._pairs.T]
        chord = self._problem.domain.difference(end, begin)
        straight = begin[:, None] + nodes[:, None] * chord[:, None]
        charts = np.repeat(self._chart, len(nodes))
        graphs = Graphs(self._problem, self._charts, charts)
        positions = graphs.positions(straight.reshape(-1, self._problem.n))
        positions = positions.reshape(*straight.shape[:2], 2)
        points = self._patches.lifted(self._row_of_curve, positions)
        are_known = np.isfinite(self._patches.misfits[self._row_of_curve])
        border = np.flatnonzero(self._label <= BORDER)
        points[border], are_known[border] = self._on_bounds(border, positions[border])
        return points, are_known

    def _on_bounds(
        self, edges: np.ndarray, positions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Points (b, k, n) on the bounds along which ``edges`` (b,) run, next to positions
        (b, k, 2) in the planes of their charts, and whether all are there (b,)."""
        n, shape = self._problem.n, positions.shape[:2]
        charts, labels = np.repeat(
            [self._chart[edges], self._label[edges]], shape[1], 1
        )
        graphs = Graphs(self._problem, self._charts, charts)
        flat = positions.reshape(-1, 2)
        points, is_there = graphs.onto_bounds(flat, bounds_of(labels, n))
        are_there = np.all(is_there.reshape(shape), axis=1)
        return points.reshape(*shape, n), np.asarray(are_there)

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
        graphs = Graphs(self._problem, self._charts, np.repeat(cells.chart, count))
        return graphs.positions(points.reshape(-1, n)).reshape(-1, count, 2)


def _errors_of_edges(outline: np.ndarray, places: np.ndarray) -> np.ndarray:
    """How much area (e,) edges move from one cell to the next where the polynomials
    through their ``outline`` (e, k, 2) at ``places`` (k,) are off."""
    lengths: np.ndarray = np.linalg.norm(outline[:, -1] - outline[:, 0], axis=1)
    off = _tails(np.swapaxes(outline, 1, 2), places)
    errors: np.ndarray = lengths * np.linalg.norm(off, axis=1)
    return errors


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
