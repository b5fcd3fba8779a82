"""The command `bifurc special`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

from linkages.app import options
from linkages.app.exit_codes import ExitCode, exit_code_table

if TYPE_CHECKING:
    from linkages.parameters.members import Members
    from linkages.parameters.special import SpecialValues


@click.command("special", epilog=exit_code_table())
@click.argument("linkage", metavar="NAME|FILE.toml")
@options.free_param_option
@click.option(
    "--relations",
    is_flag=True,
    help="Find each value to 50 digits, and a simple relation of the parameters that "
    "it follows; check it at random members.",
)
@options.SEARCH_OPTIONS["budget"]
@options.json_option("; angles in radians")
def special_command(
    linkage: str,
    parameters: tuple[str, ...],
    relations: bool,
    as_json: bool,
    budget: float,
) -> None:
    """Find the values of a parameter at which the map of a linkage changes: a bifurcation
    appears or vanishes, forms become one, or a form comes from nothing.

    Every value is the solution of equations, and is known to nearly all digits of a
    double; maps beside it and at it show what changes. The parameter is free as --param
    gamma or --param gamma=10:20, others have values; angles are in degrees. Of a file
    numbers are the parameters: entries of a table (a12, alpha12, R1), lengths of bars
    (A-B), coordinates of joints (J1.x).

    \b
    Examples:
      bifurc special four-bar --param d=0.3:7
      bifurc special spherical-four-bar --param alpha12=20:160 --relations
      bifurc special six_bar.toml --param A-B=0.5:2
    """
    from bifurc.limits import Deadline
    from linkages.app.output import say, say_json, say_next
    from linkages.app.parameter_ranges import choose_members
    from linkages.app.texts.parameters_text import changes_document, describe_changes
    from linkages.parameters.relations import precise_changes
    from linkages.parameters.special import special_values

    members, refusals = choose_members(linkage, parameters, most=1)
    deadline = Deadline(budget)
    special = special_values(members, deadline=deadline)
    precise = precise_changes(members, special.changes, deadline) if relations else None
    if as_json:
        say_json(changes_document(members, special, precise))
    else:
        (refusal,) = refusals.values()
        say(describe_changes(members, refusal, special, precise))
        say_next(*steps_after(linkage, parameters, members, special))
    is_whole = special.is_whole
    if precise is not None:
        is_whole = is_whole and len(precise) == len(special.changes)
    if not is_whole and not math.isfinite(budget):
        click.get_current_context().exit(ExitCode.INTERRUPTED)


def steps_after(
    linkage: str, parameters: tuple[str, ...], members: Members, special: SpecialValues
) -> list[str]:
    """The map at the first value, and what becomes of points over the others."""
    from linkages.app.texts.next_steps import steps_with_members
    from linkages.app.texts.parameters_text import typed

    steps = []
    if special.changes:
        (free,) = members.free
        value = typed(free, special.changes[0].value)
        steps.append(steps_with_members("map", linkage, parameters, value))
    return [*steps, steps_with_members("follow", linkage, parameters)]
