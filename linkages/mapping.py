"""From a loop to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.numerics.blur import change_by_rounding
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.forms import FormIdentity, name_forms
from linkages.labels import subject_of
from linkages.linkage import Linkage
from linkages.loop import GeometryError, Loop

__all__ = ["largest_residual", "map_linkage", "name_atlas"]

DEFAULT_SEARCH = SearchSettings()

NAMING = 400  # samples of a form for its name
# where on every piece of a form its closure is checked
CLOSING = np.linspace(0.0, 1.0, 24, endpoint=False)


def map_linkage(
    linkage: Linkage | Loop,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    seed: int = 0,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """The transition map of a linkage: every form with its name, every bifurcation,
    every near miss.

    ``seed`` is that of the random starts; ``progress`` is called with what was found
    and how many. `linkages.labels.FormLabels` reads what a form is,
    `linkages.labels.loop_of` the loop that an atlas is of. Every form has its
    ``certificate``, unless the settings say otherwise. Raises `GeometryError` for
    anything but a linkage.
    """
    linkage = _as_linkage(linkage)
    problem = LoopClosure(linkage.loop)
    atlas = explore(problem, settings=settings, seed=seed, progress=progress)
    return name_atlas(atlas, linkage)


def name_atlas(atlas: Atlas, linkage: Linkage) -> Atlas:
    """The atlas of a linkage with the names of its forms, their labels, and the loop as
    its subject."""
    identities = _recognise(atlas, linkage)
    return _label(atlas, identities, LoopClosure(linkage.loop))


def largest_residual(problem: LoopClosure, branch: Branch) -> float:
    """The largest closure error at places all along a branch: the norm over rotation
    and translation."""
    lengths = np.diff(branch.breaks)
    places = branch.breaks[:-1, None] + lengths[:, None] * CLOSING
    residuals = problem.residuals(branch(places.ravel()))
    return float(np.linalg.norm(residuals, axis=1).max(initial=0.0))


def _as_linkage(linkage: Linkage | Loop) -> Linkage:
    if isinstance(linkage, Loop):
        return Linkage(linkage)
    if not isinstance(linkage, Linkage):
        allowed = "a `Linkage`, which `linkages.load` returns, or a `Loop`"
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
