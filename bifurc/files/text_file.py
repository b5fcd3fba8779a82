"""Reading text and TOML from files that may hold anything."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bifurc.errors import BifurcError

ENCODING = "utf-8-sig"  # editors of Windows begin a file with a mark, which is no text


class TextFileError(BifurcError, ValueError):
    """A file that cannot be read: ``path`` and the ``reason``, which follows the name
    of the file in a sentence."""

    def __init__(self, path: Path, reason: str):
        self.path = path
        self.reason = reason
        super().__init__(f"{path}: {reason}")


def read_text(path: Path) -> str:
    """The text in a file; raises `TextFileError`."""
    if path.is_dir():
        raise TextFileError(path, "is a folder, and not a file")
    try:
        return path.read_text(encoding=ENCODING)
    except FileNotFoundError:
        raise TextFileError(path, "there is no such file") from None
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
