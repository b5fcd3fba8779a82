"""All configurations of a mechanism in slices, or all of its assemblies, by paths.

Where as many closures as unknowns are left with one unknown given, at each of its values
all configurations are found (`linkages.modules.solve`). A motion moves one of the
unknowns: slices of all of them leave none out that is longer than the steps between
them.
"""

from __future__ import annotations

import numpy as np

from bifurc.limits import current_deadline, until
from bifurc.problem import Problem
from linkages.dyads.group import UnfollowedError
from linkages.dyads.slices import (
    MOST_POINTS,
    DyadSlices,
    follows_many_turns,
    slice_places,
    within_limits,
)
from linkages.modules.solve import Module
from linkages.structure.structure import Structure

MOST_COORDINATES = 30  # of a module that is looked at
MOST_UNKNOWNS = 10  # all of which drive, one after the other
SLICES = 12  # of each of them, at which paths lead to all configurations
MOST_PATHS = 100  # complex configurations at a value of every unknown, in all
TIME = 0.4  # of what is left of a budget, for generic solutions and paths


def all_assemblies(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """All assemblies of the mechanism of a ``structure`` that nothing moves; None where
    it is not known that they are all."""
    with until(current_deadline().share(TIME)):
        try:
            return _assemblies(structure)
        except UnfollowedError:
            return None


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """Slices of the mechanism of a ``structure`` at evenly spaced values, the first one
    drawn, of all of its unknowns; None where it is not known that they have all
    configurations."""
    with until(current_deadline().share(TIME)):
        try:
            return _slices(structure, rng)
        except UnfollowedError:
            return None


def _assemblies(structure: Structure) -> DyadSlices:
    """The assemblies of what nothing moves. Raises `UnfollowedError`."""
    module = _small_module(structure, ())
    points = module.configurations({})
    inside = [one for point in points for one in within_limits(structure, point)]
    return DyadSlices(
        structure,
        np.array(inside).reshape(-1, len(structure.unknowns)),
        (),
        (),
        misses_none=True,
        counts=(module.count,),
        trace=module.generic.trace or 0.0,
    )


def _slices(structure: Structure, rng: np.random.Generator) -> DyadSlices:
    """Slices of all unknowns. Raises `UnfollowedError`."""
    unknowns = structure.unknowns
    if structure.embedded or structure.point_pairs or len(unknowns) > MOST_UNKNOWNS:
        raise UnfollowedError("not every motion moves one of a few joints")
    modules = [_small_module(structure, (number,)) for number in range(len(unknowns))]
    if sum(module.count for module in modules) > MOST_PATHS:
        raise UnfollowedError("there are too many configurations")
    points: list[np.ndarray] = []
    steps = []
    for number, module in enumerate(modules):
        places, step = slice_places(unknowns[number], rng, SLICES)
        steps.append(step)
        for place in places:
            for point in module.configurations({number: float(place)}):
                points += within_limits(structure, point)
        if len(points) > MOST_POINTS:
            raise UnfollowedError("there are too many configurations")
    return DyadSlices(
        structure,
        np.array(points).reshape(-1, len(unknowns)),
        tuple(range(len(unknowns))),
        tuple(steps),
        misses_none=True,
        counts=tuple(module.count for module in modules),
        trace=max(module.generic.trace or 0.0 for module in modules),
    )


def _small_module(structure: Structure, held: tuple[int, ...]) -> Module:
    """The module with some unknowns held. Raises `UnfollowedError`."""
    if follows_many_turns(structure):
        raise UnfollowedError("something follows many turns")
    module = Module(structure, held)
    if module.family.n > MOST_COORDINATES:
        raise UnfollowedError("there are too many unknowns")
    return module
