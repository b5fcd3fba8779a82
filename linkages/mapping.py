"""From a loop to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.decisions import unit_over_rounding
from bifurc.numerics.blur import change_by_rounding
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.decisions import keeps_angle
from linkages.forms import name_forms
from linkages.labels import FormLabels, largest_residual, subject_of
from linkages.linkage import Linkage
from linkages.loop import LARGEST, SMALLEST, Loop
from linkages.values import GeometryError

if TYPE_CHECKING:
    from linkages.closure.mechanism_closure import MechanismClosure
    from linkages.mechanisms.mechanism import Mechanism

DEFAULT_SEARCH = SearchSettings()

SAMPLES = 400  # of a form, to name it and to see what stands still


def map_linkage(
    linkage: Linkage | Loop | Mechanism,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    seed: int = 0,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """The transition map of a linkage or a mechanism: every form with its name, every
    bifurcation, every near miss.

    ``seed`` is that of the random starts; ``progress`` is called with what was found
    and how many. `linkages.labels.FormLabels` reads what a form is,
    `linkages.labels.loop_of` the loop that an atlas is of, and
    `linkages.readout.readout.Readout` the joint variables of a mechanism, also of
    one that is a single loop. Every form
    has its ``certificate``, unless the settings say otherwise. Raises `GeometryError`
    for anything but a linkage or a mechanism, and for a loop with lengths whose squares
    leave the range of doubles.
    """
    search = partial(explore, settings=settings, seed=seed, progress=progress)
    if isinstance(linkage, Loop):
        linkage = Linkage(linkage)
    if isinstance(linkage, Linkage):
        return _map_loop(linkage, search)
    return _map_mechanism(linkage, search)


def _map_loop(linkage: Linkage, search: Callable[..., Atlas]) -> Atlas:
    size = linkage.loop.characteristic_length
    if not SMALLEST < size < LARGEST:
        allowed = f"between {SMALLEST:g} and {LARGEST:g}; choose another unit"
        raise GeometryError("characteristic length", f"{size:.1g}", allowed)
    return name_atlas(search(LoopClosure(linkage.loop)), linkage)


def _map_mechanism(mechanism: Mechanism, search: Callable[..., Atlas]) -> Atlas:
    """The transition map of a mechanism in its own unknowns: solved as that of its loop,
    where it is a single one of revolute joints."""
    # they import networkx, which a loop does not need
    from linkages.closure.mechanism_closure import MechanismClosure
    from linkages.mechanisms.mechanism import Mechanism
    from linkages.readout.loop_atlas import in_joint_variables
    from linkages.readout.readout import Readout

    if not isinstance(mechanism, Mechanism):
        allowed = (
            "what `linkages.load` returns, a `Linkage` or a `Mechanism`, or a `Loop`"
        )
        raise GeometryError("linkage", repr(mechanism), allowed)
    readout = Readout(mechanism)
    if readout.single_loop is not None:
        atlas = _map_loop(Linkage(readout.single_loop.loop), search)
        return in_joint_variables(atlas, readout)
    closure = MechanismClosure(mechanism, structure=readout.structure)
    return _label_mechanism(search(closure), closure)


def name_atlas(atlas: Atlas, linkage: Linkage) -> Atlas:
    """The atlas of a linkage with the names of its forms, their labels, and the loop as
    its subject."""
    problem = LoopClosure(linkage.loop)
    branches = [form.branch for form in atlas.forms]
    samples = [branch.sample(SAMPLES) for branch in branches]
    changes = [change_by_rounding(problem, branch) for branch in branches]
    identities = name_forms(samples, linkage.loop, linkage.patterns, changes)
    labels = []
    for branch, identity in zip(branches, identities, strict=True):
        residual = largest_residual(problem, branch)
        labels.append(replace(identity.labels, max_residual=residual).as_values())
    named = atlas.renamed([identity.name for identity in identities], labels)
    return replace(named, subject=subject_of(linkage.loop))


def _label_mechanism(atlas: Atlas, problem: MechanismClosure) -> Atlas:
    """The atlas with labels on its forms, and the mechanism as its subject."""
    from linkages.mechanisms.subject import mechanism_subject
    from linkages.turns.translates import with_translates

    names = [form.name for form in atlas.forms]
    labels = [_labels(problem, form.branch).as_values() for form in atlas.forms]
    subject = mechanism_subject(problem.mechanism)
    # what unknowns are multiplied with to be in rad and in the user's unit
    subject["scale"] = problem.structure.scales.tolist()
    labelled = replace(atlas.renamed(names, labels), subject=subject)
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
