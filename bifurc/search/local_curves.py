"""The branches next to a singular point, known from its germ, as curves in pieces."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.numerics.collocation import piece_through
from bifurc.problem import Problem
from bifurc.search.branch_parts import with_piece_between
from bifurc.singular.germ import Germ
from bifurc.singular.local_branches import LocalBranch

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
    pieces, lengths, residuals = [], [], []
    powers = CHECKS[:, None] ** np.arange(order + 1)
    for begin, end in pairwise(edges):
        middle, half = 0.5 * (begin + end), 0.5 * (end - begin)

        def points(
            x: np.ndarray, middle: float = middle, half: float = half
        ) -> np.ndarray:
            places: np.ndarray = branch(middle + half * x)
            return places

        piece = piece_through(points, order)
        coefficients = piece.coefficients
        coefficients[0] += germ.u
        pieces.append(coefficients)
        lengths.append(piece.length)
        residuals.append(float(problem.gaps(powers @ coefficients).max()))
    breaks = np.concatenate([[0.0], np.cumsum(lengths)])
    return Branch(
        pieces=np.array(pieces),
        centers=0.5 * (breaks[:-1] + breaks[1:]),
        radii=0.5 * np.diff(breaks),
        breaks=breaks,
        residuals=np.array(residuals),
        periods=problem.periods,
        outcome=Outcome.STALLED,
    )
