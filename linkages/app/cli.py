"""The command line: list, show, map, route and sweep. Modules are imported by the
command that needs them."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bifurc.errors import BifurcError
from bifurc.limits import HeldInterrupt
from linkages.app.status import EchoHandler, ExitCode, StatusLine, compilation_announced
from linkages.app.sweep.command import sweep_command
from linkages.app.tolerance_command import tolerance_command
from linkages.app.verify_command import verify_command

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from bifurc.problem import Problem

EXIT_CODES = """\b
Exit codes:
  0    done; for map: the linkage moves
  2    bad input
  3    the linkage does not move: rigid, or no real configuration
  4    there is no route
  5    for identify: no linkage of the catalogue has this geometry
  6    for verify: something does not hold
  130  interrupted; what was found is shown and written
"""
EXPLORING = (
    click.option(
        "--param",
        "parameters",
        multiple=True,
        metavar="KEY=VALUE",
        help="Parameter of a named linkage, angles in degrees; may be given several times.",
    ),
    click.option(
        "--starts",
        default=200,
        type=click.IntRange(min=1),
        show_default=True,
        help="Random starts.",
    ),
    click.option(
        "--seed",
        default=0,
        type=click.IntRange(min=0),
        show_default=True,
        help="Seed of the random starts.",
    ),
    click.option(
        "--tolerance",
        default=1e-13,
        show_default=True,
        help="How closely curves are followed.",
    ),
    click.option(
        "--budget",
        type=click.FloatRange(min=0, min_open=True),
        default=float("inf"),
        metavar="SECONDS",
        help="End the search after so long, with what was found.  [default: none]",
    ),
    click.option("-v", "--verbose", is_flag=True, help="Say more on standard error."),
)


def exploring(command: Callable[..., Any]) -> Callable[..., Any]:
    """``command`` with the options that say what is explored, and how."""
    for option in reversed(EXPLORING):
        command = option(command)
    return command


class BadInput(click.ClickException):
    """Something the user can mend, said without a traceback."""

    exit_code = int(ExitCode.BAD_INPUT)


class NoRoute(click.ClickException):
    """Two forms or surfaces that no route joins."""

    exit_code = int(ExitCode.NO_ROUTE)


class Commands(click.Group):
    """A group that turns the errors of the library into messages and exit codes."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except BifurcError as error:
            raise BadInput(str(error)) from None
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            ctx.exit(ExitCode.INTERRUPTED)


@click.group(cls=Commands, epilog=EXIT_CODES)
@click.version_option(package_name="bifurc")
def main() -> None:
    """Transition maps of spatial linkages.

    \b
    Examples:
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map my_linkage.toml --json
      bifurc route special-double-subtractive-goldberg "Form I" "Bennett 4R"
    """


@main.command("list")
def list_linkages() -> None:
    """List the linkages of the catalogue.

    \b
    Example:
      bifurc list
    """
    from linkages.app.summary import table
    from linkages.catalogue import catalogue

    rows = [
        (found.name, str(found.build().n), found.title)
        for found in catalogue().values()
    ]
    click.echo(table(("name", "joints", "title"), rows))


@main.command()
@click.argument("name")
def show(name: str) -> None:
    """Show a linkage of the catalogue: source, parameters, conditions, geometry.

    \b
    Example:
      bifurc show bennett
    """
    from linkages.app.summary import describe_entry
    from linkages.catalogue import entry

    click.echo(describe_entry(entry(name)))


@main.command(epilog=EXIT_CODES)
@click.argument("linkage", metavar="FILE.toml|NAME")
@click.option(
    "--tolerance",
    default=1e-8,
    show_default=True,
    help="How far a table may be from the linkage it is.",
)
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print one JSON document and nothing else; angles in radians.",
)
def identify(linkage: str, tolerance: float, as_json: bool) -> None:
    """Name the linkages of the catalogue that a table is a case of, whichever way it is
    read.

    Other first joint, direction, sense of axes and links, mirror image and scale make
    no difference. Where none fits, the nearest are shown with the numbers that are off.

    \b
    Example:
      bifurc identify my_linkage.toml
    """
    from linkages.app.choice import choose_linkage
    from linkages.app.identify import (
        NOT_KNOWN,
        describe_identification,
        make_identification_document,
    )
    from linkages.identification.identify import identify as identify_loop

    found = identify_loop(choose_linkage(linkage).loop, tolerance)
    if as_json:
        import json

        click.echo(json.dumps(make_identification_document(found), allow_nan=False))
    else:
        click.echo(describe_identification(found))
    click.get_current_context().exit(0 if found.matches or found.locked else NOT_KNOWN)


@main.command("map", epilog=EXIT_CODES)
@click.argument("linkage", metavar="NAME|FILE.toml")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for dataset, graph, summary and figures.",
)
@click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print one JSON document and nothing else; angles in radians.",
)
@click.option(
    "--certify",
    is_flag=True,
    help="Prove that no form jumps from one arc to another, and say where.",
)
@click.option(
    "--digits",
    type=click.IntRange(20, 1000),
    help="Find every singular point again in arithmetic of so many digits, and show how many of the map's agree.",
)
@exploring
def map_command(
    linkage: str,
    parameters: tuple[str, ...],
    out: Path | None,
    as_json: bool,
    certify: bool,
    digits: int | None,
    verbose: bool,
    **search: Any,
) -> None:
    """Map every motion form of a linkage, every bifurcation, and the graph between
    them.

    \b
    Examples:
      bifurc map bennett --param alpha=70 --param beta=30
      bifurc map special-double-subtractive-goldberg --out out
      bifurc map my_linkage.toml --json > map.json
      bifurc map special-double-subtractive-goldberg --digits 50
    """
    _listen(verbose)
    if as_json and digits:
        raise BadInput(
            "--digits: it has no place in the JSON document; leave out --json"
        )
    if out is not None:
        _prepare(out)
    with (
        HeldInterrupt()
    ):  # Ctrl-C ends the search, but not before what was found is shown and written
        atlas = _explore(linkage, parameters, certify, **search)
        from linkages.app.summary import make_summary
        from linkages.app.verdict import judge

        verdict, summary = judge(atlas), make_summary(atlas)
        click.echo(_as_json(atlas) if as_json else summary)
        if out is not None:
            from linkages.app.files import write_data, write_figures

            written = write_data(atlas, out, summary)
    if digits:
        from linkages.app.confirmation import describe_confirmation

        click.echo("\n" + describe_confirmation(atlas, linkage, parameters, digits))
    if out is not None:
        written += write_figures(atlas, out)
        click.echo(
            f"wrote {', '.join(path.name for path in written)} to {out}", err=True
        )
    if verdict.code is not ExitCode.MAPPED and as_json:
        click.echo(verdict.sentence, err=True)
    click.get_current_context().exit(verdict.code)


@main.command(epilog=EXIT_CODES)
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.argument("start", metavar="FROM")
@click.argument("goal", metavar="TO")
@exploring
def route(
    source: str,
    start: str,
    goal: str,
    parameters: tuple[str, ...],
    verbose: bool,
    **search: Any,
) -> None:
    """Show how to take a linkage from one form to another, over surfaces where that is
    the way.

    FROM and TO are names of forms or surfaces as `bifurc map` shows them, or the part
    of a name that tells them apart.

    \b
    Examples:
      bifurc route special-double-subtractive-goldberg "Form I" "Bennett 4R"
      bifurc route out/atlas.nc "Form III" "Form IV"
    """
    _listen(verbose)
    atlas = (
        _load(source)
        if source.endswith(".nc")
        else _explore(source, parameters, **search)
    )
    from bifurc.errors import RouteError
    from bifurc.routes.route import find_route
    from linkages.app.summary import describe_route

    names = [atlas.full_name(name) for name in (start, goal)]
    try:
        found = find_route(atlas, names[0], names[1], problem=_problem(atlas))
    except RouteError as error:
        raise NoRoute(str(error)) from None
    click.echo(describe_route(atlas, found, *names))


main.add_command(sweep_command)
main.add_command(tolerance_command)
main.add_command(verify_command)


def _listen(verbose: bool) -> None:
    """Show warnings of the library (and with ``verbose`` all it says) for the time of
    this command."""
    handler = EchoHandler(logging.INFO if verbose else logging.WARNING)
    for name in ("bifurc", "linkages"):
        logger = logging.getLogger(name)
        logger.setLevel(handler.level)
        logger.addHandler(handler)
        click.get_current_context().call_on_close(
            lambda logger=logger: logger.removeHandler(handler)
        )


def _prepare(out: Path) -> None:
    from linkages.app.files import prepare_folder

    try:
        prepare_folder(out)
    except OSError as error:
        raise BadInput(
            f"--out {out}: nothing can be written there ({error.strerror})"
        ) from None


def _explore(
    linkage: str,
    parameters: tuple[str, ...],
    certify: bool = False,
    *,
    tolerance: float,
    starts: int,
    seed: int,
    budget: float,
) -> Atlas:
    from bifurc.curves.continuation import TraceSettings
    from bifurc.search.settings import SearchSettings
    from linkages.app.choice import choose_linkage
    from linkages.mapping import map_linkage

    settings = SearchSettings(
        starts=starts, budget=budget, tracing=TraceSettings(tolerance=tolerance)
    )
    chosen = choose_linkage(linkage, parameters)
    status = StatusLine()
    try:
        with compilation_announced():
            return map_linkage(
                chosen, settings=settings, certify=certify, seed=seed, progress=status
            )
    finally:
        status.wipe()


def _problem(atlas: Atlas) -> Problem:
    """The closure equations of the linkage that an atlas is of."""
    from linkages.closure.loop_closure import LoopClosure
    from linkages.loop import Loop

    linkage = atlas.subject
    return LoopClosure(Loop(linkage["lengths"], linkage["twists"], linkage["offsets"]))


def _as_json(atlas: Atlas) -> str:
    import json

    from linkages.app.document import make_document

    return json.dumps(make_document(atlas), allow_nan=False)


def _load(path: str) -> Atlas:
    from bifurc.files.dataset import AtlasFileError, load_atlas

    try:
        return load_atlas(path)
    except FileNotFoundError:
        raise BadInput(f"{path}: there is no such file") from None
    except AtlasFileError as error:
        raise BadInput(str(error)) from None
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({error.strerror or error})") from None
