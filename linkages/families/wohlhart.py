"""Wohlhart's symmetric 6R mechanism: six equal lengths, twists alpha and 2 pi - alpha
in turn, no offsets."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from linkages.construction.conditions import require_positive, require_within
from linkages.construction.numbers import pi_like
from linkages.entry import Entry, FormPattern, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "wohlhart_symmetric"]


def wohlhart_symmetric(a: Any, alpha: Any) -> Loop:
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
    require_within("twist alpha", alpha, 0.0, math.pi)
    return Loop(
        (a,) * 6,
        (alpha, 2 * pi_like(alpha) - alpha) * 3,
        (0,) * 6,
        "wohlhart-symmetric",
    )


def _patterns(a: float, alpha: float) -> tuple[FormPattern, ...]:
    c, s = math.cos(alpha), math.sin(alpha)

    def residual(theta: np.ndarray) -> np.ndarray:
        theta = np.asarray(theta)
        x, y = theta[..., 0], theta[..., 1]
        alike = np.sin((np.roll(theta, -2, axis=-1) - theta) / 2)
        joined = (1 + c * c) * np.cos(x) * np.cos(y) + s * s * (np.cos(x) + np.cos(y))
        joined = joined - 2 * c * np.sin(x) * np.sin(y) + c * c
        return np.concatenate([alike, joined[..., None]], axis=-1)

    return (FormPattern("threefold form", residual),)


ENTRIES: tuple[Entry, ...] = (
    Entry(
        "wohlhart-symmetric",
        "Wohlhart symmetric 6R mechanism",
        "Wohlhart 1987, Proc. 7th IFToMM World Congress, 193-198; Racila and Dahan 2010, Meccanica 45, "
        "153-165, eqs (2)-(15)",
        wohlhart_symmetric,
        (
            Parameter("a", 1.0, "length", "length of every link", 0.3, 3.0),
            Parameter(
                "alpha",
                math.pi / 2,
                "angle",
                "twist of links 12, 34 and 56",
                0.2,
                math.pi - 0.2,
            ),
        ),
        conditions=(
            "all lengths equal, all offsets 0",
            "twists alpha and 2 pi - alpha in turn",
        ),
        patterns=_patterns,
        errata=(
            "Racila and Dahan 2010, eq. (17): C3 has cos(theta) + 1 where it must have cos(phi) + 1",
            "Racila and Dahan 2010, section 2: 90 degrees is not the only twist of continuous motion; thick "
            "links may collide at others, but the closed curves are full",
        ),
        facts={
            "mobility": 1,
            "rank": 5,
            "forms": 1,
            "bifurcations": 0,
            "components": 1,
        },
    ),
)
