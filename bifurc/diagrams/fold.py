"""A fold as the regular solution of a system of its own.

The point u and the tangent v solve F(u) = 0, F'(u) v = 0, v_p = 0, t . v = 1 with the
tangent t nearby (Moore and Spence 1980), whatever the pieces of a curve are off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.curves.deflation import WithNullVector
from bifurc.problem import Problem

STEPS = (
    60  # at a fold of higher order a step is no shorter than a part of the one before
)
SETTLED = 1e-15  # of the sizes of the unknowns: a step after which none follows
FARTHEST = 0.1  # of the sizes: a longer step leads elsewhere
RANK = 1e-14  # of singular values, over the largest: what is smaller is rounding


class Fold(NamedTuple):
    """A fold at ``u`` (n,), and the second derivative of the parameter in the arclength
    (``bend``) there."""

    u: np.ndarray
    bend: float


def refined_fold(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    parameter: int,
    sizes: np.ndarray,
) -> Fold | None:
    """The fold next to ``start`` (n,), where a curve has a ``tangent`` (n,); None where
    Newton's method leads away, and for many unknowns.

    ``parameter`` is the index of the unknown that turns back, ``sizes`` (n,) are those
    of the unknowns.
    """
    if problem.is_large:
        return None
    n = problem.n
    across = tangent / sizes
    length = float(np.linalg.norm(across))
    system = WithNullVector(problem, across / sizes / length**2, np.eye(n)[parameter])
    units = np.concatenate([sizes, length * sizes])
    point = np.concatenate([start, tangent])
    for _ in range(STEPS):
        right = -system.residuals(point[None])[0]
        step = _scaled_least_squares(system.jacobians(point[None])[0], right, units)
        if step is None or np.abs(step).max() > FARTHEST:
            return None
        point = point + units * step
        if np.abs(step[:n]).max() <= SETTLED:
            break
    u, v = np.split(point, 2)
    return Fold(u, _bend(problem, u, v, parameter))


def _scaled_least_squares(
    matrix: np.ndarray, right: np.ndarray, units: np.ndarray
) -> np.ndarray | None:
    """The solution (n,) of a system in ``units`` (n,) of its unknowns, all equations
    weighted alike; None where it is not finite."""
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        return None
    scaled = matrix * units
    weights = np.linalg.norm(scaled, axis=1)
    weights[weights == 0.0] = 1.0
    step: np.ndarray = np.linalg.lstsq(
        scaled / weights[:, None], right / weights, rcond=RANK
    )[0]
    return step


def _bend(
    problem: Problem, u: np.ndarray, tangent: np.ndarray, parameter: int
) -> float:
    """The second derivative of the parameter in the arclength: F' u'' = - F'' t t, u''
    across the unit tangent t."""
    t = tangent / np.linalg.norm(tangent)
    system = np.vstack([problem.jacobians(u[None])[0], t])
    right = np.einsum("mij,i,j->m", problem.hessian(u), t, t)
    bend = np.linalg.lstsq(system, np.append(-right, 0.0), rcond=RANK)[0]
    return float(bend[parameter])
