"""Yu and Baker's syncopated 6R: a collinear Waldron hybrid taken from a primary Bennett loop."""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.entry import Entry, Parameter
from linkages.link import bennett_links, closed_chain, half_angle_ratio, syncopated_link
from linkages.loop import Loop

__all__ = ["ENTRIES", "yu_baker"]


def yu_baker(
    alpha: Any, beta: Any, gamma: Any, delta: Any, scale_1: Any, scale_2: Any = None
) -> Loop:
    """Yu and Baker's syncopated 6R: links e - b, a + c, e - d, c, b - d, a.

    Twists in rad. ``scale_1`` and ``scale_2`` (by default the same) are length / sin(twist) of a, b and of c,
    d. Source: Yu and Baker (1981); equation (2.4.10) in Song (2013) asks for one ratio, which is not needed.
    """
    a, b = bennett_links(scale_1, alpha, beta)
    c, d = bennett_links(scale_1 if scale_2 is None else scale_2, gamma, delta)
    e = syncopated_link(a + c, half_angle_ratio(alpha, beta) * half_angle_ratio(gamma, delta))
    return closed_chain(e - b, a + c, e - d, c, b - d, a)


_TWISTS = tuple(
    Parameter(name, radians(value), "angle", f"twist of link {link}", radians(15), radians(110))
    for name, value, link in (("alpha", 35, "a"), ("beta", 62, "b"), ("gamma", 81, "c"), ("delta", 48, "d"))
)
_CONDITIONS = (
    "links e-b, a+c, e-d, c, b-d, a, twists likewise, R = 0",
    "sin(epsilon)/e = sin(alpha+gamma)/(a+c), m(alpha,beta) m(gamma,delta) = m(epsilon, alpha+gamma)",
)

ENTRIES = (
    Entry(
        "yu-baker-6r",
        "Yu and Baker's syncopated 6R",
        "Yu and Baker (1981); Song (2013), eq. 2.4.10",
        yu_baker,
        (*_TWISTS, Parameter("scale_1", 1.7, "length", "length / sin(twist) of a, b, c, d", 0.5, 3.0)),
        ("sin(twist)/length is the same for the links a, b, c, d", *_CONDITIONS),
        facts={"joints": 6, "mobility": 1},
    ),
    Entry(
        "yu-baker-two-ratio-6r",
        "Yu and Baker's syncopated 6R with two Bennett ratios",
        "Yu and Baker (1981); Song (2013), eq. 2.4.10",
        yu_baker,
        (
            *_TWISTS,
            Parameter("scale_1", 1.7, "length", "length / sin(twist) of a and b", 0.5, 3.0),
            Parameter("scale_2", 1.25, "length", "length / sin(twist) of c and d", 0.5, 3.0),
        ),
        ("sin(alpha)/a = sin(beta)/b and sin(gamma)/c = sin(delta)/d", *_CONDITIONS),
        errata=("four equal Bennett ratios are printed; two pairs suffice",),
        facts={"joints": 6, "mobility": 1},
    ),
)
