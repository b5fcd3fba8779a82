"""Solutions of a family, followed while its parameters move on a straight line.

Every isolated solution of a member is the end of a path that begins at one of the
solutions of a generic member (coefficient-parameter continuation: Morgan and Sommese
1989; Sommese and Wampler 2005, theorem 7.1.1). The compiled tracker predicts by the
Taylor series of a path and corrects by two steps of Newton's method, of which the
second has to be much smaller than the first. Two paths from different starts do not
meet but at singular ends: where two came to one regular end, one has jumped, and both
are followed again in smaller steps. So are those that were lost, as where they pass far
from all others or near a singular point; residuals then have twice the digits of
doubles (Timme 2021), as all of them have at the ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from bifurc.decisions import (
    ends_beyond_reach,
    is_at_infinity,
    is_plainly_at_infinity,
    is_same_path_end,
    is_singular_meeting,
    is_singular_path_end,
    solves_all_equations,
)
from bifurc.limits import Deadline
from bifurc.paths.family import Family, complex_normal

ORDER = 8  # of the series by which the next point is predicted
TOLERANCE = 1e-5  # of a prediction, over 1 + the size of the point
SMALLER = 1e-2  # of the tolerance with which paths are followed again
AGAIN = 3  # times at most, if nothing else is said
MOST_STEPS = 3_000
# Of the straight way, from its end: complex places through which lost paths are led, two
# each time that they are followed again.
DETOURS = (0.5 + 0.1j, 0.5 - 0.1j, 0.5 + 0.4j, 0.5 - 0.4j)
TINY = 1e-300  # keeps rows of zeros from being divided by
LEAST_RATIO = (
    1e-7  # of singular values, where multiple ends are known to half the digits
)
NEARBY = 1e-6  # along any direction: points that are compared
HALF_THE_DIGITS = 30.0  # times less well a multiple end is known than what is the same
# Places about a singular end, and how far from it, over 1 + its size, from which Newton's
# method looks for regular ones; of these it then moves less than paths that are the same.
PLACES, DISTANCES = 8, np.geomspace(1e-2, 1e-7, 6)
NEWTON_STEPS, STILL = 12, 1e-2
BESIDE = 0.1  # over 1 + the size of a point: where rows have the sizes of most places


class PathEnd(IntEnum):
    """How a path ended; the numbers are those of the compiled tracker."""

    # At a solution with independent equations.
    REGULAR = 0
    # At a solution where they are dependent, or that is not isolated.
    SINGULAR = 1
    AT_INFINITY = 2
    # Where steps became too small.
    STUCK = 3
    TOO_LONG = 4
    # Newton's method does not converge at the start.
    NO_START = 5
    OUT_OF_TIME = 6


REASONS = {
    PathEnd.STUCK: "steps became too small",
    PathEnd.TOO_LONG: f"more than {MOST_STEPS} steps",
    PathEnd.NO_START: "the start is no solution",
    PathEnd.OUT_OF_TIME: "out of time",
}


@dataclass(frozen=True, eq=False)
class Paths:
    """Where paths ended: ``points`` (k, n), what is left of each way, ``rests`` (k,)
    from 1 to 0, ``ends`` (k,) of `PathEnd`, how often each goes round its end until it
    closes, ``windings`` (k,), and ``steps`` (k,).

    ``solves_all`` (k,): whether a regular end solves all equations, and not only the
    combinations of them that were followed.
    """

    points: np.ndarray
    rests: np.ndarray
    ends: np.ndarray
    windings: np.ndarray
    steps: np.ndarray
    solves_all: np.ndarray

    @property
    def is_regular(self) -> np.ndarray:
        """Which of them (k,) ended at regular solutions of the equations followed."""
        regular: np.ndarray = self.ends == PathEnd.REGULAR
        return regular

    @property
    def regular(self) -> np.ndarray:
        """The regular ends (j, n) that solve all equations."""
        points: np.ndarray = self.points[self.is_regular & self.solves_all]
        return points

    @property
    def is_lost(self) -> np.ndarray:
        """Which of them (k,) came to no end."""
        lost: np.ndarray = self.ends >= PathEnd.STUCK
        return lost

    @property
    def singular(self) -> np.ndarray:
        """The ends (j, n) that are singular."""
        points: np.ndarray = self.points[self.ends == PathEnd.SINGULAR]
        return points

    @property
    def lost(self) -> int:
        """How many of them came to no end."""
        return int(np.count_nonzero(self.is_lost))

    @property
    def is_finite(self) -> np.ndarray:
        """Which of them (k,) did not end at infinity."""
        finite: np.ndarray = self.ends != PathEnd.AT_INFINITY
        return finite

    def far(self, reach: float = np.inf) -> int:
        """How many ended so far away that it is not told from infinity, and is not
        plainly beyond what is within ``reach``."""
        ends = self.points[self.ends == PathEnd.AT_INFINITY]
        # at infinity a coordinate that is zero is none
        sizes = np.fmax.reduce(np.abs(ends), axis=1, initial=1.0)
        if np.isinf(reach):
            return int(np.count_nonzero(~is_plainly_at_infinity(1.0 / sizes)))
        return int(np.count_nonzero(~ends_beyond_reach(reach / sizes)))

    @staticmethod
    def joined(several: Sequence[Paths]) -> Paths:
        """Several batches, one at least, as one."""
        names = vars(several[0])
        rows = {name: [vars(one)[name] for one in several] for name in names}
        return Paths(**{name: np.concatenate(row) for name, row in rows.items()})

    def replace(self, numbers: np.ndarray, others: Paths, own: np.ndarray) -> None:
        """Put the ``others`` with their ``own`` numbers (j,) in the places of those with
        ``numbers`` (j,)."""
        for name, values in vars(self).items():
            values[numbers] = getattr(others, name)[own]

    def reasons(self) -> list[str]:
        """Why paths were lost, each reason once."""
        kinds = np.unique(self.ends[self.is_lost]).tolist()
        return [REASONS[PathEnd(kind)] for kind in kinds]


def follow_paths(
    family: Family,
    starts: np.ndarray,
    first: np.ndarray,
    last: np.ndarray,
    deadline: Deadline | None = None,
    tolerance: float = TOLERANCE,
    farthest: float = np.inf,
    again: int = AGAIN,
) -> Paths:
    """The paths of solutions ``starts`` (k, n), all different, of the member with the
    parameters ``first`` (q,), or each of a member of its own (k, q), to that with
    ``last``, (q,) or (k, q).

    Paths that come to one regular end, and those that are lost, are followed again in
    smaller steps and with residuals of twice the digits, so often (``again``), and past
    what they pass too near to. None is begun after the ``deadline``. In homogeneous
    coordinates paths that end ``farthest`` times as far away as 1, or more, may count as
    at infinity.
    """
    deadline = deadline or Deadline()
    shape = (len(starts), family.parameters)
    both = np.broadcast_to(first, shape), np.broadcast_to(last, shape)
    way = _Way(family, *both, deadline, farthest)
    paths = _followed(way, starts, tolerance, is_precise=False)
    for attempt in range(again):
        doubtful = np.flatnonzero(_are_doubtful(paths))
        if not len(doubtful) or deadline.passed:
            break
        smaller = tolerance * SMALLER ** (attempt + 1)
        others = _followed(way.of(doubtful), starts[doubtful], smaller, is_precise=True)
        paths.replace(doubtful, others, np.arange(len(doubtful)))
        for place in DETOURS[2 * attempt : 2 * attempt + 2]:
            _lead_round(way, starts, paths, tolerance, place)
    _tell_meetings(way, paths)
    _tell_apart(way, paths)
    return paths


def with_affine_ends(family: Family, paths: Paths) -> Paths:
    """Paths with their ends no longer in homogeneous coordinates."""
    return replace(paths, points=family.affine(paths.points))


def _lead_round(
    way: _Way, starts: np.ndarray, paths: Paths, tolerance: float, place: complex
) -> None:
    """Lead the paths that are lost through a complex ``place`` beside the straight way,
    and keep those that come to a regular end at which no other path is.

    A lost path may pass too near to a place where it is infinite. On another way it may
    change its end with another path; but as the straight paths have all ends, each once,
    what is left is an end of those that are lost.
    """
    lost = np.flatnonzero(paths.is_lost)
    if not len(lost) or way.deadline.passed:
        return
    straight = way.of(lost)
    middle = straight.last + place * (straight.first - straight.last)
    there = straight._replace(last=middle)
    before = _followed(there, starts[lost], tolerance, is_precise=True)
    lost, places = lost[before.is_regular], before.points[before.is_regular]
    back = straight._replace(first=middle).of(np.flatnonzero(before.is_regular))
    after = _followed(back, places, tolerance, is_precise=True)
    for own, number in enumerate(lost.tolist()):
        ends = paths.points[paths.is_regular]
        more = np.concatenate([ends, after.points[own][None]])
        if after.is_regular[own] and copy_of(more)[-1] == len(ends):
            paths.replace(np.array([number]), after, np.array([own]))


def _tell_meetings(way: _Way, paths: Paths) -> None:
    """Correct the ends of paths that still meet at regular ones: where the equations are
    dependent but for half of the digits, as of two paths that come to a double solution
    and do not turn round it, they are singular; else it is not known what is right."""
    has_jumped = _meets_another(paths)
    at_ends = np.flatnonzero(paths.is_regular | (paths.ends == PathEnd.SINGULAR))
    copies = copy_of(paths.points[at_ends], HALF_THE_DIGITS)
    is_met = np.bincount(copies, minlength=len(copies))[copies] > 1
    meeting = at_ends[is_met & paths.is_regular[at_ends]]
    if not len(meeting):
        return
    family, last = way.family, way.last[meeting]
    matrices = family.jacobians(paths.points[meeting], last)
    beside = paths.points[meeting]
    shifts = complex_normal(np.random.default_rng(0), beside.shape)
    sizes = 1.0 + np.abs(beside).max(axis=1, initial=0.0, keepdims=True)
    others = family.jacobians(beside + BESIDE * sizes * shifts, last)
    is_singular = is_singular_meeting(_rank_ratios(matrices, others))
    paths.ends[has_jumped] = PathEnd.STUCK
    paths.ends[meeting[is_singular]] = PathEnd.SINGULAR


def _tell_apart(way: _Way, paths: Paths) -> None:
    """Put regular solutions in the place of a singular end of several paths where there
    are as many beside it: from farther away they look like one."""
    singular = np.flatnonzero(paths.ends == PathEnd.SINGULAR)
    copies = copy_of(paths.points[singular], HALF_THE_DIGITS)
    for first in np.unique(copies).tolist():
        members = singular[copies == first]
        if len(members) < 2:
            continue
        last = way.last[members[0]]
        found = _regular_solutions_beside(way.family, paths.points[members[0]], last)
        if len(found) == len(members):
            paths.points[members] = found
            paths.ends[members] = PathEnd.REGULAR


def _regular_solutions_beside(
    family: Family, point: np.ndarray, last: np.ndarray
) -> np.ndarray:
    """The regular solutions (k, n) that Newton's method finds from places about a point
    (n,), near and less near."""
    rng = np.random.default_rng(0)
    size = 1.0 + float(np.abs(point).max())
    shifts = complex_normal(rng, (PLACES, len(DISTANCES), family.n))
    points = point + size * (DISTANCES[:, None] * shifts).reshape(-1, family.n)
    moves = np.full(len(points), np.inf)
    for _ in range(NEWTON_STEPS):
        steps = _newton_steps(family, points, last)
        points = points - steps
        moves = np.abs(steps).max(axis=1)
        is_near = np.abs(points - point).max(axis=1) < size * DISTANCES[0]
        points, moves = points[is_near], moves[is_near]
    points = distinct(points[is_same_path_end(moves / size, STILL)])
    others = family.jacobians(points + BESIDE * size * shifts[0, 0], last)
    ratios = _rank_ratios(family.jacobians(points, last), others)
    regular: np.ndarray = points[~is_singular_meeting(ratios)]
    return regular


def _newton_steps(
    family: Family, points: np.ndarray, parameters: np.ndarray
) -> np.ndarray:
    """F'^+ F (k, n) at points (k, n)."""
    matrices = family.jacobians(points, parameters)
    residuals = family.residuals(points, parameters)
    steps: np.ndarray = (np.linalg.pinv(matrices) @ residuals[:, :, None])[:, :, 0]
    return steps


class _Way(NamedTuple):
    """From where to where (k, q) the parameters of a ``family`` move for each of k paths,
    until which ``deadline`` these are begun, and from where on they are of no
    interest."""

    family: Family
    first: np.ndarray
    last: np.ndarray
    deadline: Deadline
    farthest: float

    def of(self, numbers: np.ndarray) -> _Way:
        """That of some of the paths, by their ``numbers`` (j,)."""
        return self._replace(first=self.first[numbers], last=self.last[numbers])


def _followed(
    way: _Way, starts: np.ndarray, tolerance: float, is_precise: bool
) -> Paths:
    """The paths of solutions ``starts`` (k, n), to a ``tolerance``."""
    family, first, last, deadline, farthest = way
    points, rests, ends, windings, steps = family.tape.compiled.follow_paths(
        np.ascontiguousarray(starts, dtype=complex),
        np.ascontiguousarray(first, dtype=complex),
        np.ascontiguousarray(last, dtype=complex),
        family.combinations,
        ORDER,
        tolerance,
        MOST_STEPS,
        family.coordinates,
        farthest,
        is_precise,
        family.has_regular_ends,
        deadline.left,
    )
    jacobians = family.jacobians(points, last)
    _tell_singular_and_infinite(family, points, _rank_ratios(jacobians), ends)
    solves_all = np.ones(len(points), dtype=bool)
    if family.tape.m > family.n:
        misfits = np.abs(family.residuals(points, last)).max(axis=1, initial=0.0)
        sizes = np.abs(jacobians).max(axis=(1, 2), initial=0.0)
        sizes *= 1.0 + np.abs(points).max(axis=1, initial=0.0)
        solves_all = solves_all_equations(misfits / sizes)
    return Paths(points, rests, ends, windings, steps, solves_all)


def _tell_singular_and_infinite(
    family: Family, points: np.ndarray, ratios: np.ndarray, ends: np.ndarray
) -> None:
    """Correct the ``ends`` (k,) of paths at ``points`` (k, n) by the ``ratios`` (k,) of
    singular values there: at a point of a curve of solutions the tracker has nothing
    left to correct."""
    is_singular = (ends == PathEnd.REGULAR) & is_singular_path_end(ratios)
    ends[is_singular] = PathEnd.SINGULAR
    if not family.is_projective:
        return
    places = np.abs(points[:, : family.coordinates])
    nearness = places[:, 0] / places.max(axis=1)
    nearness *= np.maximum(ratios, LEAST_RATIO)
    has_come = (ends == PathEnd.REGULAR) | (ends == PathEnd.SINGULAR)
    ends[has_come & is_at_infinity(nearness)] = PathEnd.AT_INFINITY


def _rank_ratios(matrices: np.ndarray, others: np.ndarray | None = None) -> np.ndarray:
    """The smallest singular value of matrices (k, m, n) over the largest (k,), rows
    counted by their sizes, or those in ``others`` (k, m, n) where these are larger; 0
    where they are not finite."""
    is_finite = np.all(np.isfinite(matrices), axis=(1, 2))
    matrices = np.where(is_finite[:, None, None], matrices, 0.0)
    rows = np.abs(matrices).max(axis=2, initial=0.0, keepdims=True)
    if others is not None:
        rows = np.maximum(rows, np.abs(others).max(axis=2, initial=0.0, keepdims=True))
    values = np.linalg.svd(matrices / np.maximum(rows, TINY), compute_uv=False)
    ratios: np.ndarray = values[:, -1] / np.maximum(values[:, 0], TINY)
    return ratios


def _are_doubtful(paths: Paths) -> np.ndarray:
    """Which paths (k,) are to be followed again."""
    has_failed: np.ndarray = paths.is_lost & (paths.ends != PathEnd.OUT_OF_TIME)
    doubtful: np.ndarray = has_failed | _meets_another(paths)
    return doubtful


def _meets_another(paths: Paths) -> np.ndarray:
    """Which paths (k,) ended at a regular solution where another one did."""
    numbers = np.flatnonzero(paths.is_regular)
    copies = copy_of(paths.points[numbers])
    meets = np.zeros(len(paths.ends), dtype=bool)
    is_copy = copies != np.arange(len(copies))
    meets[numbers[is_copy]] = True
    meets[numbers[copies[is_copy]]] = True
    return meets


def copy_of(points: np.ndarray, unit: float = 1.0) -> np.ndarray:
    """For each of the points (k, n) the number (k,) of the first one that is the
    same, as far as they are known: in a larger ``unit`` less well."""
    copies = np.arange(len(points))
    sizes = 1.0 + np.abs(points).max(axis=1, initial=0.0)
    # what is the same is near each other in every order along a direction
    direction = np.random.default_rng(0).normal(size=points.shape[1])
    heights = points.real @ direction / sizes
    order = np.argsort(heights)
    for place, number in enumerate(order.tolist()):
        for other in order[place + 1 :].tolist():
            if heights[other] - heights[number] > NEARBY:
                break
            gap = float(np.abs(points[other] - points[number]).max(initial=0.0))
            if is_same_path_end(gap / sizes[number], unit):
                copies[other] = copies[number] = min(copies[other], copies[number])
    return copies


def distinct(points: np.ndarray) -> np.ndarray:
    """The points (k, n) without those that stand there before."""
    first: np.ndarray = points[copy_of(points) == np.arange(len(points))]
    return first
