"""The dimension of the solution set about a solution.

Where F' has one rank r in a neighbourhood of a solution, the solutions there are a
manifold of dimension n - r (constant rank theorem; Lee 2013, Introduction to Smooth
Manifolds, theorem 4.12). The corank at a single point does not tell: it is larger at
singular points, and all along components that are shaky. So the null space of F' is
probed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.limits import Deadline
from bifurc.numerics.null_spaces import NULL, null_spaces
from bifurc.problem import Problem

__all__ = ["LocalDimensions", "local_dimensions"]

# of the probes, over the scale: at much less, degenerate singular points would look
# like surfaces
RADIUS = 5e-3
# a probe that loses a larger share of itself when it is projected does not lie along
# the solutions
KEPT = 0.05
CHUNK = 256  # points probed between two looks at the clock


@dataclass(frozen=True)
class LocalDimensions:
    """What the solution set is about each of k solutions.

    ``dimension`` (k,) of the solutions nearby, the largest where several components
    meet, -1 where it was not found; ``nullity`` (k,) of F' at the point; ``regular``
    (k,) whether the solutions nearby are a manifold and F' has the rank that belongs to
    it.
    """

    dimension: np.ndarray
    nullity: np.ndarray
    regular: np.ndarray


def local_dimensions(
    problem: Problem, points: np.ndarray, deadline: Deadline | None = None
) -> LocalDimensions:
    """Dimension of the solution set about each of the solutions ``points`` (k, n).

    From every point probes go out along the null space of F', of dimension d, and are
    projected onto the solutions. Where all of them stay what they were, but for
    curvature, the solutions fill d dimensions. Where F' has a higher rank at the ends
    of probes, the point is singular, and the dimension is the largest found at those
    ends. Where the rank is the same all around and yet probes are lost, the component
    is shaky: the dimension is that of the space which the ends of the probes span.
    Points not reached before the ``deadline`` get dimension -1.
    """
    deadline = deadline or Deadline()
    count = len(points)
    dimension, nullity = np.full(count, -1), np.zeros(count, dtype=int)
    regular = np.zeros(count, dtype=bool)
    for begin in range(0, count, CHUNK):
        if deadline.passed:
            break
        part = slice(begin, begin + CHUNK)
        sigma, right = null_spaces(problem, points[part])
        nullity[part] = np.count_nonzero(sigma < NULL, axis=1)
        for k in np.unique(nullity[part]):
            rows = begin + np.flatnonzero(nullity[part] == k)
            basis = right[rows - begin, problem.n - k :]
            dimension[rows], regular[rows] = _dimensions_of_nullity(
                problem, points[rows], basis
            )
    return LocalDimensions(dimension, nullity, regular)


def _dimensions_of_nullity(
    problem: Problem, points: np.ndarray, basis: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Dimension and regularity of points (b, n) whose null spaces (b, k, n) all have
    dimension k."""
    count, k = basis.shape[:2]
    if k == 0:
        return np.zeros(count, dtype=int), np.ones(count, dtype=bool)
    ends, reached, loss = _probe(problem, points, basis, RADIUS)
    regular = loss.max(axis=1) < KEPT
    dimension = np.where(regular, k, -1)
    for i in np.flatnonzero(~regular):
        kept = np.isfinite(loss[i])
        dimension[i] = _dimension_beside(problem, ends[i, kept], reached[i, kept])
    return dimension, regular


def _probe(
    problem: Problem, points: np.ndarray, basis: np.ndarray, radius: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends (b, p, n) of probes, their coordinates (b, p, k) in the null space over the
    radius, and losses (b, p)."""
    count, k, n = basis.shape
    rng = np.random.default_rng(k)
    axes = np.linalg.qr(rng.normal(size=(k, k)))[0]
    extra = rng.normal(size=(2, k))
    x = np.concatenate([axes, -axes, extra / np.linalg.norm(extra, axis=1)[:, None]])
    length = radius * problem.scale
    starts = points[:, None] + length * (x @ basis)
    ends, gaps = problem.project(starts.reshape(-1, n))
    ends, gaps = ends.reshape(starts.shape), gaps.reshape(count, len(x))
    reached = (
        np.einsum("bpn,bkn->bpk", problem.difference(ends, points[:, None]), basis)
        / length
    )
    loss = np.linalg.norm(reached - x, axis=2)
    loss[gaps > 1e-10] = np.inf
    return ends, reached, loss


def _dimension_beside(problem: Problem, ends: np.ndarray, reached: np.ndarray) -> int:
    """Dimension about a point that lost probes, from the ``ends`` (p, n) of the others
    and where they ``reached``."""
    away = np.linalg.norm(reached, axis=1) > 0.1
    if not np.any(away):
        return 0
    sigma, right = null_spaces(problem, ends[away])
    nullity = np.count_nonzero(sigma < 10 * NULL, axis=1)
    found = 0
    for i in np.flatnonzero(
        nullity < reached.shape[1]
    ):  # the rank is higher there: the point itself is singular
        own = right[i, problem.n - nullity[i] :][None]
        if nullity[i] <= found or not nullity[i]:
            continue
        if _probe(problem, ends[away][i][None], own, 0.01 * RADIUS)[2].max() < KEPT:
            found = int(nullity[i])
    if found or np.any(nullity < reached.shape[1]):
        return found if found else -1
    spread = np.linalg.svd(reached[away], compute_uv=False) / np.sqrt(
        np.count_nonzero(away)
    )
    return int(np.count_nonzero(spread > KEPT))
