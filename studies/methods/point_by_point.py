"""Predictor-corrector continuation, one point after the other."""

from __future__ import annotations

import numpy as np

from bifurc.problem import Problem
from studies.methods.curve import (
    Curve,
    MethodFailure,
    through_points,
    through_points_and_tangents,
)
from studies.methods.linear import evaluate, solve_bordered

__all__ = [
    "pseudo_arclength_secant",
    "pseudo_arclength_tangent",
    "svd_predictor_corrector",
]

NEWTON = 8  # corrections of one point
LONGEST = (
    0.6  # largest step over the turn of a step: straight stretches are not smooth ones
)


def turn_per_step(tolerance: float) -> float:
    """Angle by which the tangent may turn in a step so that cubic pieces err by about
    ``tolerance``."""
    return 2.5 * tolerance**0.25


def pseudo_arclength_tangent(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    tolerance: float,
    longest: float | None = None,
) -> Curve:
    """Pseudo-arclength continuation (Keller 1977) with the tangent as predictor and
    cubic Hermite pieces.

    Steps turn the tangent by an equal angle, halved where Newton's method does not
    converge; the ``longest``, over the problem's scale, is `LONGEST` times that angle
    unless given.
    """
    longest = LONGEST * turn_per_step(tolerance) if longest is None else longest
    turn, u, t, h = (
        turn_per_step(tolerance),
        start,
        tangent,
        turn_per_step(tolerance) * 0.1,
    )
    points, tangents, travelled = [u], [t], 0.0
    while travelled < length:
        found = _correct(problem, u + h * t, t, tolerance)
        if found is None:
            h = _halved(h)
            continue
        new, slope = found
        angle = float(np.linalg.norm(slope - t))
        if angle > 2 * turn:
            h = _halved(h)
            continue
        travelled += float(np.linalg.norm(new - u)) * (1 + angle**2 / 24)
        u, t = new, slope
        points.append(u)
        tangents.append(t)
        h = min(
            h * min(2.0, max(0.5, turn / (angle + 1e-300))), longest * problem.scale
        )
    return through_points_and_tangents(points, tangents, length)


def pseudo_arclength_secant(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    tolerance: float,
) -> Curve:
    """Pseudo-arclength continuation with the secant through the last two points as
    predictor, and a cubic spline."""
    turn, u, t, h = (
        turn_per_step(tolerance),
        start,
        tangent,
        turn_per_step(tolerance) * 0.1,
    )
    points, travelled, tried = [u], 0.0, h
    while travelled < length + 2 * h:
        found = _correct(problem, u + h * t, t, tolerance)
        if found is None:
            h = _halved(h)
            continue
        chord = found[0] - u
        size = float(np.linalg.norm(chord))
        angle = float(np.linalg.norm(chord / size - t))
        if (
            angle > 2 * turn and h > tried / 16 and len(points) > 1
        ):  # the last secant itself lags behind the tangent
            h = _halved(h)
            continue
        travelled += size
        u, t = found[0], chord / size
        points.append(u)
        h = min(
            h * min(1.5, max(0.5, turn / (angle + 1e-300))),
            LONGEST * turn * problem.scale,
        )
        tried = h
    return through_points(points, length)


def _halved(h: float) -> float:
    if h < 1e-9:
        raise MethodFailure("the step has become too small")
    return 0.5 * h


def _correct(
    problem: Problem, guess: np.ndarray, tangent: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Newton's method on F = 0, t . (u - guess) = 0; the point and the unit tangent
    there, or None."""
    u, enough = guess, max(0.1 * tolerance, 1e-13) * problem.scale
    right, last = np.empty(0), np.inf
    for _ in range(NEWTON):
        residual, jacobian = evaluate(problem, u)
        right = np.zeros((len(residual) + 1, 2))
        right[:-1, 0], right[-1, 1] = -residual, 1.0
        solution = solve_bordered(jacobian, tangent, right)
        step, slope = solution[:, 0], solution[:, 1]
        u = u + step
        size = float(np.linalg.norm(step))
        if not size < 2 * last:
            return None
        # quadratic convergence: the next step would be about size^2, and the tangent is
        # as good
        if size < max(enough, 1e-3 * np.sqrt(enough)):
            return u, slope / np.linalg.norm(slope)
        last = size
    return None


def svd_predictor_corrector(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    tolerance: float,
) -> Curve:
    """The method of Gan and Pellegrino 2006 as in Song 2013, appendix A, with cubic
    Hermite pieces between its points.

    Predictor: a fixed step along the null vector of F', the last right singular vector.
    Corrector: steps of the pseudo-inverse of rank n - 1, from a singular value
    decomposition each, until the closure error, over the largest singular value, is
    below the tolerance. (In (A2) and (A6) the factors stand in the wrong order, and the
    sum of (A17) is -E.)
    """
    h, u, t = 0.5 * turn_per_step(tolerance), start, tangent
    points, tangents, travelled = [u], [t], 0.0
    limit = max(0.1 * tolerance, 1e-14)
    while travelled < length:
        new = u + h * t
        for _ in range(NEWTON):
            residual, jacobian = evaluate(problem, new)
            left, sigma, right = np.linalg.svd(jacobian)
            if float(np.linalg.norm(residual)) <= limit * sigma[0]:
                break
            rank = problem.n - 1
            new = new - right[:rank].T @ ((left[:, :rank].T @ residual) / sigma[:rank])
        else:
            raise MethodFailure("the corrector does not converge")
        slope = right[-1] * np.sign(right[-1] @ t)
        travelled += float(
            np.linalg.norm(new - u) * (1 + np.linalg.norm(slope - t) ** 2 / 24)
        )
        u, t = new, slope
        points.append(u)
        tangents.append(t)
    return through_points_and_tangents(points, tangents, length)
