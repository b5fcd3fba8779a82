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
    from linkages.app.texts.entry_text import describe_entry, describe_mechanism
    from linkages.app.texts.network_text import describe_network
    from linkages.arrays.entries import MECHANISMS
    from linkages.catalogue import entry
    from linkages.networks.entries import NETWORKS

    if name in NETWORKS:
        say(describe_network(NETWORKS[name]))
    elif name in MECHANISMS:
        say(describe_mechanism(MECHANISMS[name]))
    else:
        say(describe_entry(entry(name)))
