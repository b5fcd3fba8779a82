"""A linkage as a workshop makes it: every entry of its table a little off."""

from __future__ import annotations

import numpy as np

from linkages.loop import GeometryError, Loop

__all__ = ["make_with_errors"]


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
    units = (size, error, size)
    lengths, twists, offsets = (
        tuple((values + unit * rng.normal(size=loop.n)).tolist())
        for values, unit in zip(loop.arrays, units, strict=True)
    )
    return Loop(lengths, twists, offsets, loop.name)
