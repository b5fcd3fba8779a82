"""6R linkages of three Bennett loops: serial and L-shape of Goldberg, their
syncopations, Baker's variants.

Twists in rad. Only the length of link a is free: b, c, d follow from the Bennett ratio,
and are checked where they are given. Every offset is zero unless a kink angle brings
one.
"""

from __future__ import annotations

from collections.abc import Callable
from math import radians, sin
from typing import Any

from linkages.construction.constructions import lock, superpose
from linkages.construction.link import (
    bennett_links,
    closed_chain,
    half_angle_ratio,
    syncopated_link,
)
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "generalized_l_shape_goldberg",
    "generalized_serial_goldberg",
    "l_shape_goldberg",
    "l_shape_variant",
    "serial_goldberg",
    "serial_variant",
    "syncopated_l_shape_goldberg",
    "syncopated_serial_goldberg",
]


def serial_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Serial Goldberg 6R: three Bennett loops in a row, links a, c, d in line. Source:
    Goldberg (1943)."""
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return closed_chain(b, a + c + d, b, d, c, a)


def syncopated_serial_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Syncopated serial Goldberg 6R: a serial one taken from a Bennett loop with sides
    a + c + d and e.

    Source: Goldberg (1943), equation (2.4.2) in Song (2013), whose triple product lacks
    a minus sign.
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    product = (
        half_angle_ratio(alpha, beta)
        * half_angle_ratio(gamma, beta)
        * half_angle_ratio(delta, beta)
    )
    side = syncopated_link(a + c + d, -product) - b
    return closed_chain(side, a + c + d, side, d, c, a)


def l_shape_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """L-shape Goldberg 6R: a Goldberg 5R and a Bennett loop across it on link a.
    Source: Goldberg (1943)."""
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return closed_chain(b + d, a + c, b, c, d, a)


def syncopated_l_shape_goldberg(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Syncopated L-shape Goldberg 6R: an L-shape one taken from a Bennett loop with
    sides a + c and e.

    Source: Goldberg (1943), equation (2.4.4) in Song (2013).
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    e = syncopated_link(
        a + c, half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, beta)
    )
    return closed_chain(b + d - e, a + c, e - b, c, d, a)


def serial_variant(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Baker's variant of the serial Goldberg 6R: a, c in line on one side and c, d on
    the other.

    Source: Baker (1993a), equation (2.4.5) in Song (2013).
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return closed_chain(b, a + c, d, b, c + d, a)


def l_shape_variant(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """Baker's variant of the L-shape Goldberg 6R: b, d in line on one side and c, d on
    the other.

    Source: Baker (1993a), equation (2.4.6) in Song (2013).
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return closed_chain(b + d, a, c, b, c + d, a)


def generalized_serial_goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, delta: Any, kink_1: Any, kink_2: Any
) -> Loop:
    """Serial Goldberg 6R with a, c locked at ``kink_1`` and that link and d at
    ``kink_2``, rad.

    Source: named by Goldberg (1943) and Song (2013), section 2.4.1, without formulas.
    """
    a, b, c, d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    pair = lock(
        superpose(closed_chain(a, b, a, b), closed_chain(c, b, c, b)), 4, kink_1
    )  # a b [a.c] b c
    row = pair.relabelled(4)  # c a b [a.c] b
    return lock(superpose(row, closed_chain(d, b, d, b)), 5, kink_2).relabelled(2)


def generalized_l_shape_goldberg(
    a: Any, alpha: Any, beta: Any, gamma: Any, delta: Any, kink_1: Any, kink_2: Any
) -> Loop:
    """L-shape Goldberg 6R with b, d locked at ``kink_2`` and a, c at ``kink_1``, rad.

    Source: named by Goldberg (1943) and Song (2013), section 2.4.1, without formulas.
    """
    a, b, c, d = bennett_links(
        a, alpha, b=(beta, None), c=(gamma, None), d=(delta, None)
    )
    pair = lock(
        superpose(closed_chain(a, b, a, b), closed_chain(c, b, c, b)), 4, kink_1
    )  # a b [a.c] b c
    bent = pair.reversed().relabelled(4)
    return (
        lock(superpose(bent, closed_chain(d, a, d, a)), 5, kink_2)
        .reversed()
        .relabelled(1)
    )


def _parameters(*degrees: float) -> tuple[Parameter, ...]:
    twists = tuple(
        Parameter(
            name,
            radians(value),
            "angle",
            f"twist of link {link}",
            radians(15),
            radians(110),
        )
        for name, value, link in zip(
            ("alpha", "beta", "gamma", "delta"), degrees, "abcd", strict=True
        )
    )
    return (
        Parameter(
            "a", 1.7 * sin(radians(degrees[0])), "length", "length of link a", 0.3, 3.0
        ),
        *twists,
    )


def _kink(name: str, degrees: float, links: str) -> Parameter:
    return Parameter(
        name,
        radians(degrees),
        "angle",
        f"angle between {links}",
        radians(-120),
        radians(120),
    )


def _entry(
    name: str,
    title: str,
    source: str,
    construct: Callable[..., Loop],
    parameters: tuple[Parameter, ...],
    *conditions: str,
    errata: tuple[str, ...] = (),
) -> Entry:
    ratio = "sin(twist)/length is the same for the links a, b, c, d"
    facts = {"joints": 6, "mobility": 1}
    return Entry(
        name,
        title,
        source,
        construct,
        parameters,
        (ratio, *conditions),
        errata=errata,
        facts=facts,
    )


_SERIAL = "links b, a+c+d, b, d, c, a, twists likewise, R = 0"
_L_SHAPE = "links b+d, a+c, b, c, d, a, twists likewise, R = 0"

ENTRIES = (
    _entry(
        "serial-goldberg-6r",
        "Serial Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.1",
        serial_goldberg,
        _parameters(35, 62, 41, 22),
        _SERIAL,
    ),
    _entry(
        "syncopated-serial-goldberg-6r",
        "Syncopated serial Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.2",
        syncopated_serial_goldberg,
        _parameters(35, 62, 41, 22),
        "links e-b, a+c+d, e-b, d, c, a, twists likewise, R = 0",
        "sin(epsilon)/e = sin(alpha+gamma+delta)/(a+c+d)",
        "m(alpha,beta) m(gamma,beta) m(delta,beta) = -m(epsilon, alpha+gamma+delta)",
        errata=(
            "the triple product is printed with + and then leaves the linkage rigid; it takes -",
        ),
    ),
    _entry(
        "l-shape-goldberg-6r",
        "L-shape Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.3",
        l_shape_goldberg,
        _parameters(66, 50, 28, 83),
        _L_SHAPE,
    ),
    _entry(
        "syncopated-l-shape-goldberg-6r",
        "Syncopated L-shape Goldberg 6R",
        "Goldberg (1943); Song (2013), eq. 2.4.4",
        syncopated_l_shape_goldberg,
        _parameters(35, 62, 41, 22),
        "links b+d-e, a+c, e-b, c, d, a, twists likewise, R = 0",
        "sin(epsilon)/e = sin(alpha+gamma)/(a+c), m(alpha,beta) m(gamma,beta) = m(epsilon, alpha+gamma)",
    ),
    _entry(
        "serial-goldberg-variant-6r",
        "Variant of the serial Goldberg 6R",
        "Baker (1993a); Song (2013), eq. 2.4.5",
        serial_variant,
        _parameters(66, 50, 28, 83),
        "links b, a+c, d, b, c+d, a, twists likewise, R = 0",
    ),
    _entry(
        "l-shape-goldberg-variant-6r",
        "Variant of the L-shape Goldberg 6R",
        "Baker (1993a); Song (2013), eq. 2.4.6",
        l_shape_variant,
        _parameters(66, 50, 28, 83),
        "links b+d, a, c, b, c+d, a, twists likewise, R = 0",
    ),
    _entry(
        "generalized-serial-goldberg-6r",
        "Serial Goldberg 6R with kink angles",
        "Goldberg (1943)",
        generalized_serial_goldberg,
        (
            *_parameters(35, 62, 41, 22),
            _kink("kink_1", 25, "a and c"),
            _kink("kink_2", -40, "c and d"),
        ),
        "as the serial linkage, the links a, c, d locked at the two kink angles and replaced by one",
    ),
    _entry(
        "generalized-l-shape-goldberg-6r",
        "L-shape Goldberg 6R with kink angles",
        "Goldberg (1943)",
        generalized_l_shape_goldberg,
        (
            *_parameters(66, 50, 28, 83),
            _kink("kink_1", 25, "a and c"),
            _kink("kink_2", -40, "b and d"),
        ),
        "as the L-shape linkage, the pairs a, c and b, d locked at the kink angles",
    ),
)
