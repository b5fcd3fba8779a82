"""The command `bifurc export`: forms and routes for other programs."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from linkages.app import options
from linkages.app.exit_codes import CommandError, exit_code_table

if TYPE_CHECKING:
    from bifurc.atlas import Atlas, Form
    from linkages.export.model import Motion

TO = "--to"
MODEL, TABLE = ".glb", ".csv"
MOTIONS = (MODEL, TABLE)
PARTS = (".stl", ".step")
MECHANISMS = (".mjcf", ".xml", ".sdf")
PICTURES = (".svg", ".dxf")
FEWEST, MOST = 2, 100_000

COMMAND_LINE = ParameterSource.COMMANDLINE

# options that go with some files only: what they are called inside, and with which
TARGETS = {
    "routes": MOTIONS,
    "count": MOTIONS,
    "trace": (TABLE, *PICTURES),
    **dict.fromkeys(("diameter", "play", "wall", "size", "unit", "offsets"), PARTS),
}


@click.command("export", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.option(
    TO,
    "out",
    type=options.FILE,
    required=True,
    metavar="FILE",
    help=(
        "The file: .glb is an animated model, .csv a table of joint angles (rad) and paths, .stl "
        "parts for a printer, laid out, .step the same parts assembled, .mjcf (or .xml) "
        "and .sdf the linkage for simulators, where a form begins, .svg and .dxf a picture of "
        "it, where the page of bifurc view begins."
    ),
)
@options.form_option
@click.option(
    "--route",
    "routes",
    type=(str, str),
    multiple=True,
    metavar="FROM TO",
    help="A route between two forms; may be given several times.",
)
@options.number_option(
    "--count",
    click.IntRange(FEWEST, MOST),
    361,
    "Configurations along each form or route, for .glb and .csv.",
)
@options.trace_option
@options.print_options
@options.atlas_options
def export_command(
    source: str,
    out: Path,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
    trace: tuple[str, ...],
    choice: options.AtlasOptions,
    printing: options.PrintOptions,
) -> None:
    """Write forms and routes of a linkage for other programs.

    Printable parts are links, pins and caps, in mm. Bodies of planar mechanisms lie in
    layers, and slides are slots; elsewhere hinges sit along their axes so
    that no parts meet along the forms; a pin goes through the eyes of two links, and a
    cap is glued or pressed on its end. STL has all parts side by side on the plane
    z = 0, for a slicer to arrange; STEP has named solids where the first form begins.

    \b
    Examples:
      bifurc export bennett --to bennett.glb
      bifurc export altmann --form 1 --to altmann.csv --count 100
      bifurc export four-bar --form 1 --to coupler.csv --trace 23:1,0.5
      bifurc export out/atlas.nc --route "Form I" "Bennett 4R" --to route.glb
      bifurc export bennett --to bennett.stl --size 120 --diameter 8
      bifurc export slider_crank.toml --to slider_crank.step
      bifurc export bennett --to bennett.mjcf
      bifurc export four-bar --to four_bar.dxf
    """
    from linkages.app.answer.verdict import exit_by, judge
    from linkages.app.output import require_ending, require_writable, say_next
    from linkages.app.texts.form_names import require_forms
    from linkages.app.texts.next_steps import chosen_linkage

    require_ending(TO, out, *MOTIONS, *PARTS, *MECHANISMS, *PICTURES)
    check_options(out)
    check_count_of_forms(out, forms)
    require_writable(out, TO)
    atlas = choose_atlas(source, out, choice)
    if forms or not is_one_of(out, PICTURES):  # what is rigid can be drawn
        require_forms(atlas)
    if is_one_of(out, PARTS):
        export_parts(atlas, forms, printing, choice.search.seed, out)
    elif is_one_of(out, MECHANISMS):
        export_mechanism(atlas, forms, out)
    elif is_one_of(out, PICTURES):
        export_picture(atlas, forms, trace, out)
    else:
        export_motions(atlas, forms, routes, count, trace, out)
    if is_one_of(out, MECHANISMS):
        say_next(f"bifurc map {shlex.quote(str(out))}")
    else:
        chosen = chosen_linkage(source, choice.parameters, choice.hold)
        say_next(f"bifurc view {chosen}")
    exit_by(judge(atlas))


def is_one_of(out: Path, endings: tuple[str, ...]) -> bool:
    """Whether the name of a file has one of the endings, in capitals or not."""
    return out.name.lower().endswith(endings)


def check_options(out: Path) -> None:
    """Raise `CommandError` for options on the command line that have no effect on the
    file, and where parts cannot be made."""
    context = click.get_current_context()
    for option in context.command.params:
        endings = TARGETS.get(option.name or "")
        if endings is None or is_one_of(out, endings):
            continue
        if context.get_parameter_source(option.name or "") is not COMMAND_LINE:
            continue
        raise CommandError(
            f"{option.opts[0]}: it has no effect on {out.name}; it goes with "
            f"{' and '.join(endings)}"
        )
    if is_one_of(out, PARTS):
        from linkages.app.reports.printing import require_cad

        require_cad(out)


def check_count_of_forms(out: Path, forms: tuple[str, ...]) -> None:
    """Raise `CommandError` for several forms where the file holds one configuration."""
    if is_one_of(out, MECHANISMS + PICTURES) and len(forms) > 1:
        raise CommandError(
            f"--form {forms[1]}: {out.name} holds one configuration; name one form"
        )


def choose_atlas(source: str, out: Path, choice: options.AtlasOptions) -> Atlas:
    """The atlas that is exported; raises `CommandError` for a mechanism where the file
    takes single loops only, or planar ones besides."""
    from linkages.app.atlas_source import atlas_of, is_atlas_file, loop_atlas_of
    from linkages.app.reports.stacking import is_stacked

    if is_one_of(out, MOTIONS + PICTURES):
        return atlas_of(source, choice)
    if not is_one_of(out, PARTS):
        return loop_atlas_of(source, choice)
    if is_atlas_file(source):
        # it is that of the seats of hinges
        choice = replace(choice, search=replace(choice.search, seed=0))
    return loop_atlas_of(source, choice, is_stacked)


def export_parts(
    atlas: Atlas,
    texts: tuple[str, ...],
    printing: options.PrintOptions,
    seed: int,
    out: Path,
) -> None:
    """Write printable parts; say where hinges sit, or in which layers bodies lie, and how
    near parts come.

    Raises `CommandError` where parts meet: with offsets that were given after the file
    is written, else without any.
    """
    from linkages.app.output import say, writing_to
    from linkages.app.reports.printing import (
        describe_meetings,
        describe_seating,
        interference_error,
        meetings_along,
        seat_hinges,
        write_parts,
    )
    from linkages.app.reports.stacking import is_stacked
    from linkages.app.texts.form_names import choose_forms
    from linkages.subject import subject_at

    forms = choose_forms(atlas, texts)
    if is_stacked(subject_at(atlas)):
        export_stack(atlas, forms, printing, out)
        return
    seating = seat_hinges(atlas, forms, printing, seed)
    say(describe_seating(seating))
    if not seating.is_apart:
        say(describe_meetings(atlas, seating, meetings_along(seating, forms)))
    if seating.is_apart or printing.offsets is not None:
        with writing_to(out, TO):
            write_parts(atlas, forms[0], seating, out)
        click.echo(f"wrote {out}", err=True)
    if not seating.is_apart:
        raise interference_error(seating, printing)


def export_stack(
    atlas: Atlas, forms: list[Form], printing: options.PrintOptions, out: Path
) -> None:
    """Write printable parts of a planar mechanism; raises `CommandError` where they meet
    in all layers."""
    from linkages.app.output import say, writing_to
    from linkages.app.reports.stacking import (
        describe_stack,
        stack_error,
        stack_of,
        write_stack,
    )

    stack = stack_of(atlas, forms, printing)
    say(describe_stack(atlas, stack))
    if stack.layers.meetings:
        raise stack_error(atlas, stack)
    with writing_to(out, TO):
        write_stack(atlas, forms[0], stack, out)
    click.echo(f"wrote {out}", err=True)


def export_mechanism(atlas: Atlas, texts: tuple[str, ...], out: Path) -> None:
    """Write the linkage where the first of the forms begins."""
    from linkages.app.output import write_content
    from linkages.app.texts.form_names import choose_forms
    from linkages.formats.table import mechanism_text
    from linkages.labels import loop_of
    from linkages.mechanisms.of_loop import mechanism_of_loop

    form = choose_forms(atlas, texts)[0]
    mechanism = mechanism_of_loop(loop_of(atlas), form.branch(0.0))
    write_content(out, mechanism_text(mechanism, out), TO)
    click.echo(f"wrote {out}: {form.name}", err=True)


def export_picture(
    atlas: Atlas, forms: tuple[str, ...], trace: tuple[str, ...], out: Path
) -> None:
    """Write the picture of a linkage where a form, or else the map, is first shown, with
    the paths of the points of a ``trace``."""
    from linkages.app.output import write_content
    from linkages.app.texts.form_names import choose_form
    from linkages.pictures.dxf import make_dxf
    from linkages.pictures.plot_linkage import painter_of, place_of, plot_linkage

    name = choose_form(atlas, forms[0]).name if forms else None
    content: str | bytes
    if is_one_of(out, (".dxf",)):
        place = place_of(atlas, name, None)
        content = make_dxf(painter_of(atlas, place, trace).picture(place.point))
    else:
        from bifurc.figures.plotting import RESOLUTION
        from bifurc.figures.rendering import contents_of

        figure = plot_linkage(atlas, name, trace=trace)
        content = contents_of(figure, RESOLUTION, ["svg"])["svg"]
    write_content(out, content, TO)
    click.echo(f"wrote {out}", err=True)


def export_motions(
    atlas: Atlas,
    forms: tuple[str, ...],
    routes: tuple[tuple[str, str], ...],
    count: int,
    trace: tuple[str, ...],
    out: Path,
) -> None:
    """Write the motions along forms and routes, in a table with the paths of the points
    of a ``trace``."""
    from linkages.app.motions import choose_motions
    from linkages.app.output import write_content
    from linkages.app.texts.form_names import choose_forms

    motions = choose_motions(atlas, forms, routes, count)
    chosen = choose_forms(atlas, () if routes else forms)
    write_content(out, make_content(atlas, motions, chosen, trace, out), TO)
    names = ", ".join(motion.name for motion in motions)
    click.echo(f"wrote {out}: {names}", err=True)


def make_content(
    atlas: Atlas,
    motions: list[Motion],
    forms: list[Form],
    trace: tuple[str, ...],
    out: Path,
) -> bytes:
    """What the file of that ending holds; bodies of a planar mechanism lie in the layers
    in which they pass each other along ``forms``."""
    if is_one_of(out, (TABLE,)):
        if len(motions) != 1:
            raise CommandError(
                f"--to {out}: a table holds one form or route, and there are "
                f"{len(motions)}; name one with --form or --route"
            )
        return make_table(atlas, motions[0], trace).encode("utf-8")
    from bifurc.release import installed_version
    from linkages.app.reports.layers import parts_in_layers
    from linkages.export.glb import make_glb
    from linkages.export.model import model_of
    from linkages.subject import subject_at

    parts = parts_in_layers(atlas, forms)
    model = model_of(parts, subject_at(atlas).name, motions)
    return make_glb(model, f"bifurc {installed_version()}")


def make_table(atlas: Atlas, motion: Motion, trace: tuple[str, ...] = ()) -> str:
    """The joint variables along a motion: angles of a loop, or all variables of a
    mechanism and the unit quaternions of its spherical joints; then the coordinates of
    the points of a ``trace``."""
    import numpy as np

    from linkages.export.model import make_angle_table
    from linkages.links.traced_points import traced_columns
    from linkages.subject import subject_at

    subject, points = subject_at(atlas), motion.configurations
    names, values = subject.joint_values(points)
    heads, columns = traced_columns(subject.flat_parts, trace, points)
    table = np.concatenate([values, columns], axis=1)
    return make_angle_table(motion.arclength, table, [*names, *heads])
