"""What is said on standard error while a command works."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import click

LIBRARIES = ("bifurc", "linkages")


class StatusLine:
    """A line on a terminal that says what was found so far; it appears after a second
    and is wiped at the end."""

    def __init__(self, patience: float = 1.0):
        self._start = time.monotonic()
        self._patience = patience
        self._width = 0

    def __call__(self, what: str, count: int) -> None:
        """Show progress: the `progress` callback of `bifurc.search.explore.explore`."""
        seconds = time.monotonic() - self._start
        if seconds <= self._patience or not sys.stderr.isatty():
            return
        text = f"exploring: {count} {what} so far, {seconds:.0f} s"
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
        """Show one record."""
        click.echo(f"{record.levelname.lower()}: {record.getMessage()}", err=True)


@contextmanager
def library_messages() -> Iterator[None]:
    """Show warnings of the library on standard error for the time of a block."""
    handler = EchoHandler()
    for name in LIBRARIES:
        logger = logging.getLogger(name)
        logger.setLevel(logging.WARNING)
        logger.addHandler(handler)
    try:
        yield
    finally:
        for name in LIBRARIES:
            logger = logging.getLogger(name)
            logger.setLevel(logging.NOTSET)
            logger.removeHandler(handler)


def say_more() -> None:
    """Let the library say all it has to say, inside a block of `library_messages`."""
    for name in LIBRARIES:
        logging.getLogger(name).setLevel(logging.INFO)
