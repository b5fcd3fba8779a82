"""Arithmetic modulo the periods of the unknowns.

An unknown with a period p stands for a circle; one whose period is infinite stands for
a line. Every function takes ``periods`` (n,), inf where there is none.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

import numpy as np

LARGEST_DENOMINATOR = 1000  # of a ratio of turns after which both are back
RATIO_ROUNDING = 1e-12  # by which such a ratio may differ from a fraction, of itself
SEAM = 1e-12  # share of a period: what lies nearer to an end of it lies at the end


def difference(a: np.ndarray, b: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """a - b (..., n), periodic unknowns taken to within half a period of zero."""
    gap: np.ndarray = np.asarray(a, dtype=float) - b
    periodic = np.isfinite(periods)
    if periodic.all():  # every loop: picking columns would take most of the time
        gap -= periods * np.rint(gap / periods)
    elif periodic.any():
        period = periods[periodic]
        turns = np.rint(gap[..., periodic] / period)
        gap[..., periodic] -= period * turns
    return gap


def wrap(points: np.ndarray, periods: np.ndarray, within: float = SEAM) -> np.ndarray:
    """``points`` (..., n) with periodic unknowns in (-period / 2, period / 2].

    What lies nearer than the share ``within`` of a period to either end comes out at
    + period / 2 exactly: on which side of the end it lies would be rounding.
    """
    out = np.array(points, dtype=float)
    periodic = np.isfinite(periods)
    period = periods[periodic]
    angles = out[..., periodic]
    angles -= period * np.rint(angles / period)
    at_the_seam = np.abs(angles) >= (0.5 - within) * period
    out[..., periodic] = np.where(at_the_seam, 0.5 * period, angles)
    return out


def whole_turns(travel: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """Number of periods (n,) in ``travel`` (n,), to the nearest integer; 0 for unknowns
    without a period."""
    turns = np.zeros(len(periods), dtype=int)
    periodic = np.isfinite(periods)
    periods_gained = travel[periodic] / periods[periodic]
    turns[periodic] = np.rint(periods_gained)
    return turns


def tree_box(periods: np.ndarray) -> np.ndarray:
    """The periods (n,) as `scipy.spatial.cKDTree` takes them: 0 where there is none."""
    return np.where(np.isfinite(periods), periods, 0.0)


def into_box(points: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """``points`` (..., n) with periodic unknowns in [0, period)."""
    out = np.array(points, dtype=float)
    periodic = np.isfinite(periods)
    if np.all(periodic):  # every loop: picking columns would take most of the time
        out %= periods
        return np.where(out >= periods, 0.0, out)
    period = periods[periodic]
    inside = out[..., periodic] % period
    out[..., periodic] = np.where(inside >= period, 0.0, inside)
    return out


def wrapped_periods(periods: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """The periods (n,) of the unknowns to wrap; inf for those whose ``bounds`` (n, 2)
    reach farther."""
    half = 0.5 * periods
    low, high = bounds.T
    is_bounded = np.isfinite(bounds).any(axis=1)
    reaches_farther = is_bounded & ((low < -half) | (high > half))
    return np.where(reaches_farther, np.inf, periods)


def common_period(ratios: Iterable[float]) -> float:
    """The smallest turn (rad) of an unknown after which all angles are back that it turns
    at these ``ratios``; inf where none is short."""
    turning = []
    for ratio in ratios:
        fraction = Fraction(float(ratio)).limit_denominator(LARGEST_DENOMINATOR)
        if abs(float(fraction) - ratio) > RATIO_ROUNDING * abs(ratio):
            return math.inf
        if fraction:
            turning.append(fraction)
    denominator = math.lcm(*(fraction.denominator for fraction in turning))
    numerator = math.gcd(*(fraction.numerator for fraction in turning))
    return 2 * math.pi * denominator / numerator
