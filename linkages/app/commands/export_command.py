"""The command `bifurc export`: forms and routes for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table
from linkages.app.options import (
    SearchOptions,
    form_option,
    param_option,
    search_options,
    verbose_option,
)
from linkages.app.print_options import PrintOptions, print_options

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from linkages.export.motion import Motion

__all__ = ["export_command"]

MODEL, TABLE = ".glb", ".csv"
LAID_OUT, ASSEMBLED = ".stl", ".step"
MECHANISMS = (".xml", ".mjcf", ".sdf")
FEWEST, MOST = 2, 100_000


@click.command("export", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.option(
    "--to",
    "out",
    type=click.Path(path_type=Path, dir_okay=False),
    required=True,
    metavar="FILE",
    help=(
        "The file: .glb is an animated model, .csv a table of joint angles (rad), .stl "
        "parts for a printer, laid out, .step the same parts assembled, .mjcf (or .xml) "
        "and .sdf the linkage for simulators, where a form begins."
    ),
)
@form_option
@click.option(
    "--route",
    "routes",
    type=(str, str),
    multiple=True,
    metavar="FROM TO",
    help="A route between two forms; may be given several times.",
)
@click.option(
    "--count",
    type=click.IntRange(FEWEST, MOST),
    default=361,
    show_default=True,
    help="Configurations along each form or route, for .glb and .csv.",
)
@print_options
@param_option
@search_options
@verbose_option
def export_command(
    source: str,
    out: Path,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
    parameters: tuple[str, ...],
    verbose: bool,
    search: SearchOptions,
    printing: PrintOptions,
) -> None:
    """Write forms and routes of a linkage for other programs.

    Printable parts are links, pins and caps, in mm. Hinges sit along their axes so
    that no parts meet along the forms; a pin goes through the eyes of two links, and a
    cap is glued or pressed on its end. STL has all parts side by side on the plane
    z = 0, for a slicer to arrange; STEP has named solids where the first form begins.

    \b
    Examples:
      bifurc export bennett --to bennett.glb
      bifurc export altmann --form 1 --to altmann.csv --count 100
      bifurc export out/atlas.nc --route "Form I" "Bennett 4R" --to route.glb
      bifurc export bennett --to bennett.stl --size 120 --diameter 8
      bifurc export bennett --to bennett.mjcf
    """
    from linkages.app.atlas_source import loop_atlas_of
    from linkages.app.forms import require_forms
    from linkages.app.output import require_ending, require_writable
    from linkages.app.status import say_more
    from linkages.app.verdict import exit_by, judge

    if verbose:
        say_more()
    require_ending("--to", out, MODEL, TABLE, LAID_OUT, ASSEMBLED, *MECHANISMS)
    is_printed = out.name.lower().endswith((LAID_OUT, ASSEMBLED))
    is_mechanism = out.name.lower().endswith(MECHANISMS)
    if is_mechanism and routes:
        start, goal = routes[0]
        raise CommandError(
            f"--route {start!r} {goal!r}: it has no effect on {out.name}, which holds "
            "one configuration, where the first form begins; name it with --form"
        )
    if is_printed:
        check_print_options(out, routes)
    elif printing != PrintOptions():
        raise CommandError(
            "--diameter, --play, --wall, --size, --unit, --offsets: they have no effect "
            f"on {out.name}, which is neither {LAID_OUT} nor {ASSEMBLED}"
        )
    require_writable(out)
    atlas = loop_atlas_of(source, parameters, search)
    require_forms(atlas)
    if is_printed:
        export_parts(atlas, forms, printing, search.seed, out)
    elif is_mechanism:
        export_mechanism(atlas, forms, out)
    else:
        export_motions(atlas, forms, routes, count, out)
    exit_by(judge(atlas))


def check_print_options(out: Path, routes: tuple[tuple[str, str], ...]) -> None:
    """Raise `CommandError` where parts cannot be made, or not for routes."""
    from linkages.app.printing import require_cad

    if routes:
        start, goal = routes[0]
        raise CommandError(
            f"--route {start!r} {goal!r}: it has no effect on {out.name}, whose parts "
            "are kept apart along forms; name these with --form"
        )
    require_cad(out)


def export_parts(
    atlas: Atlas, texts: tuple[str, ...], printing: PrintOptions, seed: int, out: Path
) -> None:
    """Write printable parts; say where hinges sit and how near parts come.

    Raises `CommandError` where parts meet: with offsets that were given after the file
    is written, else without any.
    """
    from linkages.app.forms import choose_forms
    from linkages.app.output import say, writing_to
    from linkages.app.printing import (
        describe_meetings,
        describe_seating,
        interference_error,
        meetings_along,
        seat_hinges,
        write_parts,
    )

    forms = choose_forms(atlas, texts)
    seating = seat_hinges(atlas, forms, printing, seed)
    say(describe_seating(seating))
    if not seating.is_apart:
        say(describe_meetings(atlas, seating, meetings_along(seating, forms)))
    if seating.is_apart or printing.offsets is not None:
        with writing_to(out):
            write_parts(atlas, forms[0], seating, out)
        click.echo(f"wrote {out}", err=True)
    if not seating.is_apart:
        raise interference_error(seating, printing)


def export_mechanism(atlas: Atlas, texts: tuple[str, ...], out: Path) -> None:
    """Write the linkage where the first of the forms begins."""
    from bifurc.files.atomic import replace_file
    from linkages.app.forms import choose_forms
    from linkages.app.mechanism_file import mechanism_text
    from linkages.app.output import writing_to
    from linkages.labels import loop_of
    from linkages.mechanisms.of_loop import mechanism_of_loop

    form = choose_forms(atlas, texts)[0]
    mechanism = mechanism_of_loop(loop_of(atlas), form.branch(0.0))
    text = mechanism_text(mechanism, out)
    with writing_to(out):
        replace_file(out, lambda part: part.write_text(text, encoding="utf-8"))
    click.echo(f"wrote {out}: {form.name}", err=True)


def export_motions(
    atlas: Atlas,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
    out: Path,
) -> None:
    """Write the motions along forms and routes."""
    from bifurc.files.atomic import replace_file
    from linkages.app.output import writing_to

    motions = choose_motions(atlas, forms, routes, count)
    content = make_content(atlas, motions, out)
    with writing_to(out):
        replace_file(out, lambda part: part.write_bytes(content))
    names = ", ".join(motion.name for motion in motions)
    click.echo(f"wrote {out}: {names}", err=True)


def choose_motions(
    atlas: Atlas,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
) -> list[Motion]:
    """The motions along forms and routes, all forms where neither is named."""
    from linkages.app.forms import choose_forms
    from linkages.export.motion import motion_of_form

    chosen = choose_forms(atlas, forms) if forms or not routes else []
    motions = [motion_of_form(form, count) for form in chosen]
    for start, goal in routes:
        motion = make_route_motion(atlas, start, goal, count)
        if motion.name in [other.name for other in motions]:
            raise CommandError(
                f"--route {start!r} {goal!r}: the route from {motion.name} is named "
                "already, and may be only once"
            )
        motions.append(motion)
    return motions


def make_route_motion(atlas: Atlas, start: str, goal: str, count: int) -> Motion:
    """The motion along the shortest route between two forms.

    Raises `CommandError` for an unknown form, where there is no route, and for one
    without length.
    """
    from bifurc.errors import RouteError
    from bifurc.routes.route import find_route
    from linkages.closure.loop_closure import LoopClosure
    from linkages.export.motion import motion_of_route
    from linkages.labels import loop_of

    option = f"--route {start!r} {goal!r}"
    try:
        first, last = atlas.full_name(start), atlas.full_name(goal)
    except RouteError as error:
        raise CommandError(f"{option}: {error}") from None
    problem = LoopClosure(loop_of(atlas))
    try:
        route = find_route(atlas, first, last, problem=problem)
    except RouteError as error:
        raise CommandError(str(error), ExitCode.NO_ROUTE) from None
    if not route.legs:
        raise CommandError(
            f"{option}: it begins and ends in one configuration of {first!r}; name two "
            "different forms, or --form for all of one"
        )
    return motion_of_route(atlas, route, f"{first} to {last}", count)


def make_content(atlas: Atlas, motions: list[Motion], out: Path) -> bytes:
    """What the file of that ending holds."""
    from linkages.labels import loop_of

    if out.name.lower().endswith(TABLE):
        from linkages.export.angle_table import make_angle_table

        if len(motions) != 1:
            raise CommandError(
                f"--to {out}: a table holds one form or route, and there are "
                f"{len(motions)}; name one with --form or --route"
            )
        return make_angle_table(motions[0], atlas.names).encode("utf-8")
    from importlib.metadata import version

    from linkages.export.glb import make_glb

    generator = f"bifurc {version('bifurc')}"
    return make_glb(loop_of(atlas), motions, generator)
