"""What is written on the atlas of a mechanism: the unknowns that stand still along each
form, and the mechanism itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.decisions import unit_over_rounding
from bifurc.numerics.blur import change_by_rounding
from linkages.closure.mechanism_closure import MechanismClosure
from linkages.decisions import keeps_angle
from linkages.labels import FormLabels, largest_residual
from linkages.mechanisms.subject import mechanism_subject
from linkages.turns.translates import with_translates

SAMPLES = 400  # of a form, to see what stands still


def label_mechanism(atlas: Atlas, problem: MechanismClosure) -> Atlas:
    """The atlas with labels on its forms, and the mechanism as its subject."""
    names = [form.name for form in atlas.forms]
    labels = [_labels(problem, form.branch).as_values() for form in atlas.forms]
    named = atlas.renamed(names, labels)
    subject = mechanism_subject(problem.mechanism)
    # what unknowns are multiplied with to be in rad and in the user's unit
    subject["scale"] = problem.structure.scales.tolist()
    labelled = replace(named, subject=subject)
    return with_translates(labelled, problem.structure, problem.lattice)


def _labels(problem: MechanismClosure, branch: Branch) -> FormLabels:
    """The unknowns, from 1, that keep their values along a branch, these values, and
    the largest closure error."""
    samples = branch.sample(SAMPLES)
    deviation = np.abs(samples - samples.mean(axis=0)).max(axis=0)
    unit = unit_over_rounding(keeps_angle, change_by_rounding(problem, branch))
    still = np.flatnonzero(keeps_angle(deviation, unit))
    return FormLabels(
        inactive_joints=tuple(int(i) + 1 for i in still),
        inactive_angles=tuple(float(samples[0, i]) for i in still),
        max_residual=largest_residual(problem, branch),
    )
