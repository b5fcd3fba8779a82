"""The Bennett linkage, 4R, in its four set-ups.

Opposite links are alike, all offsets vanish, and sin(twist)/length of the two links
agree up to sign: with the same sign opposite joints turn oppositely (asymmetric
set-up), with opposite signs they turn alike (line-symmetric set-up). Turning joint axes
round changes one set-up into another of the same shape.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_within,
)
from linkages.construction.numbers import pi_like
from linkages.entry import Entry, FormPattern, Parameter
from linkages.loop import Loop

__all__ = [
    "ENTRIES",
    "bennett",
    "bennett_ab_2",
    "bennett_lb_2",
    "bennett_line_symmetric",
]

SOURCE = "Bennett 1903; set-ups: Song 2013, Kinematic study of overconstrained linkages, eqs (2.2.1)-(2.2.19)"


def _loop(a: Any, alpha: Any, b: Any, beta: Any) -> Loop:
    return Loop((a, b, a, b), (alpha, beta, alpha, beta), (0, 0, 0, 0), "bennett")


def _check(a: Any, alpha: Any, beta: Any, b: Any) -> Any:
    require_positive("length of link 12", a)
    for name, twist in (("twist alpha", alpha), ("twist beta", beta)):
        require_within(name, twist, 0.0, math.pi)
    return bennett_length("23", beta, b, a, alpha)


def bennett(a: Any, alpha: Any, beta: Any, b: Any = None) -> Loop:
    """The asymmetric Bennett linkage AB-1: links a/alpha and b/beta in turn, b = a
    sin(beta)/sin(alpha).

    Twists in rad, between 0 and pi. A given ``b`` is checked. Raises `GeometryError`
    when it does not have the Bennett ratio of the first link. Closed form: theta3 =
    -theta1, theta4 = -theta2 and tan(theta1/2) tan(theta2/2) = sin((beta + alpha)/2) /
    sin((beta - alpha)/2) (Song 2013, eqs 2.2.2-2.2.4).
    """
    return _loop(a, alpha, _check(a, alpha, beta, b), beta)


def bennett_ab_2(a: Any, alpha: Any, beta: Any, b: Any = None) -> Loop:
    """The asymmetric Bennett linkage AB-2, whose second twist is pi - beta (Song 2013,
    eq. 2.2.18).

    Parameters, closed form (with pi - beta for beta) and errors as in `bennett`.
    """
    return _loop(a, alpha, _check(a, alpha, beta, b), pi_like(alpha, beta) - beta)


def bennett_line_symmetric(a: Any, alpha: Any, beta: Any, b: Any = None) -> Loop:
    """The line-symmetric Bennett linkage LB-1, whose second twist is -beta (Song 2013,
    eqs 2.2.13, 2.2.17).

    Parameters and errors as in `bennett`. Closed form: theta3 = theta1, theta4 = theta2
    and tan(theta1/2) tan(theta2/2) = cos((alpha23 + alpha)/2) / cos((alpha23 -
    alpha)/2) (eq. 2.2.14).
    """
    return _loop(a, alpha, _check(a, alpha, beta, b), -beta)


def bennett_lb_2(a: Any, alpha: Any, beta: Any, b: Any = None) -> Loop:
    """The line-symmetric Bennett linkage LB-2, whose second twist is beta - pi (Song
    2013, eq. 2.2.17).

    Parameters, closed form (eq. 2.2.14) and errors as in `bennett_line_symmetric`.
    """
    return _loop(a, alpha, _check(a, alpha, beta, b), beta - pi_like(alpha, beta))


def _patterns(sign: int, second_twist: Any) -> Any:
    """Patterns of a set-up: opposite joints turn alike (``sign`` +1) or oppositely
    (-1)."""

    def patterns(a: float, alpha: float, beta: float) -> tuple[FormPattern, ...]:
        x, y = alpha / 2, second_twist(beta) / 2
        product, over = (
            (math.cos(x + y), math.cos(y - x))
            if sign > 0
            else (math.sin(x + y), math.sin(y - x))
        )

        def residual(theta: np.ndarray) -> np.ndarray:
            h = np.asarray(theta) / 2
            return np.stack(
                [
                    np.sin(h[..., 2] - sign * h[..., 0]),
                    np.sin(h[..., 3] - sign * h[..., 1]),
                    over * np.sin(h[..., 0]) * np.sin(h[..., 1])
                    - product * np.cos(h[..., 0]) * np.cos(h[..., 1]),
                ],
                axis=-1,
            )

        return (FormPattern("Bennett form", residual),)

    return patterns


PARAMETERS = (
    Parameter("a", 1.0, "length", "length of links 12 and 34", 0.3, 3.0),
    Parameter(
        "alpha",
        math.radians(100),
        "angle",
        "twist of links 12 and 34",
        0.15,
        math.pi - 0.15,
    ),
    Parameter(
        "beta",
        math.radians(40),
        "angle",
        "twist of links 23 and 41 before its sign is set",
        0.15,
        math.pi - 0.15,
    ),
)


def _entry(
    name: str, title: str, construct: Any, sign: int, second_twist: Any, twist: str
) -> Entry:
    return Entry(
        name=name,
        title=title,
        source=SOURCE,
        construct=construct,
        parameters=PARAMETERS,
        conditions=(
            "a12 = a34, a23 = a41, alpha12 = alpha34, alpha23 = alpha41",
            f"alpha23 = {twist}, sin(alpha)/a = sin(beta)/b",
            "all offsets 0",
        ),
        patterns=_patterns(sign, second_twist),
        errata=(
            "Song 2013, eqs (2.2.8), (2.2.11): the order of the inverses, and theta2 with theta4, are "
            "exchanged; the results (2.2.9), (2.2.10), (2.2.14) are right.",
        ),
        facts={"mobility": 1, "rank": 3, "forms": 1, "bifurcations": 0},
    )


ENTRIES: tuple[Entry, ...] = (
    _entry(
        "bennett",
        "Bennett linkage, asymmetric set-up",
        bennett,
        -1,
        lambda beta: beta,
        "beta",
    ),
    _entry(
        "bennett-ab-2",
        "Bennett linkage, asymmetric set-up with supplementary twist",
        bennett_ab_2,
        -1,
        lambda beta: math.pi - beta,
        "pi - beta",
    ),
    _entry(
        "bennett-line-symmetric",
        "Bennett linkage, line-symmetric set-up",
        bennett_line_symmetric,
        +1,
        lambda beta: -beta,
        "-beta",
    ),
    _entry(
        "bennett-lb-2",
        "Bennett linkage, line-symmetric set-up with supplementary twist",
        bennett_lb_2,
        +1,
        lambda beta: beta - math.pi,
        "beta - pi",
    ),
)
