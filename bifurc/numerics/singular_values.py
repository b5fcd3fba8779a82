"""Singular values of F'."""

from __future__ import annotations

import numpy as np

from bifurc import _core
from bifurc.problem import Problem

__all__ = ["singular_values"]

# Unknowns up to which compiled code takes them by Jacobi's method, which knows small ones
# to more digits than LAPACK: of more unknowns that takes twenty times as long.
FEW = 100


def singular_values(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Singular values (..., n) of F' at points (..., n), over the problem's magnitude,
    padded with zeros."""
    if not points.size:
        return np.empty(points.shape)
    flat = points.reshape(-1, points.shape[-1])
    jacobians = problem.jacobians(flat) / problem.magnitude
    is_few = problem.n <= FEW
    values_of = _core.singular_values if is_few else np.linalg.svdvals
    values = values_of(jacobians)
    out = np.zeros((len(flat), problem.n))
    out[:, : values.shape[1]] = values[:, : problem.n]
    return out.reshape(points.shape)
