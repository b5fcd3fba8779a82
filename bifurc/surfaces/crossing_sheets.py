"""Where another sheet of solutions crosses a surface that charts cover.

Charts pass over a curve in which another sheet crosses: the tangent plane is smooth
there. One regular singular value passes through zero and changes its sign, if signs are
followed from chart to chart. That happens between the charts wherever these lie, while
a chart that happens to fail beside the curve depends on the place of all others.
"""

from __future__ import annotations

import numpy as np

from bifurc.numerics.null_spaces import NULL
from bifurc.problem import Problem
from bifurc.singular.locate import locate_singular_point
from bifurc.surfaces.chart_atlas import ChartAtlas

__all__ = ["has_uncovered_crossing", "is_on_singular_curve"]

CLEAR = 0.3  # determinant of the turn between two spaces above which its sign counts
BESIDE = 1.5  # distance from a chart, over its radius, in which it covers a crossing
LOOKS = 6  # pairs of charts between which a crossing is looked for
NEXT = 0.02  # distance, over the scale, at which other singular points are looked for


def has_uncovered_crossing(problem: Problem, charts: ChartAtlas, agree: float) -> bool:
    """Whether a sheet crosses the covered surface, and no chart lies on it.

    Charts whose tangent planes turn by a cosine below ``agree`` lie on different
    sheets.
    """
    pairs, places = _sign_changes(problem, charts)
    uncovered = [
        (pair, place)
        for pair, place in zip(pairs, places, strict=True)
        if not _is_covered(charts, int(pair[0]), place, agree)
    ]
    spread = np.unique(np.linspace(0, len(uncovered) - 1, LOOKS).astype(int))
    for k in spread[: len(uncovered)]:
        pair, place = uncovered[k]
        reach = 2.0 * float(charts.radii[pair].max())
        located = locate_singular_point(problem, place, 3, reach)
        if located is not None and is_on_singular_curve(problem, *located):
            return True
    return False


def _sign_changes(
    problem: Problem, charts: ChartAtlas
) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours (k, 2) between which F' changes its orientation, and places (k, n)
    there.

    With F' = L S R^T of rank n - 2 at two charts, the determinant of F' at the second
    one, in the bases L and R of the first, has the sign of det(L1^T L2) det(R1^T R2).
    """
    rank = problem.n - 2
    left, sigma, right = np.linalg.svd(
        problem.jacobians(charts.centers), full_matrices=False
    )
    i, j = charts.neighbours.T
    if rank < 1 or sigma.shape[1] < rank or not len(i):
        return np.empty((0, 2), dtype=int), np.empty((0, problem.n))
    left, right = left[:, :, :rank], right[:, :rank]
    smallest = sigma[:, rank - 1]
    across = np.linalg.det(np.swapaxes(left[i], 1, 2) @ left[j])
    normal = np.linalg.det(right[i] @ np.swapaxes(right[j], 1, 2))
    clear = (np.abs(across) > CLEAR) & (np.abs(normal) > CLEAR)
    regular = np.minimum(smallest[i], smallest[j]) > NULL * problem.magnitude
    changes = np.flatnonzero(clear & regular & (across * normal < 0))
    i, j = i[changes], j[changes]
    share = smallest[i] / (smallest[i] + smallest[j])
    step = problem.difference(charts.centers[j], charts.centers[i])
    return charts.neighbours[changes], charts.centers[i] + share[:, None] * step


def _is_covered(
    charts: ChartAtlas, chart: int, place: np.ndarray, agree: float
) -> bool:
    """Whether a chart on another sheet than ``chart`` lies about a ``place`` (n,)."""
    distance = np.linalg.norm(charts.apart(charts.centers, place), axis=1)
    near = np.flatnonzero(distance < BESIDE * charts.radii)
    turned = np.swapaxes(charts.bases[near], 1, 2) @ charts.bases[chart]
    cosines = np.linalg.svd(turned, compute_uv=False)[:, -1]
    return bool(np.any(cosines < agree))


def is_on_singular_curve(
    problem: Problem, point: np.ndarray, null_space: np.ndarray, error: float
) -> bool:
    """Whether other singular points of the same kind are near one (n,).

    They are looked for from starts to all sides in its ``null_space`` (n, k); ``error``
    is that of its place.
    """
    away = NEXT * problem.scale + 100 * error
    for start in point + away * np.concatenate([null_space.T, -null_space.T]):
        other = locate_singular_point(problem, start, null_space.shape[1], 2.0 * away)
        if other is None:
            continue
        gap = np.linalg.norm(problem.difference(other[0], point))
        if gap > 0.2 * away + 10 * other[2]:
            return True
    return False
