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
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from linkages.closed_forms.form_table import form_tables
from linkages.construction.conditions import decided
from linkages.construction.equations import evaluate
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


# --- forms

# of sin1, cos1, sin, cos, sin1 sin, sin1 cos, cos1 sin, cos1 cos, 1
LETTERS = "ABCDEFGHL"
LINKS = ("12", "23", "34")


def closure_equation(
    number: int, values: Mapping[str, float], sign: int = 1
) -> np.ndarray:
    """The coefficients (9,) A, ..., H, L of the equation for the angle of joint 2 or 3
    where opposite joints turn alike, or for ``sign`` -1 oppositely.

    ``values`` are lengths, twists (rad) and offsets by their names; offsets that are not
    among them are 0.
    """
    names = {"R1": 0.0, "R2": 0.0, "R3": 0.0, **values}
    for link in LINKS:
        turn = sign if link == "34" else 1
        twist = values[f"alpha{link}"]
        names |= {
            f"c{link}": turn * math.cos(twist),
            f"s{link}": turn * math.sin(twist),
        }
    constants = form_tables("bricard")["bricard-line-symmetric"][0]["constants"]
    formulas = [constants[f"{letter}_{number}"] for letter in LETTERS]
    return np.array([evaluate(formula, names) for formula in formulas])


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


def _residual(
    sign: int, root: int, values: Mapping[str, float]
) -> Callable[[np.ndarray], np.ndarray]:
    """Residual of theta_{i+3} = sign theta_i, both equations, and their roots if
    ``root`` is +1 or -1.

    The derivative of the equation by theta2 is half the square root with its sign, so
    that its sign names the root, without poles and without regard to where the form is
    entered.
    """
    second, third = (closure_equation(number, values, sign) for number in (2, 3))
    second = second / max(np.abs(second).max(), 1e-300)
    third = third / max(np.abs(third).max(), 1e-300)

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


def patterns(revised: bool = False, /, **values: float) -> tuple[FormPattern, ...]:
    """Forms I and II, and, where one closed curve holds both, "Forms I and II"; for
    the ``revised`` linkage I' and II', for zero offsets all of them.

    ``values`` are the parameters of `bricard_line_symmetric`.
    """
    has_lengths = max(values[f"a{link}"] for link in LINKS) > 0
    has_offsets = any(values.get(f"R{joint}", 0.0) for joint in (1, 2, 3))
    out = []
    if not revised:
        out += _three_patterns("original", "", +1, values)
    if revised or (has_lengths and not has_offsets):
        out += _three_patterns("revised", "'", -1, values)
    return tuple(out)


def _three_patterns(
    suffix: str, mark: str, sign: int, values: Mapping[str, float]
) -> list[FormPattern]:
    roots = {
        f"Form I{mark}": +1,
        f"Form II{mark}": -1,
        f"Forms I{mark} and II{mark}": 0,
    }
    return [
        FormPattern(f"{name} ({suffix})", _residual(sign, root, values))
        for name, root in roots.items()
    ]


NO_LENGTHS = {"a12": 0.0, "a23": 0.0, "a34": 0.0}

ENTRIES = read_entries(
    "bricard",
    {
        "bricard-line-symmetric": Model(bricard_line_symmetric, patterns),
        "bricard-line-symmetric-zero-offset": Model(bricard_line_symmetric, patterns),
        "bricard-octahedral-line-symmetric": Model(
            bricard_octahedral_line_symmetric, partial(patterns, False, **NO_LENGTHS)
        ),
        "bricard-line-symmetric-revised": Model(
            revised_line_symmetric, partial(patterns, True)
        ),
    },
)
