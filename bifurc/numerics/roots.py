"""Many bracketed roots of one function at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc import _core

__all__ = ["bracketed_roots"]

STEPS = 100


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
    low = np.ascontiguousarray(low, dtype=float)
    high = np.ascontiguousarray(high, dtype=float)
    brackets = _core.Brackets(low, high, function(low), function(high), tolerance)
    for _ in range(STEPS):
        is_done = brackets.narrow(function(brackets.points()))
        if is_done:
            break
    return brackets.roots()
