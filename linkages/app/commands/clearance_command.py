"""The command `bifurc clearance`: how near links come to each other."""

from __future__ import annotations

import click

from linkages.app import options
from linkages.app.exit_codes import exit_code_table

LARGEST = 1e100  # diameter, as lengths of links


@click.command("clearance", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@options.form_option
@options.number_option(
    "--diameter",
    options.NumberRange(min=0, max=LARGEST),
    0.0,
    "Diameter of the links, in the unit of the linkage; 0 is that of their middle "
    "lines.",
)
@options.json_option("; angles in radians")
@options.atlas_options
def clearance_command(
    source: str,
    forms: tuple[str, ...],
    diameter: float,
    as_json: bool,
    choice: options.AtlasOptions,
) -> None:
    """Show how near links come to each other along forms, and where.

    Links are rods along offsets and common normals, bodies of a mechanism the lines
    from joint to joint that `bifurc view` draws; two that share a joint are left out.
    Planar ones lie in layers, as few as keep all apart; a pin goes from the lowest to the
    highest body of its joint. A mechanism file may say the layers itself.

    \b
    Examples:
      bifurc clearance bricard-trihedral
      bifurc clearance out/atlas.nc --form "Form I" --diameter 0.05
      bifurc clearance four-bennett-network --lock 2=40 --lock 6=-75
    """
    from linkages.app.answer.verdict import exit_by, judge
    from linkages.app.atlas_source import atlas_of
    from linkages.app.output import say, say_json
    from linkages.app.reports.clearance import (
        clearance_document,
        clearance_of,
        describe_clearance,
    )
    from linkages.app.texts.form_names import choose_forms, require_forms

    atlas = atlas_of(source, choice)
    require_forms(atlas)
    chosen = choose_forms(atlas, forms)
    clearance = clearance_of(atlas, chosen, diameter)
    if as_json:
        say_json(clearance_document(atlas, clearance))
    else:
        say(describe_clearance(atlas, clearance))
    exit_by(judge(atlas))
