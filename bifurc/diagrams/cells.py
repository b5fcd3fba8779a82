"""Parts of a curve on which the zeros of a function are plain.

A function of the arclength is sampled at Chebyshev nodes of a part, and the part is
halved until its interpolant (Trefethen 2013, chapters 3 and 7) shows that there is no
zero on it, or that the function is monotone, or that only rounding is left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev

AlongCurve: TypeAlias = Callable[[np.ndarray], np.ndarray]

COUNT = 20  # nodes of a part, both ends among them
LAST = 4  # coefficients that show whether the nodes are enough
SAFETY = 4.0  # times the coefficients of the upper half, for what is left out
RESOLVED = 1e-12  # of the size on a part: so small the last coefficients are rounding
TOLERANCE = 1e-12  # of the typical size on a piece: less is no more than rounding
NOISE = 1e-6  # of that size: noise is no larger
STAYS = 0.6  # times the last coefficients: noise does not shrink with a part
ROUNDING_OF_NOISE = 10.0  # times the last coefficients
NARROWEST = 1e-13  # of the length of the curve
MOST_CELLS = 4000  # parts that are looked at, and PER_PIECE more a piece
PER_PIECE = 40

X = -np.cos(np.pi * np.arange(COUNT) / (COUNT - 1))
_SERIES = chebyshev.chebvander(X, COUNT - 1)
_TO_COEFFICIENTS = np.linalg.inv(_SERIES)
_DERIVATIVE = chebyshev.chebder(np.eye(COUNT))  # (COUNT - 1, COUNT), of coefficients


class CellKind(Enum):
    """What a function does on a part of a curve."""

    # It is not zero.
    CLEAR = "clear"
    # It is zero at most once.
    MONOTONE = "monotone"
    # It is zero as far as rounding tells.
    FLAT = "flat"
    # It is exactly zero at all nodes.
    ZERO = "zero"
    # It is known to noise.
    NOISY = "noisy"
    # It jumps, or is steeper than nodes can show.
    ROUGH = "rough"
    # It is not defined.
    UNDEFINED = "undefined"
    # The limit of parts was reached.
    OPEN = "open"


class Cell(NamedTuple):
    """A part from ``low`` to ``high``, ``values`` (COUNT,) at its ``places`` (COUNT,),
    and the ``rounding`` below which a value is no more than that."""

    low: float
    high: float
    kind: CellKind
    places: np.ndarray
    values: np.ndarray
    rounding: float


@dataclass(frozen=True)
class _Parts:
    """Parts (k,) that are looked at together: their ends, the typical ``size`` on the
    pieces in which they lie, and the last coefficients (``tails``) of the parts of which
    they are halves."""

    low: np.ndarray
    high: np.ndarray
    size: np.ndarray
    tails: np.ndarray

    @property
    def places(self) -> np.ndarray:
        """Chebyshev nodes (k, COUNT)."""
        middle, half = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        places: np.ndarray = middle[:, None] + half[:, None] * X
        places[:, 0], places[:, -1] = self.low, self.high
        return places

    def halves(self, of: np.ndarray, tails: np.ndarray) -> _Parts:
        """Both halves of the parts ``of`` (k,)."""
        low, high = self.low[of], self.high[of]
        middle = 0.5 * (low + high)
        return _Parts(
            np.concatenate([low, middle]),
            np.concatenate([middle, high]),
            np.tile(self.size[of], 2),
            np.tile(tails[of], 2),
        )


def cells_along(
    breaks: np.ndarray, function: AlongCurve, rounding: float
) -> list[Cell]:
    """Parts, in order, of a curve whose pieces begin and end at ``breaks`` (p + 1,).

    ``function`` maps arclengths (k,) to values (k,), known to ``rounding``.
    """
    count = len(breaks) - 1
    narrowest = NARROWEST * float(breaks[-1] - breaks[0])
    left = MOST_CELLS + PER_PIECE * count
    size, tails = np.zeros(count), np.full(count, np.inf)
    parts = _Parts(breaks[:-1], breaks[1:], size, tails)
    cells: list[Cell] = []
    while len(parts.low):
        places = parts.places
        values = function(places.ravel()).reshape(places.shape)
        if not cells and not np.any(parts.size):
            parts = replace(parts, size=_sizes(values, rounding))
        kinds, tails = _kinds_of(parts, values, narrowest)
        left -= len(places)
        ends_here = np.array([kind is not CellKind.OPEN for kind in kinds])
        ends_here |= left <= 0
        for k in np.flatnonzero(ends_here):
            noise = tails[k] if kinds[k] is CellKind.NOISY else 0.0
            hidden = max(TOLERANCE * parts.size[k], ROUNDING_OF_NOISE * noise)
            ends = float(parts.low[k]), float(parts.high[k])
            cells.append(Cell(*ends, kinds[k], places[k], values[k], hidden))
        parts = parts.halves(np.flatnonzero(~ends_here), tails)
    return sorted(cells, key=lambda cell: cell.low)


def _sizes(values: np.ndarray, rounding: float) -> np.ndarray:
    """Typical sizes (k,) of values (k, COUNT): the median, which a pole leaves as it is,
    the largest where most are 0, and more where ``rounding`` is."""
    finite = np.where(np.isfinite(values), np.abs(values), 0.0)
    median, largest = np.median(finite, axis=1), finite.max(axis=1)
    typical = np.where(median > 0.0, median, largest)
    return np.maximum(typical, rounding / TOLERANCE)


def _kinds_of(
    parts: _Parts, values: np.ndarray, narrowest: float
) -> tuple[list[CellKind], np.ndarray]:
    """What the function does on every part, and the last coefficients (k,) there; a
    part that is to be halved is `CellKind.OPEN`."""
    finite = np.isfinite(values)
    is_defined = finite.all(axis=1)
    known = np.where(finite, values, 0.0)
    coefficients = known @ _TO_COEFFICIENTS.T
    tails = np.abs(coefficients[:, -LAST:]).max(axis=1)
    slopes = coefficients @ _DERIVATIVE.T
    size = np.abs(known).max(axis=1)
    is_resolved = tails <= RESOLVED * np.maximum(size, parts.size)
    is_clear = _keeps_sign(coefficients)
    is_monotone = is_resolved & _keeps_sign(slopes)
    stays = (tails >= STAYS * parts.tails) & (tails <= NOISE * parts.size)
    tells = [
        (CellKind.UNDEFINED, ~finite.any(axis=1)),
        (CellKind.ZERO, is_defined & (size == 0.0)),
        (CellKind.FLAT, is_defined & (size <= TOLERANCE * parts.size)),
        (CellKind.CLEAR, is_defined & is_clear),
        (CellKind.MONOTONE, is_defined & is_monotone),
        (CellKind.NOISY, is_defined & stays & ~is_resolved),
        (CellKind.ROUGH, parts.high - parts.low <= narrowest),
    ]
    kinds = []
    for k in range(len(values)):
        kind = next((kind for kind, holds in tells if holds[k]), CellKind.OPEN)
        kinds.append(kind)
    return kinds, np.where(is_defined, tails, np.inf)


def _keeps_sign(coefficients: np.ndarray) -> np.ndarray:
    """Whether functions keep their signs (k,): the first of their coefficients (k, c) is
    larger than all others together can be, what they leave out included."""
    sizes = np.abs(coefficients)
    upper = sizes[:, sizes.shape[1] // 2 :].sum(axis=1)
    keeps: np.ndarray = sizes[:, 0] > sizes[:, 1:].sum(axis=1) + SAFETY * upper
    return keeps
