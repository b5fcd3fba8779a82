"""The Bennett linkage, 4R, in its four set-ups.

Opposite links are alike, all offsets vanish, and sin(twist)/length of the two links
agree up to sign: with the same sign opposite joints turn oppositely (asymmetric
set-up), with opposite signs they turn alike (line-symmetric set-up). Turning joint axes
round changes one set-up into another of the same shape.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

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
SecondTwist: TypeAlias = Callable[[Any], Any]  # that of links 23, 41, from beta


def bennett(
    a: Number,
    alpha: Number,
    beta: Number,
    b: Number | None = None,
    *,
    second_twist: SecondTwist = lambda beta: beta,
) -> Loop:
    """The Bennett linkage with links a/alpha and b/beta in turn, b = a
    sin(beta)/sin(alpha): AB-1, or that with another second twist.

    Twists in rad, between 0 and pi. A given ``b`` is checked. Raises `GeometryError`
    when it does not have the Bennett ratio of the first link. Closed form: theta3 =
    -theta1, theta4 = -theta2 and tan(theta1/2) tan(theta2/2) = sin((beta + alpha)/2) /
    sin((beta - alpha)/2) (Song 2013, eqs 2.2.2-2.2.4); in the line-symmetric set-ups
    theta3 = theta1, theta4 = theta2 and cos((alpha23 + alpha)/2) / cos((alpha23 -
    alpha)/2) (eq. 2.2.14).
    """
    require_positive("length of link 12", a)
    require_twists(alpha=alpha, beta=beta)
    b = bennett_length("23", beta, b, a, alpha)
    twists = (alpha, second_twist(beta)) * 2
    return Loop((a, b, a, b), twists, (0, 0, 0, 0), "bennett")


def _patterns(
    sign: int, second_twist: SecondTwist, a: float, alpha: float, beta: float
) -> tuple[FormPattern, ...]:
    """The form where opposite joints turn alike (``sign`` +1) or oppositely (-1)."""
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


def _model(sign: int, second_twist: SecondTwist) -> Model:
    construct = partial(bennett, second_twist=second_twist)
    return Model(construct, partial(_patterns, sign, second_twist))


# Song (2013), equations (2.2.18), (2.2.13) and (2.2.17) for the second twists
ENTRIES = read_entries(
    "bennett",
    {
        "bennett": _model(OPPOSITE, lambda beta: beta),
        "bennett-ab-2": _model(OPPOSITE, lambda beta: pi_like(beta) - beta),
        "bennett-line-symmetric": _model(ALIKE, lambda beta: -beta),
        "bennett-lb-2": _model(ALIKE, lambda beta: beta - pi_like(beta)),
    },
)
