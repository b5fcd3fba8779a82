"""Kaleidocycles: rings of 6 to 12 hinges on links that are all alike, each the common
normal of its two hinges; tetrahedra that hang together by opposite edges.

A hinge has no sense, so that a ring of links of one twist may close in two ways: with
the sense of the first hinge handed on from link to link, the last link hands it back or
reverses it. The latter rings, Moebius kaleidocycles, close only from a least twist on.
There all configurations are one closed curve, however many hinges there are, and the
screws have rank 5 all along it: the least twist is a fold of the closure.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from linkages.construction.conditions import require_positive
from linkages.construction.numbers import Number, atan, pi_like
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop

POSITION = 220
CLASSIC = (6, 8, 10, 12)
# tan(twist / 2) of the least twist, by the number of hinges: roots of
# 128 c^3 - 183 c^2 + 202 c - 47 (7) and 8 c^3 - 15 c^2 + 18 c - 7 (9) in its cosine, of
# 64 c^8 - 128 c^6 + 144 c^4 - 52 c^2 - 1 (12), and of longer polynomials
LEAST_HALF_TANGENTS = {
    7: "0.737521719609819267333190208189874690003732059513984",
    8: "0.600484999351711202587232986182792370915381575827921",
    9: "0.511534704995203695713531343648126496069104053718613",
    10: "0.447742281684854429932364082997001113669928980924342",
    11: "0.399208888113449628300631839011061441691635041190041",
    12: "0.360790283538865659099071942805396091469371970314238",
}


def kaleidocycle(a: Number, joints: int) -> Loop:
    """The classic ring of an even number of ``joints``: links of length ``a``, right
    angles of alternating sign, so that neighbouring links may mirror each other.

    Raises `GeometryError` for a length that is not positive. Source: Schattschneider and
    Walker (1977).
    """
    require_positive("length a", a)
    right = pi_like(a) / 2
    return Loop((a,) * joints, (right, -right) * (joints // 2), (0,) * joints)


def twisted_ring(a: Number, twist: Number, joints: int) -> Loop:
    """The ring of links of length ``a`` and of one ``twist`` (rad), of which the last
    one reverses the sense of the first hinge.

    Raises `GeometryError` for a length that is not positive.
    """
    require_positive("length a", a)
    twists = (twist,) * (joints - 1) + (twist - pi_like(a, twist),)
    return Loop((a,) * joints, twists, (0,) * joints)


def moebius_kaleidocycle(a: Number, joints: int) -> Loop:
    """The `twisted_ring` of the least twist with which it closes.

    Raises `GeometryError` for a length that is not positive. Sources: Schönke and Fried
    (2019), Kaji, Schönke, Grunwald and Fried (2018).
    """
    require_positive("length a", a)
    unit = a / a  # in the number type of the length
    half_tangent = Fraction(LEAST_HALF_TANGENTS[joints]) * unit
    return twisted_ring(a, 2 * atan(half_tangent), joints)


ENTRIES = read_entries(
    "kaleidocycle",
    {
        f"kaleidocycle-{joints}": Model(partial(kaleidocycle, joints=joints))
        for joints in CLASSIC
    }
    | {
        f"moebius-kaleidocycle-{joints}": Model(
            partial(moebius_kaleidocycle, joints=joints)
        )
        for joints in LEAST_HALF_TANGENTS
    },
)
