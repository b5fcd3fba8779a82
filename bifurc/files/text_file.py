"""Reading text and TOML from files that may hold anything."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bifurc.errors import BifurcError

NEAREST = 3  # names that are shown where there is no file of a name
ENCODING = "utf-8-sig"  # editors of Windows begin a file with a mark, which is no text


class TextFileError(BifurcError, ValueError):
    """A file that cannot be read: ``path`` and the ``reason``, which follows the name
    of the file in a sentence."""

    def __init__(self, path: Path, reason: str):
        self.path = path
        self.reason = reason
        super().__init__(f"{path}: {reason}")


def missing_file(path: Path) -> str:
    """That a file is not there, with the names of its folder that are most like its."""
    try:
        names = [other.name for other in path.parent.iterdir()]
    except OSError:  # no folder, or one that cannot be listed
        names = []
    near = difflib.get_close_matches(path.name, names, NEAREST)
    hint = f"; the nearest here: {', '.join(near)}" if near else ""
    return f"there is no such file{hint}"


def read_text(path: Path) -> str:
    """The text in a file; raises `TextFileError`."""
    if path.is_dir():
        raise TextFileError(path, "is a folder, and not a file")
    try:
        return path.read_text(encoding=ENCODING)
    except FileNotFoundError:
        raise TextFileError(path, missing_file(path)) from None
    except OSError as error:
        raise TextFileError(path, f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        reason = f"is not UTF-8 text: byte {error.start} is wrong"
        raise TextFileError(path, reason) from None


def read_toml(
    path: Path, parse_float: Callable[[str], Any] = float
) -> dict[str, object]:
    """What a TOML file holds, decimals as ``parse_float`` reads them; raises
    `TextFileError`."""
    text = read_text(path)
    try:
        return tomllib.loads(text, parse_float=parse_float)
    except RecursionError:
        reason = "is not valid TOML: its lists are too deep inside each other"
        raise TextFileError(path, reason) from None
    # TOMLDecodeError, which tells line and column, or an integer of over 4300 digits
    except ValueError as error:
        raise TextFileError(path, f"is not valid TOML: {error}") from None
