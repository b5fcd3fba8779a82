"""All configurations of a mechanism of any joints with one unknown at given values, by
paths, and what they say of its motions.

A motion on which the driver passes such a value cannot be missed. Whether it moves on
every motion is asked of the complex ones: each lies on a curve on which some unknown is
not constant, and passes any value of that, but for a few. So at one generic complex
value of every unknown all configurations are found, and at each the driver has to move.
"""

from __future__ import annotations

import numpy as np

from bifurc.decisions import is_singular_path_end
from bifurc.limits import current_deadline, until
from bifurc.paths.family import complex_normal
from bifurc.paths.follow import PathEnd, Paths
from bifurc.paths.monodromy import Fibre
from bifurc.problem import Problem
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.slices import (
    DyadSlices,
    follows_many_turns,
    places_of_slices,
    within_limits,
)
from linkages.modules.assemblies import TIME, require_no_short_length
from linkages.modules.equations import ClosureFamily
from linkages.structure.structure import Structure

MOST_COORDINATES = 11  # of a mechanism that is looked at: with more, paths take long
MOST_DRIVERS = 2


class Motions:
    """The motions of a ``structure`` by its configurations at values of one unknown
    after the other.

    Raises `UnfollowedError` where it is not known that all are found.
    """

    def __init__(self, structure: Structure):
        self.structure = structure
        if follows_many_turns(structure):
            raise UnfollowedError("something follows many turns")
        try:
            first = ClosureFamily(structure, (0,))
        except ValueError as error:
            raise UnfollowedError(str(error)) from error
        if first.standing or first.n > MOST_COORDINATES:
            raise UnfollowedError("there are too many unknowns")
        numbers = range(1, len(structure.unknowns))
        others = [ClosureFamily(structure, (number,)) for number in numbers]
        self.families = [first, *others]
        # all configurations at a complex value of every one that moves
        self.fibres: dict[tuple[int, ...], Fibre] = {}

    def drivers(self, rng: np.random.Generator) -> list[int]:
        """A few unknowns, by number, that move on every motion, those with the least
        configurations at a value."""
        moving = np.ones(len(self.families), dtype=bool)
        for family in self._of_all_motions():
            (value,) = complex_normal(rng, 1)
            given = family.given_at(value)
            points = self._paths(family, value).regular
            self.fibres[family.drivers] = Fibre(given, points)
            for jacobian in family.family.jacobians(points, given):
                moving &= _do_move(family, jacobian)
        of_joints = [
            number
            for number in np.flatnonzero(moving).tolist()
            if self.structure.unknowns[number].variable >= 0
        ]
        counts = [self.families[number].generic.count for number in of_joints]
        order = np.argsort(counts, kind="stable")[:MOST_DRIVERS]
        return [of_joints[place] for place in order.tolist()]

    def _of_all_motions(self) -> list[ClosureFamily]:
        """Families of which on every motion one has a driver that moves: of every
        unknown but those that stand still for generic lengths, and of all of these
        together with another one."""
        moving = [family for family in self.families if family.is_regular]
        if not moving:
            raise UnfollowedError("it moves, or more holds it than has to")
        still = [one.drivers[0] for one in self.families if not one.is_regular]
        if still:
            together = (moving[0].drivers[0], *still)
            moving.append(ClosureFamily(self.structure, together))
        return moving

    def points(self, driver: int, place: float) -> np.ndarray:
        """All real configurations (k, n) within the limits with one of the `drivers` at
        a place: each lies on a curve that has points at the complex value as well."""
        family = self.families[driver]
        start = self.fibres[family.drivers]
        paths = family.followed(start, family.given_at(place))
        if not np.all(paths.is_regular):
            paths = self._paths(family, place)
        points = family.points(family.real_ends(paths))
        points[:, driver] = place
        inside = [
            one for point in points for one in within_limits(self.structure, point)
        ]
        return np.array(inside).reshape(-1, len(self.families))

    def _paths(self, family: ClosureFamily, value: complex) -> Paths:
        """The paths to all configurations with the driver of a family at a value."""
        paths = family.paths_to_regular(family.given_at(value))
        if np.any(paths.ends == PathEnd.AT_INFINITY):
            require_no_short_length(self.structure)
        return paths


def _do_move(family: ClosureFamily, jacobian: np.ndarray) -> np.ndarray:
    """Which unknowns (n,) move on the curve on which the driver does, at a point with
    derivatives (m, c) of the equations, the last of which holds the driver."""
    rates = np.abs(np.linalg.svd(jacobian[:-1])[2][-1])
    shares = rates / rates.max()
    firsts = [place.start for place in family.columns]
    return np.array([not is_singular_path_end(float(shares[k])) for k in firsts])


def for_subject(
    problem: Problem, structure: Structure, rng: np.random.Generator, count: int
) -> DyadSlices | None:
    """Slices of a few unknowns of the mechanism of a ``structure`` that move on every
    motion; None where it is not known that there are such, and that the slices are
    complete."""
    with until(current_deadline().share(TIME)):
        try:
            return _sliced(Motions(structure), rng)
        except UnfollowedError:
            return None


def _sliced(motions: Motions, rng: np.random.Generator) -> DyadSlices:
    """The slices of all drivers. Raises `UnfollowedError`."""
    drivers = motions.drivers(rng)
    if not drivers:
        raise UnfollowedError("no unknown moves on every motion")
    points, steps = [], []
    for driver in drivers:
        places, step = places_of_slices(motions.structure.unknowns[driver], rng)
        points += [motions.points(driver, place) for place in places]
        steps.append(step)
    generic = [motions.families[driver].generic for driver in drivers]
    return DyadSlices(
        motions.structure,
        np.concatenate(points),
        tuple(drivers),
        tuple(steps),
        misses_none=True,
        counts=tuple(one.count for one in generic),
        trace=max(one.trace or 0.0 for one in generic),
    )
