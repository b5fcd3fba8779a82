"""The map of a mechanism that is a single loop of revolute joints.

It is made in the angles of the loop's Denavit-Hartenberg table, and stated in the
variables of the joints, as that of every mechanism: they are these angles in another
order, with other signs, and counted from the reference configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.isometry import Isometry, recount_atlas
from bifurc.torus import wrap
from linkages.closure.closure import Closure
from linkages.labels import FormLabels, subject_of
from linkages.mechanisms.subject import mechanism_subject
from linkages.readout.readout import Readout


def to_loop_angles(readout: Readout) -> Isometry:
    """From the unknowns of a mechanism to the joint angles of its loop, where it is a
    single one of revolute joints; else to the unknowns as they are."""
    single = readout.single_loop
    if single is None:
        return Isometry.identity(len(readout.structure.unknowns))
    return single.to_unknowns(readout.structure).inverse


def in_loop_angles(atlas: Atlas, readout: Readout) -> Atlas:
    """The atlas of a mechanism in the joint angles of its loop, which is the subject
    then, where it is a single one of revolute joints; else the atlas as it is."""
    single = readout.single_loop
    if single is None:
        return atlas
    names = Closure(single.loop).domain.names
    recounted = _recount(atlas, to_loop_angles(readout), names)
    return replace(recounted, subject=subject_of(single.loop))


def in_joint_variables(atlas: Atlas, readout: Readout) -> Atlas:
    """The atlas of the loop that a mechanism is, in the unknowns of the mechanism, which
    is the subject then. The forms keep their names, which count the joints round the
    loop, and their symmetries, which are those of the joint angles."""
    structure = readout.structure
    names = [unknown.label for unknown in structure.unknowns]
    recounted = _recount(atlas, to_loop_angles(readout).inverse, names)
    subject = mechanism_subject(readout.mechanism)
    subject["scale"] = structure.scales.tolist()
    return replace(recounted, subject=subject)


def _recount(atlas: Atlas, isometry: Isometry, names: Sequence[str]) -> Atlas:
    """The atlas in the new unknowns of an isometry, with the labels of the forms."""
    recounted = recount_atlas(atlas, isometry, names)
    forms = [_with_labels(form, isometry, atlas.periods) for form in recounted.forms]
    return replace(recounted, forms=tuple(forms))


def _with_labels(form: Form, isometry: Isometry, periods: np.ndarray) -> Form:
    """A form whose labels name the joints that stand still by the new unknowns of an
    isometry; ``periods`` (n,) are those of the old ones."""
    labels = FormLabels.of(form)
    angles = np.zeros(len(periods))
    still = [joint - 1 for joint in labels.inactive_joints]
    angles[still] = labels.inactive_angles
    recounted = wrap(isometry.points(angles), periods[isometry.columns])
    numbers = sorted(isometry.index(joint) for joint in still)
    values = replace(
        labels,
        inactive_joints=tuple(number + 1 for number in numbers),
        inactive_angles=tuple(float(recounted[number]) for number in numbers),
    )
    return replace(form, labels=values.as_values())
