"""The 6R of Waldron and that of Yu and Baker: two Bennett loops, of any ratios, with a
joint axis in common, and what is taken from a primary Bennett loop when they are
collinear."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from linkages.construction.constructions import share_joint
from linkages.construction.link import (
    Link,
    basic_links,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    joined_chain,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.construction.possible_angles import half_tangents, kink_pairs, twists_with
from linkages.construction.spatial_triangle import Kink, KinkAngle, composite_link
from linkages.entry_table import Model, read_entries
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


# b and d folded upon each other, a and c in line: links b, a, b - d, c, d, a + c. Yu and
# Baker (1981); section 2.4.6 in Song (2013)
waldron_collinear = partial(
    waldron_hybrid, kink_1=Kink.FOLDED, kink_2=Kink.STRAIGHT, shift=0
)


def _guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Kinks from the twists, the shift from a length or an offset, linear in it."""
    lengths, twists, _ = form
    unit = lengths[0]
    second_lock = twists[3], twists[1], twists[5]
    for pair in kink_pairs((twists[0], twists[4], twists[2]), second_lock):
        try:
            shifts = _shifts(form, pair["kink_1"], unit)
        except GeometryError:
            continue
        for shift in shifts:
            yield {**pair, "shift": shift}


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


def yu_baker(*parameters: Number, **others: Any) -> Loop:
    """Yu and Baker's syncopated 6R of `basic_links`: links e - b, a + c, e - d, c, b -
    d, a; e/epsilon follows.

    Raises `GeometryError` where the loop of e does not exist: for alpha = beta and for
    gamma = delta. Source: Yu and Baker (1981); equation (2.4.10) in Song (2013).
    """
    return _syncopated(basic_links(*parameters, **others))


def yu_baker_two_ratios(
    a: Number,
    alpha: Number,
    beta: Number,
    c: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    d: Number | None = None,
) -> Loop:
    """Yu and Baker's syncopated 6R with one Bennett ratio for a, b and another for c,
    d.

    Errors and source as `yu_baker`; equation (2.4.10) in Song (2013) asks for one
    ratio, which is not needed.
    """
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    link_c, link_d = bennett_links(c, gamma, d=(delta, d))
    return _syncopated({"a": link_a, "b": link_b, "c": link_c, "d": link_d})


def _syncopated(links: dict[str, Link]) -> Loop:
    a, b, c, d = links.values()
    product = half_angle_ratio(a.twist, b.twist) * half_angle_ratio(c.twist, d.twist)
    links["e"] = syncopated_link(a + c, product)
    return joined_chain("e-b a+c e-d c b-d a", links)


def _yu_baker_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """A cubic equation for tan(beta/2): delta is beta less the twist of link 56,
    epsilon beta plus that of link 12."""
    twists = form[1]
    half_twists = twists / 2
    a = float(np.tan(half_twists[5]))
    c = float(np.tan(half_twists[3]))
    firsts = _signed(twists[0])
    fifths = _signed(twists[4])
    for s, r in itertools.product(firsts, fifths):
        for beta in twists_with(np.roots(_cubic(a, c, s, r))):
            half_delta = np.tan(beta / 2 - np.arctan(r))
            delta = 2 * np.arctan(half_delta)
            yield {"beta": beta, "delta": delta % np.pi}


def _cubic(a: float, c: float, s: float, r: float) -> np.ndarray:
    """Coefficients, the highest first, of the equation for x = tan(beta/2) by the half
    tangents of a, c and of the links 12, 56."""
    # tan(delta/2) is x - r over 1 + r x
    left = np.convolve([1.0, r * (a * c - 1.0), a * c], [-s, 1.0])
    right = np.convolve([c * r, a + c, -a * r], [1.0, s])
    return (a + c) * left - (1.0 - a * c) * right


def _signed(twist: float) -> list[float]:
    """Half tangents of the twist and of its opposite, each with and without a half
    turn."""
    return half_tangents(twist) + half_tangents(-twist)


ENTRIES = read_entries(
    "waldron",
    {
        "waldron-hybrid": Model(waldron_hybrid, guesses=_guesses),
        "waldron-collinear": Model(waldron_collinear),
        "yu-baker": Model(yu_baker, guesses=_yu_baker_guesses),
        "yu-baker-two-ratios": Model(yu_baker_two_ratios, guesses=_yu_baker_guesses),
    },
)
