"""A problem that counts how often its equations are evaluated."""

from __future__ import annotations

import numpy as np

from bifurc import March, MarchSettings, NumericalProblem, Problem
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
        self.take_unknowns_of(problem)
        self.curvature_residual = problem.curvature_residual
        self.hessian_error = problem.hessian_error
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

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point."""
        return self._problem.hessian(point)

    def curvature_bound(self) -> float | None:
        """As of the problem."""
        return self._problem.curvature_bound()

    def complex_curvature(self, reach: np.ndarray) -> np.ndarray | None:
        """As of the problem."""
        return self._problem.complex_curvature(reach)

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
