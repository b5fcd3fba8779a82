"""Components along which F' has a lower rank than their dimension says: shaky motions,
double components.

There F = 0 does not determine them well enough to correct a point onto them. That all
singular values of F' after number r are zero is a condition that does (deflation:
Leykin, Verschelde and Zhao 2006): with orthonormal bases U and V of the last left and
right singular vectors at a point,

    F(u) = 0,   U^T F'(u) V = 0,

whose derivative there, with U and V held, is that of a regular system where the
component is double to first order.
"""

from __future__ import annotations

import numpy as np

from bifurc.decisions import closes_to_rounding
from bifurc.function_problem import NumericalProblem
from bifurc.problem import Problem

NEXT = 1e-4  # of the scale: how far a solution known to half the digits may be off


class RankDeflated(NumericalProblem):
    """The equations of a ``problem``, and that F' has no higher ``rank``.

    The bases are those at each point: values of the further equations at two points
    have no signs in common, only their sizes have a meaning.
    """

    def __init__(self, problem: Problem, rank: int):
        self._problem = problem
        self._rank = rank
        self.take_unknowns_of(problem)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F and the singular values after number ``rank``, as a matrix (k, m + e)."""
        residuals = self._problem.residuals(points)
        left, right, jacobians = self._last_vectors(points)
        blocks = np.swapaxes(left, 1, 2) @ jacobians @ right
        count = len(points)
        further = blocks.reshape(count, blocks.shape[1] * blocks.shape[2])
        return np.concatenate([residuals, further], axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' and below it U^T F'' V (k, m + e, n)."""
        left, right, jacobians = self._last_vectors(points)
        hessians = self._problem.hessians(points).reshape(*jacobians.shape, self.n)
        bends = np.einsum("kma,kmij,kib->kabj", left, hessians, right)
        count = len(points)
        further = bends.reshape(count, bends.shape[1] * bends.shape[2], self.n)
        return np.concatenate([jacobians, further], axis=1)

    def next_to(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) of lower rank next to solutions ``points`` (k, n) known to
        half the digits, and whether there is one (k,)."""
        solutions, gaps = self.project(points)
        offsets = np.linalg.norm(self.difference(solutions, points), axis=1)
        return solutions, closes_to_rounding(gaps) & (offsets < NEXT * self.scale)

    def _last_vectors(
        self, points: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """U (k, m, m - r), V (k, n, n - r) and F' (k, m, n)."""
        jacobians = self._problem.jacobians(points)
        left, _, right = np.linalg.svd(jacobians)
        r = self._rank
        return left[:, :, r:], np.swapaxes(right[:, r:], 1, 2), jacobians
