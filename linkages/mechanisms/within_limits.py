"""From closed configurations beyond limits to others within them.

A configuration that is only moved to within its limits and closed again leaves narrow
ones again. What was beyond them is held within, at a place drawn there, and the rest
closes the mechanism, if it can: with more held than the mechanism has freedoms it
cannot, and fewer are.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from bifurc.decisions import is_start_solved

__all__ = ["HoldingProblem", "brought_within_limits"]

TIMES_BACK = 4  # that each is brought back, where closure leads beyond other limits


class HoldingProblem(Protocol):
    """What is asked of a problem: those of its unknowns that are held stay."""

    @property
    def n(self) -> int:
        """How many unknowns there are."""

    @property
    def bounds(self) -> np.ndarray:
        """Their lower and upper limits (n, 2)."""

    def are_inside(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, n) lie within the limits (k,)."""

    def project_with_held(
        self, starts: np.ndarray, is_held: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) near starts (k, n), the same in what is held (n,), and the
        residuals (k,)."""


def brought_within_limits(
    problem: HoldingProblem, beyond: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Solutions (k, n) within the limits, from others ``beyond`` (j, n) them."""
    inside = [np.empty((0, problem.n))]
    kept = np.zeros(beyond.shape, dtype=bool)
    for _ in range(TIMES_BACK):
        if not len(beyond):
            break
        points, held = _held_within(problem, beyond, kept, rng)
        is_inside = problem.are_inside(points)
        inside.append(points[is_inside])
        beyond, kept = points[~is_inside], held[~is_inside]
    return np.concatenate(inside)


def _held_within(
    problem: HoldingProblem,
    beyond: np.ndarray,
    kept: np.ndarray,
    rng: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) and what is held at each (k, n), of those ``beyond`` (j, n) that
    had others ``kept`` (j, n) from which one was reached: all that is beyond is held
    within its limits as well, or what is farthest, or that alone."""
    low, high = problem.bounds.T
    excess = np.maximum(low - beyond, beyond - high)
    is_beyond = excess > 0.0
    farthest = np.arange(problem.n) == np.argmax(excess, axis=1)[:, None]
    choices = np.array([kept | is_beyond, kept | farthest, farthest])
    starts = _drawn_within(problem, beyond, is_beyond, rng)
    points, held = [], []
    for number in range(len(choices)):
        is_held = choices[number]
        ends, gaps = _project(problem, starts, is_held)
        is_solved = is_start_solved(gaps)
        points.append(ends[is_solved])
        held.append(is_held[is_solved])
        starts, choices = starts[~is_solved], choices[:, ~is_solved]
    return np.concatenate(points), np.concatenate(held)


def _drawn_within(
    problem: HoldingProblem,
    points: np.ndarray,
    is_beyond: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Points (k, n) with what is beyond its limits (k, n) drawn from within them; at
    the limit, where there is but one."""
    low, high = problem.bounds.T
    has_both = np.isfinite(problem.bounds).all(axis=1)
    width = np.where(has_both, high, 0.0) - np.where(has_both, low, 0.0)
    within: np.ndarray = np.clip(points, low, high)
    drawn = np.where(has_both, low, 0.0) + width * rng.uniform(size=points.shape)
    return np.where(is_beyond & has_both, drawn, within)


def _project(
    problem: HoldingProblem, starts: np.ndarray, is_held: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What is reached from starts (k, n), each with unknowns of its own held (k, n),
    and the residuals (k,)."""
    points, gaps = starts.copy(), np.empty(len(starts))
    patterns, of_start = np.unique(is_held, axis=0, return_inverse=True)
    for number, pattern in enumerate(patterns):
        own = of_start.reshape(-1) == number
        points[own], gaps[own] = problem.project_with_held(starts[own], pattern)
    return points, gaps
