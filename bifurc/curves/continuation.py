"""Tracing: from a start and a direction to one branch, with bridges, pieces across a
singular point where no series reaches."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome, points_on_piece
from bifurc.checks import check_type, point_of
from bifurc.curves.ends import end_of_curve, same_place
from bifurc.curves.misclosure import visible_misclosure
from bifurc.curves.track import (
    CAUTIOUS,
    Bridge,
    BridgeRule,
    End,
    Place,
    SplitCurve,
    Track,
)
from bifurc.decisions import is_solution
from bifurc.errors import ProblemError
from bifurc.limits import Deadline, is_time_over
from bifurc.numerics.collocation import bridge_by_collocation
from bifurc.numerics.null_spaces import decompose, null_vector
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.singular.locate import locate_singular_point
from bifurc.system import (
    Anchor,
    March,
    MarchSettings,
    MarchStatus,
    Piece,
    System,
    relative_gaps,
)

# Pieces made before the end of the curve is looked for: beside a bend, at least, and at
# most.
AT_A_BEND, AT_ONCE, MOST_AT_ONCE = 14, 40, 1000
UNKNOWNS_AT_ONCE = 10_000  # of all pieces of a march, between two looks at the time
# Times the width of the last piece: that of the first one that is tried after it.
GROWTH = 1.5
CLEAR = 10.0  # times the radius of least caution: from there on a bend is passed
# Outcomes after which a curve is not followed the other way.
WHOLE = (Outcome.CLOSED, Outcome.OPEN, Outcome.STEP_LIMIT, Outcome.TIME_LIMIT)


class _Ways(NamedTuple):
    """A curve followed ``forward`` from its start and, where that is not the whole of
    it, ``backward``."""

    forward: Branch
    backward: Branch | None

    @property
    def branch(self) -> Branch:
        """The whole curve."""
        forward, backward = self
        if backward is None or not len(backward.pieces):
            return forward
        if not len(forward.pieces):
            return backward.reversed()
        if backward.outcome is Outcome.CLOSED:
            # it came through where the other way stalled
            return backward.reversed()
        return joined_branch(backward.reversed(), forward)


DEFAULT_SETTINGS = TraceSettings()


def trace_branch(
    problem: Problem,
    start: np.ndarray,
    direction: np.ndarray | None = None,
    settings: TraceSettings = DEFAULT_SETTINGS,
    closing: float = is_solution.threshold,
    deadline: Deadline | None = None,
) -> Branch:
    """The whole smooth curve through ``start`` (n,), first followed to the side of
    ``direction`` (n,).

    A curve that does not close is followed both ways to its ends. Trouble is an
    `Outcome` on the branch, not an exception: a start that cannot be corrected gives a
    branch of no pieces whose ``gap`` is the residual left. The curve ends where no
    correction across it brings the relative residual below ``closing``, and where it
    is followed when the ``deadline`` has passed. Raises `ProblemError` for a start or
    direction of the wrong shape.

    >>> import bifurc, numpy as np
    >>> circle = bifurc.FunctionProblem(lambda u: [u @ u - 1], [(-2, 2), (-2, 2)])
    >>> branch = bifurc.trace_branch(circle, np.array([1.0, 0.1]))
    >>> branch.closed, round(branch.length / np.pi, 12)
    (True, 2.0)
    >>> bool(np.abs(np.linalg.norm(branch.sample(1000), axis=1) - 1).max() < 1e-12)
    True
    """
    check_type("problem", problem, Problem)
    check_type("settings", settings, TraceSettings)
    start = point_of("start", start, problem.n)
    if direction is not None:
        direction = point_of("direction", direction, problem.n)
        if not np.any(direction):
            raise ProblemError("direction", direction, "a vector other than zero")
    tangent = null_vector(problem, start, direction)
    place = Place(start, tangent)
    ways = _followed_both_ways(problem, place, settings, closing, deadline)
    branch = ways.branch
    for farther, is_backward in _places_with_room(problem, ways):
        again = _followed_both_ways(problem, farther, settings, closing, deadline)
        if _goes_farther(again.branch, branch):
            branch = again.branch.reversed() if is_backward else again.branch
    return branch


def _followed_both_ways(
    problem: Problem,
    start: Place,
    settings: TraceSettings,
    closing: float,
    deadline: Deadline | None,
) -> _Ways:
    """The ways that a curve goes from ``start``; none backward where the one forward is
    the whole of it."""
    forward = follow_curve(problem, start, settings, closing, deadline)
    if forward.outcome in WHOLE or is_time_over():
        return _Ways(forward, None)
    back = Place(start.point, -start.tangent)
    return _Ways(forward, follow_curve(problem, back, settings, closing, deadline))


def _places_with_room(problem: Problem, ways: _Ways) -> list[tuple[Place, bool]]:
    """Places to follow a curve from once more, towards where it stalled so near to its
    start that bridges had no room to begin, and whether that is backward.

    A start on a half-branch beside a singular point is as far from it as a piece is
    wide, and a step may end at the point.
    """
    forward, backward = ways
    if backward is None or ways.branch.closed:
        return []
    room = MOST_ROOM * problem.domain.scale
    places = []
    for way, other in ((forward, backward), (backward, forward)):
        if way.outcome is not Outcome.STALLED or way.length > room:
            continue
        if len(way.pieces) and len(other.pieces):
            s = min(room, 0.5 * other.length)
            slope = other(s, 1)
            place = Place(other(s), -slope / np.linalg.norm(slope))
            places.append((place, way is backward))
    return places


def _goes_farther(branch: Branch, other: Branch) -> bool:
    """Whether a branch is more of a curve than the ``other`` one."""
    if branch.closed or other.closed:
        return branch.closed and not other.closed
    return branch.length > other.length


def follow_curve(
    problem: Problem,
    start: Place,
    settings: TraceSettings,
    closing: float = is_solution.threshold,
    deadline: Deadline | None = None,
) -> Branch:
    """The curve from ``start`` to the side of its tangent until it closes, leaves the
    region, stalls or grows too long, or the ``deadline`` has passed."""
    track = Track(start, settings.order, problem.domain.has_crossings)
    while True:
        march = _march(problem, track, settings, closing)
        if march.status is MarchStatus.OPEN and not len(track):
            gap = float(march.residuals[-1])
            return track.empty_branch(Outcome.OPEN, problem.domain.periods, gap)
        first = max(len(track) - 1, 0)  # the former last piece may reach over the end
        track.append(march)
        end = end_of_curve(problem, track, first, settings.tolerance)
        if end is None:
            end = _end_of_patience(problem, track, march, settings)
        is_late = deadline is not None and deadline.passed
        if end is None and (is_late or is_time_over()):
            end = End(Outcome.TIME_LIMIT, track.reached)
        if end is not None:
            return track.branch(end, problem.domain.periods)


def _end_of_patience(
    problem: Problem, track: Track, march: March, settings: TraceSettings
) -> End | None:
    """The end of the curve where it stalled after a ``march`` or grew too long; None
    where it goes on."""
    end: End | None = None
    # beside a cusp the end of a piece may be corrected to where nothing is solved
    if march.status is not MarchStatus.RAN:
        end = _overcome_stall(problem, track, settings)
    elif _is_clear(problem, march, settings):
        track.allow_long_steps_only()
    longest = settings.max_length * problem.domain.reach * problem.domain.scale
    if end is None and track.reached > longest:
        end = End(Outcome.STEP_LIMIT, track.reached)
    return end


def _march(
    problem: Problem, track: Track, settings: TraceSettings, closing: float
) -> March:
    """Some pieces from the front of the track on."""
    domain = problem.domain
    count = min(max(AT_ONCE, len(track)), MOST_AT_ONCE)
    count = min(count, max(UNKNOWNS_AT_ONCE // problem.n, 1))
    march_settings = MarchSettings(
        order=settings.order,
        tolerance=settings.tolerance,
        shortest=max(track.caution.shortest, settings.shortest) * problem.domain.scale,
        longest=settings.longest * domain.stride * domain.scale,
        count=min(AT_A_BEND, count) if track.is_at_a_bend else count,
        closing=closing,
        length=settings.max_length * domain.reach * domain.scale - track.reached,
        first=GROWTH * track.last_width,
        anchor=Anchor(
            *track.begin, same_place(settings.tolerance) * problem.domain.scale
        ),
    )
    if closing > is_solution.threshold and len(
        track
    ):  # an ordinary curve misses rounding alone
        gaps = relative_gaps(problem, track.pieces[-AT_A_BEND:, 0])
        march_settings = replace(march_settings, misclosure=gaps.max(initial=0.0))
    front = track.front
    return problem.march(front.point, front.tangent, march_settings)


def _is_clear(problem: Problem, march: March, settings: TraceSettings) -> bool:
    """Whether the last step of a march is long enough for the least caution."""
    if not len(march.radii):
        return False
    shortest = max(CAUTIOUS[0].shortest, settings.shortest) * problem.domain.scale
    return bool(march.radii[-1] > CLEAR * shortest)


def _overcome_stall(
    problem: Problem, track: Track, settings: TraceSettings
) -> End | None:
    """The end of the curve, if the track ends where it stalled or on a bridge laid from
    there; None where it goes on."""
    if not track.may_overcome_stall():
        return End(Outcome.STALLED, track.reached)
    bridge = bridge_from(problem, track, settings.tolerance)
    if bridge is not None:
        track.append_bridge(bridge)
        return end_of_curve(problem, track, len(track) - 1, settings.tolerance)
    if not track.may_take_shorter_steps:
        return End(Outcome.STALLED, track.reached)
    track.allow_shorter_steps()
    return None


def joined_branch(before: Branch, after: Branch) -> Branch:
    """One open branch from two that share the end of the first and the start of the
    second."""
    shift = before.length
    outcomes = (before.outcome, after.outcome)
    ends = (Outcome.TIME_LIMIT, Outcome.STALLED, after.outcome)
    return replace(
        after,
        pieces=np.concatenate([before.pieces, after.pieces]),
        centers=np.concatenate([before.centers, after.centers + shift]),
        radii=np.concatenate([before.radii, after.radii]),
        breaks=np.concatenate([before.breaks, after.breaks[1:] + shift]),
        residuals=np.concatenate([before.residuals, after.residuals]),
        outcome=next(end for end in ends if end in outcomes),
    )


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
