"""A fold as the regular solution of a system of its own.

The point u and the tangent v solve F(u) = 0, F'(u) v = 0, v_p = 0, |v| = 1 (Moore and
Spence 1980), whatever the pieces of a curve are off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.problem import Problem

STEPS = (
    60  # at a fold of higher order a step is no shorter than a part of the one before
)
SETTLED = 1e-15  # of the sizes of the unknowns: a step after which none follows
FARTHEST = 0.1  # of the sizes: a longer step leads elsewhere
MANY_UNKNOWNS = 60  # from here on F'' takes too long


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
    if problem.n > MANY_UNKNOWNS:
        return None
    rows = np.linalg.norm(problem.jacobians(start[None])[0] * sizes, axis=1)
    weights = 1.0 / np.where(rows > 0.0, rows, 1.0)
    u, v = start.copy(), tangent / sizes
    v /= np.linalg.norm(v)
    for _ in range(STEPS):
        step = _newton_step(problem, u, v, parameter, sizes, weights)
        if step is None or np.abs(step).max() > FARTHEST:
            return None
        u = u + sizes * step[: problem.n]
        v = v + step[problem.n :]
        if np.abs(step[: problem.n]).max() <= SETTLED:
            break
    return Fold(u, _bend(problem, u, sizes * v, parameter))


def _newton_step(
    problem: Problem,
    u: np.ndarray,
    v: np.ndarray,
    parameter: int,
    sizes: np.ndarray,
    weights: np.ndarray,
) -> np.ndarray | None:
    """The step (2 n,) of point and tangent, both over ``sizes``:

    [ F'      0  ] [du]     [ F       ]
    [ F'' v   F' ] [dv] = - [ F' v    ]
    [ 0      e_p ]          [ v_p     ]
    [ 0       v  ]          [ (v v-1)/2 ]
    """
    n = problem.n
    first = weights[:, None] * problem.jacobians(u[None])[0] * sizes
    second = np.einsum("mij,j->mi", problem.hessian(u), sizes * v)
    second = weights[:, None] * second * sizes
    unit = np.zeros(n)
    unit[parameter] = 1.0
    nothing = np.zeros_like(first)
    matrix = np.block([[first, nothing], [second, first]])
    border = np.block([[np.zeros((2, n)), np.stack([unit, v])]])
    residual = weights * problem.residuals(u[None])[0]
    right = [residual, first @ v, [v[parameter], 0.5 * (v @ v - 1.0)]]
    system, right_side = np.vstack([matrix, border]), -np.concatenate(right)
    if not (np.isfinite(system).all() and np.isfinite(right_side).all()):
        return None
    step: np.ndarray = np.linalg.lstsq(system, right_side, rcond=1e-14)[0]
    return step


def _bend(
    problem: Problem, u: np.ndarray, tangent: np.ndarray, parameter: int
) -> float:
    """The second derivative of the parameter in the arclength: F' u'' = - F'' t t, u''
    across the unit tangent t."""
    t = tangent / np.linalg.norm(tangent)
    system = np.vstack([problem.jacobians(u[None])[0], t])
    right = np.einsum("mij,i,j->m", problem.hessian(u), t, t)
    bend = np.linalg.lstsq(system, np.append(-right, 0.0), rcond=1e-14)[0]
    return float(bend[parameter])
