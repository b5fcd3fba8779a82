"""What happens along a traced curve: singular values, user test functions, dead points.

Everything is evaluated on the dense curve after tracing, in batches, at Chebyshev nodes
of each piece, and read off the interpolants; detection never disturbs the tracing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_zero_along, stands_still, unit_over_rounding
from bifurc.numerics.roots import bracketed_roots
from bifurc.numerics.singular_values import singular_values
from bifurc.system import System

COUNT = 16
# Chebyshev nodes of a piece, from 0 where it begins to 1 where it ends.
NODES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(COUNT) + 0.5) / COUNT)


@dataclass(frozen=True, eq=False)
class Profile:
    """Singular values of F', over the problem's magnitude, at Chebyshev nodes of every
    piece of a curve.

    ``arclength`` (p, k), ``values`` (p, k, n) in decreasing order, ``rank``:
    the rank that F' has along the curve but for single points, n - 1 as a rule. Number
    ``rank`` is the one to watch; there is none where F' vanishes all along.
    """

    arclength: np.ndarray
    values: np.ndarray
    rank: int

    @property
    def smallest(self) -> np.ndarray:
        """The smallest regular singular value (p, k); 0 where there is none."""
        if not self.rank:
            return np.zeros(self.arclength.shape)
        return self.values[..., self.rank - 1]


def profile_branch(problem: System, branch: Branch) -> Profile:
    """The singular values along a curve."""
    arclength = branch.places(NODES)
    values = singular_values(problem, branch(arclength))
    rank = usual_rank(values.reshape(-1, problem.n))
    return Profile(arclength, values, min(rank, problem.n - 1))


def usual_rank(values: np.ndarray) -> int:
    """The rank that singular values (k, n) tell of at most of k places: by the middle
    one of every column."""
    middle = len(values) // 2
    typical = np.partition(values, middle, axis=0)[middle]
    return int(np.count_nonzero(~is_zero_along(typical)))


def roots_along(
    branch: Branch, function: Callable[[np.ndarray], np.ndarray]
) -> list[np.ndarray]:
    """Arclengths of the sign changes along a curve of test functions.

    ``function`` maps arclengths (k,) to values (k, q); one array of roots is returned
    for each of the q functions. Sign changes are bracketed on the Chebyshev nodes of
    every piece and refined all together.
    """
    inner = branch.places(NODES).ravel()
    s = np.concatenate([[0.0], inner, [branch.length]])
    values = function(s)
    index, which = np.nonzero(values[:-1] * values[1:] < 0)
    if not len(index):
        return [np.empty(0)] * values.shape[1]

    def of_interest(x: np.ndarray) -> np.ndarray:
        return np.take_along_axis(function(x), which[:, None], axis=1)[:, 0]

    roots = bracketed_roots(of_interest, s[index], s[index + 1])
    return [roots[which == q] for q in range(values.shape[1])]


def dead_points(
    branch: Branch, by_rounding: float = 0.0, slack: float = 0.0
) -> list[np.ndarray]:
    """For each unknown the arclengths of its dead points: du_i/ds changes sign. None
    for one that stays constant, as far as rates ``by_rounding`` tell.

    A branch may leave its bounds at a dead point: one no farther beyond the end than
    ``slack`` is at the end.
    """
    unit = unit_over_rounding(stands_still, by_rounding)
    is_constant = stands_still(branch.largest_rates, unit)
    turnings = [
        np.empty(0) if is_constant[i] else branch.turning_points(i)
        for i in range(branch.n)
    ]
    if branch.outcome is not Outcome.LEFT_REGION:
        return turnings
    for end in (0.0, branch.length):
        at_end = _turn_at(branch, end, slack) & ~is_constant
        for i in np.flatnonzero(at_end):
            is_inner = np.abs(turnings[i] - end) > slack
            turnings[i] = np.sort(np.append(turnings[i][is_inner], end))
    return turnings


def _turn_at(branch: Branch, end: float, slack: float) -> np.ndarray:
    """Which unknowns (n,) turn back within ``slack`` of an end of a branch, as their
    first two derivatives there tell."""
    rates, bends = np.abs(branch(end, 1)), np.abs(branch(end, 2))
    turn: np.ndarray = (rates <= slack * bends) & ~stands_still(bends * branch.length)
    return turn
