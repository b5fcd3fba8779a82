"""The solution set next to a singular point, cut with a small sphere.

Every branch through the point leaves along its null space. The reduced equations of
Liapunov and Schmidt live on that space alone, and their zeros on a small circle or
sphere are the half-branches: two for every branch that passes, whatever the order at
which their tangents or curvatures separate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize.elementwise import find_minimum
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bifurc.numerics.null_spaces import NULL, null_spaces
from bifurc.numerics.roots import bracketed_roots
from bifurc.singular.dimension import local_dimensions

if TYPE_CHECKING:
    from bifurc.problem import Problem

__all__ = ["ReducedEquations", "Section", "is_on_surface", "section"]

ANGLES, FIRST = (
    96,
    0.01,
)  # samples on the circle of a null space of dimension 2, and the angle of the first
MARGIN = (
    8.0  # times the rounding of the reduced equations: what is smaller counts as zero
)
ROOT, TOUCH = (
    1e-10,
    1e-6,
)  # of the largest value on the circle: what counts as zero at a root, and where h touches zero
MOST_TESTED = (
    40  # solutions of higher nullity on a sphere whose local dimension is looked at
)


@dataclass(frozen=True)
class Section:
    """Solutions on a small sphere about a point: ``points`` (h, n), one for each
    half-branch of a curve, and the local ``dimension`` of the solution set: where it is
    2 or more, the sphere meets more than the curves. Where one of the points is a zero
    that is none but for rounding, which may stand for two or for none, ``doubtful``
    says so."""

    points: np.ndarray
    dimension: int
    doubtful: bool = False


class ReducedEquations:
    """The Liapunov-Schmidt reduction at a singular point, on the sphere of ``radius``
    in its null space.

    For a unit vector x of the null space V (n, k) the point is u + radius V x + w(x),
    where w solves the independent equations; what is left is W^T F / radius^2, with W
    the left null space. The chord iteration for w uses the one factorisation made here
    and gains a factor of about the radius each time.
    """

    def __init__(
        self, problem: Problem, point: np.ndarray, null_space: np.ndarray, radius: float
    ):
        jacobian = problem.jacobians(point[None])[0] / problem.magnitude
        left, sigma, right = np.linalg.svd(jacobian)
        rank = problem.n - null_space.shape[1]
        self._problem, self._point, self._null_space, self._radius = (
            problem,
            point,
            null_space,
            radius,
        )
        self._inverse = (right[:rank].T / sigma[:rank]) @ left[:, :rank].T
        self._left = left[:, rank:]
        self.noise = 4e-15 / radius**2

    def points(self, x: np.ndarray) -> np.ndarray:
        """Points (k, n) that solve the independent equations above unit vectors x (k,
        nullity)."""
        base = self._point + self._radius * x @ self._null_space.T
        w = np.zeros_like(base)
        for _ in range(10):
            step = (
                self._problem.residuals(base + w)
                / self._problem.magnitude
                @ self._inverse.T
            )
            w -= step
            if np.abs(step).max(initial=0.0) < 1e-15 * self._problem.scale:
                break
        return base + w

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The reduced equations (k, codimension) at unit vectors x (k, nullity)."""
        residual = self._problem.residuals(self.points(x)) / self._problem.magnitude
        return residual @ self._left / self._radius**2


def section(
    problem: Problem, point: np.ndarray, null_space: np.ndarray, radius: float
) -> Section:
    """Intersection of the solution set with a sphere of ``radius`` about a singular
    point (n,)."""
    if null_space.shape[1] == 2:
        return _circle_section(ReducedEquations(problem, point, null_space, radius))
    return _sphere_section(problem, point, null_space, radius)


def is_on_surface(problem: Problem, point: np.ndarray) -> bool:
    """Whether a solution (n,) lies on a component of dimension 2 or more with the rank
    that belongs to it.

    Where many branches meet, F is so flat that probes nearby look like solutions: the
    section has the last word.
    """
    found = local_dimensions(problem, point[None])
    if not found.dimension[0] == found.nullity[0] > 1:
        return False
    null_space = np.linalg.svd(problem.jacobians(point[None])[0])[2][
        problem.n - found.nullity[0] :
    ].T
    return section(problem, point, null_space, 2e-2 * problem.scale).dimension > 1


# --- nullity 2: every zero on a circle ----------------------------------------------------------------


def _circle_section(equations: ReducedEquations) -> Section:
    """All zeros on the circle: sign changes of the leading combination of the
    equations, also those that its minima between two samples reveal; what does not
    solve the other equations is dropped."""
    angles = FIRST + 2 * np.pi * np.arange(ANGLES) / ANGLES
    values = equations(_unit(angles))
    size = float(np.linalg.norm(values, axis=1).max())
    if size < MARGIN * equations.noise:
        return Section(equations.points(_unit(angles))[:0], 2)
    h = values @ np.linalg.svd(values, full_matrices=False)[2][0]
    # on a small circle term k of the Fourier series is of the order of radius^(k - 2):
    # the samples hold all of it
    series = np.fft.rfft(h) / ANGLES
    series[1:-1] *= 2
    rates = np.arange(len(series))

    def combined(angle: np.ndarray, sign: np.ndarray) -> np.ndarray:
        return np.asarray(
            sign
            * (
                np.exp(1j * (np.asarray(angle)[..., None] - FIRST) * rates) @ series
            ).real
        )

    low, high, touching = _brackets(
        angles, h, combined, MARGIN * equations.noise + 1e-9 * size
    )
    roots = (
        bracketed_roots(lambda x: combined(x, np.ones_like(x)), low, high, 1e-12)
        if len(low)
        else np.empty(0)
    )
    candidates = np.concatenate([roots, touching])
    if not len(candidates):
        return Section(np.empty((0, len(equations.points(_unit(angles[:1]))[0]))), 0)
    left_over = np.linalg.norm(equations(_unit(candidates)), axis=1)
    # a root is exact to rounding, so that all equations hold there or not; a touching
    # point has half the digits
    good = (
        np.repeat([ROOT, TOUCH], [len(roots), len(touching)]) * size
        + MARGIN * equations.noise
    )
    kept = left_over < good
    found = equations.points(_unit(candidates[kept]))
    return Section(found, 1 if len(found) else 0, bool(np.any(kept[len(roots) :])))


def _brackets(
    angles: np.ndarray,
    h: np.ndarray,
    combined: Callable[[np.ndarray, np.ndarray], np.ndarray],
    zero: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Brackets (low, high) of the sign changes of ``h`` on the circle, and the angles
    where it only touches zero."""
    step, after = angles[1] - angles[0], np.roll(h, -1)
    changes = np.flatnonzero(np.sign(h) * np.sign(after) < 0)
    low, high = angles[changes], angles[changes] + step
    dips = np.flatnonzero(
        (np.abs(h) <= np.abs(np.roll(h, 1))) & (np.abs(h) < np.abs(after))
    )
    dips = dips[
        (np.sign(h[dips]) == np.sign(after[dips]))
        & (np.sign(h[dips]) == np.sign(np.roll(h, 1)[dips]))
    ]
    if not len(dips):
        return low, high, np.empty(0)
    at, sign = angles[dips], np.sign(h[dips])
    bottom = find_minimum(combined, (at - step, at, at + step), args=(sign,))
    below = bottom.f_x < -zero
    low = np.concatenate([low, at[below] - step, bottom.x[below]])
    high = np.concatenate([high, bottom.x[below], at[below] + step])
    return low, high, bottom.x[np.abs(bottom.f_x) <= zero]


def _unit(angles: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


# --- nullity 3 and more: many starts on a sphere ------------------------------------------------------


def _sphere_section(
    problem: Problem, point: np.ndarray, null_space: np.ndarray, radius: float
) -> Section:
    """What Gauss-Newton reaches from starts spread over the sphere."""
    k = null_space.shape[1]
    half = np.random.default_rng(k).normal(size=(100 * (k - 1), k))
    half /= np.linalg.norm(half, axis=1)[:, None]
    starts = point + radius * np.concatenate([half, -half]) @ null_space.T
    found, gaps, last = problem.project_to_sphere(starts, point, radius)
    # next to the point F is of order radius^2 whatever the direction: the residual must
    # be far below that
    good = found[
        (gaps < 1e-8 * (radius / problem.scale) ** 2 + 5e-15) & (last < 1e-4 * radius)
    ]
    if not len(good):
        return Section(np.empty((0, problem.n)), 0)
    near = cKDTree(good).query_pairs(1e-4 * radius, output_type="ndarray")
    links = csr_array((np.ones(len(near)), tuple(near.T)), shape=(len(good),) * 2)
    clusters = good[
        np.unique(connected_components(links, directed=False)[1], return_index=True)[1]
    ]
    return _told_apart(problem, clusters)


def _told_apart(problem: Problem, found: np.ndarray) -> Section:
    """The section of solutions (h, n) on a sphere: those on curves are its points,
    those on surfaces its dimension.

    A curve may be shaky, and a solution of higher nullity on it; the dimension of the
    nearby solutions decides.
    """
    sigma, _ = null_spaces(problem, found)
    doubtful = np.flatnonzero(sigma[:, -2] < NULL)
    tested = doubtful[:: max(1, len(doubtful) // MOST_TESTED)]
    dimension = local_dimensions(problem, found[tested]).dimension
    if np.all(dimension < 2):
        return Section(found, 1)
    apart = np.setdiff1d(np.arange(len(found)), doubtful)
    return Section(found[apart], int(dimension.max()))
