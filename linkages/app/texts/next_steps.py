"""What can be done next with the linkage of an atlas, as commands to type."""

from __future__ import annotations

import shlex

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from linkages.app.answer.verdict import rounding_of
from linkages.app.options import AtlasOptions
from linkages.subject import subject_at
from linkages.values import GeometryError

MOST = 3  # steps that are named


def next_steps(
    atlas: Atlas, linkage: str, choice: AtlasOptions, has_files: bool
) -> str:
    """Up to three commands for the ``linkage`` as it was named and chosen, a line each;
    ``has_files``: figures and page are written already."""
    options = [f"--param {shlex.quote(one)}" for one in choice.parameters]
    options += [f"--lock {shlex.quote(lock)}" for lock in choice.hold.locks]
    if choice.hold.driver:
        options.append(f"--drive {shlex.quote(choice.hold.driver)}")
    if choice.hold.is_without_centre:
        options.append("--without-centre")
    name = shlex.quote(linkage)
    steps = [
        *_about_the_table(atlas, name, has_files),
        *_routes(atlas, name),
    ]
    if not has_files:
        steps += [f"bifurc map {name} --out DIR", f"bifurc view {name}"]
    lines = [" ".join([step, *options]) for step in steps[:MOST]]
    return "\n".join(f"next: {line}" for line in lines)


def _about_the_table(atlas: Atlas, name: str, has_files: bool) -> list[str]:
    """Where nothing moves: to find what a table is meant to be."""
    if atlas.forms or atlas.surfaces:
        return []
    try:
        subject_at(atlas).as_loop()
    except GeometryError:
        return []
    if not rounding_of(atlas):
        return [f"bifurc identify {name}"]
    mapped = " --out DIR" if has_files else ""
    return [
        f"bifurc map {name} --nearest{mapped}",
        f"bifurc identify {name} --write exact.toml",
    ]


def _routes(atlas: Atlas, name: str) -> list[str]:
    """From one form to another that meets it."""
    for point in atlas.bifurcations:
        forms = sorted({form for form, _ in point.passes})
        if len(forms) > 1:
            both = [_short_name(atlas, form) for form in forms[:2]]
            return [f"bifurc route {name} {both[0]} {both[1]}"]
    return []


def _short_name(atlas: Atlas, index: int) -> str:
    """The name of a form up to its brackets, where no other one begins so."""
    full = atlas.forms[index].name
    short = full.partition(" (")[0]
    try:
        is_clear = atlas.form(short) == index
    except RouteError:
        is_clear = False
    return shlex.quote(short if is_clear else full)
