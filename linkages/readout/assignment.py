"""Which forms of a crease pattern leave the flat state as it is assigned."""

from __future__ import annotations

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.torus import wrap
from linkages.decisions import keeps_angle, passes_reference
from linkages.readout.readout import Readout

STEP = 0.01  # of a form, from the flat state
AS_ASSIGNED = "as assigned"


def named_as_assigned(atlas: Atlas, readout: Readout) -> Atlas:
    """The atlas with those forms named so on which every valley and every mountain folds
    its way as the form leaves the flat state."""
    flat = _flat_state(readout)
    if flat is None:
        return atlas
    names = [
        f"{form.name} ({AS_ASSIGNED})"
        if _leaves_as_assigned(form.branch, flat, readout)
        else form.name
        for form in atlas.forms
    ]
    return atlas.renamed(names, [form.labels for form in atlas.forms])


def _flat_state(readout: Readout) -> np.ndarray | None:
    """The unknowns (n,) where the sheet is flat; None where no crease is assigned or
    some are at rest, or where it is given folded and one that is not assigned has
    another fold angle."""
    mechanism, structure = readout.mechanism, readout.structure
    if mechanism.at_rest:
        return None
    flat: np.ndarray = readout.structure.reference.copy()
    angles = {one.joint: one.angle for one in mechanism.creases}
    columns = {
        mechanism.variables[number].joint: column
        for number, column in structure.column_of.items()
    }
    if not angles.keys() & columns.keys():
        return None
    if any(angles.values()) and columns.keys() - angles.keys():
        return None
    for joint, column in columns.items():
        flat[column] = -angles.get(joint, 0.0)
    return flat


def _leaves_as_assigned(branch: Branch, flat: np.ndarray, readout: Readout) -> bool:
    """Whether a branch leaves the ``flat`` state (n,), to one side, with every assigned
    crease folded its way."""
    for s in branch.passes(flat, passes_reference.threshold):
        step = STEP * branch.length
        ways = np.array([s - step, s + step])
        if branch.closed:
            ways = np.remainder(ways, branch.length)
        inside = ways[(ways >= 0.0) & (ways <= branch.length)]
        folds = _folds(branch(inside), readout)
        if np.any(np.all((folds > 0.0) & ~keeps_angle(folds), axis=1)):
            return True
    return False


def _folds(points: np.ndarray, readout: Readout) -> np.ndarray:
    """The fold angles (k, c), rad, of the assigned creases that are not held, positive
    where they are folded their way, at configurations (k, n)."""
    values = readout.values(points)
    numbers = {one.joint: k for k, one in enumerate(readout.mechanism.variables)}
    columns = []
    for crease in readout.mechanism.creases:
        number = numbers[crease.joint]
        if number in readout.structure.column_of:
            folds = values[:, number] + crease.angle
            periods = np.full(len(folds), 2 * np.pi)
            columns.append(crease.sign * wrap(folds, periods))
    return np.array(columns).reshape(len(columns), len(points)).T
