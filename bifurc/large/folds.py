"""Folds of a large problem, located by Newton's method with bordered systems alone."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.large.scaled_problem import ScaledProblem

STEPS = 12
SETTLED = 1e-9  # a step after which the next one, its square, would be rounding
STAGNANT = 0.5  # times the step before: a short step that is no shorter is rounding
SHORT = 1e-6


class LocatedFold(NamedTuple):
    """A fold at ``point`` (n,), the second derivative ``bend`` of the parameter in the
    arclength, the length of the ``last_step`` and what is left of F, the ``gap``."""

    point: np.ndarray
    bend: float
    last_step: float
    gap: float


def locate_fold(
    problem: ScaledProblem, start: np.ndarray, tangent: np.ndarray
) -> LocatedFold | None:
    """The fold near ``start`` (n,), a point with about the ``tangent`` (n,); None where
    the iteration does not settle.

    Solved are F = 0 and h = 0, h the parameter's component of the tangent. With the
    matrix M of F' and the row ``tangent`` under it

        M d = [-F; 0],  M t = [0; 1],  M t'(x) = [-F''(t, x); 0],

    the step is d + a t with h + h'(d) + a h'(t) = 0: four systems with one matrix, no
    transpose, and F' without the parameter's column may be singular, as it is at the
    fold.
    """
    point = start
    before = np.inf
    for _ in range(STEPS):
        step, bend = _step(problem, point, tangent)
        length = float(np.linalg.norm(step))
        if not length < 1.0:
            return None
        point = point + step
        is_rounding = length < SHORT and length > STAGNANT * before
        if length < SETTLED or is_rounding:
            gap = float(problem.gaps(point[None])[0])
            return LocatedFold(point, bend, length, gap)
        before = length
    return None


def _step(
    problem: ScaledProblem, point: np.ndarray, row: np.ndarray
) -> tuple[np.ndarray, float]:
    """The step (n,) to where the parameter turns back, and its second derivative."""
    system = problem.bordered(point, row[None])
    nothing = np.zeros(problem.n - 1)
    across = system.solve(np.append(-problem.relative_residuals(point[None])[0], 0.0))
    along = system.solve(np.append(nothing, 1.0))

    def change(direction: np.ndarray) -> float:
        curved = problem.second_derivative(point, direction, along)
        return float(system.solve(np.append(-curved, 0.0))[-1])

    slope = change(along)
    share = -(along[-1] + change(across)) / slope if slope else np.inf
    bend = slope / float(along @ along)
    return across + share * along, bend
