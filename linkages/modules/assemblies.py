"""All assemblies of a mechanism of any joints that nothing moves, by paths."""

from __future__ import annotations

import numpy as np

from bifurc.limits import current_deadline, until
from bifurc.paths.monodromy import GenericSolutions
from bifurc.problem import Problem
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.slices import (
    DyadSlices,
    follows_many_turns,
    pins_hold_all,
    stands,
    within_limits,
)
from linkages.modules.equations import ClosureFamily, solutions_of
from linkages.modules.loops import single_loop
from linkages.structure.structure import Structure

MOST_COORDINATES = 30  # of a mechanism that is looked at
TIME = 0.4  # of what is left of a budget, for generic solutions and paths


class Module:
    """The mechanism of a ``structure`` that nothing moves.

    Raises `UnfollowedError` where it is not known that all configurations are found.
    """

    def __init__(self, structure: Structure):
        self.structure = structure
        if follows_many_turns(structure):
            raise UnfollowedError("something follows many turns")
        if pins_hold_all(structure):
            raise UnfollowedError("it is built of dyads and of groups on pins")
        try:
            self.family = ClosureFamily(structure)
        except ValueError as error:
            raise UnfollowedError(str(error)) from error
        self.loop = single_loop(self.family)
        if self.family.n > MOST_COORDINATES:
            raise UnfollowedError("there are too many unknowns")

    @property
    def generic(self) -> GenericSolutions:
        """The complex configurations for generic lengths."""
        return self.loop.family().generic if self.loop else self.family.generic

    def configurations(self) -> np.ndarray:
        """All real configurations (k, n), angles between -pi and pi."""
        ends = self._solutions()
        return self.family.points(ends[self.family.are_real(ends)])

    def _solutions(self) -> np.ndarray:
        """All complex ones (k, c), as coordinates of the family."""
        if self.loop:
            return self.loop.solutions()
        return solutions_of(self.family, self.family.given, self.structure)


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """All assemblies of the mechanism of a ``structure`` that nothing moves; None where
    it is not known that they are all."""
    with until(current_deadline().share(TIME)):
        try:
            module = Module(structure)
            return _assemblies(module) if stands(problem, structure) else None
        except UnfollowedError:
            return None


def _assemblies(module: Module) -> DyadSlices:
    """The assemblies of what nothing moves. Raises `UnfollowedError`."""
    structure = module.structure
    points = module.configurations()
    inside = [one for point in points for one in within_limits(structure, point)]
    return DyadSlices(
        structure,
        np.array(inside).reshape(-1, len(structure.unknowns)),
        (),
        (),
        misses_none=True,
        counts=(module.generic.count,),
        trace=module.generic.trace or 0.0,
    )
