"""The command `bifurc show`."""

from __future__ import annotations

import click


@click.command("show")
@click.argument("name")
def show_command(name: str) -> None:
    """Show a linkage of the catalogue: source, parameters, conditions, geometry.

    \b
    Example:
      bifurc show bennett
    """
    from linkages.app.output import say
    from linkages.app.texts.entry_text import describe_entry, describe_sheet
    from linkages.app.texts.network_text import describe_network
    from linkages.catalogue import entry
    from linkages.networks.entries import NETWORKS
    from linkages.sheets.entries import SHEETS

    if name in NETWORKS:
        say(describe_network(NETWORKS[name]))
    elif name in SHEETS:
        say(describe_sheet(SHEETS[name]))
    else:
        say(describe_entry(entry(name)))
