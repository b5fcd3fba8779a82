"""Discretised fields with known special points: Bratu's problem, Swift and Hohenberg's
equation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import dstn
from scipy.sparse import csr_array, diags_array, eye_array, hstack, kron

# Largest p in one dimension: 8 (t / cosh t)^2 with t tanh t = 1 (Bratu 1914).
FOLD_IN_1D = 3.5138307191251613
# In two, as others computed it: 6.808124423 (Mohsen 2014).
FOLD_IN_2D = 6.808124423


# --- Bratu's problem ------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class BratuField:
    """F(u, p) = L u + p exp(u) with the differences ``laplacian`` L (m, m)."""

    laplacian: csr_array

    @property
    def n(self) -> int:
        """Number of unknowns, the parameter included."""
        return int(self.laplacian.shape[0]) + 1

    def residual(self, x: np.ndarray) -> np.ndarray:
        """F (m,) at (u, p)."""
        value: np.ndarray = self.laplacian @ x[:-1] + x[-1] * np.exp(x[:-1])
        return value

    def jacobian(self, x: np.ndarray) -> csr_array:
        """F' (m, m + 1) at (u, p)."""
        grown = np.exp(x[:-1])
        square = self.laplacian + diags_array(x[-1] * grown)
        return csr_array(hstack([square, csr_array(grown[:, None])]))


def bratu_field(points: int, dimensions: int) -> BratuField:
    """Bratu's problem on the unit interval or square, 0 at the rim, with so many inner
    points a side: three- or five-point differences."""
    second = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(points, points))
    second = (points + 1) ** 2 * second
    if dimensions == 1:
        return BratuField(csr_array(second))
    unit = eye_array(points)
    return BratuField(csr_array(kron(second, unit) + kron(unit, second)))


def fast_poisson(points: int) -> Callable[[np.ndarray], np.ndarray]:
    """L^-1 of the square by sine transforms: exact at p = 0, and a preconditioner."""
    angle = 0.5 * np.pi * np.arange(1, points + 1) / (points + 1)
    values = -4.0 * (points + 1) ** 2 * np.sin(angle) ** 2
    divisor = 4.0 * (points + 1) ** 2 * (values[:, None] + values)

    def solve(right: np.ndarray) -> np.ndarray:
        waves = dstn(right.reshape(points, points), type=1)
        waves /= divisor
        solution: np.ndarray = dstn(waves, type=1, overwrite_x=True).ravel()
        return solution

    return solve


# --- Swift and Hohenberg's equation ---------------------------------------------------


class SwiftHohenberg:
    """p u - (1 + D)^2 u + c - u^3 = 0 at ``points`` inner points of an interval, with
    u = u'' = 0 at both ends, D the second differences and c a ``constant``."""

    def __init__(self, points: int, length: float, constant: float = 0.0):
        step = length / (points + 1)
        shape = (points, points)
        second = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=shape)
        root = csr_array(second / step**2 + eye_array(points))
        self.linear = csr_array(root @ root)
        self.n = points + 1
        self.constant = constant
        self._waves = 4.0 / step**2
        self._angles = 0.5 * np.pi * np.arange(1, points + 1) / (points + 1)

    def residual(self, x: np.ndarray) -> np.ndarray:
        """F (m,) at (u, p)."""
        u = x[:-1]
        value: np.ndarray = x[-1] * u + self.constant - u**3 - self.linear @ u
        return value

    @property
    def pattern(self) -> csr_array:
        """Where F' has entries (m, m), without the parameter's column."""
        return csr_array(abs(self.linear) + eye_array(self.n - 1))

    def crossings_below(self, parameter: float) -> np.ndarray:
        """The parameters, in order, at which waves leave u = 0: the eigenvalues of the
        linear part, in closed form."""
        values = (1.0 - self._waves * np.sin(self._angles) ** 2) ** 2
        below: np.ndarray = np.sort(values[values < parameter])
        return below


# --- the Brusselator ------------------------------------------------------------------


class Brusselator:
    """u' = D_u u'' + A - (B + 1) u + u^2 v and v' = D_v v'' + B u - u^2 v at ``points``
    inner points of the unit interval, u = A and v = B / A at both ends: B is the
    parameter, and u = A, v = B / A a solution for every B (Prigogine and Lefever 1968)."""

    a, of_u, of_v = 2.0, 0.008, 0.004  # A, D_u and D_v

    def __init__(self, points: int):
        shape = (points, points)
        second = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=shape)
        self.laplacian = csr_array((points + 1) ** 2 * second)
        self.points = points
        self.n = 2 * points + 1

    def residual(self, x: np.ndarray) -> np.ndarray:
        """F (2 points,) at (u, v, B)."""
        u, v, b = x[: self.points], x[self.points : -1], x[-1]
        reaction = b * u - u * u * v
        along_u = self.of_u * (self.laplacian @ (u - self.a)) + self.a - u - reaction
        along_v = self.of_v * (self.laplacian @ (v - b / self.a)) + reaction
        return np.concatenate([along_u, along_v])

    @property
    def pattern(self) -> csr_array:
        """Where F' has entries, without the parameter's column."""
        return csr_array(kron(np.ones((2, 2)), abs(self.laplacian)))

    def constant(self, b: float) -> np.ndarray:
        """The constant solution (n,) at a parameter."""
        u, v = np.full(self.points, self.a), np.full(self.points, b / self.a)
        return np.concatenate([u, v, [b]])

    def hopf_points_below(self, parameter: float) -> tuple[np.ndarray, np.ndarray]:
        """The parameters, in order, at which a pair of eigenvalues of a sine wave is
        imaginary, and their frequencies: trace and determinant of two rows by two
        columns, in closed form."""
        angles = 0.5 * np.pi * np.arange(1, self.points + 1) / (self.points + 1)
        waves = 4.0 * (self.points + 1) ** 2 * np.sin(angles) ** 2
        b = 1.0 + self.a**2 + (self.of_u + self.of_v) * waves
        of_u, of_v = b - 1.0 - self.of_u * waves, -(self.a**2) - self.of_v * waves
        squares = of_u * of_v + self.a**2 * b
        is_pair = (b < parameter) & (squares > 0.0)
        return b[is_pair], np.sqrt(squares[is_pair])
