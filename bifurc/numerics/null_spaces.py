"""Null spaces of F': tangents of curves, tangent planes of surfaces, and the singular
value decompositions that they come from.

Singular values and residuals are over the problem's magnitude throughout.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc._core import null_vector as null_vector_of
from bifurc.decisions import is_null
from bifurc.numerics.bordered import bordered_at
from bifurc.numerics.singular_values import factors_of
from bifurc.system import (
    System,
    jacobian_at,
    relative_gaps,
    relative_jacobians,
    relative_residuals,
)

# stands in a denominator where a singular value is zero: the square of what comes out
# is still a double
TINY = 1e-140
# A singular value, over the largest, that counts as zero beside a smaller one; and the
# part of a direction, over its length, that must lie in a null space to say where to go.
NEGLIGIBLE, AGREEING = 1e-9, 1e-3
# Corrections of one point onto a valley, which converge linearly with a rate of about the
# gap over sigma; singular values below a share of the largest are taken for that there.
VALLEY_ROUNDS, VALLEY_FLOOR = 40, 1e-12


# --- tangents -------------------------------------------------------------------------


def null_vector(
    problem: System, point: np.ndarray, along: np.ndarray | None = None
) -> np.ndarray:
    """Unit tangent (n,) of the curve through ``point``: the null vector of F'.

    It has no sign of its own: it is turned to agree with ``along`` where that is given,
    else with a fixed direction. Where the null space is larger, that is projected on it.
    A large problem is bordered instead of decomposed.
    """
    if problem.domain.is_large:
        return _null_vector_by_borders(problem, point, along)
    jacobian = jacobian_at(problem, point)
    if not isinstance(jacobian, np.ndarray):
        return _null_vector_by_borders(problem, point, along)
    near = np.empty(0) if along is None else along
    return null_vector_of(jacobian, near, negligible=NEGLIGIBLE, agreeing=AGREEING)


def _null_vector_by_borders(
    problem: System, point: np.ndarray, along: np.ndarray | None
) -> np.ndarray:
    """The null vector (n,), first with any border that is not across it, then with
    itself."""
    if along is None:
        rng = np.random.default_rng(0)
        along = np.array(rng.normal(size=problem.n))
    unit: np.ndarray = along / np.linalg.norm(along)
    first = bordered_at(problem, point, unit).null_vector()
    return bordered_at(problem, point, first).null_vector()


def null_spaces(problem: System, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Singular values (k, n) of F' at points (k, n), padded with zeros, and right
    singular vectors (k, n, n), one a row."""
    _, sigma, right = factors_of(relative_jacobians(problem, points))
    return _padded(sigma, problem.n), right


def tangent_planes(problem: System, points: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Orthonormal bases (k, n, d) of the tangent spaces of components of dimension d at
    solutions (k, n), turned as little as possible against the bases ``near`` (k, n, d)
    or (n, d).

    Where the null space is larger, at singular points, the part of it that is nearest
    to ``near`` is taken.
    """
    return planes_next_to(*null_spaces(problem, points), near)


def planes_next_to(
    sigma: np.ndarray, right: np.ndarray, near: np.ndarray
) -> np.ndarray:
    """`tangent_planes` (k, n, d) from the singular values (k, n) and right singular
    vectors (k, n, n)."""
    dimension = near.shape[-1]
    zeros = np.count_nonzero(is_null(sigma), axis=1)
    nullity = np.maximum(zeros, dimension)
    most = int(nullity.max(initial=dimension))
    numbers = np.arange(most, 0, -1)  # of the singular values, counted from the last
    belongs = numbers <= nullity[:, None]  # (k, most)
    rows = right[:, -most:] * belongs[:, :, None]
    left, _, across = np.linalg.svd(rows @ near, full_matrices=False)
    columns = np.swapaxes(rows, 1, 2)
    planes: np.ndarray = columns @ left @ across
    return planes


def cosines_between_planes(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Cosines (..., d), decreasing, of the principal angles between spaces with
    orthonormal bases (..., n, d)."""
    products = np.swapaxes(one, -1, -2) @ other
    return np.linalg.svd(products, compute_uv=False)


def _padded(sigma: np.ndarray, n: int) -> np.ndarray:
    """Singular values (..., n), zeros after those (..., min(m, n)) of an m x n
    matrix."""
    *batch, count = sigma.shape
    values = np.zeros((*batch, n))
    values[..., :count] = sigma
    return values


# --- decompositions -------------------------------------------------------------------


@dataclass
class Decomposition:
    """F and F' = U diag(sigma) V^T at k points, both over the problem's magnitude.

    ``residuals`` (k, m), ``left`` (k, m, m) with the columns u_i, ``sigma`` (k, min(m,
    n)) in decreasing order, ``right`` (k, n, n) with the rows v_i.
    """

    residuals: np.ndarray
    left: np.ndarray
    sigma: np.ndarray
    right: np.ndarray

    def components(self, i: int) -> np.ndarray:
        """u_i . F (k,): what is left of one combination of the equations."""
        direction = self.left[:, :, i]
        components: np.ndarray = np.einsum("km,km->k", direction, self.residuals)
        return components

    def newton_steps(self, rank: int, floor: float = 0.0) -> np.ndarray:
        """Gauss-Newton steps (k, n) of a given rank: - sum_{i <= rank} v_i (u_i . F) /
        sigma_i.

        They go across the null space and not along it. A singular value below ``floor``
        times the largest is taken for that, and where there are fewer equations than the
        rank, so is what none of them says anything of.
        """
        rank = min(rank, self.sigma.shape[1])
        left = self.left[:, :, :rank]
        sigma = self.sigma[:, :rank]
        right = self.right[:, :rank]
        lowest = np.maximum(floor * sigma[:, :1], TINY)
        components = np.einsum("kmi,km->ki", left, self.residuals)
        across = components / np.maximum(sigma, lowest)
        steps: np.ndarray = -np.einsum("kin,ki->kn", right, across)
        return steps

    def replace(self, rows: np.ndarray, others: Decomposition) -> None:
        """Put ``others`` in the place of the points ``rows``."""
        self.residuals[rows] = others.residuals
        self.left[rows] = others.left
        self.sigma[rows] = others.sigma
        self.right[rows] = others.right


def newton_in_rank(
    problem: System, points: np.ndarray, rank: int, rounds: int
) -> np.ndarray:
    """Points (k, n) after so many Gauss-Newton steps of a ``rank``: in the equations
    that are regular there."""
    for _ in range(rounds if len(points) else 0):
        points = points + decompose(problem, points).newton_steps(rank)
    return points


def correct_to_valley(
    problem: System, points: np.ndarray, rounds: int = VALLEY_ROUNDS
) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, n) moved onto the valley of a system (`bifurc.curves.valley`), across
    it, and the relative residual (k,) that is left at each."""
    points = np.array(points, dtype=float)
    rank = problem.n - 1
    for _ in range(rounds):
        steps = decompose(problem, points).newton_steps(rank, VALLEY_FLOOR)
        points += steps
        longest = np.abs(steps).max(initial=0.0)
        if longest < 1e-14 * problem.domain.scale:
            break
    return points, relative_gaps(problem, points)


def decompose(problem: System, points: np.ndarray) -> Decomposition:
    """F and the singular value decomposition of F' at points (k, n)."""
    residuals = relative_residuals(problem, points)
    left, sigma, right = factors_of(relative_jacobians(problem, points))
    return Decomposition(residuals, left, sigma, right)
