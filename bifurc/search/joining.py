"""A branch through a point at which it is continuous with its tangent, but not smooth.

At the origin of x^3 = y^4 a single branch passes, whose curvature is infinite there: no
Taylor series reaches it, and the trace from either side stalls before the point or a
little beyond it. There F is so flat that a short polynomial through the point solves
the equations to rounding.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_same_point, is_solution
from bifurc.numerics.collocation import reparametrised
from bifurc.problem import Problem
from bifurc.singular.point import SingularPoint

__all__ = ["joined_through"]

BEYOND = 1.5  # times the farther end: so far from the point both branches are cut
LOOKS = 400  # along a branch for the place of the cut
WITHIN = np.linspace(-1.0, 1.0, 17)  # of the piece between, where it is checked


def joined_through(
    problem: Problem,
    point: SingularPoint,
    one: tuple[Branch, float],
    other: tuple[Branch, float],
) -> Branch | None:
    """The branch that two branches are, which end at a point at the arclengths given
    with them, or the closed curve of one branch that ends there twice; None where what
    lies between them does not solve the equations."""
    is_loop = one[0] is other[0]
    before = one[0] if one[1] > 0.0 else one[0].reversed()
    after = other[0] if other[1] == 0.0 else other[0].reversed()
    ends = np.array([before(before.length), after(0.0)])
    gaps = np.linalg.norm(problem.difference(ends, point.u), axis=1)
    clear = max(BEYOND * float(gaps.max()), 2 * point.error)
    last = _clear_of(problem, point, before.reversed(), clear)
    first = _clear_of(problem, point, after, clear)
    if last is None or first is None:
        return None
    if is_loop:
        before = _part(before, first, before.length - last)
        return _with_piece(problem, point, before, before, Outcome.CLOSED)
    before = _part(before, 0.0, before.length - last)
    after = _part(after, first, after.length)
    outcome = _outcome(problem, before, after)
    return _with_piece(problem, point, before, after, outcome)


def _clear_of(
    problem: Problem, point: SingularPoint, branch: Branch, distance: float
) -> float | None:
    """The arclength from the begin of a branch from which on it is farther than a
    ``distance`` from a point; None where it is too short."""
    places = np.linspace(0.0, min(10 * distance, branch.length), LOOKS)
    gaps = problem.difference(branch(places), point.u)
    is_clear = np.linalg.norm(gaps, axis=1) > distance
    return float(places[np.argmax(is_clear)]) if np.any(is_clear) else None


def _part(branch: Branch, begin: float, end: float) -> Branch:
    """The part of a branch between two arclengths."""
    first = int(np.searchsorted(branch.breaks, begin, side="right")) - 1
    last = int(np.searchsorted(branch.breaks, end, side="left"))
    kept = slice(first, last)
    inner = branch.breaks[first + 1 : last]
    return replace(
        branch,
        pieces=branch.pieces[kept],
        centers=branch.centers[kept] - begin,
        radii=branch.radii[kept],
        breaks=np.concatenate([[0.0], inner - begin, [end - begin]]),
        residuals=branch.residuals[kept],
    )


def _with_piece(
    problem: Problem,
    point: SingularPoint,
    before: Branch,
    after: Branch,
    outcome: Outcome,
) -> Branch | None:
    """Two branches with a polynomial through a point between them, or one closed by it;
    None where that is no solution."""
    order = before.pieces.shape[1] - 1
    begin, end = before(before.length), after(0.0)
    shift = problem.difference(end, begin) - (end - begin)  # whole periods
    chord = end + shift - begin
    half = 0.5 * float(np.linalg.norm(chord))
    slopes = half * before(before.length, 1), half * after(0.0, 1)
    cubic = np.zeros((order + 1, before.n))
    cubic[0] = begin + 0.5 * chord + 0.25 * (slopes[0] - slopes[1])
    cubic[1] = 0.75 * chord - 0.25 * (slopes[0] + slopes[1])
    cubic[2] = 0.25 * (slopes[1] - slopes[0])
    cubic[3] = 0.25 * (slopes[0] + slopes[1]) - 0.25 * chord
    if order >= 4:
        # (1 - t^2)^2 leaves ends and slopes, and the middle goes to the point
        aside = problem.difference(point.u, cubic[0])
        cubic[[0, 2, 4]] += np.outer([1.0, -2.0, 1.0], aside)
    piece, length = reparametrised(cubic)
    powers = WITHIN[:, None] ** np.arange(order + 1)
    residual = float(problem.gaps(powers @ piece).max())
    if not is_solution(residual):
        return None
    closing = Branch(
        pieces=piece[None],
        centers=np.array([0.5 * length]),
        radii=np.array([0.5 * length]),
        breaks=np.array([0.0, length]),
        residuals=np.array([residual]),
        periods=before.periods,
        outcome=outcome,
    )
    closed = _followed_by(before, closing, np.zeros(before.n))
    if outcome is Outcome.CLOSED:
        return closed
    return replace(_followed_by(closed, after, shift), outcome=outcome)


def _followed_by(one: Branch, other: Branch, shift: np.ndarray) -> Branch:
    """A branch and after it another one, moved by a ``shift`` (n,)."""
    pieces = other.pieces.copy()
    pieces[:, 0] += shift
    return replace(
        other,
        pieces=np.concatenate([one.pieces, pieces]),
        centers=np.concatenate([one.centers, other.centers + one.length]),
        radii=np.concatenate([one.radii, other.radii]),
        breaks=np.concatenate([one.breaks, other.breaks[1:] + one.length]),
        residuals=np.concatenate([one.residuals, other.residuals]),
    )


def _outcome(problem: Problem, before: Branch, after: Branch) -> Outcome:
    """How a branch ends that has the begin of one and the end of another."""
    ends = np.array([before(0.0), after(after.length)])
    gaps = np.abs(ends[:, :, None] - problem.bounds).min(axis=(1, 2))
    is_at_bounds = is_same_point(gaps, problem.scale)
    return Outcome.LEFT_REGION if np.all(is_at_bounds) else Outcome.STALLED
