"""All configurations of a loop with a joint at given values within its limits.

A slice of a loop is complete whatever limits its joints have: those leave some of it
out. So what passes through narrow limits is found as surely as without any.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkages.loop import GeometryError
from linkages.mechanisms.single_loop import SingleLoop, as_single_loop
from linkages.mechanisms.structure import Structure
from linkages.slices.elimination import Slice, slice_configurations

__all__ = ["slices_within_limits"]

SLICES = 12  # of the limits of a joint


def slices_within_limits(structure: Structure, rng: np.random.Generator) -> np.ndarray:
    """Configurations (k, n) in the slices of every joint with limits, at evenly spaced
    values within these, the first one drawn; none where the mechanism, but for its
    limits, is no loop of at most six revolute joints."""
    nowhere = np.empty((0, len(structure.unknowns)))
    has_limits = any(one.limits for one in structure.mechanism.variables)
    single = _without_limits(structure) if has_limits else None
    if single is None:
        return nowhere
    points = [nowhere]
    for number, variable in enumerate(structure.mechanism.variables):
        if variable.limits is None or variable.locked is not None:
            continue
        low, high = variable.limits
        steps = (np.arange(SLICES) + rng.uniform()) / SLICES
        cut = _slice(single, number, low + (high - low) * steps)
        if cut is not None:
            points.append(_unknowns(structure, single, cut.configurations))
    return np.concatenate(points)


def _without_limits(structure: Structure) -> SingleLoop | None:
    """The mechanism without its limits as a loop; None where it is none."""
    mechanism = structure.mechanism
    joints = tuple(replace(joint, limits=()) for joint in mechanism.joints)
    return as_single_loop(Structure(replace(mechanism, joints=joints)))


def _slice(single: SingleLoop, variable: int, values: np.ndarray) -> Slice | None:
    """The slices of a loop at ``values`` (k,), rad, of a variable, by number; None for
    a loop of more than six joints."""
    joint = int(np.flatnonzero(single.variables == variable)[0])
    angles = single.reference[joint] + single.signs[joint] * values
    try:
        return slice_configurations(single.loop, joint + 1, angles)
    except GeometryError:
        return None


def _unknowns(
    structure: Structure, single: SingleLoop, angles: np.ndarray
) -> np.ndarray:
    """The unknowns (k, n) at joint angles (k, n) of the loop, rad, those with limits
    within half a turn of the middle of these."""
    columns = [structure.column_of[number] for number in single.variables]
    points = np.empty_like(angles)
    points[:, columns] = single.signs * (angles - single.reference)
    for column, unknown in enumerate(structure.unknowns):
        if np.isinf(unknown.period):
            middle = 0.5 * (unknown.low + unknown.high)
            turns = np.round((middle - points[:, column]) / (2 * np.pi))
            points[:, column] += 2 * np.pi * turns
    return points
