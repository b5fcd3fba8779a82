"""6R linkages that a network of Bennett loops leaves when two of its joints are locked:
Baker's variants with kink angles, and an isomer of the L-shape linkage with kink
angles.

Named by Song (2013), sections 5.4.3 and 5.4.6, without formulas. All are the outer loop
of three or four Bennett loops, a/alpha, b/beta, c/gamma, d/delta of one Bennett ratio,
with two link pairs replaced by one link each. How they move follows from
`linkages.networks.network`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from linkages.construction.basic_links import EQUAL_RATIOS, length_a, twists_of_links
from linkages.construction.constructions import isomerize, lock
from linkages.construction.link import bennett_links, closed_chain
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import kinks
from linkages.construction.spatial_triangle import KinkAngle
from linkages.construction.table_equations import zero_offsets
from linkages.entry import Condition, Entry, Parameter, Relation, RelationKind
from linkages.families.goldberg_6r import generalized_l_shape_goldberg
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "generalized_l_shape_variant",
    "generalized_serial_variant",
    "isomerized_l_shape",
]

POSITION = 75
SOURCE = "Song (2013), section 5.4"


def generalized_l_shape_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """Baker's variant of the L-shape Goldberg 6R with b, d locked at ``kink_1`` and c,
    d at ``kink_2`` (rad, or a `Kink`): links [b d], a, c, b, [c d], a. Source: Song
    (2013), case 2 of section 5.4.3."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    ring = closed_chain(link_d, link_b, link_a, link_c, link_b, link_c, link_d, link_a)
    return lock(lock(ring, 7, kink_2), 2, kink_1)


def generalized_serial_variant(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """Baker's variant of the serial Goldberg 6R with a, c locked at ``kink_1`` and c, d
    at ``kink_2`` (rad, or a `Kink`): links b, [a c], d, b, [c d], a. Source: Song
    (2013), section 5.4.6."""
    link_a, link_b, link_c, link_d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    ring = closed_chain(link_b, link_a, link_c, link_d, link_b, link_d, link_c, link_a)
    return lock(lock(ring, 7, kink_2), 3, kink_1)


def isomerized_l_shape(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
) -> Loop:
    """The isomer of the L-shape Goldberg 6R with kink angles: links [b d], [a c], b, d,
    c, a, the pair a, c locked at ``kink_1`` and b, d at ``kink_2`` (rad, or a `Kink`).
    Source: Song (2013), case 3 of section 5.4.3."""
    plain = generalized_l_shape_goldberg(a, alpha, beta, gamma, delta, kink_1, kink_2)
    return isomerize(plain, 5)


# --- first guesses


def _hidden_twists(
    length: float, twist: float, ratio: float, known: float
) -> Iterator[float]:
    """The other twists of a link made of two, of ``length`` and ``twist``, one of which
    has the twist ``known``: length = ratio (cos x + cos y) tan(twist / 2)."""
    for joined, sign in itertools.product((twist, twist + np.pi), (1, -1)):
        tangent = np.tan(joined / 2)
        if not tangent:
            continue
        cosine = sign * length / (ratio * tangent) - np.cos(known)
        if abs(cosine) < 1:
            yield float(np.arccos(cosine))


def _l_shape_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The twist delta from the lengths of both links that are made of two, and the
    kinks from their twists."""
    lengths, twists, _ = form
    ratio = lengths[1] / np.sin(twists[1])
    beta, gamma = twists[3], twists[2]
    deltas = [
        *_hidden_twists(lengths[0], twists[0], ratio, beta),
        *_hidden_twists(lengths[4], twists[4], ratio, gamma),
    ]
    for delta in deltas:
        first = kinks(beta, delta, twists[0])
        second = kinks(gamma, delta, twists[4])
        for kink_1, kink_2 in itertools.product(first, second):
            yield {"delta": delta, "kink_1": kink_1, "kink_2": kink_2}


def _serial_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """As for the L-shape, for the twist gamma."""
    lengths, twists, _ = form
    ratio = lengths[5] / np.sin(twists[5])
    alpha, delta = twists[5], twists[2]
    gammas = [
        *_hidden_twists(lengths[1], twists[1], ratio, alpha),
        *_hidden_twists(lengths[4], twists[4], ratio, delta),
    ]
    for gamma in gammas:
        first = kinks(alpha, gamma, twists[1])
        second = kinks(gamma, delta, twists[4])
        for kink_1, kink_2 in itertools.product(first, second):
            yield {"gamma": gamma, "kink_1": kink_1, "kink_2": kink_2}


def _isomer_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The kinks from the twists of the links that are made of two."""
    twists = form[1]
    beta, delta, gamma, alpha = twists[2:]
    first = kinks(alpha, gamma, twists[1])
    second = kinks(beta, delta, twists[0])
    for kink_1, kink_2 in itertools.product(first, second):
        yield {"kink_1": kink_1, "kink_2": kink_2}


# --- entries


def _kink(number: int, degrees: float, links: str) -> Parameter:
    meaning = f"angle between {links}"
    return Parameter.angle(f"kink_{number}", degrees, meaning, -120, 120)


def _condition(links: str) -> Condition:
    return Condition(f"links {links}; links in brackets from the spatial triangles")


LINKS = (length_a(66), *twists_of_links(a=66, b=50, c=28, d=83))
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "generalized-serial-goldberg-variant-6r",
        "Variant of the serial Goldberg 6R with kink angles",
        SOURCE,
        generalized_serial_variant,
        (*LINKS, _kink(1, 25, "a and c"), _kink(2, -40, "c and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("b, [a c], d, b, [c d], a"),
            Condition("R1 = R4 = 0", (zero_offsets(1, 4),)),
        ),
        guesses=_serial_guesses,
        facts=FACTS,
    ),
    Entry(
        "generalized-l-shape-goldberg-variant-6r",
        "Variant of the L-shape Goldberg 6R with kink angles",
        SOURCE,
        generalized_l_shape_variant,
        (*LINKS, _kink(1, 25, "b and d"), _kink(2, -40, "c and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("[b d], a, c, b, [c d], a"),
            Condition("R3 = R4 = 0", (zero_offsets(3, 4),)),
        ),
        guesses=_l_shape_guesses,
        facts=FACTS,
    ),
    Entry(
        "isomerized-generalized-l-shape-goldberg-6r",
        "Isomer of the L-shape Goldberg 6R with kink angles",
        SOURCE,
        isomerized_l_shape,
        (*LINKS, _kink(1, 25, "a and c"), _kink(2, -40, "b and d")),
        conditions=(
            EQUAL_RATIOS,
            _condition("[b d], [a c], b, d, c, a"),
            Condition("R4 = R5 = R6 = 0", (zero_offsets(4, 5, 6),)),
        ),
        guesses=_isomer_guesses,
        relations=(
            Relation(
                RelationKind.ISOMER,
                "generalized-l-shape-goldberg-6r",
                "Wohlhart (1991b); Song (2013), section 5.4.3",
                "links c and d exchanged",
                joint=5,
            ),
        ),
        facts=FACTS,
    ),
)
