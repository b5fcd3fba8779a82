"""Where solutions beside a traced curve are unique: samples with the balls that hold
one arc each.

The theorem stands in `bifurc.curves.certificate`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from bifurc.branch import Branch
from bifurc.numerics.null_spaces import TINY, decompose
from bifurc.problem import Problem

__all__ = ["SHARE", "Samples", "sample_curve"]

# of sigma / K: how far neighbouring points may be apart
SHARE = 1.0 / (2.0 * np.sqrt(2.0))
CORRECTIONS = 2  # of a point whose residual leaves it in doubt
DOUBT = 0.05  # of the ball: a solution in doubt by more is corrected
ROUNDING = 2e-15  # what F, over the magnitude, may be wrong by in doubles


@dataclass(frozen=True)
class Samples:
    """Solutions beside the traced curve at arclengths ``s`` (k,).

    ``points`` (k, n), the curve's ``tangents`` (k, n), orthonormal bases of the ranges
    of F', ``left`` (k, m, n - 1), and of F'^T, ``right`` (k, n - 1, n). A ``ball`` (k,)
    around each holds one arc, and the solution itself is ``offset`` (k,) or less from
    the point. Where F' is singular to within rounding the sample is ``blurred`` (k,).
    """

    s: np.ndarray
    points: np.ndarray
    tangents: np.ndarray
    left: np.ndarray
    right: np.ndarray
    ball: np.ndarray
    offset: np.ndarray
    blurred: np.ndarray

    def joined(self, others: Samples) -> Samples:
        """These and ``others``, sorted by arclength."""
        order = np.argsort(np.concatenate([self.s, others.s]), kind="stable")
        columns = []
        for column in fields(self):
            pair = (getattr(self, column.name), getattr(others, column.name))
            columns.append(np.concatenate(pair)[order])
        return Samples(*columns)

    @cached_property
    def distances(self) -> np.ndarray:
        """Distances of neighbours (k - 1,)."""
        steps = np.diff(self.points, axis=0)
        distances: np.ndarray = np.linalg.norm(steps, axis=1)
        return distances

    @cached_property
    def reach(self) -> np.ndarray:
        """How far neighbours may be apart (k - 1,) to lie on one arc, by the ball
        around one of them."""
        larger_ball = np.maximum(self.ball[:-1], self.ball[1:])
        reach: np.ndarray = larger_ball - self.offset[:-1] - self.offset[1:]
        return reach

    @property
    def far(self) -> np.ndarray:
        """Whether neighbours are farther apart than that (k - 1,)."""
        far: np.ndarray = self.distances > self.reach
        return far

    @property
    def reversals(self) -> np.ndarray:
        """Arclengths after which the sign of det [G'; t] is another, G followed along
        the curve."""
        frames = np.concatenate([self.right, self.tangents[:, None, :]], axis=1)
        signs = np.sign(np.linalg.det(frames))
        turns = np.einsum("kmi,kmj->kij", self.left[:-1], self.left[1:])
        turn_signs = np.sign(np.linalg.det(turns))
        reversals: np.ndarray = self.s[1:][signs[1:] * signs[:-1] * turn_signs < 0]
        return reversals


def sample_curve(
    problem: Problem, branch: Branch, s: np.ndarray, bound: float
) -> Samples:
    """Solutions beside the traced curve at ``s`` (k,), with what is known around them.

    Where the residual, over a small singular value, leaves the solution in doubt by
    more than a share of the ball, the point is corrected first, by Gauss-Newton. The
    traced point must lie in the ball all the same. Where rounding alone leaves as much
    in doubt as half the ball, nothing can be said.
    """
    rank = problem.n - 1
    traced = branch(s)
    points = traced.copy()
    decomposition = decompose(problem, points)
    # singular value at which rounding leaves half the ball in doubt
    resolved = np.sqrt(4.0 * (2.0 + SHARE) / SHARE * ROUNDING * bound)
    is_solved = np.abs(decomposition.components(rank - 1)) < 5 * ROUNDING
    blurred = (decomposition.sigma[:, rank - 1] < resolved) & is_solved
    for _ in range(CORRECTIONS):
        steps = decomposition.newton_steps(rank)
        doubts = 2.0 * np.linalg.norm(steps, axis=1)
        allowed = DOUBT * SHARE * decomposition.sigma[:, rank - 1] / bound
        loose = np.flatnonzero((doubts > allowed) & ~blurred)
        if not len(loose):
            break
        points[loose] += steps[loose]
        decomposition.replace(loose, decompose(problem, points[loose]))
    # a point is off the solution by at most twice its correction (Newton and
    # Kantorovich again)
    weakest = decomposition.sigma[:, rank - 1]
    corrections = np.linalg.norm(decomposition.newton_steps(rank), axis=1)
    rounding = ROUNDING / np.maximum(weakest, TINY)
    offset = 2.0 * np.maximum(corrections, rounding)
    # beyond this the bound on the second derivative may fail
    valid = problem.curvature_residual / np.maximum(decomposition.sigma[:, 0], TINY)
    ball = SHARE * (np.minimum(weakest / bound, valid) - offset)
    is_outside = np.linalg.norm(points - traced, axis=1) > ball
    ball[blurred | is_outside] = 0.0
    offset[blurred] = 0.0
    tangents = branch(s, 1)
    return Samples(
        s=s,
        points=points,
        tangents=tangents / np.linalg.norm(tangents, axis=1)[:, None],
        left=decomposition.left[:, :, :rank],
        right=decomposition.right[:, :rank],
        ball=np.maximum(ball, 0.0),
        offset=offset,
        blurred=blurred,
    )
