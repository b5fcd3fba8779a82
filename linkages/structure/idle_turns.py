"""Turns that move nothing: a body that a joint holds, and a spherical joint on the axis
of that joint, turns about the axis by itself."""

from __future__ import annotations

import numpy as np

from linkages.decisions import meets_in_one_point
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.groups import Group, Groups


def find_idle_turn(groups: Groups) -> str | None:
    """The label of a variable that moves nothing but a body or a chain of bodies about
    its own line; None where there is none.

    A body that hangs on its neighbour by a turn and a spherical joint on the axis of it
    is a door, and no idle one.
    """
    mechanism, ends = groups.mechanism, groups.ends
    for group in groups.all:
        if len(group.outer) != 1 or len(group.points) != 1:
            continue
        (pair,) = group.outer
        is_moved = ends[pair].moved in group.bodies
        neighbour = groups.of_body[ends[pair].base if is_moved else ends[pair].moved]
        is_door = group.points[0] in neighbour.points
        if is_door or _holds_locks(mechanism, group):
            continue
        center = groups.points[group.points[0]].center
        for number in _turns_beside(mechanism, pair, is_moved):
            motion = mechanism.variables[number].motion
            arm = np.cross(center - motion.point, motion.direction)
            if meets_in_one_point(float(np.linalg.norm(arm)), groups.unit):
                return mechanism.variables[number].label
    return None


def _holds_locks(mechanism: Mechanism, group: Group) -> bool:
    """Whether a pair inside is locked elsewhere than at 0: the spherical joint is then
    not where it was given."""
    numbers = [v for k in group.inner for v in mechanism.pairs[k].variables]
    return any(mechanism.variables[number].locked != 0.0 for number in numbers)


def _turns_beside(mechanism: Mechanism, pair: int, is_moved: bool) -> list[int]:
    """The free turns of a pair, by number, whose axes stand still in its moved body or
    else in its base: one may lock each at 0."""
    numbers = list(mechanism.pairs[pair].variables)
    variables = [mechanism.variables[number] for number in numbers]
    is_one_line = all(
        not np.any(np.cross(one.motion.direction, variables[0].motion.direction))
        for one in variables
    )
    if not is_one_line:
        numbers = numbers[-1:] if is_moved else numbers[:1]
    followed = {
        one.leader.number
        for follower, one in enumerate(mechanism.variables)
        if one.leader.number != follower
    }
    turns = []
    for number in numbers:
        variable = mechanism.variables[number]
        low, high = variable.limits or (-np.inf, np.inf)
        is_alone = variable.leader.number == number and number not in followed
        is_free = variable.locked is None and is_alone and low <= 0.0 <= high
        if is_free and variable.motion.is_turn and variable.motion.advance == 0.0:
            turns.append(number)
    return turns
