"""Tracing: from a start and a direction to one branch."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.corrector import null_vector
from bifurc.problem import MarchStatus, Problem, ProblemError

__all__ = ["TraceSettings", "trace_branch"]


@dataclass(frozen=True)
class TraceSettings:
    """How a curve is followed. Lengths are in units of the problem's ``scale``.

    ``order`` of the pieces and the ``tolerance`` to which they meet the curve, the ``shortest`` and ``longest`` trusted
    radius, and the ``max_length`` after which tracing gives up. Raises `ProblemError` outside the ranges.
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
                "shortest, longest, max_length", (self.shortest, self.longest, self.max_length),
                "positive and increasing",
            )  # fmt: skip


DEFAULT_SETTINGS = TraceSettings()


def trace_branch(
    problem: Problem,
    start: np.ndarray,
    direction: np.ndarray | None = None,
    settings: TraceSettings = DEFAULT_SETTINGS,
) -> Branch:
    """The whole smooth curve through ``start`` (n,), first followed to the side of ``direction`` (n,).

    A curve that does not close is followed both ways to its ends. Trouble is an `Outcome` on the branch, not an
    exception: a start that cannot be corrected gives a branch of no pieces whose ``gap`` is the residual left. Raises
    `ProblemError` for a start or direction of the wrong shape.
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
    return _join(backward.reversed(), forward)


def _follow(problem: Problem, start: np.ndarray, tangent: np.ndarray, settings: TraceSettings) -> Branch:
    """The curve from ``start`` along ``tangent`` until it closes, leaves the region, stalls or grows too long."""
    scale, count = problem.scale, 28
    pieces = np.empty((0, settings.order + 1, problem.n))
    centers, radii, residuals = np.empty(0), np.empty(0), np.empty(0)
    point, heading, reached = start, tangent, 0.0
    while True:
        run = problem.march(
            point, heading, settings.order, settings.tolerance, settings.shortest * scale,
            settings.longest * scale, count,
        )  # fmt: skip
        first = max(len(pieces) - 1, 0)
        centers = np.concatenate([centers, reached + np.cumsum(run.steps)])
        pieces, radii = np.concatenate([pieces, run.pieces]), np.concatenate([radii, run.radii])
        if run.status == MarchStatus.OPEN:
            gap = float(run.residuals[-1])
            return _assemble(problem, pieces, centers, radii, residuals, Outcome.OPEN, 0.0, gap)
        residuals = np.concatenate([residuals, run.residuals])
        if not len(run.pieces):
            return _assemble(problem, pieces, centers, radii, residuals, Outcome.STALLED, reached)
        end = _end_of_curve(problem, pieces, centers, radii, first)
        if end is not None:
            return _assemble(problem, pieces, centers, radii, residuals, *end)
        reached = float(centers[-1] + radii[-1])
        if run.status == MarchStatus.STALLED:
            return _assemble(problem, pieces, centers, radii, residuals, Outcome.STALLED, reached)
        if reached > settings.max_length * scale:
            return _assemble(problem, pieces, centers, radii, residuals, Outcome.STEP_LIMIT, reached)
        point = pieces[-1].sum(axis=0)
        heading = np.arange(settings.order + 1) @ pieces[-1]
        heading, count = heading / np.linalg.norm(heading), 16


def _breaks(centers: np.ndarray, radii: np.ndarray, length: float) -> np.ndarray:
    """Where neighbouring pieces hand over: at equal fractions of their radii."""
    share = radii[:-1] / (radii[:-1] + radii[1:])
    inner = centers[:-1] + share * np.diff(centers)
    return np.concatenate([[0.0], inner, [length]])


def _assemble(
    problem: Problem, pieces: np.ndarray, centers: np.ndarray, radii: np.ndarray, residuals: np.ndarray,
    outcome: Outcome, length: float, gap: float = 0.0,
) -> Branch:  # fmt: skip
    """The branch of the pieces up to arclength ``length``."""
    breaks = _breaks(centers, radii, length) if len(pieces) else np.zeros(1)
    keep = int(np.searchsorted(breaks[:-1], length, side="left")) if len(pieces) else 0
    breaks = np.append(breaks[:keep], length)
    return Branch(
        pieces[:keep], centers[:keep], radii[:keep], breaks, residuals[:keep], problem.periods, outcome, gap
    )


def _end_of_curve(
    problem: Problem, pieces: np.ndarray, centers: np.ndarray, radii: np.ndarray, first: int
) -> tuple[Outcome, float] | None:
    """Where the curve, from piece ``first`` on, comes back to its start or first leaves the bounds."""
    closing = _closing(problem, pieces, centers, radii, first)
    leaving = _leaving(problem, pieces, centers, radii, first)
    if closing is not None and (leaving is None or closing < leaving):
        return Outcome.CLOSED, closing
    return None if leaving is None else (Outcome.LEFT_REGION, leaving)


def _closing(
    problem: Problem, pieces: np.ndarray, centers: np.ndarray, radii: np.ndarray, first: int
) -> float | None:
    """Arclength at which the curve passes its start again in the same direction, modulo the periods."""
    order = pieces.shape[1] - 1
    powers = (-centers[0] / radii[0]) ** np.arange(order + 1)
    start = powers @ pieces[0]
    slope = (np.arange(1, order + 1) * powers[:-1]) @ pieces[0][1:] / radii[0]
    away = np.linalg.norm(problem.difference(pieces[first:, 0], start), axis=1)
    for i in first + np.flatnonzero(away < 1.1 * radii[first:]):
        grid = np.linspace(-1.0, 1.0, 17)
        gap = problem.difference(np.vander(grid, order + 1, increasing=True) @ pieces[i], start)
        x = grid[np.argmin(np.linalg.norm(gap, axis=1))]
        for _ in range(6):
            powers = x ** np.arange(order + 1)
            offset = problem.difference(powers @ pieces[i], start)
            tangent = (np.arange(1, order + 1) * powers[:-1]) @ pieces[i][1:]
            x = x - offset @ tangent / (tangent @ tangent)
        s = centers[i] + x * radii[i]
        same_way = tangent @ slope > 0.9 * np.linalg.norm(tangent)
        # across a start beside a crossing the tangent turns no more than the pieces' own error allows
        if abs(x) <= 1.02 and s > 0.5 * radii[0] and same_way and np.linalg.norm(offset) < 1e-9 * problem.scale:
            return float(s)
    return None


def _leaving(
    problem: Problem, pieces: np.ndarray, centers: np.ndarray, radii: np.ndarray, first: int
) -> float | None:
    """Arclength at which the curve first leaves the bounds."""
    if not np.any(np.isfinite(problem.bounds)):
        return None

    def outside(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
        points = np.vander(x, len(piece), increasing=True) @ piece
        return np.max(np.maximum(problem.bounds[:, 0] - points, points - problem.bounds[:, 1]), axis=1)

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
    """One open branch from two that share the end of the first and the start of the second."""
    shift = before.length
    return replace(
        after,
        pieces=np.concatenate([before.pieces, after.pieces]),
        centers=np.concatenate([before.centers, after.centers + shift]),
        radii=np.concatenate([before.radii, after.radii]),
        breaks=np.concatenate([before.breaks, after.breaks[1:] + shift]),
        residuals=np.concatenate([before.residuals, after.residuals]),
        outcome=Outcome.STALLED if Outcome.STALLED in (before.outcome, after.outcome) else after.outcome,
    )
