"""The command `bifurc verify`."""

from __future__ import annotations

import click

__all__ = ["FAILED", "verify_command"]

FAILED = 6  # exit code


@click.command("verify")
@click.argument("name", required=False)
@click.option(
    "--members",
    default=1,
    type=click.IntRange(min=1),
    show_default=True,
    help="Members of each family.",
)
@click.option(
    "--points",
    default=6,
    type=click.IntRange(min=1),
    show_default=True,
    help="Points of an exact proof.",
)
@click.option(
    "--seed",
    default=0,
    type=click.IntRange(min=0),
    show_default=True,
    help="Seed of what is drawn.",
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON document and nothing else."
)
def verify_command(
    name: str | None, members: int, points: int, seed: int, as_json: bool
) -> None:
    """Verify a linkage of the catalogue, or all: proofs, mobility, closed forms,
    misprints.

    The first member has the default parameters, the others are random. Exit code 6 if
    something does not hold.

    \b
    Examples:
      bifurc verify bennett
      bifurc verify mixed-double-goldberg-type-i --members 50 --json
    """
    import json

    from linkages.app.verify import describe, verify, verify_all

    found = (
        verify_all(members, points, seed)
        if name is None
        else iter([verify(name, members, points, seed)])
    )
    documents, failures = [], 0
    for checked in found:
        failures += len(checked.failures)
        documents.append(checked.document())
        if not as_json:
            click.echo(describe(checked))
    if as_json:
        click.echo(
            json.dumps(documents[0] if name is not None else documents, allow_nan=False)
        )
    click.get_current_context().exit(FAILED if failures else 0)
