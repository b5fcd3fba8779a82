"""The closure of a mechanism as a problem for `bifurc`: its equations with bounds on how
they bend, with seeds, and with what judges the motions that are traced."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Protocol, TypeAlias

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_start_solved
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.seeding import random_seeds, start_region
from bifurc.seeds import Audit, Seeds
from bifurc.system import Curvature
from linkages.closure import cut_at_limits
from linkages.closure.curvature import CurvatureBounds
from linkages.closure.mechanism_system import MechanismSystem
from linkages.closure.within_limits import brought_within_limits
from linkages.dyads import slices as dyads
from linkages.structure.structure import Structure
from linkages.turns import whole_turns
from linkages.turns.whole_turns import TurnedEnds

NEARLY_CLOSED = 0.2  # the largest residual at which bounds on F'' hold
MOST_BEYOND = 60  # solutions beyond the limits that are brought back to them


class Source(Protocol):
    """Points ``starts`` (k, n) near solutions, and how sure it is that ``branches`` are
    all motions, judged in about so many ``seconds``."""

    @property
    def starts(self) -> np.ndarray:
        """Points near solutions."""

    def __call__(self, branches: Sequence[Branch], seconds: float) -> Audit:
        """What is said of the branches."""


# The source of a problem of a structure, drawn with a generator beside so many random
# starts; None where the method says nothing of such a mechanism.
ForSubject: TypeAlias = Callable[
    [Problem, Structure, np.random.Generator, int], Source | None
]


# what gives starts and judges what is traced: the first that applies to a mechanism
SOURCES: tuple[ForSubject, ...] = (
    dyads.for_subject,
    whole_turns.for_subject,
    cut_at_limits.for_subject,
)


class MechanismClosure(MechanismSystem):
    """The closure equations of a mechanism, with all that a search asks of them."""

    @cached_property
    def curvature(self) -> Curvature:
        """Bounds on F'' from the geometry."""
        bounds = CurvatureBounds(self.structure, NEARLY_CLOSED)
        return Curvature(bounds.near_solutions, bounds.at_complex_points, NEARLY_CLOSED)

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """The closed configuration nearest to the reference, what the starts of a
        source lead to and what ``count`` random starts do or, where these lead beyond
        given limits, others within, and those that the mechanism knows itself."""
        drawn = self._drawn(rng, count, deadline)
        lattice = self.lattice
        judge = self._judge(rng, count)
        starts = self.reference[None]
        if judge is not None:
            starts = np.concatenate([starts, judge.starts])
        points, gaps = self.project(starts)
        solutions = points[is_start_solved(gaps)]
        brought = self._from_beyond_limits(solutions, drawn, rng)
        solutions = np.concatenate([solutions, brought])
        if lattice:
            # what is outside the limits may have a translate inside
            solutions = lattice.homes(solutions)
        seeds = drawn.with_constructed(solutions[self.domain.are_inside(solutions)])
        if judge is None:
            seeds = replace(seeds, more=self._drawn)
        seeds = replace(seeds, audit=judge)
        if lattice:
            ends = TurnedEnds(self, lattice, judge)
            seeds = replace(seeds, home=lattice.home, audit=ends)
        return seeds.with_constructed(self._assemblies())

    def _judge(self, rng: np.random.Generator, count: int) -> Source | None:
        """The first of the sources that applies to the mechanism; None where none
        does."""
        for for_subject in SOURCES:
            source = for_subject(self, self.structure, rng, count)
            if source is not None:
                return source
        return None

    def _assemblies(self) -> np.ndarray:
        """Closed configurations (k, n) that the mechanism knows."""
        known = self.mechanism.assemblies()
        if not len(known):
            return np.empty((0, self.n))
        points, _ = self.project(known[:, list(self.structure.column_of)])
        return points

    def _from_beyond_limits(
        self, solutions: np.ndarray, drawn: Seeds, rng: np.random.Generator
    ) -> np.ndarray:
        """Closed configurations (k, n) within limits that are given, from those of the
        ``solutions`` (j, n) beyond them and some that random starts reached there:
        narrow limits leave few that are reached else."""
        if all(one.limits is None for one in self.structure.mechanism.variables):
            return np.empty((0, self.n))
        missed = drawn.missed[is_start_solved(drawn.gaps)]
        beyond = np.concatenate([solutions[~self.domain.are_inside(solutions)], missed])
        hold = self.scaled_tape.project
        return brought_within_limits(self, hold, beyond[:MOST_BEYOND], rng)

    def _drawn(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """What is reached from random starts before a deadline; where whole turns lead
        to the same again, half of them from a region that holds a translate of
        everything."""
        lattice = self.lattice
        if not lattice:
            return random_seeds(self, rng, count, deadline=deadline)
        region = lattice.region(start_region(self), self.reference)
        homes = lattice.homes
        anywhere = random_seeds(self, rng, count // 2, None, deadline, homes)
        rest = count - count // 2
        near = random_seeds(self, rng, rest, region, deadline, homes)
        return anywhere.and_random(near)
