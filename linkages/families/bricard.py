"""The line-symmetric Bricard 6R linkages: general, with zero offsets, octahedral, and
revised.

Opposite links are alike. With opposite offsets alike too, Forms I and II ("original")
have theta_{i+3} = theta_i; with opposite offsets negative ("revised") the Forms I' and
II' have theta_{i+3} = -theta_i; with zero offsets there are all four.

The closure then leaves one bilinear equation between theta1 and theta2 and one between
theta1 and theta3: Song (2013), equations (4.2.14)-(4.2.24), with H2 and L2 of (4.2.15)
completed, and (4.3.3)-(4.3.8) for opposite angles, of which (4.3.8) is not in the text.
Each is a quadratic in tan(theta/2); Form I takes the plus root for theta2 and the minus
root for theta3, Form II the opposite: the discriminants of both are the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from linkages.closed_forms.closed_form import (
    ClosedForm,
    Pair,
    constant,
    cosine_of,
    joint,
    signed,
    sine_of,
    tangent,
)
from linkages.construction.conditions import decided
from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop
from linkages.values import GeometryError

POSITION = 160


def bricard_line_symmetric(
    a12: Number,
    a23: Number,
    a34: Number,
    alpha12: Number,
    alpha23: Number,
    alpha34: Number,
    R1: Number = 0,
    R2: Number = 0,
    R3: Number = 0,
) -> Loop:
    """The general line-symmetric Bricard linkage: links 12, 23, 34 and offsets of
    joints 1, 2, 3, twice over.

    Lengths not negative, twists in rad, any offsets. Raises `GeometryError` for a
    negative length. Sources: Song 2013, eqs (4.2.14)-(4.2.24), and section 4.4.3 without
    offsets; without lengths Bricard 1897; Song 2013, eq. (2.4.16), to which the
    equalities of the twists must be added: without them the loop is rigid.
    """
    for name, length in (("a12", a12), ("a23", a23), ("a34", a34)):
        size = decided(length)
        if size is not None and size < 0:
            raise GeometryError(f"length {name}", f"{size:.6g}", "0 or greater")
    return Loop((a12, a23, a34) * 2, (alpha12, alpha23, alpha34) * 2, (R1, R2, R3) * 2)


bricard_octahedral_line_symmetric = partial(bricard_line_symmetric, 0, 0, 0)


def revised_line_symmetric(
    a12: Number,
    a23: Number,
    a34: Number,
    alpha12: Number,
    alpha23: Number,
    alpha34: Number,
    R1: Number,
    R2: Number,
    R3: Number,
) -> Loop:
    """Revised general line-symmetric Bricard 6R: opposite links equal, opposite offsets
    negative.

    Lengths and offsets in one unit, twists in rad. Source: Mavroidis and Roth (1995);
    equation (2.4.19) in Song (2013).
    """
    half = (Link(a12, alpha12), Link(a23, alpha23), Link(a34, alpha34))
    return closed_chain(*half, *half, offsets=(R1, R2, R3, -R1, -R2, -R3))


# --- the equations of closure

Three = tuple[Number, Number, Number]
Coefficients = tuple[Number, ...]
# of sin1, cos1, sin, cos, sin1 sin, sin1 cos, cos1 sin, cos1 cos, 1
LETTERS = "ABCDEFGHL"


class Equations(NamedTuple):
    """Coefficients (A, ..., H, L) of the equations for theta2 and for theta3."""

    second: Coefficients
    third: Coefficients


def closure_equations(
    a: Three, c: Three, s: Three, R: Three, sign: int = 1
) -> Equations:
    """The equations where opposite joints turn alike (eqs 4.2.15, 4.2.22), or for
    ``sign`` -1 oppositely, with opposite offsets (eqs 4.3.6, 4.3.8; the latter is not in
    the text): those with the twist alpha34 turned round.

    ``a``, ``R`` are the three lengths and offsets, ``c``, ``s`` cosines and sines of
    the twists, of any number type.
    """
    (a12, a23, a34), (r1, r2, r3) = a, R
    c12, c23, c34 = c[0], c[1], sign * c[2]
    s12, s23, s34 = s[0], s[1], sign * s[2]
    second = (
        a34 * s12 * c23 + a12 * s34,
        -(r3 * s12 * c23 * s34 + r2 * s12 * s34),
        a23 * s12 * c34 + a12 * s23,
        -(r3 * s12 * s23 * c34 + r1 * s12 * s23),
        r3 * s23 * s34,
        a34 * c12 * s23 + a23 * s34,
        a23 * c12 * s34 + a34 * s23,
        -r3 * c12 * s23 * s34,
        r1 * (c12 * c23 + c34) + r2 * (c23 + c12 * c34) + r3 * (1 + c12 * c23 * c34),
    )
    third = (
        a12 * c23 * s34 + a34 * s12,
        -(r2 * s12 * c23 * s34 + r3 * s12 * s34),
        a23 * c12 * s34 + a34 * s23,
        -(r2 * c12 * s23 * s34 + r1 * s23 * s34),
        r2 * s12 * s23,
        a12 * s23 * c34 + a23 * s12,
        a23 * s12 * c34 + a12 * s23,
        -r2 * s12 * s23 * c34,
        r1 * (c12 + c23 * c34) + r2 * (1 + c12 * c23 * c34) + r3 * (c23 + c12 * c34),
    )
    return Equations(second, third)


# --- forms


def _value_and_slope(
    k: np.ndarray, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The equation with coefficients ``k`` in theta1 = ``x``, theta = ``y``; its
    derivative by ``y``."""
    s = np.sin(x)
    c = np.cos(x)
    free = k[0] * s + k[1] * c + k[8]
    by_sin = k[2] + k[4] * s + k[6] * c
    by_cos = k[3] + k[5] * s + k[7] * c
    sine = np.sin(y)
    cosine = np.cos(y)
    value = free + by_sin * sine + by_cos * cosine
    slope = by_sin * cosine - by_cos * sine
    return value, slope


def _scaled(coefficients: Coefficients) -> np.ndarray:
    k = np.array([float(value) for value in coefficients])
    return np.asarray(k / max(np.abs(k).max(), 1e-300))


def _residual(
    sign: int, root: int, equations: Equations
) -> Callable[[np.ndarray], np.ndarray]:
    """Residual of theta_{i+3} = sign theta_i, both equations, and their roots if
    ``root`` is +1 or -1.

    The derivative of the equation by theta2 is half the square root with its sign, so
    that its sign names the root, without poles and without regard to where the form is
    entered.
    """
    second = _scaled(equations.second)
    third = _scaled(equations.third)

    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        rows = []
        for i in range(3):
            gap = theta[..., i + 3] - sign * theta[..., i]
            rows.append(np.sin(gap / 2))
        for i, k, side in ((1, second, root), (2, third, -root)):
            value, slope = _value_and_slope(k, theta[..., 0], theta[..., i])
            rows.append(value)
            rows.append(np.maximum(0.0, -side * slope))
        return np.stack(rows, axis=-1)

    return residual


def patterns(
    a12: float,
    a23: float,
    a34: float,
    alpha12: float,
    alpha23: float,
    alpha34: float,
    R1: float = 0.0,
    R2: float = 0.0,
    R3: float = 0.0,
    revised: bool = False,
) -> tuple[FormPattern, ...]:
    """Forms I and II, and, where one closed curve holds both, "Forms I and II"; for
    the ``revised`` linkage I' and II', for zero offsets all of them.

    Lengths and offsets in one unit, twists in rad.
    """
    a = (a12, a23, a34)
    c = (math.cos(alpha12), math.cos(alpha23), math.cos(alpha34))
    s = (math.sin(alpha12), math.sin(alpha23), math.sin(alpha34))
    R = (R1, R2, R3)
    has_lengths = max(a) > 0
    has_offsets = max(abs(R1), abs(R2), abs(R3)) > 0
    out = []
    if not revised:
        equations = closure_equations(a, c, s, R)
        out += _three_patterns("original", "", +1, equations)
    if revised or (has_lengths and not has_offsets):
        equations = closure_equations(a, c, s, R, -1)
        out += _three_patterns("revised", "'", -1, equations)
    return tuple(out)


def _three_patterns(
    suffix: str, mark: str, sign: int, equations: Equations
) -> list[FormPattern]:
    roots = {
        f"Form I{mark}": +1,
        f"Form II{mark}": -1,
        f"Forms I{mark} and II{mark}": 0,
    }
    return [
        FormPattern(f"{name} ({suffix})", _residual(sign, root, equations))
        for name, root in roots.items()
    ]


# --- closed forms

LENGTH_NAMES = ("a12", "a23", "a34")
TWIST_NAMES = ("alpha12", "alpha23", "alpha34")
OFFSET_NAMES = ("R1", "R2", "R3")


class _Quadratic(NamedTuple):
    """Aterm, Bterm, Cterm of equations (4.2.18), (4.2.21): the quadratic in
    tan(theta/2) of joint 2 or 3."""

    a: Number
    b: Number
    c: Number


def _quadratic(number: int) -> _Quadratic:
    """The quadratic of joint ``number``."""
    a, b, c, d, e, f, g, h, free = (constant(f"{x}_{number}") for x in LETTERS)
    s1, c1 = joint(1)
    sine = 2 * s1 * c1
    cosine = c1**2 - s1**2
    one = s1**2 + c1**2
    rest = a * sine + b * cosine + free * one
    by_sin = c * one + e * sine + g * cosine
    by_cos = d * one + f * sine + h * cosine
    return _Quadratic(rest - by_cos, 2 * by_sin, rest + by_cos)


def _third_pairs() -> tuple[Pair, ...]:
    """The pairs of joint 3: its root has the sign opposite to that of joint 2."""
    second = _quadratic(2)
    third = _quadratic(3)
    s, c = joint(2)
    # the square root, as two quotients
    roots = (
        (2 * second.a * s + second.b * c, c),
        (-2 * second.c * c - second.b * s, s),
    )
    out: list[Pair] = []
    for top, bottom in roots:
        out.append((-third.b * bottom - top, 2 * third.a * bottom))
        out.append((2 * third.c * bottom, top - third.b * bottom))
    return tuple(out)


def _symbols(names: tuple[str, ...], parameters: tuple[str, ...]) -> Three:
    """The symbols of ``names``, or 0 for those that are none of the ``parameters``."""
    x, y, z = (constant(name) if name in parameters else 0 for name in names)
    return x, y, z


def _closed_form(
    linkage: str,
    sign: int,
    lengths: tuple[str, ...],
    offsets: tuple[str, ...],
) -> ClosedForm:
    """``sign`` +1 where opposite joints turn alike, -1 where oppositely."""
    u12, u23, u34 = (tangent(name) for name in TWIST_NAMES)
    rows = closure_equations(
        _symbols(LENGTH_NAMES, lengths),
        (cosine_of(u12), cosine_of(u23), cosine_of(u34)),
        (sine_of(u12), sine_of(u23), sine_of(u34)),
        _symbols(OFFSET_NAMES, offsets),
        sign,
    )
    constants = {}
    for number, row in ((2, rows.second), (3, rows.third)):
        for letter, value in zip(LETTERS, row, strict=True):
            constants[f"{letter}_{number}"] = value
    s, c = joint(2)
    quadratic = _quadratic(2)
    half: tuple[tuple[Pair, ...], ...] = ((joint(1),), (joint(2),), _third_pairs())
    other = tuple(tuple(signed(sign, pair) for pair in pairs) for pairs in half)
    return ClosedForm(
        linkage,
        "Forms I and II" if sign > 0 else "Forms I' and II'",
        ORIGINAL if sign > 0 else REVISED,
        TWIST_NAMES,
        (*half, *other),
        constants,
        (*lengths, *offsets),
        relation=quadratic.a * s**2 + quadratic.b * s * c + quadratic.c * c**2,
        second=2,
    )


ORIGINAL = "Song 2013, eqs (4.2.14)-(4.2.24), H2 and L2 of (4.2.15) completed"
REVISED = "Song 2013, eqs (4.3.3)-(4.3.8), (4.3.8) being missing in the text"


def _formulas(
    signs: tuple[int, ...],
    linkage: str,
    lengths: tuple[str, ...] = LENGTH_NAMES,
    offsets: tuple[str, ...] = OFFSET_NAMES,
) -> tuple[ClosedForm, ...]:
    return tuple(_closed_form(linkage, sign, lengths, offsets) for sign in signs)


ENTRIES = read_entries(
    "bricard",
    {
        "bricard-line-symmetric": Model(
            bricard_line_symmetric, patterns, partial(_formulas, (+1,))
        ),
        "bricard-line-symmetric-zero-offset": Model(
            bricard_line_symmetric,
            patterns,
            partial(_formulas, (+1, -1), offsets=()),
        ),
        "bricard-octahedral-line-symmetric": Model(
            bricard_octahedral_line_symmetric,
            partial(patterns, 0.0, 0.0, 0.0),
            partial(_formulas, (+1,), lengths=()),
        ),
        "bricard-line-symmetric-revised": Model(
            revised_line_symmetric,
            partial(patterns, revised=True),
            partial(_formulas, (-1,)),
        ),
    },
)
