"""Whether a branch is a curve of solutions between its pieces' nodes, too."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import dead_points
from bifurc.decisions import is_same_point
from bifurc.problem import Problem

__all__ = ["Verification", "verify_branch"]

MOST = 4000  # stretches of a branch that are looked at
SHORTEST = 1e-7  # half a stretch, over the scale, that is not divided any more
# Share of its smallest singular value by which F' may vary about a stretch, on which a
# curve of solutions then runs next to the branch and nowhere leaves it.
STEADY = 0.5
ARCLENGTH = 1.001  # times the distance from the middle, at most, that s is off it


class Verification(NamedTuple):
    """What is known of a branch: an arclength at which it ``misses`` the solutions,
    None where there is none, and a place (n,) that is ``open``, None where it solves
    the equations all along within the bounds."""

    misses: float | None
    open: np.ndarray | None


def verify_branch(
    problem: Problem,
    branch: Branch,
    are_beside: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> Verification:
    """Whether a branch solves the equations all along, by bounds on F and F' about
    stretches of it, but where balls about points (k, n) of radii (k,) ``are_beside`` a
    singular point."""
    torn = _torn_at(problem, branch)
    if torn is not None:
        return Verification(torn, None)
    breaks = branch.breaks
    begin, end = breaks[:-1], breaks[1:]
    count = 0
    while len(begin):
        count += len(begin)
        middles, halves = branch(0.5 * (begin + end)), 0.5 * (end - begin)
        is_wrong, is_steady = _judge(problem, middles, halves)
        is_beside = are_beside(middles, halves)
        missed = np.flatnonzero(is_wrong & ~is_beside)
        if len(missed):
            return Verification(float(0.5 * (begin + end)[missed[0]]), None)
        rest = np.flatnonzero(~is_steady & ~is_beside)
        is_short = halves[rest] < SHORTEST * problem.scale
        if (count > MOST and len(rest)) or np.any(is_short):
            return Verification(None, middles[rest[0]])
        begin, end = begin[rest], end[rest]
        cuts = 0.5 * (begin + end)
        begin, end = np.concatenate([begin, cuts]), np.concatenate([cuts, end])
    return Verification(None, _beyond_bounds(problem, branch))


def _torn_at(problem: Problem, branch: Branch) -> float | None:
    """The arclength at which a branch does not hand over from one piece to the next, or
    from the last one of a closed curve to the first; None where there is none."""
    begins, ends = branch.ends_of_pieces()
    following = np.roll(begins, -1, axis=0)
    gaps = np.linalg.norm(problem.difference(following, ends), axis=1)
    if not branch.closed:
        gaps[-1] = 0.0
    torn = np.flatnonzero(~is_same_point(gaps, problem.scale))
    return float(branch.breaks[torn[0] + 1]) if len(torn) else None


def _judge(
    problem: Problem, middles: np.ndarray, halves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """On which stretches with ``middles`` (k, n), half as long as ``halves`` (k,), a
    branch solves nothing somewhere, and on which F' is as good as constant."""
    reach = ARCLENGTH * halves[:, None]
    low, high = middles - reach, middles + reach
    values = problem.value_bounds(low, high)
    jacobians = problem.jacobian_bounds(low, high)
    assert values is not None and jacobians is not None
    is_wrong = np.any((values[0] > 0.0) | (values[1] < 0.0), axis=1)
    is_wrong |= ~is_same_point(problem.gaps(middles), problem.scale)
    mean = 0.5 * (jacobians[0] + jacobians[1])
    width = 0.5 * (jacobians[1] - jacobians[0])
    is_finite = np.all(np.isfinite(mean) & np.isfinite(width), axis=(1, 2))
    sizes = np.linalg.norm(width, axis=(1, 2))
    smallest = np.zeros(len(middles))
    smallest[is_finite] = np.linalg.svd(mean[is_finite], compute_uv=False)[:, -1]
    return is_wrong, is_finite & (sizes < STEADY * smallest)


def _beyond_bounds(problem: Problem, branch: Branch) -> np.ndarray | None:
    """A place (n,) of a branch beyond the bounds, None where it has none."""
    for places in dead_points(branch):
        points = branch(places)
        is_beyond = ~problem.are_inside(points)
        if np.any(is_beyond):
            beyond: np.ndarray = points[is_beyond][0]
            return beyond
    return None
