"""Singular points: where the rank of F' drops below what it is along the curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from bifurc.problem import Problem
from bifurc.singular.sphere import section

__all__ = [
    "Kind",
    "SingularPoint",
    "classify_singular_point",
    "locate_singular_point",
    "second_order_tangents",
]

# relative residual of a singular point: above it is a near miss, which doubles still
# resolve
SOLVED = 1e-13
RADII = (
    2e-2,
    4e-2,
    8e-2,
    5e-3,
    1.25e-3,
)  # of the sections, over the scale, in the order in which they are tried


class Kind(Enum):
    """What a singular point is."""

    BIFURCATION = "bifurcation"  # two or more branches meet
    RANK_DROP = "rank drop"  # one smooth branch passes
    CUSP = "cusp"  # two half-branches leave to the same side
    ISOLATED = "isolated"  # no branch passes
    DIMENSION_CHANGE = (
        "dimension change"  # branches meet a component of dimension 2 or more
    )
    # it lies on a component of dimension 2 or more, and no branch passes
    SURFACE = "singular point of a surface"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class SingularPoint:
    """A located singular point.

    ``u`` (n,), ``rank`` of F' there, ``null_space`` (n, k), ``error``: estimate of the
    distance to the exact point, ``half_branches`` (h, n): unit directions in which
    solutions leave it, as seen on a small sphere, ``tangents`` (t, n) of the branches
    from the second-order equations (t = 0 where these do not decide), ``dimension`` of
    the solution set nearby (-1 where sections of two radii disagree), ``order`` of the
    argument that decided: 2, or 0 for the section alone, which was made at ``radius``.
    """

    u: np.ndarray
    rank: int
    null_space: np.ndarray
    error: float
    half_branches: np.ndarray
    tangents: np.ndarray
    dimension: int
    order: int
    radius: float

    @property
    def kind(self) -> Kind:
        """What the half-branches alone say."""
        if self.dimension > 1:
            return Kind.DIMENSION_CHANGE if len(self.half_branches) else Kind.SURFACE
        if self.dimension < 0:
            return Kind.UNDECIDED
        count = len(self.half_branches)
        if count == 0:
            return Kind.ISOLATED
        if count == 2:
            return (
                Kind.CUSP
                if self.half_branches[0] @ self.half_branches[1] > 0
                else Kind.RANK_DROP
            )
        return Kind.BIFURCATION if count % 2 == 0 else Kind.UNDECIDED


# --- location -----------------------------------------------------------------------------------------


def locate_singular_point(
    problem: Problem,
    start: np.ndarray,
    nullity: int,
    reach: float,
    iterations: int = 60,
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """The point near ``start`` where F = 0 and F' has a null space of dimension
    ``nullity``: (u, V (n, k), error).

    Gauss-Newton on ``F(u) = 0, F'(u) V = 0, V^T V = I`` for the point and its null
    space together: in the unknowns (du, dV) the matrix is

        [ F'      0           ]
        [ F''V    I_k (x) F'  ]
        [ 0       I_k (x) V^T ]   (columns of dV orthogonal to V)

    which is regular at a simple singular point although F' is not; at one of higher
    order the iteration converges linearly and to fewer digits, which the error says.
    None where it does not converge or moves farther than ``reach``. The error estimate
    is the last correction plus rounding over the smallest singular value of that
    matrix.
    """
    n, k = problem.n, nullity
    u = start.copy()
    basis = np.linalg.svd(problem.jacobians(u[None])[0])[2][n - k :].T
    moves: list[float] = []
    condition, unknowns, weak = 0.0, 0, np.empty((0, n))
    for _ in range(iterations):
        matrix, right = _augmented_system(problem, u, basis)
        left, sigma, transposed = np.linalg.svd(matrix, full_matrices=False)
        kept = sigma > 1e-12 * sigma[0]
        weak = transposed[sigma < 1e-6 * sigma[0]][:, :n]
        if np.count_nonzero(kept) < unknowns:
            break  # of higher order, and so near that the next step would be rounding
        unknowns, condition = (
            int(np.count_nonzero(kept)),
            float(sigma[0] / sigma[kept][-1]),
        )
        step = transposed[kept].T @ ((left[:, kept].T @ right) / sigma[kept])
        u = u + step[:n]
        basis = np.linalg.qr(basis + step[n:].reshape(k, n).T)[0]
        moves.append(float(np.linalg.norm(step[:n])))
        if np.linalg.norm(problem.difference(u, start)) > reach:
            return None
        stagnant = len(moves) > 4 and moves[-1] > 0.9 * moves[-2]
        if moves[-1] < 1e-15 * min(condition, 1e6) * problem.scale or (
            stagnant and moves[-1] < 1e-7 * problem.scale
        ):
            break
    for _ in range(
        2
    ):  # at a point of higher order the last steps are poor also in the equations that are not
        left, sigma, right = np.linalg.svd(
            problem.jacobians(u[None])[0] / problem.magnitude, full_matrices=False
        )
        residuals = problem.residuals(u[None])[0] / problem.magnitude
        u = u - right[: n - k].T @ (left[:, : n - k].T @ residuals / sigma[: n - k])
    values = np.linalg.svd(
        problem.jacobians(u[None])[0] / problem.magnitude, compute_uv=False
    )
    residual = np.linalg.norm(problem.residuals(u[None])[0]) / problem.magnitude
    tail = values[n - k] if len(values) > n - k else 0.0
    if (
        residual > SOLVED
        or tail > 1e-7
        or not moves
        or moves[-1] > 1e-4 * problem.scale
    ):
        return None
    error = _location_error(moves, condition) * problem.scale
    for direction in weak:
        if np.linalg.norm(direction) > 0.1:
            u, doubt = _centred(
                problem, u, direction / np.linalg.norm(direction), k, reach
            )
            error = max(error, doubt)
    return u, basis, error


def _centred(
    problem: Problem, u: np.ndarray, direction: np.ndarray, nullity: int, reach: float
) -> tuple[np.ndarray, float]:
    """The middle of the stretch through ``u`` along ``direction`` on which the singular
    point cannot be told from rounding, and half of its length: the point lies on it."""
    tau = reach * np.geomspace(1e-7, 1.0, 120)
    ends = []
    for sign in (1.0, -1.0):
        line = u + sign * tau[:, None] * direction
        sigma = np.linalg.svd(
            problem.jacobians(line) / problem.magnitude, compute_uv=False
        )
        small = (
            sigma[:, problem.n - nullity]
            if sigma.shape[1] > problem.n - nullity
            else np.zeros(len(line))
        )
        off = (
            small + np.linalg.norm(problem.residuals(line), axis=1) / problem.magnitude
        )
        beyond = np.flatnonzero(off > 1e-12)
        ends.append(float(tau[beyond[0]]) if len(beyond) else reach)
    return u + 0.5 * (ends[0] - ends[1]) * direction, 0.5 * (ends[0] + ends[1])


def _augmented_system(
    problem: Problem, u: np.ndarray, basis: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and right-hand side of one Gauss-Newton step of
    `locate_singular_point`."""
    n, k = basis.shape
    residual = problem.residuals(u[None])[0] / problem.magnitude
    jacobian = problem.jacobians(u[None])[0] / problem.magnitude
    hessian = problem.hessian(u) / problem.magnitude
    m = len(jacobian)
    matrix, right = np.zeros((m + k * (m + k), n + k * n)), np.zeros(m + k * (m + k))
    matrix[:m, :n], right[:m] = jacobian, -residual
    for j in range(k):
        rows, columns = (
            slice(m + j * m, m + (j + 1) * m),
            slice(n + j * n, n + (j + 1) * n),
        )
        matrix[rows, :n], matrix[rows, columns] = hessian @ basis[:, j], jacobian
        right[rows] = -jacobian @ basis[:, j]
        matrix[m + k * m + j * k : m + k * m + (j + 1) * k, columns] = basis.T
    return matrix, right


def _location_error(moves: list[float], condition: float) -> float:
    """Estimate of the distance left: rounding times the condition where convergence was
    quadratic; where it was linear, the rest of the geometric series, twice."""
    rounding = 1e-15 * condition
    ratio = moves[-1] / moves[-2] if len(moves) > 1 and moves[-2] > 0 else 0.0
    if moves[-1] <= 10 * rounding and ratio < 0.1 and condition < 1e7:
        return rounding + moves[-1]
    ratio = min(max(ratio, 0.5), 0.9)
    return (
        2.0 * moves[-1] * ratio / (1.0 - ratio) + rounding
        if condition < 1e7
        else 4.0 * moves[-1] / (1.0 - ratio)
    )


# --- tangent cone of second order ---------------------------------------------------------------------


def second_order_tangents(
    problem: Problem, point: np.ndarray, null_space: np.ndarray
) -> np.ndarray | None:
    """Unit tangents (t, n) at a singular point of nullity 2 that second order allows;
    None where it does not decide.

    With W the left null space, all branches have tangents V x with W^T F''(Vx, Vx) = 0:
    binary quadratic forms, as many as W has columns, and often proportional to each
    other. They are reduced to an independent set by an SVD of their coefficients. One
    independent form with two distinct real roots gives two tangents, without real roots
    none; two or more have a common root or not. No form at all, or a double root, is
    for higher order.
    """
    if null_space.shape[1] != 2:
        return None
    jacobian = problem.jacobians(point[None])[0] / problem.magnitude
    left = np.linalg.svd(jacobian)[0][:, problem.n - 2 :]
    hessian = problem.hessian(point) / problem.magnitude
    forms = np.einsum("mw,mij,ia,jb->wab", left, hessian, null_space, null_space)
    coefficients = np.stack(
        [forms[:, 0, 0], 2 * forms[:, 0, 1], forms[:, 1, 1]], axis=1
    )
    _, sigma, right = np.linalg.svd(coefficients, full_matrices=False)
    if sigma[0] < 1e-7:
        return None
    independent = right[sigma > 1e-6 * sigma[0]]
    a, b, c = independent[0]
    discriminant = b * b - 4 * a * c
    if len(independent) == 1 and abs(discriminant) < 1e-6:
        return None
    if discriminant < 0:
        return np.empty((0, len(point)))
    angles = _roots_on_circle(a, b, c)
    x = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    powers = np.stack([x[:, 0] ** 2, x[:, 0] * x[:, 1], x[:, 1] ** 2], axis=1)
    common = np.all(np.abs(powers @ independent.T) < 1e-6, axis=1)
    if not np.any(common) and len(independent) == 2 and _have_common_root(independent):
        return None
    return x[common] @ null_space.T


def _roots_on_circle(a: float, b: float, c: float) -> np.ndarray:
    """Angles in [0, pi) with a cos^2 + b cos sin + c sin^2 = 0, for a non-negative
    discriminant."""
    # with double angles: (a + c)/2 + (a - c)/2 cos 2t + b/2 sin 2t = 0
    phase, size = np.arctan2(b, a - c), np.hypot(b, a - c)
    offset = np.arccos(np.clip(-(a + c) / size, -1.0, 1.0))
    return np.array([(phase + offset) / 2, (phase - offset) / 2]) % np.pi


def _have_common_root(pair: np.ndarray) -> bool:
    """Whether the resultant of two binary quadratic forms vanishes."""
    (a, b, c), (d, e, f) = pair
    return bool(abs((a * f - c * d) ** 2 - (a * e - b * d) * (b * f - c * e)) < 1e-6)


# --- classification -----------------------------------------------------------------------------------


def classify_singular_point(
    problem: Problem,
    point: np.ndarray,
    null_space: np.ndarray,
    error: float,
    radii: Sequence[float] = RADII,
) -> SingularPoint:
    """The located point with its half-branches, tangents and local dimension.

    The section is made at the first of ``radii`` and at half of it (in units of the
    problem's scale); where the two disagree, at the next: at a larger one branches that
    touch separate, at a smaller one other singular points stay outside. A sphere
    smaller than the ``error`` of the point says nothing. One in doubt counts only where
    all are. Tangents of second order are kept where their number agrees with the
    section.
    """
    k = null_space.shape[1]
    tangents = second_order_tangents(problem, point, null_space)
    agreed, radius, outer = False, 0.0, None
    for share in radii:
        size = share * problem.scale
        if outer is not None and size / 2 < error:
            continue  # the point may lie outside of that sphere
        pair = [section(problem, point, null_space, r) for r in (size, size / 2)]
        agree = pair[0].dimension == pair[1].dimension and len(pair[0].points) == len(
            pair[1].points
        )
        clear = not any(s.doubtful for s in pair)
        agree = agree and size / 2 > error
        if outer is None or (agree and (clear or not agreed)):
            agreed, radius, outer = agree, size, pair[0]
        if agree and clear:
            break
    assert outer is not None
    half = (outer.points - point) / radius
    decided = tangents is not None and 2 * len(tangents) == len(half) and agreed
    return SingularPoint(
        u=point,
        rank=problem.n - k,
        null_space=null_space,
        error=error,
        half_branches=half if agreed else half[:0],
        tangents=tangents
        if decided and tangents is not None
        else np.empty((0, len(point))),
        dimension=outer.dimension if agreed else -1,
        order=2 if decided else 0,
        radius=radius,
    )
