"""A problem that counts how often its equations are evaluated."""

from __future__ import annotations

import numpy as np

from bifurc import Curvature, March, MarchSettings, NumericalProblem, Problem
from studies.methods.curve import MethodFailure

# evaluations of F and F' that a compiled Taylor piece costs: corrections, checks, and
# the series itself
A_PIECE = 10


class Counted(NumericalProblem):
    """``problem`` with the number of ``evaluations`` so far: points at which F or F'
    was asked for, one each.

    Raises `MethodFailure` beyond ``budget`` evaluations.
    """

    def __init__(self, problem: Problem, budget: int = 100_000):
        self._problem = problem
        self.evaluations = 0
        self.budget = budget
        self.domain, self.magnitude = problem.domain, problem.magnitude
        self.accuracy = problem.accuracy
        # by collocation F and F' are evaluated through the methods below
        is_own = type(problem).march is not NumericalProblem.march
        self._compiled = is_own or getattr(problem, "scaled_tape", None) is not None

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        self._count(len(points))
        return self._problem.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        self._count(len(points))
        return self._problem.jacobians(points)

    def _count(self, more: int) -> None:
        self.evaluations += more
        if self.evaluations > self.budget:
            raise MethodFailure(f"it is not done after {self.budget} evaluations")

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""
        return self._problem.hessians(points)

    @property
    def curvature(self) -> Curvature | None:
        """As of the problem."""
        return self._problem.curvature

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Pieces of the curve; compiled ones are taken to cost `A_PIECE` evaluations
        each."""
        if not self._compiled:
            return super().march(start, tangent, settings)
        march = self._problem.march(start, tangent, settings)
        self.evaluations += A_PIECE * max(1, len(march.pieces))
        return march
