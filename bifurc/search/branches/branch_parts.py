"""Branches cut into parts, parts joined to branches, and the curves between them.

At the origin of x^3 = y^4 a single branch passes, continuous with its tangent, whose
curvature is infinite there: no Taylor series reaches it, and the trace from either side
stalls before the point or a little beyond it. There F is so flat that a short polynomial
through the point solves the equations to rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_same_point, is_solution
from bifurc.numerics.collocation import piece_through, reparametrised
from bifurc.problem import Problem
from bifurc.singular.point import SingularPoint
from bifurc.system import Piece, relative_gaps

if TYPE_CHECKING:
    # they import mpmath, which most searches do not need
    from bifurc.singular.germ import Germ
    from bifurc.singular.local_branches import LocalBranch

WITHIN = np.linspace(-1.0, 1.0, 17)  # of the piece between, where it is checked


def part_of(branch: Branch, begin: float, end: float) -> Branch:
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


def with_piece_between(
    problem: Problem,
    point: np.ndarray,
    before: Branch,
    after: Branch,
    outcome: Outcome,
) -> Branch | None:
    """Two branches with a polynomial through a ``point`` (n,) between them, or one closed
    by it; None where that is no solution. Its order is 4 where theirs is lower."""
    order = max(before.pieces.shape[1] - 1, 4)
    begin, end = before(before.length), after(0.0)
    shift = problem.domain.difference(end, begin) - (end - begin)  # whole periods
    chord = end + shift - begin
    half = 0.5 * float(np.linalg.norm(chord))
    slopes = half * before(before.length, 1), half * after(0.0, 1)
    cubic = np.zeros((order + 1, before.n))
    cubic[0] = begin + 0.5 * chord + 0.25 * (slopes[0] - slopes[1])
    cubic[1] = 0.75 * chord - 0.25 * (slopes[0] + slopes[1])
    cubic[2] = 0.25 * (slopes[1] - slopes[0])
    cubic[3] = 0.25 * (slopes[0] + slopes[1]) - 0.25 * chord
    # (1 - t^2)^2 leaves ends and slopes, and the middle goes to the point
    aside = problem.domain.difference(point, cubic[0])
    quartic = cubic.copy()
    quartic[[0, 2, 4]] += np.outer([1.0, -2.0, 1.0], aside)
    piece, length = reparametrised(quartic)
    powers = WITHIN[:, None] ** np.arange(order + 1)
    residual = float(relative_gaps(problem, powers @ piece).max())
    if not is_solution(residual):
        return None
    closing = branch_of_pieces(
        [Piece(piece, length, residual)], before.periods, outcome
    )
    closed = followed_by(before, closing, np.zeros(before.n))
    if outcome is Outcome.CLOSED:
        return closed
    return replace(followed_by(closed, after, shift), outcome=outcome)


def branch_of_pieces(
    pieces: Sequence[Piece], periods: np.ndarray, outcome: Outcome
) -> Branch:
    """The branch of polynomial pieces that lie end to end."""
    lengths = np.array([piece.length for piece in pieces])
    breaks = np.concatenate([[0.0], np.cumsum(lengths)])
    return Branch(
        pieces=np.array([piece.coefficients for piece in pieces]),
        centers=breaks[:-1] + 0.5 * lengths,
        radii=0.5 * lengths,
        breaks=breaks,
        residuals=np.array([piece.residual for piece in pieces]),
        periods=periods,
        outcome=outcome,
    )


def followed_by(one: Branch, other: Branch, shift: np.ndarray) -> Branch:
    """A branch and after it another one, moved by a ``shift`` (n,)."""
    rows = max(one.pieces.shape[1], other.pieces.shape[1])
    before, after = _padded(one.pieces, rows), _padded(other.pieces, rows)
    after[:, 0] += shift
    return replace(
        other,
        pieces=np.concatenate([before, after]),
        centers=np.concatenate([one.centers, other.centers + one.length]),
        radii=np.concatenate([one.radii, other.radii]),
        breaks=np.concatenate([one.breaks, other.breaks[1:] + one.length]),
        residuals=np.concatenate([one.residuals, other.residuals]),
    )


def _padded(pieces: np.ndarray, rows: int) -> np.ndarray:
    """The same polynomials (k, rows, n), with zeros for the higher coefficients."""
    missing = rows - pieces.shape[1]
    return np.pad(pieces, ((0, 0), (0, missing), (0, 0)))


def joined_outcome(problem: Problem, before: Branch, after: Branch) -> Outcome:
    """How a branch ends that has the begin of one and the end of another."""
    ends = np.array([before(0.0), after(after.length)])
    gaps = np.abs(ends[:, :, None] - problem.domain.bounds).min(axis=(1, 2))
    is_at_bounds = is_same_point(gaps, problem.domain.scale)
    return Outcome.LEFT_REGION if np.all(is_at_bounds) else Outcome.STALLED


BEYOND = 1.5  # times the farther end: so far from the point both branches are cut
LOOKS = 400  # along a branch for the place of the cut


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
    gaps = np.linalg.norm(problem.domain.difference(ends, point.u), axis=1)
    clear = max(BEYOND * float(gaps.max()), 2 * point.error)
    last = _clear_of(problem, point, before.reversed(), clear)
    first = _clear_of(problem, point, after, clear)
    if last is None or first is None:
        return None
    if is_loop:
        before = part_of(before, first, before.length - last)
        return with_piece_between(problem, point.u, before, before, Outcome.CLOSED)
    before = part_of(before, 0.0, before.length - last)
    after = part_of(after, first, after.length)
    outcome = joined_outcome(problem, before, after)
    return with_piece_between(problem, point.u, before, after, outcome)


def _clear_of(
    problem: Problem, point: SingularPoint, branch: Branch, distance: float
) -> float | None:
    """The arclength from the begin of a branch from which on it is farther than a
    ``distance`` from a point; None where it is too short."""
    places = np.linspace(0.0, min(10 * distance, branch.length), LOOKS)
    gaps = problem.domain.difference(branch(places), point.u)
    is_clear = np.linalg.norm(gaps, axis=1) > distance
    return float(places[np.argmax(is_clear)]) if np.any(is_clear) else None


PARTS = 8  # of a branch that is smooth at the point, each a piece
# Towards a point at which it is not every piece is shorter by this factor, down to a
# share of the way to the end.
SHORTER, SHORTEST = 0.6, 1e-7
CHECKS = np.linspace(-1.0, 1.0, 9)  # of a piece, where its residual is seen


def half_curve(problem: Problem, germ: Germ, half: int, order: int) -> Branch:
    """The half-branch of a number, from where it ends into the point."""
    branch = germ.neighbourhood.branch_of(half)
    side = branch.side(half)
    edges = [*_shrinking(branch.ramification), 0.0]
    return _curve(problem, germ, branch, side * np.array(edges), order)


def curve_through(problem: Problem, germ: Germ, half: int, order: int) -> Branch | None:
    """The branch that a half-branch of a number belongs to, from where that ends through
    the point; None where no polynomial leads across the point."""
    branch = germ.neighbourhood.branch_of(half)
    side = branch.side(half)
    if branch.ramification == 1:
        edges = np.linspace(side, -side, PARTS + 1)
        return _curve(problem, germ, branch, edges, order)
    shrinking = np.array(_shrinking(branch.ramification))
    before = _curve(problem, germ, branch, side * shrinking, order)
    after = _curve(problem, germ, branch, -side * shrinking[::-1], order)
    return with_piece_between(problem, germ.u, before, after, Outcome.STALLED)


def _shrinking(ramification: int) -> list[float]:
    """s from 1 down to where x is negligible."""
    shares = [1.0]
    while shares[-1] ** ramification > SHORTEST:
        shares.append(SHORTER * shares[-1])
    return shares


def _curve(
    problem: Problem,
    germ: Germ,
    branch: LocalBranch,
    edges: Sequence[float] | np.ndarray,
    order: int,
) -> Branch:
    """The curve of pieces of an ``order`` between places s = ``edges`` (k + 1,) of a
    branch."""
    pieces = []
    powers = CHECKS[:, None] ** np.arange(order + 1)
    for begin, end in pairwise(edges):
        middle, half = 0.5 * (begin + end), 0.5 * (end - begin)

        def points(
            x: np.ndarray, middle: float = middle, half: float = half
        ) -> np.ndarray:
            return branch(middle + half * x)

        # so short that places beside the point would be rounded off elsewhere
        piece = piece_through(points, order)
        piece.coefficients[0] += germ.u
        residual = float(relative_gaps(problem, powers @ piece.coefficients).max())
        pieces.append(replace(piece, residual=residual))
    return branch_of_pieces(pieces, problem.domain.periods, Outcome.STALLED)
