"""The saved atlas of a linkage that a command line names."""

from __future__ import annotations

from bifurc.atlas import Atlas
from bifurc.files.dataset import load_atlas
from linkages.app.exit_codes import CommandError
from linkages.app.subject import subject_at
from linkages.labels import NoLinkageError


def open_linkage_atlas(path: str) -> Atlas:
    """The atlas of a linkage in a file. Raises `bifurc.AtlasFileError` for a file that
    holds no atlas, and `CommandError` for one that holds another, or is not there."""
    try:
        atlas = load_atlas(path)
    except FileNotFoundError:
        raise CommandError(f"{path}: there is no such file") from None
    try:
        subject_at(atlas)
    except NoLinkageError as error:
        raise CommandError(f"{path}: {error}") from None
    return atlas
