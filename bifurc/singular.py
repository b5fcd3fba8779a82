"""Singular points: where the rank of F' drops below what it is along the curve."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from bifurc.problem import Problem

__all__ = [
    "Kind",
    "Section",
    "SingularPoint",
    "classify_singular_point",
    "locate_singular_point",
    "second_order_tangents",
    "section",
]


class Kind(Enum):
    """What a singular point is."""

    BIFURCATION = "bifurcation"  # two or more branches meet
    RANK_DROP = "rank drop"  # one smooth branch passes
    ISOLATED = "isolated"  # no branch passes
    END = "end"  # a branch ends: a cusp or an end in a component of other dimension
    DIMENSION_CHANGE = "dimension change"  # it lies on a component of dimension 2 or more
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class SingularPoint:
    """A located singular point.

    ``u`` (n,), ``rank`` of F' there, ``null_space`` (n, k), ``error``: estimate of the distance to the exact
    point, ``half_branches`` (h, n): unit directions in which solutions leave it, as seen on a small sphere, ``tangents``
    (t, n) of the branches from the second-order equations (t = 0 where these do not decide), ``dimension``
    of the solution set nearby, ``order`` of the argument that decided: 2, or 0 for the section alone, which was made at ``radius``.
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
            return Kind.DIMENSION_CHANGE
        count = len(self.half_branches)
        if count == 0:
            return Kind.ISOLATED
        if count == 1:
            return Kind.END
        if count == 2:
            return Kind.RANK_DROP
        return Kind.BIFURCATION if count % 2 == 0 else Kind.UNDECIDED


# --- location -----------------------------------------------------------------------------------------


def locate_singular_point(
    problem: Problem, start: np.ndarray, nullity: int, reach: float, iterations: int = 20
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """The point near ``start`` where F = 0 and F' has a null space of dimension ``nullity``: (u, V (n, k), error).

    Gauss-Newton on ``F(u) = 0, F'(u) V = 0, V^T V = I`` for the point and its null space together: in the
    unknowns (du, dV) the matrix is

        [ F'      0           ]
        [ F''V    I_k (x) F'  ]
        [ 0       I_k (x) V^T ]   (columns of dV orthogonal to V)

    which is regular although F' is not. None where it does not converge or moves farther than ``reach``. The error
    estimate is the last correction plus rounding over the smallest singular value of that matrix.
    """
    n, k = problem.n, nullity
    u = start.copy()
    jacobian = problem.jacobians(u[None])[0] / problem.magnitude
    basis = np.linalg.svd(jacobian)[2][n - k :].T
    m = len(jacobian)
    smallest, moved = np.inf, np.inf
    for iteration in range(iterations):
        residual = problem.residuals(u[None])[0] / problem.magnitude
        jacobian = problem.jacobians(u[None])[0] / problem.magnitude
        hessian = problem.hessian(u) / problem.magnitude
        matrix = np.zeros((m + k * (m + k), n + k * n))
        matrix[:m, :n] = jacobian
        right = np.zeros(len(matrix))
        right[:m] = -residual
        for j in range(k):
            rows, columns = slice(m + j * m, m + (j + 1) * m), slice(n + j * n, n + (j + 1) * n)
            matrix[rows, :n] = hessian @ basis[:, j]
            matrix[rows, columns] = jacobian
            right[rows] = -jacobian @ basis[:, j]
            ortho = slice(m + k * m + j * k, m + k * m + (j + 1) * k)
            matrix[ortho, columns] = basis.T
        left, sigma, transposed = np.linalg.svd(matrix, full_matrices=False)
        kept = sigma > 1e-9 * sigma[0]
        smallest = float(sigma[kept][-1] / sigma[0])
        step = transposed[kept].T @ ((left[:, kept].T @ right) / sigma[kept])
        du = step[:n]
        previous, moved = moved, float(np.linalg.norm(du))
        u = u + du
        basis = np.linalg.qr(basis + step[n:].reshape(k, n).T)[0]
        if np.linalg.norm(problem.difference(u, start)) > reach:
            return None
        if moved < 1e-14 * problem.scale or (iteration > 3 and moved > 0.5 * previous and moved < 1e-9 * problem.scale):
            break
    values = np.linalg.svd(problem.jacobians(u[None])[0] / problem.magnitude, compute_uv=False)
    residual = np.linalg.norm(problem.residuals(u[None])[0]) / problem.magnitude
    tail = values[n - k] if len(values) > n - k else 0.0
    if residual > 1e-11 or tail > 1e-8:
        return None
    error = min(moved, previous) + 1e-15 / max(smallest, 1e-15)
    return u, basis, error


# --- tangent cone of second order ---------------------------------------------------------------------


def second_order_tangents(problem: Problem, point: np.ndarray, null_space: np.ndarray) -> np.ndarray | None:
    """Unit tangents (t, n) at a singular point of nullity 2 that second order allows; None where it does not decide.

    With W the left null space, all branches have tangents V x with W^T F''(Vx, Vx) = 0: binary quadratic forms,
    as many as W has columns, and often proportional to each other. They are reduced to an independent set by an SVD of
    their coefficients. One independent form with two distinct real roots gives two tangents, without real roots none;
    two or more have a common root or not. No form at all, or a double root, is for higher order.
    """
    if null_space.shape[1] != 2:
        return None
    jacobian = problem.jacobians(point[None])[0] / problem.magnitude
    left = np.linalg.svd(jacobian)[0][:, problem.n - 2 :]
    hessian = problem.hessian(point) / problem.magnitude
    forms = np.einsum("mw,mij,ia,jb->wab", left, hessian, null_space, null_space)
    coefficients = np.stack([forms[:, 0, 0], 2 * forms[:, 0, 1], forms[:, 1, 1]], axis=1)
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
    """Angles in [0, pi) with a cos^2 + b cos sin + c sin^2 = 0, for a non-negative discriminant."""
    # with double angles: (a + c)/2 + (a - c)/2 cos 2t + b/2 sin 2t = 0
    phase, size = np.arctan2(b, a - c), np.hypot(b, a - c)
    offset = np.arccos(np.clip(-(a + c) / size, -1.0, 1.0))
    return np.array([(phase + offset) / 2, (phase - offset) / 2]) % np.pi


def _have_common_root(pair: np.ndarray) -> bool:
    """Whether the resultant of two binary quadratic forms vanishes."""
    (a, b, c), (d, e, f) = pair
    return bool(abs((a * f - c * d) ** 2 - (a * e - b * d) * (b * f - c * e)) < 1e-6)


# --- section with a small sphere ----------------------------------------------------------------------


@dataclass(frozen=True)
class Section:
    """Solutions on a small sphere about a point: ``points`` (h, n), one for each half-branch, and the local
    ``dimension`` of the solution set (2 stands for 2 or more: the section is not finite)."""

    points: np.ndarray
    dimension: int


def section(problem: Problem, point: np.ndarray, null_space: np.ndarray, radius: float) -> Section:
    """Intersection of the solution set with the sphere of ``radius`` about a singular point.

    Starts are spread over the unit sphere of the null space, to which all branches are tangent.
    """
    directions = _spread(null_space.shape[1])
    starts = point + radius * directions @ null_space.T
    found, gaps, last = problem.project_to_sphere(starts, point, radius)
    # next to the point F is of order radius^2 whatever the direction: the residual must be far below that
    good = found[(gaps < 1e-8 * (radius / problem.scale) ** 2 + 5e-15) & (last < 1e-4 * radius)]
    clusters: list[np.ndarray] = []
    for candidate in good:
        if all(np.linalg.norm(candidate - other) > 1e-2 * radius for other in clusters):
            clusters.append(candidate)
    if len(clusters) > max(12, len(starts) // 4):
        return Section(np.array(clusters), 2)
    return Section(np.array(clusters).reshape(-1, len(point)), 1 if clusters else 0)


def _spread(k: int) -> np.ndarray:
    """Unit vectors over the sphere in R^k, in opposite pairs."""
    if k == 1:
        return np.array([[1.0], [-1.0]])
    if k == 2:
        angles = 0.1 + np.arange(24) * np.pi / 12
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)
    half = np.random.default_rng(k).normal(size=(100 * (k - 1), k))
    half /= np.linalg.norm(half, axis=1)[:, None]
    return np.concatenate([half, -half])


def classify_singular_point(
    problem: Problem, point: np.ndarray, null_space: np.ndarray, error: float, radius: float = 1e-2
) -> SingularPoint:
    """The located point with its half-branches, tangents and local dimension.

    The section is made at ``radius`` and at a quarter of it (in units of the problem's scale); where the two disagree the
    radius shrinks, down to 1/64 of the first. Tangents of second order are kept where their number agrees with the section.
    """
    k = null_space.shape[1]
    tangents = second_order_tangents(problem, point, null_space)
    radius *= problem.scale
    outer = section(problem, point, null_space, radius)
    agreed = False
    for _ in range(3):
        inner = section(problem, point, null_space, radius / 4)
        if inner.dimension == outer.dimension and (inner.dimension > 1 or len(inner.points) == len(outer.points)):
            agreed = True
            break
        radius, outer = radius / 4, inner
    half = (outer.points - point) / radius
    decided = tangents is not None and 2 * len(tangents) == len(half) and agreed
    return SingularPoint(
        u=point, rank=problem.n - k, null_space=null_space, error=error, half_branches=half if agreed else half[:0],
        tangents=tangents if decided and tangents is not None else np.empty((0, len(point))),
        dimension=outer.dimension if agreed else 0, order=2 if decided else 0, radius=radius,
    )  # fmt: skip
