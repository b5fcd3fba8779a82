"""Rank-aware correction onto the solution set of an overdetermined, consistent
system."""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.limits import is_time_over, left_behind
from bifurc.numerics.bordered import (
    Bordered,
    bordered_at,
    bordered_matrix,
    sparse_factors,
)
from bifurc.system import (
    SphereProjection,
    System,
    jacobian_at,
    relative_jacobians,
    relative_residuals,
)

ACROSS_STEPS = 30  # of one point onto a curve
LEAST_SQUARES_STEPS = 80  # of one random start
LEAST_WEIGHT = 1e-15  # on the length of a step, at which what it solves is regular
SPHERE_STEPS = 25  # of one start on a small sphere
# residual left by one step, as a share, above which a factorisation made elsewhere is
# given up
SLOW = 0.05
BENT = 1e-13  # a residual above this may rise once for a bend, and not for rounding


class Correction(NamedTuple):
    """A ``point`` (n,) corrected onto a curve, the relative residual ``gap`` that is
    left, and the factorisation used last."""

    point: np.ndarray
    gap: float
    factored: Bordered | None


class _Iterate(NamedTuple):
    """A point (n,), F over the magnitude there (m,), and the norm of that."""

    point: np.ndarray
    residual: np.ndarray
    gap: float


def _iterate(problem: System, point: np.ndarray) -> _Iterate:
    residual = problem.residuals(point[None])[0] / problem.magnitude
    return _Iterate(point, residual, math.sqrt(residual @ residual))


# --- onto curves and surfaces ---------------------------------------------------------


def correct_across(
    problem: System,
    point: np.ndarray,
    tangent: np.ndarray,
    tolerance: float,
    factored: Bordered | None = None,
) -> Correction:
    """``point`` corrected onto the curve in the hyperplane across ``tangent``.

    Gauss-Newton on ``[F'; t] d = [-F; 0]`` in the least-squares sense, with a
    factorisation made nearby (``factored``, of the same tangent) as long as the
    residual falls fast enough with it, and a fresh one where it does not. It converges
    as long as the system is consistent, whatever the number of redundant equations, and
    to the smallest residual where it is not. A step in a weak direction may raise the
    residual, by the bend of the other equations, before the next one lowers it: that is
    let pass once.
    """
    enough = last_step(tolerance, problem.domain.scale)
    best = _Iterate(point, np.empty(0), np.inf)
    gap_before = math.inf
    is_fresh = False
    has_bend = False
    for _ in range(ACROSS_STEPS):
        iterate = _iterate(problem, point)
        if iterate.gap < best.gap:
            best = iterate
        has_risen = is_fresh and iterate.gap >= gap_before
        has_stopped = has_risen and (has_bend or iterate.gap < BENT)
        if has_stopped or not math.isfinite(iterate.gap):
            break
        has_bend = has_bend or has_risen
        rate = iterate.gap / gap_before if gap_before < math.inf else 1.0
        is_fresh = factored is None or iterate.gap > SLOW * gap_before
        if factored is None or is_fresh:
            origin = iterate if has_risen else best
            factored = bordered_at(problem, origin.point, tangent)
            iterate = origin
        step = factored.solve(-iterate.residual)
        point = iterate.point + step
        gap_before = iterate.gap
        length = math.sqrt(step @ step)
        if length * max(rate, 0.01) <= enough:
            # the next step would be too small to matter: F is not evaluated again
            return Correction(point, iterate.gap, factored)
    return Correction(best.point, best.gap, factored)


def last_step(tolerance: float, scale: float) -> float:
    """The length of a correction, with what the next one is expected to be, after which
    a point is known to the ``tolerance`` over the ``scale``."""
    return 0.01 * tolerance * scale


class NormalCorrections(NamedTuple):
    """Points (k, n) corrected straight to a tangent plane, the relative residuals
    ``gaps`` (k,) that are left, and whether the last step ``is_settled`` (k,): too small
    to matter."""

    points: np.ndarray
    gaps: np.ndarray
    is_settled: np.ndarray


def correct_normal(
    problem: System, points: np.ndarray, bases: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) straight above ``points`` (k, n) of tangent planes (k, n, 2),
    and the relative residuals (k,)."""
    corrections = normal_corrections(problem, points, bases)
    return corrections.points, corrections.gaps


def normal_corrections(
    problem: System, points: np.ndarray, bases: np.ndarray
) -> NormalCorrections:
    """How ``points`` (k, n) are corrected straight to tangent spaces with the bases (k,
    n, d) or (n, d).

    Gauss-Newton on ``[F'; T^T] d = [-F; 0]``, as for curves, by normal equations: far
    faster than an SVD of every matrix, and what a step loses to rounding the next one
    mends. A little damping keeps them regular at singular points.
    """
    spaces = np.broadcast_to(bases, (len(points), *bases.shape[-2:]))
    return NormalCorrections(
        *_core.normal_corrections(
            compiled_equations(problem),
            problem.domain.scale,
            np.ascontiguousarray(points, dtype=float),
            np.ascontiguousarray(spaces),
        )
    )


def compiled_equations(problem: System) -> object:
    """F and F', over the magnitude, for the compiled methods that are the same for all
    systems: many points at a time where Python makes them."""
    equations = problem.shortcuts.equations
    if equations is not None:
        return equations(problem.magnitude)
    return _core.called_equations(
        problem.n,
        partial(relative_residuals, problem),
        partial(relative_jacobians, problem),
        lambda points: problem.hessians(points) / problem.magnitude,
    )


def limited(steps: np.ndarray, longest: float) -> np.ndarray:
    """``steps`` (k, n), those longer than ``longest`` shortened to it."""
    lengths = np.linalg.norm(steps, axis=1)
    shares = np.minimum(1.0, longest / (lengths + 1e-300))
    shortened: np.ndarray = steps * shares[:, None]
    return shortened


# --- from anywhere --------------------------------------------------------------------


def project_by_least_squares(
    problem: System, starts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) reached from every start (k, n), and the relative residual (k,)
    left at each, infinite where F is not defined; where the time is over, from the first
    of them."""
    points = np.array(starts, dtype=float)
    gaps = np.empty(len(points))
    for k, start in enumerate(points):
        end = _least_squares(problem, start)
        points[k] = end.point
        gaps[k] = end.gap if math.isfinite(end.gap) else math.inf
    return points, gaps


def _least_squares(problem: System, start: np.ndarray) -> _Iterate:
    """Where Levenberg and Marquardt's method ends.

    With the residual norm as damping it converges quadratically to solution sets that
    are not isolated points as well (Fan & Yuan 2005).
    """
    best = _iterate(problem, start)
    damping = 1e-2  # over the residual
    for _ in range(LEAST_SQUARES_STEPS):
        if not best.gap > 1e-15 or damping > 1e9 or is_time_over():
            break
        step = _damped_step(problem, best, damping * best.gap)
        if step is None:
            break
        trial = _iterate(problem, best.point - step)
        if trial.gap < best.gap:
            is_fast = trial.gap < 0.5 * best.gap
            damping = max(damping * (0.2 if is_fast else 1.0), 1e-8)
            best = trial
        else:
            damping *= 8.0
    return best


def _damped_step(problem: System, at: _Iterate, weight: float) -> np.ndarray | None:
    """What to subtract (n,) from a point, with a ``weight`` on its length; None where
    F' is not finite there."""
    jacobian = jacobian_at(problem, at.point)
    if isinstance(jacobian, np.ndarray):
        jacobian = jacobian / problem.magnitude
        if not np.all(np.isfinite(jacobian)):
            return None
        normal = jacobian.T @ jacobian + weight * np.eye(problem.n)
        solve = left_behind(problem.n, np.linalg.lstsq)
        step, *_ = solve(normal, jacobian.T @ at.residual, rcond=None)
        return np.asarray(step)
    from scipy.sparse import block_array, csc_array, eye_array

    matrix = csc_array(jacobian) / problem.magnitude
    if not np.all(np.isfinite(matrix.data)):
        return None
    # d = J^T y with (J J^T + w) y = F: neither J J^T nor J^T J is formed, as a parameter
    # that is in all equations would fill it
    m, n = matrix.shape
    weights = max(weight, LEAST_WEIGHT) * eye_array(m)
    both = block_array([[-eye_array(n), matrix.T], [matrix, weights]], format="csc")
    try:
        factors = sparse_factors(both)
    except RuntimeError:  # exactly singular
        return None
    return np.asarray(factors.solve(np.append(np.zeros(n), at.residual))[:n])


def project_to_sphere_by_newton(
    problem: System, starts: np.ndarray, center: np.ndarray, radius: float
) -> SphereProjection:
    """Solutions reached from starts (k, n), at distance ``radius`` from ``center``."""
    points = np.array(starts, dtype=float)
    last_steps = np.empty(len(points))
    gaps = np.empty(len(points))
    for k, start in enumerate(points):
        points[k], last_steps[k] = _newton_on_sphere(problem, start, center, radius)
        gaps[k] = _iterate(problem, points[k]).gap
    return SphereProjection(points, gaps, last_steps)


def _newton_on_sphere(
    problem: System, start: np.ndarray, center: np.ndarray, radius: float
) -> tuple[np.ndarray, float]:
    """Where Gauss-Newton on F = 0 and |u - center| = radius ends, and the length of its
    last step.

    It is not damped: next to a singular point the equations differ in size by the
    radius, which a merit function would see and Newton's method does not. Steps are cut
    to a third of the radius.
    """
    point = start
    length = np.inf
    for _ in range(SPHERE_STEPS):
        offset = (point - center) / radius
        jacobian = relative_jacobians(problem, point[None])[0]
        residual = relative_residuals(problem, point[None])[0]
        matrix = bordered_matrix(jacobian, offset)
        if not (np.isfinite(matrix).all() and np.isfinite(residual).all()):
            break
        outwards = 0.5 * radius * (1.0 - offset @ offset)
        right = np.append(-residual, outwards)
        step, *_ = np.linalg.lstsq(matrix, right, rcond=1e-14)
        length = float(np.linalg.norm(step))
        share = min(1.0, radius / (3.0 * length + 1e-300))
        point = point + step * share
        if length < 1e-14 * problem.domain.scale:
            break
    return point, length
