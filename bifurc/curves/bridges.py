"""Bridges: pieces across a singular point where no series reaches."""

from __future__ import annotations

import numpy as np

from bifurc.branch import points_on_piece
from bifurc.curves.misclosure import visible_misclosure
from bifurc.curves.track import Bridge, BridgeRule, Place, SplitCurve, Track
from bifurc.decisions import is_solution
from bifurc.numerics.collocation import bridge_by_collocation
from bifurc.numerics.null_spaces import decompose
from bifurc.numerics.singular_values import singular_values
from bifurc.singular.locate import locate_singular_point
from bifurc.system import Piece, System

REACHES = (0.1, 0.2, 0.05, 0.4, 0.02)  # half widths of bridges, in scales,
MOST_ROOM = max(REACHES)  # that a bridge needs before the point, in scales
BLURRED_REACHES = (0.1, 0.2, 0.4, 0.8)  # and across points that are missed
SLACKS = (10.0, 100.0)  # times the tolerance: how good the nodes of a bridge must be
MISSED = 10.0  # times the misclosure of the curve: what a bridge may miss, too
AHEAD = np.linspace(0.0, 1.0, 9)  # shares of the next piece
BEYOND = 1.5  # times as far as points are missed
RESIDUAL = 10.0  # times the tolerance: the residual that a bridge may have


def bridge_from(problem: System, track: Track, tolerance: float) -> Bridge | None:
    """A bridge across the point before which the track stalled, or None.

    Near a singular point where the rank drops faster than on a simple crossing no
    series reaches over. The curve is smooth there all the same: a piece by collocation,
    from as far before the point as beyond it, needs no series.
    """
    if not len(track):
        return None
    if isinstance(problem, SplitCurve):
        blurred = _blurred_ahead(problem, track)
        if blurred is not None:
            return _bridge_of_split_curve(problem, track, blurred)
    if track.caution.bridges is BridgeRule.NOWHERE:
        return None
    misclosure = visible_misclosure(problem, track.pieces[:, 0])
    if not is_solution(misclosure):
        misclosure = 0.0
    only_singular = track.caution.bridges is BridgeRule.AT_SINGULAR_POINTS
    if only_singular and not _is_near_singular(problem, track.front.point, misclosure):
        return None
    for reach in REACHES:
        begin = track.reached - reach * problem.domain.scale
        if begin < track.centers[0]:
            continue
        last = track.piece_at(begin)
        place = track.at(last, begin)
        width = 2 * reach * problem.domain.scale
        piece = _piece_across(problem, place, width, track.order, tolerance, misclosure)
        if piece is not None:
            return Bridge(last, begin, piece)
    return None


def _blurred_ahead(curve: SplitCurve, track: Track) -> float | None:
    """How far ahead the last point lies where the curve is not single and the next
    piece would be; None where there is none."""
    point, tangent = track.front
    steps = 2.0 * float(track.radii[-1]) * AHEAD
    missed = np.flatnonzero(curve.missed(point + steps[:, None] * tangent))
    return float(steps[missed[-1]]) if len(missed) else None


def _bridge_of_split_curve(
    curve: SplitCurve, track: Track, blurred: float
) -> Bridge | None:
    """A bridge across points where the curve is not single, which reach as far ahead
    as ``blurred``."""
    for reach in BLURRED_REACHES:
        begin = track.reached - reach * curve.domain.scale
        if begin < track.centers[0] or reach * curve.domain.scale < BEYOND * blurred:
            continue
        last = track.piece_at(begin)
        place = track.at(last, begin)
        width = 2 * reach * curve.domain.scale
        piece = curve.bridge(place.point, place.tangent, width, track.order)
        if piece is not None:
            return Bridge(last, begin, piece)
    return None


def _piece_across(
    problem: System,
    place: Place,
    width: float,
    order: int,
    tolerance: float,
    misclosure: float,
) -> Piece | None:
    """A piece of about ``width`` from ``place`` across a crossing, or None."""
    most = RESIDUAL * tolerance + MISSED * misclosure
    for slack in SLACKS:
        loose = slack * tolerance
        piece = bridge_by_collocation(
            problem, place.point, place.tangent, order, loose, width, misclosure
        )
        if piece is None or piece.residual > most:
            continue
        if _spans_a_crossing(problem, piece.coefficients, loose, misclosure):
            return piece
    return None


def _is_near_singular(problem: System, point: np.ndarray, misclosure: float) -> bool:
    """Whether a singular point can be located near ``point``, so that a bridge is worth
    trying."""
    if problem.domain.is_large:
        return False
    values = singular_values(problem, point)
    small = problem.n - int(np.count_nonzero(values > 1e-2))
    nullities = sorted({2, min(small, 4)} - {0, 1})
    reach = 0.05 * problem.domain.scale
    return any(
        locate_singular_point(problem, point, nullity, reach, misclosure) is not None
        for nullity in nullities
    )


def _spans_a_crossing(
    problem: System, piece: np.ndarray, tolerance: float, misclosure: float
) -> bool:
    """Whether a bridge meets the weakest equation to rounding, or to the
    ``misclosure`` of its curve, as it does where branches really cross.

    Straight across a near miss of width w that equation is off by w^2, while its
    singular value goes to zero: a residual that no correction of the size of
    ``tolerance`` explains.
    """
    points = points_on_piece(piece, np.linspace(-1.0, 1.0, 61))
    decomposition = decompose(problem, points)
    weakest = problem.n - 2
    if decomposition.sigma.shape[1] <= weakest:
        return True
    off = np.abs(decomposition.components(weakest))
    sigma = decomposition.sigma[:, weakest]
    most = 10.0 * tolerance * sigma + 1e-14 + MISSED * misclosure
    return bool(np.all(off <= most))
