"""What the program sees of statements of the sources that are not so."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from bifurc.atlas import Atlas
from bifurc.graphs import transition_graph
from linkages.catalogue import entry
from linkages.closed_forms.translator import Stroke, contact_angle, stroke_angles
from linkages.construction.constructions import ending_with, superpose
from linkages.construction.equations import numbers_of
from linkages.construction.link import Link, basic_links, closed_chain
from linkages.errata.erratum import HOLDS
from linkages.families.mixed_double_goldberg import Kind, Order, double_goldberg_type
from linkages.identification.equivalence import table
from linkages.identification.identify import identify
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.networks.assembly import motion_at
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import NetworkMechanism, lock_network
from linkages.values import GeometryError

MEMBERS = 12  # random linkages that a general statement is held against
TRIES = 200  # draws among which these are looked for
SAMPLES = 60  # configurations at which a statement on motions is looked at
SAME = 1e-6  # |sin| of half the gap between angles that a formula gives


class Member(NamedTuple):
    """A linkage of a family, and its transition map."""

    loop: Loop
    atlas: Atlas


@cache
def _random_members(name: str) -> list[Member]:
    """Random members of the linkage called ``name`` that move; draws that no loop has
    are passed over."""
    family = entry(name)
    rng = np.random.default_rng(1)
    members: list[Member] = []
    for _ in range(TRIES):
        with suppress(GeometryError):
            loop = family.build(**family.draw(rng))
            atlas = map_linkage(loop)
            if atlas.forms:
                members.append(Member(loop, atlas))
        if len(members) == MEMBERS:
            break
    return members


def _random_maps(name: str) -> list[Atlas]:
    return [member.atlas for member in _random_members(name)]


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


def forms_of_double_goldbergs() -> str:
    """How many forms random double-Goldberg linkages have, and the special one, and
    whether its two that are not constructive meet."""
    maps = _random_maps("wohlhart-double-goldberg")
    four = [atlas for atlas in maps if len(atlas.forms) == 4]
    special = map_linkage(load("special-wohlhart-double-goldberg"))
    others = [form.name for form in special.forms if "non-constructive" in form.name]
    meet = transition_graph(special).has_edge(*others)
    return (
        f"4 forms in {len(four)} of {len(maps)} random ones; {len(special.forms)} in the "
        f"special one, of which {' and '.join(name.split(' (')[0] for name in others)} "
        f"{'meet' if meet else 'do not meet'}"
    )


SECOND = "reconfigurable-bricard-2"


def bifurcations_of_the_second_bricard() -> str:
    """How many of random second reconfigurable Bricard linkages have bifurcations."""
    maps = _random_maps(SECOND)
    meeting = [atlas for atlas in maps if atlas.bifurcations]
    return f"{len(meeting)} of {len(maps)} random ones have bifurcations"


def formulas_of_the_bennett_form() -> str:
    """Which formulas of the line-symmetric Bricard linkage the Bennett form of the
    second reconfigurable one obeys: with the source's numbers, and of random ones."""
    loop = entry(SECOND).build()
    ours = _formulas_obeyed(Member(loop, map_linkage(loop)))
    random = Counter(map(_formulas_obeyed, _random_members(SECOND)))
    counts = ", ".join(f"{text} in {random[text]}" for text in sorted(random))
    return f"{ours}; of {random.total()} random ones: {counts}"


def _formulas_obeyed(member: Member) -> str:
    """Which of (4.2.23), the first root, and (4.2.24) hold on the Bennett form."""
    (bennett,) = [form for form in member.atlas.forms if "Bennett" in form.name]
    bricard = entry("bricard-line-symmetric")
    numbers = numbers_of(table(member.loop))
    parameters = {name: numbers[name] for name in bricard.defaults}
    theta = bennett.branch.sample(SAMPLES)
    names = []
    for name, root in (("Form I", 1), ("Form II", -1)):
        closed = bricard.closed_forms[0].configurations(theta[:, 0], parameters, root)
        gaps = np.abs(np.sin((closed - theta) / 2)).max(axis=1)
        if (gaps < SAME).any():
            names.append(name)
    return " and ".join(names)


def windings_of_type_two() -> str:
    """How often the joints of Type II linkages turn round: as given, with alpha between
    beta and gamma, and with delta beyond alpha and gamma."""
    windings = []
    for beta, delta in ((50, 45), (80, 45), (50, 83)):
        degrees = {"beta": beta, "delta": delta}
        values = {name: np.radians(value) for name, value in degrees.items()}
        atlas = map_linkage(load("mixed-double-goldberg-type-ii", **values))
        turns = np.abs(atlas.forms[0].branch.winding).astype(int)
        text = " ".join(str(turn) for turn in turns)
        windings.append(f"{text} turns for beta = {beta}, delta = {delta} deg")
    return "; ".join(windings)


def freedoms_of_type_one_without_the_extra_link() -> str:
    """Of Type I without the link c: by how much two Bennett linkages on a common link
    a, each turned as it likes, fail to close as that 6R linkage."""
    a, b, _, d = basic_links(1.0, *np.radians([66, 50, 28, 83])).values()
    loop = closed_chain(a, b, d, a, d, b)
    first, second = np.random.default_rng(1).uniform(-np.pi, np.pi, (2, SAMPLES))
    of_b, of_d = _bennett(a, b, first), _bennett(d, a, second)
    # joints 3 and 6 have the common link on one side, which runs the other way
    joints = [of_b[:, 0], of_b[:, 1], of_b[:, 2] + np.pi + of_d[:, 0], of_d[:, 1],
              of_d[:, 2], of_d[:, 3] + np.pi + of_b[:, 3]]  # fmt: skip
    return _closes(loop, np.transpose(joints))


def freedoms_with_equal_links() -> str:
    """Of double-Goldberg linkages with delta = beta: by how much they fail to close
    with joints 3 and 6 folded, joints 1 and 2 turned as they like."""
    first, second = np.random.default_rng(1).uniform(-np.pi, np.pi, (2, SAMPLES))
    folded = np.full(SAMPLES, np.pi)
    theta = np.transpose([first, second, folded, -second, -first, folded])
    texts = []
    for name in ("double-subtractive-goldberg", "wohlhart-double-goldberg"):
        family = entry(name)
        loop = family.build(delta=family.defaults["beta"])
        texts.append(f"{name}: {_closes(loop, theta)}")
    return "; ".join(texts)


def _bennett(link: Link, other: Link, theta_1: np.ndarray) -> np.ndarray:
    """Configurations (k, 4) of a Bennett linkage at these angles of its joint 1."""
    values = {"alpha": float(link.twist), "beta": float(other.twist)}
    return entry("bennett").closed_forms[0].configurations(theta_1, values)


def _closes(loop: Loop, theta: np.ndarray) -> str:
    """At how many of configurations (k, n) a loop closes."""
    gaps = [loop.closure_error(one) for one in theta]
    closed = np.count_nonzero(np.array(gaps) < HOLDS)
    return f"closes at {closed} of {len(theta)} random pairs of angles"


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
