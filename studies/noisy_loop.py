"""A loop seen through rounding noise, inside its compiled kernels too."""

from __future__ import annotations

import numpy as np

from bifurc.noisy_problem import NoisyMethods, RoundingNoise
from linkages import Loop, LoopClosure
from linkages.kinematics import LinkTable, link_geometry


class NoisyLoop(Loop):
    """A loop whose lengths, twists and offsets are off by two units in the last place,
    anew whenever somebody reads them."""

    noise: RoundingNoise

    @property
    def arrays(self) -> LinkTable:
        """Lengths, twists (rad) and offsets (n,) with errors."""
        columns = (self.lengths, self.twists, self.offsets)
        floats = [np.array(column, dtype=float) for column in columns]
        return LinkTable(*(self.noise.relative(values) for values in floats))

    @property
    def link_geometry(self) -> np.ndarray:
        """What compiled kernels read of the links, (6, n), with errors."""
        geometry = link_geometry(self.arrays, self.characteristic_length)
        return self.noise.relative(geometry)


class NoisyLoopClosure(NoisyMethods, LoopClosure):
    """The closure of a noisy loop: each call of a kernel gets a geometry of its own."""

    loop: NoisyLoop

    def __init__(self, loop: NoisyLoop):
        super().__init__(loop)
        self.noise = loop.noise

    @property
    def _geometry(self) -> np.ndarray:
        return self.loop.link_geometry

    @_geometry.setter
    def _geometry(self, geometry: np.ndarray) -> None:
        """The geometry without errors is not used."""


def noisy_closure(loop: Loop, seed: int) -> LoopClosure:
    """The closure of ``loop`` seen through rounding noise drawn with ``seed``."""
    noisy = NoisyLoop(loop.lengths, loop.twists, loop.offsets, loop.name)
    object.__setattr__(noisy, "noise", RoundingNoise(seed))
    return NoisyLoopClosure(noisy)
