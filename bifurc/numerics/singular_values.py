"""Singular values of F', and the decompositions that they come from.

Where F' is not finite, as at the rim of where F is defined, it says nothing: the
singular values count as infinite, so that nothing is taken for singular there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.limits import left_behind
from bifurc.system import System, relative_jacobians

# Unknowns up to which compiled code takes them by Jacobi's method, which knows small ones
# to more digits than LAPACK: of 40 unknowns that takes four times as long, of 100 ten times.
FEW = 30


def singular_values(problem: System, points: np.ndarray) -> np.ndarray:
    """Singular values (..., n) of F' at points (..., n), over the problem's magnitude,
    padded with zeros."""
    if not points.size:
        return np.empty(points.shape)
    flat = points.reshape(-1, points.shape[-1])
    if problem.n <= FEW:
        jacobians = relative_jacobians(problem, flat)
        return _core.singular_values(jacobians).reshape(points.shape)
    out = np.zeros((len(flat), problem.n))
    for row, point in zip(out, flat, strict=True):  # one large matrix at a time
        values = values_of(relative_jacobians(problem, point[None])[0])
        row[: len(values)] = values
    return out.reshape(points.shape)


class Factors(NamedTuple):
    """U diag(sigma) V^T: ``left`` with the columns u_i, ``sigma`` in decreasing order,
    ``right`` with the rows v_i."""

    left: np.ndarray
    sigma: np.ndarray
    right: np.ndarray


def factors_of(matrices: np.ndarray, full_matrices: bool = True) -> Factors:
    """The singular value decomposition of matrices (..., m, n); infinite singular
    values of one that is not finite."""
    is_finite, sound = _sound(matrices)
    decompose = left_behind(sound.shape[-1], np.linalg.svd)
    left, sigma, right = decompose(sound, full_matrices=full_matrices)
    return Factors(left, np.where(is_finite[..., None], sigma, np.inf), right)


def values_of(matrices: np.ndarray) -> np.ndarray:
    """The singular values (..., min(m, n)) of matrices (..., m, n) alone, in decreasing
    order; infinite ones of a matrix that is not finite."""
    is_finite, sound = _sound(matrices)
    values = left_behind(sound.shape[-1], np.linalg.svd)(sound, compute_uv=False)
    return np.where(is_finite[..., None], values, np.inf)


def _sound(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which matrices (..., m, n) are finite, and the matrices with zeros in the place of
    the others."""
    is_finite = np.asarray(np.isfinite(matrices).all(axis=(-2, -1)))
    if is_finite.all():
        return is_finite, matrices
    return is_finite, np.where(is_finite[..., None, None], matrices, 0.0)
