"""The command `bifurc network`: what a network becomes under its locks."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import CommandError, exit_code_table
from linkages.app.options import out_option, param_option

if TYPE_CHECKING:
    from linkages.identification.locked_networks import LockedState
    from linkages.networks.network import Network


@click.command("network", epilog=exit_code_table())
@click.argument("name", metavar="NAME")
@click.option(
    "--locks",
    "is_locked",
    is_flag=True,
    help="Lock every two and every three outer joints.",
)
@click.option(
    "--kinks",
    nargs=2,
    type=float,
    metavar="FIRST SECOND",
    help=(
        "D-H angles in degrees at which pairs are locked, in the order of the outer "
        "loop.  [default: where the joints stand]"
    ),
)
@out_option("the tables as Markdown and CSV")
@param_option
def network_command(
    name: str,
    is_locked: bool,
    kinks: tuple[float, float] | None,
    out: Path | None,
    parameters: tuple[str, ...],
) -> None:
    """Show a network of Bennett loops, or tell what it becomes under its locks.

    \b
    Examples:
      bifurc network four-bennett-network --locks
      bifurc network serial-bennett-network --locks --kinks 40 -75 --out out
    """
    from linkages.app.choice import choose_linkage, require_kind
    from linkages.app.output import require_folder, say, say_written
    from linkages.app.texts.network_text import describe_network, make_page
    from linkages.networks.entries import NETWORKS
    from linkages.networks.mechanism import NetworkMechanism

    refusal = f"{name}: it is no network; those are {', '.join(NETWORKS)}"
    if name not in NETWORKS:
        raise CommandError(refusal)
    if not is_locked:
        if out is not None or kinks is not None or parameters:
            raise CommandError("--out, --kinks, --param: they go with --locks")
        say(describe_network(NETWORKS[name]))
        return
    angles = () if kinks is None else _radians(kinks)
    require_folder(out)
    chosen = require_kind(choose_linkage(name, parameters), NetworkMechanism, refusal)
    tables = _lock_all(chosen.placed.network, angles)
    page = make_page(name, tables)
    say(page)
    if out is not None:
        say_written(_write(out, page, tables), out)


def _lock_all(
    network: Network, kinks: tuple[float, ...]
) -> dict[str, list[LockedState]]:
    """What every pair of locks, at ``kinks`` (rad) if there are some, and every triple
    make of a network."""
    from linkages.app.output import StatusLine
    from linkages.identification.locked_networks import locked_states

    tables: dict[str, list[LockedState]] = {}
    with StatusLine() as status:
        for count, title in ((2, "pairs"), (3, "triples")):
            states = tables[title] = []
            for state in locked_states(network, count, kinks if count == 2 else ()):
                states.append(state)
                status(f"{title} of locks", len(states))
    return tables


def _write(out: Path, page: str, tables: dict[str, list[LockedState]]) -> list[Path]:
    """The paths of the files just written to ``out``, all or none."""
    from bifurc.files.atomic import replace_files
    from linkages.app.output import writing_to
    from linkages.app.texts.network_text import as_csv

    def write(stage: Path) -> None:
        (stage / "locks.md").write_text(page + "\n", encoding="utf-8")
        for title, states in tables.items():
            path = stage / f"lock_{title}.csv"
            path.write_text(as_csv(states), encoding="utf-8")

    with writing_to(out):
        return replace_files(out, write)


def _radians(degrees: tuple[float, ...]) -> tuple[float, ...]:
    from linkages.values import check_angle

    for angle in degrees:
        check_angle("--kinks", angle, in_degrees=True)
    return tuple(math.radians(angle) for angle in degrees)
