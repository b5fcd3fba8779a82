"""Loops whose joint angles are coupled: locked joints, gears between joints, motions
kept symmetric.

The n joint angles are an affine function of fewer unknowns, theta = M v + c. A loop of
n > 7 joints moves with n - 6 degrees of freedom at least; with k = 7 unknowns curves
are left, as of a 7R loop.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bifurc.checks import floats_of
from bifurc.function_problem import NumericalProblem
from bifurc.problem import March, MarchSettings
from bifurc.torus import common_period
from linkages.closure.loop_closure import LoopClosure, march
from linkages.loop import Loop
from linkages.values import GeometryError


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
    hessian_error = LoopClosure.hessian_error

    def __init__(
        self, loop: Loop, matrix: np.ndarray, offset: np.ndarray | None = None
    ):
        self.loop = loop
        self.matrix = _coupling_matrix(loop.n, matrix)
        self.offset = _coupling_offset(loop.n, offset)
        count = self.matrix.shape[1]
        self.names = tuple(f"v{j + 1}" for j in range(count))
        self.units = ("rad",) * count
        self.periods = np.array([common_period(column) for column in self.matrix.T])
        self.bounds = np.full((count, 2), [-np.inf, np.inf])
        self._closure = LoopClosure(loop)
        self._coupling = np.column_stack([self.matrix, self.offset])

    def angles(self, points: np.ndarray) -> np.ndarray:
        """Joint angles (..., n), rad, of unknowns (..., k)."""
        theta: np.ndarray = points @ self.matrix.T + self.offset
        return theta

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """Closure residuals (m, 6) at points (m, k)."""
        return self._closure.residuals(self.angles(points))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (m, 6, k) of `residuals`."""
        of_angles = self._closure.jacobians(self.angles(points))
        jacobians: np.ndarray = of_angles @ self.matrix
        return jacobians

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """Second derivative (6, k, k) of the residual."""
        of_angles = self._closure.hessian(self.angles(point))
        hessian: np.ndarray = self.matrix.T @ of_angles @ self.matrix
        return hessian

    def curvature_bound(self) -> float:
        """That of the loop times |M|^2: once for the distance, once for the chain
        rule."""
        stretch = float(np.linalg.norm(self.matrix, 2))
        return self._closure.curvature_bound() * stretch**2

    def complex_curvature(self, reach: np.ndarray) -> np.ndarray:
        """Bounds (m,) on |F''| at all complex unknowns no farther than ``reach`` (m,)
        from real ones."""
        stretch = float(np.linalg.norm(self.matrix, 2))
        of_angles = self._closure.complex_curvature(stretch * reach)
        return of_angles * stretch**2

    def march(
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """Taylor pieces of the motion from ``start`` (k,) along ``tangent`` (k,)."""
        geometry = self.loop.link_geometry
        return march(self, geometry, start, tangent, settings, self._coupling)


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
    locked = [joint - 1 for joint in angles]
    return np.delete(np.eye(joints), locked, axis=1), offset


def _coupling_matrix(n: int, matrix: np.ndarray) -> np.ndarray:
    """M (n, k) as floats; raises `GeometryError` for a wrong shape, values that are not
    finite and dependent columns."""
    m = floats_of("coupling matrix", matrix)
    if m.ndim != 2 or m.shape[0] != n or not 1 <= m.shape[1] <= n:
        allowed = f"({n}, k) with k from 1 to {n}"
        raise GeometryError("shape of the coupling matrix", m.shape, allowed)
    _check_finite("coupling matrix", m)
    rank = int(np.linalg.matrix_rank(m))
    if rank < m.shape[1]:
        allowed = f"{m.shape[1]}, the number of its columns"
        raise GeometryError("rank of the coupling matrix", rank, allowed)
    return m


def _coupling_offset(n: int, offset: np.ndarray | None) -> np.ndarray:
    """c (n,) as floats, 0 where none is given; raises `GeometryError` for a wrong shape
    and values that are not finite."""
    if offset is None:
        return np.zeros(n)
    c = floats_of("coupling offset", offset)
    if c.shape != (n,):
        raise GeometryError("shape of the coupling offset", c.shape, f"({n},)")
    _check_finite("coupling offset", c)
    return c


def _check_finite(name: str, values: np.ndarray) -> None:
    is_wrong = ~np.isfinite(values)
    if np.any(is_wrong):
        raise GeometryError(name, values[is_wrong][0], "finite numbers")
