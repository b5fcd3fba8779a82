"""Folds and singular points of a large problem, located by Newton's method with bordered
systems alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from bifurc.large.scaled_problem import ScaledProblem
from bifurc.large.singular_triples import SingularTriple
from bifurc.system import relative_gaps, relative_residuals

T = TypeVar("T")

STEPS = 12
SETTLED = 1e-9  # a step after which the next one, its square, would be rounding
STAGNANT = 0.5  # times the step before: a short step that is no shorter is rounding
SHORT = 1e-6
NO_FORM = 1e-12  # of quadratic forms, over their largest value: no direction is told


# --- folds ----------------------------------------------------------------------------


class LocatedFold(NamedTuple):
    """A fold at ``point`` (n,), the second derivative ``bend`` of the parameter in the
    arclength, and what is left of F, the ``gap``."""

    point: np.ndarray
    bend: float
    gap: float


def locate_fold(
    problem: ScaledProblem, start: np.ndarray, tangent: np.ndarray
) -> LocatedFold | None:
    """The fold near ``start`` (n,), a point with about the ``tangent`` (n,); None where
    the iteration does not settle.

    Solved are F = 0 and h = 0, h the parameter's component of the tangent. With the
    matrix M of F' and the row ``tangent`` under it

        M d = [-F; 0],  M t = [0; 1],  M t'(x) = [-F''(t, x); 0],

    the step is d + a t with h + h'(d) + a h'(t) = 0: four systems with one matrix, no
    transpose, and F' without the parameter's column may be singular, as it is at the
    fold.
    """

    def step_at(point: np.ndarray) -> tuple[np.ndarray, float]:
        system = problem.bordered(point, tangent[None])
        residual = relative_residuals(problem, point[None])[0]
        across = system.solve(np.append(-residual, 0.0))
        along = system.solve(_unit(problem.n, problem.n - 1))

        def change(direction: np.ndarray) -> float:
            curved = problem.second_derivative(point, direction, along)
            return float(system.solve(np.append(-curved, 0.0))[-1])

        slope = change(along)
        share = -(along[-1] + change(across)) / slope if slope else np.inf
        return across + share * along, slope / float(along @ along)

    end = _by_newton(step_at, start, problem.n)
    if end is None:
        return None
    point, bend = end
    return LocatedFold(point, bend, float(relative_gaps(problem, point[None])[0]))


def _by_newton(
    step_at: Callable[[np.ndarray], tuple[np.ndarray, T]], start: np.ndarray, n: int
) -> tuple[np.ndarray, T] | None:
    """Where steps from ``start`` (k,) settle, as the lengths of their first ``n`` entries
    tell, and what ``step_at`` says besides of the last of them; None where they do
    not."""
    values = start
    before = np.inf
    for _ in range(STEPS):
        step, facts = step_at(values)
        length = float(np.linalg.norm(step[:n]))
        if not length < 1.0:
            return None
        values = values + step
        is_rounding = length < SHORT and length > STAGNANT * before
        if length < SETTLED or is_rounding:
            return values, facts
        before = length
    return None


# --- singular points ------------------------------------------------------------------


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
    n, q = problem.n, len(triples)
    rows = np.stack([tangent, *(triple.right for triple in triples)])
    columns = np.column_stack([triple.left for triple in triples])

    step_at = partial(_crossing_step, problem, rows, columns)
    end = _by_newton(step_at, np.append(start, np.zeros(q)), n)
    if end is None:
        return None
    values, null = end
    basis, turn = np.linalg.qr(null.basis)
    back = np.linalg.inv(turn)
    return LocatedCrossing(
        point=values[:n],
        basis=basis,
        left=null.left,
        gap=float(np.linalg.norm(values[n:])),
        forms=back.T @ null.forms @ back,
        regular=float(np.linalg.norm(null.g, ord=2)),
    )


def _crossing_step(
    problem: ScaledProblem, rows: np.ndarray, columns: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, _NullSpace]:
    """The step (n + q,) from x and beta, ``values`` (n + q,), with C ``rows`` (q + 1, n)
    and B ``columns`` (n - 1, q), and the null space at x."""
    n, q = problem.n, columns.shape[1]
    point, beta = values[:n], values[n:]
    system = problem.bordered(point, rows, columns)
    solved = np.column_stack(
        [system.solve(_unit(n + q, k)) for k in range(n - 1, n + q)]
    )
    left = [system.solve_transposed(_unit(n + q, k)) for k in range(n, n + q)]
    null = _null_space(problem, point, solved, np.stack(left))
    # to F + B beta = 0 first, and then along the null space to G = 0
    residual = relative_residuals(problem, point[None])[0] + columns @ beta
    across = system.solve(np.concatenate([-residual, np.zeros(q + 1)]))
    bends = problem.second_derivative(point, across[:n], null.basis)
    wanted = (null.g - null.left @ bends).ravel()
    forms = null.forms.reshape(-1, q + 1)
    shares, *_ = np.linalg.lstsq(forms, wanted, rcond=NO_FORM)
    return across + solved @ shares, null


class _NullSpace(NamedTuple):
    """V (n, q + 1), W (q, n - 1), G (q, q + 1) and the quadratic forms (q, q + 1, q + 1)
    at a point."""

    basis: np.ndarray
    left: np.ndarray
    g: np.ndarray
    forms: np.ndarray


def _null_space(
    problem: ScaledProblem, point: np.ndarray, solved: np.ndarray, left: np.ndarray
) -> _NullSpace:
    """The null space at a point (n,) from [V; G] (n + q, q + 1) and [W, .] (q, n + q)."""
    n = problem.n
    basis, g = solved[:n], solved[n:]
    left = left[:, : n - 1]
    changes = [problem.second_derivative(point, one, basis) for one in basis.T]
    forms = np.stack([left @ change for change in changes], axis=1)
    return _NullSpace(basis, left, g, 0.5 * (forms + np.swapaxes(forms, 1, 2)))


def _unit(size: int, k: int) -> np.ndarray:
    """Unit vector number ``k`` of so many."""
    unit = np.zeros(size)
    unit[k] = 1.0
    return unit
