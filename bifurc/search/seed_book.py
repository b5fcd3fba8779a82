"""The books of the seeds: what each of them turned out to lie on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from bifurc.decisions import is_same_point, may_be_weak
from bifurc.limits import whole
from bifurc.numerics.blur import same_reach
from bifurc.numerics.singular_values import singular_values
from bifurc.problem import Problem
from bifurc.seeds import Seeds


class Fate(StrEnum):
    """Where a seed lies."""

    # It lies on a traced branch.
    ON_FORM = "on a form"
    # It is a singular point, or as near to one as its digits tell.
    AT_SINGULAR_POINT = "at a singular point"
    # It is a solution without motion.
    RIGID = "rigid assembly"
    # It lies on a curve along which the system is nearly solved.
    ON_NEAR_MOTION = "on a near motion"
    # The solutions about it are of dimension 2 or more.
    ON_COMPONENT = "on a component of higher dimension"
    # It only nearly solves the equations.
    NO_SOLUTION = "no solution"


class SeedFate(NamedTuple):
    """What one seed lies on, and which one of these.

    ``number`` is that of a branch, a near motion, a singular point or a rigid assembly
    among the findings. Of a component it is the dimension.
    """

    fate: Fate
    number: int = 0


class SeedBook:
    """The ``seeds`` of a search, and what is known of each.

    ``values`` (k, n) are the singular values at the seeds, ``reach`` (k,) is how far
    from their curves they may have been found, ``fates`` what is known of each by its
    number.
    """

    def __init__(self, problem: Problem):
        nowhere = np.empty((0, problem.n))
        self.problem = problem
        self.seeds = Seeds(nowhere, np.empty(0, dtype=bool), np.empty(0), nowhere)
        self.values = nowhere
        self.reach = np.empty(0)
        self.fates: dict[int, SeedFate] = {}

    @property
    def open_seeds(self) -> list[int]:
        """Numbers of the seeds of which nothing is known yet, first those whose curve
        is far from singular."""
        if len(self.fates) == len(self.seeds.points):
            return []
        numbers = [k for k in range(len(self.seeds.points)) if k not in self.fates]
        values = self.values[numbers, max(self.problem.n - 2, 0)]
        return [numbers[k] for k in np.argsort(-values, kind="stable")]

    @whole
    def add(self, seeds: Seeds, values: np.ndarray) -> None:
        """Replace the seeds by ``seeds``, which begin with those known so far;
        ``values`` (k, n) are the singular values at the new ones."""
        new = seeds.points[len(self.seeds.points) :]
        self.seeds = seeds
        self.values = np.concatenate([self.values, values])
        reach = reach_of_places(self.problem, new, values)
        self.reach = np.concatenate([self.reach, reach])

    @whole
    def settle(self, numbers: Iterable[int], fate: SeedFate) -> None:
        """Record one fate of some seeds."""
        self.fates.update(dict.fromkeys(numbers, fate))

    @whole
    def reopen(self, numbers: Iterable[int]) -> None:
        """Forget what is known of some seeds."""
        for number in numbers:
            del self.fates[number]

    @whole
    def move(self, fate: SeedFate, other: SeedFate | None) -> None:
        """Give the seeds of one fate another one; None: nothing is known of them."""
        numbers = [number for number, known in self.fates.items() if known == fate]
        if other is None:
            self.reopen(numbers)
        else:
            self.settle(numbers, other)

    def random_hits(self) -> Counter[SeedFate]:
        """How many random starts came to each fate."""
        is_random = self.seeds.random.tolist()
        return Counter(fate for k, fate in self.fates.items() if is_random[k])


def reach_of_places(
    problem: Problem, points: np.ndarray, values: np.ndarray | None = None
) -> np.ndarray:
    """How far (k,) from a curve points (k, n) of it may be found; ``values`` (k, n) are
    the singular values there, where they are known."""
    if values is None:
        values = singular_values(problem, points)
    reach = np.full(len(points), is_same_point.threshold * problem.domain.scale)
    weak = may_be_weak(values[:, max(problem.n - 2, 0)])
    if weak.any():
        own = same_reach(problem, points[weak], values[weak]) * problem.domain.scale
        reach[weak] = np.maximum(reach[weak], own)
    return reach
