"""Loops whose joint angles are coupled: locked joints, gears between joints, motions
kept symmetric.

The n joint angles are an affine function of fewer unknowns, theta = M v + c. A loop of
n > 7 joints moves with n - 6 degrees of freedom at least; with k = 7 unknowns curves
are left, as of a 7R loop.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from bifurc.function_problem import NumericalProblem
from bifurc.problem import March, MarchStatus
from linkages.closure import kernels
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import GeometryError, Loop

__all__ = ["CoupledClosure", "locked_joints"]

LARGEST_DENOMINATOR = 1000  # of a gear ratio whose angles come back to where they were


class CoupledClosure(NumericalProblem):
    """The closure equations of a loop in k unknowns v (rad) with theta = M v + c.

    ``matrix`` M (n, k) is constant and its columns are independent: a row of zeros
    locks a joint at its entry of ``offset`` c (n,), rad; two rows in proportion are a
    pair of gears. Arclength is that of v. An unknown is periodic where its column is
    rational. k may be any number from 1 to n, as the mobility of a loop may be
    anything. Raises `linkages.loop.GeometryError` for wrong shapes, values that are not
    finite and dependent columns.
    """

    curvature_residual = LoopClosure.curvature_residual

    def __init__(
        self, loop: Loop, matrix: np.ndarray, offset: np.ndarray | None = None
    ):
        self.loop = loop
        self.matrix, self.offset = _checked(loop.n, matrix, offset)
        count = self.matrix.shape[1]
        self.names = tuple(f"v{j + 1}" for j in range(count))
        self.units = ("rad",) * count
        self.periods = np.array([_period(column) for column in self.matrix.T])
        self.bounds = np.full((count, 2), [-np.inf, np.inf])
        self._closure = LoopClosure(loop)
        self._coupling = np.column_stack([self.matrix, self.offset])

    def angles(self, points: np.ndarray) -> np.ndarray:
        """Joint angles (..., n), rad, of unknowns (..., k)."""
        return points @ self.matrix.T + self.offset

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (m, 6) at points (m, k)."""
        return self._closure.residuals(self.angles(points))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (m, 6, k) of `residuals`."""
        return self._closure.jacobians(self.angles(points)) @ self.matrix

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """Second derivative (6, k, k) of the residual."""
        return self.matrix.T @ self._closure.hessian(self.angles(point)) @ self.matrix

    def curvature_bound(self) -> float:
        """That of the loop times |M|^2: once for the distance, once for the chain
        rule."""
        return (
            self._closure.curvature_bound() * float(np.linalg.norm(self.matrix, 2)) ** 2
        )

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
            self._closure._geometry,
            order,
            tolerance,
            shortest,
            longest,
            count,
            self._coupling,
        )
        return March(MarchStatus(status), pieces, steps, radii, residuals)


def locked_joints(
    joints: int, angles: Mapping[int, float]
) -> tuple[np.ndarray, np.ndarray]:
    """M (n, n - locked) and c (n,) of a loop of n ``joints`` of which some are locked.

    ``angles`` (rad) are those of the locked joints, counted from 1. Raises
    `linkages.loop.GeometryError` for a joint that the loop does not have.
    """
    offset = np.zeros(joints)
    for joint, angle in angles.items():
        if not 1 <= joint <= joints:
            raise GeometryError("locked joint", joint, f"from 1 to {joints}")
        offset[joint - 1] = angle
    return np.delete(np.eye(joints), [joint - 1 for joint in angles], axis=1), offset


def _checked(
    n: int, matrix: np.ndarray, offset: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """M and c as float arrays."""
    m, c = (
        np.array(matrix, dtype=float),
        np.zeros(n) if offset is None else np.array(offset, dtype=float),
    )
    if m.ndim != 2 or m.shape[0] != n or not 1 <= m.shape[1] <= n:
        raise GeometryError(
            "shape of the coupling matrix", m.shape, f"({n}, k) with k from 1 to {n}"
        )
    if c.shape != (n,):
        raise GeometryError("shape of the coupling offset", c.shape, f"({n},)")
    for what, values in (("coupling matrix", m), ("coupling offset", c)):
        if not np.all(np.isfinite(values)):
            raise GeometryError(what, values[~np.isfinite(values)][0], "finite numbers")
    rank = int(np.linalg.matrix_rank(m))
    if rank < m.shape[1]:
        raise GeometryError(
            "rank of the coupling matrix",
            rank,
            f"{m.shape[1]}, the number of its columns",
        )
    return m, c


def _period(ratios: np.ndarray) -> float:
    """The smallest turn (rad) of an unknown that brings all joints it turns round, inf
    where none is short."""
    found = [Fraction(float(r)).limit_denominator(LARGEST_DENOMINATOR) for r in ratios]
    if any(
        abs(float(f) - r) > 1e-12 * abs(r) for f, r in zip(found, ratios, strict=True)
    ):
        return math.inf
    turning = [f for f in found if f]
    return (
        2
        * math.pi
        * math.lcm(*(f.denominator for f in turning))
        / math.gcd(*(f.numerator for f in turning))
    )
