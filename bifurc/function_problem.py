"""Problems of which nothing is known but F and F', and those from a Python callable."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csc_array, issparse, sparray

from bifurc.errors import ProblemError
from bifurc.numerics.bordered import as_dense
from bifurc.numerics.collocation import march_by_collocation
from bifurc.numerics.corrector import (
    project_by_least_squares,
    project_to_sphere_by_newton,
)
from bifurc.problem import March, Problem
from bifurc.seeding import random_seeds
from bifurc.seeds import Seeds

__all__ = ["FunctionProblem", "NumericalProblem"]


class NumericalProblem(Problem):
    """A problem that gives `residuals` and `jacobians`, and nothing else: second
    derivatives by differences, pieces by collocation, solutions by least squares."""

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,), by central differences of F'."""
        step = 1e-5 * (1.0 + np.abs(point))
        shifts = np.diag(step)
        upper = self.jacobians(point + shifts)
        lower = self.jacobians(point - shifts)
        out = np.moveaxis((upper - lower) / (2 * step[:, None, None]), 0, -1)
        return 0.5 * (out + np.swapaxes(out, 1, 2))

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
        """Up to ``count`` pieces of the curve from ``start`` (n,) along ``tangent``, by
        collocation."""
        return march_by_collocation(
            self, start, tangent, order, tolerance, shortest, longest, count
        )

    def project(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n) and the relative residual (k,) that is
        left at each, by least squares."""
        return project_by_least_squares(self, starts)

    def project_to_sphere(
        self, starts: np.ndarray, center: np.ndarray, radius: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Solutions (k, n) at distance ``radius`` from ``center`` (n,), relative
        residuals (k,) and last steps (k,), by Newton's method."""
        return project_to_sphere_by_newton(self, starts, center, radius)

    def seeds(self, rng: np.random.Generator, count: int) -> Seeds:
        """Solutions reached from ``count`` random starts."""
        return random_seeds(self, rng, count)


class FunctionProblem(NumericalProblem):
    """A problem from a plain Python callable ``function``: (n,) -> (m,).

    Derivatives come from ``jacobian``: (n,) -> (m, n), dense or sparse, where given,
    else by complex step where the function lets complex numbers through, else by
    central differences; ``derivatives`` says which. ``bounds`` (n, 2) is the region
    from which `explore` draws starts and in which curves are followed. Raises
    `ProblemError` for bounds out of order and for a function that gives no finite
    vector.
    """

    def __init__(
        self,
        function: Callable[[np.ndarray], Sequence[float] | np.ndarray],
        bounds: Sequence[Sequence[float]],
        *,
        jacobian: Callable[[np.ndarray], np.ndarray | sparray] | None = None,
        names: Sequence[str] | None = None,
        units: Sequence[str] | None = None,
        periods: Sequence[float] | None = None,
    ):
        self.bounds = np.array(bounds, dtype=float)
        if (
            self.bounds.ndim != 2
            or self.bounds.shape[1] != 2
            or not np.all(self.bounds[:, 0] < self.bounds[:, 1])
        ):
            raise ProblemError(
                "bounds", self.bounds.tolist(), "rows of (low, high) with low < high"
            )
        n = len(self.bounds)
        self.names = tuple(names) if names else tuple(f"u{i + 1}" for i in range(n))
        self.units = tuple(units) if units else ("",) * n
        self.periods = (
            np.full(n, np.inf) if periods is None else np.array(periods, dtype=float)
        )
        for what, given in (
            ("names", self.names),
            ("units", self.units),
            ("periods", self.periods),
        ):
            if len(given) != n:
                raise ProblemError(
                    f"number of {what}", len(given), f"{n}, the number of bounds"
                )
        if not np.all(self.periods > 0):
            raise ProblemError(
                "periods",
                self.periods.tolist(),
                "positive, inf where an unknown has none",
            )
        self._function, self._jacobian = function, jacobian
        low = np.where(np.isfinite(self.bounds[:, 0]), self.bounds[:, 0], -1.0)
        high = np.where(np.isfinite(self.bounds[:, 1]), self.bounds[:, 1], 1.0)
        probes = np.random.default_rng(0).uniform(low, high, (7, n))
        value = np.asarray(function(probes[0]), dtype=float)
        if value.ndim != 1 or not np.all(np.isfinite(value)):
            raise ProblemError(
                "value of the function", value, "a vector of finite numbers"
            )
        self.derivatives = "given" if jacobian else self._choose_derivatives(probes[0])
        self.magnitude = (
            float(np.median([_spectral_norm(self.jacobian(u)) for u in probes])) or 1.0
        )
        self.scale = float(np.median(high - low)) / 4.0

    def _choose_derivatives(self, probe: np.ndarray) -> str:
        try:
            by_complex = self._complex_step(probe)
        except (TypeError, ValueError, np.exceptions.ComplexWarning):
            return "central differences"
        by_difference = self._central_difference(probe)
        size = 1.0 + np.abs(by_difference).max()
        agree = (
            by_complex.shape == by_difference.shape
            and np.abs(by_complex - by_difference).max() < 1e-5 * size
        )
        return "complex step" if agree else "central differences"

    def _complex_step(self, point: np.ndarray) -> np.ndarray:
        shifts = point + 1e-100j * np.eye(self.n)
        return np.column_stack(
            [np.imag(np.asarray(self._function(row))) / 1e-100 for row in shifts]
        )

    def _central_difference(self, point: np.ndarray) -> np.ndarray:
        columns = []
        for i in range(self.n):
            step = np.zeros(self.n)
            step[i] = 6e-6 * (1.0 + abs(point[i]))
            upper, lower = (
                np.asarray(self._function(point + sign * step), dtype=float)
                for sign in (1, -1)
            )
            columns.append((upper - lower) / (2 * step[i]))
        return np.column_stack(columns)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return np.array(
            [np.asarray(self._function(u), dtype=float) for u in np.atleast_2d(points)]
        )

    def jacobian(self, point: np.ndarray) -> np.ndarray | sparray:
        """F' (m, n) at one point (n,), sparse where the given ``jacobian`` makes it
        so."""
        if self._jacobian is None:
            return (
                self._complex_step(point)
                if self.derivatives == "complex step"
                else self._central_difference(point)
            )
        made = self._jacobian(point)
        return made if issparse(made) else np.asarray(made, dtype=float)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n), dense."""
        made = [self.jacobian(u) for u in np.atleast_2d(points)]
        return np.array([as_dense(j) for j in made])


def _spectral_norm(matrix: np.ndarray | sparray) -> float:
    """Largest singular value of a dense matrix; for a sparse one the bound sqrt(|A|_1
    |A|_inf)."""
    if issparse(matrix):
        size: np.ndarray | sparray = abs(csc_array(matrix))
        return float(np.sqrt(size.sum(axis=0).max() * size.sum(axis=1).max()))
    return float(np.linalg.norm(matrix, ord=2))
