"""Near motions: curves along which a system is nearly solved, but not quite.

A linkage that misses the condition of its motion narrowly has a curve of least
misclosure instead of a motion: the valley of |F|, see `bifurc.curves.valley_problem`.
It is traced like a motion, until it closes or misses too much. So where it ends, how
long it is and by how much it misses do not depend on where the trace began. Where the
misclosure passes zero the linkage closes: these are its rigid assemblies there. All
other points at which it closes to rounding are places of the near motion where doubles
see no more of the misclosure.

A near surface is a surface all over which a system is nearly solved. A planar loop of
five joints with one small twist has no configuration, and misses closure by as much all
over what would be its surface. There is no valley of |F| on it: two and more singular
values are small beside the root of what is missed, so that no curve on the surface is
closer to a solution than its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch
from bifurc.curves.continuation import trace_branch
from bifurc.curves.jumps import repeats_itself
from bifurc.curves.misclosure import (
    NearMotionTrace,
    NearSurface,
    bridges_of,
    largest_of,
    misclosures,
)
from bifurc.curves.monitor import NODES
from bifurc.curves.valley_problem import ValleyProblem
from bifurc.decisions import (
    closes_to_rounding,
    is_flat,
    is_same_point,
    is_stretch_short,
    nearly_closes,
)
from bifurc.limits import Deadline
from bifurc.numerics.corrector import correct_across
from bifurc.numerics.null_spaces import (
    correct_to_valley,
    decompose,
    newton_in_rank,
    null_spaces,
)
from bifurc.numerics.roots import bracketed_roots
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.system import System, relative_gaps, relative_jacobians

LONGEST = 200.0  # scales along which a near motion is followed
# Of the misclosure: tolerance of the pieces, within these bounds. Pieces that may miss as
# much as the near motion itself pass a crossing straight on, which has opened.
PRECISION, FINEST, COARSEST = 1e-2, 1e-13, 1e-10
# How far beside a start it is followed from where the valley is not single at the
# start, in scales, after so many steps onto it.
BESIDE, CORRECTIONS = 0.1, 5
CLEAR = 30.0  # square of the smallest regular singular value over the misclosure
# How far from a sample a solution may lie: times the distance of its neighbours, or over
# the scale.
REACH, NEARBY = 2.0, 1e-3
BLUR = 1e-14  # over the smallest singular value: how well a solution is known
TINY = 1e-300
ROUNDS = 30  # of Newton's method for a place where the misclosure passes zero
# Rounds in which the place on a bridge is looked for where most is singular, and the
# places that are looked at in each.
NARROWINGS, LOOKS = 5, 33
LOCATED = 1e-9  # over the scale: error of the places where the misclosure is extreme
STEPS = 6  # of Newton's method across a surface
FAR = 0.2  # of the scale: so far beside a point it is seen whether the surface goes on
STAYS = 0.5  # share of that which correction must leave
TRIED = 12  # points from which that is looked at


def trace_near_motion(
    problem: Problem,
    start: np.ndarray,
    settings: TraceSettings,
    deadline: Deadline | None = None,
) -> NearMotionTrace | None:
    """The near motion through a point (n,) at which the system is nearly solved, as far
    as it is followed before the ``deadline``; None where no curve is followed."""
    valley = ValleyProblem(problem)
    places = np.array([start, *_beside(problem, start)])
    # where the system happens to be solved the residual does not show what is missed
    missed = float(misclosures(problem, places).max())
    if not np.isfinite(missed):
        return None  # next to a rim of where the equations are defined
    tolerance = min(max(PRECISION * missed, FINEST), COARSEST)
    max_length = min(settings.max_length, LONGEST)
    settings = replace(settings.to_tolerance(tolerance), max_length=max_length)
    place = _clearest(valley, places, missed)
    branch = trace_branch(valley, place, None, settings, deadline=deadline)
    if not len(branch.pieces) or is_same_point(branch.length, problem.domain.scale):
        return None  # it leaves the region where it begins
    course = _course(valley, branch, settings.tolerance)
    points, heights = course.extremes()
    return NearMotionTrace(
        branch=branch,
        misclosure=largest_of(problem, points, heights),
        is_short=not branch.closed
        and is_stretch_short(branch.length, problem.domain.scale),
        is_blurred=bool(len(course.bridges)),
        is_repeated=repeats_itself(problem, branch),
        assemblies=_assemblies(problem, course),
        tolerance=settings.tolerance,
    )


def _beside(problem: System, start: np.ndarray) -> np.ndarray:
    """Points (2, n) of the valley a little away from ``start`` (n,), to both sides."""
    _, right = null_spaces(problem, start[None])
    step = BESIDE * problem.domain.scale * right[0, -1]
    ahead = np.array([start - step, start + step])
    return correct_to_valley(problem, ahead, CORRECTIONS)[0]


def _clearest(valley: ValleyProblem, places: np.ndarray, missed: float) -> np.ndarray:
    """The first of the places (k, n), if nothing is singular there beside what is
    ``missed``, else the one that is least singular."""
    weakest = singular_values(valley.of, places)[:, valley.rank - 1]
    if weakest[0] ** 2 > CLEAR * missed:
        clear: np.ndarray = places[0]
        return clear
    is_near = nearly_closes(relative_gaps(valley.of, places))
    clearest: np.ndarray = places[np.argmax(weakest * is_near)]
    return clearest


# --- what a near motion misses along its way ------------------------------------------


@dataclass(frozen=True)
class _Course:
    """A near motion at ``arclengths`` (k,): ``points`` (k, n), what is missed there,
    ``heights`` (k,), whether that falls or grows, ``slopes`` (k,), and whether it
    ``is_blurred`` (k,), which makes all that no fact: it is so on the pieces whose
    numbers are ``bridges``."""

    valley: ValleyProblem
    branch: Branch
    arclengths: np.ndarray
    points: np.ndarray
    heights: np.ndarray
    slopes: np.ndarray
    is_blurred: np.ndarray
    bridges: np.ndarray

    def extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, n) at which most is missed, and how much (k,): between ends of the
        curve and of the places where the valley is blurred."""
        tops = self.roots_of_slope(-1.0)
        ends = self._ends()
        highest = np.array([self._corrected(s) for s in tops])
        points = np.concatenate([highest.reshape(-1, self.valley.n), ends])
        heights = misclosures(self.valley.of, points)
        clear = ~self.is_blurred
        return (
            np.concatenate([points, self.points[clear]]),
            np.concatenate([heights, self.heights[clear]]),
        )

    def roots_of_slope(self, sign: float) -> np.ndarray:
        """Arclengths (k,) at which the misclosure is least (``sign`` 1) or largest
        (-1), next to nothing else."""
        s, slopes, blurred = self.arclengths, sign * self.slopes, self.is_blurred
        if self.branch.closed:
            s = np.append(s, s[0] + self.branch.length)
            slopes = np.append(slopes, slopes[0])
            blurred = np.append(blurred, blurred[0])
        turns = (slopes[:-1] < 0) & (slopes[1:] >= 0) & ~blurred[:-1] & ~blurred[1:]
        low, high = s[:-1][turns], s[1:][turns]
        if not len(low):
            return np.empty(0)

        def slopes_at(s: np.ndarray) -> np.ndarray:
            return _slopes_at(self.valley.of, self.branch(s), self.branch(s, 1))

        return bracketed_roots(slopes_at, low, high, LOCATED * self.valley.domain.scale)

    def _ends(self) -> np.ndarray:
        """The ends (k, n) of the curve, if it is open, and of all places where the
        valley is blurred."""
        ends = []
        if not self.branch.closed:
            ends += list(self.branch(np.array([0.0, self.branch.length])))
        for number in self.bridges:
            ends += self._edges(*self.branch.breaks[number : number + 2])
        return np.array(ends).reshape(-1, self.valley.n)

    def _edges(self, begin: float, end: float) -> list[np.ndarray]:
        """The two points (n,) of the valley between two arclengths at which it ceases
        to be single and is so again."""

        def clearness(s: np.ndarray) -> np.ndarray:
            return np.array([self.valley.clearness(self._corrected(x)) for x in s])

        middle = self._most_singular(begin, end)
        low, high = np.array([begin, middle]), np.array([middle, end])
        if np.any(clearness(low) * clearness(high) >= 0):
            return []
        roots = bracketed_roots(
            clearness, low, high, LOCATED * self.valley.domain.scale
        )
        return [self._corrected(float(root)) for root in roots]

    def _most_singular(self, begin: float, end: float) -> float:
        """The arclength between two others at which the smallest regular singular value
        is least."""
        rank = self.valley.rank
        low, high = begin, end
        for _ in range(NARROWINGS):
            s = np.linspace(low, high, LOOKS)
            values = singular_values(self.valley.of, self.branch(s))[:, rank - 1]
            lowest = int(np.argmin(values))
            low, high = s[max(lowest - 1, 0)], s[min(lowest + 1, LOOKS - 1)]
        return float(0.5 * (low + high))

    def _corrected(self, s: float) -> np.ndarray:
        """The point (n,) of the valley next to an arclength."""
        tangent = self.branch(s, 1)
        return correct_across(self.valley, self.branch(s), tangent, FINEST).point


def _course(valley: ValleyProblem, branch: Branch, tolerance: float) -> _Course:
    """The near motion at nodes of every piece."""
    is_bridge = bridges_of(branch, tolerance)
    arclengths = branch.places(NODES).ravel()
    points = branch(arclengths)
    return _Course(
        valley=valley,
        branch=branch,
        arclengths=arclengths,
        points=points,
        heights=misclosures(valley.of, points),
        slopes=_slopes_at(valley.of, points, branch(arclengths, 1)),
        is_blurred=np.repeat(is_bridge, len(NODES)),
        bridges=np.flatnonzero(is_bridge),
    )


def _slopes_at(problem: System, points: np.ndarray, tangents: np.ndarray) -> np.ndarray:
    """Half the slope (k,) of the squared misclosure along a curve with unit
    ``tangents`` (k, n) at points (k, n)."""
    at = decompose(problem, points)
    weak = at.left[:, :, problem.n - 1 :]
    missed = np.einsum("kmi,km->ki", weak, at.residuals)
    moves = relative_jacobians(problem, points) @ tangents[:, :, None]
    changes = np.einsum("kmi,km->ki", weak, moves[:, :, 0])
    slopes: np.ndarray = np.einsum("ki,ki->k", missed, changes)
    return slopes


# --- where the misclosure passes zero -------------------------------------------------


@dataclass(frozen=True)
class _Zeros:
    """Solutions (k, n) on a near motion next to the samples ``numbers`` (k,) of it, and
    how far rounding may ``blur`` (k,) each."""

    numbers: np.ndarray
    solutions: np.ndarray
    blur: np.ndarray


def _assemblies(problem: System, course: _Course) -> np.ndarray:
    """Solutions (k, n) on a near motion. Between two of them the misclosure is more
    than rounding."""
    zeros = _zeros(problem, course)
    heights = course.heights
    kept: list[int] = []
    for k in range(len(zeros.numbers)):
        if not kept or _are_apart(problem, heights, zeros, kept[-1], k):
            kept.append(k)
    if (
        course.branch.closed
        and len(kept) > 1
        and not _are_apart(
            problem, np.append(heights, heights), zeros, kept[-1], kept[0]
        )
    ):
        kept.pop()
    return zeros.solutions[kept]


def _zeros(problem: System, course: _Course) -> _Zeros:
    """Solutions next to where the misclosure is least."""
    lowest = np.sort(course.roots_of_slope(1.0) % course.branch.length)
    if not len(lowest):
        return _Zeros(np.empty(0, dtype=int), course.points[:0], np.empty(0))
    numbers = np.searchsorted(course.arclengths, lowest)
    numbers = np.minimum(numbers, len(course.arclengths) - 1)
    spacing = np.gradient(course.arclengths)[numbers]
    reach = np.maximum(REACH * spacing, NEARBY * problem.domain.scale)
    points = course.branch(lowest)
    solutions = _solve(problem, points, reach)
    moves = np.linalg.norm(solutions - points, axis=1)
    stiffness = singular_values(problem, solutions)[:, -1]
    blur = BLUR / np.maximum(stiffness, TINY)
    is_zero = closes_to_rounding(relative_gaps(problem, solutions)) & (moves <= reach)
    return _Zeros(numbers[is_zero], solutions[is_zero], blur[is_zero])


def _are_apart(
    problem: System, heights: np.ndarray, zeros: _Zeros, one: int, other: int
) -> bool:
    """Whether two zeros, ``other`` being the next along the near motion, are two in
    doubles: there is a misclosure between them, and they are not one place."""
    begin, end = zeros.numbers[one], zeros.numbers[other]
    if end < begin:
        end += len(heights) // 2
    wall = float(heights[begin : end + 1].max())
    offset = problem.domain.difference(zeros.solutions[one], zeros.solutions[other])
    distance = float(np.linalg.norm(offset))
    is_one_place = distance <= zeros.blur[one] + zeros.blur[other]
    return not is_one_place and not closes_to_rounding(wall)


def _solve(problem: System, points: np.ndarray, longest: np.ndarray) -> np.ndarray:
    """Points (k, n) after Gauss-Newton steps of full rank, none longer than
    ``longest`` (k,)."""
    solutions = points.copy()
    best = relative_gaps(problem, points)
    trial = solutions.copy()
    for _ in range(ROUNDS):
        steps = decompose(problem, trial).newton_steps(problem.n)
        lengths = np.linalg.norm(steps, axis=1)
        shares = np.minimum(1.0, longest / np.maximum(lengths, TINY))
        trial = trial + shares[:, None] * steps
        gaps = relative_gaps(problem, trial)
        is_better = gaps < best
        solutions[is_better] = trial[is_better]
        best = np.minimum(best, gaps)
    return solutions


# --- near surfaces --------------------------------------------------------------------


def near_surfaces(
    problem: System, points: np.ndarray
) -> tuple[list[NearSurface], np.ndarray]:
    """The near surfaces, one for each dimension, on which some of the points (k, n) lie
    at which the system is nearly solved; and which of the points lie on none (k,)."""
    surfaces = []
    is_left = np.ones(len(points), dtype=bool)
    dimensions = _weak_directions(problem, points)
    for dimension in range(2, problem.n):
        own = dimensions == dimension
        rank = problem.n - dimension
        places = newton_in_rank(problem, points[own], rank, STEPS)
        if not len(places) or not _is_surface(problem, places, dimension):
            continue
        misclosure = float(relative_gaps(problem, places).max())
        surfaces.append(NearSurface(dimension, misclosure, places[0]))
        is_left &= ~own
    return surfaces, is_left


def _weak_directions(problem: System, points: np.ndarray) -> np.ndarray:
    """How many singular values (k,) are small beside the root of what points (k, n)
    miss."""
    if not len(points):
        return np.empty(0, dtype=int)
    at = decompose(problem, points)
    values = np.zeros((len(points), problem.n))
    values[:, : at.sigma.shape[1]] = at.sigma
    gaps = np.maximum(np.linalg.norm(at.residuals, axis=1), TINY)
    is_weak = is_flat(values**2, gaps[:, None])
    counts: np.ndarray = np.count_nonzero(is_weak, axis=1)
    return counts


def _is_surface(problem: System, places: np.ndarray, dimension: int) -> bool:
    """Whether about most of the places (k, n) the system is nearly solved in all weak
    directions, as far as `FAR`."""
    tried = places[:TRIED]
    right = decompose(problem, tried).right[:, problem.n - dimension :]  # (k, d, n)
    steps = FAR * problem.domain.scale * np.concatenate([right, -right], axis=1)
    probes = (tried[:, None] + steps).reshape(-1, problem.n)
    ends = newton_in_rank(problem, probes, problem.n - dimension, STEPS)
    starts = np.repeat(tried, 2 * dimension, axis=0)
    moves = np.linalg.norm(ends - starts, axis=1)
    goes_on = (moves > STAYS * FAR * problem.domain.scale) & nearly_closes(
        relative_gaps(problem, ends)
    )
    goes_on &= _weak_directions(problem, ends) >= dimension
    is_all_round = goes_on.reshape(len(tried), -1).all(axis=1)
    return bool(np.mean(is_all_round) > 0.5)
