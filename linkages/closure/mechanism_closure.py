"""The closure of a mechanism as a problem for `bifurc`."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from bifurc.checks import check_type, rows_of
from bifurc.decisions import is_start_solved
from bifurc.domain import Domain
from bifurc.equations.system import ScaledTape
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.limits import Deadline
from bifurc.problem import Accuracy, Curvature, Shortcuts
from bifurc.seeding import random_seeds, start_region
from bifurc.seeds import Seeds
from linkages.closure import cut_at_limits
from linkages.closure.curvature import CurvatureBounds
from linkages.closure.equations import Equations, write_equations
from linkages.closure.errors import JointErrors
from linkages.closure.within_limits import brought_within_limits
from linkages.dyads import slices as dyads
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.source import ForSubject, Source
from linkages.structure.structure import Structure
from linkages.turns import whole_turns
from linkages.turns.turn_lattice import TurnLattice, turn_lattice
from linkages.turns.whole_turns import TurnedEnds

# unknowns up to which compiled methods with dense matrices take no longer than those in
# Python: for sections with spheres, and for curves of equations that are not sparse
LARGEST_COMPILED = 250
NEARLY_CLOSED = 0.2  # the largest residual at which bounds on F'' hold
MOST_BEYOND = 60  # solutions beyond the limits that are brought back to them
STRIDE_OF = 12  # joints, the most of a loop: up to there a stride is the scale
# what gives starts and judges what is traced: the first that applies to a mechanism
SOURCES: tuple[ForSubject, ...] = (
    dyads.for_subject,
    whole_turns.for_subject,
    cut_at_limits.for_subject,
)


class MechanismClosure(NumericalProblem):
    """The closure equations of a mechanism in the variables of its joints.

    Angles are in radians, slides in characteristic lengths. All derivatives are exact:
    they come from the tape of the equations. With ``errors`` it is the mechanism as it
    is made, in the same unknowns, and need not close anywhere. ``structure`` is that of
    the mechanism, where it is there already.
    """

    scaled_tape: ScaledTape

    def __init__(
        self,
        mechanism: Mechanism,
        errors: JointErrors | None = None,
        structure: Structure | None = None,
    ):
        check_type("mechanism", mechanism, Mechanism)
        self.mechanism = mechanism
        self.structure = structure or Structure(mechanism)
        unknowns = self.structure.unknowns
        # in a step of the same angles more joints make it longer, by the root of their number
        stride = math.sqrt(max(1.0, len(unknowns) / STRIDE_OF))
        self.domain = Domain(
            names=tuple(unknown.label for unknown in unknowns),
            units=tuple(unknown.unit for unknown in unknowns),
            periods=np.array([unknown.period for unknown in unknowns]),
            bounds=np.array([[one.low, one.high] for one in unknowns]),
            stride=stride,
        )
        self._equations: Equations = write_equations(self.structure, errors)
        tape = self._equations.tape
        self.accuracy = Accuracy(
            derivatives="recorded",
            equations=f"recorded ({tape.size} operations)",
            data_rounding=mechanism.coordinate_rounding / self.structure.unit,
            hessian_error=EXACT_HESSIAN,
        )
        self.scaled_tape = ScaledTape(
            tape,
            self.magnitude,
            self.domain,
            largest_dense=LARGEST_COMPILED,
            largest_sparse=math.inf,
        )

    # --- values and derivatives -------------------------------------------------------

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self.scaled_tape.residuals(rows_of("points", points, self.n))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self.scaled_tape.jacobians(rows_of("points", points, self.n))

    def hessians(self, points: np.ndarray) -> np.ndarray:
        """F'' (k, m, n, n) at points (k, n)."""
        return self.scaled_tape.hessians(rows_of("points", points, self.n))

    @property
    def shortcuts(self) -> Shortcuts:
        """What the tape does in one call, and the solver of systems with F' where that is
        factored as a sparse matrix."""
        if not self.scaled_tape.is_factored_sparse:
            return super().shortcuts
        return super().shortcuts._replace(
            m=self.scaled_tape.tape.m, bordered_solver=self.scaled_tape.bordered_solver
        )

    @cached_property
    def rows_of_closures(self) -> list[slice]:
        """The equations that belong to each closure of the structure."""
        ends = np.cumsum([0, *self._equations.counts])
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    def columns_of_joint(self, name: str) -> list[int]:
        """The numbers of the unknowns that move a joint."""
        structure = self.structure
        columns: list[int] = []
        for number, pair in enumerate(self.mechanism.pairs):
            if pair.joint != name:
                continue
            free = [k for k in pair.variables if k in structure.column_of]
            columns += [structure.column_of[k] for k in free]
            columns += structure.embedded.get(number, ())
        return sorted(set(columns))

    @cached_property
    def curvature(self) -> Curvature:
        """Bounds on F'' from the geometry."""
        bounds = CurvatureBounds(self.structure, NEARLY_CLOSED)
        return Curvature(bounds.near_solutions, bounds.at_complex_points, NEARLY_CLOSED)

    # --- starts -----------------------------------------------------------------------

    @property
    def reference(self) -> np.ndarray:
        """The reference configuration (n,): all variables 0. Where joints are locked
        elsewhere it need not be closed."""
        return self.structure.reference

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

    @cached_property
    def lattice(self) -> TurnLattice:
        """The whole turns after which every closed configuration is closed again."""
        return turn_lattice(self.structure)
