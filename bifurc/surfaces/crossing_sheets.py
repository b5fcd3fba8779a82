"""Where another sheet of solutions crosses a surface that charts cover.

Charts pass over a curve in which another sheet crosses: the tangent plane is smooth
there. One regular singular value passes through zero and changes its sign, if signs are
followed from chart to chart. That happens between the charts wherever these lie, while
a chart that happens to fail next to the curve depends on the place of all others.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_null
from bifurc.numerics.null_spaces import cosines_between_planes
from bifurc.numerics.singular_values import factors_of
from bifurc.problem import Problem
from bifurc.singular.locate import LocatedPoint, locate_singular_point
from bifurc.surfaces.chart_atlas import ChartAtlas

# Determinant of the turn between two spaces above which its sign counts.
CLEAR = 0.3
# Distance from a chart, over its radius, in which it covers a crossing, and in which
# charts of one sheet are neighbours of one another.
NEAR_CHART, ONE_SHEET = 1.5, 4.0
# Height of a crossing above the plane of a chart that covers it, over the radius.
LOW = 0.3
# Pairs of charts between which a crossing is looked for, and how far from the place,
# over the larger radius.
LOOKS, REACH = 6, 2.0
# Distances, over the scale, and that over the error, at which other singular points are
# looked for.
NEXT, NEXT_TO_ERROR = (0.02, 1e-3, 5e-5), 100
# Distance, over that and over the error, from which another singular point counts.
OTHER, OTHER_TO_ERROR = 0.2, 10


def has_uncovered_crossing(problem: Problem, charts: ChartAtlas, agree: float) -> bool:
    """Whether a sheet crosses the covered surface, and no chart lies on it.

    Charts whose tangent planes turn by a cosine below ``agree`` lie on different
    sheets.
    """
    uncovered, nullity = [], charts.dimension + 1
    for crossing in sign_changes(problem, charts):
        if not _is_covered(charts, crossing, agree):
            uncovered.append(crossing)
    spread = np.unique(np.linspace(0, len(uncovered) - 1, LOOKS).astype(int))
    for k in spread[: len(uncovered)]:
        crossing = uncovered[k]
        reach = REACH * float(charts.radii[crossing.pair].max())
        located = locate_singular_point(problem, crossing.place, nullity, reach)
        if located is not None and is_on_singular_curve(problem, located):
            return True
    return False


def is_on_singular_curve(problem: Problem, located: LocatedPoint) -> bool:
    """Whether other singular points of the same kind are near one: on a curve of them,
    which may be as small as the smallest distance at which they are looked for."""
    if located.is_isolated:
        return False
    steps = problem.domain.scale * np.array(NEXT) + NEXT_TO_ERROR * located.error
    return any(_has_another_beside(problem, located, step) for step in steps.tolist())


def _has_another_beside(
    problem: Problem, located: LocatedPoint, distance: float
) -> bool:
    """Whether starts at a ``distance`` to all sides of a singular point, in its null
    space, lead to others."""
    u, null_space = located.u, located.null_space
    nullity = null_space.shape[1]
    for direction in np.concatenate([null_space.T, -null_space.T]):
        start = u + distance * direction
        other = locate_singular_point(problem, start, nullity, 2.0 * distance)
        if other is None:
            continue
        gap = np.linalg.norm(problem.domain.difference(other.u, u))
        if gap > OTHER * distance + OTHER_TO_ERROR * other.error:
            return True
    return False


class SignChange(NamedTuple):
    """Numbers of a ``pair`` (2,) of neighbours between which F' changes its
    orientation, and a ``place`` (n,) there."""

    pair: np.ndarray
    place: np.ndarray


def sign_changes(problem: Problem, charts: ChartAtlas) -> list[SignChange]:
    """All neighbours between which F' changes its orientation.

    With F' = L S R^T of rank n - d at two charts, the determinant of F' at the second
    one, in the bases L and R of the first, has the sign of det(L1^T L2) det(R1^T R2).
    """
    rank = problem.n - charts.dimension
    jacobians = problem.jacobians(charts.centers)
    left, sigma, right = factors_of(jacobians, full_matrices=False)
    if rank < 1 or sigma.shape[1] < rank:
        return []
    left, right = left[:, :, :rank], right[:, :rank]
    smallest = sigma[:, rank - 1]
    i, j = charts.neighbours.T
    across = np.linalg.det(np.swapaxes(left[i], 1, 2) @ left[j])
    normal = np.linalg.det(right[i] @ np.swapaxes(right[j], 1, 2))
    is_clear = (np.abs(across) > CLEAR) & (np.abs(normal) > CLEAR)
    lower = np.minimum(smallest[i], smallest[j])
    is_regular = ~is_null(lower, problem.magnitude)
    changes = is_clear & is_regular & (across * normal < 0)
    crossings = []
    for pair in charts.neighbours[changes]:
        # where the singular value is zero, if it falls and rises in straight lines
        first, last = pair
        share = smallest[first] / (smallest[first] + smallest[last])
        step = problem.domain.difference(charts.centers[last], charts.centers[first])
        crossings.append(SignChange(pair, charts.centers[first] + share * step))
    return crossings


def _is_covered(charts: ChartAtlas, crossing: SignChange, agree: float) -> bool:
    """Whether a chart on another sheet lies about a crossing: it is turned, or no
    neighbours lead to it from those between which the crossing is."""
    gaps = charts.difference(crossing.place, charts.centers)
    distances = np.linalg.norm(gaps, axis=1)
    near = np.flatnonzero(distances < NEAR_CHART * charts.radii)
    cosines = cosines_between_planes(charts.bases[near], charts.bases[crossing.pair[0]])
    if np.any(cosines[:, -1] < agree):
        return True
    along = np.einsum("kij,ki->kj", charts.bases[near], gaps[near])
    squares = distances[near] ** 2 - np.einsum("kj,kj->k", along, along)
    are_low = squares < (LOW * charts.radii[near]) ** 2
    others = set(near[are_low].tolist()) - charts.joined_to(
        int(crossing.pair[0]), distances < ONE_SHEET * charts.radii
    )
    return bool(others)
