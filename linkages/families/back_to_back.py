"""Back-to-back double-Goldberg 6R: two Goldberg 5R linkages on the link pair b, d, and
its isomer.

Equation (2.4.8) of Song (2013) for the links is not legible in the copy used; the links
here follow from the construction and were proved by closure.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from linkages.construction.basic_links import EQUAL_RATIOS, length_a
from linkages.construction.conditions import require_different, require_equal
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import Number, atan, tan
from linkages.construction.possible_angles import twist_pairs
from linkages.construction.table_equations import equal_offsets, zero_offsets
from linkages.entry import (
    BY_IDENTIFICATION,
    Condition,
    Entry,
    Parameter,
    Relation,
    RelationKind,
)
from linkages.loop import Loop

POSITION = 110


def matching_twist(alpha: Number, beta: Number, gamma: Number) -> Number:
    """The twist delta (rad) for which both 5R linkages share the motion of three
    joints.

    tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2); derived from the construction.
    Raises `GeometryError` for beta = 0.
    """
    bottom = tan(beta / 2)
    require_different("tan(beta/2)", bottom, 0, "no twist")
    return 2 * atan(tan(alpha / 2) * tan(gamma / 2) / bottom)


def back_to_back(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    R2: Number = 0,
    R3: Number = 0,
    delta: Number | None = None,
    sign: int = 1,
) -> Loop:
    """Back-to-back double-Goldberg 6R: links a, b + d, a, c, b + d, c with R2 = R5, R3
    = R6.

    ``sign`` -1 gives the case b - d. ``delta`` follows from the other twists (rad) and
    is checked if given; lengths follow from ``a`` and the Bennett ratio. Without the
    condition on delta the loop still moves, as a linkage of Mavroidis and Roth. Raises
    `GeometryError`. Source: Chen and You (2007); equation (2.4.9) in Song (2013).
    """
    link_a, pair, link_c = _links(a, alpha, beta, gamma, delta, sign)
    links = (link_a, pair, link_a, link_c, pair, link_c)
    return closed_chain(*links, offsets=(0, R2, R3, 0, R2, R3))


def isomerized_back_to_back(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    R2: Number = 0,
    R3: Number = 0,
    delta: Number | None = None,
    sign: int = 1,
) -> Loop:
    """The isomer of `back_to_back`: links a, b + d, c, a, b + d, c with R2 = R6, R3 =
    R5.

    Source: Chen and You (2007), Wohlhart (1991b); equation (2.4.9) in Song (2013).
    """
    link_a, pair, link_c = _links(a, alpha, beta, gamma, delta, sign)
    links = (link_a, pair, link_c, link_a, pair, link_c)
    return closed_chain(*links, offsets=(0, R2, R3, 0, R3, R2))


def _links(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number | None,
    sign: int,
) -> tuple[Link, Link, Link]:
    """The links a, b + d or b - d, and c."""
    if delta is None:
        delta = matching_twist(alpha, beta, gamma)
    else:
        require_equal(
            "tan(beta/2) tan(delta/2)",
            tan(beta / 2) * tan(delta / 2),
            tan(alpha / 2) * tan(gamma / 2),
            "tan(alpha/2) tan(gamma/2)",
        )
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    pair = link_b + link_d if sign > 0 else link_b - link_d
    return link_a, pair, link_c


def _guesses(sign: int, form: np.ndarray) -> Iterator[dict[str, float]]:
    """The twist beta of the joined link b + d or b - d: it, or delta."""
    lengths, twists, _ = form
    size = lengths[1] * np.sin(twists[0]) / lengths[0]
    for beta, delta in twist_pairs(twists[1], size, sign):
        yield {"beta": beta}
        yield {"beta": delta}


# --- entries


def _twist(name: str, degrees: float, link: str) -> Parameter:
    return Parameter.angle(name, degrees, f"twist of link {link}", 20, 110)


PARAMETERS = (
    length_a(35),
    _twist("alpha", 35, "a"),
    _twist("beta", 62, "b"),
    _twist("gamma", 81, "c"),
    Parameter.length("R2", 0.31, "offset R2", -0.5, 0.5),
    Parameter.length("R3", -0.47, "offset R3", -0.5, 0.5),
)
TANGENTS = Condition(
    "tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2) for the construction; "
    "the 6R moves without it"
)
OFFSETS = Condition(
    "R1 = R4 = 0, R2 = R5, R3 = R6", (zero_offsets(1, 4), equal_offsets((2, 5), (3, 6)))
)
ISOMER_OFFSETS = Condition(
    "R1 = R4 = 0, R2 = R6, R3 = R5", (zero_offsets(1, 4), equal_offsets((2, 6), (3, 5)))
)
FACTS = {"joints": 6, "mobility": 1}


def _case_of(other: str) -> Relation:
    return Relation(RelationKind.SPECIAL_CASE, other, "Mavroidis and Roth (1995)")


def _entry(joined: str, sign: int) -> Entry:
    relations = [_case_of("mavroidis-roth-opposite")]
    if sign > 0:
        built = Relation(
            RelationKind.CONSTRUCTED,
            "goldberg-5r",
            "Chen and You (2007)",
            "two on the link pair b, d",
        )
        relations.append(built)
    links = Condition(f"links a, {joined}, a, c, {joined}, c")
    return Entry(
        f"back-to-back-double-goldberg-{_word(sign)}",
        f"Back-to-back double-Goldberg 6R ({joined})",
        "Chen and You (2007); Song (2013), eq. 2.4.8, 2.4.9",
        partial(back_to_back, sign=sign),
        PARAMETERS,
        conditions=(EQUAL_RATIOS, TANGENTS, links, OFFSETS),
        guesses=partial(_guesses, sign),
        relations=tuple(relations),
        facts=FACTS,
    )


def _isomer_entry(joined: str, sign: int, other: str) -> Entry:
    isomer = Relation(
        RelationKind.ISOMER,
        other,
        BY_IDENTIFICATION,
        "links at joint 3 exchanged",
        joint=3,
    )
    links = Condition(f"links a, {joined}, c, a, {joined}, c")
    return Entry(
        f"isomerized-back-to-back-double-goldberg-{_word(sign)}",
        f"Isomerized back-to-back double-Goldberg 6R ({joined})",
        "Chen and You (2007); Song (2013), eq. 2.4.9",
        partial(isomerized_back_to_back, sign=sign),
        PARAMETERS,
        conditions=(EQUAL_RATIOS, TANGENTS, links, ISOMER_OFFSETS),
        guesses=partial(_guesses, sign),
        relations=(_case_of("exchanged-mavroidis-roth-reflected"), isomer),
        facts=FACTS,
    )


def _word(sign: int) -> str:
    return "sum" if sign > 0 else "difference"


ENTRIES = (
    _entry("b + d", 1),
    _isomer_entry("b + d", 1, "special-wohlhart-double-goldberg"),
    _entry("b - d", -1),
    _isomer_entry("b - d", -1, "special-double-subtractive-goldberg"),
)
