"""Natural-parameter stepping: one unknown is set, `scipy.optimize` solves for the
others."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares, root

from bifurc import Problem
from studies.methods.curve import Curve, MethodFailure
from studies.methods.point_by_point import turn_per_step

# of the last 1 to 4 of equally spaced points, in the polynomial through them
WEIGHTS = ((1,), (-1, 2), (1, -3, 3), (-1, 4, -6, 4))


def natural_parameter(
    problem: Problem,
    start: np.ndarray,
    travel: float,
    parameter: int | None,
    tolerance: float,
) -> Curve:
    """Equal steps of the unknown ``parameter`` over ``travel``, each solved from the
    cubic through the points before.

    `scipy.optimize.root` (hybrid method) where the rest is square, `least_squares`
    (Levenberg-Marquardt) where there are more equations. There has to be an unknown
    without dead points. A cubic spline joins the points.
    """
    if parameter is None:
        raise MethodFailure("every unknown has a dead point")
    count = max(8, int(abs(travel) / (0.5 * turn_per_step(tolerance))))
    values = start[parameter] + np.linspace(0.0, travel, count + 1)
    others = np.delete(np.arange(problem.n), parameter)
    solved = [start]
    for k in range(1, count + 1):
        guess = _extrapolate(solved)
        guess[parameter] = values[k]
        solved.append(_solve(problem, guess, others, tolerance))
    return Curve(_along(values, np.array(solved)), 1.0, count + 1)


def _solve(
    problem: Problem, guess: np.ndarray, others: np.ndarray, tolerance: float
) -> np.ndarray:
    def residual(x: np.ndarray) -> np.ndarray:
        guess[others] = x
        return np.asarray(problem.residuals(guess[None])[0])

    def jacobian(x: np.ndarray) -> np.ndarray:
        guess[others] = x
        return np.asarray(problem.jacobians(guess[None])[0][:, others])

    x = guess[others]
    enough = max(0.1 * tolerance, 1e-14)
    if len(residual(x)) == len(others):
        solution = root(residual, x, jac=jacobian, tol=enough)
    else:
        solution = least_squares(
            residual,
            x,
            jac=jacobian,
            method="lm",
            xtol=enough,
            ftol=enough,
            gtol=enough,
        )
    x = solution.x
    if np.linalg.norm(residual(x)) > 1e3 * tolerance * problem.magnitude + 1e-11:
        raise MethodFailure("the solver does not converge")
    guess[others] = x
    return guess


def _extrapolate(solved: list[np.ndarray]) -> np.ndarray:
    """The next of equally spaced points by the polynomial through the last four."""
    count = min(len(solved), len(WEIGHTS))
    weights = np.array(WEIGHTS[count - 1], dtype=float)
    return np.asarray(weights @ np.array(solved[-count:]))


def _along(values: np.ndarray, solved: np.ndarray) -> CubicSpline:
    travelled = (values - values[0]) / (values[-1] - values[0])
    return CubicSpline(travelled, solved)
