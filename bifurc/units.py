"""Units of the unknowns and of the equations, and how values change with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    # SciPy takes longer to import than a small problem to solve
    from scipy.sparse import sparray


@dataclass(frozen=True)
class Units:
    """An unknown u_i is counted from ``origin`` (n,) on in units of ``sizes`` (n,), and
    equation j times ``weights`` (m,).

    Sizes and weights are powers of 2: nothing is lost on the way in and out.
    """

    origin: np.ndarray
    sizes: np.ndarray
    weights: np.ndarray

    @property
    def is_uniform(self) -> bool:
        """Whether all unknowns are counted in one size, so that angles, and lengths but
        for a factor, are those of the user."""
        return bool(np.all(self.sizes == self.sizes[0]))

    def inwards(self, points: np.ndarray) -> np.ndarray:
        """Points (..., n) of the user in these units."""
        counted: np.ndarray = (points - self.origin) / self.sizes
        return counted

    def outwards(self, points: np.ndarray) -> np.ndarray:
        """Points (..., n) in these units as the user counts them."""
        restated: np.ndarray = self.origin + self.sizes * points
        return restated

    def directions(self, vectors: np.ndarray) -> np.ndarray:
        """Unit vectors (..., n) in these units as unit vectors of the user."""
        restated = self.sizes * vectors
        lengths = np.linalg.norm(restated, axis=-1, keepdims=True)
        unit: np.ndarray = restated / np.where(lengths > 0.0, lengths, 1.0)
        return unit

    def jacobian(self, outer: np.ndarray | sparray) -> np.ndarray | sparray:
        """F' (m, n) in these units, from that of the user, ``outer``, dense or sparse."""
        if isinstance(outer, np.ndarray):
            return self.weights[:, None] * outer * self.sizes
        from scipy.sparse import csc_array

        inner = csc_array(outer, copy=True)
        by_column = np.repeat(self.sizes, np.diff(inner.indptr))
        inner.data = self.weights[inner.indices] * inner.data * by_column
        return inner
