"""Many bracketed roots of one function at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

__all__ = ["bracketed_roots"]

STEPS = 100
ROUNDING = 4e-16  # of a root, as a share of it


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
    a = np.array(low, dtype=float)
    b = np.array(high, dtype=float)
    fa = function(a)
    fb = function(b)
    share = np.full_like(a, 0.5)  # of the way from a to b, for the next point
    for _ in range(STEPS):
        x = a + share * (b - a)
        fx = function(x)
        is_beyond = np.sign(fx) == np.sign(fa)  # of the root, seen from b
        points = _Triples(
            a=x,
            b=np.where(is_beyond, b, a),
            c=np.where(is_beyond, a, b),
            fa=fx,
            fb=np.where(is_beyond, fb, fa),
            fc=np.where(is_beyond, fa, fb),
        )
        a, b = points.a, points.b
        fa, fb = points.fa, points.fb
        enough = ROUNDING * np.abs(a) + tolerance
        width = np.abs(b - a)
        is_root = (width <= 2 * enough) | (fa * fb == 0)
        if np.all(is_root):
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            share = points.next_share(enough / width)
    is_better = np.abs(fa) <= np.abs(fb)
    return np.where(is_better, a, b)


class _Triples(NamedTuple):
    """The newest points ``a``, the other ends ``b`` of the brackets, the ends ``c``
    before them, and the values there, each (k,)."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    fa: np.ndarray
    fb: np.ndarray
    fc: np.ndarray

    def next_share(self, least: np.ndarray) -> np.ndarray:
        """How far from a to b (k,) the next points lie: by inverse quadratic
        interpolation where its parabola is monotonic in the bracket, else half way.

        They keep a share of ``least`` (k,) from either end.
        """
        a, b, c = self.a, self.b, self.c
        fa, fb, fc = self.fa, self.fb, self.fc
        xi = (a - b) / (c - b)
        phi = (fa - fb) / (fc - fb)
        is_monotonic = (phi * phi < xi) & ((1 - phi) ** 2 < 1 - xi)
        weight_b = fa / (fb - fa) * fc / (fb - fc)
        distance_c = (c - a) / (b - a)
        weighted_c = distance_c * fa / (fc - fa) * fb / (fc - fb)
        inverse = weight_b + weighted_c
        is_safe = is_monotonic & np.isfinite(inverse)
        least = np.minimum(least, 0.5)
        return np.where(is_safe, np.clip(inverse, least, 1 - least), 0.5)
