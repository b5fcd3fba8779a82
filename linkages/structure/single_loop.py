"""A mechanism that is one loop of revolute joints, as a `Loop`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.isometry import Isometry
from linkages.axes import loop_from_axes
from linkages.loop import MAX_JOINTS, MIN_JOINTS, Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.structure import ClosureKind, Structure
from linkages.values import GeometryError


@dataclass(frozen=True, eq=False)
class SingleLoop:
    """A ``loop``, its joint angles in the ``reference`` configuration (n,), rad, the
    ``variables`` (n,) of the mechanism, by number, that its joints are, in loop order,
    and their ``signs`` (n,): angle - reference = sign * variable."""

    loop: Loop
    reference: np.ndarray
    variables: np.ndarray
    signs: np.ndarray

    def to_unknowns(self, structure: Structure) -> Isometry:
        """From the joint angles of the loop to the unknowns of the ``structure`` that it
        is the loop of."""
        columns = [structure.column_of[int(number)] for number in self.variables]
        joints = np.argsort(columns)
        return Isometry(joints, self.signs[joints], self.reference[joints])


def as_single_loop(structure: Structure) -> SingleLoop | None:
    """The mechanism as one loop of 4 to 12 revolute joints; None where it is none, or
    where joints have limits, are coupled or stand locked elsewhere than at 0, or where
    coordinates are known to less than doubles hold."""
    # the equations of a mechanism say what hangs on the rounding of coordinates
    if not structure.mechanism.is_known_to_rounding:
        return None
    return turns_as_loop(structure)


def turns_as_loop(structure: Structure) -> SingleLoop | None:
    """The same, also where coordinates are known to less."""
    mechanism = structure.mechanism
    if mechanism.independent_loops != 1 or mechanism.is_coupled:
        return None
    if not _has_plain_turns_only(mechanism):
        return None
    (closure,) = structure.closures
    if closure.kind is not ClosureKind.CYCLE:
        return None
    variables, signs = [], []
    for step in closure.chain:
        # against the sense of a joint of several turns the last one comes first
        for number in mechanism.pairs[step.pair].variables[:: step.sign]:
            if mechanism.variables[number].locked is None:
                variables.append(number)
                signs.append(step.sign)
    if not MIN_JOINTS <= len(variables) <= MAX_JOINTS:
        return None
    motions = [mechanism.variables[number].motion for number in variables]
    points = [motion.point for motion in motions]
    directions = [motion.direction for motion in motions]
    try:
        loop, reference = loop_from_axes(points, directions, mechanism.name)
    except GeometryError:  # neighbouring axes coincide
        return None
    return SingleLoop(loop, reference, np.array(variables), np.array(signs))


def _has_plain_turns_only(mechanism: Mechanism) -> bool:
    """Whether every variable is a turn without advance or limits, free or locked at
    0."""
    if any(pair.center is not None for pair in mechanism.pairs):
        return False
    for variable in mechanism.variables:
        motion = variable.motion
        if not motion.is_turn or motion.advance or variable.limits is not None:
            return False
        if variable.locked not in (None, 0.0):
            return False
    return True
