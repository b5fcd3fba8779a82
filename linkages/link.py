"""A link of a Bennett-based linkage, and the little arithmetic that the sources do with links.

The sources write a link as a/alpha and join links collinearly, a+c/alpha+gamma, or lay them back on each
other, a-c/alpha-gamma. Here ``a + c`` and ``a - c`` mean just that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from linkages.loop import GeometryError, Loop
from linkages.numbers import atan, sin, tan

__all__ = [
    "Link",
    "bennett_links",
    "closed_chain",
    "half_angle_ratio",
    "refuse_unequal_ratios",
    "syncopated_link",
]


@dataclass(frozen=True)
class Link:
    """A binary link: ``length`` and ``twist`` (rad) of the common normal of its two joint axes."""

    length: Any
    twist: Any

    def __add__(self, other: Link) -> Link:
        return Link(self.length + other.length, self.twist + other.twist)

    def __sub__(self, other: Link) -> Link:
        return Link(self.length - other.length, self.twist - other.twist)

    def __neg__(self) -> Link:
        return Link(-self.length, -self.twist)


def bennett_links(scale: Any, *twists: Any) -> tuple[Link, ...]:
    """Links of one Bennett ratio: each has length ``scale * sin(twist)``; ``scale`` is 1 / Bennett ratio."""
    return tuple(Link(scale * sin(twist), twist) for twist in twists)


def closed_chain(*links: Link, offsets: Sequence[Any] | None = None) -> Loop:
    """The loop with these links in order and the given offsets, by default none."""
    return Loop(
        tuple(link.length for link in links),
        tuple(link.twist for link in links),
        tuple(offsets) if offsets is not None else (0,) * len(links),
    )


def half_angle_ratio(x: Any, y: Any) -> Any:
    """sin((x + y)/2) / sin((x - y)/2), the factor of every Bennett closure equation; twists in rad."""
    return sin((x + y) / 2) / sin((x - y) / 2)


def syncopated_link(base: Link, product: Any) -> Link:
    """The second link of the primary Bennett loop, with sides ``base`` and this one, of a syncopation.

    Its twist x solves ``half_angle_ratio(x, base.twist) = product``; its length has the Bennett ratio of
    ``base``.
    """
    twist = 2 * atan((product + 1) / (product - 1) * tan(base.twist / 2))
    return Link(base.length * sin(twist) / sin(base.twist), twist)


def refuse_unequal_ratios(tolerance: float = 1e-9, **links: Link) -> None:
    """Raise `GeometryError` if the named links have not one Bennett ratio, relative to ``tolerance``.

    Compared as a sin(alpha') against a' sin(alpha), which also serves links without length.
    """
    names, first = list(links), next(iter(links.values()))
    for name in names[1:]:
        link = links[name]
        here, there = link.length * sin(first.twist), first.length * sin(link.twist)
        extent = max(abs(float(link.length)), abs(float(first.length)), 1e-300)
        if abs(float(here - there)) > tolerance * extent:
            raise GeometryError(
                f"link {name}: sin(twist)/length",
                float(sin(link.twist) / link.length) if link.length != 0 else "infinite",
                f"{float(sin(first.twist) / first.length)}, the Bennett ratio of link {names[0]}",
            )
