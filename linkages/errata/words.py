"""What the sources say in words and is not so, each with what the program sees.

Statements of one figure or one example that are made of all linkages are listed too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bifurc.atlas import Atlas
from linkages.catalogue import entry
from linkages.closed_forms.translator import Stroke, contact_angle, stroke_angles
from linkages.construction.constructions import ending_with, superpose
from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.families.mixed_double_goldberg import Kind, Order, double_goldberg_type
from linkages.identification.identify import identify
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.networks.assembly import motion_at
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import NetworkMechanism, lock_network

THESIS = "Song 2013"
PAPER = "Racila and Dahan 2010"
MEMBERS = 12  # random linkages that a general statement is held against
TRIES = 200  # draws among which these are looked for


@dataclass(frozen=True)
class WordErratum:
    """A statement of a ``source`` and what holds in its place; ``see`` says in a few
    words what the program finds."""

    source: str
    place: str
    printed: str
    corrected: str
    see: Callable[[], str]


def _random_maps(name: str) -> list[Atlas]:
    """Transition maps of random members of a linkage that moves."""
    family = entry(name)
    rng = np.random.default_rng(1)
    maps: list[Atlas] = []
    for _ in range(TRIES):
        values = family.draw(rng)
        atlas = map_linkage(family.build(**values))
        if atlas.forms:
            maps.append(atlas)
        if len(maps) == MEMBERS:
            break
    return maps


def _components_of_double_goldbergs() -> str:
    maps = _random_maps("wohlhart-double-goldberg")
    split = [atlas for atlas in maps if atlas.components > 1]
    return f"{len(split)} of {len(maps)} random ones have more than one component"


def _one_curve_for_two_forms() -> str:
    maps = _random_maps("bricard-line-symmetric")
    single = [atlas for atlas in maps if len(atlas.forms) == 1]
    return f"in {len(single)} of {len(maps)} random ones both are one closed curve"


def _windings_of_type_two() -> str:
    windings = []
    for delta in (45, 83):
        atlas = map_linkage(
            load("mixed-double-goldberg-type-ii", delta=np.radians(delta))
        )
        turns = np.abs(atlas.forms[0].branch.winding).astype(int)
        text = " ".join(str(turn) for turn in turns)
        windings.append(f"{text} turns for delta = {delta} deg")
    return "; ".join(windings)


def _type_of_a_common_pair() -> str:
    a, b, c, d = _basic_links()
    # links of S2 and G2 from the common pair on, which comes last
    subtractive = closed_chain(a, b - c, a, c, b)
    other = closed_chain(a, c + d, a, c, d)
    return _identified(
        superpose(ending_with(subtractive, a, c), ending_with(other, a, c), shared=2),
        ["mixed-double-goldberg-type-ii", "mixed-double-goldberg-type-iii"],
    )


def _bakers_variants() -> str:
    alpha, beta, gamma, delta = np.radians([66, 50, 28, 83])
    variants = ["serial-goldberg-variant-6r", "l-shape-goldberg-variant-6r"]
    texts = []
    for order in (Order.II, Order.IV):
        loop = double_goldberg_type(
            1.0, alpha, beta, gamma, delta, order=order, kind=Kind.GOLDBERG
        )
        texts.append(f"Type {order.name}: {_identified(loop, variants)}")
    return "; ".join(texts)


def _end_of_the_long_stroke() -> str:
    """Where the strokes of the translator with a twist of 150 degrees end."""
    texts = []
    for stroke in Stroke:
        theta, phi = stroke_angles(np.radians(150), stroke)
        end = np.round(np.degrees([theta[-1], phi[-1]])).astype(int) + 0
        texts.append(f"{stroke}: theta = {end[0]}, phi = {end[1]} deg")
    return "; ".join(texts)


def _continuous_twists() -> str:
    """The twists, of some, at which the translator turns without contact of thin
    links."""
    free = [
        twist
        for twist in (75, 90, 105, 115, 125, 150)
        if contact_angle(float(np.radians(twist))) is None
    ]
    return "none of O2, O4, O6 meet at " + ", ".join(map(str, free)) + " deg"


def _basic_links() -> tuple[Link, ...]:
    """Links a, b, c, d of one Bennett ratio."""
    alpha, beta, gamma, delta = np.radians([66, 50, 28, 83])
    return bennett_links(1.0, alpha, b=(beta, None), c=(gamma, None), d=(delta, None))


def _identified(loop: Loop, names: Sequence[str]) -> str:
    """Which of the linkages called ``names`` a loop is."""
    entries = [entry(name) for name in names]
    matches = identify(loop, entries=entries, locking=False).names
    return "it is " + (" and ".join(matches) or "none of these")


def _freedoms(mechanism: NetworkMechanism, locks: Sequence[str]) -> tuple[int, int]:
    """Mobility of a network with joints locked where they stand, and how many outer
    joints move."""
    placed = mechanism.placed
    motion = motion_at(placed.network, locks, placed.reference)
    ring = placed.network.plan.ring
    return motion.mobility, len(ring) - len(motion.still(ring))


def _pairs_three_apart() -> str:
    network = lock_network(NETWORKS["four-bennett-network"].build(), {})
    ring = network.placed.network.plan.ring
    pairs = [(ring[k], ring[(k + 3) % 8]) for k in range(8)]
    alike = [pair for pair in pairs if _freedoms(network, pair) == (1, 6)]
    return f"{len(alike)} of {len(pairs)} pairs leave a 6R of mobility 1"


def _moving_triples() -> str:
    network = lock_network(NETWORKS["four-bennett-network"].build(), {})
    triples = list(combinations(network.placed.network.plan.ring, 3))
    moving = [triple for triple in triples if _freedoms(network, triple)[0]]
    names = ", ".join("/".join(triple) for triple in moving)
    return f"{names} of {len(triples)} move"


WORDS: tuple[WordErratum, ...] = (
    WordErratum(
        THESIS,
        "table 3.5.1, against table 3.5.2",
        "Type II is a variant of Baker's first variant (2.4.5), Type IV of his second "
        "(2.4.6)",
        "Type II of the second, Type IV of the first, as in table 3.5.2 and section "
        "3.4",
        _bakers_variants,
    ),
    WordErratum(
        THESIS,
        "section 3.4.3",
        "linkages S2 and G2 with a common link pair give a Type II linkage",
        "they give Type III",
        _type_of_a_common_pair,
    ),
    WordErratum(
        THESIS,
        "section 3.4.2",
        "theta1 of Type II turns twice while theta3 to theta6 turn once",
        "only where m3 m4 < 0, with delta between alpha and gamma; else theta1 and "
        "theta2 do not turn",
        _windings_of_type_two,
    ),
    WordErratum(
        THESIS,
        "section 4.2",
        "the general line-symmetric Bricard linkage has two distinct forms",
        "for the lengths and twists given; for others the formulas of Forms I and II "
        "are two parts of one form",
        _one_curve_for_two_forms,
    ),
    WordErratum(
        THESIS,
        "section 5.2.1",
        "all four forms of Wohlhart's double-Goldberg linkage can bifurcate into each "
        "other",
        "for some geometries; others have two components of two forms each",
        _components_of_double_goldbergs,
    ),
    WordErratum(
        THESIS,
        "table 5.4.1",
        "odd/odd+2: 1/3, 4/5, 5/7, 7/1",
        "3/5 for 4/5",
        lambda: "4/5 is no pair of odd joints, and stands in the row n/n+1 too",
    ),
    WordErratum(
        THESIS,
        "table 5.4.1, row n/n+3",
        "n/n+3: 1/4 to 5/8",
        "1/4 to 5/8, 6/1, 7/2, 8/3",
        _pairs_three_apart,
    ),
    WordErratum(
        THESIS,
        "section 5.4.5",
        "a third lock makes every 5R and 6R linkage of the network immobile",
        "all but four triples are rigid: a 5R keeps its motion where the third joint "
        "stands still anyway",
        _moving_triples,
    ),
    WordErratum(
        THESIS,
        "text on fig. 5.4.14",
        "(a) gives the L-shape linkages, (b) the serial ones",
        "(a) is the serial network, (b) the L-shape one, as in the caption",
        lambda: "the caption contradicts the text",
    ),
    WordErratum(
        PAPER,
        "section 4",
        "in the final position theta = 120 deg and all joints are in the plane",
        "on the short stroke, and on the long one for twists up to 120 deg",
        _end_of_the_long_stroke,
    ),
    WordErratum(
        PAPER,
        "section 2",
        "90 deg is the only twist with a continuous movement",
        "thin links only meet beyond 120 and below 60 deg",
        _continuous_twists,
    ),
)
