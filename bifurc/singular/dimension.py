"""The dimension of the solution set about a solution.

Where F' has one rank r in a neighbourhood of a solution, the solutions there are a
manifold of dimension n - r (constant rank theorem; Lee 2013, Introduction to Smooth
Manifolds, theorem 4.12). The corank at a single point does not tell: it is larger at
singular points, and all along components that are shaky. So the null space of F' is
probed.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    Decision,
    fills_null_space,
    is_across_span,
    is_closed_on_surface,
    is_null_at_probe,
    is_solution_at_probe,
    may_be_null,
    may_fill_null_space,
)
from bifurc.limits import CutOff, Deadline, cut_off_after
from bifurc.numerics.blur import rounding_unit
from bifurc.numerics.corrector import correct_normal
from bifurc.numerics.null_spaces import null_spaces
from bifurc.problem import Problem
from bifurc.system import relative_gaps

# Length of the probes, over the scale: at much less, degenerate singular points would
# look like surfaces.
RADIUS = 5e-3
# Distances, over the scale, at which it is seen what a surface misses, and the largest
# height above the null space there, over them.
REACHES, LOW = (5e-2, 2e-2, RADIUS), 0.2
# Length, over `RADIUS`, of the probes about the end of a probe.
AT_END = 0.01
# Share of its length that a probe must keep for its end to be beside the point.
AWAY = 0.1
# Times the root of the residual: the singular value at a solution that is known no
# better because F is a square.
HIDDEN = 10.0
# Residual below which what projection leaves is on its way to a solution, and how many
# times it is projected again at most.
SLOW, AGAIN = 1e-6, 3
# Points probed together, and where the time may be over before all are.
CHUNK, FEW = 256, 4


@dataclass(frozen=True)
class LocalDimensions:
    """What the solution set is about each of k solutions.

    ``dimension`` (k,) of the solutions nearby, the largest where several components
    meet, -1 where it was not found; ``nullity`` (k,) of F' at the point; ``regular``
    (k,) whether the solutions nearby are a manifold and F' has the rank that belongs to
    it; ``shaky`` (k,) whether F' has one lower rank at all solutions nearby.
    """

    dimension: np.ndarray
    nullity: np.ndarray
    regular: np.ndarray
    shaky: np.ndarray


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
    dimension = np.full(count, -1)
    nullity = np.zeros(count, dtype=int)
    regular = np.zeros(count, dtype=bool)
    shaky = np.zeros(count, dtype=bool)
    with suppress(CutOff), cut_off_after(deadline):
        for begin in range(0, count, CHUNK):
            part = slice(begin, begin + CHUNK)
            sigma, right = null_spaces(problem, points[part])
            nullity[part] = np.count_nonzero(may_be_null(sigma), axis=1)
            for rows in _alike(nullity[part], deadline):
                if deadline.passed:
                    return LocalDimensions(dimension, nullity, regular, shaky)
                k = int(nullity[part][rows[0]])
                basis = right[rows, problem.n - k :]
                own = _dimensions_of_nullity(problem, points[part][rows], basis)
                regular[begin + rows], shaky[begin + rows] = own.regular, own.shaky
                dimension[begin + rows] = own.dimension  # last: now they are reached
    return LocalDimensions(dimension, nullity, regular, shaky)


def _alike(nullity: np.ndarray, deadline: Deadline) -> list[np.ndarray]:
    """The numbers of points that are looked at together: those of one nullity (c,), a few
    where a ``deadline`` may pass before all are done."""
    groups = [np.flatnonzero(nullity == k) for k in np.unique(nullity)]
    at_once = FEW if deadline.seconds < np.inf else CHUNK
    return [
        group[first : first + at_once]
        for group in groups
        for first in range(0, len(group), at_once)
    ]


def _dimensions_of_nullity(
    problem: Problem, points: np.ndarray, basis: np.ndarray
) -> LocalDimensions:
    """What is about points (b, n) whose null spaces (b, k, n) all have dimension k."""
    count, k = basis.shape[:2]
    nullity, shaky = np.full(count, k), np.zeros(count, dtype=bool)
    if k == 0:
        regular = np.ones(count, dtype=bool)
        return LocalDimensions(nullity, nullity, regular, shaky)
    probes = _probe(problem, points, basis, RADIUS)
    regular = may_fill_null_space(probes.loss.max(axis=1))
    dimension = np.where(regular, k, -1)
    for i in np.flatnonzero(~regular):
        arrived = np.isfinite(probes.loss[i])
        ends = probes.ends[i, arrived]
        coordinates = probes.coordinates[i, arrived]
        dimension[i], shaky[i] = _dimension_from_ends(problem, ends, coordinates)
    shaky &= dimension < k
    full = np.flatnonzero(dimension == k) if k > 1 else np.empty(0, dtype=int)
    if len(full):
        missed = misclosures_beside(problem, points[full], basis[full])
        unit = rounding_unit(problem, points[full])
        is_closed = is_closed_on_surface(missed, unit)
        regular[full] &= is_closed
        # what does not fill all directions of the null space has fewer dimensions
        dimension[full[np.isfinite(missed) & ~is_closed]] = k - 1
    return LocalDimensions(dimension, nullity, regular, shaky)


def misclosures_beside(
    problem: Problem, points: np.ndarray, basis: np.ndarray
) -> np.ndarray:
    """The largest relative residual (b,) that is left beside solutions (b, n) when only
    the equations across the null spaces (b, k, n) are solved; infinite where that
    fails.

    Above every direction of the null space there is one point that solves them. On a
    component of dimension k it solves the others, too, to rounding. Beside one it
    misses them by what it takes to see that these are curves: the farther away the
    more, so the farthest of the `REACHES` counts above which the points lie low.
    """
    count, k, n = basis.shape
    missed = np.full(count, np.inf)
    waiting = np.arange(count)
    directions = _probe_directions(k)
    for reach in REACHES:
        if not len(waiting):
            break
        length = reach * problem.domain.scale
        starts = points[waiting, None] + length * (directions @ basis[waiting])
        flat = starts.reshape(-1, n)
        bases = np.swapaxes(basis[waiting], 1, 2)
        ends, gaps = correct_normal(problem, flat, np.repeat(bases, len(directions), 0))
        heights = np.linalg.norm(ends - flat, axis=1).reshape(len(waiting), -1)
        is_low = heights.max(axis=1) < LOW * length
        largest = gaps.reshape(len(waiting), -1).max(axis=1)
        missed[waiting[is_low]] = largest[is_low]
        waiting = waiting[~is_low]
    return missed


class _Probes(NamedTuple):
    """Probes p along the null spaces, of dimension k, of points b, after projection.

    ``ends`` (b, p, n) are solutions, ``coordinates`` (b, p, k) where they lie in the
    null space, over the length of the probes. ``loss`` (b, p) is the share of a probe
    that projection takes away, infinite where its end is no solution.
    """

    ends: np.ndarray
    coordinates: np.ndarray
    loss: np.ndarray


def _probe(
    problem: Problem, points: np.ndarray, basis: np.ndarray, radius: float
) -> _Probes:
    """Probes of length ``radius`` (over the scale) about points (b, n) in their null
    spaces (b, k, n)."""
    count, k, n = basis.shape
    directions = _probe_directions(k)
    length = radius * problem.domain.scale
    starts = points[:, None] + length * (directions @ basis)
    flat_ends, flat_gaps = project_slowly(
        problem, starts.reshape(-1, n), is_solution_at_probe
    )
    ends = flat_ends.reshape(starts.shape)
    gaps = flat_gaps.reshape(count, len(directions))
    offsets = problem.domain.difference(ends, points[:, None])
    coordinates = np.einsum("bpn,bkn->bpk", offsets, basis) / length
    loss = np.linalg.norm(coordinates - directions, axis=2)
    loss[~is_solution_at_probe(gaps)] = np.inf
    return _Probes(ends, coordinates, loss)


def project_slowly(
    problem: Problem, starts: np.ndarray, is_enough: Decision
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) near ``starts`` and the residual (k,) left at each, also where
    F' has a lower rank at all solutions nearby: steps shrink slowly there, and are taken
    until a residual ``is_enough`` or gets no smaller."""
    ends, gaps = problem.project(starts)
    slow = np.flatnonzero(gaps < SLOW)
    for _ in range(AGAIN):
        slow = slow[~is_enough(gaps[slow])]
        if not len(slow):
            break
        closer, left = problem.project(ends[slow])
        is_closer = left < 0.5 * gaps[slow]
        slow = slow[is_closer]
        ends[slow], gaps[slow] = closer[is_closer], left[is_closer]
    return ends, gaps


@cache
def _probe_directions(k: int) -> np.ndarray:
    """Unit vectors (2 k + 2, k), always the same: both ways along axes turned at
    random, and two more."""
    rng = np.random.default_rng(k)
    axes, _ = np.linalg.qr(rng.normal(size=(k, k)))
    extra = rng.normal(size=(2, k))
    extra /= np.linalg.norm(extra, axis=1)[:, None]
    directions = np.concatenate([axes, -axes, extra])
    directions.setflags(write=False)
    return directions


def _dimension_from_ends(
    problem: Problem, ends: np.ndarray, coordinates: np.ndarray
) -> tuple[int, bool]:
    """Dimension about a point that lost probes, from the ``ends`` (p, n) of the others
    and their ``coordinates`` (p, k), -1 where the ends do not tell; and whether they
    all have the rank of the point."""
    is_away = np.linalg.norm(coordinates, axis=1) > AWAY
    if not np.any(is_away):
        return 0, False
    ends, coordinates = ends[is_away], coordinates[is_away]
    sigma, right = null_spaces(problem, ends)
    hidden = HIDDEN * np.sqrt(relative_gaps(problem, ends))  # where F is a square
    unit = np.maximum(1.0, hidden / is_null_at_probe.threshold)
    nullity = np.count_nonzero(is_null_at_probe(sigma, unit[:, None]), axis=1)
    of_higher_rank = np.flatnonzero(nullity < coordinates.shape[1])
    if not len(of_higher_rank):
        return _dimension_of_span(coordinates), True
    # the point itself is singular: the solutions are a manifold about the ends
    largest = 0
    for i in of_higher_rank:
        if nullity[i] <= largest:
            continue
        basis = right[i, problem.n - nullity[i] :][None]
        probes = _probe(problem, ends[i][None], basis, AT_END * RADIUS)
        if fills_null_space(float(probes.loss.max())):
            largest = int(nullity[i])
    return (largest if largest else -1), False


def _dimension_of_span(coordinates: np.ndarray) -> int:
    """Dimension of the space that vectors (p, k) span, but for curvature."""
    sigma = np.linalg.svd(coordinates, compute_uv=False)
    spread = sigma / np.sqrt(len(coordinates))
    return int(np.count_nonzero(~is_across_span(spread)))
