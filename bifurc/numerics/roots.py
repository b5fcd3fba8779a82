"""Many bracketed roots of one function at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["bracketed_roots"]


def bracketed_roots(
    function: Callable[[np.ndarray], np.ndarray],
    low: np.ndarray,
    high: np.ndarray,
    tolerance: float = 1e-15,
) -> np.ndarray:
    """Roots (k,), one in each bracket from ``low`` to ``high`` (k,), where ``function``
    has opposite signs at the ends.

    ``function`` maps (k,) to (k,), entry by entry. Chandrupatla's method (1997):
    inverse quadratic interpolation where that is safe, else bisection. Roots are found
    to ``tolerance`` and to rounding. The method is that of
    `scipy.optimize.elementwise.find_root`, which is general and takes half a
    millisecond an iteration.
    """
    a, b = np.array(low, dtype=float), np.array(high, dtype=float)
    fa, fb = function(a), function(b)
    t = np.full_like(a, 0.5)
    for _ in range(100):
        x = a + t * (b - a)
        fx = function(x)
        same = np.sign(fx) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, fx
        enough = 4e-16 * np.abs(a) + tolerance
        width = np.abs(b - a)
        if np.all((width <= 2 * enough) | (fa * fb == 0)):
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            quadratic = (phi * phi < xi) & ((1 - phi) ** 2 < 1 - xi)
            inverse = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (
                fc - fa
            ) * fb / (fc - fb)
            least = np.minimum(enough / width, 0.5)
        t = np.where(
            quadratic & np.isfinite(inverse), np.clip(inverse, least, 1 - least), 0.5
        )
    return np.where(np.abs(fa) <= np.abs(fb), a, b)
