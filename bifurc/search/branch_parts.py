"""Branches cut into parts, and parts joined to branches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_same_point, is_solution
from bifurc.numerics.collocation import reparametrised
from bifurc.problem import Problem

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
    shift = problem.difference(end, begin) - (end - begin)  # whole periods
    chord = end + shift - begin
    half = 0.5 * float(np.linalg.norm(chord))
    slopes = half * before(before.length, 1), half * after(0.0, 1)
    cubic = np.zeros((order + 1, before.n))
    cubic[0] = begin + 0.5 * chord + 0.25 * (slopes[0] - slopes[1])
    cubic[1] = 0.75 * chord - 0.25 * (slopes[0] + slopes[1])
    cubic[2] = 0.25 * (slopes[1] - slopes[0])
    cubic[3] = 0.25 * (slopes[0] + slopes[1]) - 0.25 * chord
    # (1 - t^2)^2 leaves ends and slopes, and the middle goes to the point
    aside = problem.difference(point, cubic[0])
    quartic = cubic.copy()
    quartic[[0, 2, 4]] += np.outer([1.0, -2.0, 1.0], aside)
    piece, length = reparametrised(quartic)
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
    closed = followed_by(before, closing, np.zeros(before.n))
    if outcome is Outcome.CLOSED:
        return closed
    return replace(followed_by(closed, after, shift), outcome=outcome)


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
    gaps = np.abs(ends[:, :, None] - problem.bounds).min(axis=(1, 2))
    is_at_bounds = is_same_point(gaps, problem.scale)
    return Outcome.LEFT_REGION if np.all(is_at_bounds) else Outcome.STALLED
