"""Starting points, and the estimate of what they missed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.domain import Domain
from bifurc.limits import Deadline, current_deadline, is_time_over
from bifurc.problem import Problem
from bifurc.seeds import Seeds
from bifurc.torus import wrap

AT_ONCE = 10  # starts between two looks at the clock, fewer where these
QUICK = 0.1  # s or more take
CONFIDENCE = 0.95  # of the limit of the probability that something was missed
STEPS = 8  # of Newton's iteration for that limit


class WithDomain(Protocol):
    """What has unknowns."""

    @property
    def domain(self) -> Domain:
        """The unknowns and their region."""


def random_seeds(
    problem: Problem,
    rng: np.random.Generator,
    count: int,
    region: np.ndarray | None = None,
    deadline: Deadline | None = None,
    homes: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Seeds:
    """Solutions reached from ``count`` random starts, drawn from a ``region`` (n, 2); of
    those that come after the ``deadline`` there are none.

    Where shifts of the unknowns lead from solutions to others, ``homes`` shifts
    solutions (k, n) into the bounds before those outside are left out.

    Unknowns are drawn from the bounds; where these are infinite, from the period, or
    from -scale to scale.
    """
    low, high = (start_region(problem) if region is None else region).T
    starts = rng.uniform(low, high, (count, problem.n))
    points, gaps = _projected(problem, starts, deadline)
    points = _next_to_bounds(problem, points)
    if region is not None:
        points = wrap(points, problem.domain.periods)
    is_solved = is_start_solved(gaps)
    if homes is not None:
        for k in np.flatnonzero(is_solved):
            if is_time_over():  # as if this start and the next had not been drawn
                points, gaps, is_solved = points[:k], gaps[:k], is_solved[:k]
                break
            points[k] = homes(points[[k]])[0]
    is_taken = is_solved & problem.domain.are_inside(points)
    solutions = points[is_taken]
    return Seeds(
        points=solutions,
        random=np.ones(len(solutions), dtype=bool),
        gaps=gaps[~is_taken],
        missed=points[~is_taken],
    )


def _projected(
    problem: Problem, starts: np.ndarray, deadline: Deadline | None
) -> tuple[np.ndarray, np.ndarray]:
    """What `Problem.project` makes of the first of the starts (k, n), as many as there
    is time for, a few of them in any case."""
    deadline = deadline or current_deadline()
    is_whole = deadline.seconds == np.inf and not problem.domain.is_large
    if is_whole or not len(starts):
        return problem.project(starts)
    parts: list[tuple[np.ndarray, np.ndarray]] = []
    begin, at_once = 0, 1
    while begin < len(starts) and not (parts and deadline.passed):
        began = time.perf_counter()
        parts.append(problem.project(starts[begin : begin + at_once]))
        begin += at_once
        is_quick = time.perf_counter() - began < QUICK
        if is_quick and not problem.domain.is_large:
            at_once = min(2 * at_once, AT_ONCE)
    points, gaps = zip(*parts, strict=True)
    return np.concatenate(points), np.concatenate(gaps)


def start_region(problem: WithDomain) -> np.ndarray:
    """The box (n, 2) from which starts are drawn."""
    low, high = problem.domain.bounds.T
    periodic = np.isfinite(problem.domain.periods)
    half = np.where(periodic, 0.5 * problem.domain.periods, problem.domain.scale)
    low = np.where(np.isfinite(low), low, -half)
    high = np.where(np.isfinite(high), high, half)
    return np.column_stack([low, high])


def _next_to_bounds(problem: Problem, points: np.ndarray) -> np.ndarray:
    """Points (k, n) with unknowns that have a period and bounds within half a period of
    the middle of these."""
    has_bounds = np.isfinite(problem.domain.bounds).all(axis=1)
    is_limited = np.isfinite(problem.domain.periods) & has_bounds
    if not np.any(is_limited):
        return points
    out = points.copy()
    period = problem.domain.periods[is_limited]
    beside = out[:, is_limited] - problem.domain.bounds[is_limited].mean(axis=1)
    out[:, is_limited] -= period * np.round(beside / period)
    return out


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
    limit = -math.log(1.0 - CONFIDENCE)
    if singles:
        limit = _largest_poisson_mean(singles)
    return min(1.0, limit / starts)


def _largest_poisson_mean(count: int) -> float:
    """The mean of a Poisson distribution that gives no more than so many with the chance
    that is left by the confidence."""
    # scipy.special, which has it, takes longer to import than a small problem to solve
    numbers = np.arange(count + 1)
    factorials = np.append(0.0, np.cumsum(np.log(numbers[1:])))
    mean = count + 1.0
    for _ in range(STEPS):
        chances = np.exp(numbers * math.log(mean) - mean - factorials)
        mean += (
            math.log(chances.sum() / (1.0 - CONFIDENCE)) * chances.sum() / chances[-1]
        )
    return mean
