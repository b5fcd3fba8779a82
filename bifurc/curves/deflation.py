"""Curves along which F' has a lower rank throughout: shaky motions, double components.

There F = 0 does not determine the curve well enough to correct a point onto it: across
it F grows with the square of the distance. One step of deflation (Ojika 1987; Leykin,
Verschelde and Zhao 2006) adds a null vector v that is not the tangent as further
unknown,

    F(u) = 0,   F'(u) v = 0,   a . v = 1,   t . v = 0,

with a and t from the null space at the start of a run. The curve of (u, v) is regular
where the double component is of first order.

Where others meet such a curve F' does not say: it has rank n - 2 all along. The matrix
of the deflated system is regular where the curve is a double one, as z = 0 = (z - y)^2
is, and singular where others meet it.

A component of any lower rank r is one of the solutions of F = 0 at which all singular
values of F' after number r are zero, too.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.branch import Branch
from bifurc.curves.monitor import Profile
from bifurc.decisions import (
    closes_to_rounding,
    is_shaky,
    is_zero_along,
    may_be_crossed,
    may_be_shaky,
)
from bifurc.domain import Domain
from bifurc.function_problem import NumericalProblem
from bifurc.numerics.collocation import march_by_collocation, reparametrised
from bifurc.numerics.corrector import compiled_equations
from bifurc.numerics.null_spaces import null_spaces
from bifurc.numerics.singular_values import factors_of, singular_values, values_of
from bifurc.problem import Problem
from bifurc.singular.prestress import positive_combination
from bifurc.singular.sphere import section
from bifurc.system import March, MarchSettings, MarchStatus, Piece, Shortcuts

RUN = 4  # pieces made with one choice of a and t, before both are renewed
SECTION_RADIUS = 1e-2  # of the sphere on which half-branches are looked for, in scales
DIP = 0.5  # of the typical value, below which a minimum at the nodes is looked at
NARROWER, ROUNDS = 4.0, 16  # by which the places about a minimum close in on it
STEPS = (
    1e-3,
    1e-5,
    1e-7,
)  # over the scale, to both sides of where two slopes are to meet
UNKNOWN = 0
TINY = 1e-300  # keeps what vanishes on both sides from being divided by
NEXT = 1e-4  # of the scale: how far a solution known to half the digits may be off


class WithNullVector(NumericalProblem):
    """The deflated system in the unknowns (u, v), for one choice of a and t."""

    def __init__(self, problem: Problem, a: np.ndarray, t: np.ndarray):
        n = problem.n
        self._problem = problem
        self._normal = np.vstack([a, t])
        domain = problem.domain
        self.domain = Domain(
            names=domain.names * 2,
            units=domain.units + ("",) * n,
            periods=np.concatenate([domain.periods, np.full(n, np.inf)]),
            bounds=np.tile([-np.inf, np.inf], (2 * n, 1)),
            scale=domain.scale,
        )
        self.magnitude = problem.magnitude

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
        hessians = self._problem.hessians(u)
        for i in range(k):
            products[i, :, :n] = hessians[i] @ v[i]
        borders[:, :, n:] = self._normal * self.magnitude
        return out


class Deflated(NumericalProblem):
    """The same problem, followed along curves on which F' has rank n - 2.

    Everything but `march` is that of ``problem``.
    """

    def __init__(self, problem: Problem):
        self._problem = problem
        self.domain, self.magnitude = problem.domain, problem.magnitude

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self._problem.residuals(points)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self._problem.jacobians(points)

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""
        return self._problem.hessians(points)

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
        matrix[:, : problem.n] *= problem.domain.scale
        matrix[: len(matrix) // 2 - 1] /= problem.domain.scale  # F' itself
        sigma = values_of(matrix / problem.magnitude)
        # of fewer equations the last values are zero
        values[k] = sigma[2 * problem.n - 2] if len(sigma) > 2 * problem.n - 2 else 0.0
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
    cut = section(problem, point, null_space, SECTION_RADIUS * problem.domain.scale)
    if cut.dimension != 1 or len(cut.points) != 2:
        return None
    sigma = singular_values(problem, cut.points)
    if not np.all(is_shaky(sigma[:, problem.n - 2])):
        return None
    chord: np.ndarray = cut.points[1] - cut.points[0]
    length = np.linalg.norm(chord)
    are_opposite = length > SECTION_RADIUS * problem.domain.scale
    return chord / length if are_opposite else None


# --- what meets such a curve ----------------------------------------------------------


class LowerRank(NamedTuple):
    """The ``multiplicity`` of a curve, of one of lower rank 2 or, not known, 0, and
    the arclengths ``crossings`` (k,) at which the deflated system is singular."""

    multiplicity: int
    crossings: np.ndarray


ORDINARY = LowerRank(1, np.empty(0))  # that of a curve of full rank


def lower_rank_along(problem: Problem, branch: Branch, profile: Profile) -> LowerRank:
    """What deflation says of a branch on which F' has a ``profile`` of rank n - 2 or
    less; of less it says nothing."""
    unknown = LowerRank(UNKNOWN, np.empty(0))
    if profile.rank < problem.n - 2:
        return unknown
    nodes = profile.arclength.ravel()
    values = deflated_singular_values(problem, branch, nodes)
    typical = float(np.median(values))
    if is_zero_along(typical):
        return unknown
    are_low = _are_dips(values, branch.closed) & (values < DIP * typical)
    dips = np.flatnonzero(are_low).tolist()
    places = np.array([_bottom(problem, branch, nodes, k) for k in dips])
    depths = deflated_singular_values(problem, branch, places)
    return LowerRank(2, places[may_be_crossed(depths, typical)])


def _are_dips(values: np.ndarray, is_closed: bool) -> np.ndarray:
    """Which of a row of values (k,) are not above their neighbours; the ends of an open
    row are none."""
    is_dip: np.ndarray = (values <= np.roll(values, 1)) & (values < np.roll(values, -1))
    if not is_closed:
        is_dip[[0, -1]] = False
    return is_dip


def _bottom(problem: Problem, branch: Branch, nodes: np.ndarray, k: int) -> float:
    """The arclength of the minimum about node ``k``; where it is a zero, to rounding."""
    reach = float(np.max(np.diff(nodes[max(k - 1, 0) : k + 2])))
    middle = float(nodes[k])
    for _ in range(ROUNDS):
        trial = middle + reach * np.linspace(-1.0, 1.0, 9)
        values = deflated_singular_values(problem, branch, _within(branch, trial))
        middle = float(trial[np.argmin(values)])
        reach /= NARROWER
    for step in STEPS:  # about a zero the two slopes are as steep as each other
        sides = middle + step * problem.domain.scale * np.array([-1.0, 1.0])
        left, right = deflated_singular_values(problem, branch, _within(branch, sides))
        middle += (
            step * problem.domain.scale * float((left - right) / (left + right + TINY))
        )
    return float(_within(branch, np.array([middle]))[0])


def _within(branch: Branch, s: np.ndarray) -> np.ndarray:
    """Arclengths on the branch: modulo its length, or none beyond its ends."""
    if branch.closed:
        return np.asarray(s % branch.length)
    return np.asarray(np.clip(s, 0.0, branch.length))


# --- components of lower rank ---------------------------------------------------------


class RankDeflated(NumericalProblem):
    """The equations of a ``problem``, and that F' has no higher ``rank``: with
    orthonormal bases U and V of the last left and right singular vectors at a point,

        F(u) = 0,   U^T F'(u) V = 0,

    whose derivative there, with U and V held, is that of a regular system where the
    component is double to first order. The bases are those at each point: values of the further equations at two points
    have no signs in common, only their sizes have a meaning.
    """

    def __init__(self, problem: Problem, rank: int):
        self._problem = problem
        self._rank = rank
        self.domain, self.magnitude = problem.domain, problem.magnitude

    @cached_property
    def _equations(self) -> object:
        """F and F' for compiled methods."""
        return _core.rank_deflated(compiled_equations(self._problem), self._rank)

    @property
    def shortcuts(self) -> Shortcuts:
        """What compiled code does in one call."""
        return Shortcuts(equations=lambda magnitude: self._equations)

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F and the singular values after number ``rank``, as a matrix (k, m + e)."""
        at = np.ascontiguousarray(points)
        return self.magnitude * _core.residuals_at(self._equations, at)

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' and below it U^T F'' V (k, m + e, n)."""
        at = np.ascontiguousarray(points)
        return self.magnitude * _core.jacobians_at(self._equations, at)

    def next_to(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) of lower rank next to solutions ``points`` (k, n) known to
        half the digits, and whether there is one (k,)."""
        solutions, gaps = self.project(points)
        offsets = np.linalg.norm(self.domain.difference(solutions, points), axis=1)
        return solutions, closes_to_rounding(gaps) & (
            offsets < NEXT * self.domain.scale
        )

    def is_curve_alone(self, point: np.ndarray) -> bool:
        """Whether second order shows that a curve alone runs through a solution (n,), and
        no surface on which the rank is lower along a curve: one stress has a form that is
        positive for every flex across the curve."""
        tangent = factors_of(self.jacobians(point[None])[0]).right[-1]
        factors = factors_of(self._problem.jacobians(point[None])[0] / self.magnitude)
        flexes, stresses = factors.right[self._rank :], factors.left[:, self._rank :].T
        beside = flexes - np.outer(flexes @ tangent, tangent)
        across = factors_of(beside).right[: len(flexes) - 1]
        hessian = self._problem.hessians(point[None])[0] / self.magnitude
        forms = np.tensordot(stresses, across @ (hessian @ across.T), axes=1)
        return positive_combination(forms)[0] is not None
