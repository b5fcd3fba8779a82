"""Where a branch begins and which way it runs, by the curve itself: the seed from which
it was traced and last bits do not change it.

The start of a closed curve is where a fixed function of the unknowns is largest. Where
two of its maxima are nearly equal, as they are on a curve that a symmetry maps to
itself, or where the maximum is flat, the next function decides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_slow_at_start, is_unclear_start
from bifurc.problem import Problem
from bifurc.torus import whole_turns, wrap, wrapped_periods

FUNCTIONS = 8  # that are tried
ROUNDING = 1e-15  # of an arclength: how closely a top is located
# By how much a maximum stands above all others, over the range of the function.
CLEAR_MARGIN = 1e-3
PLACES = (np.arange(10) + 0.5) / 10  # of every piece, where the function is sampled
# Of the samples: so close to the highest, over the range, are those beside a top that
# may be the highest.
HIGH = 0.1
# Of a maximum: its second derivative times the square of the length of the curve, over
# the range of the function (20 for a cosine once round). Its place is known to rounding
# over this.
CLEAR_BEND = 0.1
BEND_STEP = 1e-3  # of the difference for it, over the length of the curve
SEAM = 1e-7  # share of a period: so near to its end an unknown begins at the end
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def canonical_course(problem: Problem, branch: Branch) -> Branch:
    """The same curve with a start and a direction of its own.

    It winds forwards: the first winding number that is not zero is positive. A curve
    that does not wind leaves its start with the first unknown that clearly moves
    growing. An open curve begins at that of its ends where the function is larger.
    Periodic unknowns begin within half a period of zero.
    """
    if not len(branch.pieces):
        return branch
    if branch.closed:
        branch = branch.begun_at(_clearest_top(problem, branch))
        if not _runs_forwards(branch):
            branch = branch.reversed()
    elif _begins_at_the_lower_end(problem, branch):
        branch = branch.reversed()
    start = branch.ends[0]
    periods = wrapped_periods(problem.domain.periods, problem.domain.bounds)
    wrapped = wrap(start, periods, within=SEAM)
    return branch.moved_by_periods(whole_turns(wrapped - start, periods))


# --- where it begins ------------------------------------------------------------------


class _Top(NamedTuple):
    """The arclength at which a function is largest on a curve, and how clearly: by its
    margin and its bend, each over what is clear."""

    arclength: float
    clarity: float


def _clearest_top(problem: Problem, branch: Branch) -> float:
    """The arclength at which a closed curve begins: the top of the first function that
    has a clear one, or else of the one that has the clearest."""
    samples = branch.places(PLACES).ravel()
    points = branch(samples)
    clearest = _Top(0.0, 0.0)
    for number in range(FUNCTIONS):
        height = _Height.of(problem, number, branch)
        top = height.top(samples, points)
        if not is_unclear_start(top.clarity):
            return top.arclength % branch.length
        if top.clarity > clearest.clarity:
            clearest = top
    return clearest.arclength % branch.length


@dataclass(frozen=True)
class _Height:
    """A function along a closed curve, with the ``coefficients`` (4, n) of
    `bifurc._core.Curve.rates_of_height`: a weight times the cosine of an angle beyond its phase, or
    times an unknown without a period over the scale."""

    branch: Branch
    coefficients: np.ndarray

    @staticmethod
    def of(problem: Problem, number: int, branch: Branch) -> _Height:
        """Function ``number`` of those that are tried: their coefficients are spread
        evenly (Weyl 1916), so that no symmetry of a problem respects them."""
        columns = np.arange(1, problem.n + 1) + number * problem.n
        weights = 0.5 + (columns * GOLDEN) % 1.0
        phases = 2 * np.pi * ((columns * np.sqrt(2.0)) % 1.0)
        periodic = np.isfinite(problem.domain.periods)
        angular = np.zeros(problem.n)
        angular[periodic] = 2 * np.pi / problem.domain.periods[periodic]
        signs = np.where(np.sin(phases) > 0, 1.0, -1.0)
        linear = np.where(periodic, 0.0, signs / problem.domain.scale)
        return _Height(branch, np.array([weights, phases, angular, linear]))

    def at(self, points: np.ndarray) -> np.ndarray:
        """Heights (k,) of points (k, n)."""
        weights, phases, angular, linear = self.coefficients
        waves = np.cos(points * angular - phases)
        heights: np.ndarray = np.where(angular > 0, waves, points * linear) @ weights
        return heights

    def top(self, samples: np.ndarray, points: np.ndarray) -> _Top:
        """Where the height is largest on the curve, of which ``samples`` (k,) are
        arclengths in order and ``points`` (k, n) what stands there."""
        heights = self.at(points)
        extent = float(np.ptp(heights))
        is_high = heights > heights.max() - HIGH * extent
        numbers = np.arange(len(samples))
        before, after = numbers - 1, (numbers + 1) % len(samples)
        is_top = (heights >= heights[before]) & (heights > heights[after])
        low, high = samples[before], samples[after]
        low[0] -= self.branch.length
        high[-1] += self.branch.length
        near = is_high & is_top
        tops = self.branch.compiled.level_places(
            self.coefficients, low[near], high[near], ROUNDING
        )
        order = np.argsort(self.at(self.branch(tops)))
        if not len(tops):
            return _Top(0.0, 0.0)
        best = float(tops[order[-1]])
        highest = self.at(self.branch(tops[order[-2:]]))
        margin = highest[-1] - highest[0] if len(tops) > 1 else np.inf
        step = BEND_STEP * self.branch.length
        beside = np.array([best - step, best + step])
        rise, fall = self.branch.compiled.rates_of_height(self.coefficients, beside)
        bend = (rise - fall) / (2 * step) * self.branch.length**2
        clarity = min(float(margin) / CLEAR_MARGIN, float(bend) / CLEAR_BEND)
        return _Top(best, clarity / extent)


# --- which way it runs ----------------------------------------------------------------


def _runs_forwards(branch: Branch) -> bool:
    """Whether a closed curve winds forwards, or without winding leaves its start with
    the first unknown that clearly moves growing."""
    turning = branch.winding[branch.winding != 0]
    if len(turning):
        return bool(turning[0] > 0)
    rates = branch(0.0, 1)
    sizes = np.abs(rates)
    moving = rates[~is_slow_at_start(sizes, sizes.max())]
    return bool(moving[0] > 0)


def _begins_at_the_lower_end(problem: Problem, branch: Branch) -> bool:
    """Whether an open curve ends where the first function that tells its ends apart is
    larger."""
    ends = branch(np.array([0.0, branch.length]))
    margin = CLEAR_MARGIN * branch.length / problem.domain.scale
    for number in range(FUNCTIONS):
        begin, end = _Height.of(problem, number, branch).at(ends)
        if abs(end - begin) > margin:
            return bool(end > begin)
    return False
