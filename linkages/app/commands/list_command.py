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
    from linkages.catalogue import catalogue
    from linkages.networks.entries import NETWORKS
    from linkages.sheets.entries import SHEETS

    rows = []
    for entry in catalogue().values():
        joints = entry.build().n
        rows.append((entry.name, str(joints), entry.title))
    for network in NETWORKS.values():
        rows.append((network.name, str(len(network.plan.axes)), network.title))
    for sheet in SHEETS.values():
        creases = len(sheet.build().joints)
        rows.append((sheet.name, str(creases), sheet.title))
    say(table(("name", "joints", "title"), rows))
