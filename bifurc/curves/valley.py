"""Systems that contradict themselves a little: the valley along which they are nearly
solved.

A linkage made with errors has no curve of solutions, since its redundant equations no
longer agree. What is left of the curve is a valley of |F|. With F' = U diag(sigma) V^T
and v_n the weak right singular vector, a point lies on the valley where u_i . F = 0 for
i = 1 .. n - 1: to first order |F| is then the least that any move across v_n can reach,
and the gradient of |F|^2 runs along the valley. These n - 1 equations make a curve. The
corrector takes

    d = - sum_{i < n} v_i (u_i . F) / sigma_i,

Gauss-Newton steps of rank n - 1, which never divide by the singular value that the
errors made of zero; the predictor goes along v_n. |F| on the valley is the closure gap.
At a consistent system the valley is the curve itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from itertools import combinations
from typing import NamedTuple

import numpy as np

from bifurc.numerics.null_spaces import decompose
from bifurc.numerics.singular_values import factors_of
from bifurc.problem import Problem

# corrections of one point; convergence is linear with a rate of about the gap over
# sigma
ROUNDS = 40
# singular values below this share of the largest are taken for that in a correction
FLOOR = 1e-12
# of the way on which a singular value could fall to zero: the longest step
SHARE = 0.25
TURN = 0.25  # rad between the tangents of neighbouring points
# distance from a start, in scales, beyond which another valley is reached and not its
# own
FAR = 0.25
SHORTEST = 1e-9  # step, in scales, at which a valley is given up
FINE = 8  # samples of a step where two valleys are compared


class ValleyEnd(Enum):
    """Why following a valley ended."""

    DONE = "done: the condition to stop was met"
    STEP_LIMIT = "step limit: raise the number of steps"
    LOST = (
        "lost: the corrector does not converge; "
        "the errors are too large for a valley here"
    )


@dataclass(frozen=True)
class Valley:
    """A stretch of a valley: ``points`` (k, n), unit ``tangents`` (k, n), ``gaps``
    (k,): relative residuals, and ``weakest`` (k,): singular value n - 1 over the
    problem's magnitude, zero where the valley would fork."""

    points: np.ndarray
    tangents: np.ndarray
    gaps: np.ndarray
    weakest: np.ndarray
    end: ValleyEnd

    def dense(self) -> np.ndarray:
        """Points of the cubic through points and tangents, `FINE` a step."""
        from scipy.interpolate import CubicHermiteSpline

        if len(self.points) < 2:
            return self.points
        steps = np.diff(self.points, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        s = np.concatenate([[0.0], np.cumsum(lengths)])
        fine_steps = np.diff(s) / FINE
        between = s[:-1, None] + np.arange(FINE) * fine_steps[:, None]
        cubic = CubicHermiteSpline(s, self.points, self.tangents)
        points: np.ndarray = cubic(np.append(between, s[-1]))
        return points


@dataclass(frozen=True)
class Unfolding:
    """What a crossing of nominal branches has become.

    ``pairs``: which of the starts are joined by a valley, by their indices,
    ``distance``: the least between two valleys that join different starts (infinite
    where there is one valley alone), ``weakest``: the smallest singular value n - 1
    along them, over the problem's magnitude, ``gap``: the largest relative residual
    along them.
    """

    pairs: tuple[tuple[int, int], ...]
    distance: float
    weakest: float
    gap: float
    valleys: tuple[Valley, ...]


# --- onto a valley --------------------------------------------------------------------


def correct_to_valley(
    problem: Problem, points: np.ndarray, rounds: int = ROUNDS
) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, n) moved onto the valley, across it, and the relative residual (k,)
    that is left at each."""
    points = np.array(points, dtype=float)
    rank = problem.n - 1
    for _ in range(rounds):
        steps = decompose(problem, points).newton_steps(rank, FLOOR)
        points += steps
        longest = np.abs(steps).max(initial=0.0)
        if longest < 1e-14 * problem.scale:
            break
    return points, problem.gaps(points)


class _Station(NamedTuple):
    """A ``point`` (n,) on a valley, the unit ``tangent`` (n,) and singular value n - 1
    there."""

    point: np.ndarray
    tangent: np.ndarray
    sigma: float


def _settle(
    problem: Problem, point: np.ndarray, heading: np.ndarray, enough: float
) -> _Station | None:
    """The station of the valley across the weak direction from ``point``.

    Corrections end below ``enough``, or where they shrink no more: at rounding over the
    singular value. None where they do not become small: where the residual times F'' is
    no longer small beside sigma^2, the valley has no floor.
    """
    rank = problem.n - 1
    before = np.inf
    for _ in range(ROUNDS):
        decomposition = decompose(problem, point[None])
        step = decomposition.newton_steps(rank, FLOOR)[0]
        size = float(np.linalg.norm(step))
        shrinks_no_more = size < 1e3 * enough and size > 0.3 * before
        if size < enough or shrinks_no_more:
            weak = decomposition.right[0, rank]
            tangent = weak if weak @ heading >= 0 else -weak
            sigma = float(decomposition.sigma[0, rank - 1])
            return _Station(point + step, tangent, sigma)
        # corrections that overshoot in turn are halved
        point = point + (step if size < 0.9 * before else 0.5 * step)
        before = size
    return None


# --- along a valley -------------------------------------------------------------------


def follow_valley(
    problem: Problem,
    start: np.ndarray,
    direction: np.ndarray,
    stop: Callable[[np.ndarray], bool],
    longest: float = 0.1,
    steps: int = 20_000,
) -> Valley:
    """The valley from near ``start`` (n,) to the side of ``direction``, until ``stop``
    says so of a point.

    No step is longer than ``longest`` (in units of the problem's scale), turns the
    tangent by more than `TURN`, or covers more than a quarter of the way on which
    singular value n - 1 could fall to zero: no crossing is nearer.
    """
    station = _settle(problem, start, direction, 1e-9 * problem.scale)
    if station is None or not _is_near(problem, station.point, start):
        heading = direction / np.linalg.norm(direction)
        nowhere = _Station(start, heading, 0.0)
        return _valley(problem, [nowhere], ValleyEnd.LOST)
    stations = [station]
    longest *= problem.scale
    length = longest
    for _ in range(steps):
        rate = _rate(problem, station.point, station.tangent)
        clear = SHARE * station.sigma / rate
        length = min(2.0 * length, longest, clear)
        step = _step(problem, station, length)
        if step is None:
            return _valley(problem, stations, ValleyEnd.LOST)
        length, station = step
        stations.append(station)
        if stop(station.point):
            return _valley(problem, stations, ValleyEnd.DONE)
    return _valley(problem, stations, ValleyEnd.STEP_LIMIT)


def _is_near(problem: Problem, point: np.ndarray, start: np.ndarray) -> bool:
    """Whether a point is still on the valley of its start."""
    distance = np.linalg.norm(point - start)
    return bool(distance <= FAR * problem.scale)


def _step(
    problem: Problem, station: _Station, length: float
) -> tuple[float, _Station] | None:
    """The length of a step, at most ``length``, and where it leads; None where even the
    shortest fails."""
    u, t = station.point, station.tangent
    while True:
        ahead = u + length * t
        following = _settle(problem, ahead, t, 1e-6 * length)
        if following is not None:
            correction = np.linalg.norm(following.point - u - length * t)
            is_straight = following.tangent @ t >= np.cos(TURN)
            if correction <= 0.5 * length and is_straight:
                return length, following
        length *= 0.5
        if length < SHORTEST * problem.scale:
            return None


def _valley(problem: Problem, stations: list[_Station], end: ValleyEnd) -> Valley:
    points = np.array([station.point for station in stations])
    return Valley(
        points=points,
        tangents=np.array([station.tangent for station in stations]),
        gaps=problem.gaps(points),
        weakest=np.array([station.sigma for station in stations]),
        end=end,
    )


def _rate(problem: Problem, point: np.ndarray, tangent: np.ndarray) -> float:
    """How fast the block of F' that nearly vanishes, over the problem's magnitude,
    changes along ``tangent``."""
    rank = problem.n - 2
    jacobian = problem.jacobians(point[None])[0]
    left, _, right = factors_of(jacobian)
    change = problem.hessian(point) @ tangent / problem.magnitude
    block = left[:, rank:].T @ change @ right[rank:].T
    return float(np.linalg.norm(block)) + 1e-3 / problem.scale


# --- crossings ------------------------------------------------------------------------


def unfold_crossing(
    problem: Problem, center: np.ndarray, starts: np.ndarray
) -> Unfolding:
    """How the nominal half-branches that reached from ``starts`` (h, n) to ``center``
    (n,) are joined now.

    From every start the valley is followed inwards, until it leaves the ball about the
    centre that the start lies on.
    """
    offsets = starts - center
    radii = np.linalg.norm(offsets, axis=1)
    free = list(range(len(starts)))
    valleys: list[Valley] = []
    pairs: list[tuple[int, int]] = []
    while free:
        i = free.pop(0)
        stop = _leaves(center, float(radii[i]))
        valley = follow_valley(problem, starts[i], -offsets[i], stop)
        gaps = valley.points[-1] - starts
        distances = np.linalg.norm(gaps, axis=1) / radii
        distances[i] = np.inf
        j = int(np.argmin(distances))
        valleys.append(valley)
        pairs.append((i, j))
        if j in free and valley.end is ValleyEnd.DONE:
            free.remove(j)
    distances_between = [_distance(a, b) for a, b in combinations(valleys, 2)]
    return Unfolding(
        pairs=tuple(pairs),
        distance=min(distances_between, default=np.inf),
        weakest=min(float(valley.weakest.min()) for valley in valleys),
        gap=max(float(valley.gaps.max()) for valley in valleys),
        valleys=tuple(valleys),
    )


def _leaves(center: np.ndarray, radius: float) -> Callable[[np.ndarray], bool]:
    """Whether a path that went inwards has come out of the ball again."""
    was_inside = False

    def stop(point: np.ndarray) -> bool:
        nonlocal was_inside
        distance = float(np.linalg.norm(point - center))
        was_inside = was_inside or distance < 0.9 * radius
        return distance > (radius if was_inside else 2 * radius)

    return stop


def _distance(a: Valley, b: Valley) -> float:
    """The least distance between two valleys."""
    from scipy.spatial import cKDTree

    distances, _ = cKDTree(a.dense()).query(b.dense())
    return float(np.min(distances))
