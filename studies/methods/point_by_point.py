"""Predictor-corrector continuation, one point after the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc import Problem
from studies.methods.curve import (
    Curve,
    MethodFailure,
    through_points,
    through_points_and_tangents,
)
from studies.methods.linear import evaluate, solve_bordered

NEWTON = 8  # corrections of one point
# largest step over the turn of a step: straight stretches are not smooth ones
LONGEST = 0.6
FIRST = 0.1  # first step, over the turn of a step
SMALLEST = 1e-9  # step below which a curve is given up


def turn_per_step(tolerance: float) -> float:
    """Angle by which the tangent may turn in a step so that cubic pieces err by about
    ``tolerance``."""
    return float(2.5 * tolerance**0.25)


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
    turn = turn_per_step(tolerance)
    limit = (LONGEST * turn if longest is None else longest) * problem.domain.scale
    u, t, h = start, tangent, FIRST * turn
    points = [u]
    tangents = [t]
    travelled = 0.0
    while travelled < length:
        corrected = _correct(problem, u + h * t, t, tolerance)
        if corrected is None:
            h = _halved(h)
            continue
        angle = float(np.linalg.norm(corrected.tangent - t))
        if angle > 2 * turn:
            h = _halved(h)
            continue
        chord = float(np.linalg.norm(corrected.point - u))
        travelled += chord * (1 + angle**2 / 24)
        u, t = corrected.point, corrected.tangent
        points.append(u)
        tangents.append(t)
        growth = min(2.0, max(0.5, turn / (angle + 1e-300)))
        h = min(h * growth, limit)
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
    turn = turn_per_step(tolerance)
    limit = LONGEST * turn * problem.domain.scale
    u, t, h = start, tangent, FIRST * turn
    points = [u]
    travelled = 0.0
    planned = h
    while travelled < length + 2 * h:
        corrected = _correct(problem, u + h * t, t, tolerance)
        if corrected is None:
            h = _halved(h)
            continue
        chord = corrected.point - u
        size = float(np.linalg.norm(chord))
        angle = float(np.linalg.norm(chord / size - t))
        # the last secant itself lags behind the tangent: halve four times at most
        if angle > 2 * turn and h > planned / 16 and len(points) > 1:
            h = _halved(h)
            continue
        travelled += size
        u, t = corrected.point, chord / size
        points.append(u)
        growth = min(1.5, max(0.5, turn / (angle + 1e-300)))
        h = planned = min(h * growth, limit)
    return through_points(points, length)


def _halved(h: float) -> float:
    if h < SMALLEST:
        raise MethodFailure("the step has become too small")
    return 0.5 * h


class _Corrected(NamedTuple):
    """A point (n,) of the curve and the unit tangent (n,) there."""

    point: np.ndarray
    tangent: np.ndarray


def _correct(
    problem: Problem, guess: np.ndarray, tangent: np.ndarray, tolerance: float
) -> _Corrected | None:
    """Newton's method on F = 0, t . (u - guess) = 0; None where it does not
    converge."""
    u = guess
    enough = max(0.1 * tolerance, 1e-13) * problem.domain.scale
    last = np.inf
    for _ in range(NEWTON):
        residual, jacobian = evaluate(problem, u)
        right = np.zeros((len(residual) + 1, 2))
        right[:-1, 0] = -residual
        right[-1, 1] = 1.0
        solution = solve_bordered(jacobian, tangent, right)
        step, slope = solution[:, 0], solution[:, 1]
        u = u + step
        size = float(np.linalg.norm(step))
        if not size < 2 * last:
            return None
        # quadratic convergence: the next step would be about size^2, and the tangent is
        # as good
        if size < max(enough, 1e-3 * np.sqrt(enough)):
            return _Corrected(u, slope / np.linalg.norm(slope))
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
    h = 0.5 * turn_per_step(tolerance)
    u, t = start, tangent
    points = [u]
    tangents = [t]
    travelled = 0.0
    limit = max(0.1 * tolerance, 1e-14)
    while travelled < length:
        point, null_vector = _correct_by_svd(problem, u + h * t, limit)
        slope = null_vector * np.sign(null_vector @ t)
        turn = np.linalg.norm(slope - t)
        travelled += float(np.linalg.norm(point - u) * (1 + turn**2 / 24))
        u, t = point, slope
        points.append(u)
        tangents.append(t)
    return through_points_and_tangents(points, tangents, length)


def _correct_by_svd(problem: Problem, guess: np.ndarray, limit: float) -> _Corrected:
    """The point that steps of the pseudo-inverse lead to, and the null vector there, of
    either sign; raises `MethodFailure`."""
    u = guess
    rank = problem.n - 1
    for _ in range(NEWTON):
        residual, jacobian = evaluate(problem, u)
        left, sigma, right = np.linalg.svd(jacobian)
        if float(np.linalg.norm(residual)) <= limit * sigma[0]:
            return _Corrected(u, right[-1])
        u = u - right[:rank].T @ ((left[:, :rank].T @ residual) / sigma[:rank])
    raise MethodFailure("the corrector does not converge")
