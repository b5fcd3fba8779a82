"""Bricard's trihedral 6R, and the linkages of Altmann and Wohlhart near it."""

from __future__ import annotations

from functools import partial
from math import pi

from linkages.construction.conditions import require_equal, require_positive
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, pi_like, sqrt
from linkages.construction.table_equations import (
    TableNumbers,
    equal_lengths,
    equation,
    opposite_twists,
    twists_of_value,
    zero_lengths,
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
    return closed_chain(
        Link(a12, odd),
        Link(a23, even),
        Link(a34, odd),
        Link(a45, even),
        Link(a56, odd),
        Link(a61, even),
    )


def altmann(a12: Number, a34: Number) -> Loop:
    """Altmann's 6R: a line-symmetric Bricard linkage with right angles and a23 = a56 =
    0.

    Source: Altmann (1954), Baker (1993b); equation (2.4.21) in Song (2013).
    """
    right = pi_like(a12, a34) / 2
    return closed_chain(
        Link(a12, right),
        Link(0, right),
        Link(a34, right),
        Link(a12, -right),
        Link(0, right),
        Link(a34, -right),
    )


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


# --- conditions


def _squares_gap(t: TableNumbers) -> float:
    """a12^2 + a34^2 + a56^2 = a23^2 + a45^2 + a61^2."""
    odd = t.a(12) ** 2 + t.a(34) ** 2 + t.a(56) ** 2
    even = t.a(23) ** 2 + t.a(45) ** 2 + t.a(61) ** 2
    return odd - even


def _offsets_gap(t: TableNumbers) -> float:
    """R2 + R4 + R6 = 0."""
    return t.R(2) + t.R(4) + t.R(6)


SQUARES = Condition(
    "a12^2 + a34^2 + a56^2 = a23^2 + a45^2 + a61^2", (equation(_squares_gap),)
)
NO_OFFSETS = Condition("R = 0", (zero_offsets(),))
ALTERNATING_TWISTS = Condition(
    "alpha12 = alpha34 = alpha56 = pi/2, alpha23 = alpha45 = alpha61 = -pi/2",
    (twists_of_value(pi / 2, 12, 34, 56), twists_of_value(-pi / 2, 23, 45, 61)),
)
EQUAL_TWISTS = Condition(
    "all twists pi/2", (twists_of_value(pi / 2, 12, 23, 34, 45, 56, 61),)
)
ALTMANN_CONDITIONS = (
    Condition(
        "a12 = a45, a34 = a61, a23 = a56 = 0",
        (equal_lengths((12, 45), (34, 61)), zero_lengths(23, 56)),
    ),
    Condition(
        "alpha12 = alpha23 = alpha34 = alpha56 = pi/2, alpha45 = alpha61 = -pi/2, "
        "R = 0",
        (
            twists_of_value(pi / 2, 12, 23, 34, 56),
            twists_of_value(-pi / 2, 45, 61),
            zero_offsets(),
        ),
    ),
)
HYBRID_CONDITIONS = (
    Condition(
        "a61 = a12, a23 = a34, a45 = a56, "
        "alpha61 = -alpha12, alpha34 = -alpha23, alpha56 = -alpha45",
        (
            equal_lengths((61, 12), (23, 34), (45, 56)),
            opposite_twists((61, 12), (34, 23), (56, 45)),
        ),
    ),
    Condition(
        "R1 = R3 = R5 = 0, R2 + R4 + R6 = 0",
        (zero_offsets(1, 3, 5), equation(_offsets_gap)),
    ),
)


# --- entries


def _length(name: str, default: float) -> Parameter:
    return Parameter.length(name, default, f"length {name}", 0.5, 1.6)


def _side(name: str, default: float, low: float) -> Parameter:
    return Parameter.length(name, default, f"length {name}", low, low + 0.3)


def _twist(link: int, degrees: float) -> Parameter:
    low, high = (-165, -15) if degrees < 0 else (15, 165)
    meaning = f"twist of link {link}"
    return Parameter.angle(f"alpha{link}", degrees, meaning, low, high)


def _offset(name: str, default: float) -> Parameter:
    return Parameter.length(name, default, f"offset {name}", -0.5, 0.5)


SIDES = (
    _side("a12", 1.0, 0.95),
    _side("a23", 0.7, 0.65),
    _side("a34", 1.1, 0.95),
    _side("a45", 0.9, 0.65),
    _side("a56", 0.8, 0.7),
)
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "bricard-trihedral",
        "Trihedral Bricard 6R",
        "Bricard (1927); Baker (1980); Song (2013), eq. 2.4.15",
        trihedral,
        SIDES,
        conditions=(SQUARES, ALTERNATING_TWISTS, NO_OFFSETS),
        facts=FACTS,
    ),
    Entry(
        "bricard-trihedral-equal-twists",
        "Trihedral Bricard 6R with equal twists",
        "variant of Bricard (1927) found by closure",
        partial(trihedral, alternating=False),
        SIDES,
        conditions=(SQUARES, EQUAL_TWISTS, NO_OFFSETS),
        facts=FACTS,
    ),
    Entry(
        "altmann",
        "Altmann's 6R",
        "Altmann (1954); Baker (1993b); Song (2013), eq. 2.4.21",
        altmann,
        (_length("a12", 1.0), _length("a34", 1.4)),
        conditions=ALTMANN_CONDITIONS,
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE,
                "bricard-line-symmetric-zero-offset",
                "Baker (1993b)",
            ),
            Relation(RelationKind.SPECIAL_CASE, "bricard-trihedral", BY_IDENTIFICATION),
            Relation(
                RelationKind.SPECIAL_CASE,
                "bricard-trihedral-equal-twists",
                BY_IDENTIFICATION,
            ),
        ),
        facts=FACTS,
    ),
    Entry(
        "wohlhart-hybrid",
        "Wohlhart's hybrid 6R",
        "Wohlhart (1987); Song (2013), eq. 2.4.22",
        wohlhart_hybrid,
        (
            _length("a12", 1.0),
            _length("a23", 0.8),
            _length("a45", 1.25),
            _twist(12, -50),
            _twist(23, 77),
            _twist(45, 110),
            _offset("R2", 0.4),
            _offset("R4", 0.3),
        ),
        conditions=HYBRID_CONDITIONS,
        errata=(
            "the pairs 12-23, 34-45, 56-61 are printed; with R2 + R4 + R6 = 0 they are "
            "61-12, 23-34, 45-56",
        ),
        facts=FACTS,
    ),
)
