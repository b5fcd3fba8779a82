"""A mechanism as a workshop makes it: every joint a little off its place on every body.

In: a structure, and how large errors are. Out: small displacements that stand in the
chains of its closures.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkages.closure.changes import Changes, Elements
from linkages.mechanisms.joint import Motion
from linkages.structure.structure import Structure
from linkages.values import GeometryError

SIDES = 2  # bodies that a pair joins, and points that a closure brings together


@dataclass(frozen=True, eq=False)
class JointErrors(Changes):
    """How far joints are off on the bodies that they join.

    ``turns`` (p, 2, 3), rad, and ``shifts`` (p, 2, 3) are those of the frames of each
    pair's joint on its base and on its moved body, about ``places`` (p, 3) in the
    user's unit. ``points`` (c, 2, 3) are those of the points that each closure brings
    together, ``rods`` (c,) those of the lengths of rods. Errors of lengths are in the
    unit of the structure.
    """

    places: np.ndarray
    turns: np.ndarray
    shifts: np.ndarray
    points: np.ndarray
    rods: np.ndarray

    def displacement(self, pair: int, side: int) -> Elements:
        if pair >= len(self.places):  # no joint, but a body or a point that is free
            return ()
        motions = []
        for is_turn, vectors in ((False, self.shifts), (True, self.turns)):
            vector = vectors[pair, side]
            size = float(np.linalg.norm(vector))
            if size > 0.0:
                motion = Motion(is_turn, vector / size, self.places[pair])
                motions.append((motion, size))
        return motions

    def ends(self, closure: int) -> tuple[list[float], list[float]]:
        first, second = self.points[closure].tolist()
        return first, second

    def rod(self, closure: int) -> float:
        return float(self.rods[closure])


def draw_errors(
    structure: Structure, error: float, rng: np.random.Generator
) -> JointErrors:
    """Normally distributed errors, independent of each other.

    ``error`` is their standard deviation: in rad for turns, in characteristic lengths
    for shifts and rods. The same generator with another ``error`` gives the same errors
    to another scale. Raises `GeometryError` for an ``error`` that is no such number.
    """
    if not (np.isfinite(error) and error >= 0.0):
        raise GeometryError("error", error, "a finite number, not negative")
    pairs = len(structure.mechanism.pairs)
    closures = len(structure.closures)
    # in this order, so that a seed keeps its meaning
    turns = error * rng.normal(size=(pairs, SIDES, 3))
    shifts = error * rng.normal(size=(pairs, SIDES, 3))
    points = error * rng.normal(size=(closures, SIDES, 3))
    rods = error * rng.normal(size=closures)
    return JointErrors(_places(structure), turns, shifts, points, rods)


def _places(structure: Structure) -> np.ndarray:
    """A point (p, 3) of the joint of each pair: of an axis that nearest to the middle of
    the mechanism, and that middle itself for what only slides."""
    mechanism = structure.mechanism
    middle = structure.size.points.mean(axis=0)
    places = []
    for pair in mechanism.pairs:
        place = middle
        if pair.center is not None:
            place = pair.center
        turns = [
            mechanism.variables[number].motion
            for number in pair.variables
            if mechanism.variables[number].motion.is_turn
        ]
        if turns:
            axis = turns[0]
            along = float((middle - axis.point) @ axis.direction)
            place = axis.point + along * axis.direction
        places.append(place)
    return np.array(places).reshape(-1, 3)
