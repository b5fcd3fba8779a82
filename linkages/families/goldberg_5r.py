"""Goldberg's 5R linkages: plain, subtractive, syncopated, generalized, and those of
Myard.

All are made of two Bennett loops with a common link b/beta: the other links a/alpha and
c/gamma are added in link 23, laid back on each other, or locked at an angle. Twists in
rad. Only the length of link a is free: the others follow from the Bennett ratio, and are
checked where they are given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from linkages.construction import numbers
from linkages.construction.conditions import (
    bennett_length,
    require_different,
    require_equal,
    require_positive,
    require_twists,
)
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import Number, pi_like
from linkages.construction.possible_angles import half_tangents, kinks, twists_with
from linkages.construction.spatial_triangle import KinkAngle, composite_link
from linkages.entry import FormPattern, Guesses
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop

POSITION = 40
SUM, DIFFERENCE = +1, -1  # how a and c are joined


def joined_goldberg(
    sign: int,
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """The Goldberg 5R with links 12, 23, 34, 45, 51: b, a + c, b, c, a, and the twists
    likewise, in rad; for ``sign`` -1 the subtractive one with a - c, a > c.

    Lengths b and c follow from the Bennett ratio of a/alpha, and are checked when given.
    Raises `GeometryError` for another ratio. theta1 + theta4 and theta2 + theta3 + theta5
    are pi, in the subtractive one 0. Sources: Goldberg 1943; Song 2013, eqs (2.3.1),
    (3.2.1), (3.2.2), and Song and Chen, A family of mixed double-Goldberg 6R linkages,
    eqs (2.1), (2.2); for the subtractive one Song and Chen 2011 and Song 2013, eqs
    (3.2.3), (3.2.4), where link 23 must be a51 - a45 / alpha51 - alpha45 and
    tan(theta3/2) = tan(theta1/2) sin((gamma - beta)/2) / sin((gamma + beta)/2).
    """
    require_positive("length a", a)
    require_twists(alpha=alpha, beta=beta, gamma=gamma)
    b = bennett_length("b/beta", beta, b, a, alpha)
    c = bennett_length("c/gamma", gamma, c, a, alpha)
    joined = a + sign * c
    require_positive("length of link 23", joined)
    if sign < 0:
        require_different("twist gamma", gamma, alpha, "alpha, whose link it cancels")
    lengths = (b, joined, b, c, a)
    twists = (beta, alpha + sign * gamma, beta, gamma, alpha)
    return Loop(lengths, twists, (0,) * 5)


goldberg = partial(joined_goldberg, SUM)
subtractive_goldberg = partial(joined_goldberg, DIFFERENCE)


def syncopated_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """Syncopated Goldberg 5R: a Goldberg 5R taken from a Bennett loop with sides a + c
    and d.

    d/delta follows from the three twists. Raises `GeometryError` where that loop does
    not exist: for beta equal to alpha or gamma. Source: Goldberg (1943), fig. 2.3.1b
    and equation (2.3.2) in Song (2013); Baker (1979) showed it to be a Goldberg 5R with
    link d - b in place of b.
    """
    link_a, link_b, link_c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    product = half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, beta)
    joined = link_a + link_c
    side = syncopated_link(joined, product) - link_b
    return closed_chain(side, joined, side, link_c, link_a)


def generalized_goldberg(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    kink: KinkAngle,
    b: Number | None = None,
    c: Number | None = None,
) -> Loop:
    """Generalized Goldberg 5R: the links a and c locked at the angle ``kink`` (rad, or
    a `Kink`).

    R2 = R3 is the offset that the composite link brings. Source: Goldberg (1943),
    Wohlhart (1991a); equation (2.3.3) in Song (2013).
    """
    link_a, link_b, link_c = bennett_links(a, alpha, b=(beta, b), c=(gamma, c))
    joined = composite_link(link_a, link_c, kink)
    offsets = (0, joined.before.offset, joined.after.offset, 0, 0)
    return closed_chain(link_b, joined.link, link_b, link_c, link_a, offsets=offsets)


def myard_asymmetric(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """Asymmetric Myard 5R: the Goldberg 5R of two equal Bennett loops. Source: Myard
    (1931), Baker (1979)."""
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    return closed_chain(link_b, link_a + link_a, link_b, link_a, link_a)


def extended_myard(
    a: Number,
    alpha: Number,
    beta: Number,
    offset: Number = 0,
    b: Number | None = None,
    alpha34: Number | None = None,
) -> Loop:
    """Extended Myard 5R, plane-symmetric, with R3 = R4 = ``offset``.

    ``alpha34`` follows: cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3 sin(beta)/b)^2). If
    given it is checked. Source: Chen and You (2008a), equation (2.3.5) in Song (2013),
    where alpha34 = pi - 2 alpha is printed for any R3 = R4; that holds for R3 = 0 only.
    Raises `GeometryError`.
    """
    link_a, link_b = bennett_links(a, alpha, b=(beta, b))
    half_turn = pi_like(alpha, beta, offset)
    middle = _middle_twist(alpha, beta, offset, link_b, half_turn)
    if alpha34 is not None:
        require_equal("alpha34", alpha34, middle, "which goes with R3 = R4")
    last = Link(link_a.length, half_turn - alpha)
    offsets = (0, 0, offset, offset, 0)
    return closed_chain(link_a, link_b, Link(0, middle), link_b, last, offsets=offsets)


def _middle_twist(
    alpha: Number, beta: Number, offset: Number, b: Link, half_turn: Number
) -> Number:
    """alpha34 of the extended Myard linkage."""
    if offset == 0:
        return half_turn - 2 * alpha
    require_different("length of link b", b.length, 0, "which holds no offset", scale=0)
    shear = offset * numbers.sin(beta) / b.length
    return 2 * numbers.acos(numbers.sin(alpha) / numbers.sqrt(1 + shear**2))


def myard_plane_symmetric(
    a: Number,
    alpha: Number,
    offset: Number = 0,
    b: Number | None = None,
    alpha34: Number | None = None,
) -> Loop:
    """Plane-symmetric Myard 5R: `extended_myard` with right-angled links 23 and 45.

    Source: Myard (1931), equation (2.3.4) in Song (2013) with alpha45 = pi/2 where
    alpha41 is printed.
    """
    right_angle = pi_like(a, alpha) / 2
    return extended_myard(a, alpha, right_angle, offset, b, alpha34)


# --- forms


def _pattern(name: str, sign: int) -> Callable[..., tuple[FormPattern, ...]]:
    zero = np.cos if sign > 0 else np.sin

    def residual(theta: np.ndarray) -> np.ndarray:
        h = np.moveaxis(np.asarray(theta) / 2, -1, 0)
        opposite = zero(h[0] + h[3])
        others = zero(h[1] + h[2] + h[4])
        return np.stack([opposite, others], axis=-1)

    return lambda **values: (FormPattern(name, residual),)


# --- first guesses


def syncopation_guesses(side: int, alpha: int, gamma: int) -> Guesses:
    """The twist beta by tan(beta/2) tan((delta - beta)/2) = tan(alpha/2) tan(gamma/2).

    The arguments are columns of the table: of the link delta - beta, of a and of c.
    """

    def guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
        twists = form[1]
        product = np.tan(twists[alpha] / 2) * np.tan(twists[gamma] / 2)
        for half_tangent in half_tangents(twists[side]):
            other = product / half_tangent if half_tangent else np.inf
            for beta in twists_with(other):
                yield {"beta": beta}

    return guesses


def _kink_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    twists = form[1]
    for kink in kinks(twists[4], twists[3], twists[1]):
        yield {"kink": kink}


ENTRIES = read_entries(
    "goldberg_5r",
    {
        "goldberg-5r": Model(
            goldberg,
            _pattern("Goldberg form", SUM),
        ),
        "subtractive-goldberg-5r": Model(
            subtractive_goldberg,
            _pattern("subtractive Goldberg form", DIFFERENCE),
        ),
        "syncopated-goldberg-5r": Model(
            syncopated_goldberg,
            guesses=syncopation_guesses(side=0, alpha=4, gamma=3),
        ),
        "generalized-goldberg-5r": Model(generalized_goldberg, guesses=_kink_guesses),
        "myard-plane-symmetric-5r": Model(myard_plane_symmetric),
        "extended-myard-5r": Model(extended_myard),
        "myard-asymmetric-5r": Model(myard_asymmetric),
    },
)
