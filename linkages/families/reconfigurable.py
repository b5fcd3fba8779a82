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

from linkages.closed_forms.closed_form import (
    ClosedForm,
    Pair,
    constant,
    cosine_of,
    joint,
    minus,
    only,
    plus,
    reciprocal,
    signed,
    sine_of,
    symbols,
    tangent,
)
from linkages.construction import numbers
from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_twists,
)
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


# --- forms and closed forms


def _patterns(
    construct: Callable[..., Loop], set_up: str
) -> Callable[..., tuple[FormPattern, ...]]:
    name = f"Bennett 4R form (joints 2,5 inactive) {set_up}"

    def patterns(**values: float) -> tuple[FormPattern, ...]:
        arrays = construct(**values).arrays
        lengths, twists, offsets = (row[:3].tolist() for row in arrays)
        others = bricard_patterns(*lengths, *twists, *offsets)

        def inactive(theta: np.ndarray) -> np.ndarray:
            gap = np.asarray(theta)[..., [1, 4]] - values["kink"]
            return np.sin(gap / 2)

        return FormPattern(name, inactive), *others

    return patterns


def _triangle_constants() -> dict[str, Number]:
    """The constants of the closed form, by the half tangents of alpha, beta, kink,
    gamma: the spatial triangle, as in `composite_link`, and the product m of the
    Bennett loop on its third side."""
    u_a = tangent("alpha")
    u_b = tangent("beta")
    u_k = tangent("kink")
    u_g = tangent("gamma")
    s_a = sine_of(u_a)
    c_a = cosine_of(u_a)
    s_b = sine_of(u_b)
    c_b = cosine_of(u_b)
    s_k = sine_of(u_k)
    c_k = cosine_of(u_k)
    x_1, y_1, sin_d, u_d = symbols("x_1 y_1 sin_delta u_delta")
    return {
        "k": u_k,
        "x_1": c_k * s_b * c_a + c_b * s_a,
        "y_1": s_k * s_b,
        "x_3": c_k * s_a * c_b + c_a * s_b,
        "y_3": s_k * s_a,
        "sin_delta": numbers.sqrt(x_1**2 + y_1**2),
        "u_delta": sin_d / (1 + c_a * c_b - c_k * s_a * s_b),
        "m": (u_g + u_d) / (u_g - u_d),
    }


def _formulas(sign: int, equation: str, linkage: str) -> tuple[ClosedForm, ...]:
    """The Bennett form, ``sign`` +1 for the line-symmetric set-up: third sides of the
    triangles, links 34 and 61.

    The angles of that Bennett loop are theta1 + first, theta3 + third, where first and
    third are the angles of the spatial triangle at the joints 1 and 3. Song (2013),
    equations (5.3.13), (5.3.15).
    """
    sin_d = constant("sin_delta")
    first = (constant("y_1"), sin_d + constant("x_1"))
    third = (constant("y_3"), sin_d + constant("x_3"))
    kink: Pair = (constant("k"), 1)
    one = plus(joint(1), first)
    other = reciprocal(one, constant("m"))
    angles = (
        joint(1),
        kink,
        minus(other, third),
        minus(signed(sign, one), first),
        kink,
        minus(signed(sign, other), third),
    )
    form = ClosedForm(
        linkage,
        "Bennett 4R form",
        f"Song 2013, eq. {equation}",
        ("alpha", "beta", "kink", "gamma"),
        only(*angles),
        _triangle_constants(),
    )
    return (form,)


# every five degrees, none of them collinear
CIRCLE = np.linspace(-math.pi, math.pi, 72, endpoint=False) + 0.01
KINK_SCAN = {"kink": tuple(CIRCLE.tolist())}

ENTRIES = read_entries(
    "reconfigurable",
    {
        "reconfigurable-bricard-1": Model(
            reconfigurable_bricard_1,
            _patterns(reconfigurable_bricard_1, "asymmetric"),
            partial(_formulas, -1, "(5.3.13)"),
            scan=KINK_SCAN,
        ),
        "reconfigurable-bricard-2": Model(
            reconfigurable_bricard_2,
            _patterns(reconfigurable_bricard_2, "line-symmetric"),
            partial(_formulas, +1, "(5.3.15)"),
            scan=KINK_SCAN,
        ),
    },
)
