"""From closed configurations beyond limits to others within them.

A configuration that is only moved to within its limits and closed again leaves narrow
ones again. What was beyond them is held within, at a place drawn there, and the rest
closes the mechanism, if it can: with more held than the mechanism has freedoms it
cannot, and fewer are. Where many are limited and others are not, holding one leads
beyond the next: there the way along the solutions leads back, towards all limits at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from bifurc.decisions import is_start_solved
from bifurc.limits import is_time_over
from bifurc.problem import Problem

TIMES_BACK = 4  # that each is brought back, where closure leads beyond other limits
STEPS = 30  # along the solutions towards the limits
FARTHER, LONGEST = 8.0, 0.5  # times as far as the next solution, up to so many scales
TINY = 1e-300  # keeps a length of zero from being divided by

# Gives solutions (k, n) near starts (k, n), the same in what is held (n,), and the
# residuals (k,).
Holding: TypeAlias = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def brought_within_limits(
    problem: Problem, hold: Holding, beyond: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Solutions (k, n) within the limits, from others ``beyond`` (j, n) them."""
    inside = [_led_within(problem, beyond)]
    kept = np.zeros(beyond.shape, dtype=bool)
    for _ in range(TIMES_BACK):
        if not len(beyond) or is_time_over():
            break
        points, held = _held_within(problem, hold, beyond, kept, rng)
        is_inside = problem.domain.are_inside(points)
        inside.append(points[is_inside])
        beyond, kept = points[~is_inside], held[~is_inside]
    return np.concatenate(inside)


def _led_within(problem: Problem, beyond: np.ndarray) -> np.ndarray:
    """Solutions (k, n) within the limits to which the way leads along the solutions,
    from others ``beyond`` (j, n) them.

    Each step goes to the solution beside the nearest point of the middle half of the
    limits, or farther that way, by the method of alternating projections (von Neumann
    1950); it is the last where it leads no nearer to that half.
    """
    inside = [np.empty((0, problem.n))]
    for _ in range(STEPS):
        if not len(beyond) or is_time_over():
            break
        points = _nearer(problem, beyond)
        is_nearer = _distances(problem, points) < _distances(problem, beyond)
        is_inside = problem.domain.are_inside(points) & is_nearer
        inside.append(points[is_inside])
        beyond = points[is_nearer & ~is_inside]
    return np.concatenate(inside)


def _nearer(problem: Problem, points: np.ndarray) -> np.ndarray:
    """The solutions (k, n) to which one step leads from others (k, n)."""
    beside, gaps = problem.project(_middles(problem, points))
    steps = beside - points
    lengths = np.linalg.norm(steps, axis=1, keepdims=True)
    longest = np.maximum(LONGEST * problem.domain.scale, lengths)
    steps *= np.minimum(FARTHER, longest / np.maximum(lengths, TINY))
    far, far_gaps = problem.project(points + steps)
    ends = np.array([beside, far])
    distances = np.array([_distances(problem, end) for end in ends])
    is_solved = np.array([is_start_solved(gaps), is_start_solved(far_gaps)])
    distances[~is_solved] = np.inf
    best = np.argmin(distances, axis=0)
    nearer: np.ndarray = ends[best, np.arange(len(points))]
    is_any = np.isfinite(distances.min(axis=0))
    return np.where(is_any[:, None], nearer, points)


def _middles(problem: Problem, points: np.ndarray) -> np.ndarray:
    """The points (k, n) of the middle half of the limits that are next to points
    (k, n)."""
    low, high = problem.domain.bounds.T
    has_both = np.isfinite(problem.domain.bounds).all(axis=1)
    margin = np.zeros(problem.n)
    margin[has_both] = 0.25 * (high - low)[has_both]
    middles: np.ndarray = np.clip(points, low + margin, high - margin)
    return middles


def _distances(problem: Problem, points: np.ndarray) -> np.ndarray:
    """How far points (k, n) are from the middle half of the limits (k,)."""
    distances: np.ndarray = np.linalg.norm(points - _middles(problem, points), axis=1)
    return distances


def _held_within(
    problem: Problem,
    hold: Holding,
    beyond: np.ndarray,
    kept: np.ndarray,
    rng: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) and what is held at each (k, n), of those ``beyond`` (j, n) that
    had others ``kept`` (j, n) from which one was reached: all that is beyond is held
    within its limits as well, or what is farthest, or that alone."""
    low, high = problem.domain.bounds.T
    excess = np.maximum(low - beyond, beyond - high)
    is_beyond = excess > 0.0
    farthest = np.arange(problem.n) == np.argmax(excess, axis=1)[:, None]
    choices = np.array([kept | is_beyond, kept | farthest, farthest])
    starts = _drawn_within(problem, beyond, is_beyond, rng)
    points, held = [], []
    for number in range(len(choices)):
        is_held = choices[number]
        ends, gaps = _project(hold, starts, is_held)
        is_solved = is_start_solved(gaps)
        points.append(ends[is_solved])
        held.append(is_held[is_solved])
        starts, choices = starts[~is_solved], choices[:, ~is_solved]
    return np.concatenate(points), np.concatenate(held)


def _drawn_within(
    problem: Problem,
    points: np.ndarray,
    is_beyond: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Points (k, n) with what is beyond its limits (k, n) drawn from within them; at
    the limit, where there is but one."""
    low, high = problem.domain.bounds.T
    has_both = np.isfinite(problem.domain.bounds).all(axis=1)
    width = np.where(has_both, high, 0.0) - np.where(has_both, low, 0.0)
    within: np.ndarray = np.clip(points, low, high)
    drawn = np.where(has_both, low, 0.0) + width * rng.uniform(size=points.shape)
    return np.where(is_beyond & has_both, drawn, within)


def _project(
    hold: Holding, starts: np.ndarray, is_held: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What is reached from starts (k, n), each with unknowns of its own held (k, n),
    and the residuals (k,), infinite where the time was over before."""
    points, gaps = starts.copy(), np.full(len(starts), np.inf)
    patterns, of_start = np.unique(is_held, axis=0, return_inverse=True)
    for number, pattern in enumerate(patterns):
        if is_time_over():
            break
        own = of_start.reshape(-1) == number
        points[own], gaps[own] = hold(starts[own], pattern)
    return points, gaps
