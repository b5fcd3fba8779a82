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
    negative,
    only,
    plus,
    reciprocal,
    sine_of,
    tangent,
)
from linkages.construction import numbers
from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_within,
)
from linkages.construction.link import Link
from linkages.construction.numbers import Number, pi_like
from linkages.construction.spatial_triangle import composite_link
from linkages.construction.table_equations import equal_links, equal_offsets
from linkages.entry import (
    Condition,
    Entry,
    FormPattern,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
from linkages.families.bricard import bricard_line_symmetric
from linkages.families.bricard import patterns as bricard_patterns
from linkages.loop import Loop

POSITION = 200
SOURCE = "Song 2013, Kinematic study of overconstrained linkages, section 5.3, "
FIRST, SECOND = "reconfigurable-bricard-1", "reconfigurable-bricard-2"


def _loop(
    a: Number,
    alpha: Number,
    b: Number,
    beta: Number,
    r2: Number,
    kink: Number,
    gamma: Number,
    c: Number | None,
    twist34: Number,
) -> Loop:
    require_positive("length a", a)
    require_positive("length b", b)
    require_within("twist alpha", alpha, 0.0, math.pi)
    require_within("twist beta", beta, 0.0, math.pi)
    require_within("twist gamma", gamma, 0.0, math.pi)
    triangle = composite_link(Link(a, alpha), Link(b, beta), kink, r2)
    third = triangle.link
    c = bennett_length("34", gamma, c, third.length, third.twist)
    r1 = -triangle.before.offset
    r3 = -triangle.after.offset
    return bricard_line_symmetric(a, b, c, alpha, beta, twist34, r1, r2, r3)


def reconfigurable_bricard_1(
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
    a: Number,
    alpha: Number,
    b: Number,
    beta: Number,
    r2: Number,
    kink: Number,
    gamma: Number,
    c: Number | None = None,
) -> Loop:
    """The second reconfigurable Bricard linkage, whose links 34 and 61 have the twist
    gamma - pi.

    Parameters and errors as in `reconfigurable_bricard_1`. Source: Song 2013, eqs
    (5.3.14), (5.3.15), where (5.3.6) must have sines in place of cosines.
    """
    return _loop(a, alpha, b, beta, r2, kink, gamma, c, gamma - pi_like(gamma))


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
    x_1 = constant("x_1")
    y_1 = constant("y_1")
    sin_d = constant("sin_delta")
    u_d = constant("u_delta")
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


def _formulas(linkage: str, sign: int, equation: str) -> tuple[ClosedForm, ...]:
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
    opposite_one = one if sign > 0 else negative(one)
    opposite_other = other if sign > 0 else negative(other)
    angles = (
        joint(1),
        kink,
        minus(other, third),
        minus(opposite_one, first),
        kink,
        minus(opposite_other, third),
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


# --- entries


def _twist(name: str, degrees: float, links: str) -> Parameter:
    default = math.radians(degrees)
    meaning = f"twist of links {links}"
    return Parameter(name, default, ParameterKind.ANGLE, meaning, 0.2, math.pi - 0.2)


PARAMETERS = (
    Parameter.length("a", 0.9, "length of links 12 and 45", 0.3, 3.0),
    _twist("alpha", 35, "12 and 45"),
    Parameter.length("b", 2.0, "length of links 23 and 56", 0.3, 3.0),
    _twist("beta", 60, "23 and 56"),
    Parameter.length("r2", 0.7, "offset of joints 2 and 5", -1.0, 1.0),
    Parameter(
        "kink",
        math.radians(-70),
        ParameterKind.ANGLE,
        "angle of joints 2 and 5 in the Bennett form",
        -3.0,
        3.0,
    ),
    _twist("gamma", 160, "34 and 61"),
)
# every five degrees, none of them collinear
CIRCLE = np.linspace(-math.pi, math.pi, 72, endpoint=False) + 0.01
KINK_SCAN = {"kink": tuple(CIRCLE.tolist())}
LINE_SYMMETRY = Condition(
    "opposite links and offsets alike",
    (equal_links((12, 45), (23, 56), (34, 61)), equal_offsets((1, 4), (2, 5), (3, 6))),
)
TRIANGLE = Condition(
    "R1 and R3 those of the spatial triangle of the links 12 and 23 at theta2 = kink"
)
RELATIONS = (
    Relation(
        RelationKind.SPECIAL_CASE, "bricard-line-symmetric", "Song (2013), section 5.3"
    ),
    Relation(
        RelationKind.CONSTRUCTED,
        "bennett",
        "Song (2013), section 5.3",
        "a spatial triangle on opposite links",
    ),
)
DENOMINATOR = (
    "Song 2013, eqs (5.3.2), (5.3.9), (5.3.18): the denominator of R3 must be "
    "sin(alpha23) sin(theta2)"
)

ENTRIES: tuple[Entry, ...] = (
    Entry(
        FIRST,
        "First reconfigurable line-symmetric Bricard 6R linkage",
        SOURCE + "eqs (5.3.7)-(5.3.13)",
        reconfigurable_bricard_1,
        PARAMETERS,
        conditions=(
            LINE_SYMMETRY,
            TRIANGLE,
            Condition(
                "sin(gamma)/c = sin(delta)/d of the third side d/delta of the triangle"
            ),
        ),
        patterns=_patterns(reconfigurable_bricard_1, "asymmetric"),
        formulas=partial(_formulas, FIRST, -1, "(5.3.13)"),
        scan=KINK_SCAN,
        relations=RELATIONS,
        errata=(
            DENOMINATOR,
            "Song 2013, eq. (5.3.18): the minus sign before sin(alpha34)/a34 must be a "
            "plus",
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
        SECOND,
        "Second reconfigurable line-symmetric Bricard 6R linkage",
        SOURCE + "eqs (5.3.14), (5.3.15)",
        reconfigurable_bricard_2,
        PARAMETERS,
        conditions=(
            LINE_SYMMETRY,
            TRIANGLE,
            Condition(
                "sin(gamma - pi)/c = -sin(delta)/d of the third side d/delta of the "
                "triangle"
            ),
        ),
        patterns=_patterns(reconfigurable_bricard_2, "line-symmetric"),
        formulas=partial(_formulas, SECOND, +1, "(5.3.15)"),
        scan=KINK_SCAN,
        relations=RELATIONS,
        errata=(
            DENOMINATOR,
            "Song 2013, eq. (5.3.6): the two cosines must be sines",
            "Song 2013, section 5.3.4: the Bennett form need not be Form II; it "
            "follows the roots of Form I for the default parameters, and those of "
            "both, with two bifurcations, for most others",
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
