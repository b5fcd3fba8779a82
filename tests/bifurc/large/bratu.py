"""Bratu's problem by differences, in one dimension and two: u'' + p exp(u) = 0."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import dstn
from scipy.sparse import csr_array, diags_array, eye_array, hstack, kron

# Largest p in one dimension: 8 (t / cosh t)^2 with t tanh t = 1 (Bratu 1914).
FOLD_IN_1D = 3.5138307191251613


@dataclass(frozen=True)
class Bratu:
    """F(u, p) = L u + p exp(u) with the differences ``laplacian`` L (m, m)."""

    laplacian: csr_array

    @property
    def n(self) -> int:
        return self.laplacian.shape[0] + 1

    def residual(self, x: np.ndarray) -> np.ndarray:
        return self.laplacian @ x[:-1] + x[-1] * np.exp(x[:-1])

    def jacobian(self, x: np.ndarray) -> csr_array:
        grown = np.exp(x[:-1])
        square = self.laplacian + diags_array(x[-1] * grown)
        return csr_array(hstack([square, csr_array(grown[:, None])]))


def bratu(points: int, dimensions: int = 1) -> Bratu:
    """Bratu's problem with so many inner points in each direction of the unit cube."""
    second = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(points, points))
    second = (points + 1) ** 2 * second
    if dimensions == 1:
        return Bratu(csr_array(second))
    unit = eye_array(points)
    return Bratu(csr_array(kron(second, unit) + kron(unit, second)))


def fast_poisson(points: int) -> Callable[[np.ndarray], np.ndarray]:
    """L^-1 of the square by sine transforms."""
    number = np.arange(1, points + 1)
    angle = 0.5 * np.pi * number / (points + 1)
    values = -4.0 * (points + 1) ** 2 * np.sin(angle) ** 2
    divisor = 4.0 * (points + 1) ** 2 * (values[:, None] + values)

    def solve(right: np.ndarray) -> np.ndarray:
        waves = dstn(right.reshape(points, points), type=1)
        return dstn(waves / divisor, type=1).ravel()

    return solve
