"""Mavroidis and Roth's 6R: four links of one Bennett ratio, and two equal links that
are free."""

from __future__ import annotations

from enum import Enum
from functools import partial

from linkages.construction.basic_links import length_a, twist_of
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import Number
from linkages.construction.table_equations import (
    equal_links,
    equal_offsets,
    opposite_offsets,
    zero_offsets,
)
from linkages.entry import (
    BY_IDENTIFICATION,
    Condition,
    Entry,
    Parameter,
    Relation,
    RelationKind,
)
from linkages.loop import Loop

POSITION = 140


class OffsetPattern(Enum):
    """How the offsets of joints 5 and 6 follow from those of joints 2 and 3."""

    OPPOSITE = "R2 = R5, R3 = R6"
    REFLECTED = "R2 = R6, R3 = R5"
    NEGATIVE = "R2 = -R5, R3 = -R6"


def mavroidis_roth(
    a: Number,
    alpha: Number,
    gamma: Number,
    length: Number,
    twist: Number,
    R2: Number,
    R3: Number,
    pattern: OffsetPattern = OffsetPattern.OPPOSITE,
    exchanged: bool = False,
    c: Number | None = None,
) -> Loop:
    """Mavroidis and Roth's 6R: links a, l, a, c, l, c, or a, l, c, a, l, c when
    ``exchanged``.

    ``alpha``, ``gamma`` are the twists (rad) of a and c; the length of c follows and is
    checked if given; ``length`` and ``twist`` are those of the free link l. Raises
    `GeometryError`. Source: Mavroidis and Roth (1995), equation (2.4.11) in Song
    (2013); the pattern R2 = -R5, R3 = -R6 moves as well: two generalized Goldberg 5R of
    one kink angle on their common link pair have it.
    """
    link_a, link_c = bennett_links(a, alpha, c=(gamma, c))
    free = Link(length, twist)
    R5, R6 = {
        OffsetPattern.OPPOSITE: (R2, R3),
        OffsetPattern.REFLECTED: (R3, R2),
        OffsetPattern.NEGATIVE: (-R2, -R3),
    }[pattern]
    offsets = (0, R2, R3, 0, R5, R6)
    third, fourth = (link_c, link_a) if exchanged else (link_a, link_c)
    return closed_chain(link_a, free, third, fourth, free, link_c, offsets=offsets)


# --- entries

PARAMETERS = (
    length_a(35),
    twist_of("a", 35),
    twist_of("c", 81),
    Parameter.length("length", 1.13, "length of the free links 23 and 56", 0.3, 2.0),
    Parameter.angle("twist", 73, "twist of the free links 23 and 56", 15, 165),
    Parameter.length("R2", 0.31, "offset R2", -0.5, 0.5),
    Parameter.length("R3", -0.47, "offset R3", -0.5, 0.5),
)
OFFSETS = {
    OffsetPattern.OPPOSITE: equal_offsets((2, 5), (3, 6)),
    OffsetPattern.REFLECTED: equal_offsets((2, 6), (3, 5)),
    OffsetPattern.NEGATIVE: opposite_offsets((2, 5), (3, 6)),
}
LINKS = Condition(
    "a12 = a34, a23 = a56, a45 = a61, twists likewise",
    (equal_links((12, 34), (23, 56), (45, 61)),),
)
EXCHANGED_LINKS = Condition(
    "a12 = a45, a23 = a56, a34 = a61, twists likewise",
    (equal_links((12, 45), (23, 56), (34, 61)),),
)
RATIO = Condition(
    "sin(twist)/length is the same for the links 12, 34, 45, 61; links 23 = 56 are free"
)
SOURCE = "Mavroidis and Roth (1995); Song (2013), eq. 2.4.11"


def _name(pattern: OffsetPattern, exchanged: bool) -> str:
    order = "exchanged-" if exchanged else ""
    return f"{order}mavroidis-roth-{pattern.name.lower()}"


def _source(pattern: OffsetPattern, exchanged: bool) -> str:
    if pattern is not OffsetPattern.NEGATIVE:
        return SOURCE
    if exchanged:
        return "found by closure"
    return (
        "found by closure; the kinked double-Goldberg 6R of Wohlhart (1991a) is a case "
        "of it"
    )


def _relations(pattern: OffsetPattern, exchanged: bool) -> tuple[Relation, ...]:
    relations = []
    if pattern is OffsetPattern.REFLECTED:
        case = Relation(RelationKind.SPECIAL_CASE, "dietmaier", "Dietmaier (1995b)")
        relations.append(case)
    if pattern is OffsetPattern.NEGATIVE:
        same = _name(OffsetPattern.OPPOSITE, exchanged)
        relations.append(Relation(RelationKind.SAME, same, BY_IDENTIFICATION))
    elif exchanged:
        isomer = Relation(
            RelationKind.ISOMER,
            _name(pattern, exchanged=False),
            "Wohlhart (1991b)",
            "links at joint 4 exchanged",
            joint=4,
        )
        relations.append(isomer)
    if exchanged and pattern is OffsetPattern.OPPOSITE:
        general = "bricard-line-symmetric"
        case = Relation(RelationKind.SPECIAL_CASE, general, BY_IDENTIFICATION)
        relations.insert(0, case)
    return tuple(relations)


def _entry(pattern: OffsetPattern, exchanged: bool) -> Entry:
    word = "exchanged, " if exchanged else ""
    offsets = (zero_offsets(1, 4), OFFSETS[pattern])
    return Entry(
        _name(pattern, exchanged),
        f"Mavroidis and Roth's 6R, {word}{pattern.value}",
        _source(pattern, exchanged),
        partial(mavroidis_roth, pattern=pattern, exchanged=exchanged),
        PARAMETERS,
        conditions=(
            EXCHANGED_LINKS if exchanged else LINKS,
            RATIO,
            Condition(f"R1 = R4 = 0, {pattern.value}", offsets),
        ),
        relations=_relations(pattern, exchanged),
        facts={"joints": 6, "mobility": 1},
    )


ENTRIES = tuple(
    _entry(pattern, exchanged)
    for exchanged in (False, True)
    for pattern in OffsetPattern
)
