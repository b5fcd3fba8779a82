"""Angles that the twists and lengths of composite links leave possible, every candidate
of each; all in rad."""

from __future__ import annotations

import itertools
from math import pi
from typing import Any

import numpy as np

__all__ = ["half_tangents", "kinks", "twist_pairs", "twists_of"]

BESIDE = 0.01
# a cosine beyond this is not the rounding, or the error, of a table worth fitting
SLACK = 1.02


def _inverse_cosine(value: float) -> float | None:
    return float(np.arccos(np.clip(value, -1.0, 1.0))) if abs(value) < SLACK else None


def kinks(first: float, second: float, joined: float) -> list[float]:
    """Angles at which links with the twists ``first``, ``second`` make one with the
    twist ``joined``, modulo pi.

    Near the collinear kinks the twist hardly depends on the angle: the collinear one
    and angles beside it come too.
    """
    scale = np.sin(first) * np.sin(second)
    out: list[float] = []
    for cosine in (np.cos(joined), -np.cos(joined)):
        kink = (
            _inverse_cosine((np.cos(first) * np.cos(second) - cosine) / scale)
            if scale
            else None
        )
        if kink is None:
            continue
        out += [kink, -kink]
        if np.sin(kink) < 2 * BESIDE:
            collinear = round(kink / pi) * pi
            out = [collinear, *out, collinear + BESIDE, collinear - BESIDE]
    return out


def twist_pairs(twist: float, ratio: float, sign: int) -> list[tuple[float, float]]:
    """Twists x, y in (0, pi) with x + sign y = ``twist`` modulo pi and sin x + sign sin
    y = ``ratio`` up to sign."""
    out = []
    for total, size in itertools.product(
        (twist, twist + pi, twist - pi), (ratio, -ratio)
    ):
        sine = 2 * np.sin(total / 2)
        other = _inverse_cosine(size / sine) if sine else None
        if other is None:
            continue
        pairs = (
            [(other + total / 2, other - total / 2)]
            if sign < 0
            else [(total / 2 + h, total / 2 - h) for h in (other, -other)]
        )
        out += [pair for pair in pairs if all(0 < x < pi for x in pair)]
    return out


def half_tangents(twist: float) -> list[float]:
    """tan(x/2) for the twist and for the twist plus pi."""
    t = float(np.tan(twist / 2))
    return [t, -1 / t] if t else [0.0]


def twists_of(tangents: Any) -> list[float]:
    """Twists in (0, pi) with these half-angle tangents, complex ones left out."""
    values = np.atleast_1d(tangents)
    return [
        float(2 * np.arctan(t.real))
        for t in values
        if abs(t.imag) < 1e-6 * (1 + abs(t)) and t.real > 0
    ]
