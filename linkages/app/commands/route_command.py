"""The command `bifurc route`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from linkages.app import options
from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table

if TYPE_CHECKING:
    from bifurc.atlas import Atlas


COSTS = ("length", "bifurcations", "travel")
MOST = 100  # routes that are shown


@click.command("route", epilog=exit_code_table())
@click.argument("source", metavar="NAME|FILE.toml|ATLAS.nc")
@click.argument("start", metavar="[FROM]", required=False)
@click.argument("goal", metavar="[TO]", required=False)
@click.option(
    "--from",
    "start_locks",
    metavar="LOCKS[@ANGLES]",
    help="Locks of a network at the start, and D-H angles of other outer joints there.",
)
@click.option(
    "--to",
    "goal_locks",
    metavar="LOCKS[@ANGLES]",
    help="The same at the goal.",
)
@click.option(
    "--avoid",
    multiple=True,
    metavar="NAME",
    help="A singular point, form or surface that the way must not pass; several times.",
)
@click.option(
    "--through",
    multiple=True,
    metavar="NAME",
    help="One that it must pass; may be given several times, in any order.",
)
@click.option(
    "--cost",
    type=click.Choice(COSTS),
    default=COSTS[0],
    show_default=True,
    help=(
        "What is to be small: the length, the number of singular points on the way, "
        "or the travel of the joint that travels farthest."
    ),
)
@options.number_option(
    "--best", click.IntRange(1, MOST), 1, "Show so many ways, the best first."
)
@options.json_option("; lengths and travels in radians")
@options.atlas_options
def route_command(
    source: str,
    start: str | None,
    goal: str | None,
    start_locks: str | None,
    goal_locks: str | None,
    avoid: tuple[str, ...],
    through: tuple[str, ...],
    cost: str,
    best: int,
    as_json: bool,
    choice: options.AtlasOptions,
) -> None:
    """Show how to take a linkage from one form to another, over surfaces where that is
    the way.

    FROM and TO are names of forms or surfaces as `bifurc map` shows them, or the part
    of a name that tells them apart. For a network --from and --to say which outer
    joints are locked; on the way locks are exchanged.

    \b
    Examples:
      bifurc route special-double-subtractive-goldberg "Form I" "Bennett 4R"
      bifurc route out/atlas.nc "Form III" "Form IV" --avoid B2 --best 3
      bifurc route out/atlas.nc "Form I" "Form IV" --through "Form II" --cost travel
      bifurc route five_bar.toml --lock J1=40 "Form 1" "Form 2"
      bifurc route four-bennett-network --from "2=40,6=-75@p4=90" --to "2=40,4=90"
    """
    from bifurc.routes.wishes import Cost, Wishes
    from linkages.app.answer.verdict import judge
    from linkages.app.atlas_source import atlas_of, routes_between
    from linkages.app.output import say, say_json
    from linkages.app.texts.route_text import describe_routes, document_of_routes

    if start_locks is not None or goal_locks is not None:
        if start is not None:
            raise CommandError("--from, --to: they replace the names FROM and TO")
        if choice.hold != options.HoldOptions():
            raise CommandError(
                f"{choice.hold.names}: --from and --to say which joints are locked"
            )
        require_defaults("avoid", "through", "cost", "best", "as_json")
        _route_over_locks(source, start_locks, goal_locks, choice)
        return
    if start is None or goal is None:
        missing = "FROM" if start is None else "TO"
        raise click.UsageError(f"Missing argument '{missing}'.")
    atlas = atlas_of(source, choice)
    if not atlas.forms and not atlas.surfaces:
        verdict = judge(atlas)
        raise CommandError(verdict.sentence, verdict.code)
    ends = atlas.full_name(start), atlas.full_name(goal)
    wishes = Wishes(avoid, through, Cost(cost))
    routes = routes_between(atlas, *ends, best, wishes)
    if as_json:
        say_json(document_of_routes(routes))
        return
    say(describe_routes(atlas, routes, *ends))
    say_steps(source, choice, start, goal)


def say_steps(source: str, choice: options.AtlasOptions, start: str, goal: str) -> None:
    """Say what can be done next with the way between two forms."""
    from linkages.app.output import say_next
    from linkages.app.texts.next_steps import chosen_linkage, steps_after_a_route

    chosen = chosen_linkage(source, choice.parameters, choice.hold)
    say_next(*steps_after_a_route(chosen, start, goal))


def require_defaults(*names: str) -> None:
    """Raise `CommandError` for options that do not go with locks."""
    context = click.get_current_context()
    for option in context.command.params:
        source = context.get_parameter_source(option.name or "")
        if option.name in names and source is ParameterSource.COMMANDLINE:
            raise CommandError(f"{option.opts[0]}: it does not go with --from and --to")


def _route_over_locks(
    source: str,
    start: str | None,
    goal: str | None,
    choice: options.AtlasOptions,
) -> None:
    """Show the route of a network over its locks; raises `CommandError` where there is
    none, or the source is no network."""
    from bifurc.errors import RouteError
    from linkages.app.atlas_source import explore_linkage, require_uninterrupted
    from linkages.app.choice import choose_linkage, require_kind
    from linkages.app.output import say
    from linkages.app.texts.route_text import describe_lock_route, read_place
    from linkages.networks.entries import NETWORKS
    from linkages.networks.lock_routes import find_lock_route
    from linkages.networks.mechanism import NetworkMechanism, lock_network

    refusal = f"--from, --to: they take a network: {', '.join(NETWORKS)}"
    if source not in NETWORKS:
        raise CommandError(refusal)
    if start is None or goal is None:
        raise CommandError("--from, --to: both must be given")
    named = choose_linkage(source, choice.parameters)
    chosen = require_kind(named, NetworkMechanism, refusal)
    network = chosen.placed.network
    places = [
        read_place(text, option, chosen)
        for option, text in (("--from", start), ("--to", goal))
    ]
    uncertified = replace(choice.search, certify=False)

    def explore(mechanism: NetworkMechanism) -> Atlas:
        atlas = explore_linkage(mechanism, uncertified)
        require_uninterrupted(atlas)
        return atlas

    try:
        route = find_lock_route(network, places[0], places[1], explore)
    except RouteError as error:
        raise CommandError(str(error), ExitCode.NO_ROUTE) from None
    locked = lock_network(network, places[1].locks)
    say(describe_lock_route(route, locked, explore(locked)))
