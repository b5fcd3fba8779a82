"""A linkage as a workshop makes it: every entry of its table, or every joint of a
mechanism on each of its bodies, a little off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bifurc.problem import Problem
from linkages.closure.closure import Closure
from linkages.closure.errors import draw_errors
from linkages.loop import Loop
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.structure import Structure
from linkages.values import GeometryError


def closure_with_errors(
    linkage: Loop | Mechanism, error: float, rng: np.random.Generator
) -> Problem:
    """The closure equations of a linkage made with errors, in the unknowns of its
    atlas: of a loop the joint angles, of a mechanism its joint variables.

    Those of a loop are the errors of `make_with_errors`, those of a mechanism are of
    `linkages.closure.errors.draw_errors`: out of the plane, too, where it is planar.
    Raises `GeometryError` for an ``error`` that is negative or not finite.
    """
    if isinstance(linkage, Loop):
        return Closure(make_with_errors(linkage, error, rng))
    structure = Structure(linkage)
    return Closure(linkage, draw_errors(structure, error, rng), structure)


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
