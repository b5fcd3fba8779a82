"""How far points are from the exact curve: Newton's method on the residual in 40
digits."""

from __future__ import annotations

import mpmath
import numpy as np

from studies.methods.cases import DIGITS, Case

__all__ = ["distance_in_digits", "distances", "largest_distance"]

COVER = 2000  # samples of a curve whose distances are measured


def distance_in_digits(case: Case, point: np.ndarray) -> float:
    """Distance of a point near the curve to it, right to many digits, however small.

    The residual is evaluated in 40 digits; each step across the curve is solved for in
    double precision, and gains about as many digits as that has. Next to a bifurcation
    the distance is overestimated.
    """
    problem = case.problem
    jacobian = problem.jacobians(point[None])[0]
    tangent = case.reference(case.reference.nearest(point)[1][0], 1)
    matrix = np.vstack([jacobian / problem.magnitude, tangent])
    inverse = np.linalg.pinv(matrix)
    with mpmath.workdps(DIGITS):
        u, moved = [mpmath.mpf(float(x)) for x in point], np.zeros(problem.n)
        for _ in range(4):
            residual = case.exact_residual(u)
            size = max(abs(r) for r in residual)
            if size == 0:
                break
            right = (
                np.append([float(-r / size) for r in residual], 0.0) / problem.magnitude
            )
            step = inverse @ right
            u = [x + mpmath.mpf(float(d)) * size for x, d in zip(u, step, strict=True)]
            moved += step * float(size)
    return float(np.linalg.norm(moved))


def distances(case: Case, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (k,) of each point to the reference curve, and the arclength (k,)
    there."""
    return case.reference.nearest(points, neighbours=1)


def largest_distance(case: Case, points: np.ndarray) -> float:
    """Largest distance of densely sampled points to the exact curve; infinite where
    they leave out a part of it.

    By way of the reference curve, whose own error is of the order of rounding. What a
    method adds beyond the ends of an open curve is not compared: its own arclength
    tells it only roughly where to stop.
    """
    distance, s = distances(case, points)
    if not case.reference.closed:
        inside = (s > 0.0) & (s < case.length)
        if not np.any(inside):
            return np.inf
        distance, s = distance[inside], s[inside]
    ordered = np.sort(s)
    ends = [ordered[0], case.length - ordered[-1]]
    if case.reference.closed:
        ends = [ordered[0] + case.length - ordered[-1]]
    widest = max(float(np.diff(ordered).max()), *ends)
    return (
        float(distance.max())
        if widest < max(20 * case.length / len(points), 2e-2 * case.length)
        else np.inf
    )
