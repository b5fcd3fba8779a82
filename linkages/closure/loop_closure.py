"""The closure of a loop as a problem for `bifurc`: compiled kernels behind its
interface."""

from __future__ import annotations

import numpy as np

from bifurc.function_problem import NumericalProblem
from bifurc.problem import March, MarchStatus
from bifurc.seeding import CLOSED, random_seeds
from bifurc.seeds import Seeds
from linkages.closure import kernels
from linkages.loop import Loop
from linkages.slices.completeness import SliceAudit
from linkages.slices.elimination import slice_configurations

__all__ = ["LoopClosure"]

# of every joint: any motion in which a joint turns by more than 15 degrees meets one
SLICES = 24
LARGEST_SLICED = 6  # joints of the longest loop with complete slices
NEARLY_REAL = 0.2  # rad: imaginary parts of configurations whose real part is a start
ROUNDING = 4e-16  # below this residual norm a projection has nothing left to gain


class LoopClosure(NumericalProblem):
    """Six closure equations in the n joint angles (rad) of a loop.

    Translations are measured in the loop's characteristic length. The derivatives are
    exact: columns of the Jacobian are the joint screws, second derivatives their Lie
    brackets.
    """

    curvature_residual = 0.2

    def __init__(self, loop: Loop):
        self.loop = loop
        self.names = tuple(f"theta{i + 1}" for i in range(loop.n))
        self.units = ("rad",) * loop.n
        self.periods = np.full(loop.n, 2 * np.pi)
        self.bounds = np.full((loop.n, 2), [-np.inf, np.inf])
        a, alpha, offset = loop.arrays
        size = loop.characteristic_length
        self._geometry = np.array(
            [
                a / size,
                offset / size,
                np.cos(alpha),
                np.sin(alpha),
                np.cos(alpha / 2),
                np.sin(alpha / 2),
            ]
        )

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (k, 6): rotation, then translation over the characteristic
        length."""
        return kernels.residuals(
            np.ascontiguousarray(points, dtype=float), self._geometry
        )

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (k, 6, n) of `residuals`."""
        return kernels.jacobians(
            np.ascontiguousarray(points, dtype=float), self._geometry
        )

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """Second derivative (6, n, n) of the residual."""
        return kernels.hessians(
            np.ascontiguousarray(point, dtype=float), self._geometry
        )

    def curvature_bound(self) -> float:
        """K with |J(x) - J(y)| <= K |x - y| near closed configurations, from the
        geometry.

        The second derivative by joints i <= j is at most 1/2 for the rotation and the
        distance of the end point from axis j for the translation. Where the loop is
        nearly closed the end point is the base point, which the links before j and
        those after it reach; the shorter way bounds the distance, with
        ``curvature_residual`` to spare. K is the largest eigenvalue of the matrix of
        these bounds.
        """
        a, _, offset = np.abs(self.loop.arrays) / self.loop.characteristic_length
        link = a + np.roll(offset, -1)  # along link j and the axis after it
        before = np.concatenate([[0.0], np.cumsum(link)[:-1]]) - offset + offset[0]
        after = np.cumsum((a + offset)[::-1])[::-1] - offset
        distance = np.minimum(np.maximum(before, 0.0) + self.curvature_residual, after)
        later = np.maximum.outer(np.arange(self.n), np.arange(self.n))
        return float(np.linalg.eigvalsh(np.sqrt(0.25 + distance[later] ** 2))[-1])

    def march(
        self,
        start: np.ndarray,
        tangent: np.ndarray,
        order: int,
        tolerance: float,
        shortest: float,
        longest: float,
        count: int,
    ) -> March:
        """Up to ``count`` Taylor pieces of the motion from ``start`` along
        ``tangent``."""
        status, pieces, steps, radii, residuals, _ = kernels.march(
            np.ascontiguousarray(start),
            np.ascontiguousarray(tangent),
            self._geometry,
            order,
            tolerance,
            shortest,
            longest,
            count,
        )
        return March(MarchStatus(status), pieces, steps, radii, residuals)

    def seeds(self, rng: np.random.Generator, count: int) -> Seeds:
        """Closed configurations to start from: complete slices of every joint of a 4R,
        5R or 6R loop, and what is reached from ``count`` random starts."""
        drawn = random_seeds(self, rng, count)
        if self.loop.n > LARGEST_SLICED:
            return drawn
        first = rng.uniform(-np.pi, np.pi, self.n)
        steps = 2 * np.pi / SLICES * np.arange(SLICES)
        slices = [
            slice_configurations(self.loop, j + 1, first[j] + steps)
            for j in range(self.n)
        ]
        hidden = np.concatenate([s.nonreal for s in slices])
        nearly = hidden[
            np.abs(hidden.imag).max(axis=1, initial=0.0) < NEARLY_REAL
        ].real  # a small motion may be near
        reached, gaps = self.project(nearly)
        points = np.concatenate(
            [*(s.configurations for s in slices), reached[gaps < CLOSED], drawn.points]
        )
        random = np.repeat(
            [False, True], [len(points) - len(drawn.points), len(drawn.points)]
        )
        return Seeds(
            points,
            random,
            drawn.gaps,
            drawn.missed,
            SliceAudit(self.loop, tuple(slices)),
        )

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Closed configurations (k, n) near ``starts`` and the residual (k,) left at
        each."""
        return kernels.project(
            np.ascontiguousarray(starts, dtype=float), self._geometry, ROUNDING, 60
        )

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Closed configurations at distance ``radius`` from ``center``, residuals and
        last steps."""
        starts, center = (
            np.ascontiguousarray(starts, dtype=float),
            np.ascontiguousarray(center, dtype=float),
        )
        return kernels.project_to_sphere(starts, center, radius, self._geometry, 25)
