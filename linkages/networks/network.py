"""A network of Bennett loops of one ratio, and the closed form of all its motions.

The state of a cell is its angle p at its second corner, and v = 2 atan(K / tan(p/2)) is
that at its first one, K = sin((x + y)/2) / sin((x - y)/2) with the twists y of its
first link and x of its second; the other two angles are -v and -p. What the ring turns
by at an axis is the sum over the cells there, each with half a turn, less half a turn;
around an axis inside, the sum is 0. Angles are D-H angles, in rad.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import pi
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bifurc.torus import wrap
from linkages.construction.link import (
    Link,
    bennett_links,
    closed_chain,
    half_angle_ratio,
)
from linkages.construction.numbers import Number
from linkages.loop import Loop
from linkages.networks.plan import Plan
from linkages.values import quoted, require

TWISTS = ("alpha", "beta", "gamma", "delta")


class Sum(NamedTuple):
    """The sum of a ``constant`` and of angles of cells, each the corner of this number
    in the cell of this number."""

    constant: float
    corners: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Network:
    """A plan with its ``links`` "a" to "d", and the ``parameters`` that made them."""

    plan: Plan
    links: Mapping[str, Link] = field(hash=False)
    parameters: Mapping[str, float] = field(default_factory=dict, hash=False)

    @property
    def name(self) -> str:
        """What the network is called."""
        return self.plan.name

    @cached_property
    def factors(self) -> np.ndarray:
        """K (c,) of every cell."""
        factors = []
        for cell in self.plan.cells:
            first, second = (self.links[name] for name in cell.links)
            factors.append(float(half_angle_ratio(second.twist, first.twist)))
        return np.array(factors)

    # --- angles -----------------------------------------------------------------------

    def corner_angles(self, states: np.ndarray) -> np.ndarray:
        """The angles (..., c, 4) at the corners of all cells for states (..., c), modulo
        full turns."""
        states = np.asarray(states, dtype=float)
        first = other_angle(self.factors, states)
        return np.stack([first, states, -first, -states], axis=-1)

    def corner_rates(self, states: np.ndarray) -> np.ndarray:
        """The derivatives (..., c, 4) of `corner_angles` by the state of the cell."""
        sine = np.sin(np.asarray(states, dtype=float) / 2)
        cosine = np.cos(np.asarray(states, dtype=float) / 2)
        first = -self.factors / (sine**2 + (self.factors * cosine) ** 2)
        one = np.ones_like(first)
        return np.stack([first, one, -first, -one], axis=-1)

    @cached_property
    def turns(self) -> Mapping[str, Sum]:
        """What the ring turns by at each of its axes, by name."""
        return MappingProxyType(
            {axis: self._sum_at(axis, less=1) for axis in self.plan.ring}
        )

    @cached_property
    def closures(self) -> tuple[Sum, ...]:
        """The sums that are 0, modulo a full turn, for the network to close."""
        return tuple(self._sum_at(axis, less=0) for axis in self.plan.inside)

    def _sum_at(self, axis: str, less: int) -> Sum:
        """The sum over the cells at an axis, each with half a turn, but for as many as
        ``less`` says."""
        corners = self.plan.corners(axis)
        places = tuple((corner.cell, corner.number) for corner in corners)
        return Sum(pi * (len(corners) - less), places)

    def sums(self, total: Sum, states: np.ndarray) -> np.ndarray:
        """The values (...,) of a sum at states (..., c)."""
        angles = self.corner_angles(states)
        values = np.full(angles.shape[:-2], total.constant)
        for cell, corner in total.corners:
            values = values + angles[..., cell, corner]
        return values

    def rates(self, total: Sum, states: np.ndarray) -> np.ndarray:
        """The derivatives (..., c) of a sum by the states (..., c)."""
        of_corners = self.corner_rates(states)
        rates = np.zeros(of_corners.shape[:-1])
        for cell, corner in total.corners:
            rates[..., cell] += of_corners[..., cell, corner]
        return rates

    def ring_angles(self, states: np.ndarray) -> np.ndarray:
        """The joint angles (..., n) of the ring, between -pi and pi, at states (...,
        c)."""
        columns = [self.sums(total, states) for total in self.turns.values()]
        return wrap_angles(np.stack(columns, axis=-1))

    def require_axis(self, axis: str, what: str = "joint") -> None:
        """Raise `GeometryError` for what is no axis of the ring."""
        is_axis = axis in self.plan.ring
        allowed = f"one of the outer joints {', '.join(self.plan.ring)}"
        require(is_axis, f"{what} of {self.name}", quoted(axis), allowed)

    # --- loops ------------------------------------------------------------------------

    @cached_property
    def ring_loop(self) -> Loop:
        """The ring as a loop; its joints are the axes of the ring in their order."""
        bars = [self.plan.ring_bar(place) for place in range(len(self.plan.ring))]
        links = [self.links[self.plan.bars[bar]] for bar in bars]
        loop = closed_chain(*links)
        return replace(loop, name=f"ring of {self.name}")

    def cell_loop(self, number: int) -> Loop:
        """The Bennett loop of a cell."""
        cell = self.plan.cells[number]
        return closed_chain(*(self.links[cell.link(corner)] for corner in range(4)))


def wrap_angles(angles: np.ndarray | float) -> np.ndarray:
    """Angles of any shape, rad, between -pi and pi."""
    angles = np.asarray(angles, dtype=float)
    return wrap(angles[..., None], np.array([2 * pi]))[..., 0]


def other_angle(factor: np.ndarray | float, angle: np.ndarray) -> np.ndarray:
    """The angle v with tan(v/2) tan(angle/2) = ``factor``, modulo full turns."""
    half = np.asarray(angle) / 2
    return 2 * np.arctan2(factor * np.cos(half), np.sin(half))


def build_network(
    plan: Plan,
    a: Number,
    alpha: Number,
    beta: Number,
    gamma: Number,
    delta: Number,
    b: Number | None = None,
    c: Number | None = None,
    d: Number | None = None,
) -> Network:
    """The network with the length ``a`` and the twists ``alpha`` to ``delta`` (rad).

    The lengths ``b``, ``c``, ``d`` follow from the Bennett ratio, and are checked where
    they are given. Raises `GeometryError`; neighbouring links of a cell must have
    different twists, for a rhombus has no closed form.
    """
    links = bennett_links(a, alpha, b=(beta, b), c=(gamma, c), d=(delta, d))
    named = dict(zip("abcd", links, strict=True))
    parameters = {"a": float(a)}
    for name, twist in zip(TWISTS, (alpha, beta, gamma, delta), strict=True):
        parameters[name] = float(twist)
    network = Network(plan, named, parameters)
    assert len(network.factors) == len(plan.cells)  # computed, and so checked
    return network
