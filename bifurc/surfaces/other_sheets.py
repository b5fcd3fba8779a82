"""Solutions on other sheets of a surface, looked for from the charts of one.

Where another sheet is near, F' is weak in one direction across the surface. Along it the
equations, combined as the left singular vector says, are taken to be a cubic polynomial:
its other roots lie next to the next two sheets.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.numerics.corrector import normal_corrections
from bifurc.numerics.singular_values import factors_of
from bifurc.problem import Problem
from bifurc.surfaces.sheet import SOLVED
from bifurc.system import relative_jacobians, relative_residuals

# Distance, over the radius, at which values are taken, and up to which sheets are
# looked for.
PROBE, FARTHEST = 0.05, 1.0
# Distance of a solution from the centre, over that of where it was looked for, at least.
AWAY = 0.5


class OtherSheets(NamedTuple):
    """Solutions ``points`` (k, n) on sheets at ``distances`` (k,) from another one."""

    points: np.ndarray
    distances: np.ndarray


def solutions_across(
    problem: Problem, centers: np.ndarray, bases: np.ndarray, radii: np.ndarray
) -> OtherSheets:
    """Solutions straight above or below the ``centers`` (c, n) of charts with tangent
    planes ``bases`` (c, n, d) and ``radii`` (c,)."""
    weakest = problem.n - bases.shape[-1] - 1
    if weakest < 0 or not len(centers):
        return OtherSheets(np.empty((0, problem.n)), np.empty(0))
    normals, distances = _places_across(problem, centers, radii, weakest)
    chart, which = np.nonzero(np.abs(distances) < FARTHEST * radii[:, None])
    aside = distances[chart, which][:, None] * normals[chart]
    corrected = normal_corrections(problem, centers[chart] + aside, bases[chart])
    is_solved = corrected.is_settled & (corrected.gaps < SOLVED)
    offset = problem.domain.difference(corrected.points, centers[chart])
    reached = np.linalg.norm(offset, axis=1)
    is_away = reached > AWAY * np.linalg.norm(aside, axis=1)
    is_other = is_solved & is_away & problem.domain.are_inside(corrected.points)
    return OtherSheets(corrected.points[is_other], reached[is_other])


def _places_across(
    problem: Problem, centers: np.ndarray, radii: np.ndarray, weakest: int
) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (c, n) across the surface along which F' is the weakest, the right
    singular vectors of number ``weakest``, and how far along them the next two sheets
    may be (c, 2), infinite where there is none."""
    left, sigma, right = factors_of(relative_jacobians(problem, centers))
    normals, weights = right[:, weakest], left[:, :, weakest]
    width = PROBE * radii
    step = width[:, None] * normals
    above = relative_residuals(problem, centers + step)
    below = relative_residuals(problem, centers - step)
    # slope + bend t + twist t^2 = 0 at the other roots t, in units of the width
    slope = sigma[:, weakest] * width
    bend = 0.5 * np.einsum("cm,cm->c", weights, above + below)
    twist = 0.5 * np.einsum("cm,cm->c", weights, above - below) - slope
    return normals, width[:, None] * _roots(slope, bend, twist)


def _roots(slope: np.ndarray, bend: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """Real roots (k, 2) of slope + bend t + twist t^2, infinite where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        half = -0.5 * (bend + np.copysign(np.sqrt(bend**2 - 4 * slope * twist), bend))
        roots = np.stack([slope / half, half / twist], axis=1)
    roots[~np.isfinite(roots)] = np.inf
    return roots
