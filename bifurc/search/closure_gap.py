"""How nearly a system is solved that has no curve of solutions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bifurc.limits import Deadline
from bifurc.numerics.singular_values import factors_of
from bifurc.problem import Problem
from bifurc.seeds import Seeds

STEPS = 12
LONGEST = 0.5  # step, over the problem's scale
# Singular value, over the largest, below which no step is taken along its direction.
FLAT = 1e-6
WORK_AT_ONCE = 1e6  # points between two looks at the clock, times n^3
TINY = 1e-300  # keeps a step of length zero from being divided by its length


def closure_gap(
    problem: Problem, seeds: Seeds, gaps: Sequence[float], deadline: Deadline
) -> float:
    """Median residual, over the magnitude, along the valley in which the system is
    nearly solved; 0 where every start solves it.

    It is taken over the random starts that missed, as many as there is time for before
    the ``deadline``, a few in any case, and over the ``gaps`` of starts that could not be
    corrected.
    """
    residuals = seeds.gaps
    if len(seeds.missed):
        lowest = valley_points(problem, seeds.missed, deadline)
        residuals = np.maximum(problem.gaps(lowest), seeds.gaps[: len(lowest)])
    everywhere = np.concatenate([residuals, gaps])
    return float(np.median(everywhere)) if len(everywhere) else 0.0


def valley_points(
    problem: Problem, points: np.ndarray, deadline: Deadline
) -> np.ndarray:
    """Points (k, n) in the valley below the first of points (j, n) that do not solve
    the system, as many as there is time for before the ``deadline``, a few in any case.

    Gauss-Newton steps of rank n - 1 run down to the valley in which the system is
    nearly solved but not along it, so that an isolated solution at its end does not
    hide the gap.
    """
    at_once = max(1, int(WORK_AT_ONCE / problem.n**3))
    lowest = []
    for begin in range(0, len(points), at_once):
        lowest.append(_in_valley(problem, points[begin : begin + at_once]))
        if deadline.passed:
            break
    return np.concatenate(lowest) if lowest else points


def _in_valley(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Points (k, n) in the valley below points (k, n)."""
    lowest = points.copy()
    longest = LONGEST * problem.scale
    for _ in range(STEPS):
        steps = _steps_across(problem, lowest)
        lengths = np.linalg.norm(steps, axis=1) + TINY
        shares = np.minimum(1.0, longest / lengths)
        lowest -= steps * shares[:, None]
    return lowest


def _steps_across(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Gauss-Newton steps (k, n) of rank n - 1, to be subtracted."""
    across = problem.n - 1
    residuals = problem.relative_residuals(points)
    jacobians = problem.relative_jacobians(points)
    left, sigma, right = factors_of(jacobians, full_matrices=False)
    is_steep = sigma > FLAT * sigma[:, :1]
    is_steep[:, across:] = False
    inverse = np.zeros_like(sigma)
    inverse[is_steep] = 1.0 / sigma[is_steep]
    components = np.einsum("kmj,km->kj", left, residuals)
    steps: np.ndarray = np.einsum("kji,kj->ki", right, inverse * components)
    return steps
