"""Closed forms of the line-symmetric Bricard linkages, of the reconfigurable ones, and
of Wohlhart's symmetric 6R.

Line-symmetric: Song (2013), equations (4.2.14)-(4.2.24), with H2 and L2 of (4.2.15) as
in `linkages.families.bricard_forms`, and (4.3.3)-(4.3.8) for opposite angles. The
discriminants of theta2 and theta3 are the same, so that the root of one is that of the
other, with the opposite sign. Reconfigurable: equations (5.3.13), (5.3.15). Wohlhart's:
Racila and Dahan (2010), equation (15).
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from linkages.closed_forms.closed_form import (
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    negative,
    plus,
    reciprocal,
    tangent,
)
from linkages.families.bricard_forms import original_equations, revised_equations

__all__ = ["FORMS"]

FIRST, SECOND = joint(1), joint(2)
LENGTHS, TWISTS, OFFSETS = (
    ("a12", "a23", "a34"),
    ("alpha12", "alpha23", "alpha34"),
    ("R1", "R2", "R3"),
)
LETTERS = "ABCDEFGHL"


def cosine(u: Any) -> Any:
    """Cosine of the angle whose half has the tangent ``u``."""
    return (1 - u**2) / (1 + u**2)


def sine(u: Any) -> Any:
    """Sine of the angle whose half has the tangent ``u``."""
    return 2 * u / (1 + u**2)


def _terms(joint_number: int) -> tuple[Any, Any, Any]:
    """Aterm, Bterm, Cterm of equations (4.2.18), (4.2.21): the quadratic in
    tan(theta/2) of joint 2 or 3."""
    a, b, c, d, e, f, g, h, free = (
        constant(f"{letter}_{joint_number}") for letter in LETTERS
    )
    s1, c1 = FIRST
    sin1, cos1, one = 2 * s1 * c1, c1**2 - s1**2, s1**2 + c1**2
    rest = a * sin1 + b * cos1 + free * one
    by_sin, by_cos = c * one + e * sin1 + g * cos1, d * one + f * sin1 + h * cos1
    return rest - by_cos, 2 * by_sin, rest + by_cos


def _third() -> tuple[Pair, ...]:
    """The pairs of joint 3: its root has the sign opposite to that of joint 2."""
    a2, b2, c2 = _terms(2)
    a3, b3, c3 = _terms(3)
    s, c = SECOND
    out: list[Pair] = []
    for top, bottom in (
        (2 * a2 * s + b2 * c, c),
        (-2 * c2 * c - b2 * s, s),
    ):  # the square root, as a quotient
        out += [
            (-b3 * bottom - top, 2 * a3 * bottom),
            (2 * c3 * bottom, top - b3 * bottom),
        ]
    return tuple(out)


def _line_symmetric(
    linkage: str,
    form: str,
    sign: int,
    source: str,
    lengths: tuple[str, ...] = LENGTHS,
    offsets: tuple[str, ...] = OFFSETS,
) -> ClosedForm:
    """``sign`` +1 where opposite joints turn alike, -1 where oppositely."""
    equations = original_equations if sign > 0 else revised_equations
    values = [
        tuple(
            constant(name) if name in (*lengths, *offsets) else sp.Integer(0)
            for name in names
        )
        for names in (LENGTHS, OFFSETS)
    ]
    u = [tangent(name) for name in TWISTS]
    found = equations(values[0], tuple(map(cosine, u)), tuple(map(sine, u)), values[1])
    constants = {
        f"{letter}_{number}": value
        for number, row in ((2, found[0]), (3, found[1]))
        for letter, value in zip(LETTERS, row, strict=True)
    }
    a, b, c = _terms(2)
    s, co = SECOND
    half: tuple[tuple[Pair, ...], ...] = ((FIRST,), (SECOND,), _third())
    other = (
        half
        if sign > 0
        else tuple(tuple(negative(pair) for pair in pairs) for pairs in half)
    )
    return ClosedForm(
        linkage,
        form,
        source,
        TWISTS,
        (*half, *other),
        constants,
        (*lengths, *offsets),
        relation=a * s**2 + b * s * co + c * co**2,
        second=2,
    )


def _reconfigurable(linkage: str, sign: int, equation: str) -> ClosedForm:
    """The Bennett form, ``sign`` +1 for the line-symmetric set-up: third sides of the
    triangles, links 34 and 61.

    The angles of that Bennett loop are theta1 + first, theta3 + third, where first and
    third are the angles of the spatial triangle at the joints 1 and 3.
    """
    u_a, u_b, u_g, u_k = (tangent(name) for name in ("alpha", "beta", "gamma", "kink"))
    s_a, c_a, s_b, c_b, s_k, c_k = (
        sine(u_a),
        cosine(u_a),
        sine(u_b),
        cosine(u_b),
        sine(u_k),
        cosine(u_k),
    )
    x_1, y_1, x_3, y_3, sin_d, u_d, m = map(
        constant, ("x_1", "y_1", "x_3", "y_3", "sin_delta", "u_delta", "m")
    )
    constants = {
        "k": u_k,
        "x_1": c_k * s_b * c_a + c_b * s_a,
        "y_1": s_k * s_b,
        "x_3": c_k * s_a * c_b + c_a * s_b,
        "y_3": s_k * s_a,
        "sin_delta": sp.sqrt(x_1**2 + y_1**2),
        "u_delta": sin_d / (1 + c_a * c_b - c_k * s_a * s_b),
        "m": (u_g + u_d) / (u_g - u_d),
    }
    first, third = (y_1, sin_d + x_1), (y_3, sin_d + x_3)
    turned = plus(FIRST, first)
    other = reciprocal(turned, m)
    opposite = (turned, other) if sign > 0 else (negative(turned), negative(other))
    kink = (constant("k"), sp.Integer(1))
    return ClosedForm(
        linkage,
        "Bennett 4R form",
        f"Song 2013, eq. {equation}",
        ("alpha", "beta", "kink", "gamma"),
        tuple(
            (pair,)
            for pair in (
                FIRST,
                kink,
                minus(other, third),
                minus(opposite[0], first),
                kink,
                minus(opposite[1], third),
            )
        ),
        constants,
    )


def _symmetric() -> ClosedForm:
    """Wohlhart's: odd joints at theta, even joints at phi."""
    c, s = constant("c"), constant("s")
    (s1, c1), (s2, c2) = FIRST, SECOND
    sin1, cos1, one1 = 2 * s1 * c1, c1**2 - s1**2, s1**2 + c1**2
    sin2, cos2, one2 = 2 * s2 * c2, c2**2 - s2**2, s2**2 + c2**2
    relation = (1 + c**2) * cos1 * cos2 + s**2 * (cos1 * one2 + cos2 * one1)
    relation = relation - 2 * c * sin1 * sin2 + c**2 * one1 * one2
    u = tangent("alpha")
    return ClosedForm(
        "wohlhart-symmetric",
        "threefold form",
        "Racila and Dahan 2010, eq. (15)",
        ("alpha",),
        ((FIRST,), (SECOND,)) * 3,
        {"c": cosine(u), "s": sine(u)},
        relation=sp.expand(relation),
        second=2,
    )


ORIGINAL = "Song 2013, eqs (4.2.14)-(4.2.24), H2 and L2 of (4.2.15) completed"
REVISED = "Song 2013, eqs (4.3.3)-(4.3.8), (4.3.8) being missing in the text"

FORMS: tuple[ClosedForm, ...] = (
    _line_symmetric("bricard-line-symmetric", "Forms I and II", +1, ORIGINAL),
    _line_symmetric(
        "bricard-line-symmetric-zero-offset", "Forms I and II", +1, ORIGINAL, offsets=()
    ),
    _line_symmetric(
        "bricard-line-symmetric-zero-offset",
        "Forms I' and II'",
        -1,
        REVISED,
        offsets=(),
    ),
    _line_symmetric(
        "bricard-octahedral-line-symmetric", "Forms I and II", +1, ORIGINAL, lengths=()
    ),
    _line_symmetric("bricard-line-symmetric-revised", "Forms I' and II'", -1, REVISED),
    _reconfigurable("reconfigurable-bricard-1", -1, "(5.3.13)"),
    _reconfigurable("reconfigurable-bricard-2", +1, "(5.3.15)"),
    _symmetric(),
)
