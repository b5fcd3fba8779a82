"""What the unknowns of a system are, and where its solutions are looked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bifurc import torus
from bifurc.decisions import is_in_bounds

LARGE = 64  # unknowns of a system beyond which it is large


@dataclass(frozen=True, eq=False)
class Domain:
    """The unknowns of a system and the region in which its curves are followed.

    ``names`` and ``units`` (n,) label the unknowns, ``periods`` (n,) are their periods
    (inf where there is none), ``bounds`` (n, 2) the region of interest (infinite where
    there is none), ``scale`` the typical size of the unknowns. ``has_assumed_bounds``
    (n, 2): which ends of the bounds were chosen, as none were given; a single False for
    none of them. ``rim``, where something besides the bounds ends the region, gives how
    far points (k, n) lie outside of that (k,), negative inside.

    ``stride`` and ``reach`` are the units, in scales, of the longest step along a curve
    and of the length that a curve may have before it is cut off. ``has_crossings``:
    curves may cross, so that short steps are a sign of a crossing.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    periods: np.ndarray
    bounds: np.ndarray
    scale: float = 1.0
    has_assumed_bounds: np.ndarray | bool = False
    rim: Callable[[np.ndarray], np.ndarray] | None = None
    stride: float = 1.0
    reach: float = 1.0
    has_crossings: bool = True

    @property
    def is_large(self) -> bool:
        """Whether there are so many unknowns that F' is bordered instead of decomposed,
        and F'' is not formed."""
        return len(self.names) > LARGE

    @property
    def slack(self) -> float:
        """How far outside the bounds a point still counts as inside."""
        return is_in_bounds.threshold * self.scale

    def excess(self, points: np.ndarray) -> np.ndarray:
        """How far points (k, n) lie outside the region (k,), in the unknown that is
        farthest; negative inside."""
        low, high = self.bounds.T
        excess = np.maximum(low - points, points - high)
        farthest: np.ndarray = excess.max(axis=1)
        return farthest if self.rim is None else np.maximum(farthest, self.rim(points))

    def are_inside(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, n) lie within the region (k,), or outside by rounding: a
        curve may run in a bound."""
        outside: np.ndarray = np.maximum(self.excess(points), 0.0)
        return is_in_bounds(outside, self.scale)

    def are_at_bounds(self, points: np.ndarray) -> np.ndarray:
        """Which points (k, n) lie in a bound, or beyond one (k,)."""
        at_bounds: np.ndarray = self.excess(points) >= -self.slack
        return at_bounds

    def difference(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """a - b (..., n) with periodic unknowns taken to within half a period of 0."""
        return torus.difference(a, b, self.periods)
