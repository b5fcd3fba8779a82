"""Two generalized Goldberg 5R linkages on their common link pair: Wohlhart's
double-Goldberg 6R with kink angles.

The pair a, c turns alike in both, so that its ends may be bridged at any kink angle on
either side. Kinks 0, 0 give Wohlhart's linkage without offsets, pi, pi the
double-subtractive one, pi, 0 the mixed Type I; equal kinks give a linkage of Mavroidis
and Roth with R2 = R3 = -R5 = -R6.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from linkages.construction.basic_links import EQUAL_RATIOS, length_a, twists_of_links
from linkages.construction.constructions import superpose
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import kinks
from linkages.construction.spatial_triangle import KinkAngle
from linkages.construction.table_equations import zero_offsets
from linkages.entry import Condition, Entry, Parameter, Relation, RelationKind
from linkages.families.goldberg_5r import generalized_goldberg
from linkages.loop import Loop

POSITION = 90


def generalized_double_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    kink_1: KinkAngle,
    kink_2: KinkAngle,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Links b, [a c], b, d, [a c], d, the pair a, c locked at ``kink_1`` and at
    ``kink_2`` (rad, or a `Kink`).

    Twists in rad; the lengths b, c, d follow from the Bennett ratio and are checked if
    given. Raises `GeometryError`. Source: Wohlhart (1991a), for equal kinks.
    """
    first = generalized_goldberg(a, alpha, beta, gamma, kink_1, b, c)
    second = generalized_goldberg(a, alpha, delta, gamma, kink_2, d, c)
    return superpose(first, second, shared=2)


def _guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Sum and product of the cosines of alpha and gamma are linear in the rest."""
    lengths, twists, offsets = form
    ratio = lengths[0] / np.sin(twists[0])
    joined = twists[1]
    for twist, sign in itertools.product((joined, joined + np.pi), (1, -1)):
        cosine = np.cos(twist)
        total = sign * lengths[1] / ratio / np.tan(twist / 2)
        shear = offsets[1] / ratio * (1 + cosine)
        top = cosine**2 + shear**2 - 1 + total**2
        product = top / (2 * (1 + cosine))
        mean = total / 2
        square = max(mean**2 - product, 0.0)
        root = np.sqrt(square)
        if abs(mean) + root >= 1:
            continue
        pair = np.arccos([mean + root, mean - root])
        for gamma, alpha in itertools.permutations(pair):
            links = {"a": ratio * np.sin(alpha), "alpha": alpha, "gamma": gamma}
            yield from _kink_guesses(links, twists)


def _kink_guesses(
    links: dict[str, float], twists: np.ndarray
) -> Iterator[dict[str, float]]:
    """The ``links`` a and c with every pair of kinks that the twists leave possible."""
    first = kinks(links["alpha"], links["gamma"], twists[1])
    second = kinks(links["alpha"], links["gamma"], twists[4])
    for kink_1, kink_2 in itertools.product(first, second):
        yield {**links, "kink_1": kink_1, "kink_2": kink_2}


def _kink(number: int, degrees: float, side: str) -> Parameter:
    meaning = f"angle of a and c in the 5R with link {side}"
    return Parameter.angle(f"kink_{number}", degrees, meaning, -90, 90)


ENTRIES = (
    Entry(
        "generalized-double-goldberg",
        "Wohlhart's double-Goldberg 6R with kink angles",
        "Wohlhart (1991a)",
        generalized_double_goldberg,
        (
            length_a(66),
            *twists_of_links(a=66, b=50, c=28, d=83),
            _kink(1, 40, "b"),
            _kink(2, -25, "d"),
        ),
        conditions=(
            EQUAL_RATIOS,
            Condition(
                "links 12 = 34 = b and 45 = 61 = d; links 23 and 56 and their offsets "
                "from the spatial triangles of a, c"
            ),
            Condition("R1 = R4 = 0", (zero_offsets(1, 4),)),
        ),
        guesses=_guesses,
        relations=(
            Relation(
                RelationKind.CONSTRUCTED,
                "generalized-goldberg-5r",
                "Wohlhart (1991a)",
                "common link pair of two",
            ),
        ),
        facts={"joints": 6, "mobility": 1},
    ),
)
