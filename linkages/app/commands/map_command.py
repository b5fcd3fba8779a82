"""The command `bifurc map`: explore, report, write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bifurc.limits import HeldInterrupt
from linkages.app import options
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from linkages.app.files import FigureAxes


@click.command("map", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.out_option("dataset, graph, summary, figures and the page map.html")
@options.json_option("; angles in radians")
@options.no_certify_option
@click.option(
    "--digits",
    type=click.IntRange(20, 1000),
    help=(
        "Find every singular point again in arithmetic of so many digits, "
        "and show how many of the map's agree."
    ),
)
@click.option(
    "--axes",
    type=options.JointWords(2, 3),
    metavar="I,J[,K]",
    help=(
        "Draw the transition map over these two or three joints, by their names or "
        "numbers; needs --out."
    ),
)
@click.option(
    "--against",
    type=options.JointWords(1, 1),
    metavar="I",
    help="Draw the singular values against this joint; needs --out.",
)
@options.atlas_options
def map_command(
    linkage: str,
    out: Path | None,
    as_json: bool,
    no_certify: bool,
    digits: int | None,
    axes: tuple[str, ...] | None,
    against: tuple[str, ...] | None,
    choice: options.AtlasOptions,
) -> None:
    """Map every motion form of a linkage, every bifurcation, and the graph between
    them.

    \b
    Examples:
      bifurc map bennett --param alpha=70 --param beta=30
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map bricard-line-symmetric --out out --axes 1,5 --against 1
      bifurc map my_linkage.toml --json > map.json
      bifurc map five_bar.toml --lock J1=40
      bifurc map slider_crank.toml --out out --axes J1,J4
      bifurc map four-bennett-network --lock 2=40 --lock 6=-75
      bifurc map special-double-subtractive-goldberg --digits 50
    """
    from linkages.app.atlas_source import explore_parts
    from linkages.app.choice import choose_held, parts_of
    from linkages.app.files import figure_axes
    from linkages.app.output import require_folder, say_written

    if digits:
        require_digits(as_json, choice.hold)
    require_out(out, axes=axes, against=against)
    parts = parts_of(choose_held(linkage, choice.parameters, choice.hold))
    folders = folders_of(out, len(parts))
    over = [figure_axes(part, axes, against) for part in parts]
    for folder in folders:
        require_folder(folder)
    # Ctrl-C ends the search, but not before what was found is shown and written
    with HeldInterrupt():
        atlases = explore_parts(parts, replace(choice.search, certify=not no_certify))
        try:
            report(atlases, as_json)
        finally:  # where nothing can be shown, there are still the files
            paths = list(map(write_numbers, atlases, folders))
    if digits:
        confirm(atlases, linkage, choice.parameters, digits)
    for k, folder in enumerate(folders):
        if folder is not None:
            pictures = write_pictures(atlases[k], folder, over[k])
            say_written([*paths[k], *pictures], folder)
    exit_by_verdicts(atlases, as_json)


def exit_by_verdicts(atlases: Sequence[Atlas], as_json: bool) -> None:
    """End the command with the largest exit code of all maps; beside JSON verdicts that
    are not "done" are said on standard error."""
    from linkages.app.answer.verdict import judge

    verdicts = [judge(atlas) for atlas in atlases]
    for verdict in verdicts:
        if as_json and verdict.code is not ExitCode.DONE:
            click.echo(verdict.sentence, err=True)
    click.get_current_context().exit(max(verdict.code for verdict in verdicts))


def confirm(
    atlases: Sequence[Atlas], linkage: str, parameters: Sequence[str], digits: int
) -> None:
    """Print how many of the maps' digits agree with those of so many."""
    from linkages.app.output import say
    from linkages.app.reports.confirmation import describe_confirmation

    for atlas in atlases:
        say("\n" + describe_confirmation(atlas, linkage, parameters, digits))


def folders_of(out: Path | None, count: int) -> list[Path | None]:
    """The folder for each of the mechanisms of a file: ``out``, or one in it each where
    they are several."""
    if out is None or count == 1:
        return [out] * count
    return [out / f"part-{number}" for number in range(1, count + 1)]


def report(atlases: Sequence[Atlas], as_json: bool) -> None:
    """Print the maps of all mechanisms of a file, as tables or as one JSON document, of
    several one with "parts"."""
    from linkages.app.answer.document import make_document
    from linkages.app.output import say, say_json
    from linkages.app.texts.summary import make_summary

    if not as_json:
        say("\n\n\n".join(make_summary(atlas) for atlas in atlases))
        return
    documents = [make_document(atlas) for atlas in atlases]
    say_json(documents[0] if len(documents) == 1 else {"parts": documents})


def write_numbers(atlas: Atlas, out: Path | None) -> list[Path]:
    """The paths of dataset, graph and summary, just written to ``out`` if there is
    one."""
    if out is None:
        return []
    from linkages.app.files import write_data
    from linkages.app.output import writing_to
    from linkages.app.texts.summary import make_summary
    from linkages.subject import subject_at

    with writing_to(out):
        subject = subject_at(atlas)
        more, others = subject.dataset_variables(atlas), subject.files()
        return write_data(atlas, out, make_summary(atlas), more, others)


def write_pictures(atlas: Atlas, out: Path, over: FigureAxes) -> list[Path]:
    """The paths of the figures, and of the page that `bifurc view` makes, just written
    to ``out``."""
    from linkages.app.answer.verdict import judge
    from linkages.app.files import write_figures
    from linkages.app.output import writing_to
    from linkages.viewing.document import make_view_document
    from linkages.viewing.page import write_page

    with writing_to(out):
        figures = write_figures(atlas, out, over)
        document = make_view_document(atlas, judge(atlas).sentence)
        return [*figures, write_page(document, out / "map.html")]


def require_digits(as_json: bool, hold: options.HoldOptions) -> None:
    """Raise `CommandError` for options that do not go with ``--digits``."""
    if as_json:
        raise CommandError(
            "--digits: it has no place in the JSON document; leave out --json"
        )
    if hold.is_without_centre:
        raise CommandError("--digits: it does not go with --without-centre")


def require_out(out: Path | None, **figures: tuple[str, ...] | None) -> None:
    """Raise `CommandError` for options of figures where no figure is written."""
    for name, value in figures.items():
        if value is not None and out is None:
            raise CommandError(f"--{name}: figures are only drawn with --out DIR")
