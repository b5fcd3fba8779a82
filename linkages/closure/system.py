"""The closure equations of what moves: values, derivatives, domain."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bifurc.checks import rows_of
from bifurc.equations.system import CompiledSystem, ScaledTape
from bifurc.errors import ProblemError
from bifurc.function_problem import NumericalProblem
from bifurc.system import Curvature
from linkages.closure.loop_parts import parts_of_loop
from linkages.closure.parts import ClosureParts
from linkages.loop import Loop

if TYPE_CHECKING:
    # they import networkx, which a loop does not need
    from linkages.closure.changes import Changes
    from linkages.closure.flat_state import FlatState
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.structure.structure import Structure
    from linkages.turns.turn_lattice import TurnLattice


class ClosureSystem(NumericalProblem):
    """The closure equations of a ``subject``: of a loop in its joint angles, of a
    mechanism in the variables of its joints.

    Angles are in radians, lengths in characteristic lengths. All derivatives are exact.
    A mechanism with ``changes`` is another one in the same unknowns, as it is made or of
    other lengths, and need not close anywhere; ``structure`` is that of the mechanism, where it is there already.
    Raises `ProblemError` for a subject that is neither.
    """

    compiled: CompiledSystem

    def __init__(
        self,
        subject: Loop | Mechanism,
        changes: Changes | None = None,
        structure: Structure | None = None,
    ):
        self.subject = subject
        self.parts = parts = _parts_of(subject, changes, structure)
        self.domain, self.accuracy = parts.domain, parts.accuracy
        self.compiled = parts.compiled
        self.magnitude = parts.magnitude

    def residuals(self, points: np.ndarray) -> np.ndarray:
        """F (k, m) at points (k, n)."""
        return self.compiled.residuals(rows_of("points", points, self.n))

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """F' (k, m, n) at points (k, n)."""
        return self.compiled.jacobians(rows_of("points", points, self.n))

    @cached_property
    def curvature(self) -> Curvature:
        """Bounds on F'' from the geometry."""
        return self.parts.bounds()

    @property
    def structure(self) -> Structure:
        """What is unknown in a mechanism, and which chains have to close; a loop has
        none."""
        assert self.parts.structure is not None
        return self.parts.structure

    @property
    def reference(self) -> np.ndarray:
        """The reference configuration (n,) of a mechanism: all variables 0. Where joints
        are locked elsewhere it need not be closed."""
        return self.structure.reference

    @cached_property
    def lattice(self) -> TurnLattice:
        """The whole turns after which every closed configuration of a mechanism is closed
        again."""
        from linkages.turns.turn_lattice import turn_lattice

        return turn_lattice(self.structure)

    @cached_property
    def flat_state(self) -> FlatState:
        """What leads out of the flat state of a sheet."""
        from linkages.closure.flat_state import flat_state

        tape = self.compiled
        assert isinstance(tape, ScaledTape)  # that of a loop holds no unknowns
        return flat_state(self.structure, self.domain, tape.project)


def _parts_of(
    subject: Loop | Mechanism,
    changes: Changes | None,
    structure: Structure | None,
) -> ClosureParts:
    """What the closure of a ``subject`` is made of."""
    if isinstance(subject, Loop):
        return parts_of_loop(subject)
    from linkages.closure.changes import AS_GIVEN
    from linkages.closure.equations import parts_of_structure
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.structure.structure import Structure

    if not isinstance(subject, Mechanism):
        raise ProblemError("subject", repr(subject), "a Loop or a Mechanism")
    return parts_of_structure(structure or Structure(subject), changes or AS_GIVEN)
