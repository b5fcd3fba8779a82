"""A problem seen through rounding noise: what another processor makes of the last bits,
and more.

An answer that hangs on the last bits is no answer. `with_rounding_noise` is the test
for it: a search through the noise must find the same atlas. Every value that a problem
gives is off by a few units in the last place of the numbers that it comes of, anew at
every call.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.function_problem import NumericalProblem
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.seeds import Seeds
from bifurc.system import CurveNodes, March, MarchSettings, Shortcuts, SphereProjection

ULPS = 2.0  # the largest error, in units of the last place of a number about 1


class RoundingNoise:
    """Numbers off by at most two units in the last place, drawn with ``seed``."""

    def __init__(self, seed: int):
        self._rng = np.random.default_rng(seed)

    def __call__(self, values: np.ndarray, size: float) -> np.ndarray:
        """``values`` that come of numbers of a typical ``size``, with their errors."""
        return values + size * self._errors(values.shape)

    def relative(self, values: np.ndarray) -> np.ndarray:
        """``values`` with errors in proportion to each of them."""
        return values * (1.0 + self._errors(values.shape))

    def _errors(self, shape: tuple[int, ...]) -> np.ndarray:
        largest = ULPS * np.finfo(float).eps
        return self._rng.uniform(-largest, largest, shape)


class NoisyMethods(NumericalProblem):
    """The methods of a problem with errors in what they take and return; to be put
    before the class of a problem. ``noise`` makes them."""

    noise: RoundingNoise

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) with errors in proportion to magnitude and scale."""
        residuals = super().residuals(points)  # type: ignore[safe-super]
        return self.noise(residuals, self.magnitude * self.domain.scale)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) with errors in proportion to the magnitude."""
        jacobians = super().jacobians(points)  # type: ignore[safe-super]
        return self.noise(jacobians, self.magnitude)

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) with errors in proportion to magnitude over scale."""
        hessians = super().hessians(points)
        return self.noise(hessians, self.magnitude / self.domain.scale)

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Pieces with errors in their coefficients, from a start with errors."""
        start = self.noise(start, self.domain.scale)
        tangent = self.noise(tangent, 1.0)
        march = super().march(start, tangent, settings)
        return replace(march, pieces=self.noise(march.pieces, self.domain.scale))

    @property
    def shortcuts(self) -> Shortcuts:
        """What is done in one call, with errors in points of a valley; sparse matrices
        have none."""
        shortcuts = super().shortcuts._replace(equations=None)
        correct = shortcuts.valley_corrector
        if correct is None:
            return shortcuts

        def correct_with_errors(nodes: CurveNodes) -> np.ndarray | None:
            start = self.noise(nodes.start, self.domain.scale)
            points = correct(nodes._replace(start=start))
            return None if points is None else self.noise(points, self.domain.scale)

        return shortcuts._replace(valley_corrector=correct_with_errors)

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) with errors, and the residuals (k,)."""
        points, gaps = super().project(self.noise(starts, self.domain.scale))
        return self.noise(points, self.domain.scale), gaps

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> SphereProjection:
        """Solutions on a sphere with errors."""
        starts = self.noise(starts, self.domain.scale)
        projection = super().project_to_sphere(starts, center, radius)
        return projection._replace(
            points=self.noise(projection.points, self.domain.scale)
        )

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Seeds with errors."""
        seeds = super().seeds(rng, count, deadline)
        return replace(seeds, points=self.noise(seeds.points, self.domain.scale))


def with_rounding_noise(problem: Problem, seed: int) -> Problem:
    """``problem`` seen through rounding noise drawn with ``seed``.

    Where compiled kernels work inside a method, the noise is around it only; a problem
    of such kernels can do better, as `studies.noisy_loop` does.
    """
    kind = type(problem)
    noisy_kind = type(f"Noisy{kind.__name__}", (NoisyMethods, kind), {})
    noisy: Problem = object.__new__(noisy_kind)
    vars(noisy).update(vars(problem))
    vars(noisy)["noise"] = RoundingNoise(seed)
    return noisy
