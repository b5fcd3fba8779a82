"""Bricard's trihedral 6R, and the linkages of Altmann and Wohlhart near it."""

from __future__ import annotations

from functools import partial

from linkages.construction.conditions import require_equal, require_positive
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, pi_like, sqrt
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop

POSITION = 190


def trihedral(
    a12: Number,
    a23: Number,
    a34: Number,
    a45: Number,
    a56: Number,
    a61: Number | None = None,
    alternating: bool = True,
) -> Loop:
    """Trihedral Bricard 6R: right-angled links, of ``alternating`` sign or all +pi/2,
    without offsets.

    ``a61`` follows from a12^2 + a34^2 + a56^2 = a23^2 + a45^2 + a61^2 and is checked if
    given. Raises `GeometryError`. Source: Bricard (1927); equation (2.4.15) in Song
    (2013) for alternating twists.
    """
    name = "a12^2 + a34^2 + a56^2 - a23^2 - a45^2"
    square = a12**2 + a34**2 + a56**2 - a23**2 - a45**2
    require_positive(name, square)
    if a61 is None:
        a61 = sqrt(square)
    else:
        require_equal("a61^2", a61**2, square, name)
    odd = pi_like(a12, a23, a34, a45, a56) / 2
    even = -odd if alternating else odd
    lengths = (a12, a23, a34, a45, a56, a61)
    return Loop(lengths, (odd, even) * 3, (0,) * 6)


def altmann(a12: Number, a34: Number) -> Loop:
    """Altmann's 6R: a line-symmetric Bricard linkage with right angles and a23 = a56 =
    0.

    Source: Altmann (1954), Baker (1993b); equation (2.4.21) in Song (2013).
    """
    right = pi_like(a12, a34) / 2
    twists = (right, right, right, -right, right, -right)
    return Loop((a12, 0, a34) * 2, twists, (0,) * 6)


def wohlhart_hybrid(
    a12: Number,
    a23: Number,
    a45: Number,
    alpha12: Number,
    alpha23: Number,
    alpha45: Number,
    R2: Number,
    R4: Number,
    R6: Number | None = None,
) -> Loop:
    """Wohlhart's hybrid 6R: three plane-symmetric link pairs 61-12, 23-34, 45-56 with a
    common transversal.

    Lengths and offsets in one unit, twists in rad; R6 = -R2 - R4 is checked if given.
    Raises `GeometryError`. Source: Wohlhart (1987); equation (2.4.22) in Song (2013)
    has the pairs 12-23, 34-45, 56-61, which does not go with its offsets.
    """
    last = -R2 - R4
    if R6 is not None:
        require_equal("R6", R6, last, "-(R2 + R4)")
    return closed_chain(
        Link(a12, alpha12),
        Link(a23, alpha23),
        Link(a23, -alpha23),
        Link(a45, alpha45),
        Link(a45, -alpha45),
        Link(a12, -alpha12),
        offsets=(0, R2, 0, R4, 0, last),
    )


ENTRIES = read_entries(
    "bricard_other",
    {
        "bricard-trihedral": Model(trihedral),
        "bricard-trihedral-equal-twists": Model(partial(trihedral, alternating=False)),
        "altmann": Model(altmann),
        "wohlhart-hybrid": Model(wohlhart_hybrid),
    },
)
