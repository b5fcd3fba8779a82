"""Wohlhart's symmetric 6R mechanism: six equal lengths, twists alpha and 2 pi - alpha
in turn, no offsets."""

from __future__ import annotations

import math

import numpy as np

from linkages.closed_forms.closed_form import (
    ClosedForm,
    constant,
    cosine_of,
    joint,
    sine_of,
    tangent,
)
from linkages.construction.conditions import require_positive, require_within
from linkages.construction.numbers import Number, pi_like
from linkages.construction.table_equations import (
    equal_lengths,
    equal_twists,
    opposite_twists,
    zero_offsets,
)
from linkages.entry import (
    BY_IDENTIFICATION,
    Condition,
    Entry,
    FormPattern,
    Parameter,
    ParameterKind,
    Relation,
    RelationKind,
)
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
    require_within("twist alpha", alpha, 0.0, math.pi)
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


def _formulas() -> tuple[ClosedForm, ...]:
    """Odd joints at theta, even joints at phi."""
    import sympy as sp

    c = constant("c")
    s = constant("s")
    s1, c1 = joint(1)
    s2, c2 = joint(2)
    sine1 = 2 * s1 * c1
    cosine1 = c1**2 - s1**2
    one1 = s1**2 + c1**2
    sine2 = 2 * s2 * c2
    cosine2 = c2**2 - s2**2
    one2 = s2**2 + c2**2
    relation = (
        (1 + c**2) * cosine1 * cosine2
        + s**2 * (cosine1 * one2 + cosine2 * one1)
        - 2 * c * sine1 * sine2
        + c**2 * one1 * one2
    )
    u = tangent("alpha")
    form = ClosedForm(
        "wohlhart-symmetric",
        "threefold form",
        "Racila and Dahan 2010, eq. (15)",
        ("alpha",),
        ((joint(1),), (joint(2),)) * 3,
        {"c": cosine_of(u), "s": sine_of(u)},
        relation=sp.expand(relation),
        second=2,
    )
    return (form,)


ENTRIES: tuple[Entry, ...] = (
    Entry(
        "wohlhart-symmetric",
        "Wohlhart symmetric 6R mechanism",
        "Wohlhart 1987, Proc. 7th IFToMM World Congress, 193-198; "
        "Racila and Dahan 2010, Meccanica 45, 153-165, eqs (2)-(15)",
        wohlhart_symmetric,
        (
            Parameter.length("a", 1.0, "length of every link", 0.3, 3.0),
            Parameter(
                "alpha",
                math.pi / 2,
                ParameterKind.ANGLE,
                "twist of links 12, 34 and 56",
                0.2,
                math.pi - 0.2,
            ),
        ),
        conditions=(
            Condition(
                "all lengths equal, all offsets 0",
                (
                    equal_lengths((12, 23), (12, 34), (12, 45), (12, 56), (12, 61)),
                    zero_offsets(),
                ),
            ),
            Condition(
                "twists alpha and 2 pi - alpha in turn",
                (
                    equal_twists((12, 34), (12, 56)),
                    opposite_twists((12, 23), (12, 45), (12, 61)),
                ),
            ),
        ),
        patterns=_patterns,
        formulas=_formulas,
        relations=(
            Relation(
                RelationKind.SPECIAL_CASE, "bricard-plane-symmetric", BY_IDENTIFICATION
            ),
            Relation(RelationKind.SPECIAL_CASE, "wohlhart-hybrid", BY_IDENTIFICATION),
        ),
        errata=(
            "Racila and Dahan 2010, eq. (17): C3 has cos(theta) + 1 where it must have "
            "cos(phi) + 1",
            "Racila and Dahan 2010, section 2: 90 degrees is not the only twist of "
            "continuous motion; thick links may collide at others, but the closed "
            "curves are full",
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
