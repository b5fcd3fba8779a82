"""The map of a loop proved: its certificate, made and checked."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import mpmath

from bifurc.atlas import Atlas
from bifurc.limits import Deadline, HeldInterrupt, until
from linkages.app.choice import choose_precisely
from linkages.app.exit_codes import CommandError
from linkages.app.output import say, write_content
from linkages.rigorous.check import check_certificate
from linkages.rigorous.prove import certificate_bytes, make_certificate
from linkages.subject import Subject

DIGITS = 60  # of the table


def require_provable(name: str, subject: Subject) -> None:
    """Raise `CommandError` for what has no certificates."""
    if not subject.is_exact:
        raise CommandError(
            f"{name}: --rigorous proves maps of single loops that are given as a table so far, "
            "by a name of the catalogue or in a file"
        )


def prove_map(
    atlas: Atlas,
    linkage: str,
    parameters: Sequence[str],
    file: Path | None,
    seconds: float,
) -> bool:
    """Whether everything in the map of a linkage is proved: makes its certificate within
    so many seconds, or until Ctrl-C, writes it to a ``file`` if there is one, checks it,
    and prints what holds."""
    with mpmath.workdps(DIGITS):
        loop = choose_precisely(linkage, parameters)
    with HeldInterrupt() as interrupt, until(Deadline(seconds, interrupt=interrupt)):
        content = make_certificate(loop, atlas)
        interrupt.settle()
    data = certificate_bytes(content)
    if file is not None:
        is_compressed = file.suffix == ".gz"
        write_content(file, compress(data) if is_compressed else data, "--certificate")
    say("\nProof")
    holds = check_certificate(json.loads(data), lambda line: say(f"  {line}"))
    return holds and not content["open"]


def compress(data: bytes) -> bytes:
    """The same bytes whenever it is done."""
    import gzip

    return gzip.compress(data, mtime=0)
