"""The atlas that a command line names: a saved one, or that of a linkage."""

from __future__ import annotations

from collections.abc import Sequence

from bifurc.atlas import Atlas
from linkages.app.atlas_file import open_linkage_atlas
from linkages.app.choice import choose_linkage, require_loop
from linkages.app.exit_codes import CommandError
from linkages.app.exploration import explore_linkage, require_uninterrupted
from linkages.app.options import SearchOptions
from linkages.labels import loop_of

__all__ = ["atlas_of", "is_atlas_file", "loop_atlas_of"]

ATLAS_FILE = ".nc"  # how the name of a saved atlas ends


def is_atlas_file(source: str) -> bool:
    """Whether ``source`` names a saved atlas."""
    return source.endswith(ATLAS_FILE)


def atlas_of(source: str, parameters: Sequence[str], search: SearchOptions) -> Atlas:
    """The saved atlas, or that of the linkage, called ``source``.

    Raises `CommandError` for parameters of a saved atlas, or options of its search, and
    where Ctrl-C ended the search.
    """
    if is_atlas_file(source):
        if parameters:
            raise CommandError("--param: it has no effect on a saved atlas")
        if search != SearchOptions():
            raise CommandError(
                "--starts, --seed, --tolerance, --budget: they have no effect on a "
                "saved atlas, which is not searched again"
            )
        return open_linkage_atlas(source)
    atlas = explore_linkage(choose_linkage(source, parameters), search)
    require_uninterrupted(atlas)
    return atlas


def loop_atlas_of(
    source: str, parameters: Sequence[str], search: SearchOptions
) -> Atlas:
    """The saved atlas, or that of the linkage, called ``source``, where it is a single
    loop of revolute joints; raises `CommandError` for a mechanism as well."""
    if not is_atlas_file(source):
        require_loop(source, choose_linkage(source, parameters))
    atlas = atlas_of(source, parameters, search)
    loop_of(atlas)
    return atlas
