"""Whether a branch is a curve of solutions between its pieces' nodes, too."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.monitor import dead_points
from bifurc.decisions import is_same_point
from bifurc.problem import Problem

MOST = 4000  # stretches of a branch that are divided
SHORTEST = 1e-7  # half a stretch, over the scale, that is not divided any more


class Course(Enum):
    """What is known of a branch, as `_core.Tape.course` numbers it."""

    SOLVED = 0
    MISSED = 1
    OPEN = 2


class Verification(NamedTuple):
    """What is known of a branch: an arclength at which it ``misses`` the solutions,
    None where there is none, and a place (n,) that is ``open``, None where it solves
    the equations all along within the bounds."""

    misses: float | None
    open: np.ndarray | None


def verify_branch(
    problem: Problem, branch: Branch, centers: np.ndarray, reaches: np.ndarray
) -> Verification:
    """Whether a branch solves the equations all along, by bounds on F and F' about
    stretches of it, but in balls about singular points, ``centers`` (k, n), of radii
    ``reaches`` (k,)."""
    torn = _torn_at(problem, branch, centers, reaches)
    if torn is not None:
        return Verification(torn, None)
    tape = problem.continuous_tape()
    assert tape is not None
    number, s = tape.course(
        branch.compiled,
        centers,
        reaches,
        problem.periods,
        residual=is_same_point.threshold * problem.scale * problem.magnitude,
        shortest=SHORTEST * problem.scale,
        most=MOST,
    )
    match Course(number):
        case Course.MISSED:
            return Verification(s, None)
        case Course.OPEN:
            return Verification(None, branch(s))
        case Course.SOLVED:
            return Verification(None, _beyond_bounds(problem, branch))


def _torn_at(
    problem: Problem, branch: Branch, centers: np.ndarray, reaches: np.ndarray
) -> float | None:
    """The arclength at which a branch does not hand over from one piece to the next, or
    from the last one of a closed curve to the first; None where it does, but in the
    balls about singular points."""
    begins, ends = branch.ends_of_pieces()
    following = np.roll(begins, -1, axis=0)
    gaps = np.linalg.norm(problem.difference(following, ends), axis=1)
    if not branch.closed:
        gaps[-1] = 0.0
    torn = np.flatnonzero(~is_same_point(gaps, problem.scale))
    offsets = problem.difference(ends[torn, None], centers)  # (j, k, n)
    is_beside = np.linalg.norm(offsets, axis=2) + gaps[torn, None] < reaches
    torn = torn[~np.any(is_beside, axis=1)]
    return float(branch.breaks[torn[0] + 1]) if len(torn) else None


def _beyond_bounds(problem: Problem, branch: Branch) -> np.ndarray | None:
    """A place (n,) of a branch beyond the bounds, None where it has none."""
    for places in dead_points(branch):
        points = branch(places)
        is_beyond = ~problem.are_inside(points)
        if np.any(is_beyond):
            beyond: np.ndarray = points[is_beyond][0]
            return beyond
    return None
