"""The command `bifurc check`."""

from __future__ import annotations

from pathlib import Path

import click

from linkages.app.exit_codes import CommandError, ExitCode, exit_code_table
from linkages.app.options import FILE


@click.command("check", epilog=exit_code_table())
@click.argument("certificate", type=FILE)
def check_command(certificate: Path) -> None:
    """Check a certificate that `bifurc map --certificate` wrote: every statement in ball
    arithmetic, a line each.

    What is claimed, and what is not, stands in docs/proof.md. Exit code 6 if something
    does not hold. The check needs nothing of this program: the file
    linkages/rigorous/check.py does the same alone, with python-flint.

    \b
    Examples:
      bifurc map bennett --certificate bennett.json.gz
      bifurc check bennett.json.gz
    """
    from linkages.app.output import say
    from linkages.rigorous.check import check_certificate, read_certificate

    try:
        content = read_certificate(str(certificate))
    except (EOFError, ValueError):
        raise CommandError(f"{certificate}: it is no certificate") from None
    if not check_certificate(content, say):
        click.get_current_context().exit(ExitCode.DOES_NOT_HOLD)
