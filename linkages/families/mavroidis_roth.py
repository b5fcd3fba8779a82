"""The 6R of Mavroidis and Roth and that of Dietmaier: four links at two joints in
Bennett ratios, and two equal links that are free."""

from __future__ import annotations

from enum import Enum
from functools import partial

from linkages.construction.conditions import require_different, require_equal
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import Number, cos, sin
from linkages.entry_table import Model, read_entries
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


def dietmaier(
    a12: Number,
    alpha12: Number,
    alpha61: Number,
    alpha34: Number,
    alpha45: Number,
    length: Number,
    twist: Number,
    R2: Number,
    R3: Number,
    a61: Number | None = None,
    a34: Number | None = None,
    a45: Number | None = None,
) -> Loop:
    """Dietmaier's 6R: two links of one Bennett ratio at joint 1, two of another at
    joint 4, 23 equal to 56.

    Twists in rad; ``length`` and ``twist`` are those of the links 23 and 56; R2 = R6,
    R3 = R5. The other lengths follow and are checked if given: a12/sin(alpha12) (cos
    alpha12 + cos alpha61) = a34/sin(alpha34) (cos alpha34 + cos alpha45). Raises
    `GeometryError`. Source: Dietmaier (1995b); equation (2.4.12) in Song (2013) has
    sin/a for a/sin and offsets R1 = R5, R2 = R4, which leaves the linkage rigid.
    """
    link12, link61 = bennett_links(a12, alpha12, a61=(alpha61, a61))
    first = cos(alpha12) + cos(alpha61)
    second = cos(alpha34) + cos(alpha45)
    name = "cos(alpha34) + cos(alpha45)"
    require_different(name, second, 0, "supplementary twists")
    length34 = a12 / sin(alpha12) * first * sin(alpha34) / second
    if a34 is not None:
        require_equal("a34", a34, length34, "from the condition on the cosines")
        length34 = a34
    link34, link45 = bennett_links(length34, alpha34, a45=(alpha45, a45))
    free = Link(length, twist)
    links = (link12, free, link34, link45, free, link61)
    return closed_chain(*links, offsets=(0, R2, R3, 0, R3, R2))


ENTRIES = read_entries(
    "mavroidis_roth",
    {
        **{
            f"{prefix}mavroidis-roth-{pattern.name.lower()}": Model(
                partial(mavroidis_roth, pattern=pattern, exchanged=bool(prefix))
            )
            for prefix in ("", "exchanged-")
            for pattern in OffsetPattern
        },
        "dietmaier": Model(dietmaier),
    },
)
