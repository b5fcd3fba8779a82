"""Loops built by the misprinted conditions, beside those built by the corrected
ones."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, radians, sin

from linkages.catalogue import entry
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.construction.numbers import Number
from linkages.errata.erratum import Amounts, Erratum
from linkages.loop import Loop
from linkages.mobility import held_gap, survey

SONG = "Song 2013"


def immobility(loop: Loop) -> float:
    """0 if the loop moves; else its smallest singular value at a rigid assembly, or
    `held_gap`."""
    motion = survey(loop)
    if motion.mobility:
        return 0.0
    return motion.stiffness if motion.rigid else held_gap(loop)


def _erratum(
    equation: str,
    linkage: str,
    printed: str,
    corrected: str,
    build: Callable[[], Loop],
) -> Erratum:
    """The misprint of Song (2013) by which ``build`` makes the loop."""

    def measure() -> Amounts:
        return Amounts(immobility(build()), immobility(entry(linkage).build()))

    return Erratum(SONG, equation, linkage, printed, corrected, measure)


def _with_twist(name: str, link: int, twist: Callable[[Loop], float]) -> Loop:
    """The default member with another twist of ``link`` (from 1)."""
    loop = entry(name).build()
    twists = list(loop.twists)
    twists[link - 1] = twist(loop)
    return Loop(loop.lengths, tuple(twists), loop.offsets)


def _with_shifts(name: str, *shifts: float) -> Loop:
    """The default member with twists that are larger by ``shifts``, rad."""
    loop = entry(name).build()
    pairs = zip(loop.twists, shifts, strict=True)
    return Loop(
        loop.lengths, tuple(twist + shift for twist, shift in pairs), loop.offsets
    )


def _free_alpha45() -> Loop:
    return _with_twist(
        "myard-plane-symmetric-5r", 4, lambda loop: float(loop.twists[3]) - 0.2
    )


def _printed_alpha34(name: str) -> Loop:
    return _with_twist(name, 3, lambda loop: pi - 2 * float(loop.twists[0]))


def _plane_symmetric_alpha34() -> Loop:
    return _printed_alpha34("myard-plane-symmetric-5r")


def _extended_alpha34() -> Loop:
    return _printed_alpha34("extended-myard-5r")


def _printed_syncopated() -> Loop:
    alpha, beta, gamma, delta = (radians(x) for x in (35.0, 62.0, 41.0, 22.0))
    a, b, c, d = bennett_links(
        1.0, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    product: Number = 1.0
    for link in (a, c, d):
        product = product * half_angle_ratio(link.twist, b.twist)
    side = syncopated_link(a + c + d, product) - b
    return closed_chain(side, a + c + d, side, d, c, a)


def _printed_dietmaier() -> Loop:
    alpha12, alpha61, alpha34, alpha45 = (radians(x) for x in (50, 75, 35, 62))
    first = cos(alpha12) + cos(alpha61)
    second = cos(alpha34) + cos(alpha45)
    length34 = 1.3 / sin(alpha12) * (second / first) * sin(alpha34)
    link12, link61 = bennett_links(1.3, alpha12, a61=(alpha61, None))
    link34, link45 = bennett_links(length34, alpha34, a45=(alpha45, None))
    free = Link(1.13, 1.27)
    links = (link12, free, link34, link45, free, link61)
    return closed_chain(*links, offsets=(0.31, -0.47, 0, -0.47, 0.31, 0))


def _printed_alpha56() -> Loop:
    return _with_twist(
        "bricard-plane-symmetric", 5, lambda loop: pi - float(loop.twists[1])
    )


def _unequal_octahedron() -> Loop:
    return _with_shifts("bricard-octahedral-line-symmetric", 0, 0, 0, 0.2, -0.1, 0.15)


def _octahedron_without_condition() -> Loop:
    return _with_twist(
        "bricard-octahedral-plane-symmetric",
        5,
        lambda loop: float(loop.twists[4]) + 0.1,
    )


def _free_octahedron() -> Loop:
    """R1 R3 R5 + R2 R4 R6 = 0 holds, the twists are free."""
    return _with_shifts(
        "bricard-octahedral-doubly-collapsible", 0.1, -0.2, 0.05, 0.1, 0, 0.1
    )


def _printed_hybrid() -> Loop:
    links = []
    for length, twist in ((1.0, -0.9), (0.8, 1.3), (1.25, 1.9)):
        links.append(Link(length, twist))
        links.append(Link(length, -twist))
    return closed_chain(*links, offsets=(0, 0.4, 0, 0.3, 0, -0.7))


CONDITION_ERRATA: tuple[Erratum, ...] = (
    _erratum(
        "(2.3.4)",
        "myard-plane-symmetric-5r",
        "alpha23 = alpha41 = pi/2, nothing of alpha45",
        "alpha23 = alpha45 = pi/2",
        _free_alpha45,
    ),
    _erratum(
        "(2.3.4)",
        "myard-plane-symmetric-5r",
        "alpha34 = pi - 2 alpha with R3 = R4",
        "cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3/b)^2)",
        _plane_symmetric_alpha34,
    ),
    _erratum(
        "(2.3.5)",
        "extended-myard-5r",
        "alpha34 = pi - 2 alpha with R3 = R4",
        "cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3 sin(beta)/b)^2)",
        _extended_alpha34,
    ),
    _erratum(
        "(2.4.2)",
        "syncopated-serial-goldberg-6r",
        "m(alpha,beta) m(gamma,beta) m(delta,beta) = m(epsilon, s)",
        "... = -m(epsilon, s), s = alpha + gamma + delta",
        _printed_syncopated,
    ),
    _erratum(
        "(2.4.12)",
        "dietmaier",
        "sin/a for a/sin in the condition on the cosines; "
        "R1 = R5, R2 = R4, R3 = R6 = 0",
        "a12/sin(alpha12) (cos alpha12 + cos alpha61) "
        "= a34/sin(alpha34) (cos alpha34 + cos alpha45); R2 = R6, R3 = R5",
        _printed_dietmaier,
    ),
    _erratum(
        "(2.4.14)",
        "bricard-plane-symmetric",
        "alpha23 + alpha56 = pi",
        "alpha23 + alpha56 = 0",
        _printed_alpha56,
    ),
    _erratum(
        "(2.4.16)",
        "bricard-octahedral-line-symmetric",
        "no condition on the twists",
        "alpha12 = alpha45, alpha23 = alpha56, alpha34 = alpha61",
        _unequal_octahedron,
    ),
    _erratum(
        "(2.4.17)",
        "bricard-octahedral-plane-symmetric",
        "no condition on alpha23 and alpha56",
        "R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6 cos(alpha56)",
        _octahedron_without_condition,
    ),
    _erratum(
        "(2.4.18)",
        "bricard-octahedral-doubly-collapsible",
        "R1 R3 R5 + R2 R4 R6 = 0 alone",
        "the hexagon of two concentric circles as well",
        _free_octahedron,
    ),
    _erratum(
        "(2.4.22)",
        "wohlhart-hybrid",
        "pairs 12-23, 34-45, 56-61 with R2 + R4 + R6 = 0",
        "pairs 61-12, 23-34, 45-56 with R2 + R4 + R6 = 0",
        _printed_hybrid,
    ),
)
