"""Misprints in the closed forms of the line-symmetric Bricard linkages and in the
appendix on their bifurcations."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.bricard import (
    LENGTHS,
    LETTERS,
    OFFSETS,
    TWISTS,
    cosine,
    sine,
)
from linkages.closed_forms.closed_form import ClosedForm, constant, tangent
from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link
from linkages.errata.forms import compare_closed_forms, with_constant
from linkages.families.bricard_forms import original_equations

__all__ = ["SYMMETRIC_ROWS"]

Row = tuple[str, str, str, str, str, Callable[[], tuple[float, float]]]


def _symbols() -> tuple[
    tuple[Any, ...], tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]
]:
    """Lengths, cosines, sines and offsets of a closed form of the line-symmetric
    linkages."""
    u = [tangent(name) for name in TWISTS]
    lengths, offsets = tuple(map(constant, LENGTHS)), tuple(map(constant, OFFSETS))
    return lengths, tuple(map(cosine, u)), tuple(map(sine, u)), offsets


def _merged(form: ClosedForm) -> ClosedForm:
    """(4.2.15) as it stands: H2 runs into L2, which is lost."""
    _, (c12, c23, c34), (_, s23, _), (_, r2, r3) = _symbols()
    merged = -r3 * c12 * s23 + c34 + r2 * (c23 + c12 * c34) + r3 * (1 + c12 * c23 * c34)
    return with_constant(form, H_2=merged, L_2=0)


def _other_length(form: ClosedForm) -> ClosedForm:
    """(C6) with a34 for a23 in G2."""
    (_, _, a34), (c12, _, _), (_, s23, s34), _ = _symbols()
    return with_constant(form, G_2=a34 * c12 * s34 + a34 * s23)


def _no_such_length(form: ClosedForm) -> ClosedForm:
    """(4.3.6) with the difference in H2', a33 being read as a34."""
    (_, _, a34), (c12, _, _), (_, s23, s34), (_, _, r3) = _symbols()
    return with_constant(form, H_2=r3 * c12 * s23 - a34 * s34)


def _unprimed(form: ClosedForm) -> ClosedForm:
    """The coefficients (4.2.22) in the place of the missing (4.3.8)."""
    third = original_equations(*_symbols())[1]
    return with_constant(
        form,
        **{f"{letter}_3": value for letter, value in zip(LETTERS, third, strict=True)},
    )


# --- Appendix C


def _bifurcations() -> tuple[dict[str, float], float, list[float]]:
    """Coefficients (C6), the kink theta2', and theta1 of both bifurcations of the first
    reconfigurable linkage."""
    found = entry("reconfigurable-bricard-1")
    values, loop = found.defaults, found.build()
    triangle = composite_link(
        Link(values["a"], values["alpha"]),
        Link(values["b"], values["beta"]),
        values["kink"],
        values["r2"],
    )
    a, alpha, offsets = (v[:3] for v in loop.arrays)
    second = original_equations(
        tuple(a), tuple(np.cos(alpha)), tuple(np.sin(alpha)), tuple(offsets)
    )[0]
    theta_1 = -float(triangle.before[1])
    return (
        dict(zip(LETTERS, map(float, second), strict=True)),
        values["kink"],
        [theta_1, theta_1 + np.pi],
    )


def _left(t: float, first: int, third: int) -> float:
    """What (C7) leaves at the bifurcations with tan(theta2/2) = ``t``; signs of the
    terms in (C8)."""
    k, _, inputs = _bifurcations()
    pairs = [("A", "F", "E"), ("B", "H", "G"), ("L", "D", "C")]
    abc = [
        (k[x] + first * k[y]) * t * t + 2 * k[z] * t + k[x] + third * k[y]
        for x, y, z in pairs
    ]
    return max(
        float(abs(abc[0] * np.sin(x) + abc[1] * np.cos(x) + abc[2])) for x in inputs
    )


def _equal_angles() -> tuple[float, float]:
    """Equation (C3): theta2 of the bifurcations by tan(theta2/2) = tan(theta2'), or
    theta2 = theta2'."""
    _, kink, _ = _bifurcations()
    return _left(np.tan(kink), -1, 1), _left(np.tan(kink / 2), -1, 1)


def _third_terms() -> tuple[float, float]:
    _, kink, _ = _bifurcations()
    return _left(np.tan(kink / 2), -1, -1), _left(np.tan(kink / 2), -1, 1)


def _asymmetric_ratio() -> tuple[float, float]:
    """Equation (5.3.18): sin(alpha34)/a34 beside the fraction, by the angle theta1' of
    the triangle."""
    found = entry("reconfigurable-bricard-1")
    v, (a, alpha, offsets) = found.defaults, found.build().arrays
    made = composite_link(
        Link(v["a"], v["alpha"]), Link(v["b"], v["beta"]), v["kink"], v["r2"]
    )
    x, kink = np.pi - made.before[1], v["kink"]
    (c12, c23), (s12, s23) = np.cos(alpha[:2]), np.sin(alpha[:2])
    top = (
        s23 * np.sin(kink) * np.sin(x)
        - c23 * s12 * np.cos(x)
        - c12 * np.cos(kink) * s23 * np.cos(x)
    )
    bottom = a[1] * (c12 * np.sin(x) * np.sin(kink) - np.cos(x) * np.cos(kink))
    bottom = bottom - a[0] * np.cos(x) - offsets[1] * s12 * np.sin(x)
    ratio = np.sin(alpha[2]) / a[2]
    return float(abs(-ratio - top / bottom)), float(abs(ratio - top / bottom))


SONG, LINE, FIRST = "Song 2013", "bricard-line-symmetric", "reconfigurable-bricard-1"
REVISED = "bricard-line-symmetric-revised"
SYMMETRIC_ROWS: tuple[Row, ...] = (
    (
        SONG,
        "(4.2.13), (4.2.15), (C6)",
        LINE,
        "the end of H2 and the beginning of L2 are lost in the copy",
        "H2 = -R3 c12 s23 s34, L2 = R1 (c12 c23 + c34) + R2 (c23 + c12 c34) + R3 (1 + c12 c23 c34)",
        partial(compare_closed_forms, LINE, 0, _merged),
    ),
    (
        SONG,
        "(4.3.6)",
        REVISED,
        "H2' = R3 cos(alpha12) sin(alpha23) - a33 sin(alpha34); the amount is for a34",
        "H2' = R3 cos(alpha12) sin(alpha23) sin(alpha34)",
        partial(compare_closed_forms, REVISED, 0, _no_such_length),
    ),
    (
        SONG,
        "(4.3.8)",
        REVISED,
        "lost in the copy; the amount is that of (4.2.22) in its place",
        "A3' = -(a12 c23 s34 - a34 s12), ..., as in the closed form of the linkage",
        partial(compare_closed_forms, REVISED, 0, _unprimed),
    ),
    (
        SONG,
        "(C6)",
        LINE,
        "G2 = a34 cos(alpha12) sin(alpha34) + a34 sin(alpha23)",
        "G2 = a23 cos(alpha12) sin(alpha34) + a34 sin(alpha23)",
        partial(compare_closed_forms, LINE, 0, _other_length),
    ),
    (
        SONG,
        "(C3), (C4), (C8)",
        FIRST,
        "tan(theta2') = tan(theta2/2)",
        "theta2' = theta2",
        _equal_angles,
    ),
    (
        SONG,
        "(C8)",
        FIRST,
        "third terms A2 - F2, B2 - H2, L2 - D2",
        "A2 + F2, B2 + H2, L2 + D2",
        _third_terms,
    ),
    (
        SONG,
        "(5.3.18)",
        FIRST,
        "-sin(alpha34)/a34 = ...",
        "sin(alpha34)/a34 = ...",
        _asymmetric_ratio,
    ),
)
