"""Solutions as exact as doubles make them, by Newton's method.

F is small all over a surface that is nearly a solution. What counts as a solution by its
residual may lie far from the curves on it, and a descent of the residual, which has to
follow every bend of the surface, gets stuck on the way to them. Newton's method knows the
way: its steps of rank n - 1 go across the curves only, and need not make the residual
smaller at once.

Where isolated solutions come together F vanishes to a higher order, and along the
weakest direction it is rounding on a whole stretch: 1e-15 is the cube of 1e-5. How many
solutions lie on such a stretch, and where, doubles do not tell.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, islice
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    closes_to_rounding,
    is_blurred,
    is_known_assembly,
    is_start_solved,
    is_weakly_isolated,
    is_without_equation,
    may_be_crossed,
    may_be_mobile,
)
from bifurc.equations.rims import on_rims
from bifurc.equations.system import ScaledTape
from bifurc.function_problem import EquationProblem
from bifurc.numerics.blur import ROUNDING
from bifurc.numerics.corrector import limited
from bifurc.numerics.null_spaces import correct_to_valley, decompose, null_spaces
from bifurc.numerics.singular_values import factors_of, singular_values
from bifurc.problem import Problem
from bifurc.seeding import start_region
from bifurc.seeds import Seeds
from bifurc.system import relative_gaps

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
    longest = FARTHEST * problem.domain.scale
    ends = _after_newton_steps(problem, starts, STEPS, longest)
    is_near = np.linalg.norm(ends - starts, axis=1) < longest
    enough = np.maximum(relative_gaps(problem, starts), ROUNDING)
    is_better = is_near & (relative_gaps(problem, ends) <= enough)
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
    longest = LONGEST * problem.domain.scale
    points = _after_newton_steps(problem, seeds.missed[weak], LONG_STEPS, longest)
    is_solved = is_start_solved(relative_gaps(problem, points))
    is_reached = is_solved & problem.domain.are_inside(points)
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


# Of Newton's method: at a solution of order k each step leaves (1 - 1 / k) of the way.
NEWTON_STEPS = 60
FLOOR = 1e-20  # over the largest singular value: steps stay finite
NEARBY = 1e-2  # of the scale: how far a solution may lie from where it was found
# Distances along the weakest direction, over the scale, at which F is looked at, and
# the rounds in which these places are corrected across it.
DISTANCES = np.geomspace(1e-8, NEARBY, 121)
CORRECTIONS = 5


class IsolatedSolution(NamedTuple):
    """A ``point`` (n,) with its ``stiffness``, the smallest of all n singular values
    there. It ``is_isolated`` where rounding moves it by less than what tells points
    apart. It, or several, lie ``hidden`` on a stretch that reaches as far from the
    point to either side."""

    point: np.ndarray
    stiffness: float
    is_isolated: bool
    hidden: float


def polished(problem: Problem, start: np.ndarray) -> IsolatedSolution:
    """The solution next to ``start`` (n,), by Newton's method of full rank; where it is
    hidden by rounding, the middle of the stretch."""
    best, gap = _solved(problem, start)
    stiffness = float(singular_values(problem, best)[problem.n - 1])
    is_isolated = closes_to_rounding(gap) and not is_blurred(stiffness)
    if not (closes_to_rounding(gap) and is_weakly_isolated(stiffness)):
        return IsolatedSolution(best, stiffness, is_isolated, 0.0)
    stretch = _hidden_stretch(problem, best)
    if is_known_assembly(stretch.half_length, problem.domain.scale):
        return IsolatedSolution(best, stiffness, is_isolated, stretch.half_length)
    return IsolatedSolution(stretch.middle, stiffness, is_isolated, stretch.half_length)


def _solved(problem: Problem, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Where Newton's method of full rank ends next to ``start`` (n,), and the relative
    residual there.

    A step in a weak direction may raise the residual by the bend of the other
    equations, and is then corrected across that direction.
    """
    best = start
    gap = float(relative_gaps(problem, start[None])[0])
    for _ in range(NEWTON_STEPS):
        point = best + decompose(problem, best[None]).newton_steps(problem.n, FLOOR)[0]
        new_gap = float(relative_gaps(problem, point[None])[0])
        if not (new_gap < gap or closes_to_rounding(gap)):
            points, gaps = correct_to_valley(problem, point[None], CORRECTIONS)
            point, new_gap = points[0], float(gaps[0])
        distance = np.linalg.norm(point - start)
        if not distance < NEARBY * problem.domain.scale or not new_gap < gap:
            break
        best, gap = point, new_gap
    return best, gap


class _Stretch(NamedTuple):
    """A stretch of the valley of |F|: its ``middle`` (n,) and half of its length."""

    middle: np.ndarray
    half_length: float


def _hidden_stretch(problem: Problem, solution: np.ndarray) -> _Stretch:
    """The stretch of the valley on both sides of a ``solution`` (n,) on which F is
    rounding."""
    _, right = null_spaces(problem, solution[None])
    weakest = right[0, -1]
    distances = DISTANCES * problem.domain.scale
    reaches = []
    for sense in (1.0, -1.0):
        ahead = solution + sense * distances[:, None] * weakest
        _, gaps = correct_to_valley(problem, ahead, CORRECTIONS)
        visible = np.flatnonzero(~closes_to_rounding(gaps))
        last = visible[0] if len(visible) else -1
        reaches.append(float(distances[last]))
    offset = 0.5 * (reaches[0] - reaches[1])
    beside = solution + offset * weakest
    middle = correct_to_valley(problem, beside[None], CORRECTIONS)[0][0]
    return _Stretch(middle, 0.5 * (reaches[0] + reaches[1]))


# --- where the region ends ------------------------------------------------------------

IN_A_BOUND = 8  # starts in each bound, and on each rim, of so many unknowns at most
MOST_UNKNOWNS = 8
MOST_RIMS = 50  # on which solutions along them are looked for


def solutions_in_bounds(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """Solutions (k, n) within the region that have one unknown in a bound, of surfaces
    also two, or lie on a rim, reached from a few starts for each; none of equations that
    are not recorded."""
    found = np.empty((0, problem.n))
    if not isinstance(problem, EquationProblem) or problem.n > MOST_UNKNOWNS:
        return found
    compiled = problem.compiled
    if not isinstance(compiled, ScaledTape):
        return found
    low, high = start_region(problem).T
    ends = []
    for numbers, sides in _bounds_together(problem, problem.n - compiled.tape.m):
        starts = rng.uniform(low, high, (IN_A_BOUND, problem.n))
        starts[:, numbers] = problem.domain.bounds[numbers, sides]
        ends.append(compiled.project(starts, np.isin(np.arange(problem.n), numbers)))
    for tape in problem.tapes_on_rims():
        starts = rng.uniform(low, high, (IN_A_BOUND, problem.n))
        on_rim = ScaledTape(tape, problem.magnitude, problem.domain)
        ends.append(on_rim.project(starts))
    for points, gaps in ends:
        is_inside = problem.domain.are_inside(points)
        found = np.concatenate([found, points[is_start_solved(gaps) & is_inside]])
    return found


class OnRims(NamedTuple):
    """Solutions ``points`` (k, n) on rims of the equations, where F' is not finite, and
    whether there ``are_others`` (k,) along the rim beside each."""

    points: np.ndarray
    are_others: np.ndarray


def solutions_on_rims(problem: Problem, rng: np.random.Generator) -> OnRims:
    """Solutions within the region on rims of the equations, reached from a few starts
    for each rim; none of equations that are not recorded.

    A rim is one condition more: where it does not add to the rank, what is solved there
    is no mere end of a curve.
    """
    points, others = [np.empty((0, problem.n))], [np.empty(0, dtype=bool)]
    tape = None
    if isinstance(problem, EquationProblem) and problem.n <= MOST_UNKNOWNS:
        tape = problem.recording.tape
    tapes = [] if tape is None else islice(on_rims(tape), MOST_RIMS)
    low, high = start_region(problem).T
    for equations in tapes:
        starts = rng.uniform(low, high, (IN_A_BOUND, problem.n))
        on_rim = ScaledTape(equations, problem.magnitude, problem.domain)
        ends, gaps = on_rim.project(starts)
        ends = ends[is_start_solved(gaps) & problem.domain.are_inside(ends)]
        rows = on_rim.jacobians(ends)
        lengths = np.linalg.norm(rows, axis=2, keepdims=True)
        rows = rows / np.where(lengths > 0.0, lengths, 1.0)
        points.append(ends)
        others.append(may_be_mobile(factors_of(rows).sigma[:, -1]))
    return OnRims(np.concatenate(points), np.concatenate(others))


def _bounds_together(
    problem: Problem, freedom: int
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Each bound, as the number (1,) of its unknown and 0 or 1 (1,) for the lower or the
    upper one, and where there is the ``freedom`` each two (2,) of different unknowns."""
    every = np.argwhere(np.isfinite(problem.domain.bounds))
    for number, side in every:
        yield number[None], side[None]
    if freedom < 2:
        return
    for pair in combinations(every, 2):
        numbers, sides = np.array(pair).T
        if numbers[0] != numbers[1]:
            yield numbers, sides
