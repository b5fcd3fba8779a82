"""What can be done next with what a command answered on, as commands to type."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from bifurc.atlas import Atlas
from bifurc.completeness import Level
from bifurc.errors import RouteError
from linkages.app.exit_codes import ExitCode
from linkages.app.options import AtlasOptions, HoldOptions

LONGER = 10  # times a budget that was not enough
MORE_STARTS = 2000  # random ones, where the usual number has met no curve
EXACT = "exact.toml"  # the exact linkage of a table


def next_steps(
    atlas: Atlas, linkage: str, choice: AtlasOptions, has_files: bool
) -> list[str]:
    """Commands for the ``linkage`` as it was named and chosen, the first one first;
    ``has_files``: figures and page are written already."""
    chosen = chosen_linkage(linkage, choice.parameters, choice.hold)
    table_steps = _about_the_table(atlas, chosen, has_files)
    return [*table_steps, *_steps(atlas, chosen, has_files)]


def next_steps_of_nearest(
    atlas: Atlas, linkage: str, choice: AtlasOptions, out: Path | None
) -> list[str]:
    """The same after the map of the exact linkage that the table of ``linkage`` is meant
    to be, whose forms have the names of the source only there: for the map in ``out``, or
    for a file that is first to be written."""
    if out is not None:
        return _routes(atlas, shlex.quote(str(out / "atlas.nc")))
    chosen = chosen_linkage(linkage, choice.parameters, choice.hold)
    return [f"bifurc identify {chosen} --write {EXACT}", *_drawings(EXACT)]


def steps_after_solving(
    atlas: Atlas, file: str, parameters: Sequence[str], has_files: bool
) -> list[str]:
    """After the solution curves of the equations in a ``file``."""
    command = f"bifurc solve {chosen_linkage(file, parameters)}"
    steps = []
    if atlas.completeness.level is Level.OUT_OF_TIME:
        steps.append(f"{command} --budget {_longer_budget(atlas):g}")
    elif not (atlas.forms or atlas.surfaces):
        steps.append(f"{command} --starts {MORE_STARTS}")
    return steps if has_files else [*steps, f"{command} --out DIR"]


def steps_after_identifying(
    chosen: str, names: Sequence[str], is_corrected: bool, out: Path | None
) -> list[str]:
    """After it was said which linkages, called ``names``, a table is a case of, or what
    it is meant to be, ``is_corrected``, with the exact table written to ``out``."""
    if out is not None:
        return [f"bifurc map {shlex.quote(str(out))}"]
    if names:
        return [f"bifurc show {names[0]}", f"bifurc map {chosen}"]
    if is_corrected:
        exact = f"bifurc identify {chosen} --write {EXACT}"
        return [exact, f"bifurc map {chosen} --nearest"]
    return [f"bifurc map {chosen}"]


def steps_after_a_route(chosen: str, start: str, goal: str) -> list[str]:
    """After the ways between two forms."""
    way = f"--route {shlex.join([start, goal])}"
    return [
        f"bifurc animate {chosen} {way} --out route.gif",
        f"bifurc export {chosen} {way} --to route.glb",
    ]


def steps_with_members(
    command: str, name: str, texts: Sequence[str], value: str = ""
) -> str:
    """A command for a family with the same parameters; with a ``value`` of the free one,
    for the member that has it."""
    free = [text for text in texts if "=" not in text or ":" in text]
    if value:
        fixed = [text for text in texts if text not in free]
        texts = [*fixed, f"{free[0].partition('=')[0]}={value}"]
    return f"bifurc {command} {chosen_linkage(name, texts)}"


def chosen_linkage(
    linkage: str, parameters: Sequence[str], hold: HoldOptions | None = None
) -> str:
    """A linkage as it was named, with the options that choose it, to be typed."""
    words = [linkage]
    for one in parameters:
        words += ["--param", one]
    for option in hold.arguments if hold else ():
        words += option
    return shlex.join(words)


def _longer_budget(atlas: Atlas) -> float:
    return LONGER * atlas.provenance.settings.budget


def _steps(atlas: Atlas, chosen: str, has_files: bool) -> list[str]:
    """What can be done with any linkage."""
    steps = []
    if atlas.completeness.level is Level.OUT_OF_TIME:
        steps.append(f"bifurc map {chosen} --budget {_longer_budget(atlas):g}")
    steps += _routes(atlas, chosen)
    return steps if has_files else [*steps, *_drawings(chosen)]


def _drawings(chosen: str) -> list[str]:
    return [f"bifurc map {chosen} --out DIR", f"bifurc view {chosen}"]


def _about_the_table(atlas: Atlas, chosen: str, has_files: bool) -> list[str]:
    """Where nothing moves: to find what a table is meant to be."""
    # equations need none of these
    from linkages.app.answer.verdict import judge, rounding_of
    from linkages.subject import subject_at
    from linkages.values import GeometryError

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
