"""Angles that the twists and lengths of composite links leave possible, every candidate
of each; all in rad.

They read parameters off a table: what `linkages.construction.link` and
`linkages.construction.spatial_triangle` compute, the other way round.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from math import pi

import numpy as np

BESIDE = 0.01
# a cosine beyond this is not the rounding, or the error, of a table worth fitting
SLACK = 1.02


def _inverse_cosine(value: float) -> float | None:
    if not abs(value) < SLACK:
        return None
    return float(np.arccos(np.clip(value, -1.0, 1.0)))


def kinks(first: float, second: float, joined: float) -> list[float]:
    """Angles at which links with the twists ``first``, ``second`` make one with the
    twist ``joined``, modulo pi.

    Near the collinear kinks the twist hardly depends on the angle: the collinear one
    and angles beside it come too.
    """
    scale = np.sin(first) * np.sin(second)
    if not scale:
        return []
    out: list[float] = []
    for cosine in (np.cos(joined), -np.cos(joined)):
        product = np.cos(first) * np.cos(second)
        kink = _inverse_cosine((product - cosine) / scale)
        if kink is None:
            continue
        out += [kink, -kink]
        if np.sin(kink) < 2 * BESIDE:
            collinear = round(kink / pi) * pi
            out = [collinear, *out, collinear + BESIDE, collinear - BESIDE]
    return out


def kink_pairs(
    first: tuple[float, float, float], second: tuple[float, float, float]
) -> Iterator[dict[str, float]]:
    """Every pair of the `kinks` of two links that are made of two, each given by its
    twists, as the parameters ``kink_1`` and ``kink_2``."""
    for kink_1, kink_2 in itertools.product(kinks(*first), kinks(*second)):
        yield {"kink_1": kink_1, "kink_2": kink_2}


def twist_pairs(twist: float, ratio: float, sign: int) -> list[tuple[float, float]]:
    """Twists x, y in (0, pi) with x + sign y = ``twist`` modulo pi and sin x + sign sin
    y = ``ratio`` up to sign."""
    totals = (twist, twist + pi, twist - pi)
    out = []
    for total, size in itertools.product(totals, (ratio, -ratio)):
        sine = 2 * np.sin(total / 2)
        half = _inverse_cosine(size / sine) if sine else None
        if half is None:
            continue
        mean = total / 2
        pairs = [(half + mean, half - mean)]
        if sign > 0:
            pairs = [(mean + half, mean - half), (mean - half, mean + half)]
        out += [(x, y) for x, y in pairs if 0 < x < pi and 0 < y < pi]
    return out


def half_tangents(twist: float) -> list[float]:
    """tan(x/2) for the twist and for the twist plus pi."""
    t = float(np.tan(twist / 2))
    return [t, -1 / t] if t else [0.0]


def twists_with(tangents: float | np.ndarray) -> list[float]:
    """Twists in (0, pi) with these half-angle tangents, complex ones left out."""
    out = []
    for t in np.atleast_1d(tangents):
        is_real = abs(t.imag) < 1e-6 * (1 + abs(t))
        if is_real and t.real > 0:
            out.append(float(2 * np.arctan(t.real)))
    return out
