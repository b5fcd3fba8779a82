"""The sheet of a surface above a tangent plane: followed from the centre outwards, and
never by distance.

Along a straight ray in the plane the sheet is a curve. An arc of it is one curve where
the cubic through both ends, with the tangents there, is corrected onto it in places
between: Newton's method contracts at once, far from what other sheets there are, and
what the corrections leave is the smooth bump of the next order. An arc that goes over to
another sheet, however near, has a step in it, which no cubic comes near to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.numerics.corrector import SETTLED, normal_corrections
from bifurc.problem import Problem
from bifurc.system import relative_jacobians

# Places on an arc at which the cubic is corrected, and how far a quartic with the same
# ends and tangents is from it there, over what it is in the middle.
INNER = np.array([0.25, 0.5, 0.75])
BUMP = (4.0 * INNER * (1.0 - INNER)) ** 2
# Second step of Newton's method over the first, at most.
CONTRACTION = 0.125
# What the corrections may differ from the bump of a quartic, and a cubic more, over
# their size.
SMOOTH = 0.1
# Relative residual above which a point is no solution.
SOLVED = 1e-9
# Smallest cosine between a ray and the sheet above it.
STEEP = 0.3
# Shortest step along a ray, over its length, and how many are tried.
SHORTEST, STEPS = 5e-4, 60
NOWHERE = np.empty(0)


class Nodes(NamedTuple):
    """Places on rays: shares ``t`` (k,) of the rays' lengths, solutions ``points`` (k,
    n), and the ``slopes`` (k, n) of the sheet along the rays."""

    t: np.ndarray
    points: np.ndarray
    slopes: np.ndarray

    def part(self, rows: np.ndarray) -> Nodes:
        """Those of the rays ``rows``."""
        return Nodes(self.t[rows], self.points[rows], self.slopes[rows])

    def put(self, rows: np.ndarray, others: Nodes) -> None:
        """Put ``others`` in the place of those of the rays ``rows``."""
        for mine, theirs in zip(self, others, strict=True):
            mine[rows] = theirs


def on_cubic(begin: Nodes, end: Nodes, t: np.ndarray) -> np.ndarray:
    """Points (k, n) at ``t`` (k,) of the cubics through nodes with their slopes."""
    width = end.t - begin.t
    s = ((t - begin.t) / width)[:, None]
    rise = end.points - begin.points
    at_begin = width[:, None] * begin.slopes - rise
    at_end = rise - width[:, None] * end.slopes
    points: np.ndarray = begin.points + s * (
        rise + (1.0 - s) * ((1.0 - s) * at_begin + s * at_end)
    )
    return points


def slopes_at(
    problem: Problem, points: np.ndarray, planes: np.ndarray, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (k, n) of sheets at solutions (k, n) along rays in ``planes`` (k, n, 2) to
    ``positions`` (k, 2), and whether they are not too steep (k,)."""
    jacobians = relative_jacobians(problem, points)
    matrices = np.concatenate([jacobians, np.swapaxes(planes, 1, 2)], axis=1)
    inverses = np.linalg.pinv(matrices)
    slopes = np.einsum("kij,kj->ki", inverses[:, :, -2:], positions)
    lengths = np.linalg.norm(positions, axis=1)
    are_flat = lengths >= STEEP * np.linalg.norm(slopes, axis=1)
    return slopes, are_flat


def are_arcs(
    problem: Problem, planes: np.ndarray, begin: Nodes, end: Nodes
) -> np.ndarray:
    """Whether the sheet above planes (k, n, 2) runs from one node to the other (k,)."""
    count = len(INNER)
    shares = begin.t + INNER[:, None] * (end.t - begin.t)
    cubics = np.concatenate([on_cubic(begin, end, t) for t in shares])
    corrected = normal_corrections(problem, cubics, np.tile(planes, (count, 1, 1)))
    is_solved = corrected.are_settled(problem) & (corrected.gaps < SOLVED)
    is_alone = corrected.contractions < CONTRACTION
    offsets = (corrected.points - cubics).reshape(count, *begin.points.shape)
    bumps = offsets / BUMP[:, None, None]
    uneven = np.linalg.norm(0.5 * (bumps[0] + bumps[2]) - bumps[1], axis=1)
    largest = np.linalg.norm(bumps, axis=2).max(axis=0)
    is_smooth = uneven <= SMOOTH * largest + SETTLED * problem.domain.scale
    holds = np.all((is_solved & is_alone).reshape(count, -1), axis=0)
    return np.asarray(holds & is_smooth)


def follow_sheets(
    problem: Problem, centers: np.ndarray, planes: np.ndarray, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, n) above ``positions`` (k, 2) in tangent ``planes`` (k, n, 2) on the
    sheets through the solutions ``centers`` (k, n), and whether they are reached (k,).

    Each ray is followed in steps as long as they may be, at first all the way; what is
    not reached stays at the last place that was.
    """
    rays = _Rays(problem, centers, planes, positions)
    rays.run()
    return rays.at.points, rays.at.t >= 1.0


def follow_along(
    problem: Problem,
    centers: np.ndarray,
    planes: np.ndarray,
    positions: np.ndarray,
    shares: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions (k, s, n) on the way to ``positions`` (k, 2), at ``shares`` (s,) of
    it, as by `follow_sheets`, and whether they are on the sheet (k, s): where the way is
    lost, and right beside another sheet, they may be on that."""
    rays = _Rays(problem, centers, planes, positions, shares)
    rays.run()
    starts = rays.passed.reshape(-1, problem.n)
    corrected = normal_corrections(problem, starts, np.repeat(planes, len(shares), 0))
    is_there = corrected.are_settled(problem) & (corrected.gaps < SOLVED)
    is_there &= corrected.contractions < CONTRACTION
    is_there = is_there.reshape(rays.passed.shape[:2])
    is_there &= rays.at.t[:, None] >= shares
    return corrected.points.reshape(rays.passed.shape), is_there


class _Rays:
    """Rays on the way: ``at`` the last nodes reached, the ``before`` them, the
    ``steps`` (k,) that are tried next, as shares of the rays, and where they ``passed``
    (k, s, n) at ``shares`` (s,) of their lengths, by the cubics."""

    def __init__(
        self,
        problem: Problem,
        centers: np.ndarray,
        planes: np.ndarray,
        positions: np.ndarray,
        shares: np.ndarray = NOWHERE,
    ):
        self.problem = problem
        self.centers = centers
        self.planes = planes
        self.positions = positions
        self.straight = np.einsum("kij,kj->ki", planes, positions)
        count, slopes = len(centers), self.straight
        self.at = Nodes(np.zeros(count), centers.copy(), slopes.copy())
        self.before = Nodes(np.full(count, -1.0), centers - slopes, slopes.copy())
        self.steps = np.ones(count)
        self.shares = shares
        self.passed = centers[:, None] + shares[:, None] * slopes[:, None]

    def run(self) -> None:
        """Follow all rays as far as they go."""
        for _ in range(STEPS):
            some = np.flatnonzero((self.at.t < 1.0) & (self.steps >= SHORTEST))
            if not len(some):
                break
            self.step(some)

    def step(self, rays: np.ndarray) -> None:
        """One step of the rays of these numbers, or a shorter one to try where that
        fails."""
        begin, planes = self.at.part(rays), self.planes[rays]
        t = np.minimum(begin.t + self.steps[rays], 1.0)
        corrected = normal_corrections(self.problem, self._ahead(rays, t), planes)
        slopes, is_taken = slopes_at(
            self.problem, corrected.points, planes, self.positions[rays]
        )
        is_taken &= corrected.are_settled(self.problem) & (corrected.gaps < SOLVED)
        end = Nodes(t, corrected.points, slopes)
        some = np.flatnonzero(is_taken)
        is_taken[some] = are_arcs(
            self.problem, planes[some], begin.part(some), end.part(some)
        )
        self._reach(rays[is_taken], begin.part(is_taken), end.part(is_taken))
        # a cubic is off by the fourth power of the step
        room = CONTRACTION / 2 / np.maximum(corrected.contractions, 1e-300)
        growth = np.clip(np.sqrt(np.sqrt(room)), 0.5, 2.0)
        self.steps[rays] *= np.where(is_taken, growth, 0.5)

    def _reach(self, rays: np.ndarray, begin: Nodes, end: Nodes) -> None:
        """Note that rays went from one node to the next, and where they passed."""
        self.before.put(rays, begin)
        self.at.put(rays, end)
        is_between = (begin.t[:, None] < self.shares) & (self.shares <= end.t[:, None])
        ray, share = np.nonzero(is_between)
        points = on_cubic(begin.part(ray), end.part(ray), self.shares[share])
        self.passed[rays[ray], share] = points

    def _ahead(self, rays: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Where the cubics through the last two nodes lead (k, n)."""
        ahead = on_cubic(self.before.part(rays), self.at.part(rays), t)
        # rounding grows as cubics are prolonged: the place in the plane is known
        on_ray = self.centers[rays] + t[:, None] * self.straight[rays]
        planes = self.planes[rays]
        aside = np.einsum("kij,ki->kj", planes, on_ray - ahead)
        ahead += np.einsum("kij,kj->ki", planes, aside)
        return ahead
