"""What is said on standard error while a command works, and what it tells its caller at the end."""

from __future__ import annotations

import logging
import sys
import time
from enum import IntEnum
from pathlib import Path
from typing import Any

import click

__all__ = ["EchoHandler", "ExitCode", "StatusLine", "kernels_are_compiled"]


class ExitCode(IntEnum):
    """What the command `bifurc` tells its caller."""

    MAPPED = 0
    BAD_INPUT = 2
    DOES_NOT_MOVE = 3
    NO_ROUTE = 4
    INTERRUPTED = 130


class StatusLine:
    """A line on a terminal that says what was found so far; it appears after a second and is wiped at the end."""

    def __init__(self, patience: float = 1.0):
        self._began, self._patience = time.monotonic(), patience
        self._width = 0

    def __call__(self, what: str, count: int) -> None:
        """Show progress: the `progress` callback of `bifurc.explore.explore`."""
        if sys.stderr.isatty() and time.monotonic() - self._began > self._patience:
            text = f"exploring: {count} {what} so far, {time.monotonic() - self._began:.0f} s"
            click.echo("\r" + text.ljust(self._width), nl=False, err=True)
            self._width = len(text)

    def wipe(self) -> None:
        """Remove the line."""
        if self._width:
            click.echo("\r" + " " * self._width + "\r", nl=False, err=True)
            self._width = 0


class EchoHandler(logging.Handler):
    """Log records of the library, one line each on standard error."""

    def emit(self, record: logging.LogRecord) -> None:
        click.echo(f"{record.levelname.lower()}: {record.getMessage()}", err=True)


def kernels_are_compiled() -> bool:
    """Whether compiled kernels are on disk from an earlier run, as far as file names and times tell."""
    from linkages import kernels, slices

    return all(
        _is_cached(value)
        for module in (kernels, slices)
        for value in vars(module).values()
        if hasattr(value, "stats") and hasattr(value, "py_func") and value.stats.cache_path is not None
    )


def _is_cached(dispatcher: Any) -> bool:
    code = dispatcher.py_func.__code__
    source = Path(code.co_filename)
    pattern = f"*{dispatcher.py_func.__name__}-{code.co_firstlineno}.*.nbi"
    indices = Path(dispatcher.stats.cache_path).glob(pattern)
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in indices)
