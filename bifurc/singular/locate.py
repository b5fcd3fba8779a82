"""The location of a singular point, where the rank of F' drops, by an augmented
system."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_located, is_simple, is_singular_point
from bifurc.numerics.null_spaces import newton_in_rank
from bifurc.numerics.singular_values import factors_of, values_of
from bifurc.system import (
    System,
    hessian_at,
    relative_gaps,
    relative_jacobians,
    relative_residuals,
)

ITERATIONS = 60
# Singular values of the augmented matrix, over its largest: what is smaller than the
# first is rounding, what is smaller than the second is a direction of slow convergence.
ROUNDING, WEAK = 1e-12, 1e-6
# Share of a weak direction that moves the point itself, and not only its null space:
# along a bent curve the null space turns many times as far.
MOVES_POINT = 0.01
# Condition of the augmented matrix at which convergence is no longer quadratic.
HIGHER_ORDER = 1e7
# Distance, over the reach, from which the iteration has to come back to a simple point,
# and how much shorter its second step then is than its first.
ASIDE, AT_ONCE = 0.1, 1e-2
# Error, over the condition of the matrix, to which that point and the curves through it
# are known.
KNOWN_TO = 2e-14
# Times the misclosure of the curves through it, or the doubt of its place: what may be
# missed at a singular point; but of that doubt no more than this counts.
MISSED, MOST_DOUBT = 10.0, 1e-8
# Times the residual counts: beside a near miss it is less than the singular value.
SHARP = 10.0
# |F| and singular value, over the magnitude, below which rounding hides the point.
HIDDEN = 1e-12
# Unknowns up to which the germ of the curves at a point is looked for, which takes longer
# to import than to locate the point: with two 0.6 s, with four 3.4 s, with eight 7 s.
MOST_FOR_GERM = 4
# Newton steps in the regular equations after the iteration: at a point of higher order its
# last steps are poor in these as well.
SETTLING = 2
TINY = 1e-300  # keeps a step of zero from being divided by


class LocatedPoint(NamedTuple):
    """A point ``u`` (n,) where F = 0 and F' has the ``null_space`` (n, k), and an
    estimate of its ``error``, the distance to the exact point; ``is_confirmed`` unless
    it was looked for in more digits and not found. It ``is_isolated`` among those of its
    kind where the equations for it and its null space have full rank."""

    u: np.ndarray
    null_space: np.ndarray
    error: float
    is_confirmed: bool = True
    is_isolated: bool = False


def locate_singular_point(
    problem: System,
    start: np.ndarray,
    nullity: int,
    reach: float,
    misclosure: float = 0.0,
) -> LocatedPoint | None:
    """The point near ``start`` where F = 0 and F' has a null space of dimension
    ``nullity``; None where the iteration does not converge or moves farther than
    ``reach``. On curves with a ``misclosure`` F = 0 to within that.

    Gauss-Newton on F(u) = 0, F'(u) V = 0, V^T V = I for the point and its null space
    together. Its matrix is regular at a simple singular point although F' is not. At a
    point of higher order the iteration converges linearly and to fewer digits, which
    the error says: the stretch that rounding hides is measured there, and its middle
    comes back.
    """
    run = _iterate(problem, start, nullity, reach)
    if run is None or not is_located(run.moves[-1], problem.domain.scale):
        return None
    u = newton_in_rank(problem, run.u[None], problem.n - nullity, SETTLING)[0]
    gap = float(relative_gaps(problem, u[None])[0])
    missed = SHARP * gap / _unit(SHARP * misclosure)
    largest_null = float(_largest_null_values(problem, u[None], nullity)[0])
    located = None
    if missed < is_singular_point.threshold:  # or else it is none, wherever it lies
        located = _with_error(problem, run, u, reach)
        if not np.isfinite(relative_gaps(problem, located.u[None])[0]):
            return None
        doubt = min(misclosure + located.error / problem.domain.scale, MOST_DOUBT)
        largest_null /= _unit(doubt)
    return located if is_singular_point(max(missed, largest_null)) else None


def _unit(doubt: float) -> float:
    """What is missed at a singular point is measured in this where it is in ``doubt``
    by so much."""
    return max(1.0, MISSED * doubt / is_singular_point.threshold)


# --- the iteration --------------------------------------------------------------------


class _Run(NamedTuple):
    """Where Gauss-Newton ended: the point ``u`` (n,) and ``basis`` (n, k) of its null
    space, the lengths of its ``moves``, the ``condition`` of the last matrix, and the
    ``weak`` directions (w, n) that it hardly determined."""

    u: np.ndarray
    basis: np.ndarray
    moves: list[float]
    condition: float
    weak: np.ndarray


class _Step(NamedTuple):
    """A step of Gauss-Newton for the point and its null space, and the numerical rank,
    the condition and the weak directions (w, n) of its matrix."""

    du: np.ndarray  # (n,)
    dv: np.ndarray  # (n, k)
    rank: int
    condition: float
    weak: np.ndarray


def _iterate(
    problem: System, start: np.ndarray, nullity: int, reach: float
) -> _Run | None:
    """Gauss-Newton on the augmented system until its steps are rounding or stagnate;
    None where it leaves the ``reach``, or comes to where F'' is not finite."""
    u = start.copy()
    jacobian = problem.jacobians(u[None])[0]
    _, _, right = factors_of(jacobian)
    basis = right[problem.n - nullity :].T
    moves: list[float] = []
    rank = 0
    condition = 0.0
    weak = np.empty((0, problem.n))
    for _ in range(ITERATIONS):
        step = _augmented_step(problem, u, basis)
        if step is None:
            return None
        weak = step.weak
        if step.rank < rank:
            break  # of higher order, and so near that the next step would be rounding
        rank, condition = step.rank, step.condition
        u = u + step.du
        basis = np.linalg.qr(basis + step.dv)[0]
        moves.append(float(np.linalg.norm(step.du)))
        if np.linalg.norm(problem.domain.difference(u, start)) > reach:
            return None
        is_rounding = moves[-1] < 1e-15 * min(condition, 1e6) * problem.domain.scale
        if is_rounding or _is_stagnant(moves, problem.domain.scale):
            break
    return _Run(u, basis, moves, condition, weak)


def _is_stagnant(moves: list[float], scale: float) -> bool:
    """Whether steps that are small already get no shorter."""
    if len(moves) <= 4 or moves[-1] <= 0.9 * moves[-2]:
        return False
    return moves[-1] < 1e-7 * scale


def _augmented_step(problem: System, u: np.ndarray, basis: np.ndarray) -> _Step | None:
    """The shortest step that solves the augmented system in the least-squares sense;
    None where that is not finite.

    The vectors dv_j stand in rows [F'' v_j du + F' dv_j; V^T dv_j] each, with one matrix
    A = [F'; V^T] before all of them. Where A is orthogonalised, what is left without any
    dv is a system for du, with the same least squares; as many singular values as it has
    are those of the whole, if du is measured together with the dv that it makes.
    """
    jacobian = relative_jacobians(problem, u[None])[0]
    residual = relative_residuals(problem, u[None])[0]
    bends = hessian_at(problem, u) @ basis / problem.magnitude
    bends = np.moveaxis(bends, 2, 0)  # F'' v_j: (k, m, n)
    if not (np.isfinite(jacobian).all() and np.isfinite(bends).all()):
        return None
    missed = (jacobian @ basis).T  # F' v_j: (k, m)
    turns = _Turns.of(jacobian, basis)
    along = turns.inverse @ bends  # -dv_j / du: (k, n, n)
    rows = np.concatenate([jacobian[None], turns.left.T @ bends], axis=None)
    sides = np.concatenate([residual, (missed @ turns.left).ravel()])
    unit = _unit_of_steps(along)
    found = _least_squares(rows.reshape(-1, len(u)) @ unit, -sides, turns)
    du = unit @ found.vector
    dv = -(missed @ turns.inverse.T + along @ du).T
    return _Step(du, dv, found.rank, found.condition, found.weak @ unit.T)


def _unit_of_steps(along: np.ndarray) -> np.ndarray:
    """The matrix (n, n) that takes vectors to steps du of a point which, together with
    what they make of its null space, ``along`` (k, n, n), are as long as these."""
    n = along.shape[2]
    together = np.concatenate([np.eye(n), along.reshape(-1, n)])
    unit: np.ndarray = np.linalg.inv(np.linalg.qr(together, mode="r"))
    return unit


class _Solution(NamedTuple):
    """A solution ``vector`` (n,) of least squares, with the numerical rank, the condition
    and the ``weak`` directions (w, n) of the matrix."""

    vector: np.ndarray
    rank: int
    condition: float
    weak: np.ndarray


def _least_squares(matrix: np.ndarray, sides: np.ndarray, turns: _Turns) -> _Solution:
    """The shortest solution of a system (r, n) whose matrix is one with that of null
    spaces."""
    left, sigma, right = np.linalg.svd(matrix, full_matrices=False)
    largest = float(sigma.max(initial=turns.largest))
    regular = sigma > ROUNDING * largest
    shares = (left[:, regular].T @ sides) / sigma[regular]
    return _Solution(
        vector=right[regular].T @ shares,
        rank=int(np.count_nonzero(regular)),
        condition=float(largest / sigma[regular].min(initial=turns.smallest)),
        weak=right[sigma < WEAK * largest],
    )


class _Turns(NamedTuple):
    """The matrix A = [F'; V^T] by its rows F': the ``left`` (m, r) null space of A, the
    ``inverse`` (n, m) of least squares, and the ``largest`` and ``smallest`` of its
    singular values that are not rounding."""

    left: np.ndarray
    inverse: np.ndarray
    largest: float
    smallest: float

    @staticmethod
    def of(jacobian: np.ndarray, basis: np.ndarray) -> _Turns:
        """Of F' (m, n) and V (n, k)."""
        m = len(jacobian)
        left, sigma, right = np.linalg.svd(np.vstack([jacobian, basis.T]))
        rank = int(np.count_nonzero(sigma > ROUNDING * sigma[0]))
        inverse = right[:rank].T / sigma[:rank] @ left[:m, :rank].T
        return _Turns(left[:m, rank:], inverse, sigma[0], sigma[rank - 1])


def _is_simple(problem: System, run: _Run, u: np.ndarray, reach: float) -> bool:
    """Whether the iteration comes back to a point (n,) at once from beside it.

    At a point of higher order it gains a constant factor in each step. Beside a surface
    the matrix is as badly conditioned, but only because F is small in all directions of
    the null space: a simple point is one there, too, and known to rounding times the
    condition.
    """
    away = ASIDE * min(reach, problem.domain.scale)
    k = run.basis.shape[1]
    aside = u + away * run.basis @ (np.ones(k) / np.sqrt(k))
    again = _iterate(problem, aside, k, 2 * reach)
    if again is None or len(again.moves) < 2:
        return False
    apart = np.linalg.norm(problem.domain.difference(again.u, u))
    allowed = AT_ONCE * away + KNOWN_TO * run.condition * problem.domain.scale
    slowness = again.moves[1] / (AT_ONCE * max(again.moves[0], TINY))
    return is_simple(max(slowness, float(apart) / allowed))


def _with_error(
    problem: System, run: _Run, u: np.ndarray, reach: float
) -> LocatedPoint:
    """The point ``u`` (n,) of a run, or the middle of the stretch on which rounding
    hides it, with its error."""
    if len(run.weak) and _is_simple(problem, run, u, reach):
        return LocatedPoint(
            u, run.basis, KNOWN_TO * run.condition * problem.domain.scale
        )
    nullity = run.basis.shape[1]
    error = _location_error(run.moves, run.condition) * problem.domain.scale
    for direction in run.weak:
        size = np.linalg.norm(direction)
        if size > MOVES_POINT:
            stretch = _hidden_stretch(problem, u, direction / size, nullity, reach)
            u = stretch.middle
            error = max(error, stretch.half_length)
    return LocatedPoint(u, run.basis, error, is_isolated=not len(run.weak))


# --- after the iteration --------------------------------------------------------------


def _largest_null_values(
    problem: System, points: np.ndarray, nullity: int
) -> np.ndarray:
    """The largest (k,) of the ``nullity`` smallest singular values of F' at points
    (k, n), over the magnitude."""
    jacobians = relative_jacobians(problem, points)
    sigma = values_of(jacobians)
    rank = problem.n - nullity
    if sigma.shape[1] <= rank:
        return np.zeros(len(points))
    return sigma[:, rank]


def _location_error(moves: list[float], condition: float) -> float:
    """Estimate of the distance left: rounding times the condition where convergence was
    quadratic; where it was linear, the rest of the geometric series, twice."""
    rounding = 1e-15 * condition
    last = moves[-1]
    ratio = 0.0
    if len(moves) > 1 and moves[-2] > 0:
        ratio = last / moves[-2]
    if last <= 10 * rounding and ratio < 0.1 and condition < HIGHER_ORDER:
        return rounding + last
    ratio = min(max(ratio, 0.5), 0.9)
    if condition < HIGHER_ORDER:
        return 2.0 * last * ratio / (1.0 - ratio) + rounding
    return 4.0 * last / (1.0 - ratio)


class _Stretch(NamedTuple):
    """A stretch along a line: its ``middle`` (n,) and half of its length."""

    middle: np.ndarray
    half_length: float


def _hidden_stretch(
    problem: System, u: np.ndarray, direction: np.ndarray, nullity: int, reach: float
) -> _Stretch:
    """The stretch through ``u`` along ``direction`` (n,) on which the singular point
    cannot be told from rounding: the exact point lies on it."""
    ahead = _hidden_length(problem, u, direction, nullity, reach)
    behind = _hidden_length(problem, u, -direction, nullity, reach)
    middle = u + 0.5 * (ahead - behind) * direction
    rank = problem.n - nullity
    middle = newton_in_rank(problem, middle[None], rank, SETTLING)[0]
    return _Stretch(middle, 0.5 * (ahead + behind))


def _hidden_length(
    problem: System, u: np.ndarray, direction: np.ndarray, nullity: int, reach: float
) -> float:
    """How far from ``u`` along ``direction`` (n,) rounding hides that a point is no
    singular point: up to ``reach``.

    A curve leaves the line as the square of the distance: it is looked at where the
    regular equations hold.
    """
    distances = reach * np.geomspace(1e-7, 1.0, 120)
    line = u + distances[:, None] * direction
    curve = newton_in_rank(problem, line, problem.n - nullity, SETTLING)
    gaps = relative_gaps(problem, curve)
    misfits = _largest_null_values(problem, curve, nullity) + gaps
    visible = np.flatnonzero(misfits > HIDDEN)
    if not len(visible):
        return reach
    return float(distances[visible[0]])
