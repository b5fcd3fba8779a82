"""The place of a singular point of higher order, in many digits.

There F vanishes to a higher order, and doubles see a whole stretch of singular points:
1e-4 of the scale at a point of order 4. Equations that are known exactly tell which of
them it is. Gauss-Newton converges linearly there, and where its steps shrink at a steady
rate the rest of the geometric series is taken at once.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np

from bifurc.curves.misclosure import misclosure_at
from bifurc.decisions import misses_by_rounding, solves_exactly
from bifurc.errors import NOT_DEFINED
from bifurc.singular.confirm import Differences, as_precise, gauss_newton_step
from bifurc.singular.locate import LocatedPoint
from bifurc.system import System

DIGITS = 40  # that are worked to; the derivatives are differences, at three times these
ITERATIONS = 120
AMISS = 2.0  # times the distance from the place in doubles is its error
STEADY = 0.05  # relative change of the rate at which steps shrink that is none
SLOWEST = 0.95  # rate at which they shrink, at most, where the rest of them is taken
FARTHEST = 4.0  # errors of the point in doubles, and at least this share of the scale:
NEAREST = 0.02  # no farther away is the point
ENOUGH = 1e-16  # length of the last step over the scale
SETTLED = 1e-15  # error of the place then, over the scale, beside what doubles round
LEAST = 1e-30  # of F, over the magnitude and the scale, that counts as anything


def held_to_exact_equations(
    problem: System, located: LocatedPoint, misclosure: float = 0.0
) -> LocatedPoint | None:
    """A located point where the exact equations have a solution of its rank, as far as
    its error and their rounded coefficients tell; None where they have none. On curves
    with a ``misclosure`` F = 0 to within that.

    The equations for a singular point and its null space are more than their unknowns:
    an iteration may settle where they do not hold. The point is not confirmed where
    they fail by no more than doubles see.
    """
    if problem.precise_residual() is None:
        return located
    rank = problem.n - located.null_space.shape[1]
    left = misclosure_at(problem, located.u, rank)
    try:
        rounding = _coefficient_rounding(problem, located.u)
    except NOT_DEFINED:
        return located  # it is at a rim of where the function is defined
    allowed = rounding + misclosure
    error = located.error / problem.domain.scale
    unit = allowed / problem.domain.scale + error**2 + LEAST
    if solves_exactly(left / problem.domain.scale, unit):
        return located
    if misses_by_rounding(left):
        return located._replace(is_confirmed=False)
    return None


def _coefficient_rounding(problem: System, point: np.ndarray) -> float:
    """How far off F is at a point (n,), over the magnitude, where the numbers in it are
    rounded."""
    accuracy = problem.accuracy
    if accuracy.coefficient_rounding is not None:
        rounding = accuracy.coefficient_rounding(point)
        return float(np.linalg.norm(rounding)) / problem.magnitude
    rows = len(problem.residuals(point[None])[0])
    return math.sqrt(rows) * accuracy.data_rounding * problem.domain.scale


def precisely_located(
    problem: System, located: LocatedPoint, misclosure: float = 0.0
) -> LocatedPoint | None:
    """A located point as the exact equations have it, where they are known; None where
    they have no singular point of this nullity at the place to which the search for
    it leads.

    The error stays what curves in doubles may pass it by, and is at least that by which
    it was amiss. Where the iteration does not settle the point is not confirmed.
    """
    residual = problem.precise_residual()
    if residual is None:
        return located
    reach = max(FARTHEST * located.error, NEAREST * problem.domain.scale)
    with mpmath.workdps(3 * DIGITS + 10):
        derivatives = Differences(residual, mpmath.mpf(10) ** -DIGITS)
        try:
            end = _iterate(derivatives, located, reach)
        except NOT_DEFINED:
            return located  # it left where the function is defined
    if end is None:
        return located._replace(is_confirmed=False)
    u, vectors = end
    null_space, _ = np.linalg.qr(vectors)
    error = SETTLED * problem.domain.scale + float(np.linalg.norm(np.spacing(u)))
    settled = LocatedPoint(u, null_space, error)
    held = held_to_exact_equations(problem, settled, misclosure)
    if held is None:
        return None
    moved = float(np.linalg.norm(u - located.u))
    return held._replace(error=max(located.error, AMISS * moved))


def _iterate(
    derivatives: Differences, located: LocatedPoint, reach: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Where the iteration settles, as doubles: the point (n,) and vectors (n, k) that
    span its null space; None where it does not, or farther away than ``reach``."""
    negligible = mpmath.mpf(10) ** (-2 * DIGITS)
    start, basis = as_precise(located.u), as_precise(located.null_space)
    u = start
    enough = ENOUGH * min(reach / NEAREST, 1.0)
    lengths: list[mpmath.mpf] = []
    rates: list[mpmath.mpf] = []
    for _ in range(ITERATIONS):
        du, dv = gauss_newton_step(derivatives, u, basis, negligible)
        length = mpmath.norm(du)
        lengths.append(length)
        if len(lengths) > 1 and lengths[-2]:
            rates.append(length / lengths[-2])
        ahead = _ahead(rates)
        if ahead > 1:
            lengths, rates = [], []  # the next steps are those of another series
        u, basis = u + ahead * du, basis + dv
        if mpmath.norm(u - start) > reach:
            return None
        if length < enough:
            return u.astype(float), basis.astype(float)
    return None


def _ahead(rates: list[mpmath.mpf]) -> mpmath.mpf:
    """By what to lengthen a step, so that it is the rest of a geometric series; 1 where
    steps do not shrink at a steady rate."""
    if len(rates) < 2:
        return mpmath.mpf(1)
    before, rate = rates[-2:]
    is_steady = abs(rate - before) < STEADY * rate
    if not is_steady or not 0.2 < rate < SLOWEST:
        return mpmath.mpf(1)
    return 1 / (1 - rate)
