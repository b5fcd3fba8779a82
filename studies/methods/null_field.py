"""Integrating the field of null vectors, du/ds = t(u), with the solvers of
`scipy.integrate`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import DOP853, LSODA, RK45, OdeSolution, OdeSolver

from bifurc import Problem
from studies.methods.curve import Curve, MethodFailure
from studies.methods.linear import evaluate, solve_bordered

SOLVERS: dict[str, Callable[..., OdeSolver]] = {
    "RK45": RK45,
    "DOP853": DOP853,
    "LSODA": LSODA,
}


def integrate_null_field(
    problem: Problem,
    start: np.ndarray,
    tangent: np.ndarray,
    length: float,
    tolerance: float,
    solver: str,
    projected: bool,
    longest: float = np.inf,
) -> Curve:
    """The curve as the solver's own dense output, with relative and absolute tolerance
    ``tolerance``.

    ``projected``: after every step the point is put back on the curve by Newton's
    method, and the step ends there. The null vector comes from the bordered system with
    the last one as border: one factorisation a stage, less than an SVD, and the sign is
    right by itself.
    """
    last = tangent.copy()

    def field(_: float, u: np.ndarray) -> np.ndarray:
        residual, jacobian = evaluate(problem, u)
        right = np.zeros((len(residual) + 1, 1))
        right[-1] = 1.0
        t = solve_bordered(jacobian, last, right)[:, 0]
        t /= np.linalg.norm(t)
        last[:] = t
        return t

    allowed = max(tolerance, 1e-13)
    ode = SOLVERS[solver](
        field,
        0.0,
        start,
        length,
        rtol=max(allowed, 3e-14),
        atol=allowed,
        max_step=longest,
    )
    times = [0.0]
    pieces = []
    while ode.status == "running":
        message = ode.step()
        if ode.status == "failed":
            raise MethodFailure(str(message))
        pieces.append(ode.dense_output())
        times.append(ode.t)
        if projected:
            ode.y = _project(problem, ode.y, last, allowed)
            ode.f = field(ode.t, ode.y)
    solution = OdeSolution(times, pieces)
    return Curve(lambda s: solution(s).T, length, len(times))


def _project(
    problem: Problem, u: np.ndarray, tangent: np.ndarray, tolerance: float
) -> np.ndarray:
    """Newton's method across ``tangent``."""
    for _ in range(3):
        residual, jacobian = evaluate(problem, u)
        right = np.append(-residual, 0.0)[:, None]
        step = solve_bordered(jacobian, tangent, right)[:, 0]
        u = u + step
        if np.linalg.norm(step) < np.sqrt(tolerance) * 1e-2:
            break
    return u
