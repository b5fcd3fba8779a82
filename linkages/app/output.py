"""What a command prints, and the folder that it writes to."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

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


def require_folder(out: Path) -> None:
    """Make sure, before anything is computed, that files can be written to ``out``;
    raises `CommandError`. What is made for that and stays empty, as the command ends in
    an error, is removed again."""
    from linkages.app.files import prepare_folder, remove_empty

    with writing_to(out):
        made = prepare_folder(out)
    click.get_current_context().call_on_close(lambda: remove_empty(made))


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
