"""The command `bifurc figure`: the figures of the sources, drawn from the geometry."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import CommandError, exit_code_table
from linkages.app.options import out_option

if TYPE_CHECKING:
    from linkages.source_figures.table import SourceFigure

ALL = "all"


@click.command("figure", epilog=exit_code_table())
@click.argument("names", metavar="[ID|all]...", nargs=-1)
@click.option("--list", "is_list", is_flag=True, help="List all figures.")
@out_option("the figures, as PNG and SVG each")
def figure_command(names: tuple[str, ...], is_list: bool, out: Path | None) -> None:
    """Draw figures of the sources anew, from the geometry.

    IDs are those of the thesis (Song 2013) and of the papers 000 (Song and Chen 2012,
    mixed), 001 (Song and Chen 2012, special), 003 (Bil and Budniak 2014) and 004
    (Racila and Dahan 2010). The caption says what differs from the source.

    \b
    Examples:
      bifurc figure --list
      bifurc figure thesis-5.2.7 --out figures
      bifurc figure all --out figures
    """
    if is_list:
        if names or out is not None:
            raise CommandError("--list: it goes without figures and --out")
        show_list()
        return
    if not names:
        raise CommandError("figure: name figures, or give --list")
    if out is None:
        raise CommandError("--out: give the folder for the figures")
    figures = chosen_figures(names)
    write_figures(figures, out)


def show_list() -> None:
    """Print every figure with what it shows."""
    from bifurc.tables import table
    from linkages.app.output import say
    from linkages.source_figures.table import source_figures

    rows = []
    for figure in source_figures().values():
        rows.append((figure.name, figure.agreement.value, figure.title))
    say(table(("id", "source", "title"), rows))


def chosen_figures(names: Sequence[str]) -> list[SourceFigure]:
    """The figures that are named, each once; raises
    `linkages.source_figures.table.UnknownFigureError`."""
    from linkages.source_figures.table import figure_named, source_figures

    if ALL in names:
        return list(source_figures().values())
    return list({name: figure_named(name) for name in names}.values())


def write_figures(figures: Sequence[SourceFigure], out: Path) -> None:
    """Write figures to a folder, one after the other, and say which."""
    from bifurc.figures.plotting import save_figure
    from linkages.app.output import require_folder, writing_to
    from linkages.source_figures.draw import draw_source_figure

    require_folder(out)
    for source in figures:
        figure = draw_source_figure(source)
        with writing_to(out):
            for path in save_figure(figure, out / source.name):
                click.echo(f"wrote {path}", err=True)
