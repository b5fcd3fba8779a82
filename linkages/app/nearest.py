"""The exact linkage that a rounded or misprinted table is meant to be, for commands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkages.app.exit_codes import CommandError, ExitCode
from linkages.app.output import StatusLine
from linkages.app.reports.corrections import describe_corrections, exact_toml
from linkages.app.reports.entry_parameters import member_text
from linkages.entry import Linkage
from linkages.identification.corrections import (
    Correction,
    Corrections,
    corrections_of,
)
from linkages.identification.equivalence import as_loop, table
from linkages.identification.identify import Identification, identify
from linkages.identification.match import Match
from linkages.loop import Loop


def exact_linkage(
    option: str, identification: Identification, corrections: Corrections
) -> Correction:
    """The linkage that a table is, or else the first that it is meant to be; raises
    `CommandError` about an ``option`` where nothing is known of it."""
    if identification.matches:
        return Correction(identification.matches[0])
    if not corrections.found:
        raise CommandError(
            f"{option}: no linkage of the catalogue is near {identification.loop.name}, "
            "and none has all its numbers but one, or two that are not both twists",
            ExitCode.NOT_IN_CATALOGUE,
        )
    return corrections.found[0]


@dataclass(frozen=True)
class NearestLinkage:
    """The exact linkage of a table, what it is in a few ``words``, and the text of a
    file with it."""

    linkage: Linkage
    words: str
    toml: str


def nearest_linkage(loop: Loop) -> NearestLinkage:
    """The exact linkage that the table of a loop is meant to be; raises
    `CommandError`."""
    identification = identify(loop, locking=False)
    corrections = Corrections(())
    if not identification.matches:
        with StatusLine() as status:
            corrections = corrections_of(identification, status)
    correction = exact_linkage("--nearest", identification, corrections)
    words = f"--nearest: this is the map of {member_text(correction.match)}"
    if corrections.found:
        words += "\n" + describe_corrections(corrections, loop.n)
    linkage = _linkage(correction.match, loop.name)
    return NearestLinkage(linkage, words, exact_toml(loop, correction))


def _linkage(match: Match, name: str) -> Linkage:
    """The linkage with the names of forms that its source gives, where the table stands
    as there."""
    loop = as_loop(match.member, name)
    entry = match.entry
    as_built = table(entry.construct(**match.parameters))
    if entry.patterns is None or not np.allclose(as_built, match.member):
        return Linkage(loop)
    return Linkage(loop, entry.patterns(**match.parameters))
