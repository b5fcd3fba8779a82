"""The spatial triangle: three joint axes and their common normals; one side expressed
by the other two."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import degrees, pi
from typing import NamedTuple, TypeAlias

from linkages.construction.conditions import decided
from linkages.construction.link import Link
from linkages.construction.numbers import Number, atan2, cos, pi_like, sin, sqrt
from linkages.values import GeometryError

PARALLEL = 1e-12  # sine of the angle between axes that are parallel but for rounding


class Kink(Enum):
    """The kink angles at which two links are collinear: exact sum and exact difference
    of the links."""

    STRAIGHT = 0
    FOLDED = 1


KinkAngle: TypeAlias = Kink | Number


class EndGain(NamedTuple):
    """What the joint at one end of a composite link gains: offset and angle (rad)."""

    offset: Number
    angle: Number


@dataclass(frozen=True)
class CompositeLink:
    """The link that replaces a locked link pair.

    ``before`` and ``after`` are what the joint at its first and at its last end gains.
    In the convention of `Loop`: X(first) Z(kink, offset) X(second) = Z(before) X(link)
    Z(after).
    """

    link: Link
    before: EndGain
    after: EndGain


def composite_link(
    first: Link,
    second: Link,
    kink: KinkAngle = Kink.STRAIGHT,
    offset: Number = 0,
) -> CompositeLink:
    """The link between the outer axes of two links that are locked at angle ``kink``
    (rad) and ``offset``.

    The spatial triangle of the three axes. A numeric kink gives a twist between 0 and
    pi; the two collinear kinks without offset give sum and difference of lengths and of
    twists as they are. Of the common normals of parallel outer axes it is the one
    at the last end of the second link. Raises `GeometryError` when both are one axis.
    Source: Waldron (1968),
    Baker (1993a); formulas derived from the closure of the triangle.
    """
    if isinstance(kink, Kink) and offset == 0:
        return _collinear(first, second, kink)
    return _triangle(first, second, kink, offset)


def _collinear(first: Link, second: Link, kink: Kink) -> CompositeLink:
    """Sum or difference of the links."""
    nothing = EndGain(0, 0)
    if kink is Kink.STRAIGHT:
        return CompositeLink(first + second, nothing, nothing)
    half_turn = pi_like(first.twist, second.twist)
    return CompositeLink(first - second, nothing, EndGain(0, half_turn))


def _triangle(
    first: Link, second: Link, kink: KinkAngle, offset: Number
) -> CompositeLink:
    """The third side; s and c are sines and cosines of both twists and of the kink."""
    c1 = cos(first.twist)
    s1 = sin(first.twist)
    c2 = cos(second.twist)
    s2 = sin(second.twist)
    ck, sk = _cosine_and_sine(kink)
    cosine = c1 * c2 - ck * s1 * s2
    # new common normal seen from the first link, times the sine of the new twist
    before_x = ck * s2 * c1 + c2 * s1
    before_y = sk * s2
    # second link seen from the new common normal, times the sine of the new twist
    after_x = ck * s1 * c2 + c1 * s2
    after_y = sk * s1
    sine = sqrt(before_x**2 + before_y**2)
    if _is_parallel(sine):
        return _between_parallel_axes(first, second, kink, offset)
    p = first.length
    q = second.length
    length = (p * before_x + q * after_x - offset * s1 * s2 * sk) / sine
    along_first = q * s1 * sk + offset * c1
    along_last = p * s2 * sk + offset * c2
    before_offset = (along_first - cosine * along_last) / sine**2
    after_offset = (along_last - cosine * along_first) / sine**2
    return CompositeLink(
        Link(length, atan2(sine, cosine)),
        EndGain(before_offset, atan2(before_y, before_x)),
        EndGain(after_offset, atan2(after_y, after_x)),
    )


def _cosine_and_sine(kink: KinkAngle) -> tuple[Number, Number]:
    if isinstance(kink, Kink):
        return 1 - 2 * kink.value, 0
    return cos(kink), sin(kink)


def _in_degrees(kink: KinkAngle) -> str:
    """A kink as errors show it, to 10 digits."""
    angle = pi * kink.value if isinstance(kink, Kink) else float(kink)
    return f"{degrees(angle):.10g} deg"


def _is_parallel(sine: Number) -> bool:
    """Whether outer axes are parallel whose angle has a ``sine``."""
    size = decided(sine)
    return size is not None and size < PARALLEL


def _between_parallel_axes(
    first: Link, second: Link, kink: KinkAngle, offset: Number
) -> CompositeLink:
    """The link between parallel outer axes, its end on the last one where the second
    link has its own."""
    c1, s1 = cos(first.twist), sin(first.twist)
    ck, sk = _cosine_and_sine(kink)
    # the last end of the second link, seen from the first axis and the first link
    x = first.length + second.length * ck
    y = second.length * c1 * sk - offset * s1
    z = second.length * s1 * sk + offset * c1
    length = sqrt(x**2 + y**2)
    reach = sqrt(first.length**2 + second.length**2 + offset**2)
    excess = decided(length - PARALLEL * reach)
    if excess is not None and excess <= 0:
        allowed = "such that the outer axes are not the same"
        raise GeometryError("kink", _in_degrees(kink), allowed)
    before = atan2(y, x)
    along = atan2(c1 * sk, ck)  # the second link, seen from the first one
    cosine = decided(c1 * cos(second.twist) - ck * s1 * sin(second.twist))
    if cosine is not None and cosine < 0:
        twist = pi_like(first.twist, second.twist)
        after = before - along
    else:
        twist = 0 * first.twist
        after = along - before
    return CompositeLink(Link(length, twist), EndGain(z, before), EndGain(0, after))
