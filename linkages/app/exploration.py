"""Exploring a linkage for a command: with its settings, and with signs of life."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bifurc.atlas import Atlas
from linkages.app.answer.verdict import judge
from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.options import SearchOptions
from linkages.app.status import StatusLine
from linkages.linkage import Linkage
from linkages.mapping import map_linkage

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism


def explore_linkage(linkage: Linkage | Mechanism, search: SearchOptions) -> Atlas:
    """The transition map of a linkage or a mechanism; progress is shown on standard error.

    Ctrl-C ends the search early, and the atlas holds what was found by then. Raises
    `bifurc.ProblemError` for settings out of their range.
    """
    settings = search.settings()
    status = StatusLine()
    try:
        return map_linkage(
            linkage,
            settings=settings,
            seed=search.seed,
            progress=status,
        )
    finally:
        status.wipe()


def require_uninterrupted(atlas: Atlas) -> None:
    """Raise `CommandError` where Ctrl-C ended the search: half a map is of no use to
    the command."""
    if atlas.provenance.interrupted:
        raise CommandError(judge(atlas).sentence, ExitCode.INTERRUPTED)
