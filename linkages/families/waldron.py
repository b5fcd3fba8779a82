"""Waldron's hybrid 6R: two Bennett loops, of any ratios, with a joint axis in
common."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from math import radians, sin

import numpy as np

from linkages.construction.basic_links import length_a, twist_of
from linkages.construction.constructions import share_joint
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import kinks
from linkages.construction.spatial_triangle import Kink, KinkAngle, composite_link
from linkages.construction.table_equations import zero_offsets
from linkages.entry import Condition, Entry, Parameter, Relation, RelationKind
from linkages.loop import Loop
from linkages.values import GeometryError

POSITION = 120


def waldron_hybrid(
    a: Number,
    alpha: Number,
    beta: Number,
    c: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
    shift: Number,
    b: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Waldron's hybrid 6R of the Bennett loops a, b and c, d: links b, a, [b d], c, d,
    [c a].

    Twists in rad; the lengths b and d follow from the two Bennett ratios, and are
    checked if given; the links b, d are locked at ``kink_1`` and c, a at ``kink_2``
    (rad, or a `Kink`); ``shift`` is the distance of the loops along the common axis.
    Source: Waldron (1968); Baker (1993a) for the geometry.
    """
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    link_c, link_d = bennett_links(c, gamma, d=(delta, d))
    first = closed_chain(link_a, link_b, link_a, link_b)
    second = closed_chain(link_d, link_c, link_d, link_c)
    return share_joint(first, second, kink_1, kink_2, shift)


def waldron_collinear(
    a: Number,
    alpha: Number,
    beta: Number,
    c: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Waldron's hybrid 6R without offsets: b and d folded upon each other, a and c in
    line.

    Links b, a, b - d, c, d, a + c. Source: Yu and Baker (1981); section 2.4.6 in Song
    (2013).
    """
    return waldron_hybrid(
        a, alpha, beta, c, gamma, delta, Kink.FOLDED, Kink.STRAIGHT, 0, b, d
    )


def _guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Kinks from the twists, the shift from a length or an offset, linear in it."""
    lengths, twists, _ = form
    first = kinks(twists[0], twists[4], twists[2])
    second = kinks(twists[3], twists[1], twists[5])
    unit = lengths[0]
    for kink_1, kink_2 in itertools.product(first, second):
        try:
            shifts = _shifts(form, kink_1, unit)
        except GeometryError:
            continue
        for shift in shifts:
            yield {"kink_1": kink_1, "kink_2": kink_2, "shift": shift}


def _shifts(form: np.ndarray, kink: float, unit: float) -> list[float]:
    """Both shifts that give link 34, or joint 3, the size that it has in the table.

    Of length and offset that is taken which depends more on the shift.
    """
    lengths, twists, offsets = form
    b = Link(lengths[0], twists[0])
    d = Link(lengths[4], twists[4])
    at_zero = composite_link(b, d, kink, 0.0)
    at_unit = composite_link(b, d, kink, unit)
    zero = at_zero.link.length
    one = at_unit.link.length
    size = lengths[2]
    by_length = float(one) - float(zero)
    by_offset = float(at_unit.before.offset) - float(at_zero.before.offset)
    if abs(by_offset) > abs(by_length):
        zero = at_zero.before.offset
        one = at_unit.before.offset
        size = offsets[2]
    slope = float(one) - float(zero)
    return [unit * (target - float(zero)) / slope for target in (size, -size)]


# --- entries


def _kink(name: str, degrees: float, links: str) -> Parameter:
    return Parameter.angle(name, degrees, f"angle between {links}", -120, 120)


LENGTH_C = 1.25 * sin(radians(81))
LOOPS = (
    length_a(35),
    twist_of("a", 35),
    twist_of("b", 62),
    Parameter.length("c", LENGTH_C, "length of link c", 0.3, 3.0),
    twist_of("c", 81),
    twist_of("d", 48),
)
RATIOS = Condition("sin(alpha)/a = sin(beta)/b and sin(gamma)/c = sin(delta)/d")
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "waldron-hybrid",
        "Waldron's hybrid 6R of two Bennett loops",
        "Waldron (1968); Baker (1993a); Song (2013), section 2.4.5",
        waldron_hybrid,
        (
            *LOOPS,
            _kink("kink_1", 25, "b and d"),
            _kink("kink_2", -70, "c and a"),
            Parameter.length(
                "shift", 0.37, "distance along the common axis", -1.0, 1.0
            ),
        ),
        conditions=(
            RATIOS,
            Condition(
                "links 34 and 61 and the offsets R1, R3, R4, R6 from the spatial "
                "triangles"
            ),
            Condition("R2 = R5 = 0", (zero_offsets(2, 5),)),
        ),
        guesses=_guesses,
        relations=(
            Relation(
                RelationKind.CONSTRUCTED,
                "bennett",
                "Waldron (1968)",
                "two loops on a common axis",
            ),
        ),
        facts=FACTS,
    ),
    Entry(
        "waldron-collinear",
        "Waldron's hybrid 6R with collinear links",
        "Waldron (1968); Yu and Baker (1981); Song (2013), section 2.4.6",
        waldron_collinear,
        LOOPS,
        conditions=(
            RATIOS,
            Condition(
                "links b, a, b-d, c, d, a+c, twists likewise, R = 0",
                (zero_offsets(),),
            ),
        ),
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE, "waldron-hybrid", "Yu and Baker (1981)"
            ),
        ),
        facts=FACTS,
    ),
)
