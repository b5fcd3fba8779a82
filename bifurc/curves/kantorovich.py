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
        s = np.concatenate([self.s, others.s])
        order = np.argsort(s, kind="stable")
        columns = []
        for column in fields(self):
            first = getattr(self, column.name)
            second = getattr(others, column.name)
            columns.append(np.concatenate([first, second])[order])
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
        larger = np.maximum(self.ball[:-1], self.ball[1:])
        reach: np.ndarray = larger - self.offset[:-1] - self.offset[1:]
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
        tangents = self.tangents[:, None, :]
        frames = np.concatenate([self.right, tangents], axis=1)
        signs = np.sign(np.linalg.det(frames))
        turns = np.einsum("kmi,kmj->kij", self.left[:-1], self.left[1:])
        turn_signs = np.sign(np.linalg.det(turns))
        changes = signs[1:] * signs[:-1] * turn_signs
        reversals: np.ndarray = self.s[1:][changes < 0]
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
    traced = branch(s)
    solutions = _Solutions(problem, traced, bound)
    blurred = solutions.are_blurred()
    solutions.correct(~blurred)
    offset = solutions.offsets()
    ball = solutions.balls(offset)
    moved = np.linalg.norm(solutions.points - traced, axis=1)
    ball[blurred | (moved > ball)] = 0.0
    offset[blurred] = 0.0
    tangents = branch(s, 1)
    speeds = np.linalg.norm(tangents, axis=1)
    return Samples(
        s=s,
        points=solutions.points,
        tangents=tangents / speeds[:, None],
        left=solutions.left,
        right=solutions.right,
        ball=np.maximum(ball, 0.0),
        offset=offset,
        blurred=blurred,
    )


class _Solutions:
    """``points`` (k, n) beside a traced curve, and F decomposed there, for a constant
    ``bound`` of F'."""

    def __init__(self, problem: Problem, points: np.ndarray, bound: float):
        self.points = points.copy()
        self._problem = problem
        self._bound = bound
        self._rank = problem.n - 1
        self._decomposition = decompose(problem, points)

    @property
    def left(self) -> np.ndarray:
        """Orthonormal bases (k, m, n - 1) of the ranges of F'."""
        return self._decomposition.left[:, :, : self._rank]

    @property
    def right(self) -> np.ndarray:
        """Orthonormal bases (k, n - 1, n) of the ranges of F'^T."""
        return self._decomposition.right[:, : self._rank]

    @property
    def _weakest(self) -> np.ndarray:
        """Singular values n - 1 (k,)."""
        return self._decomposition.sigma[:, self._rank - 1]

    def are_blurred(self) -> np.ndarray:
        """Whether rounding leaves half the ball in doubt (k,), and F is zero as far as
        can be said."""
        weakest_component = self._decomposition.components(self._rank - 1)
        is_solved = np.abs(weakest_component) < 5 * ROUNDING
        resolved = np.sqrt(4.0 * (2.0 + SHARE) / SHARE * ROUNDING * self._bound)
        blurred: np.ndarray = (self._weakest < resolved) & is_solved
        return blurred

    def correct(self, where: np.ndarray) -> None:
        """Move those of the points ``where`` (k,) that are in doubt."""
        for _ in range(CORRECTIONS):
            steps = self._decomposition.newton_steps(self._rank)
            doubts = 2.0 * np.linalg.norm(steps, axis=1)
            allowed = DOUBT * SHARE * self._weakest / self._bound
            loose = np.flatnonzero((doubts > allowed) & where)
            if not len(loose):
                break
            self.points[loose] += steps[loose]
            corrected = decompose(self._problem, self.points[loose])
            self._decomposition.replace(loose, corrected)

    def offsets(self) -> np.ndarray:
        """How far the solutions may be from the points (k,): twice the next correction
        (Newton and Kantorovich again), or what rounding leaves."""
        steps = self._decomposition.newton_steps(self._rank)
        corrections = np.linalg.norm(steps, axis=1)
        rounding = ROUNDING / np.maximum(self._weakest, TINY)
        offsets: np.ndarray = 2.0 * np.maximum(corrections, rounding)
        return offsets

    def balls(self, offsets: np.ndarray) -> np.ndarray:
        """Radii (k,) of the balls about the points that hold one arc each."""
        largest = np.maximum(self._decomposition.sigma[:, 0], TINY)
        # beyond this the bound on the second derivative may fail
        valid = self._problem.curvature_residual / largest
        radii = np.minimum(self._weakest / self._bound, valid)
        balls: np.ndarray = SHARE * (radii - offsets)
        return balls
