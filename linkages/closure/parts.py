"""What the closure of a subject is made of."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from bifurc.checks import rows_of
from bifurc.domain import Domain
from bifurc.equations.system import CompiledSystem
from bifurc.function_problem import NumericalProblem
from bifurc.limits import Deadline
from bifurc.problem import Problem
from bifurc.seeds import Seeds
from bifurc.system import Accuracy, Curvature

if TYPE_CHECKING:
    # it imports networkx, which a loop does not need
    from linkages.structure.structure import Structure

NEARLY_CLOSED = 0.2  # the largest residual at which bounds on F'' hold


class Starts(Protocol):
    """Where a search of a closure begins."""

    def __call__(
        self,
        problem: Problem,
        rng: np.random.Generator,
        count: int,
        deadline: Deadline | None,
    ) -> Seeds:
        """Closed configurations to start from, ``count`` random starts among what they
        come of, and what judges the branches that are traced from them."""


class ClosureParts(NamedTuple):
    """What is chosen once for a subject: the equations as compiled code, the
    ``bounds`` on F'' from the geometry, worked out when they are asked for, and the
    ``starts``. A mechanism has a ``structure``, and the ``rows`` of the equations that
    belong to each of its closures."""

    domain: Domain
    accuracy: Accuracy
    compiled: CompiledSystem
    bounds: Callable[[], Curvature]
    starts: Starts
    structure: Structure | None = None
    rows: tuple[slice, ...] = ()


class ClosureOfParts(NumericalProblem):
    """The closure equations that ``parts`` make."""

    compiled: CompiledSystem

    def __init__(self, parts: ClosureParts):
        self.parts = parts
        self.domain, self.accuracy = parts.domain, parts.accuracy
        self.compiled = parts.compiled

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

    def seeds(
        self, rng: np.random.Generator, count: int, deadline: Deadline | None = None
    ) -> Seeds:
        """Closed configurations to start from, ``count`` random starts among what they
        come of."""
        return self.parts.starts(self, rng, count, deadline)
