"""A link of a Bennett-based linkage, and the little arithmetic that the sources do with
links.

The sources write a link as a/alpha and join links collinearly, a+c/alpha+gamma, or lay
them back on each other, a-c/alpha-gamma. Here ``a + c`` and ``a - c`` mean just that.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from linkages.construction.conditions import (
    ROUNDING,
    bennett_length,
    decided,
    require_different,
    require_positive,
)
from linkages.construction.numbers import Number, atan, sin, tan
from linkages.loop import Loop
from linkages.values import GeometryError


@dataclass(frozen=True)
class Link:
    """A binary link: ``length`` and ``twist`` (rad) of the common normal of its two
    joint axes."""

    length: Number
    twist: Number

    def __add__(self, other: Link) -> Link:
        return Link(self.length + other.length, self.twist + other.twist)

    def __sub__(self, other: Link) -> Link:
        return Link(self.length - other.length, self.twist - other.twist)

    def __neg__(self) -> Link:
        return Link(-self.length, -self.twist)


def bennett_links(
    a: Number, alpha: Number, **others: tuple[Number, Number | None]
) -> tuple[Link, ...]:
    """The link a/alpha and links of the same Bennett ratio, in the order given.

    Each of ``others`` is a name with (twist, length): the length follows from the ratio
    where it is None, and is checked where it is given. Twists in rad. Raises
    `GeometryError` for a ratio that differs, and for a length that is not positive.
    """
    require_positive("length a", a)
    links = [Link(a, alpha)]
    for name, (twist, given) in others.items():
        length = bennett_length(name, twist, given, a, alpha)
        links.append(Link(length, twist))
    return tuple(links)


def closed_chain(*links: Link, offsets: Sequence[Number] | None = None) -> Loop:
    """The loop with these links in order and the given offsets, by default none."""
    lengths = tuple(link.length for link in links)
    twists = tuple(link.twist for link in links)
    if offsets is None:
        offsets = (0,) * len(links)
    return Loop(lengths, twists, tuple(offsets))


def joined_chain(order: str, links: Mapping[str, Link]) -> Loop:
    """The loop without offsets of ``links`` in this order, such as "b a+c d-b a": joined
    in line, or laid back on each other."""
    chain = []
    for text in order.split():
        joined = links[text[0]]
        for sign, name in zip(text[1::2], text[2::2], strict=True):
            joined = joined + links[name] if sign == "+" else joined - links[name]
        chain.append(joined)
    return closed_chain(*chain)


def basic_links(
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> dict[str, Link]:
    """The links a/alpha, b/beta, c/gamma, d/delta of one Bennett ratio, by their letters.

    Twists in rad; the lengths b, c, d follow, and are checked where they are given.
    Errors as in `bennett_links`.
    """
    links = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    return dict(zip("abcd", links, strict=True))


def chain_constructor(order: str) -> Callable[..., Loop]:
    """The constructor of the loop of `basic_links`, whose parameters it has, in this
    order, see `joined_chain`."""

    def construct(*parameters: Number, **others: Any) -> Loop:
        return joined_chain(order, basic_links(*parameters, **others))

    return construct


def half_angle_ratio(x: Number, y: Number) -> Number:
    """sin((x + y)/2) / sin((x - y)/2), the factor of every Bennett closure equation;
    twists in rad.

    Raises `GeometryError` for equal twists, whose Bennett loop is a rhombus.
    """
    p = tan(x / 2)
    q = tan(y / 2)
    _refuse_equal_twists(p, q)
    return (p + q) / (p - q)


def _refuse_equal_twists(p: Number, q: Number) -> None:
    """Raise `GeometryError` when the twists with these half tangents are equal."""
    one = decided(p)
    other = decided(q)
    if one is None or other is None:
        return
    x = 2 * math.atan(one)
    y = 2 * math.atan(other)
    if abs(math.sin((x - y) / 2)) > ROUNDING:
        return
    shown, beside = (f"{z:.6g} rad ({math.degrees(z):.6g} deg)" for z in (x, y))
    allowed = f"different from {beside}, the twist of its neighbour"
    raise GeometryError("twist of a link", shown, allowed)


def syncopated_link(base: Link, product: Number) -> Link:
    """The second link of the primary Bennett loop, with sides ``base`` and this one, of
    a syncopation.

    Its twist x solves ``half_angle_ratio(x, base.twist) = product``; its length has the
    Bennett ratio of ``base``. Raises `GeometryError` where that loop has none: for a
    product of 1, and for a ``base`` whose twist is 0 or pi.
    """
    require_different("product of the half-angle ratios", product, 1, "one")
    tangent = (product + 1) / (product - 1) * tan(base.twist / 2)
    twist = 2 * atan(tangent)
    sine = sin(base.twist)
    require_different("sine of the twist of the joined links", sine, 0, "none")
    return Link(base.length * sin(twist) / sine, twist)
