"""The command `bifurc follow`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app import options
from linkages.app.exit_codes import CommandError, exit_code_table

if TYPE_CHECKING:
    from linkages.parameters.members import Members


@click.command("follow", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME")
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
    """Follow the singular points of a linkage while one or two of its parameters move,
    with every condition of its family kept.

    A parameter is free as --param gamma or --param gamma=10:20, and has a value as --param
    gamma=14; angles are in degrees. What is there for all values of one parameter is
    followed over that; what is there for one value alone is followed over two.

    \b
    Examples:
      bifurc follow special-double-subtractive-goldberg --point B1 --param alpha
      bifurc follow spherical-four-bar --param alpha12=40:120 --param alpha23=40:120
    """
    from linkages.app.atlas_source import explore_linkage, require_uninterrupted
    from linkages.app.output import require_folder, say, say_json
    from linkages.app.parameter_ranges import choose_members
    from linkages.app.texts.parameters_text import describe_followed, followed_document
    from linkages.parameters.followed import follow_points

    require_folder(out)
    members, refusals = choose_members(linkage, parameters, most=2)
    search = options.SearchOptions(certify=False)
    atlas = explore_linkage(members.load(members.start), search)
    require_uninterrupted(atlas)
    known = [point.name for point in atlas.points]
    for name in names:
        if name not in known:
            there = ", ".join(known) or "none"
            raise CommandError(f"--point {name}: the points are {there}")
    points = [one for one in atlas.points if not names or one.name in names]
    if not points:
        raise CommandError(f"{linkage}: it has no singular point there to follow")
    followed = follow_points(members, points)
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
    members: Members, linkage: str, parameters: tuple[str, ...], has_files: bool
) -> None:
    """Say what can be done next with the family."""
    from linkages.app.output import say_next
    from linkages.app.texts.next_steps import steps_with_members

    if len(members.free) == 1:
        say_next(steps_with_members("special", linkage, parameters))
    elif not has_files:
        say_next(steps_with_members("follow", linkage, parameters) + " --out DIR")
