"""What can be done next with the linkage of an atlas, as commands to type."""

from __future__ import annotations

import shlex
from pathlib import Path

from bifurc.atlas import Atlas
from bifurc.completeness import Level
from bifurc.errors import RouteError
from linkages.app.answer.verdict import judge, rounding_of
from linkages.app.exit_codes import ExitCode
from linkages.app.options import AtlasOptions
from linkages.subject import subject_at
from linkages.values import GeometryError

MOST = 3  # steps that are named
LONGER = 10  # times a budget that was not enough
EXACT = "exact.toml"  # the exact linkage of a table


def next_steps(
    atlas: Atlas, linkage: str, choice: AtlasOptions, has_files: bool
) -> str:
    """Up to three commands for the ``linkage`` as it was named and chosen, a line each;
    ``has_files``: figures and page are written already."""
    chosen = _chosen(linkage, choice)
    table_steps = _about_the_table(atlas, chosen, has_files)
    return _lines([*table_steps, *_steps(atlas, chosen, has_files)])


def next_steps_of_nearest(
    atlas: Atlas, linkage: str, choice: AtlasOptions, out: Path | None
) -> str:
    """The same after the map of the exact linkage that the table of ``linkage`` is meant
    to be, whose forms have the names of the source only there: for the map in ``out``, or
    for a file that is first to be written."""
    if out is not None:
        return _lines(_routes(atlas, shlex.quote(str(out / "atlas.nc"))))
    identify = f"bifurc identify {_chosen(linkage, choice)} --write {EXACT}"
    return _lines([identify, *_drawings(EXACT)])


def _lines(steps: list[str]) -> str:
    return "\n".join(f"next: {step}" for step in steps[:MOST])


def _chosen(linkage: str, choice: AtlasOptions) -> str:
    """A linkage as it was named, with the options that choose it, to be typed."""
    words = [linkage]
    for one in choice.parameters:
        words += ["--param", one]
    for option in choice.hold.arguments:
        words += option
    return shlex.join(words)


def _steps(atlas: Atlas, chosen: str, has_files: bool) -> list[str]:
    """What can be done with any linkage."""
    steps = []
    if atlas.completeness.level is Level.OUT_OF_TIME:
        longer = LONGER * atlas.provenance.settings.budget
        steps.append(f"bifurc map {chosen} --budget {longer:g}")
    steps += _routes(atlas, chosen)
    return steps if has_files else [*steps, *_drawings(chosen)]


def _drawings(chosen: str) -> list[str]:
    return [f"bifurc map {chosen} --out DIR", f"bifurc view {chosen}"]


def _about_the_table(atlas: Atlas, chosen: str, has_files: bool) -> list[str]:
    """Where nothing moves: to find what a table is meant to be."""
    if judge(atlas).code is not ExitCode.DOES_NOT_MOVE:
        return []
    try:
        subject_at(atlas).as_loop()
    except GeometryError:
        return []
    if not rounding_of(atlas):
        return [f"bifurc identify {chosen}"]
    mapped = " --out DIR" if has_files else ""
    return [
        f"bifurc map {chosen} --nearest{mapped}",
        f"bifurc identify {chosen} --write {EXACT}",
    ]


def _routes(atlas: Atlas, chosen: str) -> list[str]:
    """From one form to another that meets it."""
    for point in atlas.bifurcations:
        forms = sorted({form for form, _ in point.passes})
        if len(forms) > 1:
            both = [_short_name(atlas, form) for form in forms[:2]]
            return [f"bifurc route {chosen} {both[0]} {both[1]}"]
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
