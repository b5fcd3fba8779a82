"""The command `bifurc animate`: a linkage that moves, as GIF or MP4."""

from __future__ import annotations

from pathlib import Path

import click

from linkages.app import options
from linkages.app.exit_codes import CommandError, exit_code_table

ENDINGS = (".gif", ".mp4")
SIZE = (4.8, 4.0)  # inches
FEWEST, MOST = 2, 5000


@click.command("animate", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.option(
    "--out",
    type=options.FILE,
    required=True,
    metavar="FILE",
    help="The moving picture: .gif, or .mp4 by ffmpeg, installed or of the extra movies.",
)
@click.option(
    "--form",
    "forms",
    multiple=True,
    metavar="FORM",
    help="A form, by its name or its number in the summary; of several one is shown "
    "after another.  [default: the form as drawn, or the first]",
)
@click.option(
    "--route",
    type=(str, str),
    metavar="FROM TO",
    help="The shortest route between two forms, in place of a form.",
)
@options.number_option(
    "--count", click.IntRange(FEWEST, MOST), 100, "Pictures of each form, 25 a second."
)
@click.option(
    "--size",
    type=options.Pair("x", "4.8x4.0"),
    callback=options.check_size,
    default=SIZE,
    metavar="WxH",
    help="Width and height in inches of 100 pixels.  [default: 4.8x4.0]",
)
@options.trace_option
@options.atlas_options
def animate_command(
    source: str,
    out: Path,
    forms: tuple[str, ...],
    route: tuple[str, str] | None,
    count: int,
    size: tuple[float, float],
    trace: tuple[str, ...],
    choice: options.AtlasOptions,
) -> None:
    """Show a linkage that moves along a form or a route: straight from above where it
    is planar, else from where its joints are seen farthest apart.

    \b
    Examples:
      bifurc animate bennett --out bennett.gif
      bifurc animate four-bar --form 1 --form 2 --out both.gif --size 3.4x3.4
      bifurc animate four-bar --out coupler.gif --trace 23:1,0.5
      bifurc animate out/atlas.nc --route "Form I" "Form II" --out route.mp4
    """
    from bifurc.files.atomic import replace_file
    from linkages.app.answer.verdict import exit_by, judge
    from linkages.app.atlas_source import atlas_of
    from linkages.app.motions import choose_motions
    from linkages.app.output import require_ending, require_writable, writing_to
    from linkages.app.texts.form_names import require_forms
    from linkages.pictures.animation import movie_writer, write_animation
    from linkages.viewing.start import first_place

    if forms and route is not None:
        raise CommandError("--form: it does not go with --route")
    require_ending("--out", out, *ENDINGS)
    require_writable(out)
    movie_writer(out)  # an error before anything is computed
    atlas = atlas_of(source, choice)
    require_forms(atlas)
    routes = () if route is None else (route,)
    if not forms and route is None:
        place = first_place(atlas)
        forms = (atlas.forms[place.form or 0].name,)
    shown = choose_motions(atlas, forms, routes, count)
    with writing_to(out):
        replace_file(out, lambda part: write_animation(atlas, shown, size, part, trace))
    names = ", ".join(motion.name for motion in shown)
    click.echo(f"wrote {out}: {names}", err=True)
    exit_by(judge(atlas))
