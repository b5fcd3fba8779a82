"""Systems that contradict themselves a little: onto the valley along which they are
nearly solved, and what becomes of a crossing there.

A linkage made with errors has no curve of solutions, since its redundant equations no
longer agree. What is left of the curve is a valley of |F|. With F' = U diag(sigma) V^T
and v_n the weak right singular vector, a point lies on the valley where u_i . F = 0 for
i = 1 .. n - 1: to first order |F| is then the least that any move across v_n can reach.
The corrector takes

    d = - sum_{i < n} v_i (u_i . F) / sigma_i,

Gauss-Newton steps of rank n - 1, which never divide by the singular value that the
errors made of zero. `bifurc.curves.valley_problem` makes a system of these equations,
along whose curve a valley is traced.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.continuation import follow_curve
from bifurc.curves.track import Place, Track
from bifurc.curves.valley_problem import ValleyProblem
from bifurc.numerics.null_spaces import correct_to_valley, null_vector
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.settings import TraceSettings
from bifurc.system import relative_gaps

# distance from a start, in scales, beyond which another valley is reached and not its
# own
FAR = 0.25
LOOKS = np.linspace(0.0, 1.0, 65)  # of a piece, where valleys are compared
TRACING = TraceSettings(tolerance=1e-10, max_length=20.0)


@dataclass(frozen=True)
class Unfolding:
    """What a crossing of nominal branches has become.

    ``valleys``: the valleys from the starts inwards, each as far as it leaves the ball
    about the crossing again, or is lost before; ``pairs``: from which start to which, by
    their indices, ``distance``: the least between two valleys (infinite where there is
    one alone), ``weakest``: the smallest singular value n - 1 along them, over the
    problem's magnitude, ``gap``: the largest relative residual along them.
    """

    valleys: tuple[Branch, ...]
    pairs: tuple[tuple[int, int], ...]
    distance: float
    weakest: float
    gap: float


def unfold_crossing(
    problem: Problem, center: np.ndarray, starts: np.ndarray
) -> Unfolding:
    """How the nominal half-branches that reached from ``starts`` (h, n) to ``center``
    (n,) are joined now.

    From every start the valley is followed inwards, until it leaves the ball about the
    centre that the start lies on.
    """
    radii = np.linalg.norm(starts - center, axis=1)
    free = list(range(len(starts)))
    valleys: list[Branch] = []
    looks: list[np.ndarray] = []
    pairs: list[tuple[int, int]] = []
    while free:
        i = free.pop(0)
        valley = _valley_inwards(problem, center, starts[i])
        is_near = len(valley.pieces) > 0
        points = valley(valley.places(LOOKS).ravel()) if is_near else starts[[i]]
        distances = np.linalg.norm(points[-1] - starts, axis=1) / radii
        distances[i] = np.inf
        j = int(np.argmin(distances))
        valleys.append(valley)
        looks.append(points)
        pairs.append((i, j))
        if j in free and valley.outcome is Outcome.LEFT_REGION:
            free.remove(j)
    between = [
        _distance(valleys[i], looks[j]) for i, j in combinations(range(len(looks)), 2)
    ]
    every = np.concatenate(looks)
    return Unfolding(
        valleys=tuple(valleys),
        pairs=tuple(pairs),
        distance=min(between, default=np.inf),
        weakest=float(singular_values(problem, every)[:, problem.n - 2].min()),
        gap=float(relative_gaps(problem, every).max()),
    )


def _distance(valley: Branch, points: np.ndarray) -> float:
    """The least distance of points (k, n) to a valley."""
    distances, _ = valley.nearest(points)
    return float(distances.min())


def _valley_inwards(problem: Problem, center: np.ndarray, start: np.ndarray) -> Branch:
    """The valley from near ``start`` (n,) into the ball about ``center`` (n,) that it
    lies on, and out of it; of no pieces where no valley is near."""
    (corrected,), _ = correct_to_valley(problem, start[None])
    radius = float(np.linalg.norm([start - center, corrected - center], axis=1).max())
    valley = _ValleyInBall(problem, center, radius)
    place = Place(corrected, null_vector(valley, corrected, center - start))
    if not np.linalg.norm(corrected - start) <= FAR * problem.domain.scale:
        track = Track(place, TRACING.order)
        return track.empty_branch(Outcome.OPEN, problem.domain.periods)
    return follow_curve(valley, place, TRACING)


class _ValleyInBall(ValleyProblem):
    """The valley of a problem within a ``radius`` of a ``center`` (n,), whatever it
    misses there."""

    def __init__(self, of: Problem, center: np.ndarray, radius: float):
        super().__init__(of)
        endless = np.tile([-np.inf, np.inf], (of.n, 1))
        self.domain = replace(self.domain, bounds=endless, rim=self._outside)
        self._center = center
        self._radius = radius

    def _outside(self, points: np.ndarray) -> np.ndarray:
        """How far points (k, n) lie outside the ball (k,)."""
        distances: np.ndarray = np.linalg.norm(points - self._center, axis=1)
        return distances - self._radius

    def missed(self, points: np.ndarray) -> np.ndarray:
        """What points (k, n) miss where the valley is not single: it is followed there
        all the same."""
        return np.zeros(len(points))
