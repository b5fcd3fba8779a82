"""From a loop to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.search.certify_atlas import certify_atlas
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings
from linkages.closure.loop_closure import LoopClosure
from linkages.forms import name_forms
from linkages.linkage import Linkage
from linkages.loop import Loop

__all__ = ["largest_residual", "map_linkage"]

DEFAULT_SEARCH = SearchSettings()

NAMING = 400  # samples of a form for its name
CLOSING = np.linspace(
    0.0, 1.0, 24, endpoint=False
)  # where on every piece of a form its closure is checked


def map_linkage(
    linkage: Linkage | Loop,
    *,
    settings: SearchSettings = DEFAULT_SEARCH,
    certify: bool = False,
    seed: int = 0,
    progress: Callable[[str, int], None] | None = None,
) -> Atlas:
    """The transition map of a linkage: every form with its name, every bifurcation,
    every near miss.

    ``seed`` is that of the random starts; ``progress`` is called with what was found
    and how many. ``labels`` of a form hold its ``inactive_joints`` (from 1) and their
    ``inactive_angles`` (rad), its ``symmetry``, and ``max_residual``, the largest
    closure error seen along it relative to the characteristic length;
    the ``subject`` of the atlas holds the geometry, twists in rad. With ``certify``
    every form has its ``certificate``.
    """
    if isinstance(linkage, Loop):
        linkage = Linkage(linkage)
    loop = linkage.loop
    problem = LoopClosure(loop)
    atlas = explore(problem, settings=settings, seed=seed, progress=progress)
    samples = [form.branch.sample(NAMING) for form in atlas.forms]
    identities = name_forms(samples, loop, linkage.patterns)
    labels = [
        {
            "inactive_joints": list(identity.inactive_joints),
            "inactive_angles": list(identity.inactive_angles),
            "symmetry": identity.symmetry,
            "max_residual": largest_residual(problem, form.branch),
        }
        for identity, form in zip(identities, atlas.forms, strict=True)
    ]
    lengths, twists, offsets = (values.tolist() for values in loop.arrays)
    geometry = {
        "name": loop.name,
        "lengths": lengths,
        "twists": twists,
        "offsets": offsets,
    }
    named = atlas.renamed([identity.name for identity in identities], labels)
    named = replace(named, subject=geometry)
    return certify_atlas(problem, named) if certify else named


def largest_residual(problem: LoopClosure, branch: Branch) -> float:
    """The largest closure error at places all along a branch: the norm over rotation
    and translation."""
    places = branch.breaks[:-1, None] + np.diff(branch.breaks)[:, None] * CLOSING
    return float(
        np.linalg.norm(problem.residuals(branch(places.ravel())), axis=1).max(
            initial=0.0
        )
    )
