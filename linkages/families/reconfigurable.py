"""The reconfigurable line-symmetric Bricard linkages, first and second.

Two equal spatial triangles with sides a/alpha, b/beta and the kink theta2' stand on the
opposite links of a Bennett linkage: with the joints 2 and 5 at the kink, the joints 1,
3, 4, 6 turn as that Bennett linkage. Its set-up is asymmetric in the first linkage and
line-symmetric in the second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_within,
)
from linkages.construction.link import Link
from linkages.construction.numbers import pi_like
from linkages.construction.spatial_triangle import composite_link
from linkages.entry import Entry, FormPattern, Parameter
from linkages.families.bricard import bricard_line_symmetric
from linkages.families.bricard_forms import patterns as bricard_patterns
from linkages.loop import Loop

__all__ = ["ENTRIES", "reconfigurable_bricard_1", "reconfigurable_bricard_2"]

SOURCE = "Song 2013, Kinematic study of overconstrained linkages, section 5.3, "


def _loop(
    a: Any,
    alpha: Any,
    b: Any,
    beta: Any,
    r2: Any,
    kink: Any,
    gamma: Any,
    c: Any,
    twist34: Any,
) -> Loop:
    require_positive("length a", a)
    require_positive("length b", b)
    for name, twist in (("alpha", alpha), ("beta", beta), ("gamma", gamma)):
        require_within(f"twist {name}", twist, 0.0, math.pi)
    triangle = composite_link(Link(a, alpha), Link(b, beta), kink, r2)
    c = bennett_length("34", gamma, c, triangle.link.length, triangle.link.twist)
    r1, r3 = -triangle.before[0], -triangle.after[0]
    return bricard_line_symmetric(a, b, c, alpha, beta, twist34, r1, r2, r3)


def reconfigurable_bricard_1(
    a: Any, alpha: Any, b: Any, beta: Any, r2: Any, kink: Any, gamma: Any, c: Any = None
) -> Loop:
    """The first reconfigurable Bricard linkage: links 12 a/alpha, 23 b/beta, 34
    c/gamma, twice over.

    ``kink`` is the constant angle theta2' = theta5' of the Bennett form, rad, and
    ``r2`` the offset of joint 2. Length c follows from the Bennett ratio of the third
    side of the triangle, and is checked when given; the offsets of joints 1 and 3 are
    those of the triangle. Raises `GeometryError` when c is not positive or has another
    ratio. Source: Song 2013, eqs (5.3.7)-(5.3.13), where the denominator of r3 in
    (5.3.9) must be sin(beta) sin(theta2').
    """
    return _loop(a, alpha, b, beta, r2, kink, gamma, c, gamma)


def reconfigurable_bricard_2(
    a: Any, alpha: Any, b: Any, beta: Any, r2: Any, kink: Any, gamma: Any, c: Any = None
) -> Loop:
    """The second reconfigurable Bricard linkage, whose links 34 and 61 have the twist
    gamma - pi.

    Parameters and errors as in `reconfigurable_bricard_1`. Source: Song 2013, eqs
    (5.3.14), (5.3.15), where (5.3.6) must have sines in place of cosines.
    """
    return _loop(a, alpha, b, beta, r2, kink, gamma, c, gamma - pi_like(gamma))


def _patterns(
    construct: Callable[..., Loop], set_up: str
) -> Callable[..., tuple[FormPattern, ...]]:
    name = f"Bennett 4R form (joints 2,5 inactive) {set_up}"

    def patterns(**values: float) -> tuple[FormPattern, ...]:
        lengths, twists, offsets = (tuple(v[:3]) for v in construct(**values).arrays)

        def inactive(theta: np.ndarray) -> np.ndarray:
            return np.sin((np.asarray(theta)[..., [1, 4]] - values["kink"]) / 2)

        return FormPattern(name, inactive), *bricard_patterns(
            *lengths, *twists, *offsets
        )

    return patterns


PARAMETERS = (
    Parameter("a", 0.9, "length", "length of links 12 and 45", 0.3, 3.0),
    Parameter(
        "alpha",
        math.radians(35),
        "angle",
        "twist of links 12 and 45",
        0.2,
        math.pi - 0.2,
    ),
    Parameter("b", 2.0, "length", "length of links 23 and 56", 0.3, 3.0),
    Parameter(
        "beta",
        math.radians(60),
        "angle",
        "twist of links 23 and 56",
        0.2,
        math.pi - 0.2,
    ),
    Parameter("r2", 0.7, "length", "offset of joints 2 and 5", -1.0, 1.0),
    Parameter(
        "kink",
        math.radians(-70),
        "angle",
        "angle of joints 2 and 5 in the Bennett form",
        -3.0,
        3.0,
    ),
    Parameter(
        "gamma",
        math.radians(160),
        "angle",
        "twist of links 34 and 61",
        0.2,
        math.pi - 0.2,
    ),
)
CONDITIONS = (
    "opposite links and offsets alike",
    "R1 and R3 those of the spatial triangle of the links 12 and 23 at theta2 = kink",
)
TRIANGLE = "Song 2013, eqs (5.3.2), (5.3.9), (5.3.18): the denominator of R3 must be sin(alpha23) sin(theta2)"

ENTRIES: tuple[Entry, ...] = (
    Entry(
        "reconfigurable-bricard-1",
        "First reconfigurable line-symmetric Bricard 6R linkage",
        SOURCE + "eqs (5.3.7)-(5.3.13)",
        reconfigurable_bricard_1,
        PARAMETERS,
        conditions=(
            *CONDITIONS,
            "sin(gamma)/c = sin(delta)/d of the third side d/delta of the triangle",
        ),
        patterns=_patterns(reconfigurable_bricard_1, "asymmetric"),
        errata=(
            TRIANGLE,
            "Song 2013, eq. (5.3.18): the minus sign before sin(alpha34)/a34 must be a plus",
        ),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 3,
            "bifurcations": 2,
            "components": 1,
        },
    ),
    Entry(
        "reconfigurable-bricard-2",
        "Second reconfigurable line-symmetric Bricard 6R linkage",
        SOURCE + "eqs (5.3.14), (5.3.15)",
        reconfigurable_bricard_2,
        PARAMETERS,
        conditions=(
            *CONDITIONS,
            "sin(gamma - pi)/c = -sin(delta)/d of the third side d/delta of the triangle",
        ),
        patterns=_patterns(reconfigurable_bricard_2, "line-symmetric"),
        errata=(
            TRIANGLE,
            "Song 2013, eq. (5.3.6): the two cosines must be sines",
            "Song 2013, section 5.3.4: the Bennett form need not be Form II; it follows the roots of Form I for "
            "the default parameters, and those of both, with two bifurcations, for most others",
        ),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 2,
            "bifurcations": 0,
            "components": 2,
        },
    ),
)
