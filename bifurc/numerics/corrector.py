"""Rank-aware correction onto the solution set of an overdetermined, consistent
system."""

from __future__ import annotations

import numpy as np
from scipy.sparse import issparse

from bifurc.numerics.bordered import Bordered
from bifurc.problem import Problem

__all__ = [
    "correct_across",
    "correct_normal",
    "null_vector",
    "project_by_least_squares",
    "project_to_sphere_by_newton",
]

DAMPING = 1e-14  # of normal equations, over the largest squared singular value
LARGE = (
    64  # unknowns beyond which tangents come from bordered systems instead of an SVD
)
# residual left by one step, as a share, above which a factorisation made elsewhere is
# given up
SLOW = 0.05


def null_vector(
    problem: Problem, point: np.ndarray, along: np.ndarray | None = None
) -> np.ndarray:
    """Unit tangent (n,) of the curve through ``point``: the null vector of F'.

    It has no sign of its own: it is turned to agree with ``along`` where that is given.
    Where the null space is larger, ``along`` is projected on it. A large problem is
    bordered instead of decomposed.
    """
    jacobian = problem.jacobian(point)
    if problem.n > LARGE or issparse(jacobian):
        border = (
            np.random.default_rng(0).normal(size=problem.n) if along is None else along
        )
        first = Bordered(jacobian, border / np.linalg.norm(border)).null_vector()
        return Bordered(jacobian, first).null_vector()
    _, sigma, right = np.linalg.svd(jacobian, full_matrices=True)
    padded = np.concatenate([sigma, np.zeros(len(right) - len(sigma))])
    null = right[padded <= max(padded[-1], 1e-9 * padded[0])]
    if along is None:
        return null[-1]
    tangent = null.T @ (null @ along)
    size = np.linalg.norm(tangent)
    return tangent / size if size > 1e-3 * np.linalg.norm(along) else null[-1]


def correct_across(
    problem: Problem,
    point: np.ndarray,
    tangent: np.ndarray,
    tolerance: float,
    factored: Bordered | None = None,
) -> tuple[np.ndarray, float, Bordered | None]:
    """``point`` corrected onto the curve in the hyperplane across ``tangent``, the
    relative residual left, and the factorisation used last.

    Gauss-Newton on ``[F'; t] d = [-F; 0]`` in the least-squares sense, with a
    factorisation made nearby (``factored``, of the same tangent) as long as the
    residual falls fast enough with it, and a fresh one where it does not. It converges
    as long as the system is consistent, whatever the number of redundant equations, and
    to the smallest residual where it is not.
    """
    limit = 0.01 * tolerance * problem.scale
    u, best, best_gap, previous, fresh = point.copy(), point, np.inf, np.inf, False
    for _ in range(30):
        residual = problem.residuals(u[None])[0] / problem.magnitude
        gap = float(np.sqrt(residual @ residual))
        if gap < best_gap:
            best, best_gap, at_best = u, gap, residual
        slow = gap > SLOW * previous
        if not np.isfinite(gap) or (fresh and gap >= previous):
            break
        rate = gap / previous if previous < np.inf else 1.0
        if factored is None or slow:
            factored, fresh = (
                Bordered(problem.jacobian(best) / problem.magnitude, tangent),
                True,
            )
            u, residual, gap = best, at_best, best_gap
        else:
            fresh = False
        previous = gap
        step = factored.solve(-residual)
        u = u + step
        if np.sqrt(step @ step) * max(rate, 0.01) <= limit:
            return (
                u,
                gap,
                factored,
            )  # the residual before a last step after which the next is too small to matter
    return best, best_gap, factored


def correct_normal(
    problem: Problem, points: np.ndarray, bases: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) straight above ``points`` (k, n) of tangent planes (k, n, 2),
    and the relative residuals (k,).

    Gauss-Newton on ``[F'; T^T] d = [-F; 0]``, as for curves, by normal equations: far
    faster than an SVD of every matrix, and what a step loses to rounding the next one
    mends. `DAMPING` keeps them regular at singular points.
    """
    points = points.copy()
    across = np.swapaxes(bases, 1, 2)
    for _ in range(10):
        residual = problem.residuals(points) / problem.magnitude
        jacobian = problem.jacobians(points) / problem.magnitude
        matrix = (
            np.swapaxes(jacobian, 1, 2) @ jacobian
            + bases @ across
            + DAMPING * np.eye(problem.n)
        )
        right = np.swapaxes(jacobian, 1, 2) @ residual[:, :, None]
        step = -np.linalg.solve(matrix, right)[:, :, 0]
        size = np.linalg.norm(step, axis=1)
        points += step * np.minimum(1.0, 0.5 * problem.scale / (size + 1e-300))[:, None]
        if size.max(initial=0.0) < 1e-9 * problem.scale:
            break
    return points, np.linalg.norm(problem.residuals(points), axis=1) / problem.magnitude


def project_by_least_squares(
    problem: Problem, starts: np.ndarray, iterations: int = 80
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) reached from every start (k, n), and the relative residual (k,)
    left at each.

    Levenberg-Marquardt with the residual norm as damping, which converges quadratically
    to solution sets that are not isolated points as well (Fan & Yuan 2005).
    """
    points, gaps = np.array(starts, dtype=float), np.empty(len(starts))

    def evaluate(u: np.ndarray) -> tuple[np.ndarray, float]:
        residual = problem.residuals(u[None])[0] / problem.magnitude
        return residual, float(np.linalg.norm(residual))

    for k, u in enumerate(points):
        residual, gap = evaluate(u)
        factor = 1e-2
        for _ in range(iterations):
            if gap <= 1e-15 or factor > 1e9:
                break
            jacobian = problem.jacobians(u[None])[0] / problem.magnitude
            normal = jacobian.T @ jacobian + factor * gap * np.eye(len(u))
            trial = u - np.linalg.lstsq(normal, jacobian.T @ residual, rcond=None)[0]
            new_residual, new_gap = evaluate(trial)
            if new_gap < gap:
                factor = max(factor * (0.2 if new_gap < 0.5 * gap else 1.0), 1e-8)
                u, residual, gap = trial, new_residual, new_gap
            else:
                factor *= 8.0
        points[k], gaps[k] = u, gap
    return points, gaps


def project_to_sphere_by_newton(
    problem: Problem,
    starts: np.ndarray,
    center: np.ndarray,
    radius: float,
    iterations: int = 25,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solutions (k, n) at distance ``radius`` from ``center``, relative residuals (k,)
    and last steps (k,).

    Gauss-Newton without damping: next to a singular point the equations differ in size
    by the radius, which a merit function would see and Newton's method does not. Steps
    are cut to a third of the radius.
    """
    points, gaps, last = (
        np.array(starts, dtype=float),
        np.empty(len(starts)),
        np.empty(len(starts)),
    )
    for k, u in enumerate(points):
        for _ in range(iterations):
            offset = (u - center) / radius
            matrix = np.vstack(
                [problem.jacobians(u[None])[0] / problem.magnitude, offset]
            )
            right = np.append(
                -problem.residuals(u[None])[0] / problem.magnitude,
                0.5 * radius * (1.0 - offset @ offset),
            )
            step = np.linalg.lstsq(matrix, right, rcond=1e-14)[0]
            last[k] = np.linalg.norm(step)
            u = u + step * min(1.0, radius / (3.0 * last[k] + 1e-300))
            if last[k] < 1e-14 * problem.scale:
                break
        points[k], gaps[k] = (
            u,
            np.linalg.norm(problem.residuals(u[None])[0]) / problem.magnitude,
        )
    return points, gaps, last
