"""Mixed cells: solutions of polynomials with given monomials and generic coefficients,
at the far end of paths on which the coefficients come from where two terms of each
polynomial outweigh the others.

So many paths there are as the volume of the cells, which is the number of solutions
without zeros (Bernstein 1975, Kushnirenko 1976 and Khovanskii 1978). Where coefficients
are multiplied by exp(-h), with heights h that are zero for two points of each support at
a cell and positive for the others, solutions are near those of the two terms while
heights are large, and move with them to 0 (Huber and Sturmfels 1995).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from bifurc import _core
from bifurc.limits import Deadline
from bifurc.paths.homogeneous import Exponents

SLIGHT = 1e-14  # over the two terms: all others where paths begin
TRIES = 5  # lifts that are drawn until no two points meet at once


class CellsEnd(IntEnum):
    """How an enumeration ended; the numbers are those of the compiled one."""

    ALL = 0
    NOT_GENERIC = 1
    TOO_LARGE = 2
    OUT_OF_TIME = 3


@dataclass(frozen=True, eq=False)
class MixedCells:
    """The mixed cells of supports of t points in n directions.

    Each of c cells has two points of each support, by their numbers among all, ``first``
    (c, n) and ``second`` (c, n), and a volume, ``volumes`` (c,): that of the edges between
    them, of which ``inverses`` (c, n, n) are the inverse matrices times the volume. The
    other points are ``heights`` (c, t) above these.
    """

    first: np.ndarray
    second: np.ndarray
    inverses: np.ndarray
    volumes: np.ndarray
    heights: np.ndarray

    @staticmethod
    def of(
        supports: Sequence[Sequence[Exponents]],
        rng: np.random.Generator,
        deadline: Deadline,
        most: int,
    ) -> MixedCells | None:
        """Those of a random subdivision; None where there is more than a volume of
        ``most``, or there was no time."""
        exponents = np.array([one for support in supports for one in support], int)
        sizes = np.array([len(support) for support in supports])
        t, n = exponents.shape
        for _ in range(TRIES):
            lifts = rng.random(t + n * (n + 1))
            end, first, second, *others = _core.mixed_cells(
                exponents, sizes, lifts, most, deadline.left
            )
            if end != CellsEnd.NOT_GENERIC:
                break
        if end != CellsEnd.ALL:
            return None
        before = np.cumsum(sizes) - sizes
        return MixedCells(first + before, second + before, *others)

    @property
    def volume(self) -> int:
        """That of all cells."""
        return int(self.volumes.sum())

    def starts(self, coefficients: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) of the two terms with ``coefficients`` (t,), and the heights
        (k, t) from which paths lead to those of all terms."""
        points = [np.empty((0, self.first.shape[1]), dtype=complex)]
        heights = [np.empty((0, len(coefficients)))]
        for cell in range(len(self.volumes)):
            volume, inverse = int(self.volumes[cell]), self.inverses[cell]
            ratios = -coefficients[self.first[cell]] / coefficients[self.second[cell]]
            logarithm = inverse @ np.log(ratios) / volume
            turns = 2j * np.pi * _fractions(inverse, volume)
            points.append(np.exp(logarithm + turns))
            height = self.heights[cell]
            least = height.min(where=height > 0.0, initial=np.inf)
            scaled = height * (-np.log(SLIGHT) / least)
            heights.append(np.broadcast_to(scaled, (volume, len(scaled))))
        return np.concatenate(points), np.concatenate(heights)


def _fractions(inverse: np.ndarray, volume: int) -> np.ndarray:
    """The sums (volume, n) of columns of an inverse, over its ``volume``, up to whole
    numbers."""
    group = {(0,) * len(inverse)}
    for column in inverse.T:
        multiples = column * np.arange(volume)[:, None] % volume
        distinct = np.unique(multiples, axis=0)
        sums = (np.array(list(group))[:, None] + distinct) % volume
        group = set(map(tuple, sums.reshape(-1, len(inverse)).tolist()))
    return np.array(sorted(group)) / volume
