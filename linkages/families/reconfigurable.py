"""The reconfigurable line-symmetric Bricard linkages, first and second.

Two equal spatial triangles with sides a/alpha, b/beta and the kink theta2' stand on the
opposite links of a Bennett linkage: with the joints 2 and 5 at the kink, the joints 1,
3, 4, 6 turn as that Bennett linkage. Its set-up is asymmetric in the first linkage and
line-symmetric in the second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_twists,
)
from linkages.construction.equations import numbers_of
from linkages.construction.link import Link
from linkages.construction.numbers import Number, pi_like
from linkages.construction.spatial_triangle import composite_link
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.families.bricard import bricard_line_symmetric
from linkages.families.bricard import patterns as bricard_patterns
from linkages.loop import Loop

POSITION = 200


def reconfigurable_bricard(
    is_second: bool,
    a: Number,
    alpha: Number,
    b: Number,
    beta: Number,
    r2: Number,
    kink: Number,
    gamma: Number,
    c: Number | None = None,
) -> Loop:
    """The first reconfigurable Bricard linkage: links 12 a/alpha, 23 b/beta, 34
    c/gamma, twice over; or the second, whose links 34 and 61 have the twist gamma - pi.

    ``kink`` is the constant angle theta2' = theta5' of the Bennett form, rad, and
    ``r2`` the offset of joint 2. Length c follows from the Bennett ratio of the third
    side of the triangle, and is checked when given; the offsets of joints 1 and 3 are
    those of the triangle. Raises `GeometryError` when c is not positive or has another
    ratio. Source: Song 2013, eqs (5.3.7)-(5.3.15), where the denominator of r3 in
    (5.3.9) must be sin(beta) sin(theta2'), and (5.3.6) must have sines in place of
    cosines.
    """
    require_positive("length a", a)
    require_positive("length b", b)
    require_twists(alpha=alpha, beta=beta, gamma=gamma)
    triangle = composite_link(Link(a, alpha), Link(b, beta), kink, r2)
    third = triangle.link
    c = bennett_length("34", gamma, c, third.length, third.twist)
    r1 = -triangle.before.offset
    r3 = -triangle.after.offset
    twist34 = gamma - pi_like(gamma) if is_second else gamma
    return bricard_line_symmetric(a, b, c, alpha, beta, twist34, r1, r2, r3)


reconfigurable_bricard_1 = partial(reconfigurable_bricard, False)
reconfigurable_bricard_2 = partial(reconfigurable_bricard, True)


# --- forms


def _patterns(
    construct: Callable[..., Loop], set_up: str
) -> Callable[..., tuple[FormPattern, ...]]:
    name = f"Bennett 4R form (joints 2,5 inactive) {set_up}"

    def patterns(**values: float) -> tuple[FormPattern, ...]:
        others = bricard_patterns(
            False, **numbers_of(np.array(construct(**values).arrays))
        )

        def inactive(theta: np.ndarray) -> np.ndarray:
            gap = np.asarray(theta)[..., [1, 4]] - values["kink"]
            return np.sin(gap / 2)

        return FormPattern(name, inactive), *others

    return patterns


# every five degrees, none of them collinear
CIRCLE = np.linspace(-math.pi, math.pi, 72, endpoint=False) + 0.01
KINK_SCAN = {"kink": tuple(CIRCLE.tolist())}

ENTRIES = read_entries(
    "reconfigurable",
    {
        "reconfigurable-bricard-1": Model(
            reconfigurable_bricard_1,
            _patterns(reconfigurable_bricard_1, "asymmetric"),
            scan=KINK_SCAN,
        ),
        "reconfigurable-bricard-2": Model(
            reconfigurable_bricard_2,
            _patterns(reconfigurable_bricard_2, "line-symmetric"),
            scan=KINK_SCAN,
        ),
    },
)
