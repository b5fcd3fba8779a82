"""Least squares for one bordered system [F'; t] x = right, dense or sparse."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import csc_array, issparse

from bifurc import Problem
from bifurc.numerics.bordered import SparseBordered
from bifurc.system import jacobian_at

Jacobian: TypeAlias = np.ndarray | csc_array


def evaluate(problem: Problem, u: np.ndarray) -> tuple[np.ndarray, Jacobian]:
    """F (m,) and F' (m, n), dense or sparse, at one point."""
    residual = problem.residuals(u[None])[0]
    return residual, jacobian_at(problem, u)


def solve_bordered(
    jacobian: Jacobian, tangent: np.ndarray, right: np.ndarray
) -> np.ndarray:
    """x (n, k) that solves [F'; t] x = right (m + 1, k): by LU where it is square, else
    in the least-squares sense."""
    m, n = jacobian.shape
    if issparse(jacobian):
        return SparseBordered(jacobian, tangent[None]).solve(right)
    matrix = np.empty((m + 1, n))
    matrix[:m] = jacobian
    matrix[m] = tangent
    if m + 1 == n:
        _, _, exact, _ = lapack.dgesv(matrix, right)
        return np.asarray(exact)
    _, nearest, _ = lapack.dgels(matrix, right)
    return np.asarray(nearest[:n])


def mixtures(rows: int, wanted: int) -> np.ndarray:
    """A fixed random matrix (wanted, rows) with orthonormal rows that makes ``rows``
    redundant equations ``wanted``.

    Wherever they have the rank ``wanted`` so has, for almost every such matrix, their
    mixture.
    """
    rng = np.random.default_rng(0)
    orthogonal, _ = np.linalg.qr(rng.normal(size=(rows, rows)))
    return orthogonal[:wanted]
