"""How well a point of a curve is known, and how far a singular point is from it.

F is known to rounding. Across a curve it grows in proportion to the distance, most
slowly along the weakest regular direction: rounding over the smallest regular singular
value is the distance to which a point of the curve is known. Beside a surface that is
no solution but nearly one, that value is small all along the curve; beside a singular
point it is small because it vanishes there.
"""

from __future__ import annotations

import numpy as np

from bifurc.numerics.null_spaces import decompose
from bifurc.problem import Problem

__all__ = [
    "ROUNDING",
    "blur",
    "distance_to_singular",
    "rounding_unit",
    "same_reach",
    "smallest_regular",
]

ROUNDING = 1e-15  # of F, over the magnitude, where F is evaluated with care
PROBE = 1e-12  # step, over the scale, after which F differs by its slope and rounding
NOTHING = 1e-11  # singular value below which F says nothing of a direction
# Times the blur: two points of one curve are no farther apart.
ALIKE = 20.0
TINY = 1e-300  # keeps a rate of zero from being divided by


def rounding_unit(problem: Problem, points: np.ndarray) -> float:
    """How many times larger than `ROUNDING` the rounding of F is at points (k, n), 1 at
    least.

    F is evaluated beside the points: what its slope does not explain is rounding.
    """
    if not len(points):
        return 1.0
    rng = np.random.default_rng(0)
    steps = PROBE * problem.scale * rng.normal(size=points.shape)
    change = problem.relative_residuals(points + steps)
    change -= problem.relative_residuals(points)
    jacobians = problem.relative_jacobians(points)
    expected = np.einsum("kmn,kn->km", jacobians, steps)
    rounding = np.linalg.norm(change - expected, axis=1).max()
    return max(1.0, float(rounding) / ROUNDING)


def smallest_regular(problem: Problem, points: np.ndarray) -> np.ndarray:
    """The smallest regular singular value (k,) of F', over the magnitude, at points
    (k, n) of curves: number n - 1."""
    if not len(points):
        return np.empty(0)
    values = np.linalg.svd(problem.relative_jacobians(points), compute_uv=False)
    number = problem.n - 2
    if not 0 <= number < values.shape[1]:
        return np.full(len(points), np.inf if number < 0 else 0.0)
    smallest: np.ndarray = values[:, number]
    return smallest


def blur(sigma: np.ndarray | float) -> np.ndarray:
    """The distance, over the scale, to which points of a curve are known whose smallest
    regular singular value is ``sigma`` (k,); 0 where F says nothing of a direction."""
    values = np.asarray(sigma, dtype=float)
    distances: np.ndarray = ROUNDING / np.maximum(values, NOTHING)
    return np.where(values > NOTHING, distances, 0.0)


def same_reach(sigma: np.ndarray | float) -> np.ndarray:
    """How far apart, over the scale, two points of one curve may be found for rounding
    alone, where its smallest regular singular value is ``sigma`` (k,)."""
    return ALIKE * blur(sigma)


def distance_to_singular(
    problem: Problem, point: np.ndarray, nullity: int = 2
) -> float:
    """The distance, over the scale, at which a singular point of a ``nullity`` would
    lie from a solution (n,), to first order.

    V are as many weakest directions and W what the other ones leave of the equations:
    on V the largest of those singular values changes at the rate |W^T F''(V, V)|. On a
    surface both vanish, and beside one both are small: it is their quotient that tells.
    """
    weakest = problem.n - nullity
    decomposition = decompose(problem, point[None])
    if decomposition.sigma.shape[1] <= weakest:
        return 0.0
    sigma = float(decomposition.sigma[0, weakest])
    left = decomposition.left[0, :, weakest:]
    right = decomposition.right[0, weakest:]
    hessian = problem.hessian(point) / problem.magnitude
    reduced = np.einsum("mw,mij,ai,bj->wab", left, hessian, right, right)
    rate = float(np.linalg.norm(reduced)) * problem.scale
    return sigma / (rate + TINY)
