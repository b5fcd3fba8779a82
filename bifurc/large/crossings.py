"""Simple singular points of a large problem, where the rank of F' drops by one: located
with doubly bordered systems, and the directions of the curves through them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.smallest_singular_values import SingularTriple

__all__ = ["LocatedCrossing", "locate_crossing"]

STEPS = 12
SETTLED = 1e-9  # a step after which the next one, its square, would be rounding
STAGNANT = 0.5  # times the step before: a short step that is no shorter is rounding
SHORT = 1e-6
NO_FORM = 1e-12  # of a quadratic form, over its largest value: no direction is told


class LocatedCrossing(NamedTuple):
    """A ``point`` (n,) where F' has the null space ``basis`` (n, 2) and F misses by
    ``gap``, over the magnitude, along the left null vector.

    ``form`` (2, 2) is the quadratic form w^T F''(V x, V x) of the tangents V x of all
    curves through it.
    """

    point: np.ndarray
    basis: np.ndarray
    gap: float
    form: np.ndarray


def locate_crossing(
    problem: ScaledProblem,
    start: np.ndarray,
    tangent: np.ndarray,
    triple: SingularTriple,
) -> LocatedCrossing | None:
    """The singular point near ``start`` (n,), a point with a ``tangent`` (n,) and a small
    singular ``triple``; None where the iteration does not settle.

    With b the left vector and C the tangent and the right vector of the start,

        N = [F' b; C 0],   N [V; g] = [0; I],   N^T [w; .] = [0; 1],

    F' has a null space of two dimensions where both components of g are zero, and
    g'(x) = -w^T F''(V, x). One equation more than there are unknowns is made up for by
    a multiple of b (Govaerts 2000): F + beta b = 0 and g = 0 are solved, and beta is by
    how much F misses a crossing.
    """
    point, beta = start, 0.0
    rows = np.stack([tangent, triple.right])
    before = np.inf
    for _ in range(STEPS):
        step = _step(problem, point, beta, rows, triple.left)
        length = float(np.linalg.norm(step.change))
        if not length < 1.0:
            return None
        point, beta = point + step.change, step.beta
        is_rounding = length < SHORT and length > STAGNANT * before
        if length < SETTLED or is_rounding:
            basis, turn = np.linalg.qr(step.basis)
            back = np.linalg.inv(turn)
            return LocatedCrossing(point, basis, abs(beta), back.T @ step.form @ back)
        before = length
    return None


class _Step(NamedTuple):
    """The ``change`` (n,) of a point, the next ``beta``, and V (n, 2) and the quadratic
    form (2, 2) at the point before."""

    change: np.ndarray
    beta: float
    basis: np.ndarray
    form: np.ndarray


def _step(
    problem: ScaledProblem,
    point: np.ndarray,
    beta: float,
    rows: np.ndarray,
    column: np.ndarray,
) -> _Step:
    """A step of Newton's method on F + beta b = 0, g = 0."""
    n = problem.n
    system = problem.bordered(point, rows, column[:, None])
    first_unit, second_unit = np.zeros(n + 1), np.zeros(n + 1)
    first_unit[-2] = second_unit[-1] = 1.0
    units = (first_unit, second_unit)
    solved = np.column_stack([system.solve(unit) for unit in units])
    basis, g = solved[:n], solved[n]
    left = system.solve_transposed(second_unit)[: n - 1]
    residual = problem.relative_residuals(point[None])[0] + beta * column
    across = system.solve(np.concatenate([-residual, [0.0, 0.0]]))
    first, second = basis.T
    mixed = left @ problem.second_derivative(point, first, second)
    form = np.array(
        [
            [left @ problem.second_derivative(point, first, first), mixed],
            [mixed, left @ problem.second_derivative(point, second, second)],
        ]
    )
    by_across = np.array(
        [left @ problem.second_derivative(point, across[:n], one) for one in basis.T]
    )
    shares, *_ = np.linalg.lstsq(form, g - by_across, rcond=NO_FORM)
    change = across[:n] + basis @ shares
    return _Step(change, beta + across[n] + float(g @ shares), basis, form)
