"""Seeds beside a surface that is nearly a solution.

F is small all over such a surface. What counts as a solution by its residual may lie
far from the curves on it, and a descent of the residual, which has to follow every bend
of the surface, gets stuck on the way to them. Newton's method knows the way: its steps
go across the curves only, and need not make the residual smaller at once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    is_start_solved,
    is_without_equation,
    may_be_crossed,
)
from bifurc.numerics.blur import ROUNDING
from bifurc.numerics.corrector import limited
from bifurc.numerics.null_spaces import decompose
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.seeds import Seeds

STEPS, FARTHEST = 4, 1e-2  # from a solution to its curve, and their length in scales
LONG_STEPS, LONGEST = 30, 0.3  # from a start that missed, and the length of each
NEARLY = 1e-3  # residual of such a start


class Sharpened(NamedTuple):
    """Solutions ``points`` (k, n), and the numbers (j,) of those that ``moved``."""

    points: np.ndarray
    moved: np.ndarray


def sharpened(problem: Problem, points: np.ndarray, values: np.ndarray) -> Sharpened:
    """Solutions as near to their curves as doubles tell, from ``points`` (k, n) at
    which the singular values are ``values`` (k, n).

    Steps of rank n - 1 are taken where a direction is weak. Where they lead far away, or
    to no better solution, the point stays.
    """
    sharp = np.array(points)
    weak = _weak(problem, values)
    if not len(weak):
        return Sharpened(sharp, weak)
    starts = sharp[weak]
    longest = FARTHEST * problem.scale
    ends = _after_newton_steps(problem, starts, STEPS, longest)
    is_near = np.linalg.norm(ends - starts, axis=1) < longest
    enough = np.maximum(problem.gaps(starts), ROUNDING)
    is_better = is_near & (problem.gaps(ends) <= enough)
    sharp[weak[is_better]] = ends[is_better]
    return Sharpened(sharp, weak[is_better])


def with_weak_solutions(problem: Problem, seeds: Seeds) -> Seeds:
    """The seeds, and after them the solutions that are reached from where starts missed
    by little, in a weak direction."""
    near = np.flatnonzero(seeds.gaps < NEARLY)
    if not len(near):
        return seeds
    values = singular_values(problem, seeds.missed[near])
    weak = near[_weak(problem, values)]
    if not len(weak):
        return seeds
    longest = LONGEST * problem.scale
    points = _after_newton_steps(problem, seeds.missed[weak], LONG_STEPS, longest)
    is_solved = is_start_solved(problem.gaps(points))
    is_reached = is_solved & problem.are_inside(points)
    reached = points[is_reached]
    is_left = np.ones(len(seeds.missed), dtype=bool)
    is_left[weak[is_reached]] = False
    return replace(
        seeds,
        points=np.concatenate([seeds.points, reached]),
        random=np.concatenate([seeds.random, np.ones(len(reached), dtype=bool)]),
        gaps=seeds.gaps[is_left],
        missed=seeds.missed[is_left],
    )


def _after_newton_steps(
    problem: Problem, points: np.ndarray, count: int, longest: float
) -> np.ndarray:
    """Where ``count`` steps of rank n - 1, none longer than ``longest``, lead from
    points (k, n)."""
    for _ in range(count):
        steps = decompose(problem, points).newton_steps(problem.n - 1)
        points = points + limited(steps, longest)
    return points


def _weak(problem: Problem, values: np.ndarray) -> np.ndarray:
    """Numbers of the points with singular values (k, n) of which the smallest regular
    one is small, and not nothing."""
    if problem.n < 2:
        return np.empty(0, dtype=int)
    sigma = values[:, problem.n - 2]
    is_weak = may_be_crossed(sigma) & ~is_without_equation(sigma)
    return np.flatnonzero(is_weak)
