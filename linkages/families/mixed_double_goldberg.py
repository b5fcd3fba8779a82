"""The double-Goldberg 6R family: mixed Types I to VI, and the twelve linkages of two
equal kinds of 5R.

Two 5R linkages, each a Goldberg or a subtractive Goldberg linkage, are joined on the
link pair a, c or across the Bennett loop a, c. Up to the sign with which c is added,
the links come in six orders.
"""

from __future__ import annotations

from functools import partial
from math import pi, radians, sin
from typing import Any

from linkages.construction.link import Link, bennett_links, closed_chain
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "KINDS", "TYPES", "double_goldberg_chain", "double_goldberg_type"]

TYPES = ("I", "II", "III", "IV", "V", "VI")
KINDS = {
    "mixed": (-1, 1),
    "goldberg": (1, 1),
    "subtractive": (-1, -1),
}  # signs of the first and second 5R
_ORDER = {
    "I": "a*c b d a+c d b",
    "II": "a b*c d a+c d b",
    "III": "a b*c d+c a d b",
    "IV": "a b*c d a d+c b",
    "V": "a b*c d c d+a b",
    "VI": "a b*c d+a c d b",
}  # composite links: * takes the sign of the first 5R, + that of the second


def double_goldberg_type(
    a: Any,
    alpha: Any,
    beta: Any,
    gamma: Any,
    delta: Any,
    order: str = "I",
    kind: str = "mixed",
    b: Any = None,
    c: Any = None,
    d: Any = None,
) -> Loop:
    """The double-Goldberg 6R of Type ``order``, I to VI, made of the two 5R linkages of
    ``kind``.

    Twists of the links a, b, c, d in rad; the lengths b, c, d follow and are checked if
    given; no offsets. ``kind`` is a key of `KINDS`: "mixed" (a subtractive and a plain
    Goldberg 5R), "goldberg", "subtractive". Source: Song and Chen (2012), tables 2 and
    3; Song (2013), tables 3.3.1 and 3.5.3, equations (3.4.3) to (3.4.22). The latter's
    "alpha34 = alpha + gamma" in (3.4.11) is alpha45.
    """
    a, b, c, d = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return double_goldberg_chain(a, b, c, d, order, kind)


def double_goldberg_chain(
    a: Link, b: Link, c: Link, d: Link, order: str, kind: str
) -> Loop:
    """The loop of Type ``order`` and ``kind`` of these four basic links, whatever their
    ratios; -c is allowed."""
    names = {"a": a, "b": b, "c": c, "d": d}
    first, second = KINDS[kind]

    def link(text: str) -> Link:
        if len(text) == 1:
            return names[text]
        sign = first if text[1] == "*" else second
        return (
            names[text[0]] + names[text[2]]
            if sign > 0
            else names[text[0]] - names[text[2]]
        )

    return closed_chain(*(link(text) for text in _ORDER[order].split()))


_PARAMETERS = (
    Parameter("a", 1.7 * sin(radians(66)), "length", "length of link a", 0.3, 3.0),
    *(
        Parameter(
            name,
            radians(value),
            "angle",
            f"twist of link {link}",
            radians(15),
            radians(110),
        )
        for name, value, link in (
            ("alpha", 66, "a"),
            ("beta", 50, "b"),
            ("gamma", 28, "c"),
            ("delta", 83, "d"),
        )
    ),
)
_TITLES = {
    "mixed": "Mixed double-Goldberg 6R",
    "goldberg": "Double-Goldberg 6R",
    "subtractive": "Double-subtractive-Goldberg 6R",
}
_LOCKED = {"mixed": 0.0, "goldberg": pi, "subtractive": pi}
_ERRATA = {
    ("I", "mixed"): (
        "the closure equations (4.8), (4.9) / (3.4.8), (3.4.9) are printed with m2 for m1 and m4",
    ),
    ("II", "mixed"): (
        "alpha34 = alpha + gamma is printed twice in (4.11) / (3.4.11); one is alpha45",
    ),
    ("III", "mixed"): (
        "tan(theta4/2) = -m3 tan(theta1/2) is printed in (4.16) / (3.4.16); the sign is +",
    ),
}


def _entry(order: str, kind: str) -> Entry:
    first, second = ("+" if sign > 0 else "-" for sign in KINDS[kind])
    links = _ORDER[order].replace("+", second).replace("*", first).replace(" ", ", ")
    facts: dict[str, Any] = {"joints": 6, "mobility": 1}
    if order == "III":
        facts["locked"] = {3: _LOCKED[kind]}
    name = {"mixed": "mixed-double-goldberg", "goldberg": "double-goldberg"}.get(
        kind, "double-subtractive-goldberg"
    )
    return Entry(
        f"{name}-type-{order.lower()}",
        f"{_TITLES[kind]}, Type {order}",
        "Song and Chen (2012), tables 2 and 3; Song (2013), tables 3.3.1 and 3.5.3",
        partial(double_goldberg_type, order=order, kind=kind),
        _PARAMETERS,
        (
            "sin(twist)/length is the same for the links a, b, c, d",
            f"links {links}, twists likewise, R = 0",
        ),
        errata=_ERRATA.get((order, kind), ()),
        facts=facts,
    )


ENTRIES = tuple(_entry(order, kind) for kind in KINDS for order in TYPES)
