"""The command `bifurc route`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table
from linkages.app.options import (
    SearchOptions,
    param_option,
    search_options,
    verbose_option,
)

if TYPE_CHECKING:
    from bifurc.atlas import Atlas
    from bifurc.routes.route import Route

__all__ = ["route_command"]


@click.command("route", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.argument("start", metavar="FROM")
@click.argument("goal", metavar="TO")
@param_option
@search_options
@verbose_option
def route_command(
    source: str,
    start: str,
    goal: str,
    parameters: tuple[str, ...],
    verbose: bool,
    search: SearchOptions,
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
    from linkages.app.atlas_source import atlas_of
    from linkages.app.output import say
    from linkages.app.route_text import describe_route
    from linkages.app.status import say_more
    from linkages.app.verdict import judge

    if verbose:
        say_more()
    atlas = atlas_of(source, parameters, search)
    if not atlas.forms and not atlas.surfaces:
        verdict = judge(atlas)
        raise CommandError(verdict.sentence, verdict.code)
    start_name = atlas.full_name(start)
    goal_name = atlas.full_name(goal)
    route = _route_between(atlas, start_name, goal_name)
    say(describe_route(atlas, route, start_name, goal_name))


def _route_between(atlas: Atlas, start: str, goal: str) -> Route:
    """The shortest route between two forms or surfaces; raises `CommandError` where
    there is none."""
    from bifurc.errors import RouteError
    from bifurc.routes.route import find_route
    from linkages.app.equations import equations_of

    try:
        return find_route(atlas, start, goal, problem=equations_of(atlas))
    except RouteError as error:
        raise CommandError(str(error), ExitCode.NO_ROUTE) from None
