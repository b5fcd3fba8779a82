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

from dataclasses import replace

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_shaky, may_be_shaky
from bifurc.function_problem import NumericalProblem
from bifurc.numerics.collocation import march_by_collocation, reparametrised
from bifurc.numerics.null_spaces import null_spaces
from bifurc.numerics.singular_values import factors_of, singular_values, values_of
from bifurc.problem import March, MarchSettings, MarchStatus, Piece, Problem
from bifurc.singular.sphere import section

RUN = 4  # pieces made with one choice of a and t, before both are renewed
SECTION_RADIUS = 1e-2  # of the sphere on which half-branches are looked for, in scales


class WithNullVector(NumericalProblem):
    """The deflated system in the unknowns (u, v), for one choice of a and t."""

    def __init__(self, problem: Problem, a: np.ndarray, t: np.ndarray):
        n = problem.n
        self._problem = problem
        self._normal = np.vstack([a, t])
        self.names = problem.names * 2
        self.units = problem.units + ("",) * n
        endless = np.full(n, np.inf)
        self.periods = np.concatenate([problem.periods, endless])
        self.bounds = np.tile([-np.inf, np.inf], (2 * n, 1))
        self.magnitude = problem.magnitude
        self.scale = problem.scale

    def residuals(self, points: np.ndarray) -> np.ndarray:
        u, v = np.split(points, 2, axis=1)
        residuals = self._problem.residuals(u)
        jacobians = self._problem.jacobians(u)
        products = np.einsum("kmn,kn->km", jacobians, v)
        borders = (v @ self._normal.T - [1.0, 0.0]) * self.magnitude
        return np.concatenate([residuals, products, borders], axis=1)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Rows [F', 0], [F'' v, F'] and [0, (a, t)]."""
        u, v = np.split(points, 2, axis=1)
        jacobians = self._problem.jacobians(u)
        k, m, n = jacobians.shape
        out = np.zeros((k, 2 * m + 2, 2 * n))
        equations, products, borders = np.split(out, [m, 2 * m], axis=1)
        equations[:, :, :n] = jacobians
        products[:, :, n:] = jacobians
        for i in range(k):
            products[i, :, :n] = self._problem.hessian(u[i]) @ v[i]
        borders[:, :, n:] = self._normal * self.magnitude
        return out


class Deflated(NumericalProblem):
    """The same problem, followed along curves on which F' has rank n - 2.

    Everything but `march` is that of ``problem``.
    """

    def __init__(self, problem: Problem):
        self._problem = problem
        self.take_unknowns_of(problem)

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
        self, start: np.ndarray, tangent: np.ndarray, settings: MarchSettings
    ) -> March:
        """A few pieces of the curve from ``start`` along ``tangent``, by collocation on
        the deflated system."""
        t, a = _tangent_and_normal(self._problem, start, tangent)
        march = march_by_collocation(
            WithNullVector(self._problem, a, t),
            np.concatenate([start, a]),
            np.concatenate([t, np.zeros(self.n)]),
            replace(settings, count=min(settings.count, RUN)),
        )
        status = march.status
        if status is MarchStatus.OPEN:
            gap = float(march.residuals[-1])
            return March.without_solution(gap, settings.order, self.n)
        if status is MarchStatus.STALLED and len(march.pieces):
            status = MarchStatus.RAN  # perhaps only the choice of a and t wore out
        pieces = []
        for piece, residual in zip(march.pieces, march.residuals, strict=True):
            coefficients, length = reparametrised(piece[:, : self.n])
            pieces.append(Piece(coefficients, length, float(residual)))
        return March.of_pieces(status, pieces, settings.order, self.n)


def _tangent_and_normal(
    problem: Problem, point: np.ndarray, tangent: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The unit vector t (n,) of the null space nearest to ``tangent``, and a (n,), the
    one across it."""
    jacobian = problem.jacobians(point[None])[0]
    _, _, right = factors_of(jacobian)
    null_space = right[problem.n - 2 :]
    t = null_space.T @ (null_space @ tangent)
    t /= np.linalg.norm(t)
    quarter_turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    a = null_space.T @ quarter_turn @ (null_space @ t)
    return t, a


def deflated_singular_values(
    problem: Problem, branch: Branch, s: np.ndarray
) -> np.ndarray:
    """The smallest singular value (k,) that the deflated system has across the tangent,
    over the magnitude, at arclengths (k,) of a branch on which F' has rank n - 2."""
    values = np.empty(len(s))
    points, tangents = branch(s), branch(s, 1)
    for k, (point, tangent) in enumerate(zip(points, tangents, strict=True)):
        t, a = _tangent_and_normal(problem, point, tangent)
        system = WithNullVector(problem, a, t)
        matrix = system.jacobians(np.concatenate([point, a])[None])[0]
        matrix[:, : problem.n] *= problem.scale
        matrix[: len(matrix) // 2 - 1] /= problem.scale  # F' itself
        sigma = values_of(matrix / problem.magnitude)
        values[k] = sigma[2 * problem.n - 2]
    return values


def lower_rank_direction(problem: Problem, point: np.ndarray) -> np.ndarray | None:
    """Unit tangent (n,) of a curve through ``point`` along which F' has rank n - 2;
    None where there is none.

    There the section with a small sphere shows two opposite half-branches, and F' has
    no higher rank on either.
    """
    sigma, right = null_spaces(problem, point[None])
    if np.count_nonzero(may_be_shaky(sigma[0])) != 2:
        return None
    null_space = right[0, problem.n - 2 :].T
    cut = section(problem, point, null_space, SECTION_RADIUS * problem.scale)
    if cut.dimension != 1 or len(cut.points) != 2:
        return None
    sigma = singular_values(problem, cut.points)
    if not np.all(is_shaky(sigma[:, problem.n - 2])):
        return None
    chord: np.ndarray = cut.points[1] - cut.points[0]
    length = np.linalg.norm(chord)
    are_opposite = length > SECTION_RADIUS * problem.scale
    return chord / length if are_opposite else None
