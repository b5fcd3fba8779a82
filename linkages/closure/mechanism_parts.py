"""The parts of the closure of a mechanism: the tape of its equations, bounds from how far
its bodies reach, sources of starts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Protocol, TypeAlias

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_start_solved
from bifurc.domain import Domain
from bifurc.equations.system import ScaledTape
from bifurc.function_problem import EXACT_HESSIAN
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.seeding import random_seeds, start_region
from bifurc.seeds import Audit, Seeds
from bifurc.system import Accuracy, Curvature
from linkages.closure import cut_at_limits
from linkages.closure.curvature import CurvatureBounds
from linkages.closure.equations import write_equations
from linkages.closure.errors import JointErrors
from linkages.closure.parts import NEARLY_CLOSED, ClosureParts
from linkages.closure.within_limits import brought_within_limits
from linkages.dyads import slices as dyads
from linkages.structure.structure import Structure
from linkages.turns import whole_turns
from linkages.turns.turn_lattice import TurnLattice, turn_lattice
from linkages.turns.whole_turns import TurnedEnds

# unknowns up to which compiled methods with dense matrices take no longer than those in
# Python: for sections with spheres, and for curves of equations that are not sparse
LARGEST_COMPILED = 250
MOST_BEYOND = 60  # solutions beyond the limits that are brought back to them
STRIDE_OF = 12  # joints, the most of a loop: up to there a stride is the scale


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


def parts_of_structure(
    structure: Structure, errors: JointErrors | None = None
) -> ClosureParts:
    """The closure equations of the mechanism of a ``structure`` in the variables of its
    joints, with ``errors`` as it is made.

    Angles are in radians, slides in characteristic lengths. All derivatives are exact.
    """
    unknowns = structure.unknowns
    # in a step of the same angles more joints make it longer, by the root of their number
    stride = math.sqrt(max(1.0, len(unknowns) / STRIDE_OF))
    domain = Domain(
        names=tuple(unknown.label for unknown in unknowns),
        units=tuple(unknown.unit for unknown in unknowns),
        periods=np.array([unknown.period for unknown in unknowns]),
        bounds=np.array([[one.low, one.high] for one in unknowns]),
        stride=stride,
    )
    equations = write_equations(structure, errors)
    tape = equations.tape
    accuracy = Accuracy(
        derivatives="recorded",
        equations=f"recorded ({tape.size} operations)",
        data_rounding=structure.mechanism.coordinate_rounding / structure.unit,
        hessian_error=EXACT_HESSIAN,
    )
    compiled = ScaledTape(
        tape,
        Problem.magnitude,
        domain,
        largest_dense=LARGEST_COMPILED,
        largest_sparse=math.inf,
        is_bordered=True,
    )
    ends = np.cumsum([0, *equations.counts]).tolist()
    return ClosureParts(
        domain=domain,
        accuracy=accuracy,
        compiled=compiled,
        bounds=partial(bounds_of_structure, structure),
        starts=MechanismStarts(structure, compiled),
        structure=structure,
        rows=tuple(slice(first, last) for first, last in pairwise(ends)),
    )


def bounds_of_structure(structure: Structure) -> Curvature:
    """Bounds on F'' from the geometry."""
    bounds = CurvatureBounds(structure, NEARLY_CLOSED)
    return Curvature(bounds.near_solutions, bounds.at_complex_points, NEARLY_CLOSED)


@dataclass(frozen=True, eq=False)
class MechanismStarts:
    """Where a search of the mechanism of a ``structure`` begins, whose equations are
    ``compiled``."""

    structure: Structure
    compiled: ScaledTape

    def __call__(
        self,
        problem: Problem,
        rng: np.random.Generator,
        count: int,
        deadline: Deadline | None,
    ) -> Seeds:
        """The closed configuration nearest to the reference, what the starts of a
        source lead to and what ``count`` random starts do or, where these lead beyond
        given limits, others within, and those that the mechanism knows itself."""
        drawn = self._drawn(problem, rng, count, deadline)
        lattice = self.lattice
        judge = self._judge(problem, rng, count)
        starts = self.structure.reference[None]
        if judge is not None:
            starts = np.concatenate([starts, judge.starts])
        points, gaps = problem.project(starts)
        solutions = points[is_start_solved(gaps)]
        brought = self._from_beyond_limits(problem, solutions, drawn, rng)
        solutions = np.concatenate([solutions, brought])
        if lattice:
            # what is outside the limits may have a translate inside
            solutions = lattice.homes(solutions)
        is_inside = problem.domain.are_inside(solutions)
        seeds = drawn.with_constructed(solutions[is_inside])
        if judge is None:
            seeds = replace(seeds, more=partial(self._drawn, problem))
        seeds = replace(seeds, audit=judge)
        if lattice:
            ends = TurnedEnds(problem, lattice, judge)
            seeds = replace(seeds, home=lattice.home, audit=ends)
        return seeds.with_constructed(self._assemblies(problem))

    def _judge(
        self, problem: Problem, rng: np.random.Generator, count: int
    ) -> Source | None:
        """The first of the sources that applies to the mechanism; None where none
        does."""
        for for_subject in SOURCES:
            source = for_subject(problem, self.structure, rng, count)
            if source is not None:
                return source
        return None

    def _assemblies(self, problem: Problem) -> np.ndarray:
        """Closed configurations (k, n) that the mechanism knows."""
        known = self.structure.mechanism.assemblies()
        if not len(known):
            return np.empty((0, problem.n))
        points, _ = problem.project(known[:, list(self.structure.column_of)])
        return points

    def _from_beyond_limits(
        self,
        problem: Problem,
        solutions: np.ndarray,
        drawn: Seeds,
        rng: np.random.Generator,
    ) -> np.ndarray:
        """Closed configurations (k, n) within limits that are given, from those of the
        ``solutions`` (j, n) beyond them and some that random starts reached there:
        narrow limits leave few that are reached else."""
        if all(one.limits is None for one in self.structure.mechanism.variables):
            return np.empty((0, problem.n))
        missed = drawn.missed[is_start_solved(drawn.gaps)]
        is_beyond = ~problem.domain.are_inside(solutions)
        beyond = np.concatenate([solutions[is_beyond], missed])[:MOST_BEYOND]
        return brought_within_limits(problem, self.compiled.project, beyond, rng)

    def _drawn(
        self,
        problem: Problem,
        rng: np.random.Generator,
        count: int,
        deadline: Deadline | None,
    ) -> Seeds:
        """What is reached from random starts before a deadline; where whole turns lead
        to the same again, half of them from a region that holds a translate of
        everything."""
        lattice = self.lattice
        if not lattice:
            return random_seeds(problem, rng, count, deadline=deadline)
        region = lattice.region(start_region(problem), self.structure.reference)
        homes = lattice.homes
        anywhere = random_seeds(problem, rng, count // 2, None, deadline, homes)
        rest = count - count // 2
        near = random_seeds(problem, rng, rest, region, deadline, homes)
        return anywhere.and_random(near)

    @cached_property
    def lattice(self) -> TurnLattice:
        """The whole turns after which every closed configuration is closed again."""
        return turn_lattice(self.structure)
