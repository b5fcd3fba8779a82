"""Plane-symmetric Bricard 6R linkages: general, revised and octahedral."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial

import numpy as np

from linkages.construction.conditions import decided, require_different, require_equal
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, acos, cos, pi_like, sin
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop
from linkages.values import GeometryError

POSITION = 170


def plane_symmetric(
    a12: Number,
    a23: Number,
    a34: Number,
    alpha12: Number,
    alpha23: Number,
    alpha34: Number,
    R2: Number,
    R3: Number,
    revised: bool = False,
) -> Loop:
    """General plane-symmetric Bricard 6R; lengths and offsets in one unit, twists in
    rad.

    alpha12 + alpha61 = alpha34 + alpha45 = pi, alpha23 + alpha56 = 0, R2 = R6, R3 = R5.
    Source: Bricard (1927); equation (2.4.14) in Song (2013) has alpha23 + alpha56 = pi,
    which with these offsets is rigid. The ``revised`` one of Mavroidis and Roth (1995),
    equation (2.4.20) in Song (2013), has opposite twists, R2 = -R6, R3 = -R5: the axes 2
    and 6 are reversed on one side.
    """
    pi = pi_like(alpha12, alpha23, alpha34)
    sign = -1 if revised else 1
    return closed_chain(
        Link(a12, alpha12),
        Link(a23, alpha23),
        Link(a34, alpha34),
        Link(a34, -alpha34 if revised else pi - alpha34),
        Link(a23, -alpha23),
        Link(a12, -alpha12 if revised else pi - alpha12),
        offsets=(0, R2, R3, 0, sign * R3, sign * R2),
    )


def plane_symmetric_octahedral(
    alpha12: Number,
    alpha23: Number,
    alpha34: Number,
    alpha45: Number,
    alpha61: Number,
    R1: Number,
    alpha56: Number | None = None,
) -> Loop:
    """Plane-symmetric octahedral Bricard 6R: all lengths zero, offsets from ``R1`` and
    the twists (rad).

    ``alpha56`` follows from R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6
    cos(alpha56) and is checked if given. Raises `GeometryError`. Source: Bricard
    (1927); equation (2.4.17) in Song (2013) lacks that condition and is rigid without
    it.
    """
    R2, R3 = _outer_offsets(R1, alpha34, alpha12, "alpha12 + alpha34")
    R6, R5 = _outer_offsets(R1, alpha45, alpha61, "alpha45 + alpha61")
    base = R2**2 + R3**2 + 2 * R2 * R3 * cos(alpha23)
    product = 2 * R5 * R6
    require_different("2 R5 R6", product, 0, "an offset of no length", scale=R1**2)
    cosine = (base - R5**2 - R6**2) / product
    value = decided(cosine)
    if value is not None and abs(value) > 1:
        allowed = "between -1 and 1; these twists do not close"
        raise GeometryError("cos(alpha56)", value, allowed)
    if alpha56 is None:
        alpha56 = acos(cosine)
    else:
        require_equal("cos(alpha56)", cos(alpha56), cosine, "for the other twists")
    twists = (alpha12, alpha23, alpha34, alpha45, alpha56, alpha61)
    links = [Link(0, twist) for twist in twists]
    return closed_chain(*links, offsets=(R1, R2, R3, -R1, R5, R6))


def _outer_offsets(
    R1: Number, first: Number, second: Number, total: str
) -> tuple[Number, Number]:
    """The offsets -R1 sin(first)/sin(first + second), R1 sin(second)/sin(first +
    second); ``total`` is the name of that sum."""
    sine = sin(second + first)
    require_different(f"sin({total})", sine, 0, "parallel axes")
    return -R1 * sin(first) / sine, R1 * sin(second) / sine


def _octahedral_guesses(form: np.ndarray) -> Iterator[dict[str, float]]:
    """Twists of links of no length have no sign of their own, so all are tried."""
    twists = form[1]
    for s2, s3, s4, s6 in itertools.product((1, -1), repeat=4):
        yield {
            "alpha23": twists[1] if s2 > 0 else np.pi - twists[1],
            "alpha34": s3 * twists[2],
            "alpha45": s4 * twists[3],
            "alpha61": s6 * twists[5],
        }


ENTRIES = read_entries(
    "bricard_plane",
    {
        "bricard-plane-symmetric": Model(plane_symmetric),
        "bricard-plane-symmetric-revised": Model(
            partial(plane_symmetric, revised=True)
        ),
        "bricard-octahedral-plane-symmetric": Model(
            plane_symmetric_octahedral, guesses=_octahedral_guesses
        ),
    },
)
