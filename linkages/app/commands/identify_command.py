"""The command `bifurc identify`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app import options
from linkages.app.exit_codes import ExitCode, exit_code_table

if TYPE_CHECKING:
    from linkages.identification.corrections import Corrections
    from linkages.identification.identify import Identification
    from linkages.loop import Loop

LARGEST_TOLERANCE = 1  # as large as the linkage itself


@click.command("identify", epilog=exit_code_table())
@click.argument("linkage", metavar="FILE.toml|FILE.csv|NAME")
@options.number_option(
    "--tolerance",
    options.NumberRange(min=0, max=LARGEST_TOLERANCE, min_open=True),
    1e-8,
    "How far a table may be from the linkage it is.",
)
@click.option(
    "--write",
    "out",
    type=options.FILE,
    metavar="FILE",
    help="Write the exact table to a .toml file, a comment at each number that changes.",
)
@options.json_option("; angles in radians")
@options.hold_options
@options.param_option
def identify_command(
    linkage: str,
    tolerance: float,
    out: Path | None,
    as_json: bool,
    parameters: tuple[str, ...],
    hold: options.HoldOptions,
) -> None:
    """Name the linkages of the catalogue that a table, or a mechanism that is a single
    loop of revolute joints, is a case of, whichever way it is read.

    Other first joint, direction, sense of axes and links, mirror image and scale make
    no difference. Where none fits, the table is rounded or has a misprint: what it is
    meant to be is looked for, and said with the numbers that are wrong.

    \b
    Examples:
      bifurc identify my_linkage.toml
      bifurc identify table.csv --write exact.toml
      bifurc identify four-bennett-network --lock 2=40 --lock 6=-75 --without-centre
    """
    from linkages.app.choice import choose_held
    from linkages.app.output import (
        StatusLine,
        require_ending,
        require_writable,
        say,
        say_json,
    )
    from linkages.app.reports.identify import (
        describe_identification,
        make_identification_document,
    )
    from linkages.app.texts.next_steps import chosen_linkage
    from linkages.identification.corrections import Corrections, corrections_of
    from linkages.identification.identify import identify
    from linkages.subject import as_subject

    if out is not None:
        require_ending("--write", out, ".toml")
        require_writable(out, "--write")
    loop = as_subject(choose_held(linkage, parameters, hold)).as_loop()
    identification = identify(loop, tolerance)
    corrections = Corrections(())
    if not identification.matches:
        with StatusLine() as status:
            corrections = corrections_of(identification, status)
    if as_json:
        say_json(make_identification_document(identification, corrections))
    else:
        say(describe_identification(identification, corrections))
    if out is not None:
        write_exact(out, loop, identification, corrections)
    if not as_json:
        chosen = chosen_linkage(linkage, parameters, hold)
        say_steps(chosen, identification, bool(corrections.found), out)
    if out is None and not (identification.matches or identification.locked):
        click.get_current_context().exit(ExitCode.NOT_IN_CATALOGUE)


def write_exact(
    out: Path,
    loop: Loop,
    identification: Identification,
    corrections: Corrections,
) -> None:
    """Write the exact table of a loop."""
    from linkages.app.nearest import exact_linkage
    from linkages.app.output import say_written, write_content
    from linkages.app.reports.corrections import exact_toml

    correction = exact_linkage("--write", identification, corrections)
    write_content(out, exact_toml(loop, correction), "--write")
    say_written([out], out.parent)


def say_steps(
    chosen: str, identification: Identification, is_corrected: bool, out: Path | None
) -> None:
    """Say what can be done next with a table."""
    from linkages.app.output import say_next
    from linkages.app.texts.next_steps import steps_after_identifying

    names = identification.names
    say_next(*steps_after_identifying(chosen, names, is_corrected, out))
