"""The command `bifurc solve`: all solution curves of equations in a file."""

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
    from bifurc.systems.equation_file import EquationSystem


@click.command("solve", epilog=exit_code_table())
@click.argument("equations", metavar="FILE.toml")
@options.out_option("dataset, graph, summary and figures")
@options.json_option()
@options.no_certify_option
@click.option(
    "--param",
    "parameters",
    multiple=True,
    metavar="KEY=VALUE",
    help="Another value of a parameter of the file; may be given several times.",
)
@click.option(
    "--boxes",
    default=20_000,
    show_default=True,
    type=click.IntRange(0, 10_000_000),
    help="Divide the bounds of two to four unknowns into so many boxes at most, to prove "
    "that nothing is missing; 0 for none.",
)
@click.option(
    "--paths",
    default=200,
    show_default=True,
    type=click.IntRange(0, 10_000),
    help="Follow all isolated solutions of as many polynomials as unknowns along so many "
    "paths at most, to count them; 0 for none.",
)
@click.option(
    "--charts",
    default=1500,
    show_default=True,
    type=click.IntRange(0, 1_000_000),
    help="Cover surfaces of solutions with so many charts at most; 0 for none.",
)
@options.figure_options
@options.search_options
@options.verbose_option
def solve_command(
    equations: str,
    parameters: tuple[str, ...],
    out: Path | None,
    as_json: bool,
    no_certify: bool,
    boxes: int,
    paths: int,
    charts: int,
    figures: options.FigureOptions,
    search: options.SearchOptions,
) -> None:
    """Find all solution curves of the equations in a file, their bifurcations, and the
    bifurcation diagram along a parameter.

    \b
    Examples:
      bifurc solve reaction.toml --out out/reaction
      bifurc solve reaction.toml --param B=12 --json
    """
    from bifurc.systems.document import make_document
    from bifurc.systems.equation_file import read_equations
    from bifurc.systems.summary import make_summary
    from bifurc.systems.verdict import verdict_of
    from linkages.app.output import (
        require_folder,
        require_out,
        say,
        say_json,
        say_written,
        writing_to,
    )

    system = read_equations(equations, _values(parameters))
    require_out(out)
    require_folder(out)
    written: list[Path] = []
    # Ctrl-C ends the search, but not before what was found is shown and written
    with HeldInterrupt():
        atlas = explore_system(
            system,
            replace(
                search,
                certify=not no_certify,
                boxes=boxes,
                paths=paths,
                charts=charts,
            ),
        )
        summary = make_summary(atlas)
        try:
            if as_json:
                say_json(make_document(atlas))
            else:
                say(summary)
        finally:  # where nothing can be shown, there are still the files
            if out is not None:
                from linkages.app.files import write_data

                with writing_to(out):
                    written = write_data(atlas, out, summary)
    if out is not None:
        from linkages.app.files import write_figures

        with writing_to(out):
            written += write_figures(atlas, out, options=figures)
        say_written(written, out)
    code = exit_code_of(atlas)
    if as_json and code is not ExitCode.DONE:
        click.echo(verdict_of(atlas), err=True)
    click.get_current_context().exit(code)


def explore_system(system: EquationSystem, search: options.SearchOptions) -> Atlas:
    """The atlas of a system; progress is shown on standard error."""
    from linkages.app.output import StatusLine

    settings = search.settings()
    with StatusLine() as status:
        return system.explore(settings=settings, seed=search.seed, progress=status)


def exit_code_of(atlas: Atlas) -> ExitCode:
    """Whether there are curves, there are none, or nothing is known."""
    from bifurc.completeness import Level
    from bifurc.systems.verdict import has_only_open_points

    if atlas.provenance.interrupted:
        return ExitCode.INTERRUPTED
    if atlas.forms or atlas.surfaces:
        return ExitCode.DONE
    is_open = has_only_open_points(atlas)
    if is_open or atlas.completeness.level is Level.OUT_OF_TIME:
        return ExitCode.NOTHING_KNOWN
    return ExitCode.DOES_NOT_MOVE


def _values(texts: tuple[str, ...]) -> dict[str, float]:
    """The parameters in "key=value"; raises `CommandError`."""
    values = {}
    for text in texts:
        key, equals, number = text.partition("=")
        try:
            value = float(number)
        except ValueError:
            equals = ""
        if not equals or not key.strip():
            raise CommandError(f"--param {text}: it must be KEY=NUMBER")
        if key.strip() in values:
            raise CommandError(f"--param {text}: {key.strip()} is given twice")
        values[key.strip()] = value
    return values
