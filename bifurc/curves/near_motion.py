"""Near motions: curves along which a system is nearly solved, but not quite.

A linkage that misses the condition of its motion narrowly has a curve of least
misclosure instead of a motion, see `bifurc.curves.valley`. It is traced like a motion,
with all the misclosure that a near motion may have. Where the misclosure passes zero the
linkage closes: these are its rigid assemblies there. All other points at which it
closes to rounding are places of the near motion where doubles see no more of the
misclosure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.continuation import TraceSettings, trace_branch
from bifurc.curves.misclosure import largest_of, misclosures
from bifurc.curves.monitor import NODES, singular_values
from bifurc.curves.valley import correct_to_valley
from bifurc.decisions import (
    closes_to_rounding,
    is_same_point,
    is_stretch_short,
    nearly_closes,
)
from bifurc.numerics.null_spaces import decompose, null_spaces
from bifurc.problem import Problem

__all__ = ["NearMotionTrace", "trace_near_motion"]

LONGEST = 60.0  # scales along which a near motion is followed
PRECISION = 1e-2  # of the misclosure: tolerance of the pieces
SHORTEST = 1e-3  # of the root of the misclosure: the shortest of them, in scales
BESIDE = 0.1  # of the scale: from there it is followed,
CORRECTIONS = 5  # after so many steps onto it
# It comes back to its start but for a drift of this many times the misclosure.
DRIFT = 30.0
SPREAD = 100.0  # times the misclosure: how far beside it a start may end
SAME_WAY = 0.9  # cosine of the angle between two passes that are one
SAMPLE_CORRECTIONS = 2  # of the points at which its misclosure is looked at
# How far from a sample a solution may lie: times the distance of its neighbours, or over
# the scale.
REACH, NEARBY = 2.0, 1e-3
BLUR = 1e-14  # over the smallest singular value: how well a solution is known
TINY = 1e-300
ROUNDS = 30  # of Newton's method for a place where the misclosure passes zero
FINE = 33  # samples among which the foot of the start is looked for


@dataclass(frozen=True)
class NearMotionTrace:
    """A curve along which a system is nearly solved.

    ``branch``, up to the arclength ``length``: as far as it is known, or until it comes
    back to its start, if it ``is_closed``. The least residuals across it go up to
    ``misclosure``, over the magnitude. At the ``assemblies`` (k, n) on it the system is
    solved.
    """

    branch: Branch
    length: float
    is_closed: bool
    misclosure: float
    assemblies: np.ndarray

    @property
    def reach(self) -> float:
        """How far from the branch, over the scale, a point of the near motion may
        lie."""
        return is_same_point.threshold + SPREAD * self.misclosure


def trace_near_motion(
    problem: Problem, start: np.ndarray, settings: TraceSettings
) -> NearMotionTrace | None:
    """The near motion through a point (n,) at which the system is nearly solved; None
    where it is short."""
    beside = _beside(problem, start)
    settings = _coarser(settings, float(misclosures(problem, beside[None])[0]))
    branch = trace_branch(problem, beside, None, settings, nearly_closes.threshold)
    if not len(branch.pieces):
        return None
    length, is_closed = _length(problem, branch, float(branch.residuals.max()))
    if not is_closed and is_stretch_short(length, problem.scale):
        return None
    arclengths = branch.places(NODES).ravel()
    arclengths = arclengths[arclengths <= length]
    points, _ = correct_to_valley(problem, branch(arclengths), SAMPLE_CORRECTIONS)
    heights = misclosures(problem, points)
    return NearMotionTrace(
        branch=branch,
        length=length,
        is_closed=is_closed,
        misclosure=largest_of(problem, points, heights),
        assemblies=_assemblies(problem, points, heights, is_closed),
    )


def _coarser(settings: TraceSettings, misclosure: float) -> TraceSettings:
    """How a curve is followed that is known to no more than its ``misclosure``: where it
    passes another, it turns within the root of that."""
    return replace(
        settings,
        tolerance=max(settings.tolerance, PRECISION * misclosure),
        shortest=max(settings.shortest, SHORTEST * misclosure**0.5),
        max_length=min(settings.max_length, LONGEST),
    )


def _beside(problem: Problem, start: np.ndarray) -> np.ndarray:
    """A point (n,) of the curve of least residuals a little away from ``start``.

    Where the system happens to be solved the residual does not show what the curve
    misses.
    """
    _, right = null_spaces(problem, start[None])
    ahead = start + BESIDE * problem.scale * right[0, -1]
    corrected, _ = correct_to_valley(problem, ahead[None], CORRECTIONS)
    point: np.ndarray = corrected[0]
    return point


def _length(problem: Problem, branch: Branch, misclosure: float) -> tuple[float, bool]:
    """The arclength at which a branch comes back to its start, but for the drift that
    its misclosure brings, and whether it does."""
    arclengths = branch.places(NODES).ravel()
    distances = _distances(problem, branch, arclengths)
    far = np.flatnonzero(distances > 0.5 * problem.scale)
    if not len(far):
        return branch.length, branch.closed
    within = (is_same_point.threshold + DRIFT * misclosure) * problem.scale
    nearest = _minima_in_row(distances, closed=False)
    for k in nearest[nearest > far[0]]:
        low, high = arclengths[k - 1], arclengths[min(k + 1, len(arclengths) - 1)]
        fine = np.linspace(low, high, FINE)
        distance = _distances(problem, branch, fine)
        foot = int(np.argmin(distance))
        is_near = distance[foot] < within + (high - low) / FINE
        is_same_way = branch(fine[foot], 1) @ branch(0.0, 1) > SAME_WAY
        if is_near and is_same_way:
            return float(fine[foot]), True
    return branch.length, branch.closed


def _distances(problem: Problem, branch: Branch, s: np.ndarray) -> np.ndarray:
    """Distances (k,) of points of a branch from its start."""
    offsets = problem.difference(branch(s), branch(0.0))
    distances: np.ndarray = np.linalg.norm(offsets, axis=1)
    return distances


# --- where the misclosure passes zero -------------------------------------------------


@dataclass(frozen=True)
class _Zeros:
    """Solutions (k, n) on a near motion next to the samples ``numbers`` (k,) of it, and
    how far rounding may ``blur`` (k,) each."""

    numbers: np.ndarray
    solutions: np.ndarray
    blur: np.ndarray


def _assemblies(
    problem: Problem, points: np.ndarray, heights: np.ndarray, is_closed: bool
) -> np.ndarray:
    """Solutions (k, n) on a near motion with misclosures ``heights`` (j,) at ``points``
    (j, n) along it.

    Between two of them the misclosure is more than rounding.
    """
    zeros = _zeros(problem, points, heights, is_closed)
    kept: list[int] = []
    for k in range(len(zeros.numbers)):
        if not kept or _are_apart(problem, heights, zeros, kept[-1], k):
            kept.append(k)
    if (
        is_closed
        and len(kept) > 1
        and not _are_apart(
            problem, np.append(heights, heights), zeros, kept[-1], kept[0]
        )
    ):
        kept.pop()
    separate: np.ndarray = zeros.solutions[kept]
    return separate


def _zeros(
    problem: Problem, points: np.ndarray, heights: np.ndarray, is_closed: bool
) -> _Zeros:
    """Solutions next to the lowest of the misclosures ``heights`` (j,)."""
    lowest = _minima_in_row(heights, is_closed)
    if not len(lowest):
        return _Zeros(lowest, points[:0], np.empty(0))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    widest = np.maximum(np.append(steps, 0.0), np.append(0.0, steps))[lowest]
    reach = np.maximum(REACH * widest, NEARBY * problem.scale)
    solutions = _solve(problem, points[lowest], reach)
    moves = np.linalg.norm(solutions - points[lowest], axis=1)
    stiffness = singular_values(problem, solutions)[:, -1]
    blur = BLUR / np.maximum(stiffness, TINY)
    is_zero = closes_to_rounding(problem.gaps(solutions)) & (moves <= reach)
    return _Zeros(lowest[is_zero], solutions[is_zero], blur[is_zero])


def _are_apart(
    problem: Problem, heights: np.ndarray, zeros: _Zeros, one: int, other: int
) -> bool:
    """Whether two zeros, ``other`` being the next along the near motion, are two in
    doubles: there is a misclosure between them, and they are not one place."""
    begin, end = zeros.numbers[one], zeros.numbers[other]
    if end < begin:
        end += len(heights) // 2
    wall = float(heights[begin : end + 1].max())
    offset = problem.difference(zeros.solutions[one], zeros.solutions[other])
    distance = float(np.linalg.norm(offset))
    is_one_place = distance <= zeros.blur[one] + zeros.blur[other]
    return not is_one_place and not closes_to_rounding(wall)


def _minima_in_row(values: np.ndarray, closed: bool) -> np.ndarray:
    """Numbers (k,) of the local minima in a row of values, whose ends meet if
    closed."""
    before, after = (values[-1], values[0]) if closed else (np.inf, np.inf)
    left = np.concatenate([[before], values[:-1]])
    right = np.concatenate([values[1:], [after]])
    return np.flatnonzero((values <= left) & (values < right))


def _solve(problem: Problem, points: np.ndarray, longest: np.ndarray) -> np.ndarray:
    """Points (k, n) after Gauss-Newton steps of full rank, none longer than
    ``longest`` (k,)."""
    solutions = points.copy()
    best = problem.gaps(points)
    trial = solutions.copy()
    for _ in range(ROUNDS):
        steps = decompose(problem, trial).newton_steps(problem.n)
        lengths = np.linalg.norm(steps, axis=1)
        shares = np.minimum(1.0, longest / np.maximum(lengths, TINY))
        trial = trial + shares[:, None] * steps
        gaps = problem.gaps(trial)
        is_better = gaps < best
        solutions[is_better] = trial[is_better]
        best = np.minimum(best, gaps)
    return solutions
