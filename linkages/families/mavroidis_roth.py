"""Mavroidis and Roth's 6R: four links of one Bennett ratio, and two equal links that
are free."""

from __future__ import annotations

from enum import Enum
from functools import partial
from math import radians, sin
from typing import Any

from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "OffsetPattern", "mavroidis_roth"]


class OffsetPattern(Enum):
    """How the offsets of joints 5 and 6 follow from those of joints 2 and 3."""

    OPPOSITE = "R2 = R5, R3 = R6"
    REFLECTED = "R2 = R6, R3 = R5"
    NEGATIVE = "R2 = -R5, R3 = -R6"


def mavroidis_roth(
    a: Any,
    alpha: Any,
    gamma: Any,
    length: Any,
    twist: Any,
    R2: Any,
    R3: Any,
    pattern: OffsetPattern = OffsetPattern.OPPOSITE,
    exchanged: bool = False,
    c: Any = None,
) -> Loop:
    """Mavroidis and Roth's 6R: links a, l, a, c, l, c, or a, l, c, a, l, c when
    ``exchanged``.

    ``alpha``, ``gamma`` are the twists (rad) of a and c; the length of c follows and is
    checked if given; ``length`` and ``twist`` are those of the free link l. Raises
    `GeometryError`. Source: Mavroidis and Roth (1995), equation (2.4.11) in Song
    (2013); the pattern R2 = -R5, R3 = -R6 moves as well: two generalized Goldberg 5R of
    one kink angle on their common link pair have it.
    """
    a, c = bennett_links(a, alpha, c=(gamma, c))
    free = Link(length, twist)
    R5, R6 = {
        OffsetPattern.OPPOSITE: (R2, R3),
        OffsetPattern.REFLECTED: (R3, R2),
        OffsetPattern.NEGATIVE: (-R2, -R3),
    }[pattern]
    links = (a, free, c, a, free, c) if exchanged else (a, free, a, c, free, c)
    return closed_chain(*links, offsets=(0, R2, R3, 0, R5, R6))


_PARAMETERS = (
    Parameter("a", 1.7 * sin(radians(35)), "length", "length of link a", 0.3, 3.0),
    Parameter(
        "alpha", radians(35), "angle", "twist of link a", radians(15), radians(110)
    ),
    Parameter(
        "gamma", radians(81), "angle", "twist of link c", radians(15), radians(110)
    ),
    Parameter("length", 1.13, "length", "length of the free links 23 and 56", 0.3, 2.0),
    Parameter(
        "twist",
        radians(73),
        "angle",
        "twist of the free links 23 and 56",
        radians(15),
        radians(165),
    ),
    Parameter("R2", 0.31, "length", "offset R2", -0.5, 0.5),
    Parameter("R3", -0.47, "length", "offset R3", -0.5, 0.5),
)


def _entry(pattern: OffsetPattern, exchanged: bool) -> Entry:
    links = (
        "a12 = a45, a23 = a56, a34 = a61"
        if exchanged
        else "a12 = a34, a23 = a56, a45 = a61"
    )
    order = "exchanged-" if exchanged else ""
    source = "Mavroidis and Roth (1995); Song (2013), eq. 2.4.11"
    if pattern is OffsetPattern.NEGATIVE:
        source = "found by closure"
        source += (
            ""
            if exchanged
            else "; the kinked double-Goldberg 6R of Wohlhart (1991a) is a case of it"
        )
    return Entry(
        f"{order}mavroidis-roth-{pattern.name.lower()}",
        f"Mavroidis and Roth's 6R, {'exchanged, ' if exchanged else ''}{pattern.value}",
        source,
        partial(mavroidis_roth, pattern=pattern, exchanged=exchanged),
        _PARAMETERS,
        (
            f"{links}, twists likewise",
            "sin(twist)/length is the same for the links 12, 34, 45, 61; links 23 = 56 are free",
            f"R1 = R4 = 0, {pattern.value}",
        ),
        facts={"joints": 6, "mobility": 1},
    )


ENTRIES = tuple(
    _entry(pattern, exchanged)
    for exchanged in (False, True)
    for pattern in OffsetPattern
)
