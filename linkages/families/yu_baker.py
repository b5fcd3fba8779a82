"""Yu and Baker's syncopated 6R: a collinear Waldron hybrid taken from a primary Bennett
loop."""

from __future__ import annotations

from math import radians, sin
from typing import Any

from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "yu_baker", "yu_baker_two_ratios"]


def yu_baker(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Yu and Baker's syncopated 6R of one Bennett ratio: links e - b, a + c, e - d, c,
    b - d, a.

    Twists in rad; the lengths b, c, d follow and are checked if given; e/epsilon
    follows. Raises `GeometryError`. Source: Yu and Baker (1981); equation (2.4.10) in
    Song (2013).
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return _syncopated(a, b, c, d)


def yu_baker_two_ratios(
    a: Any,
    alpha: Any,
    beta: Any,
    c: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    d: Any = None,
) -> Loop:
    """Yu and Baker's syncopated 6R with one Bennett ratio for a, b and another for c,
    d.

    Source: as `yu_baker`; equation (2.4.10) in Song (2013) asks for one ratio, which is
    not needed.
    """
    a, b = bennett_links(a, alpha, b=(beta, b))
    c, d = bennett_links(c, gamma, d=(delta, d))
    return _syncopated(a, b, c, d)


def _syncopated(a: Link, b: Link, c: Link, d: Link) -> Loop:
    product = half_angle_ratio(a.twist, b.twist) * half_angle_ratio(c.twist, d.twist)
    e = syncopated_link(a + c, product)
    return closed_chain(e - b, a + c, e - d, c, b - d, a)


_A = Parameter("a", 1.7 * sin(radians(35)), "length", "length of link a", 0.3, 3.0)
_C = Parameter("c", 1.25 * sin(radians(81)), "length", "length of link c", 0.3, 3.0)
_TWISTS = tuple(
    Parameter(
        name,
        radians(value),
        "angle",
        f"twist of link {link}",
        radians(15),
        radians(110),
    )
    for name, value, link in (
        ("alpha", 35, "a"),
        ("beta", 62, "b"),
        ("gamma", 81, "c"),
        ("delta", 48, "d"),
    )
)
_CONDITIONS = (
    "links e-b, a+c, e-d, c, b-d, a, twists likewise, R = 0",
    "sin(epsilon)/e = sin(alpha+gamma)/(a+c), m(alpha,beta) m(gamma,delta) = m(epsilon, alpha+gamma)",
)

ENTRIES = (
    Entry(
        "yu-baker",
        "Yu and Baker's syncopated 6R",
        "Yu and Baker (1981); Song (2013), eq. 2.4.10",
        yu_baker,
        (_A, *_TWISTS),
        ("sin(twist)/length is the same for the links a, b, c, d", *_CONDITIONS),
        facts={"joints": 6, "mobility": 1},
    ),
    Entry(
        "yu-baker-two-ratios",
        "Yu and Baker's syncopated 6R with two Bennett ratios",
        "Yu and Baker (1981); Song (2013), eq. 2.4.10",
        yu_baker_two_ratios,
        (_A, *_TWISTS[:2], _C, *_TWISTS[2:]),
        ("sin(alpha)/a = sin(beta)/b and sin(gamma)/c = sin(delta)/d", *_CONDITIONS),
        errata=("four equal Bennett ratios are printed; two pairs suffice",),
        facts={"joints": 6, "mobility": 1},
    ),
)
