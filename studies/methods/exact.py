"""How far points are from the exact curve: Newton's method on the residual in 40
digits."""

from __future__ import annotations

import mpmath
import numpy as np

from studies.methods.cases import DIGITS, Case

STEPS = 4  # of Newton's method
COVER = 2000  # samples of a curve whose distances are measured


def distance_in_digits(case: Case, point: np.ndarray) -> float:
    """Distance of a point near the curve to it, right to many digits, however small.

    The residual is evaluated in 40 digits; each step across the curve is solved for in
    double precision, and gains about as many digits as that has. Next to a bifurcation
    the distance is overestimated.
    """
    problem = case.problem
    jacobian = problem.jacobians(point[None])[0]
    _, arclengths = case.reference.nearest(point)
    tangent = case.reference(arclengths[0], 1)
    inverse = np.linalg.pinv(np.vstack([jacobian / problem.magnitude, tangent]))
    way = np.zeros(problem.n)
    with mpmath.workdps(DIGITS):
        u = [mpmath.mpf(float(x)) for x in point]
        for _ in range(STEPS):
            residual = case.exact_residual(u)
            size = max(abs(r) for r in residual)
            if size == 0:
                break
            relative = [float(-r / size) for r in residual]
            step = inverse @ (np.append(relative, 0.0) / problem.magnitude)
            pairs = zip(u, step, strict=True)
            u = [x + mpmath.mpf(float(d)) * size for x, d in pairs]
            way += step * float(size)
    return float(np.linalg.norm(way))


def distances(case: Case, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (k,) of each point to the reference curve, and the arclength (k,)
    there."""
    return case.reference.nearest(points)


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
    allowed = max(20 * case.length / len(points), 2e-2 * case.length)
    if _widest_gap(case, s) >= allowed:
        return np.inf
    return float(distance.max())


def _widest_gap(case: Case, s: np.ndarray) -> float:
    """The longest stretch of the curve without any of the arclengths ``s`` (k,)."""
    ordered = np.sort(s)
    start, end = ordered[0], case.length - ordered[-1]
    ends = [start + end] if case.reference.closed else [start, end]
    return float(max(np.diff(ordered).max(), *ends))
