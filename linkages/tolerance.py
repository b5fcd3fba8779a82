"""A loop as a workshop makes it: every entry of its table a little off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkages.loop import Loop
from linkages.values import GeometryError


def make_with_errors(loop: Loop, error: float, rng: np.random.Generator) -> Loop:
    """The loop with normally distributed errors in all its entries, independent of each
    other.

    ``error`` is their standard deviation: in rad for twists, in characteristic lengths
    for lengths and offsets, also for those that are zero. The same generator with
    another ``error`` gives the same errors to another scale.
    """
    if not (np.isfinite(error) and error >= 0.0):
        raise GeometryError("error", error, "a finite number, not negative")
    size = error * loop.characteristic_length
    nominal = loop.arrays
    # in this order, so that a seed keeps its meaning
    lengths = nominal.lengths + size * rng.normal(size=loop.n)
    twists = nominal.twists + error * rng.normal(size=loop.n)
    offsets = nominal.offsets + size * rng.normal(size=loop.n)
    return replace(
        loop,
        lengths=tuple(lengths.tolist()),
        twists=tuple(twists.tolist()),
        offsets=tuple(offsets.tolist()),
    )
