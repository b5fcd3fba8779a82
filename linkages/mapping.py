"""From a loop to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from bifurc.numerics.blur import change_by_rounding
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.forms import FormIdentity, name_forms
from linkages.labels import largest_residual, subject_of
from linkages.linkage import Linkage
from linkages.loop import LARGEST, SMALLEST, Loop
from linkages.values import GeometryError

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

DEFAULT_SEARCH = SearchSettings()

NAMING = 400  # samples of a form for its name


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
    if isinstance(linkage, Loop):
        linkage = Linkage(linkage)
    if not isinstance(linkage, Linkage):
        mechanism = _as_mechanism(linkage)
        return _map_mechanism(mechanism, settings, seed, progress)
    _require_size(linkage.loop)
    problem = LoopClosure(linkage.loop)
    atlas = explore(problem, settings=settings, seed=seed, progress=progress)
    return name_atlas(atlas, linkage)


def _require_size(loop: Loop) -> None:
    size = loop.characteristic_length
    if not SMALLEST < size < LARGEST:
        allowed = f"between {SMALLEST:g} and {LARGEST:g}; choose another unit"
        raise GeometryError("characteristic length", f"{size:.1g}", allowed)


def _map_mechanism(
    mechanism: Mechanism,
    settings: SearchSettings,
    seed: int,
    progress: Callable[[str, int], None] | None,
) -> Atlas:
    """The transition map of a mechanism in its own unknowns: solved as that of its loop,
    where it is a single one of revolute joints."""
    # they import networkx, which a loop does not need
    from linkages.closure.mechanism_closure import MechanismClosure
    from linkages.networks.mechanism import (
        NetworkClosure,
        NetworkMechanism,
        network_subject,
    )
    from linkages.readout.loop_atlas import in_joint_variables
    from linkages.readout.mechanism_labels import label_mechanism
    from linkages.readout.readout import Readout

    readout = Readout(mechanism)
    single = readout.single_loop
    if single is not None:
        atlas = map_linkage(
            single.loop, settings=settings, seed=seed, progress=progress
        )
        return in_joint_variables(atlas, readout)
    if isinstance(mechanism, NetworkMechanism):
        problem: MechanismClosure = NetworkClosure(mechanism)
    else:
        problem = MechanismClosure(mechanism)
    atlas = explore(problem, settings=settings, seed=seed, progress=progress)
    labelled = label_mechanism(atlas, problem)
    if not isinstance(mechanism, NetworkMechanism):
        return labelled
    network = {"network": network_subject(mechanism)}
    return replace(labelled, subject={**labelled.subject, **network})


def name_atlas(atlas: Atlas, linkage: Linkage) -> Atlas:
    """The atlas of a linkage with the names of its forms, their labels, and the loop as
    its subject."""
    identities = _recognise(atlas, linkage)
    return _label(atlas, identities, LoopClosure(linkage.loop))


def _as_mechanism(linkage: object) -> Mechanism:
    """What is neither a linkage nor a loop, as a mechanism; raises `GeometryError`."""
    from linkages.mechanisms.mechanism import Mechanism

    if not isinstance(linkage, Mechanism):
        allowed = (
            "what `linkages.load` returns, a `Linkage` or a `Mechanism`, or a `Loop`"
        )
        raise GeometryError("linkage", repr(linkage), allowed)
    return linkage


def _recognise(atlas: Atlas, linkage: Linkage) -> list[FormIdentity]:
    """What every form is, from samples along it."""
    problem = LoopClosure(linkage.loop)
    samples = [form.branch.sample(NAMING) for form in atlas.forms]
    changes = [change_by_rounding(problem, form.branch) for form in atlas.forms]
    return name_forms(samples, linkage.loop, linkage.patterns, changes)


def _label(atlas: Atlas, identities: list[FormIdentity], problem: LoopClosure) -> Atlas:
    """The atlas with the names of its forms, their labels, and the loop as its
    subject."""
    names = []
    labels = []
    for form, identity in zip(atlas.forms, identities, strict=True):
        residual = largest_residual(problem, form.branch)
        names.append(identity.name)
        labels.append(replace(identity.labels, max_residual=residual).as_values())
    named = atlas.renamed(names, labels)
    return replace(named, subject=subject_of(problem.loop))
