"""Where solutions beside a traced curve are unique: samples with the balls that hold
one arc each.

The theorem stands in `bifurc.curves.certificate`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from bifurc.branch import Branch
from bifurc.problem import Problem

__all__ = ["SHARE", "Samples", "sample_curve"]

SHARE = 1.0 / (
    2.0 * np.sqrt(2.0)
)  # of sigma / K: how far neighbouring points may be apart
CORRECTIONS = 2  # of a point whose residual leaves it in doubt
ROUNDING = 2e-15  # what F, over the magnitude, may be wrong by in doubles


@dataclass(frozen=True)
class Samples:
    """Solutions beside the traced curve at arclengths ``s`` (k,): ``points`` (k, n),
    the curve's ``tangents`` (k, n), orthonormal bases of the ranges of F', ``left`` (k,
    m, n - 1), and of F'^T, ``right`` (k, n - 1, n). A ``ball`` (k,) around each holds
    one arc, and the solution itself is ``offset`` (k,) or less from the point. Where F'
    is singular to within rounding the sample is ``blurred`` (k,)."""

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
        pairs = ((getattr(self, f.name), getattr(others, f.name)) for f in fields(self))
        return Samples(*(np.concatenate(pair)[order] for pair in pairs))

    @cached_property
    def apart(self) -> np.ndarray:
        """How far neighbours are apart (k - 1,)."""
        return np.linalg.norm(np.diff(self.points, axis=0), axis=1)

    @cached_property
    def reach(self) -> np.ndarray:
        """How far neighbours may be apart (k - 1,) to lie on one arc, by the ball
        around one of them."""
        return (
            np.maximum(self.ball[:-1], self.ball[1:])
            - self.offset[:-1]
            - self.offset[1:]
        )

    @property
    def far(self) -> np.ndarray:
        """Whether neighbours are farther apart than that (k - 1,)."""
        return self.apart > self.reach

    @property
    def reversals(self) -> np.ndarray:
        """Arclengths after which the sign of det [G'; t] is another, G followed along
        the curve."""
        frames = np.concatenate([self.right, self.tangents[:, None, :]], axis=1)
        turn = np.einsum("kmi,kmj->kij", self.left[:-1], self.left[1:])
        signs = np.sign(np.linalg.det(frames))
        return self.s[1:][signs[1:] * signs[:-1] * np.sign(np.linalg.det(turn)) < 0]


def sample_curve(
    problem: Problem, branch: Branch, s: np.ndarray, bound: float
) -> Samples:
    """Solutions beside the traced curve at ``s`` (k,), with what is known around them.

    Where the residual, over a small singular value, leaves the solution in doubt by
    more than a share of the ball, the point is corrected first, by Gauss-Newton. The
    traced point must lie in the ball all the same. Where rounding alone leaves as much
    in doubt as half the ball, nothing can be said.
    """
    traced, tangents = branch(s), branch(s, 1)
    points, last = traced.copy(), problem.n - 2
    left, sigma, right, residual = _factored(problem, points)
    weakest = np.abs(np.einsum("km,km->k", left[:, :, last], residual))
    resolved = np.sqrt(
        4.0 * (2.0 + SHARE) / SHARE * ROUNDING * bound
    )  # singular value at which that is half the ball
    blurred = (sigma[:, last] < resolved) & (weakest < 5 * ROUNDING)
    for _ in range(CORRECTIONS):
        step = _correction(left, sigma, right, residual)
        doubtful = (
            2.0 * np.linalg.norm(step, axis=1) > 0.05 * SHARE * sigma[:, last] / bound
        )
        loose = np.flatnonzero(doubtful & ~blurred)
        if not len(loose):
            break
        points[loose] += step[loose]
        left[loose], sigma[loose], right[loose], residual[loose] = _factored(
            problem, points[loose]
        )
    # a point is off the solution by at most twice its correction (Newton and
    # Kantorovich again)
    step = np.linalg.norm(_correction(left, sigma, right, residual), axis=1)
    offset = 2.0 * np.maximum(step, ROUNDING / sigma[:, last])
    holds = (
        problem.curvature_residual / sigma[:, 0]
    )  # beyond this the bound on the second derivative may fail
    ball = SHARE * (np.minimum(sigma[:, last] / bound, holds) - offset)
    ball[blurred | (np.linalg.norm(points - traced, axis=1) > ball)] = 0.0
    offset[blurred] = 0.0
    tangents = tangents / np.linalg.norm(tangents, axis=1)[:, None]
    return Samples(
        s,
        points,
        tangents,
        left[:, :, : last + 1],
        right[:, : last + 1],
        np.maximum(ball, 0.0),
        offset,
        blurred,
    )


def _factored(
    problem: Problem, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Singular value decomposition of F' and the residual at points (k, n), over the
    magnitude."""
    left, sigma, right = np.linalg.svd(problem.jacobians(points) / problem.magnitude)
    return (
        left,
        np.maximum(sigma, 1e-300),
        right,
        problem.residuals(points) / problem.magnitude,
    )


def _correction(
    left: np.ndarray, sigma: np.ndarray, right: np.ndarray, residual: np.ndarray
) -> np.ndarray:
    """Steps (k, n) of Gauss-Newton across the curve, of rank n - 1."""
    rank = right.shape[2] - 1
    across = np.einsum("kmi,km->ki", left[:, :, :rank], residual) / sigma[:, :rank]
    return -np.einsum("kin,ki->kn", right[:, :rank], across)
