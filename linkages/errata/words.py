"""What the program sees of statements of the sources that are not so."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from bifurc.atlas import Atlas
from linkages.catalogue import entry
from linkages.closed_forms.translator import Stroke, contact_angle, stroke_angles
from linkages.construction.constructions import ending_with, superpose
from linkages.construction.link import basic_links, closed_chain
from linkages.families.mixed_double_goldberg import Kind, Order, double_goldberg_type
from linkages.identification.identify import identify
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.networks.assembly import motion_at
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import NetworkMechanism, lock_network

MEMBERS = 12  # random linkages that a general statement is held against
TRIES = 200  # draws among which these are looked for


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


def components_of_double_goldbergs() -> str:
    """How many of random double-Goldberg linkages have forms that do not meet."""
    maps = _random_maps("wohlhart-double-goldberg")
    split = [atlas for atlas in maps if atlas.components > 1]
    return f"{len(split)} of {len(maps)} random ones have more than one component"


def one_curve_for_two_forms() -> str:
    """How many of random line-symmetric Bricard linkages have a single form."""
    maps = _random_maps("bricard-line-symmetric")
    single = [atlas for atlas in maps if len(atlas.forms) == 1]
    return f"in {len(single)} of {len(maps)} random ones both are one closed curve"


def windings_of_type_two() -> str:
    """How often the joints of Type II linkages with two twists delta turn round."""
    windings = []
    for delta in (45, 83):
        atlas = map_linkage(
            load("mixed-double-goldberg-type-ii", delta=np.radians(delta))
        )
        turns = np.abs(atlas.forms[0].branch.winding).astype(int)
        text = " ".join(str(turn) for turn in turns)
        windings.append(f"{text} turns for delta = {delta} deg")
    return "; ".join(windings)


def type_of_a_common_pair() -> str:
    """What the superposition on the common pair of S2 and G2 is."""
    a, b, c, d = basic_links(1.0, *np.radians([66, 50, 28, 83])).values()
    # links of S2 and G2 from the common pair on, which comes last
    subtractive = closed_chain(a, b - c, a, c, b)
    other = closed_chain(a, c + d, a, c, d)
    return _identified(
        superpose(ending_with(subtractive, a, c), ending_with(other, a, c), shared=2),
        ["mixed-double-goldberg-type-ii", "mixed-double-goldberg-type-iii"],
    )


def bakers_variants() -> str:
    """What the mixed linkages of Types II and IV made of Goldberg loops are."""
    alpha, beta, gamma, delta = np.radians([66, 50, 28, 83])
    variants = ["serial-goldberg-variant-6r", "l-shape-goldberg-variant-6r"]
    texts = []
    for order in (Order.II, Order.IV):
        loop = double_goldberg_type(
            1.0, alpha, beta, gamma, delta, order=order, kind=Kind.GOLDBERG
        )
        texts.append(f"Type {order.name}: {_identified(loop, variants)}")
    return "; ".join(texts)


def end_of_the_long_stroke() -> str:
    """Where the strokes of the translator with a twist of 150 degrees end."""
    texts = []
    for stroke in Stroke:
        theta, phi = stroke_angles(np.radians(150), stroke)
        end = np.round(np.degrees([theta[-1], phi[-1]])).astype(int) + 0
        texts.append(f"{stroke}: theta = {end[0]}, phi = {end[1]} deg")
    return "; ".join(texts)


def continuous_twists() -> str:
    """The twists, of some, at which the translator turns without contact of thin
    links."""
    free = [
        twist
        for twist in (75, 90, 105, 115, 125, 150)
        if contact_angle(float(np.radians(twist))) is None
    ]
    return "none of O2, O4, O6 meet at " + ", ".join(map(str, free)) + " deg"


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


def pairs_three_apart() -> str:
    """How many pairs of locks three joints apart leave a 6R of mobility 1."""
    network = lock_network(NETWORKS["four-bennett-network"].build(), {})
    ring = network.placed.network.plan.ring
    pairs = [(ring[k], ring[(k + 3) % 8]) for k in range(8)]
    alike = [pair for pair in pairs if _freedoms(network, pair) == (1, 6)]
    return f"{len(alike)} of {len(pairs)} pairs leave a 6R of mobility 1"


def moving_triples() -> str:
    """Which triples of locks leave a network that moves."""
    network = lock_network(NETWORKS["four-bennett-network"].build(), {})
    triples = list(combinations(network.placed.network.plan.ring, 3))
    moving = [triple for triple in triples if _freedoms(network, triple)[0]]
    names = ", ".join("/".join(triple) for triple in moving)
    return f"{names} of {len(triples)} move"
