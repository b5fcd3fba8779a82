"""The command `bifurc map`: explore, report, write."""

from __future__ import annotations

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
    from linkages.entry import Linkage
    from linkages.mechanisms.mechanism import Mechanism

EXACT = "exact.toml"  # the table that --nearest maps


@click.command("map", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.out_option("dataset, graph, summary, figures and the page map.html")
@options.json_option("; angles in radians")
@options.no_certify_option
@click.option(
    "--nearest",
    is_flag=True,
    help=(
        "Map the exact linkage of the catalogue that a rounded or misprinted table is "
        "meant to be."
    ),
)
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
@click.option(
    "--range",
    "window",
    type=options.Pair(":", "0:360"),
    metavar="LOW:HIGH",
    help="The first and the last angle in the figures, degrees.  [default: -180:180]",
)
@click.option(
    "--overlay",
    type=options.FILE,
    metavar="FILE.csv",
    help=(
        "Lay points over the figures: a column of degrees (lengths in the file's unit) "
        "for each of some joints, with their names in the first line; needs --out."
    ),
)
@options.figure_options
@options.atlas_options
def map_command(
    linkage: str,
    out: Path | None,
    as_json: bool,
    no_certify: bool,
    nearest: bool,
    digits: int | None,
    axes: tuple[str, ...] | None,
    against: tuple[str, ...] | None,
    window: tuple[float, float] | None,
    overlay: Path | None,
    figures: options.FigureOptions,
    choice: options.AtlasOptions,
) -> None:
    """Map every motion form of a linkage, every bifurcation, and the graph between
    them.

    \b
    Examples:
      bifurc map bennett --param alpha=70 --param beta=30
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map bricard-line-symmetric --out out --axes 1,5 --against 1
      bifurc map bennett --out out --format pdf --size 3.4x2.6 --range 0:360
      bifurc map my_linkage.toml --json > map.json
      bifurc map printed_table.csv --nearest --out out
      bifurc map five_bar.toml --lock J1=40
      bifurc map slider_crank.toml --out out --axes J1,J4
      bifurc map four-bennett-network --lock 2=40 --lock 6=-75
      bifurc map special-double-subtractive-goldberg --digits 50
    """
    from linkages.app.atlas_source import explore_linkage
    from linkages.app.files import figure_axes
    from linkages.app.output import require_folder, require_out, say, say_written

    require_out(out)
    if digits:
        allow_digits(as_json, nearest, choice.hold)
    require_folder(out)
    mechanism, exact = choose_mapped(linkage, choice, nearest)
    over = figure_axes(mechanism, axes, against, window, overlay)
    # Ctrl-C ends the search, but not before what was found is shown and written
    with HeldInterrupt():
        atlas = explore_linkage(
            mechanism, replace(choice.search, certify=not no_certify)
        )
        try:
            report(atlas, as_json, choice.verbose)
        finally:  # where nothing can be shown, there are still the files
            paths = write_numbers(atlas, out, exact)
    if digits:
        from linkages.app.reports.confirmation import describe_confirmation

        say("\n" + describe_confirmation(atlas, linkage, choice.parameters, digits))
    if out is not None:
        say_written([*paths, *write_pictures(atlas, out, over, figures)], out)
    steps = "" if as_json else next_steps_of(atlas, linkage, choice, out is not None)
    end(atlas, as_json, steps)


def allow_digits(as_json: bool, nearest: bool, hold: options.HoldOptions) -> None:
    """Raise `CommandError` for what does not go with more digits."""
    if as_json:
        raise CommandError(
            "--digits: it has no place in the JSON document; leave out --json"
        )
    if hold.is_without_centre:
        raise CommandError("--digits: it does not go with --without-centre")
    if nearest:
        raise CommandError("--digits: it does not go with --nearest")


def choose_mapped(
    linkage: str, choice: options.AtlasOptions, nearest: bool
) -> tuple[Linkage | Mechanism, str]:
    """What is mapped, and the text of a file with its exact table where it is the
    ``nearest`` linkage to the one that was named."""
    from linkages.app.choice import choose_held

    mechanism = choose_held(linkage, choice.parameters, choice.hold)
    if not nearest:
        return mechanism, ""
    from linkages.app.nearest import nearest_linkage
    from linkages.subject import as_subject

    meant = nearest_linkage(as_subject(mechanism).as_loop())
    click.echo(meant.words, err=True)
    return meant.linkage, meant.toml


def next_steps_of(
    atlas: Atlas, linkage: str, choice: options.AtlasOptions, has_files: bool
) -> str:
    """What can be done next with a linkage."""
    from linkages.app.texts.next_steps import next_steps

    return next_steps(atlas, linkage, choice, has_files)


def end(atlas: Atlas, as_json: bool, steps: str) -> None:
    """End the command with the exit code of the verdict, after what can be done next,
    ``steps``, or the verdict where a document does not say it."""
    from linkages.app.answer.verdict import judge
    from linkages.app.output import say_aside

    verdict = judge(atlas)
    say_aside(steps)
    if as_json and verdict.code is not ExitCode.DONE:
        click.echo(verdict.sentence, err=True)
    click.get_current_context().exit(verdict.code)


def report(atlas: Atlas, as_json: bool, is_whole: bool) -> None:
    """Print the map, as tables or as one JSON document."""
    from linkages.app.answer.document import make_document
    from linkages.app.output import say, say_json
    from linkages.app.texts.summary import make_screen, make_summary

    if as_json:
        say_json(make_document(atlas))
    else:
        say(make_summary(atlas) if is_whole else make_screen(atlas))


def write_numbers(atlas: Atlas, out: Path | None, exact: str = "") -> list[Path]:
    """The paths of dataset, graph and summary, and of the ``exact`` table if it is no
    empty text, just written to ``out`` if there is one."""
    if out is None:
        return []
    from linkages.app.files import write_data
    from linkages.app.output import writing_to
    from linkages.app.texts.summary import make_summary
    from linkages.subject import subject_at

    with writing_to(out):
        subject = subject_at(atlas)
        more, others = subject.dataset_variables(atlas), dict(subject.files())
        if exact:
            others[EXACT] = lambda path: path.write_text(exact, encoding="utf-8")
        return write_data(atlas, out, make_summary(atlas), more, others)


def write_pictures(
    atlas: Atlas, out: Path, over: FigureAxes, look: options.FigureOptions
) -> list[Path]:
    """The paths of the figures, and of the page that `bifurc view` makes, just written
    to ``out``."""
    from linkages.app.answer.verdict import judge
    from linkages.app.files import write_figures
    from linkages.app.output import writing_to
    from linkages.viewing.document import make_view_document
    from linkages.viewing.page import write_page

    with writing_to(out):
        figures = write_figures(atlas, out, over, look)
        document = make_view_document(atlas, judge(atlas).sentence)
        return [*figures, write_page(document, out / "map.html")]
