"""The command `bifurc chart`."""

from __future__ import annotations

import math
from pathlib import Path

import click

from linkages.app import options
from linkages.app.exit_codes import ExitCode, exit_code_table

MOST_RANDOM = 100_000


@click.command("chart", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.free_param_option
@options.number_option(
    "--random",
    click.IntRange(0, MOST_RANDOM),
    100,
    "Members that check the regions.",
)
@options.SEARCH_OPTIONS["budget"]
@options.json_option("; angles in radians")
@options.out_option("chart.txt, .json and .png")
def chart_command(
    linkage: str,
    parameters: tuple[str, ...],
    random: int,
    as_json: bool,
    budget: float,
    out: Path | None,
) -> None:
    """Divide the plane of two parameters into regions of equal map.

    Boundaries are members at which alone there is a singular point: curves, followed from
    members all over the plane. What they leave are the regions; one member of each is mapped, and
    random members check that all of a region have as many forms, components and singular
    points, and the same graph.

    \b
    Examples:
      bifurc chart four-bar --param a=0.5:4 --param d=0.5:5
      bifurc chart spherical-four-bar --param alpha12=20:160 --param alpha23=20:160 --out DIR
      bifurc chart six_bar.toml --param A-B=0.5:2 --param E-F=1:3 --random 20
    """
    from bifurc.limits import Deadline
    from linkages.app.output import StatusLine, require_folder, say, say_json
    from linkages.app.parameter_ranges import choose_members
    from linkages.app.texts.chart_text import chart_document, describe_chart, map_text
    from linkages.parameters.chart import chart

    require_folder(out)
    members, _ = choose_members(linkage, parameters, most=2, least=2)
    with StatusLine() as status:
        found = chart(members, random, deadline=Deadline(budget), progress=status)
    text, document = describe_chart(found), chart_document(found)
    if out is not None:
        from linkages.app.reports.chart_files import write_chart

        words = {one: map_text(one) for one in found.maps}
        write_chart(found, words, text, document, out)
    if as_json:
        say_json(document)
    else:
        say(text)
    if not found.is_whole and not math.isfinite(budget):
        click.get_current_context().exit(ExitCode.INTERRUPTED)
