"""Rank-aware correction onto the solution set of an overdetermined, consistent system."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bifurc.problem import Problem

__all__ = ["correct_across", "null_vector", "project_by_least_squares", "project_to_sphere_by_newton"]


def null_vector(problem: Problem, point: np.ndarray, along: np.ndarray | None = None) -> np.ndarray:
    """Unit tangent (n,) of the curve through ``point``: the last right singular vector of F'.

    The vector of an SVD has no sign: it is turned to agree with ``along`` where that is given. Where several
    singular values vanish, ``along`` is projected on their null space.
    """
    _, sigma, right = np.linalg.svd(problem.jacobians(point[None])[0], full_matrices=True)
    padded = np.concatenate([sigma, np.zeros(len(right) - len(sigma))])
    null = right[padded <= max(padded[-1], 1e-9 * padded[0])]
    if along is None:
        return null[-1]
    tangent = null.T @ (null @ along)
    size = np.linalg.norm(tangent)
    return tangent / size if size > 1e-3 * np.linalg.norm(along) else null[-1]


def correct_across(
    problem: Problem, point: np.ndarray, tangent: np.ndarray, tolerance: float, iterations: int = 12
) -> tuple[np.ndarray, float]:
    """``point`` corrected onto the curve in the hyperplane across ``tangent``, and the relative residual left.

    Gauss-Newton on ``[F'; t] d = [-F; 0]`` in the least-squares sense: it converges quadratically as
    long as the system is consistent, whatever the number of redundant equations, and to the smallest
    residual where it is not.
    """
    u, best, best_gap = point.copy(), point, np.inf
    for _ in range(iterations):
        residual = problem.residuals(u[None])[0] / problem.magnitude
        gap = float(np.linalg.norm(residual))
        if not gap < best_gap:
            break
        best, best_gap = u.copy(), gap
        if gap <= 0.01 * tolerance:
            break
        matrix = np.vstack([problem.jacobians(u[None])[0] / problem.magnitude, tangent])
        u = u + np.linalg.lstsq(matrix, np.append(-residual, 0.0), rcond=1e-12)[0]
    return best, best_gap


def project_by_least_squares(
    problem: Problem, starts: np.ndarray, iterations: int = 80
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) reached from every start (k, n), and the relative residual (k,) left at each.

    Levenberg-Marquardt with the residual norm as damping, which converges quadratically to solution sets that
    are not isolated points as well (Fan & Yuan 2005).
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
    problem: Problem, starts: np.ndarray, center: np.ndarray, radius: float, iterations: int = 25
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solutions (k, n) at distance ``radius`` from ``center``, relative residuals (k,) and last steps (k,).

    Gauss-Newton without damping: next to a singular point the equations differ in size by the radius, which a
    merit function would see and Newton's method does not. Steps are cut to a third of the radius.
    """
    points, gaps, last = np.array(starts, dtype=float), np.empty(len(starts)), np.empty(len(starts))
    for k, u in enumerate(points):
        for _ in range(iterations):
            offset = (u - center) / radius
            matrix = np.vstack([problem.jacobians(u[None])[0] / problem.magnitude, offset])
            right = np.append(
                -problem.residuals(u[None])[0] / problem.magnitude, 0.5 * radius * (1.0 - offset @ offset)
            )
            step = np.linalg.lstsq(matrix, right, rcond=1e-14)[0]
            last[k] = np.linalg.norm(step)
            u = u + step * min(1.0, radius / (3.0 * last[k] + 1e-300))
            if last[k] < 1e-14 * problem.scale:
                break
        points[k], gaps[k] = u, np.linalg.norm(problem.residuals(u[None])[0]) / problem.magnitude
    return points, gaps, last
