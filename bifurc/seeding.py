"""Starting points, and the estimate of what they missed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import gammaincinv

from bifurc.problem import Problem
from bifurc.seeds import Seeds

__all__ = ["CLOSED", "missed_probability", "random_seeds"]


CLOSED = 1e-12  # residual below which a start has reached a solution


def random_seeds(
    problem: Problem, rng: np.random.Generator, count: int, closed_below: float = CLOSED
) -> Seeds:
    """Solutions reached from ``count`` random starts.

    Periodic unknowns are drawn from their period, the others from the bounds (from
    -scale to scale where these are infinite).
    """
    low = np.where(
        np.isfinite(problem.bounds[:, 0]), problem.bounds[:, 0], -problem.scale
    )
    high = np.where(
        np.isfinite(problem.bounds[:, 1]), problem.bounds[:, 1], problem.scale
    )
    periodic = np.isfinite(problem.periods)
    low = np.where(periodic, -0.5 * problem.periods, low)
    high = np.where(periodic, 0.5 * problem.periods, high)
    points, gaps = problem.project(rng.uniform(low, high, (count, problem.n)))
    solved = gaps < closed_below
    solved &= np.all(
        (points >= problem.bounds[:, 0]) & (points <= problem.bounds[:, 1]), axis=1
    )
    return Seeds(
        points[solved],
        np.ones(int(solved.sum()), dtype=bool),
        gaps[~solved],
        points[~solved],
    )


def missed_probability(hits: Sequence[int]) -> float:
    """Upper 95 % limit of the chance that one more random start would reach something
    not yet seen.

    ``hits``: how many starts reached each thing found. Good and Turing (Good 1953)
    estimate the unseen share by n1 / N, with n1 the number of things hit just once
    among N starts; n1 is close to Poisson, and its upper limit (Garwood 1936) is used
    in its place: 3 / N where nothing was hit just once.
    """
    total = int(sum(hits))
    if total == 0:
        return 1.0
    singles = sum(1 for h in hits if h == 1)
    return float(min(1.0, gammaincinv(singles + 1, 0.95) / total))
