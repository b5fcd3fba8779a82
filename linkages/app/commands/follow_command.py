"""The command `bifurc follow`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app import options
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from linkages.parameters.members import FreeParameters


@click.command("follow", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@click.option(
    "--point",
    "names",
    multiple=True,
    metavar="POINT",
    help="A singular point, by its name in the summary.  [default: every point]",
)
@options.free_param_option
@options.json_option("; angles in radians")
@options.out_option("follow.txt, .json and .png")
def follow_command(
    linkage: str,
    names: tuple[str, ...],
    parameters: tuple[str, ...],
    as_json: bool,
    out: Path | None,
) -> None:
    """Follow the singular points of a linkage or of equations while one or two parameters
    move, of a family with every condition kept.

    A parameter is free as --param gamma or --param gamma=10:20, and has a value as --param
    gamma=14; angles are in degrees. What is there for all values of one parameter is
    followed over that; what is there for one value alone is followed over two. Of a file
    numbers are the parameters: entries of a table (a12, alpha12, R1), lengths of bars
    (A-B), coordinates of joints (J1.x); of equations the constants, as --param c=0.5:2,
    besides the parameter of the diagram, whose folds are followed too.

    \b
    Examples:
      bifurc follow special-double-subtractive-goldberg --point B1 --param alpha
      bifurc follow spherical-four-bar --param alpha12=40:120 --param alpha23=40:120
      bifurc follow reaction.toml --point F1 --param B=8:20
    """
    from linkages.app.output import require_folder, say, say_json
    from linkages.app.texts.parameters_text import describe_followed, followed_document
    from linkages.parameters.followed import follow_points

    require_folder(out)
    members, refusals, atlas = _atlas_of(linkage, parameters)
    points = members.points(atlas)
    if not points:
        nothing = "no singular point there to follow, and no fold of a diagram"
        raise CommandError(f"{linkage}: it has {nothing}")
    known = [point.name for point in points]
    for name in names:
        if name not in known:
            allowed = f"one of those that are followed: {', '.join(known)}"
            raise CommandError(
                f"--point: {name!r} is not allowed; it must be {allowed}"
            )
    chosen = [one for one in points if not names or one.name in names]
    followed = follow_points(members, chosen)
    text = describe_followed(members, refusals, followed)
    document = followed_document(members, followed)
    if out is not None:
        from linkages.app.reports.follow_files import write_followed

        write_followed(members, followed, text, document, out)
    if as_json:
        say_json(document)
        return
    say(text)
    say_steps(members, linkage, parameters, out is not None)


def say_steps(
    members: FreeParameters, linkage: str, parameters: tuple[str, ...], has_files: bool
) -> None:
    """Say what can be done next with the family."""
    from linkages.app.output import say_next
    from linkages.app.texts.next_steps import steps_with_members

    if len(members.free) == 1:
        say_next(steps_with_members("special", linkage, parameters))
    elif not has_files:
        say_next(steps_with_members("follow", linkage, parameters) + " --out DIR")


def _atlas_of(
    source: str, parameters: tuple[str, ...]
) -> tuple[FreeParameters, dict[str, str], Atlas]:
    """What has free parameters, why there are no members beyond the range of one, and the
    atlas of the member from which they move."""
    from bifurc.systems.equation_file import holds_equations
    from bifurc.systems.verdict import verdict_of
    from linkages.app.atlas_source import explore_linkage, require_uninterrupted
    from linkages.app.equation_source import explore_system
    from linkages.app.parameter_ranges import choose_equations, choose_members
    from linkages.linkage import is_linkage_file

    search = options.SearchOptions(certify=False)
    if is_linkage_file(source) and holds_equations(source):
        equations = choose_equations(source, parameters)
        atlas = explore_system(equations.system, search)
        if atlas.provenance.interrupted:
            raise CommandError(verdict_of(atlas), ExitCode.INTERRUPTED)
        return equations, {}, atlas
    members, refusals = choose_members(source, parameters, most=2)
    atlas = explore_linkage(members.load(members.start), search)
    require_uninterrupted(atlas)
    return members, refusals, atlas
