"""What is said on standard error while a command works, and what it tells its caller at
the end."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import Any

import click

__all__ = ["EchoHandler", "ExitCode", "StatusLine", "compilation_announced"]


class ExitCode(IntEnum):
    """What the command `bifurc` tells its caller."""

    MAPPED = 0
    BAD_INPUT = 2
    DOES_NOT_MOVE = 3
    NO_ROUTE = 4
    INTERRUPTED = 130


class StatusLine:
    """A line on a terminal that says what was found so far; it appears after a second
    and is wiped at the end."""

    def __init__(self, patience: float = 1.0):
        self._began, self._patience = time.monotonic(), patience
        self._width = 0

    def __call__(self, what: str, count: int) -> None:
        """Show progress: the `progress` callback of `bifurc.search.explore.explore`."""
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


@contextmanager
def compilation_announced() -> Iterator[None]:
    """Say once on standard error when kernels are being compiled, and how long it took
    altogether."""
    from numba.core import event

    class Announcement(event.Listener):
        began = 0.0

        def on_start(self, event: Any) -> None:
            if not self.began:
                self.began = time.monotonic()
                click.echo(
                    "compiling kernels (once, kept on disk; about half a minute) ...",
                    err=True,
                )

        def on_end(self, event: Any) -> None:
            self.ended = time.monotonic()

    announcement = Announcement()
    try:
        with event.install_listener("numba:compile", announcement):
            yield
    finally:
        if announcement.began:
            click.echo(
                f"compiled in {announcement.ended - announcement.began:.1f} s", err=True
            )
