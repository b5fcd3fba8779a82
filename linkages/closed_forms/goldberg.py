"""Closed forms of the Bennett linkages and of the Goldberg 5R linkages.

Set-ups of Bennett's linkage: Song (2013), equations (2.2.3), (2.2.4), (2.2.14).
Goldberg 5R: equation (3.2.2), equation (2.2) of Song and Chen (2012). Subtractive
Goldberg 5R: equations (3.2.4) and (2.4), where the factor of tan(theta3/2) is printed
inverted.
"""

from __future__ import annotations

from typing import Any

from linkages.closed_forms.closed_form import (
    HALF_TURN,
    ClosedForm,
    Pair,
    constant,
    joint,
    minus,
    negative,
    plus,
    ratio,
    reciprocal,
    tangent,
)

__all__ = ["FORMS"]

INPUT = joint(1)
SONG = "Song 2013, eq. "


def _bennett(linkage: str, opposite: int, product: Any, equations: str) -> ClosedForm:
    """``opposite`` +1 where opposite joints turn alike, -1 where oppositely;
    ``product`` is t1 t2."""
    second = reciprocal(INPUT, constant("m"))
    turned = (lambda pair: pair) if opposite > 0 else negative
    return ClosedForm(
        linkage,
        "Bennett form",
        SONG + equations,
        ("alpha", "beta"),
        ((INPUT,), (second,), (turned(INPUT),), (turned(second),)),
        {"m": product},
    )


def _goldberg(
    linkage: str,
    sign: int,
    alpha: Any,
    beta: Any,
    gamma: Any,
    angles: Any,
    constants: Any,
) -> ClosedForm:
    """Links b, a + sign c, b, c, a of the half tangents alpha, beta, gamma."""
    second = reciprocal(INPUT, constant("m_a"))
    third: Pair = (
        (constant("m_c") * INPUT[0], INPUT[1])
        if sign > 0
        else (INPUT[0], constant("m_c") * INPUT[1])
    )
    rest = HALF_TURN if sign > 0 else (0, 1)
    fourth, fifth = minus(rest, INPUT), minus(rest, plus(second, third))
    factors = {
        "m_a": (alpha + beta) / (alpha - beta),
        "m_c": (gamma + beta) / (gamma - beta),
    }
    source = "(3.2.2)" if sign > 0 else "(3.2.4), the factor of tan(theta3/2) inverted"
    return ClosedForm(
        linkage,
        "Goldberg form" if sign > 0 else "subtractive Goldberg form",
        SONG + source,
        angles,
        ((INPUT,), (second,), (third,), (fourth,), (fifth,)),
        {**constants, **factors},
    )


A, B, G = tangent("alpha"), tangent("beta"), tangent("gamma")
ABC = ("alpha", "beta", "gamma")
P = constant("p")
SYNCOPATED = {
    "p": ratio("alpha", "beta") * ratio("gamma", "beta"),
    "u_delta": (P + 1) / (P - 1) * (A + G) / (1 - A * G),
    "u_side": (constant("u_delta") - B) / (1 + constant("u_delta") * B),
}

FORMS: tuple[ClosedForm, ...] = (
    _bennett("bennett", -1, (B + A) / (B - A), "(2.2.3), (2.2.4)"),
    _bennett("bennett-ab-2", -1, (1 + A * B) / (1 - A * B), "(2.2.4) with (2.2.18)"),
    _bennett("bennett-line-symmetric", +1, (1 + A * B) / (1 - A * B), "(2.2.14)"),
    _bennett("bennett-lb-2", +1, (B + A) / (B - A), "(2.2.14) with (2.2.17)"),
    _goldberg("goldberg-5r", +1, A, B, G, ABC, {}),
    _goldberg("subtractive-goldberg-5r", -1, A, B, G, ABC, {}),
    _goldberg("syncopated-goldberg-5r", +1, A, constant("u_side"), G, ABC, SYNCOPATED),
    _goldberg("myard-asymmetric-5r", +1, A, B, A, ("alpha", "beta"), {}),
)
