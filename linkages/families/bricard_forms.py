"""The forms of the line-symmetric Bricard linkage, told apart by the roots of their
closed forms.

With theta_{i+3} = theta_i the closure leaves one bilinear equation between theta1 and
theta2 and one between theta1 and theta3 (Song 2013, eqs 4.2.14-4.2.22; with theta_{i+3}
= -theta_i and zero offsets, eqs
4.3.5-4.3.8). Each is a quadratic in tan(theta/2); Form I takes the plus root for theta2 and the minus root
for theta3, Form II the opposite. The derivative of the equation by theta2 is half the
square root with its sign, so that its sign names the root, without poles and without
regard to where the form is entered.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

import numpy as np

from linkages.entry import FormPattern

__all__ = ["original_equations", "patterns", "revised_equations"]

Values = tuple[Any, ...]
Coefficients = tuple[
    float, ...
]  # of sin1, cos1, sin, cos, sin1 sin, sin1 cos, cos1 sin, cos1 cos, 1


def original_equations(
    a: Values, c: Values, s: Values, R: Values
) -> tuple[Values, Values]:
    """Coefficients (A, ..., H, L) of the equations for theta2 and theta3 (eqs 4.2.15,
    4.2.22).

    ``a``, ``R`` are the three lengths and offsets, ``c``, ``s`` cosines and sines of
    the twists, of any number type.
    """
    (a12, a23, a34), (r1, r2, r3) = a, R
    (c12, c23, c34), (s12, s23, s34) = c, s
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
    return second, third


def revised_equations(
    a: Values, c: Values, s: Values, R: Values
) -> tuple[Values, Values]:
    """The same for opposite offsets and theta_{i+3} = -theta_i (eqs 4.3.6, 4.3.8; the
    latter is not in the text)."""
    (a12, a23, a34), (r1, r2, r3) = a, R
    (c12, c23, c34), (s12, s23, s34) = c, s
    second = (
        a34 * s12 * c23 - a12 * s34,
        r3 * s12 * c23 * s34 + r2 * s12 * s34,
        -(a23 * s12 * c34 - a12 * s23),
        r3 * s12 * s23 * c34 - r1 * s12 * s23,
        -r3 * s23 * s34,
        a34 * c12 * s23 - a23 * s34,
        -(a23 * c12 * s34 - a34 * s23),
        r3 * c12 * s23 * s34,
        r1 * (c12 * c23 - c34) + r2 * (c23 - c12 * c34) + r3 * (1 - c12 * c23 * c34),
    )
    third = (
        -(a12 * c23 * s34 - a34 * s12),
        r2 * s12 * c23 * s34 + r3 * s12 * s34,
        -(a23 * c12 * s34 - a34 * s23),
        r2 * c12 * s23 * s34 + r1 * s23 * s34,
        r2 * s12 * s23,
        -(a12 * s23 * c34 - a23 * s12),
        -(a23 * s12 * c34 - a12 * s23),
        r2 * s12 * s23 * c34,
        r1 * (c12 - c23 * c34) + r2 * (1 - c12 * c23 * c34) + r3 * (c23 - c12 * c34),
    )
    return second, third


def _value_and_slope(
    k: Coefficients, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The equation with coefficients ``k`` in theta1 = ``x``, theta = ``y``; its
    derivative by ``y``."""
    s, c = np.sin(x), np.cos(x)
    free = k[0] * s + k[1] * c + k[8]
    by_sin, by_cos = k[2] + k[4] * s + k[6] * c, k[3] + k[5] * s + k[7] * c
    return free + by_sin * np.sin(y) + by_cos * np.cos(y), by_sin * np.cos(
        y
    ) - by_cos * np.sin(y)


def _form(
    sign: int, root: int, equations: tuple[Coefficients, Coefficients]
) -> Callable[[np.ndarray], np.ndarray]:
    """Residual of theta_{i+3} = sign theta_i, both equations, and their roots if
    ``root`` is +1 or -1."""
    scaled = [np.array(k) / max(np.abs(k).max(), 1e-300) for k in equations]

    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        rows = [
            np.sin((theta[..., i + 3] - sign * theta[..., i]) / 2) for i in range(3)
        ]
        for joint, k, side in ((1, scaled[0], root), (2, scaled[1], -root)):
            value, slope = _value_and_slope(tuple(k), theta[..., 0], theta[..., joint])
            rows += [value, np.maximum(0.0, -side * slope)]
        return np.stack(rows, axis=-1)

    return residual


def _three(
    suffix: str, mark: str, sign: int, equations: tuple[Coefficients, Coefficients]
) -> list[FormPattern]:
    return [
        FormPattern(f"Form I{mark} ({suffix})", _form(sign, +1, equations)),
        FormPattern(f"Form II{mark} ({suffix})", _form(sign, -1, equations)),
        FormPattern(
            f"Forms I{mark} and II{mark} ({suffix})", _form(sign, 0, equations)
        ),
    ]


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
) -> tuple[FormPattern, ...]:
    """Forms I and II, and, where one closed curve holds both, "Forms I and II"; I' and
    II' for zero offsets.

    Lengths and offsets in one unit, twists in rad.
    """
    a, alpha, offsets = (a12, a23, a34), (alpha12, alpha23, alpha34), (R1, R2, R3)
    cosines, sines = tuple(map(cos, alpha)), tuple(map(sin, alpha))
    found = _three("original", "", +1, original_equations(a, cosines, sines, offsets))
    if max(abs(R1), abs(R2), abs(R3)) == 0 and max(a) > 0:
        found += _three(
            "revised", "'", -1, revised_equations(a, cosines, sines, offsets)
        )
    return tuple(found)
