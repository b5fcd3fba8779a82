"""The command `bifurc identify`."""

from __future__ import annotations

import click

from linkages.app import options
from linkages.app.exit_codes import ExitCode, exit_code_table

LARGEST_TOLERANCE = 1  # as large as the linkage itself


@click.command("identify", epilog=exit_code_table())
@click.argument("linkage", metavar="FILE.toml|NAME")
@options.number_option(
    "--tolerance",
    options.NumberRange(min=0, max=LARGEST_TOLERANCE, min_open=True),
    1e-8,
    "How far a table may be from the linkage it is.",
)
@options.json_option("; angles in radians")
@options.hold_options
@options.param_option
def identify_command(
    linkage: str,
    tolerance: float,
    as_json: bool,
    parameters: tuple[str, ...],
    hold: options.HoldOptions,
) -> None:
    """Name the linkages of the catalogue that a table, or a mechanism that is a single
    loop of revolute joints, is a case of, whichever way it is read.

    Other first joint, direction, sense of axes and links, mirror image and scale make
    no difference. Where none fits, the nearest are shown with the numbers that are off.

    \b
    Examples:
      bifurc identify my_linkage.toml
      bifurc identify four-bennett-network --lock 2=40 --lock 6=-75 --without-centre
    """
    from linkages.app.choice import choose_held
    from linkages.app.output import say, say_json
    from linkages.app.reports.identify import (
        describe_identification,
        make_identification_document,
    )
    from linkages.identification.identify import identify
    from linkages.subject import as_subject

    loop = as_subject(choose_held(linkage, parameters, hold)).as_loop()
    identification = identify(loop, tolerance)
    if as_json:
        say_json(make_identification_document(identification))
    else:
        say(describe_identification(identification))
    if not (identification.matches or identification.locked):
        click.get_current_context().exit(ExitCode.NOT_IN_CATALOGUE)
