"""Where a curve ends that is followed: it closes, or it leaves the bounds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc._core import foot_on_piece
from bifurc.branch import Outcome
from bifurc.curves.track import End, Place, Track
from bifurc.decisions import is_back, is_nearly_back, is_other_way, is_solution
from bifurc.numerics.blur import same_reach
from bifurc.numerics.null_spaces import LARGE
from bifurc.pieces import points_on_piece
from bifurc.problem import Problem

__all__ = ["end_of_curve", "same_place"]

# where the bounds are left is looked for in so many parts, and in those of one of them
PARTS, REFINEMENTS = 16, 15
LOOSE = 30.0  # times the tolerance: the largest residual that pieces may have
NEAR = 1e-9  # distance, over the scale, within which a curve is back in any case
PLAIN = 1e-3  # share of that: nothing else is asked
EXACT = 30.0  # times the tolerance: residual of a piece on which it may close
ANCHORS = 60  # first pieces, of which the clearest is where the curve may also close


def end_of_curve(
    problem: Problem, track: Track, first: int, tolerance: float
) -> End | None:
    """Where the curve, from piece ``first`` on, closes or first leaves the bounds.

    It closes when it passes its start again, or the clearest of its first points: a
    start beside a singular point may lie off the curve by more than it shows.
    """
    if not len(track):
        return None
    begin = 0.0
    closing = _closing(problem, track, first, _Anchor(0, begin), tolerance)
    if closing is None:
        is_exact = track.residuals[:ANCHORS] <= EXACT * tolerance  # and no bridge
        clearest = int(np.argmax(track.radii[:ANCHORS] * is_exact))
        begin = float(track.centers[clearest])
        anchor = _Anchor(clearest, begin)
        closing = _closing(problem, track, clearest, anchor, tolerance)
    leaving = _leaving(problem, track, first)
    if closing is not None and (leaving is None or closing < leaving):
        return End(Outcome.CLOSED, closing, begin)
    return None if leaving is None else End(Outcome.LEFT_REGION, leaving)


def same_place(tolerance: float) -> float:
    """The distance, over the scale, within which a curve traced to a ``tolerance`` is
    where it was before."""
    return max(NEAR, LOOSE * tolerance)


class _Anchor(NamedTuple):
    """Where a curve may close: at arclength ``s`` on piece ``number``."""

    number: int
    s: float


class _Foot(NamedTuple):
    """Where a piece is nearest to a point: the coordinate ``x`` on the piece, and close
    to it the ``offset`` (n,) from the point and the derivative ``slope`` (n,) in x."""

    x: float
    offset: np.ndarray
    slope: np.ndarray


def _closing(
    problem: Problem, track: Track, first: int, anchor: _Anchor, tolerance: float
) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, passes the anchor again in
    the same direction."""
    place = track.at(anchor.number, anchor.s)
    beyond = anchor.s + 0.5 * track.radii[anchor.number]
    for number in _pieces_near(problem, track, first, place.point):
        foot = _Foot(*foot_on_piece(track.pieces[number], place.point, problem.periods))
        s = track.centers[number] + foot.x * track.radii[number]
        if abs(foot.x) > 1.02 or not s > beyond:
            continue
        if _is_same_pass(problem, place, foot, tolerance):
            return float(s)
    return None


def _pieces_near(
    problem: Problem, track: Track, first: int, point: np.ndarray
) -> np.ndarray:
    """Numbers of the pieces, from ``first`` on, that may pass ``point`` (n,)."""
    middles = track.pieces[first:, 0]
    radii = track.radii[first:]
    gaps = problem.difference(middles, point)
    is_near = np.linalg.norm(gaps, axis=1) < 1.1 * radii
    numbers: np.ndarray = first + np.flatnonzero(is_near)
    return numbers


def _is_same_pass(
    problem: Problem, place: Place, foot: _Foot, tolerance: float
) -> bool:
    """Whether the curve at the foot of a place is at that place again, and runs in the
    same direction."""
    speed = float(np.linalg.norm(foot.slope))
    if is_other_way(float(foot.slope @ place.tangent), speed):
        return False
    distance = float(np.linalg.norm(foot.offset)) / problem.scale
    loose = LOOSE * tolerance
    nearness = distance / same_place(tolerance)
    if nearness > PLAIN:
        # where a singular value is small a point is known no better than rounding over it
        known = _known_to(problem, place.point)
        residual = problem.jacobian(place.point) @ foot.offset
        apart = float(np.linalg.norm(residual)) / (problem.magnitude * problem.scale)
        nearness = min(nearness, max(distance / known, apart / loose))
    is_exact = tolerance < is_solution.threshold
    return is_back(nearness) if is_exact else is_nearly_back(nearness)


def _known_to(problem: Problem, point: np.ndarray) -> float:
    """How far, over the scale, from a point (n,) of a curve it may be found again; of a
    large problem singular values are not taken."""
    if problem.n > LARGE:
        return NEAR
    return max(float(same_reach(problem, point[None])[0]), NEAR)


def _leaving(problem: Problem, track: Track, first: int) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, first leaves the
    bounds."""
    if not problem.has_rim:
        return None
    breaks = track.breaks(track.reached)
    for number in range(first, len(track)):
        center, radius = track.centers[number], track.radii[number]
        begin, end = breaks[number : number + 2]
        grid = (np.linspace(begin, end, 33) - center) / radius
        x = _exit(problem, track.pieces[number], grid)
        if x is not None:
            return float(center + x * radius)
    return None


def _exit(problem: Problem, piece: np.ndarray, grid: np.ndarray) -> float | None:
    """Coordinate at which a piece (order + 1, n) leaves the bounds, as seen at those of
    ``grid``; None where it does not."""
    excess = _excess(problem, piece, grid)
    outside = np.flatnonzero(excess > 1e-12 * problem.scale)
    if not len(outside):
        return None
    first = outside[0]
    low = grid[max(first - 1, 0)]
    high = grid[first]
    for _ in range(REFINEMENTS):
        places = np.linspace(low, high, PARTS + 1)
        outside = np.flatnonzero(_excess(problem, piece, places) > 0)
        first = max(outside[0], 1) if len(outside) else PARTS
        low, high = places[first - 1], places[first]
    return float(low)


def _excess(problem: Problem, piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    """How far a piece lies outside the region (k,) at x (k,); negative inside."""
    return problem.excess(points_on_piece(piece, x))
