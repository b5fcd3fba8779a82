"""Singular points of a large problem, where the rank of F' drops by one or by more at
once: located with bordered systems, and the forms of the tangents there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.smallest_singular_values import SingularTriple

STEPS = 12
SETTLED = 1e-9  # a step after which the next one, its square, would be rounding
STAGNANT = 0.5  # times the step before: a short step that is no shorter is rounding
SHORT = 1e-6
NO_FORM = 1e-12  # of quadratic forms, over their largest value: no direction is told


class LocatedCrossing(NamedTuple):
    """A ``point`` (n,) where F' has the null space ``basis`` (n, q + 1) and the left null
    space ``left`` (q, n - 1), and F misses by ``gap``, over the magnitude, along that.

    ``forms`` (q, q + 1, q + 1) are the quadratic forms w^T F''(V x, V x) of the tangents
    V x of all curves through it. ``regular`` is the largest of the q singular values
    that is left there, about, over the magnitude.
    """

    point: np.ndarray
    basis: np.ndarray
    left: np.ndarray
    gap: float
    forms: np.ndarray
    regular: float

    @property
    def multiplicity(self) -> int:
        """By how much the rank drops, q."""
        return len(self.left)


def locate_crossing(
    problem: ScaledProblem,
    start: np.ndarray,
    tangent: np.ndarray,
    triples: Sequence[SingularTriple],
) -> LocatedCrossing | None:
    """The singular point near ``start`` (n,), a point with a ``tangent`` (n,) and q small
    singular ``triples``, where all of these are zero; None where the iteration does not
    settle.

    With B the left vectors and C the tangent and the right vectors of the start,

        N = [F' B; C 0],   N [V; G] = [0; I],   N^T [W; .] = [0; I],

    F' has a null space of q + 1 dimensions where G (q, q + 1) is zero, and
    G_ij'(x) = -w_i^T F''(v_j, x). There are q more equations F = 0 than a curve through a
    singular point has, which is made up for by multiples of B (Govaerts 2000):
    F + B beta = 0 and G = 0 are solved, and beta is by how much F misses a crossing.
    For q > 1 there are more equations G = 0 than unknowns, which agree with each other
    where the rank does drop by q, and are solved by least squares.
    """
    count = len(triples)
    point, beta = start, np.zeros(count)
    rows = np.stack([tangent, *(triple.right for triple in triples)])
    columns = np.column_stack([triple.left for triple in triples])
    before = np.inf
    for _ in range(STEPS):
        step = _step(problem, point, beta, rows, columns)
        length = float(np.linalg.norm(step.change))
        if not length < 1.0:
            return None
        point, beta = point + step.change, step.beta
        is_rounding = length < SHORT and length > STAGNANT * before
        if length < SETTLED or is_rounding:
            return _located(point, step)
        before = length
    return None


class _Step(NamedTuple):
    """The ``change`` (n,) of a point, the next ``beta`` (q,), and V (n, q + 1), W (q,
    n - 1), G (q, q + 1) and the quadratic forms (q, q + 1, q + 1) at the point
    before."""

    change: np.ndarray
    beta: np.ndarray
    basis: np.ndarray
    left: np.ndarray
    regular: np.ndarray
    forms: np.ndarray


def _located(point: np.ndarray, step: _Step) -> LocatedCrossing:
    """What a settled iteration has come to, with an orthonormal basis."""
    basis, turn = np.linalg.qr(step.basis)
    back = np.linalg.inv(turn)
    return LocatedCrossing(
        point=point,
        basis=basis,
        left=step.left,
        gap=float(np.linalg.norm(step.beta)),
        forms=back.T @ step.forms @ back,
        regular=float(np.linalg.norm(step.regular, ord=2)),
    )


def _step(
    problem: ScaledProblem,
    point: np.ndarray,
    beta: np.ndarray,
    rows: np.ndarray,
    columns: np.ndarray,
) -> _Step:
    """A step of Newton's method on F + B beta = 0, G = 0."""
    n, q = problem.n, columns.shape[1]
    system = problem.bordered(point, rows, columns)
    below = [_unit(n + q, k) for k in range(n - 1, n + q)]
    beside = [_unit(n + q, k) for k in range(n, n + q)]
    solved = np.column_stack([system.solve(unit) for unit in below])
    basis, g = solved[:n], solved[n:]
    left = np.stack([system.solve_transposed(unit)[: n - 1] for unit in beside])
    residual = problem.relative_residuals(point[None])[0] + columns @ beta
    across = system.solve(np.concatenate([-residual, np.zeros(q + 1)]))
    changes = [problem.second_derivative(point, one, basis) for one in basis.T]
    forms = np.stack([left @ change for change in changes], axis=1)  # (q, q + 1, q + 1)
    forms = 0.5 * (forms + np.swapaxes(forms, 1, 2))
    by_across = left @ problem.second_derivative(point, across[:n], basis)
    wanted = (g - by_across).ravel()
    shares, *_ = np.linalg.lstsq(forms.reshape(-1, q + 1), wanted, rcond=NO_FORM)
    change = across[:n] + basis @ shares
    return _Step(change, beta + across[n:] + g @ shares, basis, left, g, forms)


def _unit(size: int, k: int) -> np.ndarray:
    """Unit vector number ``k`` of so many."""
    unit = np.zeros(size)
    unit[k] = 1.0
    return unit
