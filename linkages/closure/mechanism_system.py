"""The closure equations of a mechanism: their values and derivatives, and the closed
configurations near others."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise

import numpy as np

from bifurc.checks import check_type, rows_of
from bifurc.domain import Domain
from bifurc.equations.system import ScaledTape
from bifurc.function_problem import EXACT_HESSIAN, NumericalProblem
from bifurc.system import Accuracy, Shortcuts
from linkages.closure.equations import Equations, write_equations
from linkages.closure.errors import JointErrors
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.structure import Structure
from linkages.turns.turn_lattice import TurnLattice, turn_lattice

# unknowns up to which compiled methods with dense matrices take no longer than those in
# Python: for sections with spheres, and for curves of equations that are not sparse
LARGEST_COMPILED = 250
STRIDE_OF = 12  # joints, the most of a loop: up to there a stride is the scale


class MechanismSystem(NumericalProblem):
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
    def lattice(self) -> TurnLattice:
        """The whole turns after which every closed configuration is closed again."""
        return turn_lattice(self.structure)

    @property
    def reference(self) -> np.ndarray:
        """The reference configuration (n,): all variables 0. Where joints are locked
        elsewhere it need not be closed."""
        return self.structure.reference
