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
    help="Divide the bounds of two to four unknowns into so many boxes at most, to tell "
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
@click.option(
    "--axes",
    type=options.AxisWords(),
    metavar="X,Y",
    default=(),
    help="Draw the diagram over these two: unknowns, one between bars for its size, or u "
    "between bars for the norm of all but the parameter; needs --out.",
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
    axes: tuple[str, ...],
    figures: options.FigureOptions,
    search: options.SearchOptions,
) -> None:
    """Find all solution curves of the equations in a file, their bifurcations, and the
    bifurcation diagram along a parameter.

    \b
    Examples:
      bifurc solve reaction.toml --out out/reaction
      bifurc solve reaction.toml --out out/reaction --axes p,x
      bifurc solve reaction.toml --param B=12 --json
    """
    from bifurc.systems.document import make_document
    from bifurc.systems.summary import make_summary
    from bifurc.systems.verdict import verdict_of
    from linkages.app import output
    from linkages.app.equation_source import explore_system

    system = _system_of(equations, parameters, axes)
    output.require_out(out)
    output.require_folder(out)
    choice = replace(
        search, certify=not no_certify, boxes=boxes, paths=paths, charts=charts
    )
    written: list[Path] = []
    # Ctrl-C ends the search, but not before what was found is shown and written
    with HeldInterrupt():
        atlas = explore_system(system, choice)
        summary = make_summary(atlas)
        try:
            if as_json:
                output.say_json(make_document(atlas))
            else:
                output.say(summary)
        finally:  # where nothing can be shown, there are still the files
            if out is not None:
                from linkages.app.files import write_data

                with output.writing_to(out):
                    written = write_data(atlas, out, summary)
    if out is not None:
        written += _write_figures(atlas, out, axes, figures)
        output.say_written(written, out)
    code = exit_code_of(atlas)
    if not as_json:
        say_steps(atlas, equations, parameters, out)
    elif code is not ExitCode.DONE:
        click.echo(verdict_of(atlas), err=True)
    click.get_current_context().exit(code)


def _write_figures(
    atlas: Atlas, out: Path, axes: tuple[str, ...], figures: options.FigureOptions
) -> list[Path]:
    """The paths of the figures, the diagram over these ``axes``."""
    from linkages.app.files import FigureAxes, write_figures
    from linkages.app.output import writing_to

    with writing_to(out):
        return write_figures(atlas, out, FigureAxes(diagram=axes), figures)


def say_steps(
    atlas: Atlas, file: str, parameters: tuple[str, ...], out: Path | None
) -> None:
    """Say what can be done next with the equations."""
    from linkages.app.output import say_next
    from linkages.app.texts.next_steps import steps_after_solving

    say_next(*steps_after_solving(atlas, file, parameters, out is not None))


def _system_of(
    file: str, parameters: tuple[str, ...], axes: tuple[str, ...]
) -> EquationSystem:
    """The system of a file, of which the ``axes`` of a diagram show something; raises
    `EquationFileError`, and `CommandError` for what is a linkage."""
    from bifurc.systems.equation_file import EquationFileError, read_equations
    from linkages.app.equation_source import read_constants

    values = read_constants(parameters)
    try:
        system = read_equations(file, values)
        _check_axes(axes, system)
        return system
    except EquationFileError:
        if _is_linkage(file):
            message = f"{file}: it is a linkage; `bifurc map {file}` maps it"
            raise CommandError(message) from None
        raise


def _is_linkage(source: str) -> bool:
    """Whether something is the name of a linkage, or a file that holds one."""
    from bifurc.errors import BifurcError
    from linkages.linkage import load

    try:
        load(source)
    except BifurcError:
        return False
    return True


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


def _check_axes(axes: tuple[str, ...], system: EquationSystem) -> None:
    """Raise `bifurc.ProblemError` for an axis that shows nothing of the system."""
    if axes:
        from bifurc.figures.quantities import check_axis

        for axis in axes:
            check_axis(axis, system.problem.domain.names)
