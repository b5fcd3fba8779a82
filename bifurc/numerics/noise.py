"""How noisy the values of a function are: what differences of a high order leave.

Along a line the differences of a smooth function shrink with their order, and those of
noise grow as binomial sums do (Hamming 1971; Moré and Wild 2011, Estimating
computational noise).
"""

from __future__ import annotations

from collections.abc import Callable
from math import comb

import numpy as np

VALUES = 13  # along each line
ORDERS = range(5, 10)  # of differences that are compared
LONG, SHORT = 1e-3, 1e-4  # steps between values, over the size of the region
# What differences over long and over short steps leave is smooth where the first is so
# many times larger: it falls with the power of the order. Of steps in the values, as
# rounding makes them, short ones see a part.
SMOOTH = 1e4


def noise_of(
    function: Callable[[np.ndarray], np.ndarray],
    points: np.ndarray,
    scale: float,
    rng: np.random.Generator,
) -> np.ndarray | None:
    """The standard deviation (m,) of what is not smooth in the values (m,) of a
    ``function`` of an unknown size ``scale`` about points (k, n); None where too few of
    these are finite."""
    estimates = []
    for point in points:
        heading = rng.normal(size=len(point))
        heading /= np.linalg.norm(heading)
        over_long = _along(function, point, LONG * scale * heading)
        over_short = _along(function, point, SHORT * scale * heading)
        if over_long is not None and over_short is not None:
            is_smooth = over_long > SMOOTH * over_short
            estimates.append(np.where(is_smooth, over_short, over_long))
    if not estimates:
        return None
    median: np.ndarray = np.median(estimates, axis=0)
    return median


def _along(
    function: Callable[[np.ndarray], np.ndarray], point: np.ndarray, step: np.ndarray
) -> np.ndarray | None:
    """The noise (m,) of values a ``step`` (n,) apart about a point (n,); None where one
    of them is not finite."""
    places = np.arange(VALUES) - VALUES // 2
    differences = np.array([function(point + k * step) for k in places])
    if not np.all(np.isfinite(differences)):
        return None
    by_order = []
    for order in range(1, max(ORDERS) + 1):
        differences = np.diff(differences, axis=0)
        if order in ORDERS:
            # the variance of a difference of noise is that many times its own
            squares = np.mean(differences**2, axis=0) / comb(2 * order, order)
            by_order.append(np.sqrt(squares))
    lowest: np.ndarray = np.min(by_order, axis=0)
    return lowest
