"""An order of branches and points that comes from themselves: seeds and last bits do
not change it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.atlas import Surface
from bifurc.branch import Branch
from bifurc.decisions import is_tied
from bifurc.problem import Problem
from bifurc.torus import wrap

OF_CHARTS = 0.1  # what the layout of charts makes of a mean, and a share of the area
COARSEST = 0.1  # what a large error adds to it at most
# The rule of Gauss and Legendre on every piece, for means along a branch.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


def order_branches(problem: Problem, branches: Sequence[Branch]) -> np.ndarray:
    """Numbers (k,) of branches, the longest first.

    Those of equal length, as mirror images are, stand in the order of the means of
    their cosines and then of their sines along the curve, the largest first; then of
    the means of the products of two of these, and of the winding numbers. Where a
    branch begins and which way it runs makes no difference.
    """
    if len(branches) < 2:
        return np.arange(len(branches))
    features = [_branch_features(branch, problem.domain.scale) for branch in branches]
    return order_rows(-np.array(features), is_tied.threshold)


def order_surfaces(problem: Problem, surfaces: Sequence[Surface]) -> np.ndarray:
    """Numbers (k,) of surfaces by dimension, those with charts first, the largest of
    these first.

    Those of about equal area, as mirror images are, stand in the order of the means of
    their cosines and then of their sines, the largest first. Charts are laid out anew
    with every seed: what differs by less than they do is equal.
    """
    if len(surfaces) < 2:
        return np.arange(len(surfaces))
    features = [
        _surface_features(surface, problem.domain.scale) for surface in surfaces
    ]
    return order_rows(np.array(features), OF_CHARTS)


def order_points(
    points: np.ndarray,
    periods: np.ndarray,
    scale: float,
    error: float = 0.0,
    groups: np.ndarray | None = None,
) -> np.ndarray:
    """Numbers (p,) of points (p, n) by their first unknown, then by the second, and so
    on.

    ``error`` is the largest distance of one of them to the exact point. Where there are
    ``groups`` (p,), their numbers come before the unknowns.
    """
    if len(points) < 2:
        return np.arange(len(points))
    # of two rows that differ by less in one column the next one decides
    tolerance = is_tied.threshold + min(2 * error / scale, COARSEST)
    places = wrap(points, periods, within=tolerance) / scale
    return order_rows(places, tolerance, groups)


def order_values(values: np.ndarray, tolerance: float) -> np.ndarray:
    """Numbers (k,) of values (k,), smallest first. Those between which no step is
    larger than ``tolerance`` keep their order."""
    return order_rows(values[:, None], tolerance)


def order_rows(
    features: np.ndarray, tolerance: float, groups: np.ndarray | None = None
) -> np.ndarray:
    """Numbers (k,) of rows (k, q) in lexicographic order, smallest first, one group
    after another.

    Of rows that differ in a column by no step larger than ``tolerance`` the next column
    decides; rows alike in all columns keep their order.
    """
    count = len(features)
    ranks = np.zeros(count, dtype=int) if groups is None else groups
    if not count:
        return ranks
    for values in features.T:
        ranks = _finer_ranks(ranks, values, tolerance)
        if ranks.max() == count - 1:
            break  # no two rows are alike any more
    return np.argsort(ranks, kind="stable")


def _finer_ranks(ranks: np.ndarray, values: np.ndarray, tolerance: float) -> np.ndarray:
    """Ranks (k,) by former ranks (k,) and then by values (k,).

    Of one former rank the sorted values are cut at the steps larger than ``tolerance``,
    and what stands between two cuts is alike.
    """
    ascending = np.lexsort((values, ranks))
    is_step = ~is_tied(np.diff(values[ascending]), tolerance / is_tied.threshold)
    is_step |= np.diff(ranks[ascending]) > 0
    finer = np.zeros(len(ranks), dtype=int)
    finer[ascending[1:]] = np.cumsum(is_step)
    return finer


def _branch_features(branch: Branch, scale: float) -> np.ndarray:
    """Numbers (q,) that tell branches apart: length, means, means of products, winding
    numbers up to their common sign."""
    half = 0.5 * np.diff(branch.breaks)[:, None]
    arclengths = (branch.breaks[:-1, None] + half + half * NODES).ravel()
    weights = (half * WEIGHTS / branch.length).ravel()
    points = _embedded(branch(arclengths), branch.periods, scale)
    means = weights @ points
    products = points.T @ (weights[:, None] * points)
    length = [branch.length / scale]
    upper = products[np.triu_indices(len(means))]
    turning = branch.winding[branch.winding != 0]
    sign = np.sign(turning[0]) if len(turning) else 1
    return np.concatenate([length, means, upper, sign * branch.winding])


def _surface_features(surface: Surface, scale: float) -> np.ndarray:
    """Numbers (q,) that tell surfaces apart, in ascending order: dimension, whether
    there are no charts, size and means."""
    charts = surface.charts
    kind = [float(surface.dimension), float(charts is None)]
    n = surface.samples.shape[1]
    if charts is None or not len(charts):
        return np.concatenate([kind, np.zeros(1 + 2 * n)])
    middles, sizes = charts.centers, charts.radii**charts.dimension
    if charts.is_measured:
        middles, sizes = charts.triangles.mean(axis=1), charts.triangle_areas
    means = (sizes / sizes.sum()) @ _embedded(middles, charts.periods, scale)
    size = [-np.log(charts.area if charts.is_measured else sizes.sum())]
    return np.concatenate([kind, size, -means])


def _embedded(points: np.ndarray, periods: np.ndarray, scale: float) -> np.ndarray:
    """Points (k, n) as (k, 2 n): cosines and then sines of the unknowns with a period,
    the others over the scale and then 0."""
    is_periodic = np.isfinite(periods)
    angles = points[:, is_periodic] * (2 * np.pi / periods[is_periodic])
    first = points / scale
    first[:, is_periodic] = np.cos(angles)
    second = np.zeros_like(points)
    second[:, is_periodic] = np.sin(angles)
    return np.concatenate([first, second], axis=1)
