"""Near surfaces: surfaces all over which a system is nearly solved.

A planar loop of five joints with one small twist has no configuration, and misses
closure by as much all over what would be its surface. There is no valley of |F| on it:
two and more singular values are small beside the root of what is missed, so that no
curve on the surface is closer to a solution than its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.decisions import is_flat, nearly_closes
from bifurc.numerics.null_spaces import decompose, newton_in_rank
from bifurc.problem import Problem

STEPS = 6  # of Newton's method across a surface
FAR = 0.2  # of the scale: so far beside a point it is seen whether the surface goes on
STAYS = 0.5  # share of that which correction must leave
TRIED = 12  # points from which that is looked at
TINY = 1e-300


@dataclass(frozen=True)
class NearSurface:
    """A component of a ``dimension`` all over which a system is nearly solved.

    The least residuals across it, at the places looked at, go up to ``misclosure``,
    over the magnitude. ``sample`` (n,) is one of these places.
    """

    dimension: int
    misclosure: float
    sample: np.ndarray


def near_surfaces(
    problem: Problem, points: np.ndarray
) -> tuple[list[NearSurface], np.ndarray]:
    """The near surfaces, one for each dimension, on which some of the points (k, n) lie
    at which the system is nearly solved; and which of the points lie on none (k,)."""
    surfaces = []
    is_left = np.ones(len(points), dtype=bool)
    dimensions = _weak_directions(problem, points)
    for dimension in range(2, problem.n):
        own = dimensions == dimension
        rank = problem.n - dimension
        places = newton_in_rank(problem, points[own], rank, STEPS)
        if not len(places) or not _is_surface(problem, places, dimension):
            continue
        misclosure = float(problem.gaps(places).max())
        surfaces.append(NearSurface(dimension, misclosure, places[0]))
        is_left &= ~own
    return surfaces, is_left


def _weak_directions(problem: Problem, points: np.ndarray) -> np.ndarray:
    """How many singular values (k,) are small beside the root of what points (k, n)
    miss."""
    if not len(points):
        return np.empty(0, dtype=int)
    at = decompose(problem, points)
    values = np.zeros((len(points), problem.n))
    values[:, : at.sigma.shape[1]] = at.sigma
    gaps = np.maximum(np.linalg.norm(at.residuals, axis=1), TINY)
    is_weak = is_flat(values**2, gaps[:, None])
    counts: np.ndarray = np.count_nonzero(is_weak, axis=1)
    return counts


def _is_surface(problem: Problem, places: np.ndarray, dimension: int) -> bool:
    """Whether about most of the places (k, n) the system is nearly solved in all weak
    directions, as far as `FAR`."""
    tried = places[:TRIED]
    right = decompose(problem, tried).right[:, problem.n - dimension :]  # (k, d, n)
    steps = FAR * problem.scale * np.concatenate([right, -right], axis=1)
    probes = (tried[:, None] + steps).reshape(-1, problem.n)
    ends = newton_in_rank(problem, probes, problem.n - dimension, STEPS)
    starts = np.repeat(tried, 2 * dimension, axis=0)
    moves = np.linalg.norm(ends - starts, axis=1)
    goes_on = (moves > STAYS * FAR * problem.scale) & nearly_closes(problem.gaps(ends))
    goes_on &= _weak_directions(problem, ends) >= dimension
    is_all_round = goes_on.reshape(len(tried), -1).all(axis=1)
    return bool(np.mean(is_all_round) > 0.5)
