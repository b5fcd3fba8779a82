"""The Bennett linkage, 4R, in its four set-ups.

Opposite links are alike, all offsets vanish, and sin(twist)/length of the two links
agree up to sign: with the same sign opposite joints turn oppositely (asymmetric
set-up), with opposite signs they turn alike (line-symmetric set-up). Turning joint axes
round changes one set-up into another of the same shape.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from linkages.closed_forms.closed_form import (
    ClosedForm,
    constant,
    joint,
    negative,
    only,
    reciprocal,
    tangent,
)
from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_within,
)
from linkages.construction.numbers import Number, pi_like
from linkages.construction.table_equations import equal_links, zero_offsets
from linkages.entry import (
    Condition,
    Entry,
    FormPattern,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
from linkages.loop import Loop

POSITION = 30
SOURCE = (
    "Bennett 1903; set-ups: Song 2013, Kinematic study of overconstrained linkages, "
    "eqs (2.2.1)-(2.2.19)"
)
ALIKE, OPPOSITE = +1, -1  # how opposite joints turn


def _loop(a: Number, alpha: Number, b: Number, beta: Number) -> Loop:
    return Loop((a, b, a, b), (alpha, beta, alpha, beta), (0, 0, 0, 0), "bennett")


def _second_length(a: Number, alpha: Number, beta: Number, b: Number | None) -> Number:
    require_positive("length of link 12", a)
    require_within("twist alpha", alpha, 0.0, math.pi)
    require_within("twist beta", beta, 0.0, math.pi)
    return bennett_length("23", beta, b, a, alpha)


def bennett(a: Number, alpha: Number, beta: Number, b: Number | None = None) -> Loop:
    """The asymmetric Bennett linkage AB-1: links a/alpha and b/beta in turn, b = a
    sin(beta)/sin(alpha).

    Twists in rad, between 0 and pi. A given ``b`` is checked. Raises `GeometryError`
    when it does not have the Bennett ratio of the first link. Closed form: theta3 =
    -theta1, theta4 = -theta2 and tan(theta1/2) tan(theta2/2) = sin((beta + alpha)/2) /
    sin((beta - alpha)/2) (Song 2013, eqs 2.2.2-2.2.4).
    """
    return _loop(a, alpha, _second_length(a, alpha, beta, b), beta)


def bennett_ab_2(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The asymmetric Bennett linkage AB-2, whose second twist is pi - beta (Song 2013,
    eq. 2.2.18).

    Parameters, closed form (with pi - beta for beta) and errors as in `bennett`.
    """
    second = _second_length(a, alpha, beta, b)
    return _loop(a, alpha, second, pi_like(alpha, beta) - beta)


def bennett_line_symmetric(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The line-symmetric Bennett linkage LB-1, whose second twist is -beta (Song 2013,
    eqs 2.2.13, 2.2.17).

    Parameters and errors as in `bennett`. Closed form: theta3 = theta1, theta4 = theta2
    and tan(theta1/2) tan(theta2/2) = cos((alpha23 + alpha)/2) / cos((alpha23 -
    alpha)/2) (eq. 2.2.14).
    """
    return _loop(a, alpha, _second_length(a, alpha, beta, b), -beta)


def bennett_lb_2(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The line-symmetric Bennett linkage LB-2, whose second twist is beta - pi (Song
    2013, eq. 2.2.17).

    Parameters, closed form (eq. 2.2.14) and errors as in `bennett_line_symmetric`.
    """
    second = _second_length(a, alpha, beta, b)
    return _loop(a, alpha, second, beta - pi_like(alpha, beta))


# --- form and closed form


def _patterns(
    sign: int, second_twist: Callable[[float], float]
) -> Callable[..., tuple[FormPattern, ...]]:
    """Patterns of a set-up: opposite joints turn alike (``sign`` +1) or oppositely
    (-1)."""

    def patterns(a: float, alpha: float, beta: float) -> tuple[FormPattern, ...]:
        total = (alpha + second_twist(beta)) / 2
        difference = (second_twist(beta) - alpha) / 2
        f = math.cos if sign > 0 else math.sin
        top = f(total)
        bottom = f(difference)

        def residual(theta: np.ndarray) -> np.ndarray:
            h = np.moveaxis(np.asarray(theta) / 2, -1, 0)
            s = np.sin(h)
            c = np.cos(h)
            rows = [
                np.sin(h[2] - sign * h[0]),
                np.sin(h[3] - sign * h[1]),
                bottom * s[0] * s[1] - top * c[0] * c[1],
            ]
            return np.stack(rows, axis=-1)

        return (FormPattern("Bennett form", residual),)

    return patterns


def _closed_form(
    linkage: str, sign: int, product: Number, equations: str
) -> tuple[ClosedForm, ...]:
    """The closed form with t1 t2 = ``product``; ``sign`` as in `_patterns`."""
    first = joint(1)
    second = reciprocal(first, constant("m"))
    third = first if sign > 0 else negative(first)
    fourth = second if sign > 0 else negative(second)
    form = ClosedForm(
        linkage,
        "Bennett form",
        "Song 2013, eq. " + equations,
        ("alpha", "beta"),
        only(first, second, third, fourth),
        {"m": product},
    )
    return (form,)


def _quotient_of_sums() -> Number:
    u = tangent("alpha")
    v = tangent("beta")
    return (v + u) / (v - u)


def _quotient_of_products() -> Number:
    u = tangent("alpha")
    v = tangent("beta")
    return (1 + u * v) / (1 - u * v)


def _ab_1_formulas() -> tuple[ClosedForm, ...]:
    product = _quotient_of_sums()
    return _closed_form("bennett", OPPOSITE, product, "(2.2.3), (2.2.4)")


def _ab_2_formulas() -> tuple[ClosedForm, ...]:
    product = _quotient_of_products()
    return _closed_form("bennett-ab-2", OPPOSITE, product, "(2.2.4) with (2.2.18)")


def _lb_1_formulas() -> tuple[ClosedForm, ...]:
    product = _quotient_of_products()
    return _closed_form("bennett-line-symmetric", ALIKE, product, "(2.2.14)")


def _lb_2_formulas() -> tuple[ClosedForm, ...]:
    product = _quotient_of_sums()
    return _closed_form("bennett-lb-2", ALIKE, product, "(2.2.14) with (2.2.17)")


# --- entries


def _twist(name: str, degrees: float, meaning: str) -> Parameter:
    default = math.radians(degrees)
    return Parameter(name, default, ParameterKind.ANGLE, meaning, 0.15, math.pi - 0.15)


PARAMETERS = (
    Parameter.length("a", 1.0, "length of links 12 and 34", 0.3, 3.0),
    _twist("alpha", 100, "twist of links 12 and 34"),
    _twist("beta", 40, "twist of links 23 and 41 before its sign is set"),
)
OPPOSITE_LINKS = Condition(
    "a12 = a34, a23 = a41, alpha12 = alpha34, alpha23 = alpha41",
    (equal_links((12, 34), (23, 41)),),
)
NO_OFFSETS = Condition("all offsets 0", (zero_offsets(),))
ERRATA = (
    "Song 2013, eqs (2.2.8), (2.2.11): the order of the inverses, and theta2 with "
    "theta4, are exchanged; the results (2.2.9), (2.2.10), (2.2.14) are right.",
)
FACTS = {"mobility": 1, "rank": 3, "forms": 1, "bifurcations": 0}
SAME_LINKAGE = (Relation(RelationKind.SAME, "bennett", "Song (2013), section 2.2"),)


def _conditions(second_twist: str) -> tuple[Condition, ...]:
    ratio = f"alpha23 = {second_twist}, sin(alpha)/a = sin(beta)/b"
    return OPPOSITE_LINKS, Condition(ratio), NO_OFFSETS


ENTRIES: tuple[Entry, ...] = (
    Entry(
        "bennett",
        "Bennett linkage, asymmetric set-up",
        SOURCE,
        bennett,
        PARAMETERS,
        conditions=_conditions("beta"),
        patterns=_patterns(OPPOSITE, lambda beta: beta),
        formulas=_ab_1_formulas,
        errata=ERRATA,
        facts=FACTS,
    ),
    Entry(
        "bennett-ab-2",
        "Bennett linkage, asymmetric set-up with supplementary twist",
        SOURCE,
        bennett_ab_2,
        PARAMETERS,
        conditions=_conditions("pi - beta"),
        patterns=_patterns(OPPOSITE, lambda beta: math.pi - beta),
        formulas=_ab_2_formulas,
        relations=SAME_LINKAGE,
        errata=ERRATA,
        facts=FACTS,
    ),
    Entry(
        "bennett-line-symmetric",
        "Bennett linkage, line-symmetric set-up",
        SOURCE,
        bennett_line_symmetric,
        PARAMETERS,
        conditions=_conditions("-beta"),
        patterns=_patterns(ALIKE, lambda beta: -beta),
        formulas=_lb_1_formulas,
        relations=SAME_LINKAGE,
        errata=ERRATA,
        facts=FACTS,
    ),
    Entry(
        "bennett-lb-2",
        "Bennett linkage, line-symmetric set-up with supplementary twist",
        SOURCE,
        bennett_lb_2,
        PARAMETERS,
        conditions=_conditions("beta - pi"),
        patterns=_patterns(ALIKE, lambda beta: beta - math.pi),
        formulas=_lb_2_formulas,
        relations=SAME_LINKAGE,
        errata=ERRATA,
        facts=FACTS,
    ),
)
