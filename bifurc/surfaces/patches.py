"""Graphs of a surface above the disks of charts as polynomials: a disk goes in, what
lies above any place in it comes out, without solving again.

The surface is followed from the centre along rays. Heights and slopes at some places of
each ray, the same for every disk but for its radius, give the polynomial of a degree
that is nearest to them.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from bifurc.numerics.binary_forms import unit_vectors
from bifurc.problem import Problem
from bifurc.surfaces.graphs import Graphs
from bifurc.surfaces.polygon import FlatCharts

# Places along each of degree + 1 rays, over the radius, for polynomials of a degree.
SHARES = {
    10: (0.5, 0.75, 1.0),
    14: (0.3, 0.6, 0.85, 1.0),
    18: (0.15, 0.4, 0.65, 0.83, 0.95, 1.0),
}
# Values that are known, over the coefficients, at least.
ENOUGH = 1.2


class Stencil(NamedTuple):
    """How a function on the unit disk is taken from its values and slopes.

    They are known at the ends of degree + 1 ``rays`` (r, 2) and at ``shares`` (s,) of
    them. ``powers`` (p, 2) are those of the terms of the polynomial, from the squares on.
    ``terms`` (3 r s, p) give the values, then the slopes by each coordinate, of a
    polynomial, and ``fit`` (p, 3 r s) the one that is nearest to such; ``beside`` (b, 3 r
    s) what no polynomial explains.
    """

    rays: np.ndarray
    shares: np.ndarray
    powers: np.ndarray
    terms: np.ndarray
    fit: np.ndarray
    beside: np.ndarray


@cache
def stencil_of(degree: int) -> Stencil:
    """The stencil for polynomials of a ``degree``."""
    rays = unit_vectors(2 * np.pi / (degree + 1) * np.arange(degree + 1))
    shares = np.array(SHARES[degree])
    powers = _powers(2, degree)
    places = _products(rays, shares)
    terms = np.concatenate([terms_at(places, powers), *slopes_at(places, powers)])
    left, sizes, right = np.linalg.svd(terms)
    count = len(powers)
    fit = (right.T / sizes) @ left[:, :count].T
    return Stencil(rays, shares, powers, terms, fit, left[:, count:].T)


class Rule(NamedTuple):
    """How a function of the slopes of such a polynomial is taken for another one, with
    ``powers`` (q, 2), of their degree.

    ``slopes`` (2, k, p) are those at some places, and ``through`` (q, k) takes values there
    to coefficients; ``orthogonal`` (q, q) takes these to those of polynomials that are
    orthogonal on the disk, each next one of the same degree or a higher one.
    """

    powers: np.ndarray
    slopes: np.ndarray
    through: np.ndarray
    orthogonal: np.ndarray


@cache
def rule_of(degree: int) -> Rule:
    """The rule for slopes of polynomials of a ``degree``: exact for products of two."""
    nodes, weights = np.polynomial.legendre.leggauss(degree // 2)
    angles = 2 * np.pi / (2 * degree - 1) * np.arange(2 * degree - 1)
    places = _products(unit_vectors(angles), np.sqrt(0.5 * (nodes + 1.0)))
    roots = np.tile(np.sqrt(0.5 * weights / len(angles)), len(angles))[:, None]
    powers = _powers(0, degree - 1)
    base, orthogonal = np.linalg.qr(roots * terms_at(places, powers))
    through = np.linalg.solve(orthogonal, (roots * base).T)
    slopes = slopes_at(places, _powers(2, degree))
    return Rule(powers, slopes, through, orthogonal)


def _products(directions: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Each of the directions (r, 2) times each of the lengths (s,): (r s, 2)."""
    products: np.ndarray = directions[:, None] * lengths[:, None]
    return products.reshape(-1, 2)


def _powers(lowest: int, highest: int) -> np.ndarray:
    """The powers (p, 2) of the terms of these degrees, in order."""
    rows = [(i, k - i) for k in range(lowest, highest + 1) for i in range(k + 1)]
    return np.array(rows)


def terms_at(places: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """The terms (..., p) of a polynomial with ``powers`` (p, 2) at places (..., 2)."""
    factors = np.ones((*places.shape, powers.max() + 1))
    factors[..., 1:] = places[..., None]
    x, y = np.moveaxis(np.multiply.accumulate(factors, axis=-1), -2, 0)
    terms: np.ndarray = x[..., powers[:, 0]] * y[..., powers[:, 1]]
    return terms


def slopes_at(places: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """Their derivatives (2, ..., p) by both coordinates."""
    slopes = []
    for lower in np.eye(2, dtype=int):
        remaining = np.maximum(powers - lower, 0)
        slopes.append(powers @ lower * terms_at(places, remaining))
    return np.stack(slopes)


class Ratios(NamedTuple):
    """Ratios of areas as ``terms`` (k, q) of polynomials, and how far off they may be,
    ``errors`` (k,), by what comes after them and by misfits."""

    terms: np.ndarray
    errors: np.ndarray


class Patches:
    """Graphs above disks with ``radii`` (k,) about the centres of the ``charts`` with the
    numbers (k,), as polynomials of a ``degree`` in the position over the radius.

    ``heights`` (k, p, n) are the coefficients of the graphs above their planes, over the
    radius, ``misfits`` (k,) how far, as a slope, they are off what is known of the
    surface: infinite where too little is.
    """

    def __init__(
        self,
        problem: Problem,
        charts: FlatCharts,
        numbers: np.ndarray,
        radii: np.ndarray,
        degree: int,
    ):
        self.stencil, self._rule = stencil_of(degree), rule_of(degree)
        self.centers = charts.centers[numbers]
        self.planes = charts.bases[numbers]
        self.radii = radii
        values, is_there = self._values(problem, charts, numbers)
        self.heights: np.ndarray = self.stencil.fit @ values
        beside = self.stencil.beside @ values
        self.misfits = np.linalg.norm(beside, axis=(1, 2)) / np.sqrt(values.shape[1])
        for k in np.flatnonzero(~is_there.all(axis=1)).tolist():
            self._fit_some(k, values[k], np.tile(is_there[k], 3))

    def _fit_some(self, k: int, values: np.ndarray, are_known: np.ndarray) -> None:
        """The polynomials of patch k where not all values (v, n) are known (v,)."""
        terms, known = self.stencil.terms[are_known], values[are_known]
        if len(terms) < ENOUGH * terms.shape[1]:
            self.heights[k], self.misfits[k] = 0.0, np.inf
            return
        self.heights[k] = np.linalg.lstsq(terms, known)[0]
        self.misfits[k] = np.abs(terms @ self.heights[k] - known).max()

    def _values(
        self, problem: Problem, charts: FlatCharts, numbers: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Heights and slopes (k, 3 r s, n) at the places of the stencil, and whether the
        surface is there (k, r s)."""
        rays, shares = self.stencil.rays, self.stencil.shares
        each = np.repeat(np.arange(len(numbers)), len(rays))
        ends = (self.radii[:, None, None] * rays).reshape(-1, 2)
        points, is_there = Graphs(problem, charts, numbers[each]).along(ends, shares)
        each = np.repeat(each, len(shares))
        graphs = Graphs(problem, charts, numbers[each])
        points = points.reshape(-1, problem.n)
        slopes = graphs.slopes(points)
        heights = graphs.heights(_products(ends, shares), points, slopes)
        slopes -= self.planes[each]
        heights /= self.radii[each, None]
        columns = np.stack([heights, slopes[:, :, 0], slopes[:, :, 1]])
        shape = len(numbers), len(rays) * len(shares)
        values = np.concatenate(columns.reshape(3, *shape, problem.n), axis=1)
        return values, is_there.reshape(shape)

    def lifted(self, rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
        """Points (k, s, n) of the graphs in these ``rows`` (k,) above positions (k, s,
        2)."""
        radii = self.radii[rows, None, None]
        terms = terms_at(positions / radii, self.stencil.powers)
        flat = positions @ np.swapaxes(self.planes[rows], 1, 2)
        lifted: np.ndarray = self.centers[rows, None] + flat
        lifted += radii * (terms @ self.heights[rows])
        return lifted

    def values(
        self, rows: np.ndarray, positions: np.ndarray, terms: np.ndarray
    ) -> np.ndarray:
        """Values (k, s) at positions (k, s, 2) in the planes of these ``rows`` (k,), of
        polynomials that all patches have (p, q)."""
        places = positions / self.radii[rows, None, None]
        at_places = terms_at(places, self._rule.powers)
        values: np.ndarray = np.einsum("ksq,kq->ks", at_places, terms[rows])
        return values

    def over_rays(
        self, rows: np.ndarray, ends: np.ndarray, terms: np.ndarray
    ) -> np.ndarray:
        """The same integrated over rays from the centre to ``ends`` (k, s, 2), of which a
        share t has the weight t."""
        degrees = self._rule.powers.sum(axis=1)
        return self.values(rows, ends, terms / (2.0 + degrees))

    def ratios(self, metric: np.ndarray) -> Ratios:
        """Areas on the graphs over those in the planes, lengths being taken after the
        unknowns are multiplied by ``metric`` (n,)."""
        one, other = (
            (self.planes[:, None, :, side] + slopes @ self.heights) * metric
            for side, slopes in enumerate(self._rule.slopes)
        )
        squares = (one**2).sum(axis=2) * (other**2).sum(axis=2)
        values = np.sqrt(np.maximum(squares - (one * other).sum(axis=2) ** 2, 0.0))
        terms = values @ self._rule.through.T
        stretch = values.max(axis=1) / self._least_stretch(metric)
        with np.errstate(invalid="ignore"):
            return Ratios(terms, self._tails(terms) + stretch * self.misfits)

    def _tails(self, terms: np.ndarray) -> np.ndarray:
        """What comes after polynomials (k, q) on the disk (k,), if the coefficients of
        orthogonal ones go on to shrink as those of the last six degrees do, two and two;
        none of these may be small by chance."""
        squares = (terms @ self._rule.orthogonal.T) ** 2
        degrees = self._rule.powers.sum(axis=1)
        pair = (degrees[-1] - degrees) // 2
        last, before, earlier = (
            np.sqrt(squares[:, pair == number].sum(axis=1)) + 1e-300
            for number in range(3)
        )
        rate = np.minimum(np.maximum(last / before, before / earlier), 1.0)
        tails: np.ndarray = np.maximum(last, rate * before) * rate
        return tails

    def _least_stretch(self, metric: np.ndarray) -> np.ndarray:
        """By how much the metric (n,) lengthens vectors of the planes, at least (k,)."""
        planes = self.planes * metric[:, None]
        squares = np.linalg.eigvalsh(np.swapaxes(planes, 1, 2) @ planes)[:, 0]
        least: np.ndarray = np.sqrt(np.maximum(squares, 1e-300))
        return least
