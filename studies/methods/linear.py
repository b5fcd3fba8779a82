"""Least squares for one bordered system [F'; t] x = right, dense or sparse."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lapack
from scipy.sparse import issparse

from bifurc.numerics.bordered import sparse_bordered
from bifurc.problem import Problem

__all__ = ["evaluate", "mixtures", "solve_bordered"]


def evaluate(problem: Problem, u: np.ndarray) -> tuple[np.ndarray, Any]:
    """F (m,) and F' (m, n), dense or sparse, at one point."""
    return problem.residuals(u[None])[0], problem.jacobian(u)


def solve_bordered(jacobian: Any, tangent: np.ndarray, right: np.ndarray) -> np.ndarray:
    """x (n, k) that solves [F'; t] x = right (m + 1, k): by LU where it is square, else
    in the least-squares sense."""
    m, n = jacobian.shape
    if issparse(jacobian):
        return sparse_bordered(jacobian, tangent)(right)
    matrix = np.empty((m + 1, n))
    matrix[:m], matrix[m] = jacobian, tangent
    if m + 1 == n:
        return lapack.dgesv(matrix, right)[2]
    return lapack.dgels(matrix, right)[1][:n]


def mixtures(rows: int, wanted: int) -> np.ndarray:
    """A fixed random matrix (wanted, rows) with orthonormal rows that makes ``rows``
    redundant equations ``wanted``.

    Wherever they have the rank ``wanted`` so has, for almost every such matrix, their
    mixture.
    """
    return np.linalg.qr(np.random.default_rng(0).normal(size=(rows, rows)))[0][:wanted]
