"""Tracing: from a start and a direction to one branch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.monitor import singular_values
from bifurc.errors import ProblemError
from bifurc.numerics.collocation import bridge_by_collocation
from bifurc.numerics.null_spaces import LARGE, decompose, null_vector
from bifurc.pieces import point_and_slope, points_on_piece
from bifurc.problem import March, MarchSettings, MarchStatus, Piece, Problem
from bifurc.singular.locate import locate_singular_point

__all__ = ["DEFAULT_SETTINGS", "TraceSettings", "trace_branch"]


@dataclass(frozen=True)
class TraceSettings:
    """How a curve is followed. Lengths are in units of the problem's ``scale``.

    ``order`` of the pieces and the ``tolerance`` to which they meet the curve, the
    ``shortest`` and ``longest`` trusted radius, and the ``max_length`` after which
    tracing gives up. Raises `ProblemError` outside the ranges.
    """

    order: int = 16
    tolerance: float = 1e-13
    shortest: float = 1e-9
    longest: float = 2.0
    max_length: float = 1000.0

    def __post_init__(self) -> None:
        if not 2 <= self.order <= 30:
            raise ProblemError("order", self.order, "from 2 to 30")
        if not 1e-14 <= self.tolerance <= 1e-2:
            raise ProblemError("tolerance", self.tolerance, "from 1e-14 to 1e-2")
        if not 0 < self.shortest < self.longest < self.max_length:
            raise ProblemError(
                "shortest, longest, max_length",
                (self.shortest, self.longest, self.max_length),
                "positive and increasing",
            )


DEFAULT_SETTINGS = TraceSettings()

RESOLVED = 1e-6  # two points farther apart, in scales, are never taken for one
SAME_WAY = 0.9  # cosine of the angle between two passes through one point that are one
ANCHORS = 60  # first pieces, of which the clearest is where the curve may also close
AT_ONCE = 14  # pieces made before the end of the curve is looked for
CLEAR = 10.0  # times the radius of least caution: beyond it a track is out of trouble
BRIDGE_REACHES = (0.1, 0.2, 0.05, 0.4, 0.02)  # half widths of bridges, in scales
BRIDGE_SLACKS = (10.0, 100.0)  # times the tolerance: how good nodes of a bridge must be
BRIDGE_RESIDUAL = 10.0  # times the tolerance: the residual that a bridge may have
FOOT_STEPS = 6  # of Newton's method from a sample of a piece to the foot of a point


class _Bridging(Enum):
    """Where a piece across a singular point is tried when no step is left."""

    # Where a singular point can be located.
    AT_SINGULAR_POINTS = "at singular points"
    # Whatever is there.
    ANYWHERE = "anywhere"
    # Not at all: the track ends.
    NOWHERE = "nowhere"


@dataclass(frozen=True)
class _Caution:
    """The trusted radius, in scales, below which no step is taken, and what is done
    then."""

    shortest: float
    bridging: _Bridging


# Next to a crossing rounding bends the curve F = 1e-16 from one branch into the other:
# a radius below the first of these is taken for a sign of one, and a smooth piece
# across is tried where a singular point can be located; below the second, where steps
# come to what rounding leaves of them, it is tried in any case.
CAUTIOUS = (
    _Caution(1e-4, _Bridging.AT_SINGULAR_POINTS),
    _Caution(1e-6, _Bridging.ANYWHERE),
    _Caution(0.0, _Bridging.NOWHERE),
)


# --- a track --------------------------------------------------------------------------


class _Place(NamedTuple):
    """A ``point`` (n,) of a curve and the unit ``tangent`` (n,) there."""

    point: np.ndarray
    tangent: np.ndarray


class _Bridge(NamedTuple):
    """A ``piece`` that begins at arclength ``begin`` of a track, within piece number
    ``last``."""

    last: int
    begin: float
    piece: Piece


class _End(NamedTuple):
    """Why a curve ends, and the arclengths of its track from ``begin`` to ``end`` that
    are the curve."""

    outcome: Outcome
    end: float
    begin: float = 0.0


class _Track:
    """A curve while it is followed: its pieces so far, with the arclengths of their
    ``centers`` (k,), and how cautiously it goes on."""

    def __init__(self, start: _Place, order: int):
        self._start = start
        self._level = 0
        self.pieces = np.empty((0, order + 1, len(start.point)))
        self.centers = np.empty(0)
        self.radii = np.empty(0)
        self.residuals = np.empty(0)

    def __len__(self) -> int:
        return len(self.pieces)

    @property
    def reached(self) -> float:
        """Arclength up to which the last piece is trusted."""
        return float(self.centers[-1] + self.radii[-1]) if len(self) else 0.0

    @property
    def front(self) -> _Place:
        """Where the next piece begins."""
        return self.at(-1, self.reached) if len(self) else self._start

    @property
    def caution(self) -> _Caution:
        """How cautiously the next pieces are made."""
        return CAUTIOUS[self._level]

    def at(self, number: int, s: float) -> _Place:
        """The place on piece ``number`` at arclength ``s``."""
        x = (s - self.centers[number]) / self.radii[number]
        point, slope = point_and_slope(self.pieces[number], x)
        return _Place(point, slope / np.linalg.norm(slope))

    def piece_at(self, s: float) -> int:
        """Number of the piece whose centre is nearest to arclength ``s``, over its
        radius: pieces reach back as well as on."""
        return int(np.argmin(np.abs(self.centers - s) / self.radii))

    def breaks(self, end: float) -> np.ndarray:
        """Where neighbouring pieces hand over (k + 1,), from 0 to ``end``: at equal
        fractions of their radii."""
        share = self.radii[:-1] / (self.radii[:-1] + self.radii[1:])
        inner = self.centers[:-1] + share * np.diff(self.centers)
        return np.concatenate([[0.0], inner, [end]])

    def append(self, march: March) -> None:
        """The track goes on with the pieces of a march from its front."""
        centers = self.reached + np.cumsum(march.steps)
        self.pieces = np.concatenate([self.pieces, march.pieces])
        self.centers = np.concatenate([self.centers, centers])
        self.radii = np.concatenate([self.radii, march.radii])
        self.residuals = np.concatenate([self.residuals, march.residuals])

    def append_bridge(self, bridge: _Bridge) -> None:
        """The track goes on with a bridge; pieces after its begin are dropped."""
        kept = slice(bridge.last + 1)
        radius = bridge.piece.length / 2
        self.pieces = np.concatenate(
            [self.pieces[kept], bridge.piece.coefficients[None]]
        )
        self.centers = np.append(self.centers[kept], bridge.begin + radius)
        self.radii = np.append(self.radii[kept], radius)
        self.residuals = np.append(self.residuals[kept], bridge.piece.residual)

    def take_shorter_steps(self) -> None:
        """There is no singular point to jump over: a sharp bend, to be followed."""
        self._level += 1

    def leave_trouble_behind(self) -> None:
        """Steps are long again."""
        self._level = 0

    def branch(self, end: _End, periods: np.ndarray) -> Branch:
        """The branch of the pieces between the ends of the curve."""
        if not len(self):
            return self.no_branch(end.outcome, periods)
        breaks = self.breaks(end.end)
        first = int(np.searchsorted(breaks[1:], end.begin, side="right"))
        last = int(np.searchsorted(breaks[:-1], end.end))
        kept = slice(first, last)
        inner = breaks[kept][1:] - end.begin
        return Branch(
            pieces=self.pieces[kept],
            centers=self.centers[kept] - end.begin,
            radii=self.radii[kept],
            breaks=np.concatenate([[0.0], inner, [end.end - end.begin]]),
            residuals=self.residuals[kept],
            periods=periods,
            outcome=end.outcome,
        )

    def no_branch(
        self, outcome: Outcome, periods: np.ndarray, gap: float = 0.0
    ) -> Branch:
        """A branch of no pieces."""
        nothing = np.empty(0)
        return Branch(
            pieces=self.pieces[:0],
            centers=nothing,
            radii=nothing,
            breaks=np.zeros(1),
            residuals=nothing,
            periods=periods,
            outcome=outcome,
            gap=gap,
        )


# --- tracing --------------------------------------------------------------------------


def trace_branch(
    problem: Problem,
    start: np.ndarray,
    direction: np.ndarray | None = None,
    settings: TraceSettings = DEFAULT_SETTINGS,
) -> Branch:
    """The whole smooth curve through ``start`` (n,), first followed to the side of
    ``direction`` (n,).

    A curve that does not close is followed both ways to its ends. Trouble is an
    `Outcome` on the branch, not an exception: a start that cannot be corrected gives a
    branch of no pieces whose ``gap`` is the residual left. Raises `ProblemError` for a
    start or direction of the wrong shape.
    """
    start = problem.check_point(start, "start")
    if direction is not None:
        direction = problem.check_point(direction, "direction")
    tangent = null_vector(problem, start, direction)
    forward = _follow(problem, _Place(start, tangent), settings)
    if forward.outcome in (Outcome.CLOSED, Outcome.OPEN, Outcome.STEP_LIMIT):
        return forward
    backward = _follow(problem, _Place(start, -tangent), settings)
    if not len(backward.pieces):
        return forward
    if backward.outcome is Outcome.CLOSED:
        # it came through where the other way stalled
        return backward.reversed()
    return _joined(backward.reversed(), forward)


def _follow(problem: Problem, start: _Place, settings: TraceSettings) -> Branch:
    """The curve from ``start`` to the side of its tangent until it closes, leaves the
    region, stalls or grows too long."""
    track = _Track(start, settings.order)
    longest = settings.max_length * problem.scale
    while True:
        march = _march(problem, track, settings)
        if march.status is MarchStatus.OPEN:
            gap = float(march.residuals[-1])
            return track.no_branch(Outcome.OPEN, problem.periods, gap)
        last = max(len(track) - 1, 0)
        track.append(march)
        end = _end_of_curve(problem, track, last, settings.tolerance)
        if end is None and march.status is MarchStatus.STALLED:
            end = _overcome_stall(problem, track, settings)
        elif _is_clear(problem, march, settings):
            track.leave_trouble_behind()
        if end is None and track.reached > longest:
            end = _End(Outcome.STEP_LIMIT, track.reached)
        if end is not None:
            return track.branch(end, problem.periods)


def _march(problem: Problem, track: _Track, settings: TraceSettings) -> March:
    """Some pieces from the front of the track on."""
    march_settings = MarchSettings(
        order=settings.order,
        tolerance=settings.tolerance,
        shortest=max(track.caution.shortest, settings.shortest) * problem.scale,
        longest=settings.longest * problem.scale,
        count=AT_ONCE,
    )
    front = track.front
    return problem.march(front.point, front.tangent, march_settings)


def _is_clear(problem: Problem, march: March, settings: TraceSettings) -> bool:
    """Whether the steps of a march have become long enough for the least caution."""
    shortest = max(CAUTIOUS[0].shortest, settings.shortest) * problem.scale
    return bool(len(march.radii) and march.radii[-1] > CLEAR * shortest)


def _overcome_stall(
    problem: Problem, track: _Track, settings: TraceSettings
) -> _End | None:
    """The end of the curve, if the track ends where it stalled or on a bridge laid from
    there; None where it goes on."""
    if track.caution.bridging is _Bridging.NOWHERE:
        return _End(Outcome.STALLED, track.reached)
    bridge = _bridge(problem, track, settings)
    if bridge is None:
        track.take_shorter_steps()
        return None
    track.append_bridge(bridge)
    return _end_of_curve(problem, track, len(track) - 1, settings.tolerance)


def _joined(before: Branch, after: Branch) -> Branch:
    """One open branch from two that share the end of the first and the start of the
    second."""
    shift = before.length
    outcomes = (before.outcome, after.outcome)
    return replace(
        after,
        pieces=np.concatenate([before.pieces, after.pieces]),
        centers=np.concatenate([before.centers, after.centers + shift]),
        radii=np.concatenate([before.radii, after.radii]),
        breaks=np.concatenate([before.breaks, after.breaks[1:] + shift]),
        residuals=np.concatenate([before.residuals, after.residuals]),
        outcome=Outcome.STALLED if Outcome.STALLED in outcomes else after.outcome,
    )


# --- bridges --------------------------------------------------------------------------


def _bridge(problem: Problem, track: _Track, settings: TraceSettings) -> _Bridge | None:
    """A piece across the point before which the track stalled, or None.

    Near a singular point where the rank drops faster than on a simple crossing no
    series reaches over. The curve is smooth there all the same: a piece by collocation,
    from as far before the point as beyond it, needs no series.
    """
    if not len(track):
        return None
    only_singular = track.caution.bridging is _Bridging.AT_SINGULAR_POINTS
    if only_singular and not _is_near_singular(problem, track.front.point):
        return None
    for reach in BRIDGE_REACHES:
        begin = track.reached - reach * problem.scale
        if begin < track.centers[0]:
            continue
        last = track.piece_at(begin)
        width = 2 * reach * problem.scale
        piece = _piece_across(problem, track.at(last, begin), width, settings)
        if piece is not None:
            return _Bridge(last, begin, piece)
    return None


def _piece_across(
    problem: Problem, place: _Place, width: float, settings: TraceSettings
) -> Piece | None:
    """A piece of about ``width`` from ``place`` across a crossing, or None."""
    for slack in BRIDGE_SLACKS:
        tolerance = slack * settings.tolerance
        piece = bridge_by_collocation(
            problem, place.point, place.tangent, settings.order, tolerance, width
        )
        if piece is None or piece.residual > BRIDGE_RESIDUAL * settings.tolerance:
            continue
        if _spans_a_crossing(problem, piece.coefficients, tolerance):
            return piece
    return None


def _is_near_singular(problem: Problem, point: np.ndarray) -> bool:
    """Whether a singular point can be located near ``point``, so that a bridge is worth
    trying."""
    if problem.n > LARGE:
        return False
    values = singular_values(problem, point)
    small = problem.n - int(np.count_nonzero(values > 1e-2))
    nullities = sorted({2, min(small, 4)} - {0, 1})
    reach = 0.05 * problem.scale
    return any(
        locate_singular_point(problem, point, nullity, reach) is not None
        for nullity in nullities
    )


def _spans_a_crossing(problem: Problem, piece: np.ndarray, tolerance: float) -> bool:
    """Whether a bridge meets the weakest equation to rounding, as it does where
    branches really cross.

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
    return bool(np.all(off <= 10.0 * tolerance * sigma + 1e-14))


# --- ends -----------------------------------------------------------------------------


def _end_of_curve(
    problem: Problem, track: _Track, first: int, tolerance: float
) -> _End | None:
    """Where the curve, from piece ``first`` on, closes or first leaves the bounds.

    It closes when it passes its start again, or the clearest of its first points: a
    start beside a singular point may lie off the curve by more than it shows.
    """
    if not len(track):
        return None
    begin = 0.0
    closing = _closing(problem, track, first, _Anchor(0, begin), tolerance)
    if closing is None:
        clearest = int(np.argmax(track.radii[:ANCHORS]))
        begin = float(track.centers[clearest])
        anchor = _Anchor(clearest, begin)
        closing = _closing(problem, track, clearest, anchor, tolerance)
    leaving = _leaving(problem, track, first)
    if closing is not None and (leaving is None or closing < leaving):
        return _End(Outcome.CLOSED, closing, begin)
    return None if leaving is None else _End(Outcome.LEFT_REGION, leaving)


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
    problem: Problem, track: _Track, first: int, anchor: _Anchor, tolerance: float
) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, passes the anchor again in
    the same direction."""
    place = track.at(anchor.number, anchor.s)
    beyond = anchor.s + 0.5 * track.radii[anchor.number]
    for number in _pieces_near(problem, track, first, place.point):
        foot = _foot(problem, track.pieces[number], place.point)
        s = track.centers[number] + foot.x * track.radii[number]
        if abs(foot.x) > 1.02 or not s > beyond:
            continue
        if _is_same_pass(problem, place, foot, tolerance):
            return float(s)
    return None


def _pieces_near(
    problem: Problem, track: _Track, first: int, point: np.ndarray
) -> np.ndarray:
    """Numbers of the pieces, from ``first`` on, that may pass ``point`` (n,)."""
    middles = track.pieces[first:, 0]
    distances = np.linalg.norm(problem.difference(middles, point), axis=1)
    near: np.ndarray = first + np.flatnonzero(distances < 1.1 * track.radii[first:])
    return near


def _foot(problem: Problem, piece: np.ndarray, point: np.ndarray) -> _Foot:
    """The foot of ``point`` (n,) on a piece (order + 1, n), by Newton's method."""
    grid = np.linspace(-1.0, 1.0, 17)
    offsets = problem.difference(points_on_piece(piece, grid), point)
    x = grid[np.argmin(np.linalg.norm(offsets, axis=1))]
    for _ in range(FOOT_STEPS):
        on_piece, slope = point_and_slope(piece, x)
        offset = problem.difference(on_piece, point)
        step = offset @ slope / (slope @ slope)
        x = x - step
        if abs(step) < 1e-15:
            break
    return _Foot(x, offset, slope)


def _is_same_pass(
    problem: Problem, place: _Place, foot: _Foot, tolerance: float
) -> bool:
    """Whether the curve at the foot of a place is at that place again, and runs in the
    same direction."""
    if not foot.slope @ place.tangent > SAME_WAY * np.linalg.norm(foot.slope):
        return False
    distance = np.linalg.norm(foot.offset)
    if distance > RESOLVED * problem.scale:
        return False
    if distance < max(1e-9, 30 * tolerance) * problem.scale:
        return True
    # where a singular value is small a point is known no better than rounding over it
    residual = np.linalg.norm(problem.jacobian(place.point) @ foot.offset)
    rounding = max(1e-14, 0.1 * tolerance) * problem.scale
    return bool(residual < rounding * problem.magnitude)


def _leaving(problem: Problem, track: _Track, first: int) -> float | None:
    """Arclength at which the curve, from piece ``first`` on, first leaves the
    bounds."""
    if not np.any(np.isfinite(problem.bounds)):
        return None
    breaks = track.breaks(track.reached)
    for number in range(first, len(track)):
        center, radius = track.centers[number], track.radii[number]
        grid = np.linspace(breaks[number], breaks[number + 1], 33)
        x = _exit(problem, track.pieces[number], (grid - center) / radius)
        if x is not None:
            return float(center + x * radius)
    return None


def _exit(problem: Problem, piece: np.ndarray, grid: np.ndarray) -> float | None:
    """Coordinate at which a piece (order + 1, n) leaves the bounds, as seen at those of
    ``grid``; None where it does not."""
    outside = np.flatnonzero(_excess(problem, piece, grid) > 1e-12 * problem.scale)
    if not len(outside):
        return None
    low, high = grid[max(outside[0] - 1, 0)], grid[outside[0]]
    for _ in range(60):
        middle = 0.5 * (low + high)
        if _excess(problem, piece, np.array([middle]))[0] > 0:
            high = middle
        else:
            low = middle
    return float(low)


def _excess(problem: Problem, piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    """How far a piece lies outside the bounds (k,) at x (k,), in the unknown that is
    farthest; negative inside."""
    points = points_on_piece(piece, x)
    low, high = problem.bounds.T
    farthest: np.ndarray = np.maximum(low - points, points - high).max(axis=1)
    return farthest
