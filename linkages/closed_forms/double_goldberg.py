"""Closed forms of the double-Goldberg 6R linkages: all four forms, the non-constructive
ones included.

Forms I and II: Song (2013), equations (5.2.2)-(5.2.8); Song and Chen (2012), equations
(5.2)-(5.5). Both roots of the quadratic are configurations for every input, whatever
the printed switching says. Written for t1 and t4, the quadratic is symmetric; the
double-subtractive linkage has -gamma for gamma.

Forms III and IV are known in the sources as numerical paths. Here: theta6 = theta3, and
with the half-angle tangents a, b, g, d of the basic links, v = a + g, w = a g (g
negative for the double-subtractive linkage), N_x = v (1 + w x^2) + x (1 - w)^2 and D_x
= v (1 + w x^2) - x (1 - w)^2,

    d (D_b t4 + N_b / t4) = b (D_d t1 + N_d / t1),   t1 t2 = -N_d / D_d,   t4 t5 = -N_b / D_b,
    t3 = (b D_d t1 - d D_b t4) / E,   E = v (d - b) (1 + w b d).

Eliminating t4 gives E t3^2 + b (N_d / t1 - D_d t1) t3 + v (d + b) (1 - w b d) = 0.
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
    reciprocal,
    tangent,
)

__all__ = ["FORMS"]

FIRST, THIRD, FOURTH = joint(1), joint(3), joint(4)
A, B, G, D = (tangent(name) for name in ("alpha", "beta", "gamma", "delta"))
TWISTS = ("alpha", "beta", "gamma", "delta")
THESIS = "Song 2013, eqs "


def _ratio_with(x: Any, y: Any) -> Any:
    return (x + y) / (x - y)


def _constants(sign: int, special: bool, b: Any, d: Any) -> dict[str, Any]:
    """m_xy of the links b, d with a and c, gamma being negative in the
    double-subtractive linkage."""
    g = constant("g")
    ratios = {"m_da": (d, A), "m_dc": (d, g), "m_ba": (b, A), "m_bc": (b, g)}
    gamma = {"g": sign * (B * D / A if special else G)}
    return {**gamma, **{name: _ratio_with(x, y) for name, (x, y) in ratios.items()}}


def _constructive(
    linkage: str, sign: int, special: bool = False, exchanged: bool = False
) -> ClosedForm:
    """Forms I and II; ``exchanged`` where links b and d have changed places."""
    b, d = (D, B) if exchanged else (B, D)
    m_da, m_dc, m_ba, m_bc = (
        constant(name) for name in ("m_da", "m_dc", "m_ba", "m_bc")
    )
    (s1, c1), (s4, c4) = FIRST, FOURTH
    k_d, k_b = m_da * m_dc, m_ba * m_bc
    relation = (k_d - 1) * (s4**2 + k_b * c4**2) * s1 * c1 - (1 - k_b) * (
        s1**2 + k_d * c1**2
    ) * s4 * c4
    third = minus(plus(reciprocal(FIRST, m_da), (s4, m_bc * c4)), HALF_TURN)
    return ClosedForm(
        linkage,
        "Forms I and II",
        THESIS + ("(5.2.2)-(5.2.5)" if sign > 0 else "(5.2.6)-(5.2.8)"),
        ("alpha", "beta", "delta") if special else TWISTS,
        (
            (FIRST,),
            (reciprocal(FIRST, k_d),),
            (third,),
            (FOURTH,),
            (reciprocal(FOURTH, k_b),),
            (negative(third),),
        ),
        _constants(sign, special, b, d),
        relation=relation,
        second=4,
    )


def _non_constructive(
    linkage: str, sign: int, special: bool = False, exchanged: bool = False
) -> ClosedForm:
    """Forms III and IV, by t1 and t3: for nearly equal links b and d the difference of
    t1 and t4 loses digits."""
    b, d = (D, B) if exchanged else (B, D)
    g, v, w = constant("g"), constant("v"), constant("w")
    n_b, d_b, n_d, d_d, e, f = (
        constant(name) for name in ("N_b", "D_b", "N_d", "D_d", "E", "F")
    )
    (s1, c1), (s3, c3), (b_, d_) = FIRST, THIRD, (constant("b"), constant("d"))
    relation = (
        e * s1 * c1 * s3**2
        + b_ * (n_d * c1**2 - d_d * s1**2) * s3 * c3
        + f * s1 * c1 * c3**2
    )
    fourth = (
        (b_ * d_d * s1 * c3 - e * s3 * c1, d_ * d_b * c1 * c3),
        (d_ * n_b * s1 * c3, e * s1 * s3 + b_ * n_d * c1 * c3),
    )
    constants: dict[str, Any] = {
        "b": b,
        "d": d,
        "g": sign * (B * D / A if special else G),
        "v": A + g,
        "w": A * g,
    }
    for name, x in (("b", b_), ("d", d_)):
        constants[f"N_{name}"] = v * (1 + w * x**2) + x * (1 - w) ** 2
        constants[f"D_{name}"] = v * (1 + w * x**2) - x * (1 - w) ** 2
    constants["E"] = v * (d_ - b_) * (1 + w * b_ * d_)
    constants["F"] = v * (d_ + b_) * (1 - w * b_ * d_)
    fifth = tuple((-n_b * c, d_b * s) for s, c in fourth)
    return ClosedForm(
        linkage,
        "Forms III and IV",
        "not in the sources, which follow these forms numerically",
        ("alpha", "beta", "delta") if special else TWISTS,
        ((FIRST,), ((-n_d * c1, d_d * s1),), (THIRD,), fourth, fifth, (THIRD,)),
        constants,
        relation=relation,
        second=3,
    )


def _special(
    sign: int, form: str, fourth: Pair, fifth: Pair, bennett: bool
) -> ClosedForm:
    """Forms I and II under tan(alpha/2) tan(gamma/2) = tan(beta/2) tan(delta/2), where
    each is rational."""
    m_da, m_dc, m_bc = constant("m_da"), constant("m_dc"), constant("m_bc")
    third = minus(
        plus(reciprocal(FIRST, m_da), (fourth[0], m_bc * fourth[1])), HALF_TURN
    )
    if bennett:
        third = (0, 1) if sign > 0 else HALF_TURN
    name = f"special-{'wohlhart-double' if sign > 0 else 'double-subtractive'}-goldberg"
    source = "Song and Chen 2012, eqs (5.12), (5.13), m1/m2 of Form II being m2/tan(theta1/2)"
    return ClosedForm(
        name,
        form,
        source if sign > 0 else THESIS + "(5.2.6)-(5.2.8) with (5.2.17), m2 being m6",
        ("alpha", "beta", "delta"),
        (
            (FIRST,),
            (reciprocal(FIRST, m_da * m_dc),),
            (third,),
            (fourth,),
            (fifth,),
            (negative(third),),
        ),
        _constants(sign, True, B, D),
    )


_S1, _C1 = FIRST
_K_B = constant("m_ba") * constant("m_bc")
_OPPOSITE, _REST = negative(FIRST), minus(HALF_TURN, FIRST)
WDG, DSG = "wohlhart-double-goldberg", "double-subtractive-goldberg"

FORMS: tuple[ClosedForm, ...] = (
    _constructive(WDG, +1),
    _non_constructive(WDG, +1),
    _constructive(DSG, -1),
    _non_constructive(DSG, -1),
    _constructive("double-goldberg-type-i", +1, exchanged=True),
    _non_constructive("double-goldberg-type-i", +1, exchanged=True),
    _constructive("double-subtractive-goldberg-type-i", -1, exchanged=True),
    _non_constructive("double-subtractive-goldberg-type-i", -1, exchanged=True),
    _special(+1, "Form I (Bennett 4R)", _OPPOSITE, (-_K_B * _C1, _S1), True),
    _special(+1, "Form II", (-_K_B * _C1, _S1), _OPPOSITE, False),
    _non_constructive(f"special-{WDG}", +1, special=True),
    _special(-1, "Form I", (_K_B * _S1, _C1), _REST, False),
    _special(-1, "Form II (Bennett 4R)", _REST, (_K_B * _S1, _C1), True),
    _non_constructive(f"special-{DSG}", -1, special=True),
)
