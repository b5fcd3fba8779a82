"""The atlas of equations in a file that a command line names, with other constants. It
imports nothing of linkages, which equations do not need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkages.app.exit_codes import CommandError
from linkages.app.options import SearchOptions
from linkages.app.output import StatusLine

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from bifurc.systems.equation_file import EquationSystem


def read_constants(texts: Sequence[str]) -> dict[str, float]:
    """The constants of equations in "key=value"; raises `CommandError`."""
    values = {}
    for text in texts:
        key, equals, number = text.partition("=")
        try:
            value = float(number)
        except ValueError:
            equals = ""
        if not equals or not key.strip():
            raise CommandError(f"--param {text}: it must be KEY=NUMBER")
        if key.strip() in values:
            raise CommandError(f"--param {text}: {key.strip()} is given twice")
        values[key.strip()] = value
    return values


def explore_system(system: EquationSystem, search: SearchOptions) -> Atlas:
    """The atlas of a system of equations; progress is shown on standard error."""
    settings = search.settings()
    with StatusLine() as status:
        return system.explore(settings=settings, seed=search.seed, progress=status)
