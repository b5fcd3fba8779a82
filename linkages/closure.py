"""The closure of a loop as a problem for `bifurc`: compiled kernels behind its interface."""

from __future__ import annotations

import numpy as np

from bifurc.problem import March, Problem
from linkages import kernels
from linkages.loop import Loop

__all__ = ["LoopClosure"]

ROUNDING = 4e-16  # below this residual norm a projection has nothing left to gain


class LoopClosure(Problem):
    """Six closure equations in the n joint angles (rad) of a loop.

    Translations are measured in the loop's characteristic length. The derivatives are exact: columns of
    the Jacobian are the joint screws, second derivatives their Lie brackets.
    """

    def __init__(self, loop: Loop):
        self.loop = loop
        self.names = tuple(f"theta{i + 1}" for i in range(loop.n))
        self.units = ("rad",) * loop.n
        self.periods = np.full(loop.n, 2 * np.pi)
        self.bounds = np.full((loop.n, 2), [-np.inf, np.inf])
        a, alpha, offset = loop.arrays
        size = loop.characteristic_length
        self._geometry = np.array(
            [a / size, offset / size, np.cos(alpha), np.sin(alpha), np.cos(alpha / 2), np.sin(alpha / 2)]
        )

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (k, 6): rotation, then translation over the characteristic length."""
        return kernels.residuals(np.ascontiguousarray(points, dtype=float), self._geometry)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (k, 6, n) of `residuals`."""
        return kernels.jacobians(np.ascontiguousarray(points, dtype=float), self._geometry)

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """Second derivative (6, n, n) of the residual."""
        return kernels.hessians(np.ascontiguousarray(point, dtype=float), self._geometry)

    def march(
        self, start: np.ndarray, tangent: np.ndarray, order: int, tolerance: float, shortest: float,
        longest: float, count: int,
    ) -> March:  # fmt: skip
        """Up to ``count`` Taylor pieces of the motion from ``start`` along ``tangent``."""
        status, pieces, steps, radii, residuals, _ = kernels.march(
            np.ascontiguousarray(start), np.ascontiguousarray(tangent), self._geometry, order, tolerance,
            shortest, longest, count,
        )  # fmt: skip
        return March(status, pieces, steps, radii, residuals)

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Closed configurations (k, n) near ``starts`` and the residual (k,) left at each."""
        return kernels.project(np.ascontiguousarray(starts, dtype=float), self._geometry, ROUNDING, 60)

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Closed configurations at distance ``radius`` from ``center``, residuals and last steps."""
        starts, center = np.ascontiguousarray(starts, dtype=float), np.ascontiguousarray(center, dtype=float)
        return kernels.project_to_sphere(starts, center, radius, self._geometry, 25)
