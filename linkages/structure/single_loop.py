"""A mechanism that is one loop of revolute joints, as a `Loop`: one that has the same
motions, or, whatever limits and locks it has, the same geometry."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bifurc.isometry import Isometry
from linkages.axes import loop_from_axes
from linkages.construction.constructions import lock, locked_angles
from linkages.loop import MAX_JOINTS, MIN_JOINTS, Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.structure import ClosureKind, Structure
from linkages.values import GeometryError

LOCKED_IN_PLACE = 0.0


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

    def orientation(self, structure: Structure) -> np.ndarray:
        """The rotation (3, 3) from the frame of the loop to that of the mechanism, both
        in the reference configuration: it takes axes and the joints on them along."""
        frames = self.loop.frames(self.reference)[:-1]
        motions = [structure.mechanism.variables[k].motion for k in self.variables]
        axes = np.array([one.direction for one in motions]) * self.signs[:, None]
        points = np.array([one.point for one in motions])
        here = [_across(frames[:, :3, 3], frames[0, :3, 2]), frames[:, :3, 2]]
        there = [_across(points, axes[0]), axes]
        size = np.abs(here[0]).max() or 1.0
        rows_here = np.concatenate([here[0] / size, here[1]])
        rows_there = np.concatenate([there[0] / size, there[1]])
        left, _, right = np.linalg.svd(rows_there.T @ rows_here)
        left[:, 2] *= np.sign(np.linalg.det(left @ right))
        rotation: np.ndarray = left @ right
        return rotation


def _across(points: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Where points (k, 3) lie across an axis, from the middle of them."""
    middle = points - points.mean(axis=0)
    across: np.ndarray = middle - np.outer(middle @ axis, axis)
    return across


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
    if not _has_plain_turns_only(structure):
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
    # what hangs on the loop and is free is no part of it
    if len(variables) != len(structure.unknowns):
        return None
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


def _has_plain_turns_only(structure: Structure) -> bool:
    """Whether every variable in the loop is a turn without advance or limits, free or
    locked at 0."""
    mechanism = structure.mechanism
    hanging = structure.hanging.pairs if structure.holds_flaps else ()
    pairs = [pair for k, pair in enumerate(mechanism.pairs) if k not in hanging]
    if any(pair.center is not None for pair in pairs):
        return False
    for variable in (mechanism.variables[k] for pair in pairs for k in pair.variables):
        motion = variable.motion
        if not motion.is_turn or motion.advance or variable.limits is not None:
            return False
        if variable.locked not in (None, LOCKED_IN_PLACE):
            return False
    return True


def loop_geometry(mechanism: Mechanism) -> Loop:
    """The loop that a mechanism is: limits are left out, and every locked joint is
    replaced, together with its two links, by one link.

    Unlike `as_single_loop`, whose loop has the same
    motions, this is for the geometry.
    Raises `GeometryError`, which says why, for a mechanism that is no single loop of 4
    to 12 revolute joints.
    """
    joints = []
    for joint in mechanism.joints:
        # without limits, and free where it is locked elsewhere than at 0
        in_place = tuple(LOCKED_IN_PLACE if x == 0 else None for x in joint.locked)
        limits = (None,) * len(joint.limits)
        joints.append(replace(joint, limits=limits, locked=in_place))
    free = replace(mechanism, joints=tuple(joints), with_flaps=False)
    single = turns_as_loop(Structure(free))
    if single is None:
        allowed = f"a single loop of {MIN_JOINTS} to {MAX_JOINTS} revolute joints"
        allowed += mechanism.way_to_loop
        value = f"a mechanism with {_obstacle(mechanism)}"
        raise GeometryError(mechanism.name, value, allowed)
    return _with_locks(mechanism, single)


def _with_locks(mechanism: Mechanism, single: SingleLoop) -> Loop:
    """The loop with all joints replaced that are locked elsewhere than at 0."""
    loop = single.loop
    values = [mechanism.variables[int(number)].locked for number in single.variables]
    turned = np.array([0.0 if value is None else value for value in values])
    theta = single.reference + single.signs * turned
    for joint in range(loop.n, 0, -1):
        if values[joint - 1] is None:
            continue
        kink = float(theta[joint - 1])
        try:
            theta = locked_angles(loop, joint, kink, theta)
            loop = lock(loop, joint, kink)
        except GeometryError as error:
            number = int(single.variables[joint - 1])
            name = next(p.joint for p in mechanism.pairs if number in p.variables)
            value = f"{np.degrees(turned[joint - 1]):g} degrees"
            allowed = "such that the axes beside it are not the same"
            raise GeometryError(f"lock of {name}", value, allowed) from error
    rounding = max(loop.rounding, mechanism.rounding)
    return replace(loop, name=mechanism.name, rounding=rounding)


def _obstacle(mechanism: Mechanism) -> str:
    """Why a mechanism is no single loop of revolute joints."""
    if mechanism.independent_loops != 1:
        return f"{mechanism.independent_loops} independent loops"
    for pair in mechanism.pairs:
        motions = [mechanism.variables[number].motion for number in pair.variables]
        is_of_turns = all(one.is_turn and not one.advance for one in motions)
        if pair.center is not None or not is_of_turns:
            kind = mechanism.joint(pair.joint).kind.value
            return f"a {kind} joint ({pair.joint})"
    if mechanism.is_coupled:
        return "joints that are coupled to each other"
    turns = sum(variable.locked is None for variable in mechanism.variables)
    return f"{turns} turns that are free, or neighbouring ones about one axis"
