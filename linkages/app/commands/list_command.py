"""The command `bifurc list`."""

from __future__ import annotations

import click


@click.command("list")
def list_command() -> None:
    """List the linkages of the catalogue.

    \b
    Example:
      bifurc list
    """
    from bifurc.tables import table
    from linkages.app.output import say
    from linkages.arrays.entries import MECHANISMS
    from linkages.catalogue import catalogue
    from linkages.networks.entries import NETWORKS

    rows = []
    for entry in catalogue().values():
        joints = entry.build().n
        rows.append((entry.name, str(joints), entry.title))
    for network in NETWORKS.values():
        rows.append((network.name, str(len(network.plan.axes)), network.title))
    for one in MECHANISMS.values():
        joints = len(one.build().joints)
        rows.append((one.name, str(joints), one.title))
    say(table(("name", "joints", "title"), rows))
