"""What a command prints, what it says on standard error while it works, and the folder
that it writes to."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import click
from click.core import ParameterSource

from linkages.app.exit_codes import CommandError


def say(text: str) -> None:
    """Print ``text`` and a newline.

    A reader that has gone away, as in ``bifurc map bennett | head -1``, is no error.
    Raises `CommandError` where nothing can be printed, as on a full disk.
    """
    try:
        click.echo(text)
    except BrokenPipeError:
        _discard_standard_output()
    except OSError as error:
        _discard_standard_output()
        reason = error.strerror or str(error)
        raise CommandError(f"standard output cannot be written ({reason})") from None


def say_json(document: Mapping[str, object] | Sequence[object]) -> None:
    """Print ``document`` as JSON; raises as `say`."""
    say(json.dumps(document, allow_nan=False))


def _discard_standard_output() -> None:
    """Lead standard output to nowhere: what is left in its buffer would fail again when
    the program ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def require_folder(out: Path | None) -> None:
    """Make sure, before anything is computed, that files can be written to ``out``, if
    there is one; raises `CommandError`. What is made for that and stays empty, as the command ends in
    an error, is removed again."""
    if out is None:
        return
    with writing_to(out):
        made = prepare_folder(out)
    click.get_current_context().call_on_close(lambda: remove_empty(made))


def prepare_folder(folder: Path) -> list[Path]:
    """Make sure that files can be written to ``folder``: the folders that were made for
    that, the innermost first; raises `OSError` if it cannot be."""
    chain = [folder, *folder.parents]
    missing = [path for path in chain if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        remove_empty(missing)
        raise
    return missing


def remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders, the innermost first, as far as nothing is in them."""
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()


def require_ending(option: str, out: Path, *endings: str) -> None:
    """Raise `CommandError` unless the name of the file ``out`` has one of the
    ``endings``, in capitals or not."""
    if not out.name.lower().endswith(endings):
        allowed = " or ".join(endings)
        raise CommandError(f"{option} {out}: it must end with {allowed}")


def require_writable(out: Path, option: str = "--out") -> None:
    """Make sure, before anything is computed, that the file ``out`` behind an option
    can be written; raises `CommandError`."""
    from bifurc.files.atomic import require_replaceable

    with writing_to(out, option):
        require_replaceable(out)


def write_content(out: Path, content: str | bytes, option: str) -> None:
    """Write the file ``out`` behind an option, whole or not at all; raises
    `CommandError`."""
    from bifurc.files.atomic import replace_file

    data = content.encode("utf-8") if isinstance(content, str) else content
    with writing_to(out, option):
        replace_file(out, lambda part: part.write_bytes(data))


def say_written(paths: Iterable[Path], out: Path) -> None:
    """Say on standard error which files were written to a folder."""
    names = ", ".join(path.name for path in paths)
    click.echo(f"wrote {names} to {out}", err=True)


@contextmanager
def writing_to(out: Path, option: str = "--out") -> Iterator[None]:
    """A block that writes to ``out``, the value of an option; raises `CommandError`
    where that fails."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        message = f"{option} {out}: nothing can be written there ({reason})"
        raise CommandError(message) from None


EVERY = 10.0  # s between two lines on what a search does
LIBRARIES = ("bifurc", "linkages")


class StatusLine:
    """What a search does and has found so far: on a terminal a line on standard error
    that appears after a second and is wiped at the end of its block, elsewhere what
    `saying_progress` says."""

    def __init__(self, patience: float = 1.0):
        self._start = time.monotonic()
        self._patience = patience
        self._width = 0
        self._found = "nothing"

    def __call__(self, what: str, count: int) -> None:
        """Show progress: the `progress` callback of `bifurc.search.explore.explore`."""
        self._found = f"{count} {what}"
        seconds = time.monotonic() - self._start
        if seconds <= self._patience or not sys.stderr.isatty():
            return
        text = self.text()
        click.echo("\r" + text.ljust(self._width), nl=False, err=True)
        self._width = len(text)

    def text(self) -> str:
        """What was found so far."""
        seconds = time.monotonic() - self._start
        return f"exploring, {seconds:.0f} s: {self._found}"

    def __enter__(self) -> StatusLine:
        SEARCHES.append(self)
        return self

    def __exit__(self, *error: object) -> None:
        SEARCHES.remove(self)
        if self._width:
            click.echo("\r" + " " * self._width + "\r", nl=False, err=True)
            self._width = 0


SEARCHES: list[StatusLine] = []  # that run, the innermost last


@contextmanager
def saying_progress() -> Iterator[None]:
    """A block in which standard error, where it is no terminal, gets a line every `EVERY`
    seconds: what the search has found that runs, or else for how long there is work."""
    start = time.monotonic()
    is_over = threading.Event()

    def say_again() -> None:
        while not is_over.wait(EVERY):
            working = f"working, {time.monotonic() - start:.0f} s"
            click.echo(SEARCHES[-1].text() if SEARCHES else working, err=True)

    if not sys.stderr.isatty():
        threading.Thread(target=say_again, daemon=True).start()
    try:
        yield
    finally:
        is_over.set()


MOST_STEPS = 3  # that are named after an answer


def say_next(*steps: str) -> None:
    """Say on standard error what can be done next, the first commands of ``steps``."""
    for step in steps[:MOST_STEPS]:
        click.echo(f"next: {step}", err=True)


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


FIGURE_OPTIONS = (
    "axes",
    "against",
    "window",
    "overlay",
    "formats",
    "size",
    "forms",
    "trace",
)


def require_out(out: Path | None) -> None:
    """Raise `CommandError` for options of figures on the command line where no figure
    is written."""
    if out is not None:
        return
    context = click.get_current_context()
    for option in context.command.params:
        name = option.name or ""
        source = context.get_parameter_source(name)
        if name in FIGURE_OPTIONS and source is ParameterSource.COMMANDLINE:
            raise CommandError(
                f"{option.opts[0]}: figures are only drawn with --out DIR"
            )
