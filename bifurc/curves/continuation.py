"""Tracing: from a start and a direction to one branch."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.errors import ProblemError
from bifurc.numerics.collocation import bridge_by_collocation
from bifurc.numerics.corrector import LARGE, null_vector
from bifurc.problem import MarchStatus, Problem
from bifurc.singular.locate import locate_singular_point

__all__ = ["TraceSettings", "trace_branch"]


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

# Next to a crossing rounding bends the curve F = 1e-16 from one branch into the other:
# a radius below the first of these is taken for a sign of one, and a smooth piece
# across is tried where a singular point can be located; below the second, where steps
# come to what rounding leaves of them, it is tried in any case.
CAUTIOUS = (1e-4, 1e-6)
RESOLVED = 1e-6  # two points farther apart, in scales, are never taken for one
ANCHORS = 60  # first pieces, of which the clearest is where the curve may also close
AT_ONCE = 14  # pieces made before the end of the curve is looked for


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
    along = None if direction is None else problem.check_point(direction, "direction")
    tangent = null_vector(problem, start, along)
    forward = _follow(problem, start, tangent, settings)
    if forward.outcome in (Outcome.CLOSED, Outcome.OPEN, Outcome.STEP_LIMIT):
        return forward
    backward = _follow(problem, start, -tangent, settings)
    if not len(backward.pieces):
        return forward
    if (
        backward.outcome is Outcome.CLOSED
    ):  # it came through where the other way stalled
        return backward.reversed()
    return _join(backward.reversed(), forward)


@dataclass(frozen=True)
class _Track:
    """Pieces gathered so far, with the arclengths of their centres."""

    pieces: np.ndarray
    centers: np.ndarray
    radii: np.ndarray
    residuals: np.ndarray

    @property
    def reached(self) -> float:
        """Arclength up to which the last piece is trusted."""
        return float(self.centers[-1] + self.radii[-1]) if len(self.centers) else 0.0

    def extended(
        self,
        keep: int,
        pieces: np.ndarray,
        centers: np.ndarray,
        radii: np.ndarray,
        residuals: np.ndarray,
    ) -> _Track:
        """The first ``keep`` pieces and the given ones."""
        return _Track(
            np.concatenate([self.pieces[:keep], pieces]),
            np.concatenate([self.centers[:keep], centers]),
            np.concatenate([self.radii[:keep], radii]),
            np.concatenate([self.residuals[:keep], residuals]),
        )

    def at(self, piece: int, s: float) -> tuple[np.ndarray, np.ndarray]:
        """Point and unit tangent of a piece at arclength ``s``."""
        order = self.pieces.shape[1] - 1
        powers = ((s - self.centers[piece]) / self.radii[piece]) ** np.arange(order + 1)
        slope = (np.arange(1, order + 1) * powers[:-1]) @ self.pieces[piece][1:]
        return powers @ self.pieces[piece], slope / np.linalg.norm(slope)


def _follow(
    problem: Problem, start: np.ndarray, tangent: np.ndarray, settings: TraceSettings
) -> Branch:
    """The curve from ``start`` along ``tangent`` until it closes, leaves the region,
    stalls or grows too long."""
    scale = problem.scale
    nothing = np.empty(0)
    track = _Track(
        np.empty((0, settings.order + 1, problem.n)), nothing, nothing, nothing
    )
    point, heading = start, tangent
    shortest = [max(radius, settings.shortest) * scale for radius in (*CAUTIOUS, 0.0)]
    level = 0
    while True:
        run = problem.march(
            point,
            heading,
            settings.order,
            settings.tolerance,
            shortest[level],
            settings.longest * scale,
            AT_ONCE,
        )
        if run.status == MarchStatus.OPEN:
            return _assemble(
                problem, track, Outcome.OPEN, 0.0, gap=float(run.residuals[-1])
            )
        known = len(track.pieces)
        track = track.extended(
            known,
            run.pieces,
            track.reached + np.cumsum(run.steps),
            run.radii,
            run.residuals,
        )
        end = _end_of_curve(problem, track, max(known - 1, 0), settings.tolerance)
        if end is None and run.status == MarchStatus.STALLED:
            bridged = (
                _bridge(problem, track, settings, level == 0)
                if level < len(CAUTIOUS)
                else None
            )
            if bridged is not None:
                track = bridged
                end = _end_of_curve(
                    problem, track, len(track.pieces) - 1, settings.tolerance
                )
            elif level < len(CAUTIOUS):
                level += (
                    1  # no singular point to jump over: a sharp bend, to be followed
                )
            else:
                return _assemble(problem, track, Outcome.STALLED, track.reached)
        elif len(run.radii) and run.radii[-1] > 10 * shortest[0]:
            level = 0
        if end is not None:
            return _assemble(problem, track, *end)
        if track.reached > settings.max_length * scale:
            return _assemble(problem, track, Outcome.STEP_LIMIT, track.reached)
        if len(track.pieces):
            point, heading = track.at(-1, track.reached)


def _bridge(
    problem: Problem, track: _Track, settings: TraceSettings, located: bool
) -> _Track | None:
    """The track with a piece across the point before which it stalled, or None.

    Near a singular point where the rank drops faster than on a simple crossing no
    series reaches over. The curve is smooth there all the same: a piece by collocation,
    from as far before the point as beyond it, needs no series. With ``located`` it is
    tried only where a singular point can be located.
    """
    if not len(track.pieces) or (
        located and not _is_near_singular(problem, track.at(-1, track.reached)[0])
    ):
        return None
    for reach in (0.1, 0.2, 0.05, 0.4, 0.02):
        begin = track.reached - reach * problem.scale
        if begin < track.centers[0]:
            continue
        last = int(
            np.argmin(np.abs(track.centers - begin) / track.radii)
        )  # pieces reach back as well as on
        for slack in (10.0, 100.0):
            tolerance = slack * settings.tolerance
            point, heading = track.at(last, begin)
            made = bridge_by_collocation(
                problem,
                point,
                heading,
                settings.order,
                tolerance,
                2 * reach * problem.scale,
            )
            enough = 10.0 * settings.tolerance
            if (
                made is not None
                and made[2] <= enough
                and _spans_a_crossing(problem, made[0], tolerance)
            ):
                piece, length, residual = made
                return track.extended(
                    last + 1,
                    piece[None],
                    np.array([begin + length / 2]),
                    np.array([length / 2]),
                    np.array([residual]),
                )
    return None


def _is_near_singular(problem: Problem, point: np.ndarray) -> bool:
    """Whether a singular point can be located near ``point``, so that a bridge is worth
    trying."""
    if problem.n > LARGE:
        return False
    values = np.linalg.svd(
        problem.jacobians(point[None])[0] / problem.magnitude, compute_uv=False
    )
    small = problem.n - int(np.count_nonzero(values > 1e-2))
    return any(
        locate_singular_point(problem, point, k, 0.05 * problem.scale) is not None
        for k in sorted({2, min(small, 4)})
        if k > 1
    )


def _spans_a_crossing(problem: Problem, piece: np.ndarray, tolerance: float) -> bool:
    """Whether a bridge meets the weakest equation to rounding, as it does where
    branches really cross.

    Straight across a near miss of width w that equation is off by w^2, while its
    singular value goes to zero: a residual that no correction of the size of
    ``tolerance`` explains.
    """
    points = np.vander(np.linspace(-1.0, 1.0, 61), len(piece), increasing=True) @ piece
    residuals = problem.residuals(points) / problem.magnitude
    left, sigma, _ = np.linalg.svd(problem.jacobians(points) / problem.magnitude)
    if sigma.shape[1] < problem.n - 1:
        return True
    weak = np.abs(np.einsum("km,km->k", left[:, :, problem.n - 2], residuals))
    return bool(np.all(weak <= 10.0 * tolerance * sigma[:, problem.n - 2] + 1e-14))


def _breaks(centers: np.ndarray, radii: np.ndarray, length: float) -> np.ndarray:
    """Where neighbouring pieces hand over: at equal fractions of their radii."""
    share = radii[:-1] / (radii[:-1] + radii[1:])
    inner = centers[:-1] + share * np.diff(centers)
    return np.concatenate([[0.0], inner, [length]])


def _assemble(
    problem: Problem,
    track: _Track,
    outcome: Outcome,
    end: float,
    begin: float = 0.0,
    gap: float = 0.0,
) -> Branch:
    """The branch of the pieces from arclength ``begin`` to ``end``."""
    breaks = (
        _breaks(track.centers, track.radii, end) if len(track.pieces) else np.zeros(1)
    )
    keep = slice(
        int(np.searchsorted(breaks[1:], begin, side="right")),
        int(np.searchsorted(breaks[:-1], end)),
    )
    inner = breaks[keep][1:] - begin
    return Branch(
        track.pieces[keep],
        track.centers[keep] - begin,
        track.radii[keep],
        np.concatenate([[0.0], inner, [end - begin]])
        if len(track.pieces)
        else np.zeros(1),
        track.residuals[keep],
        problem.periods,
        outcome,
        gap,
    )


def _end_of_curve(
    problem: Problem, track: _Track, first: int, tolerance: float
) -> tuple[Outcome, float, float] | None:
    """Where the curve, from piece ``first`` on, closes or first leaves the bounds:
    outcome, end and begin.

    It closes when it passes its start again, or the clearest of its first points: a
    start beside a singular point may lie off the curve by more than it shows.
    """
    if not len(track.pieces):
        return None
    anchor = int(np.argmax(track.radii[:ANCHORS]))
    closing = _closing(problem, track, first, 0, 0.0, tolerance)
    begin = 0.0
    if closing is None:
        begin = float(track.centers[anchor])
        closing = _closing(problem, track, anchor, anchor, begin, tolerance)
    leaving = _leaving(problem, track, first)
    if closing is not None and (leaving is None or closing < leaving):
        return Outcome.CLOSED, closing, begin
    return None if leaving is None else (Outcome.LEFT_REGION, leaving, 0.0)


def _closing(
    problem: Problem,
    track: _Track,
    first: int,
    begun: int,
    begin: float,
    tolerance: float,
) -> float | None:
    """Arclength at which the curve passes again, in the same direction, the point of
    piece ``begun`` at ``begin``."""
    pieces, centers, radii = track.pieces, track.centers, track.radii
    order = pieces.shape[1] - 1
    start, slope = track.at(begun, begin)
    close, close_residual = (
        max(1e-9, 30 * tolerance) * problem.scale,
        max(1e-14, 0.1 * tolerance) * problem.scale,
    )
    away = np.linalg.norm(problem.difference(pieces[first:, 0], start), axis=1)
    for i in first + np.flatnonzero(away < 1.1 * radii[first:]):
        grid = np.linspace(-1.0, 1.0, 17)
        gap = problem.difference(
            np.vander(grid, order + 1, increasing=True) @ pieces[i], start
        )
        x = grid[np.argmin(np.linalg.norm(gap, axis=1))]
        for _ in range(6):
            powers = x ** np.arange(order + 1)
            offset = problem.difference(powers @ pieces[i], start)
            tangent = (np.arange(1, order + 1) * powers[:-1]) @ pieces[i][1:]
            step = offset @ tangent / (tangent @ tangent)
            x = x - step
            if abs(step) < 1e-15:
                break
        s = centers[i] + x * radii[i]
        same_way = tangent @ slope > 0.9 * np.linalg.norm(tangent)
        apart = float(np.linalg.norm(offset))
        again = s > begin + 0.5 * radii[begun]
        if (
            abs(x) > 1.02
            or not again
            or not same_way
            or apart > RESOLVED * problem.scale
        ):
            continue
        # where a singular value is small a point is known no better than rounding over
        # it
        if (
            apart < close
            or np.linalg.norm(problem.jacobian(start) @ offset)
            < close_residual * problem.magnitude
        ):
            return float(s)
    return None


def _leaving(problem: Problem, track: _Track, first: int) -> float | None:
    """Arclength at which the curve first leaves the bounds."""
    pieces, centers, radii = track.pieces, track.centers, track.radii
    if not np.any(np.isfinite(problem.bounds)):
        return None

    def outside(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
        points = np.vander(x, len(piece), increasing=True) @ piece
        return np.max(
            np.maximum(problem.bounds[:, 0] - points, points - problem.bounds[:, 1]),
            axis=1,
        )

    edges = _breaks(centers, radii, centers[-1] + radii[-1])
    for i in range(first, len(pieces)):
        x = (np.linspace(edges[i], edges[i + 1], 33) - centers[i]) / radii[i]
        beyond = np.flatnonzero(outside(pieces[i], x) > 1e-12 * problem.scale)
        if not len(beyond):
            continue
        low, high = x[max(beyond[0] - 1, 0)], x[beyond[0]]
        for _ in range(60):
            middle = 0.5 * (low + high)
            if outside(pieces[i], np.array([middle]))[0] > 0:
                high = middle
            else:
                low = middle
        return float(centers[i] + low * radii[i])
    return None


def _join(before: Branch, after: Branch) -> Branch:
    """One open branch from two that share the end of the first and the start of the
    second."""
    shift = before.length
    return replace(
        after,
        pieces=np.concatenate([before.pieces, after.pieces]),
        centers=np.concatenate([before.centers, after.centers + shift]),
        radii=np.concatenate([before.radii, after.radii]),
        breaks=np.concatenate([before.breaks, after.breaks[1:] + shift]),
        residuals=np.concatenate([before.residuals, after.residuals]),
        outcome=Outcome.STALLED
        if Outcome.STALLED in (before.outcome, after.outcome)
        else after.outcome,
    )
