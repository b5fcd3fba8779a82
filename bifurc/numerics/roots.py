"""Many bracketed roots of one function at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bifurc import _core

STEPS = 100


def bracketed_roots(
    function: Callable[[np.ndarray], np.ndarray],
    low: np.ndarray,
    high: np.ndarray,
    tolerance: float = 1e-15,
    at_ends: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Roots (k,), one in each bracket from ``low`` to ``high`` (k,), where ``function``
    has opposite signs at the ends.

    ``function`` maps (k,) to (k,), entry by entry; ``at_ends`` are its values at low and
    high, where they are known. Chandrupatla's method (1997):
    inverse quadratic interpolation where that is safe, else bisection. Roots are found
    to ``tolerance`` and to rounding. The method is that of
    `scipy.optimize.elementwise.find_root`, which is general and takes half a
    millisecond an iteration.
    """
    low = np.ascontiguousarray(low, dtype=float)
    high = np.ascontiguousarray(high, dtype=float)
    at_low, at_high = at_ends or (function(low), function(high))
    brackets = _core.Brackets(low, high, at_low, at_high, tolerance)
    for _ in range(STEPS):
        is_done = brackets.narrow(function(brackets.points()))
        if is_done:
            break
    return brackets.roots()
