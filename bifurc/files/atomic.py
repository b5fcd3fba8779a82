"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

HIDDEN = ".writing-"  # how the names of the temporary folders begin
LEFT = 86400.0  # s, after which such a folder is no longer being written
Writer = Callable[[Path], object]


def replace_file(path: str | os.PathLike[str], write: Writer) -> Path:
    """The path of the file that ``write`` has just made; an older file is replaced.

    ``write`` gets the path of a temporary file of the same name, in a hidden folder
    beside ``path``. Whatever goes wrong, Ctrl-C included, the older file stays and the
    temporary one goes. Raises `OSError` that names ``path``.
    """
    target = Path(path)
    _check_folder(target.parent)
    _check_target(target)
    with _errors_about(target), _hidden_folder(target.parent) as stage:
        part = Path(stage) / target.name
        write(part)
        _flush(part)
        os.replace(part, target)
    return target


def require_replaceable(path: str | os.PathLike[str]) -> None:
    """Make sure that `replace_file` can make ``path``, which is left alone; raises
    `OSError` that names it."""
    target = Path(path)
    _check_folder(target.parent)
    _check_target(target)
    with _errors_about(target), _hidden_folder(target.parent):
        pass


def replace_files(folder: str | os.PathLike[str], write: Writer) -> list[Path]:
    """The paths of the files that ``write`` has just made in ``folder``, all or none.

    ``write`` gets a hidden folder inside ``folder``, whose files move to ``folder``
    when all are complete. Raises `OSError` that names ``folder``.
    """
    goal = Path(folder)
    _check_folder(goal)
    with _errors_about(goal), _hidden_folder(goal) as stage:
        write(Path(stage))
        parts = sorted(Path(stage).iterdir())
        targets = [goal / part.name for part in parts]
        for part, target in zip(parts, targets, strict=True):
            _check_target(target)
            _flush(part)
        for part, target in zip(parts, targets, strict=True):
            os.replace(part, target)
    return targets


def _hidden_folder(folder: Path) -> tempfile.TemporaryDirectory[str]:
    """A new folder on the same disk, so that its files can be renamed into place; what
    programs left there that were killed long ago goes."""
    for other in folder.glob(f"{HIDDEN}*"):
        try:
            if time.time() - other.stat().st_mtime > LEFT:
                shutil.rmtree(other)
        except OSError:
            continue  # it belongs to somebody else
    return tempfile.TemporaryDirectory(prefix=HIDDEN, dir=folder)


def _check_folder(folder: Path) -> None:
    """Raise `NotADirectoryError` unless ``folder`` exists."""
    if not folder.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "there is no such folder", str(folder))


def _check_target(path: Path) -> None:
    """Raise `OSError` where something other than a file stands, such as a device, which
    a renamed file would replace."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "this is no file that can be replaced", str(path))


def _flush(path: Path) -> None:
    """Have the content of a file on the disk before the file gets its name."""
    with path.open("rb") as file:
        os.fsync(file.fileno())


@contextmanager
def _errors_about(path: Path) -> Iterator[None]:
    """Errors that name nothing, or a temporary file, name ``path`` instead."""
    try:
        yield
    except OSError as error:
        name = error.filename
        if name is not None and HIDDEN not in str(name):
            raise
        if error.errno is None:
            raise OSError(f"{path}: {error}") from error
        raise OSError(error.errno, error.strerror, str(path)) from error
