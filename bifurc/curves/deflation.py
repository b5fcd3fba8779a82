"""Curves along which F' has a lower rank throughout: shaky motions, double components.

There F = 0 does not determine the curve well enough to correct a point onto it: across
it F grows with the square of the distance. One step of deflation (Ojika 1987; Leykin,
Verschelde and Zhao 2006) adds a null vector v that is not the tangent as further
unknown,

    F(u) = 0,   F'(u) v = 0,   a . v = 1,   t . v = 0,

with a and t from the null space at the start of a run. The curve of (u, v) is regular
where the double component is of first order.
"""

from __future__ import annotations

import numpy as np

from bifurc.function_problem import NumericalProblem
from bifurc.numerics.collocation import march_by_collocation, reparametrised
from bifurc.problem import March, MarchStatus, Problem
from bifurc.singular.sphere import section

__all__ = ["Deflated", "lower_rank_direction"]

# singular value that counts as zero at a start: seeds reach a double component only to
# 1e-8
LOWER = 1e-5
RUN = 4  # pieces made with one choice of a and t, before both are renewed


class _WithNullVector(NumericalProblem):
    """The deflated system in the unknowns (u, v), for one choice of a and t."""

    def __init__(self, problem: Problem, a: np.ndarray, t: np.ndarray):
        n = problem.n
        self._problem, self._normal = problem, np.vstack([a, t])
        self.names, self.units = problem.names * 2, problem.units + ("",) * n
        self.periods = np.concatenate([problem.periods, np.full(n, np.inf)])
        self.bounds = np.full((2 * n, 2), [-np.inf, np.inf])
        self.magnitude, self.scale = problem.magnitude, problem.scale

    def residuals(self, points: np.ndarray) -> np.ndarray:
        n = self._problem.n
        u, v = points[:, :n], points[:, n:]
        product = np.einsum("kmn,kn->km", self._problem.jacobians(u), v)
        border = (v @ self._normal.T - [1.0, 0.0]) * self.magnitude
        return np.concatenate([self._problem.residuals(u), product, border], axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        n = self._problem.n
        u, v = points[:, :n], points[:, n:]
        first = self._problem.jacobians(u)
        k, m = first.shape[:2]
        out = np.zeros((k, 2 * m + 2, 2 * n))
        out[:, :m, :n] = out[:, m : 2 * m, n:] = first
        for i in range(k):
            out[i, m : 2 * m, :n] = self._problem.hessian(u[i]) @ v[i]
        out[:, 2 * m :, n:] = self._normal * self.magnitude
        return out


class Deflated(NumericalProblem):
    """The same problem, followed along curves on which F' has rank n - 2.

    Everything but `march` is that of ``problem``.
    """

    def __init__(self, problem: Problem):
        self._problem = problem
        for name in (
            "names",
            "units",
            "periods",
            "bounds",
            "magnitude",
            "scale",
            "derivatives",
        ):
            setattr(self, name, getattr(problem, name))

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self._problem.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self._problem.jacobians(points)

    def hessian(self, point: np.ndarray) -> np.ndarray:
        """F'' (m, n, n) at a point (n,)."""
        return self._problem.hessian(point)

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
        """A few pieces of the curve from ``start`` along ``tangent``, by collocation on
        the deflated system."""
        right = np.linalg.svd(self.jacobians(start[None])[0], full_matrices=True)[2]
        null_space = right[self.n - 2 :]
        t = null_space.T @ (null_space @ tangent)
        t /= np.linalg.norm(t)
        a = null_space.T @ np.array([[0.0, -1.0], [1.0, 0.0]]) @ (null_space @ t)
        pair = _WithNullVector(self._problem, a, t)
        begin, heading = (
            np.concatenate([start, a]),
            np.concatenate([t, np.zeros(self.n)]),
        )
        march = march_by_collocation(
            pair, begin, heading, order, tolerance, shortest, longest, min(count, RUN)
        )
        status = march.status
        if status is MarchStatus.STALLED and len(march.pieces):
            status = MarchStatus.RAN  # perhaps only the choice of a and t wore out
        made = [reparametrised(piece[:, : self.n]) for piece in march.pieces]
        radii = np.array([length / 2 for _, length in made])
        steps = radii + np.concatenate([[0.0], radii[:-1]]) if len(made) else radii
        kept = np.array([piece for piece, _ in made]).reshape(-1, order + 1, self.n)
        return March(status, kept, steps, radii, march.residuals)


def lower_rank_direction(problem: Problem, point: np.ndarray) -> np.ndarray | None:
    """Unit tangent (n,) of a curve through ``point`` along which F' has rank n - 2;
    None where there is none.

    There the section with a small sphere shows two opposite half-branches, and F' has
    no higher rank on either.
    """
    _, sigma, right = np.linalg.svd(
        problem.jacobians(point[None])[0] / problem.magnitude, full_matrices=True
    )
    padded = np.concatenate([sigma, np.zeros(len(right) - len(sigma))])
    if np.count_nonzero(padded < LOWER) != 2:
        return None
    cut = section(problem, point, right[problem.n - 2 :].T, 1e-2 * problem.scale)
    if cut.dimension != 1 or len(cut.points) != 2:
        return None
    values = np.linalg.svd(
        problem.jacobians(cut.points) / problem.magnitude, compute_uv=False
    )
    if values.shape[1] >= problem.n - 1 and values[:, problem.n - 2].max() > LOWER:
        return None
    along = cut.points[1] - cut.points[0]
    return (
        along / np.linalg.norm(along)
        if np.linalg.norm(along) > 1e-2 * problem.scale
        else None
    )
