"""The saved atlas of a linkage that a command line names."""

from __future__ import annotations

from pathlib import Path

from bifurc.atlas import Atlas
from bifurc.files.dataset import AtlasFileError, load_atlas
from linkages.app.exit_codes import CommandError
from linkages.app.linkage_atlas import loop_of

__all__ = ["open_linkage_atlas"]

# a damaged file can make a reader stumble anywhere
STUMBLES = (
    ArithmeticError,
    AttributeError,
    LookupError,
    RuntimeError,
    TypeError,
    ValueError,
)


def open_linkage_atlas(path: str) -> Atlas:
    """The atlas of a linkage in a file; raises `CommandError` for any other file."""
    if Path(path).is_dir():
        raise CommandError(f"{path}: it is a folder, not a saved atlas")
    try:
        atlas = load_atlas(path)
    except FileNotFoundError:
        raise CommandError(f"{path}: there is no such file") from None
    except AtlasFileError:
        raise
    except STUMBLES as error:
        raise CommandError(f"{path}: the file is damaged ({error})") from None
    try:
        loop_of(atlas)
    except CommandError as error:
        raise CommandError(f"{path}: {error}") from None
    return atlas
