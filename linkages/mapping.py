"""From a loop to its transition map, with the forms recognised and named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.curves.certificate import certify_atlas
from bifurc.search.explore import explore
from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.entry import FormPattern
from linkages.forms import name_forms
from linkages.loop import Loop

__all__ = ["map_by_name", "map_linkage"]

NAMING = 400  # samples of a form for its name
CLOSING = np.linspace(
    0.0, 1.0, 24, endpoint=False
)  # where on every piece of a form its closure is checked


def map_linkage(
    loop: Loop,
    patterns: Sequence[FormPattern] = (),
    *,
    certify: bool = False,
    prove: bool = True,
    **options: Any,
) -> Atlas:
    """The transition map of a loop: every form with its name, every bifurcation, every
    near miss.

    ``patterns`` are the forms that a source names, ``options`` those of
    `bifurc.search.explore.explore` (``starts``, ``seed``, ``settings``, ``budget``,
    ``progress``). ``labels`` of a form hold its ``inactive_joints`` (from 1) and their
    ``inactive_angles`` (rad), its ``symmetry``, and ``max_residual``, the largest
    closure error seen along it relative to the characteristic length;
    ``info["linkage"]`` of the atlas the geometry, twists in rad. With ``certify`` they
    also hold the ``certificate`` of `bifurc.curves.certificate`. With ``prove`` it is
    looked into whether a form can be missing (`linkages.slices.completeness`).
    """
    problem = LoopClosure(loop)
    atlas = explore(problem, prove=prove, **options)
    identities = name_forms(
        [form.branch.sample(NAMING) for form in atlas.forms], loop, patterns
    )
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
    linkage = {
        "name": loop.name,
        "lengths": lengths,
        "twists": twists,
        "offsets": offsets,
    }
    named = atlas.renamed([identity.name for identity in identities], labels)
    named = replace(named, info={**atlas.info, "linkage": linkage})
    return certify_atlas(problem, named) if certify else named


def map_by_name(
    name: str, *, starts: int = 200, seed: int = 0, **parameters: Any
) -> Atlas:
    """The transition map of a linkage of the catalogue, its parameters (rad) at their
    defaults unless given.

    Raises `linkages.catalogue.UnknownLinkageError`, and `linkages.loop.GeometryError`
    for parameters that make no linkage.
    """
    found = entry(name)
    values = found.complete(parameters)
    patterns = found.patterns(**values) if found.patterns is not None else ()
    return map_linkage(found.build(**values), patterns, starts=starts, seed=seed)


def largest_residual(problem: LoopClosure, branch: Branch) -> float:
    """The largest closure error at places all along a branch: the norm over rotation
    and translation."""
    places = branch.breaks[:-1, None] + np.diff(branch.breaks)[:, None] * CLOSING
    return float(
        np.linalg.norm(problem.residuals(branch(places.ravel())), axis=1).max(
            initial=0.0
        )
    )
