"""All assemblies of a mechanism of any joints that nothing moves, by paths."""

from __future__ import annotations

import numpy as np

from bifurc.limits import current_deadline, until
from bifurc.paths.follow import PathEnd
from bifurc.problem import Problem
from linkages.decisions import is_short_bar
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.slices import (
    DyadSlices,
    follows_many_turns,
    pins_hold_all,
    stands,
    within_limits,
)
from linkages.modules.equations import ClosureFamily
from linkages.structure.structure import Structure

MOST_COORDINATES = 30  # of a mechanism that is looked at
TIME = 0.4  # of what is left of a budget, for generic solutions and paths
ROUNDING = 1e-12  # of a length: it is none


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
        if self.family.n > MOST_COORDINATES:
            raise UnfollowedError("there are too many unknowns")

    @property
    def count(self) -> int:
        """How many complex configurations there are for generic lengths."""
        return self.family.generic.count

    @property
    def trace(self) -> float:
        """The trace test of them."""
        return self.family.generic.trace or 0.0

    def configurations(self) -> np.ndarray:
        """All real configurations (k, n), angles between -pi and pi."""
        family = self.family
        paths = family.paths_to_regular(family.given)
        if np.any(paths.ends == PathEnd.AT_INFINITY):
            require_no_short_length(self.structure)
        return family.points(family.real_ends(paths))


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
        counts=(module.count,),
        trace=module.trace,
    )


def require_no_short_length(structure: Structure) -> None:
    """Raise `UnfollowedError` where paths may come back that seem to end at infinity."""
    points = [
        variable.motion.point / structure.unit
        for variable in structure.mechanism.variables
        if variable.motion.is_turn
    ]
    places = [
        place / structure.unit
        for closure in structure.closures
        for place in (closure.first, closure.second)
    ]
    rows = np.array(points + places)
    gaps = np.linalg.norm(rows[:, None] - rows[None], axis=2)
    gaps = gaps[gaps > ROUNDING]
    if len(gaps) and is_short_bar(float((gaps.min() / gaps.max()) ** 2)):
        raise UnfollowedError("a length is so short that paths seem to end at infinity")
