"""An atlas with what is said of its forms: names, joints that stand still, closure; and
the same of a mechanism that is a single loop of revolute joints.

Its map is made in the angles of the loop's Denavit-Hartenberg table, and stated in the
variables of the joints, as that of every mechanism: they are these angles in another
order, with other signs, and counted from the reference configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.branch import Branch
from bifurc.completeness import Claim, Scope
from bifurc.decisions import unit_over_rounding
from bifurc.isometry import Isometry, recount_atlas
from bifurc.limits import made_in_time
from bifurc.numerics.blur import blur_along, change_by_blur
from bifurc.problem import Problem
from bifurc.torus import wrap
from linkages.closure.system import ClosureSystem
from linkages.decisions import keeps_angle
from linkages.entry import Linkage
from linkages.forms import FormIdentity, name_forms
from linkages.labels import FormLabels, largest_residual, subject_of
from linkages.statements import LinkageClaim

SAMPLES = 160  # of a form, to name it and to see what stands still


def name_atlas(atlas: Atlas, linkage: Linkage) -> Atlas:
    """The atlas of a linkage with the names of its forms, their labels, and the loop as
    its subject; where there is no time for names it says so."""
    named = made_in_time(lambda: _named(atlas, linkage)) or _unnamed(atlas)
    return replace(named, subject=subject_of(linkage.loop))


def _named(atlas: Atlas, linkage: Linkage) -> Atlas:
    problem = ClosureSystem(linkage.loop)
    branches = [form.branch for form in atlas.forms]
    samples = [branch.sample(SAMPLES) for branch in branches]
    changes = [change_by_blur(blur_along(problem, branch)) for branch in branches]
    identities = name_forms(samples, linkage.loop, linkage.patterns, changes)
    labels = []
    for branch, identity in zip(branches, identities, strict=True):
        residual = largest_residual(problem, branch)
        labels.append(replace(identity.labels, max_residual=residual).as_values())
    named = atlas.renamed([identity.name for identity in identities], labels)
    return _saying(named, *nearly_symmetric(identities))


def nearly_symmetric(identities: Sequence[FormIdentity]) -> list[Claim]:
    """The claim that forms have their symmetries only nearly, where some do."""
    missed = [one.asymmetry for one in identities if one.asymmetry]
    if not missed:
        return []
    kind = LinkageClaim.NEARLY_SYMMETRIC
    return [kind.claim(Scope.MOTIONS, None, forms=len(missed), missed=max(missed))]


def _unnamed(atlas: Atlas) -> Atlas:
    """The atlas, with a word that its forms have numbers only."""
    return _saying(atlas, LinkageClaim.UNNAMED.claim(Scope.MOTIONS, None))


def _saying(atlas: Atlas, *more: Claim) -> Atlas:
    claims = (*atlas.completeness.claims, *more)
    return replace(atlas, completeness=replace(atlas.completeness, claims=claims))


def label_atlas(
    atlas: Atlas, problem: ClosureSystem, subject: Mapping[str, Any]
) -> Atlas:
    """The atlas of a mechanism with labels on its forms, and what is its ``subject``;
    where there is no time for labels, and for what differs by whole turns, it says so."""
    from linkages.turns.translates import with_translates
    from linkages.turns.turn_lattice import have_room_for_turns

    known = replace(atlas, subject=dict(subject))

    def labelled() -> Atlas:
        names = [form.name for form in atlas.forms]
        labels = [_labels(problem, form.branch).as_values() for form in atlas.forms]
        named = known.renamed(names, labels)
        if not have_room_for_turns(problem.structure):
            return named
        return with_translates(named, problem.structure, problem.lattice)

    return made_in_time(labelled) or _unnamed(known)


def _labels(problem: Problem, branch: Branch) -> FormLabels:
    """The unknowns, from 1, that keep their values along a branch, these values, and
    the largest closure error."""
    samples = branch.sample(SAMPLES)
    deviation = np.abs(samples - samples.mean(axis=0)).max(axis=0)
    unit = unit_over_rounding(keeps_angle, change_by_blur(blur_along(problem, branch)))
    still = np.flatnonzero(keeps_angle(deviation, unit))
    return FormLabels(
        inactive_joints=tuple(int(i) + 1 for i in still),
        inactive_angles=tuple(float(samples[0, i]) for i in still),
        max_residual=largest_residual(problem, branch),
    )


def recount_labelled(
    atlas: Atlas, isometry: Isometry, names: Sequence[str], subject: Mapping[str, Any]
) -> Atlas:
    """The atlas in the new unknowns of an isometry, with the labels of the forms, of
    another ``subject``. The forms keep their names and their symmetries, which are those
    of the joint angles round the loop."""
    recounted = recount_atlas(atlas, isometry, names)
    forms = [_recount_labels(form, isometry, atlas.periods) for form in recounted.forms]
    return replace(recounted, forms=tuple(forms), subject=dict(subject))


def _recount_labels(form: Form, isometry: Isometry, periods: np.ndarray) -> Form:
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
