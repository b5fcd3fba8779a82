"""How Bennett loops are joined to a network: its axes, its bars and its ring."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Cell:
    """A Bennett loop of a network.

    Its four ``axes`` come in the sense in which the ring runs round it. The first of
    its ``links`` ("a" to "d") joins the first axis to the second one, and the third to
    the fourth; the second link joins the others.
    """

    name: str
    axes: tuple[str, str, str, str]
    links: tuple[str, str]

    def link(self, corner: int) -> str:
        """The link that leaves the corner of this number, from 0."""
        return self.links[corner % 2]


@dataclass(frozen=True)
class Corner:
    """A corner of the cell of this number: its number there, and the bars by which the
    cell comes to the axis and leaves it."""

    cell: int
    number: int
    arrival: str
    departure: str


@dataclass(frozen=True)
class Plan:
    """Cells with common links.

    The ``ring`` is the outer loop, by its axes. Around the axes ``inside`` the cells
    close.
    """

    name: str
    title: str
    ring: tuple[str, ...]
    cells: tuple[Cell, ...]
    inside: tuple[str, ...] = ()

    @property
    def axes(self) -> tuple[str, ...]:
        """All axes: those of the ring, then those inside."""
        return self.ring + self.inside

    @cached_property
    def bars(self) -> dict[str, str]:
        """The link that every bar is, by the name of the bar."""
        bars: dict[str, str] = {}
        for cell in self.cells:
            for corner in range(4):
                bars[self.bar(cell, corner)] = cell.link(corner)
        return bars

    def bar(self, cell: Cell, corner: int) -> str:
        """The bar that leaves a corner of a cell, called after its two axes: in the
        order of the ring if it lies in it, else the axis inside first."""
        first = cell.axes[corner % 4]
        second = cell.axes[(corner + 1) % 4]
        if self._follows(second, first):
            return first + second
        if self._follows(first, second):
            return second + first
        if (first in self.inside) != (second in self.inside):
            return first + second if first in self.inside else second + first
        return min(first, second) + max(first, second)

    def _follows(self, second: str, first: str) -> bool:
        """Whether the ring leads from the axis ``first`` to the axis ``second``."""
        if first not in self.ring:
            return False
        place = self.ring.index(first)
        return self.ring[(place + 1) % len(self.ring)] == second

    def ring_bar(self, place: int) -> str:
        """The bar of the ring that leaves its axis of this number, from 0."""
        count = len(self.ring)
        return self.ring[place % count] + self.ring[(place + 1) % count]

    def corners(self, axis: str) -> tuple[Corner, ...]:
        """The corners at an axis, each leaving by the bar by which the next one comes;
        on the ring they lead from its one bar to the other."""
        by_arrival = {}
        for number, cell in enumerate(self.cells):
            if axis in cell.axes:
                place = cell.axes.index(axis)
                arrival = self.bar(cell, place - 1)
                departure = self.bar(cell, place)
                by_arrival[arrival] = Corner(number, place, arrival, departure)
        bar = next(iter(by_arrival))
        if axis in self.ring:
            bar = self.ring_bar(self.ring.index(axis) - 1)
        corners = []
        while bar in by_arrival:
            corner = by_arrival.pop(bar)
            corners.append(corner)
            bar = corner.departure
        return tuple(corners)

    def bars_at(self, axis: str) -> tuple[str, ...]:
        """The bars on an axis: those of the ring as it passes them, then the others by
        name."""
        corners = self.corners(axis)
        bars = {corner.arrival for corner in corners}
        bars |= {corner.departure for corner in corners}
        if axis not in self.ring:
            return tuple(sorted(bars))
        passed = (corners[0].arrival, corners[-1].departure)
        return passed + tuple(sorted(bars - set(passed)))


A = Cell("A", ("8", "1", "2", "0"), ("c", "a"))
B = Cell("B", ("2", "3", "4", "0"), ("b", "c"))
C = Cell("C", ("4", "5", "6", "0"), ("d", "b"))
D = Cell("D", ("6", "7", "8", "0"), ("a", "d"))

FOUR_BENNETT = Plan(
    "four-bennett-network",
    "Four Bennett loops around a common axis",
    ("1", "2", "3", "4", "5", "6", "7", "8"),
    (A, B, C, D),
    ("0",),
)
L_SHAPE = Plan(
    "l-shape-bennett-network",
    "Three Bennett loops around a common axis",
    ("8", "1", "2", "3", "4", "5", "6", "0"),
    (A, B, C),
)
SERIAL = Plan(
    "serial-bennett-network",
    "Three Bennett loops in a row",
    ("U0", "U1", "U2", "U3", "V3", "V2", "V1", "V0"),
    (
        Cell("A", ("U0", "U1", "V1", "V0"), ("a", "d")),
        Cell("B", ("U1", "U2", "V2", "V1"), ("b", "d")),
        Cell("C", ("U2", "U3", "V3", "V2"), ("c", "d")),
    ),
)
PLANS = {plan.name: plan for plan in (FOUR_BENNETT, L_SHAPE, SERIAL)}
