"""A link of a Bennett-based linkage, and the little arithmetic that the sources do with
links.

The sources write a link as a/alpha and join links collinearly, a+c/alpha+gamma, or lay
them back on each other, a-c/alpha-gamma. Here ``a + c`` and ``a - c`` mean just that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from linkages.construction.conditions import bennett_length, require_positive
from linkages.construction.numbers import atan, sin, tan
from linkages.loop import Loop

__all__ = [
    "Link",
    "bennett_links",
    "closed_chain",
    "half_angle_ratio",
    "syncopated_link",
]


@dataclass(frozen=True)
class Link:
    """A binary link: ``length`` and ``twist`` (rad) of the common normal of its two
    joint axes."""

    length: Any
    twist: Any

    def __add__(self, other: Link) -> Link:
        return Link(self.length + other.length, self.twist + other.twist)

    def __sub__(self, other: Link) -> Link:
        return Link(self.length - other.length, self.twist - other.twist)

    def __neg__(self) -> Link:
        return Link(-self.length, -self.twist)


def bennett_links(a: Any, alpha: Any, **others: tuple[Any, Any]) -> tuple[Link, ...]:
    """The link a/alpha and links of the same Bennett ratio, in the order given.

    Each of ``others`` is a name with (twist, length): the length follows from the ratio
    where it is None, and is checked where it is given. Twists in rad. Raises
    `GeometryError` for a ratio that differs, and for a length that is not positive.
    """
    require_positive("length a", a)
    lengths = {
        k: bennett_length(k, twist, given, a, alpha)
        for k, (twist, given) in others.items()
    }
    return (
        Link(a, alpha),
        *(Link(lengths[k], twist) for k, (twist, _) in others.items()),
    )


def closed_chain(*links: Link, offsets: Sequence[Any] | None = None) -> Loop:
    """The loop with these links in order and the given offsets, by default none."""
    return Loop(
        tuple(link.length for link in links),
        tuple(link.twist for link in links),
        tuple(offsets) if offsets is not None else (0,) * len(links),
    )


def half_angle_ratio(x: Any, y: Any) -> Any:
    """sin((x + y)/2) / sin((x - y)/2), the factor of every Bennett closure equation;
    twists in rad."""
    p, q = tan(x / 2), tan(y / 2)
    return (p + q) / (p - q)


def syncopated_link(base: Link, product: Any) -> Link:
    """The second link of the primary Bennett loop, with sides ``base`` and this one, of
    a syncopation.

    Its twist x solves ``half_angle_ratio(x, base.twist) = product``; its length has the
    Bennett ratio of ``base``.
    """
    twist = 2 * atan((product + 1) / (product - 1) * tan(base.twist / 2))
    return Link(base.length * sin(twist) / sin(base.twist), twist)
