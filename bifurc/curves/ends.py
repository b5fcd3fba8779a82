"""Where a curve ends that is followed: it closes, or it leaves the bounds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc import _core
from bifurc.branch import Outcome, points_on_piece, points_on_pieces
from bifurc.curves.track import End, Track
from bifurc.decisions import is_back, is_nearly_back, is_other_way, is_solution
from bifurc.numerics.blur import same_reach
from bifurc.numerics.roots import bracketed_roots
from bifurc.system import System, jacobian_at

GRID = np.linspace(0.0, 1.0, 33)  # of a piece, where it is held against its region
LOOSE = 30.0  # times the tolerance: the largest residual that pieces may have
NEAR = 1e-9  # distance, over the scale, within which a curve is back in any case
PLAIN = 1e-3  # share of that: nothing else is asked
EXACT = 30.0  # times the tolerance: residual of a piece on which it may close
ANCHORS = 60  # first pieces, of which the clearest is where the curve may also close


def end_of_curve(
    problem: System, track: Track, first: int, tolerance: float
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


class _Return(NamedTuple):
    """Where a curve is near a place again: at arclength ``s``, at a ``distance``, with
    the ``offset`` (n,) from the place; its derivative there in the coordinate of the
    piece is of size ``speed``, and ``forward`` along the tangent at the place."""

    s: float
    distance: float
    forward: float
    speed: float
    offset: np.ndarray


def _closing(
    problem: System, track: Track, first: int, anchor: _Anchor, tolerance: float
) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, passes the anchor again in
    the same direction."""
    returns = _core.returns(
        pieces=track.pieces,
        centers=track.centers,
        radii=track.radii,
        periods=problem.domain.periods,
        number=anchor.number,
        s=anchor.s,
        first=first,
    )
    for values in returns:
        place = _Return(*values)
        if _is_same_pass(problem, track, anchor, place, tolerance):
            return place.s
    return None


def _is_same_pass(
    problem: System, track: Track, anchor: _Anchor, place: _Return, tolerance: float
) -> bool:
    """Whether the curve is at the anchor again where it is near it, and runs in the
    same direction."""
    if is_other_way(place.forward, place.speed):
        return False
    distance = place.distance / problem.domain.scale
    loose = LOOSE * tolerance
    nearness = distance / same_place(tolerance)
    if nearness > PLAIN:
        # where a singular value is small a point is known no better than rounding over it
        point = track.at(anchor.number, anchor.s).point
        known = _known_to(problem, point)
        residual = jacobian_at(problem, point) @ place.offset
        apart = float(np.linalg.norm(residual)) / (
            problem.magnitude * problem.domain.scale
        )
        nearness = min(nearness, max(distance / known, apart / loose))
    is_exact = tolerance < is_solution.threshold
    return is_back(nearness) if is_exact else is_nearly_back(nearness)


def _known_to(problem: System, point: np.ndarray) -> float:
    """How far, over the scale, from a point (n,) of a curve it may be found again; of a
    large problem singular values are not taken."""
    if problem.domain.is_large:
        return NEAR
    return max(float(same_reach(problem, point[None])[0]), NEAR)


def _leaving(problem: System, track: Track, first: int) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, first leaves its
    region."""
    by_bounds = _core.exit_of_bounds(
        pieces=track.pieces,
        centers=track.centers,
        radii=track.radii,
        periods=problem.domain.periods,
        first=first,
        bounds=problem.domain.bounds,
        slack=problem.domain.slack,
    )
    if problem.domain.rim is None:
        return by_bounds
    by_samples = _leaving_by_samples(problem, track, first)
    exits = [s for s in (by_bounds, by_samples) if s is not None]
    return min(exits, default=None)


def _leaving_by_samples(problem: System, track: Track, first: int) -> float | None:
    """The same where something besides the bounds ends the region."""
    breaks = track.breaks(track.reached)[first:]
    centers, radii = track.centers[first:, None], track.radii[first:, None]
    lengths = np.diff(breaks)[:, None]
    grids = (breaks[:-1, None] + lengths * GRID - centers) / radii
    points = points_on_pieces(track.pieces[first:], grids)
    excess = problem.domain.excess(points.reshape(-1, problem.n)).reshape(grids.shape)
    outside = np.argwhere(excess > problem.domain.slack)
    if not len(outside):
        return None
    number, place = outside[0].tolist()
    low, high = grids[number, max(place - 1, 0)], grids[number, place]
    x = _exit(problem, track.pieces[first + number], low, high)
    return float(centers[number, 0] + x * radii[number, 0])


def _exit(problem: System, piece: np.ndarray, low: float, high: float) -> float:
    """Coordinate at which a piece (order + 1, n) leaves the region, between one of a
    point on or inside it, ``low``, and one of a point outside, ``high``: from a place on
    its rim, along which it may run, where it is plainly outside."""
    begin = np.array([low])
    already = problem.domain.excess(points_on_piece(piece, begin))[0]
    if already > problem.domain.slack:
        return low
    level = 0.0 if already < -problem.domain.slack else problem.domain.slack

    def outside(x: np.ndarray) -> np.ndarray:
        return problem.domain.excess(points_on_piece(piece, x)) - level

    return float(bracketed_roots(outside, begin, np.array([high]))[0])
