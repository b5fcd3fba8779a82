"""Which solutions of one dimension are joined: they walk over the component to one
another.

That a walk arrives shows that two solutions are on one component; that none does is no
proof that they are not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_same_point, may_be_null
from bifurc.limits import Deadline
from bifurc.numerics.connected_parts import connected_parts
from bifurc.numerics.null_spaces import null_spaces
from bifurc.problem import Problem
from bifurc.surfaces.walk import LONGER, SHORTER, stepped

ROUNDS, STEPS = 8, 60
# Of how many the parts are looked at first, for how many rounds, and with how many parts
# it ends there.
FIRST, FIRST_ROUNDS, MOST_FIRST = 32, 2, 16
MOST_MISSES = 2  # rounds in which no walk arrives, after which there are no others
WALKERS = 4  # that each part sends out in a round
LONGEST, SHORTEST = 0.35, 1e-3  # steps, over the scale
ABOVE = 1e-3  # of the longest step: so near in its plane, a walker elsewhere has missed


def joined_parts(
    problem: Problem, points: np.ndarray, dimension: int, deadline: Deadline
) -> np.ndarray:
    """Number (k,) of the part that each solution (k, n) on components of a ``dimension``
    is joined to, counted from 0; -1 of singular ones, which do not walk, and of all where
    the first ones are in many parts: then walks would join little more."""
    labels = np.full(len(points), -1)
    sigma, right = null_spaces(problem, points)
    plain = np.flatnonzero(np.count_nonzero(may_be_null(sigma), axis=1) == dimension)
    bases = right[plain, problem.n - dimension :]
    few = _Walk(problem, points[plain[:FIRST]], bases[:FIRST])
    if few.parts(FIRST_ROUNDS, deadline).max(initial=0) < MOST_FIRST:
        walk = _Walk(problem, points[plain], bases)
        labels[plain] = walk.parts(ROUNDS, deadline)
    return labels


def _drawn_from_each(parts: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Numbers of some solutions of each of the ``parts`` (k,) but the largest."""
    largest = int(np.argmax(np.bincount(parts)))
    chosen = []
    for part in np.unique(parts):
        members = np.flatnonzero(parts == part)
        if part != largest:
            chosen.append(rng.permutation(members)[:WALKERS])
    return np.concatenate(chosen)


class _Walk:
    """Walks between solutions ``points`` (k, n) with bases (k, d, n) of their tangent
    spaces."""

    def __init__(self, problem: Problem, points: np.ndarray, bases: np.ndarray):
        self.problem = problem
        self.points = points
        self.planes = np.swapaxes(bases, 1, 2)
        self.longest = LONGEST * problem.domain.scale

    def parts(self, rounds: int, deadline: Deadline) -> np.ndarray:
        """Number (k,) of the part that each solution is joined to after so many
        rounds."""
        rng = np.random.default_rng(0)
        count, misses = len(self.points), 0
        ways: list[tuple[int, int]] = []
        parts = np.arange(count)
        for attempt in range(rounds):
            is_one = parts.max(initial=0) == 0
            if deadline.passed or is_one or misses == MOST_MISSES:
                break
            walkers = _drawn_from_each(parts, rng)
            goals = np.array([self.goal(k, parts, rng, attempt) for k in walkers])
            have_arrived = self.run(walkers, goals, deadline)
            arrivals = zip(walkers[have_arrived], goals[have_arrived], strict=True)
            ways += [(int(walker), int(goal)) for walker, goal in arrivals]
            misses = 0 if np.any(have_arrived) else misses + 1
            parts = np.array(connected_parts(count, ways))
        return parts

    def goal(
        self, walker: int, parts: np.ndarray, rng: np.random.Generator, attempt: int
    ) -> int:
        """The number of a solution in another part, the nearest one: of all others
        first, and then of a part that is drawn at random."""
        others = np.flatnonzero(parts != parts[walker])
        if attempt:
            others = np.flatnonzero(parts == rng.choice(np.unique(parts[others])))
        gaps = self.problem.domain.difference(self.points[others], self.points[walker])
        return int(others[np.argmin(np.linalg.norm(gaps, axis=1))])

    def run(
        self, walkers: np.ndarray, goals: np.ndarray, deadline: Deadline
    ) -> np.ndarray:
        """Which of the ``walkers`` (w,) arrive at their ``goals`` (w,), both numbers of
        solutions."""
        domain = self.problem.domain
        at, planes = self.points[walkers].copy(), self.planes[walkers].copy()
        moving = _Moving(at, planes, np.full(len(walkers), self.longest))
        have_arrived = np.zeros(len(walkers), dtype=bool)
        for _ in range(STEPS):
            offset = domain.difference(self.points[goals], at)
            have_arrived |= is_same_point(np.linalg.norm(offset, axis=1), domain.scale)
            along = np.einsum("kij,klj,kl->ki", planes, planes, offset)
            has_missed = np.linalg.norm(along, axis=1) < ABOVE * self.longest
            has_stopped = moving.length < SHORTEST * domain.scale
            going = np.flatnonzero(~have_arrived & ~has_missed & ~has_stopped)
            if not len(going) or deadline.passed:
                break
            moving.step(self.problem, going, along[going], self.longest)
        return have_arrived


class _Moving(NamedTuple):
    """Walkers ``at`` solutions (w, n), with bases (w, n, d) of their tangent spaces, the
    ``planes``, and the longest step ``length`` (w,) that each tries next."""

    at: np.ndarray
    planes: np.ndarray
    length: np.ndarray

    def step(
        self, problem: Problem, going: np.ndarray, along: np.ndarray, longest: float
    ) -> None:
        """One step of the walkers that are ``going``, by their numbers (g,), ``along``
        vectors (g, n) in their tangent spaces, or a shorter length where that fails."""
        distance = np.linalg.norm(along, axis=1)
        share = np.minimum(1.0, self.length[going] / distance)
        steps = along * share[:, None]
        at, planes = self.at[going], self.planes[going]
        ends, new_planes, is_taken = stepped(problem, at, planes, steps)
        taken = going[is_taken]
        self.at[taken], self.planes[taken] = ends[is_taken], new_planes[is_taken]
        longer = np.minimum(LONGER * self.length[going], longest)
        shorter = SHORTER * np.minimum(self.length[going], distance)
        self.length[going] = np.where(is_taken, longer, shorter)
