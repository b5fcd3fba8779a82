"""The spatial triangle: three joint axes and their common normals; one side expressed
by the other two."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

from linkages.construction.conditions import decided
from linkages.construction.link import Link
from linkages.construction.numbers import atan2, cos, pi_like, sin, sqrt
from linkages.loop import GeometryError

__all__ = ["CompositeLink", "Kink", "composite_link"]


class Kink(Enum):
    """The kink angles at which two links are collinear: exact sum and exact difference
    of the links."""

    STRAIGHT = 0
    FOLDED = 1


@dataclass(frozen=True)
class CompositeLink:
    """The link that replaces a locked link pair.

    ``before`` and ``after`` are what the joint at its first and at its last end gains:
    (offset, angle). In the convention of `Loop`: X(first) Z(kink, offset) X(second) =
    Z(before) X(link) Z(after).
    """

    link: Link
    before: tuple[Any, Any]
    after: tuple[Any, Any]


def composite_link(
    first: Link, second: Link, kink: Any = Kink.STRAIGHT, offset: Any = 0
) -> CompositeLink:
    """The link between the outer axes of two links that are locked at angle ``kink``
    (rad) and ``offset``.

    The spatial triangle of the three axes. A numeric kink gives a twist between 0 and
    pi; the two collinear kinks without offset give sum and difference of lengths and of
    twists as they are. Raises `GeometryError` when the outer axes are parallel, for
    then offset and angle at their ends are not determined. Source: Waldron (1968),
    Baker (1993a); formulas derived from the closure of the triangle.
    """
    if kink is Kink.STRAIGHT and offset == 0:
        return CompositeLink(first + second, (0, 0), (0, 0))
    if kink is Kink.FOLDED and offset == 0:
        return CompositeLink(
            first - second, (0, 0), (0, pi_like(first.twist, second.twist))
        )
    p, q, e = first.length, second.length, offset
    c1, s1, c2, s2 = (
        cos(first.twist),
        sin(first.twist),
        cos(second.twist),
        sin(second.twist),
    )
    ck, sk = (
        (1 - 2 * kink.value, 0) if isinstance(kink, Kink) else (cos(kink), sin(kink))
    )
    cosine = c1 * c2 - ck * s1 * s2
    before = (
        ck * s2 * c1 + c2 * s1,
        sk * s2,
    )  # new common normal seen from the first link, times sin(twist)
    after = (
        ck * s1 * c2 + c1 * s2,
        sk * s1,
    )  # second link seen from the new common normal, times sin(twist)
    sine = sqrt(before[0] ** 2 + before[1] ** 2)
    size = decided(sine)
    if size is not None and size < 1e-12:
        raise GeometryError("kink", kink, "such that the outer axes are not parallel")
    length = (p * before[0] + q * after[0] - e * s1 * s2 * sk) / sine
    along_first, along_last = q * s1 * sk + e * c1, p * s2 * sk + e * c2
    return CompositeLink(
        Link(length, atan2(sine, cosine)),
        ((along_first - cosine * along_last) / sine**2, atan2(before[1], before[0])),
        ((along_last - cosine * along_first) / sine**2, atan2(after[1], after[0])),
    )
