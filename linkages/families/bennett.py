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

from linkages.construction.conditions import (
    bennett_length,
    require_positive,
    require_twists,
)
from linkages.construction.numbers import Number, pi_like
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop

POSITION = 30
ALIKE, OPPOSITE = +1, -1  # how opposite joints turn


def _loop(
    a: Number, alpha: Number, beta: Number, b: Number | None, second_twist: Number
) -> Loop:
    require_positive("length of link 12", a)
    require_twists(alpha=alpha, beta=beta)
    b = bennett_length("23", beta, b, a, alpha)
    twists = (alpha, second_twist, alpha, second_twist)
    return Loop((a, b, a, b), twists, (0, 0, 0, 0), "bennett")


def bennett(a: Number, alpha: Number, beta: Number, b: Number | None = None) -> Loop:
    """The asymmetric Bennett linkage AB-1: links a/alpha and b/beta in turn, b = a
    sin(beta)/sin(alpha).

    Twists in rad, between 0 and pi. A given ``b`` is checked. Raises `GeometryError`
    when it does not have the Bennett ratio of the first link. Closed form: theta3 =
    -theta1, theta4 = -theta2 and tan(theta1/2) tan(theta2/2) = sin((beta + alpha)/2) /
    sin((beta - alpha)/2) (Song 2013, eqs 2.2.2-2.2.4).
    """
    return _loop(a, alpha, beta, b, beta)


def bennett_ab_2(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The asymmetric Bennett linkage AB-2, as `bennett` with the second twist pi - beta
    (Song 2013, eq. 2.2.18)."""
    return _loop(a, alpha, beta, b, pi_like(alpha, beta) - beta)


def bennett_line_symmetric(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The line-symmetric Bennett linkage LB-1, as `bennett` with the second twist -beta
    (Song 2013, eqs 2.2.13, 2.2.17).

    Closed form: theta3 = theta1, theta4 = theta2 and tan(theta1/2) tan(theta2/2) =
    cos((alpha23 + alpha)/2) / cos((alpha23 - alpha)/2) (eq. 2.2.14).
    """
    return _loop(a, alpha, beta, b, -beta)


def bennett_lb_2(
    a: Number, alpha: Number, beta: Number, b: Number | None = None
) -> Loop:
    """The line-symmetric Bennett linkage LB-2, as `bennett_line_symmetric` with the
    second twist beta - pi (Song 2013, eq. 2.2.17)."""
    return _loop(a, alpha, beta, b, beta - pi_like(alpha, beta))


# --- forms


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


ENTRIES = read_entries(
    "bennett",
    {
        "bennett": Model(
            bennett,
            _patterns(OPPOSITE, lambda beta: beta),
        ),
        "bennett-ab-2": Model(
            bennett_ab_2,
            _patterns(OPPOSITE, lambda beta: math.pi - beta),
        ),
        "bennett-line-symmetric": Model(
            bennett_line_symmetric,
            _patterns(ALIKE, lambda beta: -beta),
        ),
        "bennett-lb-2": Model(
            bennett_lb_2,
            _patterns(ALIKE, lambda beta: beta - math.pi),
        ),
    },
)
