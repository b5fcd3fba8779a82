"""Wohlhart's symmetric 6R mechanism: six equal lengths, twists alpha and 2 pi - alpha
in turn, no offsets."""

from __future__ import annotations

import math

import numpy as np

from linkages.construction.conditions import require_positive, require_twists
from linkages.construction.numbers import Number, pi_like
from linkages.entry import FormPattern
from linkages.entry_table import Model, read_entries
from linkages.loop import Loop

POSITION = 210


def wohlhart_symmetric(a: Number, alpha: Number) -> Loop:
    """Wohlhart's symmetric 6R with links of length ``a`` and twists ``alpha``, 2 pi -
    ``alpha`` in turn.

    alpha in rad, between 0 and pi. Raises `GeometryError` outside, and for a length
    that is not positive. Odd and even angles are alike, theta and phi, with (1 +
    cos(alpha)^2) cos(theta) cos(phi) + sin(alpha)^2 (cos(theta) + cos(phi))
    - 2 cos(alpha) sin(theta) sin(phi) + cos(alpha)^2 = 0
    (Racila and Dahan 2010, eqs 2, 14, 15). Between 60 and 120 degrees this is one
    closed curve, outside two.
    """
    require_positive("length a", a)
    require_twists(alpha=alpha)
    twists = (alpha, 2 * pi_like(alpha) - alpha) * 3
    return Loop((a,) * 6, twists, (0,) * 6, "wohlhart-symmetric")


def _patterns(a: float, alpha: float) -> tuple[FormPattern, ...]:
    c = math.cos(alpha)
    s = math.sin(alpha)

    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        odd_gaps = np.sin((np.roll(theta, -2, axis=-1) - theta) / 2)
        x = theta[..., 0]
        y = theta[..., 1]
        closure = (
            (1 + c * c) * np.cos(x) * np.cos(y)
            + s * s * (np.cos(x) + np.cos(y))
            - 2 * c * np.sin(x) * np.sin(y)
            + c * c
        )
        return np.concatenate([odd_gaps, closure[..., None]], axis=-1)

    return (FormPattern("threefold form", residual),)


ENTRIES = read_entries(
    "wohlhart",
    {"wohlhart-symmetric": Model(wohlhart_symmetric, _patterns)},
)
