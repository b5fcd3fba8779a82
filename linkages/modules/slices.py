"""All configurations of a mechanism of any joints with one unknown at given values, by
paths, and what they say of its motions.

A motion on which the driver passes such a value cannot be missed. Whether it moves on
every motion is asked of the complex ones: each lies on a curve on which some unknown is
not constant, and passes any value of that, but for a few. So at one generic complex
value of every unknown all configurations are found, and at each the driver has to move.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from bifurc.decisions import is_singular_path_end
from bifurc.limits import current_deadline, until
from bifurc.paths.monodromy import Fibre
from bifurc.problem import Problem
from linkages.dyads.generic import UnfollowedError
from linkages.dyads.slices import (
    TURN,
    DyadSlices,
    follows_many_turns,
    places_of_slices,
    within_limits,
)
from linkages.modules.assemblies import TIME
from linkages.modules.equations import ClosureFamily, solutions_of
from linkages.modules.loops import single_loop
from linkages.structure.structure import Structure, Unknown

MOST_COORDINATES = 10  # of what is no single loop: with more, paths take long
MOST_DRIVERS = 1
# Complex places all round the values of a driver, and how far beside these they are, over
# the way round: less than between them.
HUBS, BESIDE = 5, 0.04
PLACES = 2  # that are tried for all configurations at one


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
            self.closures = ClosureFamily(structure, is_driven=True)
        except ValueError as error:
            raise UnfollowedError(str(error)) from error
        self.loop = single_loop(self.closures)
        is_small = self.loop or self.closures.n <= MOST_COORDINATES
        if self.closures.standing or not is_small:
            raise UnfollowedError("there are too many unknowns")
        numbers = range(len(structure.unknowns))
        self.families = [self.closures.driven_by((number,)) for number in numbers]
        # all configurations at a complex place of every one that moves
        self.bases: dict[int, tuple[complex, Fibre]] = {}

    def drivers(self, rng: np.random.Generator) -> list[int]:
        """A few unknowns, by number, that move on every motion, those with the least
        configurations at a value."""
        moving = np.ones(len(self.families), dtype=bool)
        for family in self._of_all_motions():
            base = self._base(family, rng)
            for jacobian in family.family.jacobians(base.solutions, base.parameters):
                moving &= _do_move(family, jacobian)
        of_joints = [
            number
            for number in np.flatnonzero(moving).tolist()
            if number in self.bases and self.structure.unknowns[number].variable >= 0
        ]
        counts = [self.count(number) for number in of_joints]
        order = np.argsort(counts, kind="stable")[:MOST_DRIVERS]
        return [of_joints[place] for place in order.tolist()]

    def _base(self, family: ClosureFamily, rng: np.random.Generator) -> Fibre:
        """All configurations with the driver of a family at a random complex place: there
        some may be so far away that they look singular."""
        driver = family.drivers[0]
        for attempt in range(PLACES):
            place = _place_beside(self.structure.unknowns[driver], rng.uniform())
            try:
                points = self._all_at(family, place)
                break
            except UnfollowedError:
                if attempt == PLACES - 1:
                    raise
        base = Fibre(family.given_at(place), points)
        if len(family.drivers) == 1:
            self.bases[driver] = place, base
        return base

    def count(self, driver: int) -> int:
        """How many complex configurations there are at a value of a driver."""
        return len(self.bases[driver][1].solutions)

    def trace(self, driver: int) -> float:
        """The trace test of these."""
        families = self.loop.family if self.loop else self.families.__getitem__
        return families(driver).generic.trace or 0.0

    def _of_all_motions(self) -> list[ClosureFamily]:
        """Families of which on every motion one has a driver that moves: of every
        unknown but those that stand still for generic lengths, and of all of these
        together with another one."""
        if self.loop:
            return [self.families[number] for number in self.loop.on_every_motion()]
        moving = [family for family in self.families if family.is_regular]
        if not moving:
            raise UnfollowedError("it moves, or more holds it than has to")
        still = [one.drivers[0] for one in self.families if not one.is_regular]
        if still:
            together = (moving[0].drivers[0], *still)
            moving.append(self.closures.driven_by(together))
        return moving

    def points(self, driver: int, places: list[float]) -> np.ndarray:
        """All real configurations (k, n) within the limits with one of the `drivers` at
        any of the places."""
        family = self.families[driver]
        ends = self._ends(driver, places)
        points = family.points(np.concatenate(ends))
        points[:, driver] = np.repeat(places, list(map(len, ends)))
        points = points[family.are_real(np.concatenate(ends))]
        inside = [
            one for point in points for one in within_limits(self.structure, point)
        ]
        return np.array(inside).reshape(-1, len(self.families))

    def _ends(self, driver: int, places: list[float]) -> list[np.ndarray]:
        """All complex configurations (k, c) at each of the places of a driver.

        Each lies on a curve that has points at the complex place of the base as well, from
        where paths lead to others all round, and from the next of these to the real
        ones. In a ring of turns those from a generic one are faster.
        """
        if self.loop and self.loop.is_ring_beside(driver):
            return [self.loop.solutions(driver, place) for place in places]
        family = self.families[driver]
        first, base = self.bases[driver]
        span = _span(self.structure.unknowns[driver])
        hubs = first + span / HUBS * np.arange(HUBS)
        fibres = [base, *self._fibres(family, [base] * (HUBS - 1), hubs[1:])]
        nearest = np.round((np.array(places) - first.real) * HUBS / span).astype(int)
        starts = [fibres[number] for number in (nearest % HUBS).tolist()]
        return [one.solutions for one in self._fibres(family, starts, places)]

    def _fibres(
        self, family: ClosureFamily, starts: list[Fibre], places: Iterable[complex]
    ) -> list[Fibre]:
        """All configurations with the driver of a family at each of some places, from
        all at another one for each."""
        counts = [len(one.solutions) for one in starts]
        places = list(places)
        last = [family.given_at(place) for place in places]
        first = np.repeat([one.parameters for one in starts], counts, axis=0)
        solutions = np.concatenate([one.solutions for one in starts])
        paths = family.followed(
            Fibre(first, solutions), np.repeat(last, counts, axis=0)
        )
        fibres, is_end = [], paths.is_regular & paths.solves_all
        for place, given, own in zip(places, last, _ranges(counts), strict=True):
            ends = paths.points[own]
            if not np.all(is_end[own]):
                ends = self._all_at(family, place)
            fibres.append(Fibre(given, ends))
        return fibres

    def _all_at(self, family: ClosureFamily, place: complex) -> np.ndarray:
        """All configurations (k, c) with the driver of a family at a place."""
        if self.loop:
            return self.loop.solutions(family.drivers[0], place)
        return solutions_of(family, family.given_at(place), self.structure)


def _span(unknown: Unknown) -> float:
    """Between the least and the largest values of an unknown: a turn of an angle, and 1
    where there are no limits."""
    if unknown.is_angle:
        return TURN
    span = unknown.high - unknown.low
    return span if np.isfinite(span) else 1.0


def _place_beside(unknown: Unknown, share: float) -> complex:
    """A complex place beside the real values of an unknown, after so much of them."""
    span = _span(unknown)
    low = unknown.low if np.isfinite(unknown.low) else 0.0
    return complex(low + share * span, -BESIDE * span)


def _ranges(counts: Sequence[int]) -> Iterator[slice]:
    """The places of so many, one after the other."""
    ends = np.cumsum([0, *counts]).tolist()
    return itertools.starmap(slice, itertools.pairwise(ends))


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
        points.append(motions.points(driver, places))
        steps.append(step)
    return DyadSlices(
        motions.structure,
        np.concatenate(points),
        tuple(drivers),
        tuple(steps),
        misses_none=True,
        counts=tuple(map(motions.count, drivers)),
        trace=max(map(motions.trace, drivers)),
    )
