"""Loops built by the misprinted conditions, beside those built by the corrected
ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, pi, radians, sin

from linkages.catalogue import entry
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.loop import Loop
from linkages.mobility import held_gap, survey

__all__ = ["CONDITIONS", "immobility"]

Row = tuple[str, str, str, str, str, Callable[[], Loop], Callable[[], Loop]]
TWISTS = tuple(radians(x) for x in (35.0, 62.0, 41.0, 22.0))


def immobility(loop: Loop) -> float:
    """0 if the loop moves; else its smallest singular value at a rigid assembly, or
    `held_gap`."""
    found = survey(loop)
    if found.mobility:
        return 0.0
    return found.stiffness if found.rigid else held_gap(loop)


def _corrected(name: str) -> Callable[[], Loop]:
    return lambda: entry(name).build()


def _with_twist(name: str, link: int, twist: Callable[[Loop], float]) -> Loop:
    loop = entry(name).build()
    twists = list(loop.twists)
    twists[link - 1] = twist(loop)
    return Loop(loop.lengths, tuple(twists), loop.offsets)


def _printed_syncopated() -> Loop:
    a, b, c, d = bennett_links(
        1.0, TWISTS[0], b=(TWISTS[1], None), c=(TWISTS[2], None), d=(TWISTS[3], None)
    )
    product = 1.0
    for link in (a, c, d):
        product *= half_angle_ratio(link.twist, b.twist)
    side = syncopated_link(a + c + d, product) - b
    return closed_chain(side, a + c + d, side, d, c, a)


def _printed_dietmaier() -> Loop:
    alpha12, alpha61, alpha34, alpha45 = (radians(x) for x in (50, 75, 35, 62))
    scale = (cos(alpha34) + cos(alpha45)) / (cos(alpha12) + cos(alpha61))
    link12, link61 = bennett_links(1.3, alpha12, a61=(alpha61, None))
    link34, link45 = bennett_links(
        1.3 / sin(alpha12) * scale * sin(alpha34), alpha34, a45=(alpha45, None)
    )
    free = Link(1.13, 1.27)
    return closed_chain(
        link12,
        free,
        link34,
        link45,
        free,
        link61,
        offsets=(0.31, -0.47, 0, -0.47, 0.31, 0),
    )


def _printed_hybrid() -> Loop:
    links = [Link(a, t) for a, t in ((1.0, -0.9), (0.8, 1.3), (1.25, 1.9))]
    pairs = [part for link in links for part in (link, Link(link.length, -link.twist))]
    return closed_chain(*pairs, offsets=(0, 0.4, 0, 0.3, 0, -0.7))


def _unequal_octahedron() -> Loop:
    loop = entry("bricard-octahedral-line-symmetric").build()
    twists = tuple(
        t + shift
        for t, shift in zip(loop.twists, (0, 0, 0, 0.2, -0.1, 0.15), strict=True)
    )
    return Loop(loop.lengths, twists, loop.offsets)


def _free_octahedron() -> Loop:
    """R1 R3 R5 + R2 R4 R6 = 0 holds, the twists are free."""
    loop = entry("bricard-octahedral-doubly-collapsible").build()
    twists = tuple(
        t + shift
        for t, shift in zip(loop.twists, (0.1, -0.2, 0.05, 0.1, 0, 0.1), strict=True)
    )
    return Loop(loop.lengths, twists, loop.offsets)


SONG = "Song 2013"
CONDITIONS: tuple[Row, ...] = (
    (
        SONG,
        "(2.3.4)",
        "myard-plane-symmetric-5r",
        "alpha23 = alpha41 = pi/2, nothing of alpha45",
        "alpha23 = alpha45 = pi/2",
        partial(
            _with_twist,
            "myard-plane-symmetric-5r",
            4,
            lambda loop: loop.twists[3] - 0.2,
        ),
        _corrected("myard-plane-symmetric-5r"),
    ),
    (
        SONG,
        "(2.3.4)",
        "myard-plane-symmetric-5r",
        "alpha34 = pi - 2 alpha with R3 = R4",
        "cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3/b)^2)",
        partial(
            _with_twist,
            "myard-plane-symmetric-5r",
            3,
            lambda loop: pi - 2 * loop.twists[0],
        ),
        _corrected("myard-plane-symmetric-5r"),
    ),
    (
        SONG,
        "(2.3.5)",
        "extended-myard-5r",
        "alpha34 = pi - 2 alpha with R3 = R4",
        "cos(alpha34/2) = sin(alpha) / sqrt(1 + (R3 sin(beta)/b)^2)",
        partial(
            _with_twist, "extended-myard-5r", 3, lambda loop: pi - 2 * loop.twists[0]
        ),
        _corrected("extended-myard-5r"),
    ),
    (
        SONG,
        "(2.4.2)",
        "syncopated-serial-goldberg-6r",
        "m(alpha,beta) m(gamma,beta) m(delta,beta) = m(epsilon, s)",
        "... = -m(epsilon, s), s = alpha + gamma + delta",
        _printed_syncopated,
        _corrected("syncopated-serial-goldberg-6r"),
    ),
    (
        SONG,
        "(2.4.12)",
        "dietmaier",
        "sin/a for a/sin in the condition on the cosines; R1 = R5, R2 = R4, R3 = R6 = 0",
        "a12/sin(alpha12) (cos alpha12 + cos alpha61) = a34/sin(alpha34) (cos alpha34 + cos alpha45); R2 = R6, R3 = R5",
        _printed_dietmaier,
        _corrected("dietmaier"),
    ),
    (
        SONG,
        "(2.4.14)",
        "bricard-plane-symmetric",
        "alpha23 + alpha56 = pi",
        "alpha23 + alpha56 = 0",
        partial(
            _with_twist, "bricard-plane-symmetric", 5, lambda loop: pi - loop.twists[1]
        ),
        _corrected("bricard-plane-symmetric"),
    ),
    (
        SONG,
        "(2.4.16)",
        "bricard-octahedral-line-symmetric",
        "no condition on the twists",
        "alpha12 = alpha45, alpha23 = alpha56, alpha34 = alpha61",
        _unequal_octahedron,
        _corrected("bricard-octahedral-line-symmetric"),
    ),
    (
        SONG,
        "(2.4.17)",
        "bricard-octahedral-plane-symmetric",
        "no condition on alpha23 and alpha56",
        "R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6 cos(alpha56)",
        partial(
            _with_twist,
            "bricard-octahedral-plane-symmetric",
            5,
            lambda loop: loop.twists[4] + 0.1,
        ),
        _corrected("bricard-octahedral-plane-symmetric"),
    ),
    (
        SONG,
        "(2.4.18)",
        "bricard-octahedral-doubly-collapsible",
        "R1 R3 R5 + R2 R4 R6 = 0 alone",
        "the hexagon of two concentric circles as well",
        _free_octahedron,
        _corrected("bricard-octahedral-doubly-collapsible"),
    ),
    (
        SONG,
        "(2.4.22)",
        "wohlhart-hybrid",
        "pairs 12-23, 34-45, 56-61 with R2 + R4 + R6 = 0",
        "pairs 61-12, 23-34, 45-56 with R2 + R4 + R6 = 0",
        _printed_hybrid,
        _corrected("wohlhart-hybrid"),
    ),
)
