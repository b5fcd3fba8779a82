"""A loop seen through rounding noise, inside its compiled kernels too."""

from __future__ import annotations

import numpy as np

from bifurc.noisy_problem import NoisyMethods, RoundingNoise
from linkages import Closure, Loop
from linkages.closure.loop_parts import ScrewSystem
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


class NoisyScrews(ScrewSystem):
    """The screws of a noisy loop: each call of a kernel gets a geometry of its own."""

    loop: NoisyLoop

    @property
    def geometry(self) -> np.ndarray:
        """What the kernels read of the links, with errors."""
        return self.loop.link_geometry

    @geometry.setter
    def geometry(self, geometry: np.ndarray) -> None:
        """The geometry without errors is not used."""


class NoisyClosure(NoisyMethods, Closure):
    """The closure of a noisy loop."""

    def __init__(self, loop: NoisyLoop):
        super().__init__(loop)
        self.compiled = NoisyScrews(loop, self.domain)
        self.noise = loop.noise


def noisy_closure(loop: Loop, seed: int) -> Closure:
    """The closure of ``loop`` seen through rounding noise drawn with ``seed``."""
    noisy = NoisyLoop(loop.lengths, loop.twists, loop.offsets, loop.name)
    object.__setattr__(noisy, "noise", RoundingNoise(seed))
    return NoisyClosure(noisy)
