"""Starting points, and the estimate of what they missed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.problem import Problem
from bifurc.seeds import Seeds

__all__ = ["missed_probability", "random_seeds"]

CONFIDENCE = 0.95  # of the limit of the probability that something was missed


def random_seeds(problem: Problem, rng: np.random.Generator, count: int) -> Seeds:
    """Solutions reached from ``count`` random starts.

    Periodic unknowns are drawn from their period, the others from the bounds (from
    -scale to scale where these are infinite).
    """
    low, high = _region(problem)
    starts = rng.uniform(low, high, (count, problem.n))
    points, gaps = problem.project(starts)
    lowest, highest = problem.bounds.T
    is_inside = np.all((points >= lowest) & (points <= highest), axis=1)
    is_taken = is_start_solved(gaps) & is_inside
    solutions = points[is_taken]
    return Seeds(
        points=solutions,
        random=np.ones(len(solutions), dtype=bool),
        gaps=gaps[~is_taken],
        missed=points[~is_taken],
    )


def _region(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends (n,) of the box from which starts are drawn."""
    low, high = problem.bounds.T
    low = np.where(np.isfinite(low), low, -problem.scale)
    high = np.where(np.isfinite(high), high, problem.scale)
    periodic = np.isfinite(problem.periods)
    half = 0.5 * problem.periods
    low = np.where(periodic, -half, low)
    high = np.where(periodic, half, high)
    return low, high


def missed_probability(hits: Sequence[int]) -> float:
    """Upper 95 % limit of the chance that one more random start would reach something
    not yet seen.

    ``hits``: how many starts reached each component. Good and Turing (Good 1953)
    estimate the unseen share by n1 / N, with n1 the number of components hit just once
    among N starts; n1 is close to Poisson, and its upper limit (Garwood 1936) is used
    in its place: 3 / N where nothing was hit just once.
    """
    starts = int(sum(hits))
    if starts == 0:
        return 1.0
    singles = sum(1 for count in hits if count == 1)
    return min(1.0, _poisson_limit(singles) / starts)


def _poisson_limit(count: int) -> float:
    """The upper limit of the mean of a Poisson variable that was seen to be ``count``
    (Garwood 1936)."""
    if count == 0:
        return -math.log(1.0 - CONFIDENCE)
    from scipy.special import gammaincinv

    return float(gammaincinv(count + 1, CONFIDENCE))
