"""The command `bifurc tolerance`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app import options
from linkages.app.exit_codes import exit_code_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


LARGEST_ERROR = 1  # rad, and characteristic lengths
MOST_COPIES = 10_000


@click.command("tolerance", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.number_option(
    "--error",
    options.NumberRange(min=0, max=LARGEST_ERROR),
    1e-4,
    "Standard deviation of the errors.",
)
@options.number_option(
    "--samples", click.IntRange(1, MOST_COPIES), 4, "Copies that are made."
)
@options.seed_option("Number of the first copy.")
@options.hold_options
@options.param_option
@options.out_option("tolerance.txt and .png")
def tolerance_command(
    linkage: str,
    error: float,
    samples: int,
    seed: int,
    parameters: tuple[str, ...],
    out: Path | None,
    hold: options.HoldOptions,
) -> None:
    """Show what manufacturing errors make of the forms and bifurcations of a linkage.

    Errors are in every number of a D-H table, also of a mechanism that is a single
    loop of revolute joints; in another one every joint is off on each body that it
    joins.

    \b
    Examples:
      bifurc tolerance special-double-subtractive-goldberg --error 1e-4 --out out
      bifurc tolerance four-bennett-network --lock 2=40 --lock 6=-75
    """
    from linkages.app.atlas_source import explore_linkage, require_uninterrupted
    from linkages.app.choice import choose_held
    from linkages.app.output import require_folder, say
    from linkages.app.reports.tolerance import climb, describe_tolerance, measure
    from linkages.app.texts.form_names import require_forms
    from linkages.subject import subject_at

    require_folder(out)
    chosen = choose_held(linkage, parameters, hold)
    atlas = explore_linkage(chosen, options.SearchOptions())
    require_uninterrupted(atlas)
    require_forms(atlas, " to measure.")
    # in the unknowns of the equations of what is made with errors
    atlas = subject_at(atlas).in_loop_angles(atlas)
    seeds = range(seed, seed + samples)
    copies = [measure(atlas, error, number) for number in seeds]
    ladder = climb(atlas, seeds)
    text = describe_tolerance(atlas, copies, ladder)
    try:
        say(text)
    finally:  # where nothing can be shown, there are still the files
        if out is not None:
            from linkages.app.reports.tolerance_figure import draw_tolerance

            _write(text, draw_tolerance(atlas, copies[0], ladder), out)


def _write(text: str, figure: Figure, out: Path) -> None:
    """Write the tables and the figure to ``out``."""
    from bifurc.files.atomic import replace_files
    from linkages.app.output import writing_to

    def write(stage: Path) -> None:
        (stage / "tolerance.txt").write_text(text + "\n", encoding="utf-8")
        figure.savefig(stage / "tolerance.png", dpi=150)

    with writing_to(out):
        replace_files(out, write)
    click.echo(f"wrote tolerance.txt and tolerance.png to {out}", err=True)
