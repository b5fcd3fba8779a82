"""The command `bifurc verify`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from linkages.app.exit_codes import ExitCode, exit_code_table
from linkages.app.options import json_option, number_option, seed_option

if TYPE_CHECKING:
    from linkages.app.reports.verify import NetworkVerification, Verification

MOST_MEMBERS = 1_000_000
MOST_POINTS = 1_000_000


@click.command("verify", epilog=exit_code_table())
@click.argument("name", required=False)
@number_option(
    "--members", click.IntRange(1, MOST_MEMBERS), 1, "Members of each family."
)
@number_option(
    "--points", click.IntRange(1, MOST_POINTS), 6, "Points of an exact proof."
)
@seed_option("Seed of what is drawn.")
@json_option()
def verify_command(
    name: str | None, members: int, points: int, seed: int, as_json: bool
) -> None:
    """Verify a linkage or a network of the catalogue, or all linkages: proofs, mobility,
    closed forms, misprints.

    The first member has the default parameters, the others are random. Exit code 6 if
    something does not hold.

    \b
    Examples:
      bifurc verify bennett
      bifurc verify four-bennett-network
      bifurc verify mixed-double-goldberg-type-i --members 50 --json
    """
    from linkages.app.output import say, say_json
    from linkages.app.reports.verify import make_verification_document
    from linkages.catalogue import catalogue

    names = list(catalogue()) if name is None else [name]
    documents = []
    failures = 0
    try:
        for linkage in names:
            verification, text = _verify(linkage, members, points, seed)
            failures += len(verification.failures)
            if as_json:
                documents.append(make_verification_document(verification))
            else:
                say(text)
    finally:  # an interruption leaves a document of what was verified by then
        if as_json and name is None:
            say_json(documents)
    if as_json and name is not None:
        say_json(documents[0])
    if failures:
        click.get_current_context().exit(ExitCode.DOES_NOT_HOLD)


def _verify(
    name: str, members: int, points: int, seed: int
) -> tuple[Verification | NetworkVerification, str]:
    """What was checked of a linkage or a network, and as text."""
    from linkages.app.reports.verify import (
        describe_network_verification,
        describe_verification,
        verify,
        verify_network,
    )
    from linkages.networks.entries import NETWORKS

    if name in NETWORKS:
        of_network = verify_network(name, members, seed)
        return of_network, describe_network_verification(of_network)
    of_linkage = verify(name, members, points, seed)
    return of_linkage, describe_verification(of_linkage)
