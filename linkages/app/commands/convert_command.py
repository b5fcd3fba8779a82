"""The command `bifurc convert`: a mechanism from one format of files to another."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import exit_code_table
from linkages.app.options import FILE, HoldOptions, hold_options
from linkages.app.output import (
    require_ending,
    require_writable,
    say,
    say_next,
    write_content,
)
from linkages.formats.table import READ_WORDS, WRITTEN, WRITTEN_WORDS, mechanism_text

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

TARGET = "OUT"
AFTER = ("map", "view")  # what can be done with the file that is written
HELP = f"""Write a mechanism to a file of another format.

\b
IN   {READ_WORDS}, or a network by name
OUT  {WRITTEN_WORDS}

The configuration written is the reference configuration, where all joint variables
are 0; that of a network is one with its locks.
"""


@click.command("convert", help=HELP, epilog=exit_code_table())
@click.argument("source", metavar="IN")
@click.argument("out", metavar="OUT", type=FILE)
@hold_options
def convert_command(source: str, out: Path, hold: HoldOptions) -> None:
    """Write a mechanism to a file of another format."""
    require_ending(TARGET, out, *WRITTEN)
    from bifurc.tables import count_of

    mechanism = _mechanism(source, out, hold)
    text = mechanism_text(mechanism, out)
    require_writable(out, TARGET)
    write_content(out, text, TARGET)
    bodies = count_of(len(mechanism.bodies), "body")
    joints = count_of(len(mechanism.joints), "joint")
    say(f"{out}: {mechanism.name}, {bodies}, {joints}")
    if any(mechanism.origin):
        place = " ".join(f"{coordinate:.10g}" for coordinate in mechanism.origin)
        say(f"Points are counted from {place} of {source}.")
    if mechanism.rounding and out.suffix.lower() != ".toml":
        say(
            f"Coordinates of points are known to {mechanism.rounding:.2g} only, which "
            f"{out} does not say: a map of it is surer than it should be."
        )
    say_next(*(f"bifurc {command} {shlex.quote(str(out))}" for command in AFTER))


def _mechanism(source: str, out: Path, hold: HoldOptions) -> Mechanism:
    """The mechanism of a file; raises `CommandError` for a single loop that is given as
    a table or as axes."""
    from linkages.app.choice import choose_held, require_kind
    from linkages.mechanisms.mechanism import Mechanism

    refusal = (
        f"{source}: it is a single loop, a table or axes; convert takes mechanisms; "
        f"`bifurc export {source} --to {out}` writes one"
    )
    return require_kind(choose_held(source, (), hold), Mechanism, refusal)
