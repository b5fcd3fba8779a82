"""Misprints in the closed forms of the line-symmetric Bricard linkages and in the
appendix on their bifurcations."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from linkages.catalogue import entry
from linkages.closed_forms.closed_form import (
    ClosedForm,
    constant,
    cosine_of,
    sine_of,
    tangent,
)
from linkages.construction.link import Link
from linkages.construction.numbers import Number
from linkages.construction.spatial_triangle import CompositeLink, composite_link
from linkages.errata.erratum import Amounts, Erratum
from linkages.errata.forms import Change, compare_closed_forms, with_constants
from linkages.families.bricard import LETTERS, Three, original_equations


class _Symbols(NamedTuple):
    """Lengths, cosines, sines and offsets of a closed form of the line-symmetric
    linkages, three each."""

    lengths: Three
    cosines: Three
    sines: Three
    offsets: Three


def _symbols() -> _Symbols:
    u12 = tangent("alpha12")
    u23 = tangent("alpha23")
    u34 = tangent("alpha34")
    return _Symbols(
        (constant("a12"), constant("a23"), constant("a34")),
        (cosine_of(u12), cosine_of(u23), cosine_of(u34)),
        (sine_of(u12), sine_of(u23), sine_of(u34)),
        (constant("R1"), constant("R2"), constant("R3")),
    )


def _merged(form: ClosedForm) -> ClosedForm:
    """(4.2.15) as it stands: H2 runs into L2, which is lost."""
    symbols = _symbols()
    c12, c23, c34 = symbols.cosines
    _, s23, _ = symbols.sines
    _, r2, r3 = symbols.offsets
    first = -r3 * c12 * s23 + c34
    second = r2 * (c23 + c12 * c34)
    third = r3 * (1 + c12 * c23 * c34)
    return with_constants(form, H_2=first + second + third, L_2=0)


def _other_length(form: ClosedForm) -> ClosedForm:
    """(C6) with a34 for a23 in G2."""
    symbols = _symbols()
    _, _, a34 = symbols.lengths
    c12, _, _ = symbols.cosines
    _, s23, s34 = symbols.sines
    return with_constants(form, G_2=a34 * c12 * s34 + a34 * s23)


def _no_such_length(form: ClosedForm) -> ClosedForm:
    """(4.3.6) with the difference in H2', a33 being read as a34."""
    symbols = _symbols()
    _, _, a34 = symbols.lengths
    c12, _, _ = symbols.cosines
    _, s23, s34 = symbols.sines
    _, _, r3 = symbols.offsets
    return with_constants(form, H_2=r3 * c12 * s23 - a34 * s34)


def _unprimed(form: ClosedForm) -> ClosedForm:
    """The coefficients (4.2.22) in the place of the missing (4.3.8)."""
    third = original_equations(*_symbols()).third
    constants: dict[str, Number] = {}
    for letter, value in zip(LETTERS, third, strict=True):
        constants[f"{letter}_3"] = value
    return with_constants(form, **constants)


# --- Appendix C, on the first reconfigurable linkage

FIRST = "reconfigurable-bricard-1"


def _triangle() -> CompositeLink:
    """The spatial triangle on its links 12 and 23."""
    values = entry(FIRST).defaults
    a = Link(values["a"], values["alpha"])
    b = Link(values["b"], values["beta"])
    return composite_link(a, b, values["kink"], values["r2"])


def _kink() -> float:
    """The angle theta2' of the Bennett form, rad."""
    return entry(FIRST).defaults["kink"]


def _coefficients() -> dict[str, float]:
    """The coefficients (C6), by their letters."""
    lengths, twists, offsets = (row[:3] for row in entry(FIRST).build().arrays)
    c12, c23, c34 = np.cos(twists)
    s12, s23, s34 = np.sin(twists)
    a12, a23, a34 = lengths
    r1, r2, r3 = offsets
    second = original_equations(
        (a12, a23, a34), (c12, c23, c34), (s12, s23, s34), (r1, r2, r3)
    ).second
    out = {}
    for letter, value in zip(LETTERS, second, strict=True):
        out[letter] = float(value)
    return out


def _left(t: float, first: int, third: int) -> float:
    """What (C7) leaves at the two bifurcations with tan(theta2/2) = ``t``; ``first``
    and ``third`` are the signs of the terms in (C8)."""
    k = _coefficients()

    def term(x: str, y: str, z: str) -> float:
        one = k[x] + first * k[y]
        other = k[x] + third * k[y]
        return one * t * t + 2 * k[z] * t + other

    by_sine = term("A", "F", "E")
    by_cosine = term("B", "H", "G")
    free = term("L", "D", "C")
    theta_1 = -float(_triangle().before.angle)
    gaps = []
    for x in (theta_1, theta_1 + np.pi):
        gaps.append(abs(by_sine * np.sin(x) + by_cosine * np.cos(x) + free))
    return float(max(gaps))


def _equal_angles() -> Amounts:
    """Equation (C3): theta2 of the bifurcations by tan(theta2/2) = tan(theta2'), or
    theta2 = theta2'."""
    kink = _kink()
    return Amounts(_left(np.tan(kink), -1, 1), _left(np.tan(kink / 2), -1, 1))


def _third_terms() -> Amounts:
    """Equation (C8): differences, or sums, in the third terms."""
    t = np.tan(_kink() / 2)
    return Amounts(_left(t, -1, -1), _left(t, -1, 1))


def _asymmetric_ratio() -> Amounts:
    """Equation (5.3.18): sin(alpha34)/a34 beside the fraction, by the angle theta1' of
    the triangle."""
    lengths, twists, offsets = entry(FIRST).build().arrays
    x = np.pi - float(_triangle().before.angle)
    sin_x = np.sin(x)
    cos_x = np.cos(x)
    sin_k = np.sin(_kink())
    cos_k = np.cos(_kink())
    c12, c23 = np.cos(twists[:2])
    s12, s23 = np.sin(twists[:2])
    top = s23 * sin_k * sin_x - c23 * s12 * cos_x - c12 * cos_k * s23 * cos_x
    bottom = (
        lengths[1] * (c12 * sin_x * sin_k - cos_x * cos_k)
        - lengths[0] * cos_x
        - offsets[1] * s12 * sin_x
    )
    fraction = top / bottom
    ratio = np.sin(twists[2]) / lengths[2]
    return Amounts(float(abs(-ratio - fraction)), float(abs(ratio - fraction)))


SONG = "Song 2013"
LINE = "bricard-line-symmetric"
REVISED = "bricard-line-symmetric-revised"


def _form_erratum(
    equation: str, linkage: str, printed: str, corrected: str, change: Change
) -> Erratum:
    measure = partial(compare_closed_forms, linkage, 0, change)
    return Erratum(SONG, equation, linkage, printed, corrected, measure)


SYMMETRIC_ERRATA: tuple[Erratum, ...] = (
    _form_erratum(
        "(4.2.13), (4.2.15), (C6)",
        LINE,
        "the end of H2 and the beginning of L2 are lost in the copy",
        "H2 = -R3 c12 s23 s34, L2 = R1 (c12 c23 + c34) + R2 (c23 + c12 c34) "
        "+ R3 (1 + c12 c23 c34)",
        _merged,
    ),
    _form_erratum(
        "(4.3.6)",
        REVISED,
        "H2' = R3 cos(alpha12) sin(alpha23) - a33 sin(alpha34); the amount is for a34",
        "H2' = R3 cos(alpha12) sin(alpha23) sin(alpha34)",
        _no_such_length,
    ),
    _form_erratum(
        "(4.3.8)",
        REVISED,
        "lost in the copy; the amount is that of (4.2.22) in its place",
        "A3' = -(a12 c23 s34 - a34 s12), ..., as in the closed form of the linkage",
        _unprimed,
    ),
    _form_erratum(
        "(C6)",
        LINE,
        "G2 = a34 cos(alpha12) sin(alpha34) + a34 sin(alpha23)",
        "G2 = a23 cos(alpha12) sin(alpha34) + a34 sin(alpha23)",
        _other_length,
    ),
    Erratum(
        SONG,
        "(C3), (C4), (C8)",
        FIRST,
        "tan(theta2') = tan(theta2/2)",
        "theta2' = theta2",
        _equal_angles,
    ),
    Erratum(
        SONG,
        "(C8)",
        FIRST,
        "third terms A2 - F2, B2 - H2, L2 - D2",
        "A2 + F2, B2 + H2, L2 + D2",
        _third_terms,
    ),
    Erratum(
        SONG,
        "(5.3.18)",
        FIRST,
        "-sin(alpha34)/a34 = ...",
        "sin(alpha34)/a34 = ...",
        _asymmetric_ratio,
    ),
)
