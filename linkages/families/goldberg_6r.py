"""Goldberg's 6R linkages: three Bennett loops in series or in L-shape, their
syncopations, Baker's variants, and all of these with kink angles.

They are the outer loops of three or four Bennett loops with the links a/alpha, b/beta,
c/gamma, d/delta of one Bennett ratio. Twists in rad. Only the length of link a is free:
b, c, d follow from the Bennett ratio, and are checked where they are given. Every offset
is zero unless a kink angle brings one.

Baker's variants with kink angles, and the isomer of the L-shape, are left by a network
of Bennett loops when two of its joints are locked; Song (2013), sections 5.4.3 and
5.4.6, names them without formulas. How they move follows from
`linkages.networks.network`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from linkages.construction.constructions import lock
from linkages.construction.link import (
    Link,
    basic_links,
    chain_constructor,
    half_angle_ratio,
    joined_chain,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import half_tangents, kink_pairs, twists_with
from linkages.construction.spatial_triangle import KinkAngle
from linkages.entry_table import Model, read_entries
from linkages.families.goldberg_5r import syncopation_guesses
from linkages.loop import Loop

POSITION = 70

# Goldberg (1943): links a, c, d in line
serial_goldberg = chain_constructor("b a+c+d b d c a")
# Goldberg (1943): a Goldberg 5R and a Bennett loop across it on link a
l_shape_goldberg = chain_constructor("b+d a+c b c d a")
# Baker (1993a), equations (2.4.5) and (2.4.6) in Song (2013)
serial_variant = chain_constructor("b a+c d b c+d a")
l_shape_variant = chain_constructor("b+d a c b c+d a")


def syncopated_serial_goldberg(*parameters: Number, **others: Any) -> Loop:
    """Syncopated serial Goldberg 6R of `basic_links`: a serial one taken from a Bennett
    loop with sides a + c + d and e.

    Raises `GeometryError` for a beta equal to one of the other twists. Source: Goldberg
    (1943), equation (2.4.2) in Song (2013), whose triple product lacks a minus sign.
    """
    links = basic_links(*parameters, **others)
    product = _product_with_b(links, "acd")
    links["e"] = syncopated_link(links["a"] + links["c"] + links["d"], -product)
    return joined_chain("e-b a+c+d e-b d c a", links)


def syncopated_l_shape_goldberg(*parameters: Number, **others: Any) -> Loop:
    """Syncopated L-shape Goldberg 6R of `basic_links`: an L-shape one taken from a
    Bennett loop with sides a + c and e.

    Raises `GeometryError` for a beta equal to alpha or gamma. Source: Goldberg (1943),
    equation (2.4.4) in Song (2013).
    """
    links = basic_links(*parameters, **others)
    product = _product_with_b(links, "ac")
    links["e"] = syncopated_link(links["a"] + links["c"], product)
    return joined_chain("b+d-e a+c e-b c d a", links)


def _product_with_b(links: Mapping[str, Link], names: str) -> Number:
    """The product of the half-angle ratios of these links with b."""
    product, *others = (
        half_angle_ratio(links[name].twist, links["b"].twist) for name in names
    )
    for factor in others:
        product = product * factor
    return product


def _locked_ring(order: str, *locks: tuple[int, str]) -> Callable[..., Loop]:
    """The constructor of the loop that a ring of basic links leaves when joints are
    locked, one after the other, each at the kink (rad, or a `Kink`) of this name."""

    def construct(
        a: Number,
        alpha: Number,
        beta: Number,
        gamma: Number,
        delta: Number,
        **kink_angles: KinkAngle,
    ) -> Loop:
        loop = joined_chain(order, basic_links(a, alpha, beta, gamma, delta))
        for number, name in locks:
            loop = lock(loop, number, kink_angles[name])
        return loop

    return construct


# links b, [[a c] d], b, d, c, a, and [b d], [a c], b, c, d, a: named by Goldberg (1943) and
# Song (2013), section 2.4.1, without formulas
generalized_serial_goldberg = _locked_ring(
    "b a c d b d c a", (3, "kink_1"), (3, "kink_2")
)
generalized_l_shape_goldberg = _locked_ring(
    "d b a c b c d a", (4, "kink_1"), (2, "kink_2")
)
# links [b d], a, c, b, [c d], a: case 2 of section 5.4.3 of Song (2013)
generalized_l_shape_variant = _locked_ring(
    "d b a c b c d a", (7, "kink_2"), (2, "kink_1")
)
# links b, [a c], d, b, [c d], a: section 5.4.6 of Song (2013)
generalized_serial_variant = _locked_ring(
    "b a c d b d c a", (7, "kink_2"), (3, "kink_1")
)
# links [b d], [a c], b, d, c, a: case 3 of section 5.4.3 of Song (2013)
isomerized_l_shape = _locked_ring("d b a c b d c a", (4, "kink_1"), (2, "kink_2"))


# --- first guesses


def difference_guesses(
    name: str, whole: int, part: int, form: np.ndarray
) -> Iterator[dict[str, float]]:
    """The twist ``name`` of a link that is added to, or subtracted from, the link in
    column ``part`` and makes the one in column ``whole``.

    The opposite difference comes too: a link c - b reads b - c where that is longer.
    """
    x = form[1, whole]
    y = form[1, part]
    for twist in (x - y, y - x, x + y):
        yield {name: twist % np.pi}


def _serial_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """A quadratic equation for tan(beta/2), from elementary symmetric functions of the
    other three tangents."""
    others = np.tan(form[1, 3:6] / 2)
    e1 = others.sum()
    e3 = others.prod()
    e2 = (e1**2 - (others**2).sum()) / 2
    for side in half_tangents(form[1, 0]):
        quadratic = [side * (e1 - e3), -(e1 * e2 - e3), side * e3 * (1 - e2)]
        for beta in twists_with(np.roots(quadratic)):
            yield {"beta": beta}


# every 30 degrees, none of them collinear
KINKS = tuple((np.linspace(-np.pi, np.pi, 12, endpoint=False) + 0.01).tolist())
KINK_SCAN = {"kink_1": KINKS, "kink_2": KINKS}


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


def _hidden_twist_guesses(
    name: str,
    simple: int,
    first: tuple[int, int],
    second: tuple[int, int],
    form: np.ndarray,
) -> Iterator[dict[str, float]]:
    """The twist ``name`` from the lengths of both links that are made of two, and the
    kinks from their twists.

    ``simple`` is the column of a basic link; ``first`` and ``second`` are those of a link
    made of two and of the other link in it.
    """
    lengths, twists, _ = form
    ratio = lengths[simple] / np.sin(twists[simple])
    hidden: list[float] = []
    for joined, known in (first, second):
        hidden += _hidden_twists(lengths[joined], twists[joined], ratio, twists[known])
    for twist in hidden:
        locked = [(twists[known], twist, twists[i]) for i, known in (first, second)]
        for pair in kink_pairs(*locked):
            yield {name: twist, **pair}


def _isomer_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """The kinks from the twists of the links that are made of two."""
    twists = form[1]
    beta, delta, gamma, alpha = twists[2:]
    yield from kink_pairs((alpha, gamma, twists[1]), (beta, delta, twists[0]))


ENTRIES = read_entries(
    "goldberg_6r",
    {
        "serial-goldberg-6r": Model(serial_goldberg),
        "syncopated-serial-goldberg-6r": Model(
            syncopated_serial_goldberg, guesses=_serial_guesses
        ),
        "l-shape-goldberg-6r": Model(l_shape_goldberg),
        "syncopated-l-shape-goldberg-6r": Model(
            syncopated_l_shape_goldberg,
            guesses=syncopation_guesses(side=2, alpha=5, gamma=3),
        ),
        "serial-goldberg-variant-6r": Model(
            serial_variant,
            guesses=partial(difference_guesses, "gamma", 1, 5),
        ),
        "l-shape-goldberg-variant-6r": Model(
            l_shape_variant,
            guesses=partial(difference_guesses, "delta", 0, 3),
        ),
        "generalized-serial-goldberg-6r": Model(
            generalized_serial_goldberg, scan=KINK_SCAN
        ),
        "generalized-l-shape-goldberg-6r": Model(
            generalized_l_shape_goldberg, scan=KINK_SCAN
        ),
        "generalized-serial-goldberg-variant-6r": Model(
            generalized_serial_variant,
            guesses=partial(_hidden_twist_guesses, "gamma", 5, (1, 5), (4, 2)),
        ),
        "generalized-l-shape-goldberg-variant-6r": Model(
            generalized_l_shape_variant,
            guesses=partial(_hidden_twist_guesses, "delta", 1, (0, 3), (4, 2)),
        ),
        "isomerized-generalized-l-shape-goldberg-6r": Model(
            isomerized_l_shape, guesses=_isomer_guesses
        ),
    },
)
