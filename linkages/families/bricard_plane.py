"""Plane-symmetric Bricard 6R linkages: general, revised and octahedral."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from linkages.construction.conditions import decided, require_different, require_equal
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number, acos, cos, pi_like, sin
from linkages.construction.table_equations import (
    TableNumbers,
    equal_lengths,
    equal_offsets,
    equation,
    opposite_offsets,
    opposite_twists,
    supplementary_twists,
    zero_lengths,
    zero_offsets,
    zero_twist_sums,
)
from linkages.entry import (
    Condition,
    Entry,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
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
) -> Loop:
    """General plane-symmetric Bricard 6R; lengths and offsets in one unit, twists in
    rad.

    alpha12 + alpha61 = alpha34 + alpha45 = pi, alpha23 + alpha56 = 0, R2 = R6, R3 = R5.
    Source: Bricard (1927); equation (2.4.14) in Song (2013) has alpha23 + alpha56 = pi,
    which with these offsets is rigid.
    """
    pi = pi_like(alpha12, alpha23, alpha34)
    return closed_chain(
        Link(a12, alpha12),
        Link(a23, alpha23),
        Link(a34, alpha34),
        Link(a34, pi - alpha34),
        Link(a23, -alpha23),
        Link(a12, pi - alpha12),
        offsets=(0, R2, R3, 0, R3, R2),
    )


def revised_plane_symmetric(
    a12: Number,
    a23: Number,
    a34: Number,
    alpha12: Number,
    alpha23: Number,
    alpha34: Number,
    R2: Number,
    R3: Number,
) -> Loop:
    """Revised general plane-symmetric Bricard 6R: opposite twists, R2 = -R6, R3 = -R5.

    Lengths and offsets in one unit, twists in rad. Source: Mavroidis and Roth (1995);
    equation (2.4.20) in Song (2013). It is `plane_symmetric` with the axes 2 and 6
    reversed on one side.
    """
    return closed_chain(
        Link(a12, alpha12),
        Link(a23, alpha23),
        Link(a34, alpha34),
        Link(a34, -alpha34),
        Link(a23, -alpha23),
        Link(a12, -alpha12),
        offsets=(0, R2, R3, 0, -R3, -R2),
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


# --- conditions


def _second_gap(t: TableNumbers) -> float:
    """R2 = -R1 sin(alpha34)/sin(alpha12+alpha34)."""
    sine = math.sin(t.alpha(12) + t.alpha(34))
    return t.R(2) + t.R(1) * math.sin(t.alpha(34)) / sine


def _third_gap(t: TableNumbers) -> float:
    """R3 = R1 sin(alpha12)/sin(alpha12+alpha34)."""
    sine = math.sin(t.alpha(12) + t.alpha(34))
    return t.R(3) - t.R(1) * math.sin(t.alpha(12)) / sine


def _fifth_gap(t: TableNumbers) -> float:
    """R5 = R1 sin(alpha61)/sin(alpha45+alpha61)."""
    sine = math.sin(t.alpha(45) + t.alpha(61))
    return t.R(5) - t.R(1) * math.sin(t.alpha(61)) / sine


def _sixth_gap(t: TableNumbers) -> float:
    """R6 = -R1 sin(alpha45)/sin(alpha45+alpha61)."""
    sine = math.sin(t.alpha(45) + t.alpha(61))
    return t.R(6) + t.R(1) * math.sin(t.alpha(45)) / sine


def _bases_gap(t: TableNumbers) -> float:
    """R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6 cos(alpha56)."""
    one = _squared_base(t.R(2), t.R(3), t.alpha(23))
    other = _squared_base(t.R(5), t.R(6), t.alpha(56))
    return one - other


def _squared_base(x: float, y: float, angle: float) -> float:
    """The squared third side of a triangle with the turn ``angle`` between two."""
    return x**2 + y**2 + 2 * x * y * math.cos(angle)


MIRRORED_LENGTHS = Condition(
    "a12 = a61, a23 = a56, a34 = a45", (equal_lengths((12, 61), (23, 56), (34, 45)),)
)
SUPPLEMENTARY_TWISTS = Condition(
    "alpha12 + alpha61 = pi, alpha23 + alpha56 = 0, alpha34 + alpha45 = pi",
    (supplementary_twists((12, 61), (34, 45)), opposite_twists((23, 56))),
)
OPPOSITE_TWISTS = Condition(
    "alpha12 + alpha61 = alpha23 + alpha56 = alpha34 + alpha45 = 0",
    (zero_twist_sums((12, 61), (23, 56), (34, 45)),),
)
OCTAHEDRON = (
    Condition("all lengths zero, R4 = -R1", (zero_lengths(), opposite_offsets((1, 4)))),
    Condition(
        "R2 = -R1 sin(alpha34)/sin(alpha12+alpha34), "
        "R3 = R1 sin(alpha12)/sin(alpha12+alpha34)",
        (equation(_second_gap), equation(_third_gap)),
    ),
    Condition(
        "R5 = R1 sin(alpha61)/sin(alpha45+alpha61), "
        "R6 = -R1 sin(alpha45)/sin(alpha45+alpha61)",
        (equation(_fifth_gap), equation(_sixth_gap)),
    ),
    Condition(
        "R2^2 + R3^2 + 2 R2 R3 cos(alpha23) = R5^2 + R6^2 + 2 R5 R6 cos(alpha56)",
        (equation(_bases_gap),),
    ),
)


# --- entries


def _length(name: str, default: float) -> Parameter:
    return Parameter.length(name, default, f"length {name}", 0.3, 2.0)


def _offset(name: str, default: float, low: float, high: float) -> Parameter:
    return Parameter.length(name, default, f"offset {name}", low, high)


def _twist(link: int, degrees: float) -> Parameter:
    return Parameter.angle(f"alpha{link}", degrees, f"twist of link {link}", 15, 165)


def _octahedral_twist(link: int, default: float, low: float, high: float) -> Parameter:
    """The twist with its default in rad and its bounds in degrees."""
    return Parameter(
        f"alpha{link}",
        default,
        ParameterKind.ANGLE,
        f"twist of link {link}",
        math.radians(low),
        math.radians(high),
    )


HALF = (
    _length("a12", 1.0),
    _length("a23", 0.8),
    _length("a34", 1.25),
    _twist(12, 50),
    _twist(23, 77),
    _twist(34, 110),
    _offset("R2", -0.45, -0.5, 0.5),
    _offset("R3", 0.6, -0.5, 0.5),
)
FACTS = {"joints": 6, "mobility": 1}

ENTRIES = (
    Entry(
        "bricard-plane-symmetric",
        "General plane-symmetric Bricard 6R",
        "Bricard (1927); Baker (1980); Song (2013), eq. 2.4.14",
        plane_symmetric,
        HALF,
        conditions=(
            MIRRORED_LENGTHS,
            SUPPLEMENTARY_TWISTS,
            Condition(
                "R1 = R4 = 0, R2 = R6, R3 = R5",
                (zero_offsets(1, 4), equal_offsets((2, 6), (3, 5))),
            ),
        ),
        errata=("alpha23 + alpha56 = pi is printed; it is 0 with R2 = R6, R3 = R5",),
        facts=FACTS,
    ),
    Entry(
        "bricard-plane-symmetric-revised",
        "Revised general plane-symmetric Bricard 6R",
        "Mavroidis and Roth (1995); Song (2013), eq. 2.4.20",
        revised_plane_symmetric,
        HALF,
        conditions=(
            MIRRORED_LENGTHS,
            OPPOSITE_TWISTS,
            Condition(
                "R1 = R4 = 0, R2 = -R6, R3 = -R5",
                (zero_offsets(1, 4), opposite_offsets((2, 6), (3, 5))),
            ),
        ),
        relations=(
            Relation(
                RelationKind.SAME,
                "bricard-plane-symmetric",
                "Mavroidis and Roth (1995)",
            ),
        ),
        facts=FACTS,
    ),
    Entry(
        "bricard-octahedral-plane-symmetric",
        "Plane-symmetric octahedral Bricard 6R",
        "Bricard (1897, 1927); Baker (1980); Song (2013), eq. 2.4.17",
        plane_symmetric_octahedral,
        (
            _octahedral_twist(12, 2.1898919226139584, 115, 130),
            _octahedral_twist(23, 0.9447166986444288, 45, 65),
            _octahedral_twist(34, 2.258845335456913, 120, 135),
            _octahedral_twist(45, 0.8086507372666255, 42, 50),
            _octahedral_twist(61, 0.5933371007764807, 32, 36),
            _offset("R1", 1.936892176093739, 1.0, 3.0),
        ),
        conditions=OCTAHEDRON,
        guesses=_octahedral_guesses,
        errata=(
            "the condition on alpha23 and alpha56 is missing in print; "
            "without it the loop is rigid",
        ),
        facts=FACTS,
    ),
)
