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
from itertools import combinations, pairwise

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial import cKDTree

from bifurc.problem import Problem

__all__ = [
    "Unfolding",
    "Valley",
    "ValleyEnd",
    "correct_to_valley",
    "follow_valley",
    "unfold_crossing",
]

# corrections of one point; convergence is linear with a rate of about the gap over
# sigma
ROUNDS = 40
SHARE = (
    0.25  # of the way on which a singular value could fall to zero: the longest step
)
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
    LOST = "lost: the corrector does not converge; the errors are too large for a valley here"


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
        s = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(self.points, axis=0), axis=1))]
        )
        if len(s) < 2:
            return self.points
        at = np.concatenate(
            [np.linspace(a, b, FINE, endpoint=False) for a, b in pairwise(s)]
        )
        return CubicHermiteSpline(s, self.points, self.tangents)(np.append(at, s[-1]))


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


def correct_to_valley(
    problem: Problem, points: np.ndarray, rounds: int = ROUNDS
) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, n) moved onto the valley, across it, and the relative residual (k,)
    that is left at each."""
    u = np.array(points, dtype=float)
    for _ in range(rounds):
        step = _across(problem, u)[0]
        u += step
        if np.abs(step).max(initial=0.0) < 1e-14 * problem.scale:
            break
    return u, np.linalg.norm(problem.residuals(u), axis=1) / problem.magnitude


def _across(
    problem: Problem, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corrector's steps (k, n), the weak right singular vectors (k, n) and singular
    values n - 1 (k,)."""
    rank = problem.n - 1
    residual = problem.residuals(points) / problem.magnitude
    left, sigma, right = np.linalg.svd(
        problem.jacobians(points) / problem.magnitude, full_matrices=True
    )
    strong = sigma[:, :rank]
    along = np.einsum("kmi,km->ki", left[:, :, :rank], residual) / np.maximum(
        strong, 1e-12 * sigma[:, :1]
    )
    return (
        -np.einsum("kin,ki->kn", right[:, :rank], along),
        right[:, rank],
        strong[:, -1],
    )


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
    first = _settle(problem, start, direction, 1e-9 * problem.scale)
    if first is None or np.linalg.norm(first[0] - start) > FAR * problem.scale:
        return _valley(
            problem,
            [(start, direction / np.linalg.norm(direction), 0.0)],
            ValleyEnd.LOST,
        )
    rows = [first]
    h = longest * problem.scale
    for _ in range(steps):
        u, t, sigma = rows[-1]
        h = min(2.0 * h, longest * problem.scale, SHARE * sigma / _rate(problem, u, t))
        made = _settle(problem, u + h * t, t, 1e-6 * h)
        while (
            made is None
            or np.linalg.norm(made[0] - u - h * t) > 0.5 * h
            or made[1] @ t < np.cos(TURN)
        ):
            h *= 0.5
            if h < SHORTEST * problem.scale:
                return _valley(problem, rows, ValleyEnd.LOST)
            made = _settle(problem, u + h * t, t, 1e-6 * h)
        rows.append(made)
        if stop(made[0]):
            return _valley(problem, rows, ValleyEnd.DONE)
    return _valley(problem, rows, ValleyEnd.STEP_LIMIT)


def _valley(
    problem: Problem, rows: list[tuple[np.ndarray, np.ndarray, float]], end: ValleyEnd
) -> Valley:
    points, tangents, weakest = (np.array(column) for column in zip(*rows, strict=True))
    gaps = np.linalg.norm(problem.residuals(points), axis=1) / problem.magnitude
    return Valley(points, tangents, gaps, weakest, end)


def _settle(
    problem: Problem, point: np.ndarray, heading: np.ndarray, enough: float
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """The point of the valley across the weak direction from ``point``, its tangent,
    and singular value n - 1.

    Corrections end below ``enough``, or where they shrink no more: at rounding over the
    singular value. None where they do not become small: where the residual times F'' is
    no longer small beside sigma^2, the valley has no floor.
    """
    u, last = point[None].copy(), np.inf
    for _ in range(ROUNDS):
        step, weak, sigma = _across(problem, u)
        size = float(np.linalg.norm(step))
        if size < enough or (size < 1e3 * enough and size > 0.3 * last):
            return (
                u[0] + step[0],
                weak[0] if weak[0] @ heading >= 0 else -weak[0],
                float(sigma[0]),
            )
        u += (
            step if size < 0.9 * last else 0.5 * step
        )  # corrections that overshoot in turn are halved
        last = size
    return None


def _rate(problem: Problem, point: np.ndarray, tangent: np.ndarray) -> float:
    """How fast the block of F' that nearly vanishes, over the problem's magnitude,
    changes along ``tangent``."""
    rank = problem.n - 2
    left, _, right = np.linalg.svd(problem.jacobians(point[None])[0])
    change = problem.hessian(point) @ tangent / problem.magnitude
    return (
        float(np.linalg.norm(left[:, rank:].T @ change @ right[rank:].T))
        + 1e-3 / problem.scale
    )


def unfold_crossing(
    problem: Problem, center: np.ndarray, starts: np.ndarray
) -> Unfolding:
    """How the nominal half-branches that reached from ``starts`` (h, n) to ``center``
    (n,) are joined now.

    From every start the valley is followed inwards, until it leaves the ball about the
    centre that the start lies on.
    """
    free, valleys, pairs = list(range(len(starts))), [], []
    offsets = starts - center
    radius = np.linalg.norm(offsets, axis=1)
    while free:
        i = free.pop(0)
        valley = follow_valley(
            problem, starts[i], -offsets[i], _leaves(center, float(radius[i]))
        )
        valleys.append(valley)
        apart = np.linalg.norm(valley.points[-1] - starts, axis=1) / radius
        j = int(np.argmin(np.where(np.arange(len(starts)) == i, np.inf, apart)))
        pairs.append((i, j))
        if j in free and valley.end is ValleyEnd.DONE:
            free.remove(j)
    distance = min(
        (_distance(a, b) for a, b in combinations(valleys, 2)), default=np.inf
    )
    return Unfolding(
        tuple(pairs),
        distance,
        min(float(v.weakest.min()) for v in valleys),
        max(float(v.gaps.max()) for v in valleys),
        tuple(valleys),
    )


def _leaves(center: np.ndarray, radius: float) -> Callable[[np.ndarray], bool]:
    """Whether a path that went inwards has come out of the ball again."""
    inside = False

    def stop(u: np.ndarray) -> bool:
        nonlocal inside
        distance = float(np.linalg.norm(u - center))
        inside = inside or distance < 0.9 * radius
        return distance > (radius if inside else 2 * radius)

    return stop


def _distance(a: Valley, b: Valley) -> float:
    return float(np.min(cKDTree(a.dense()).query(b.dense())[0]))
