"""Configurations of a network at given locks, complete on a grid, by its closed form.

A lock holds the sum of the angles that the cells have at its axis. A sum in which one
cell is open determines that cell, for every angle of a cell turns once as its state
turns once. So a few cells are given, the others follow one after the other, and the
sums that are left over are equations in one angle, whose roots are bracketed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_dependent_lock, is_network_closed
from linkages.networks.network import Network, Sum, other_angle, wrap_angles

GRID = 24  # values of every cell that is given
FINE = 720  # intervals in which roots are looked for
HALVINGS = 60  # of an interval in which there is a root


class Equation(NamedTuple):
    """A sum that has to be ``value``, rad, modulo full turns."""

    total: Sum
    value: float

    @property
    def cells(self) -> frozenset[int]:
        """The numbers of the cells in it."""
        return frozenset(cell for cell, _ in self.total.corners)


class Step(NamedTuple):
    """A cell that follows from an equation in which it alone is open."""

    cell: int
    equation: Equation


@dataclass(frozen=True)
class Order:
    """An order of assembly: cells that are ``given``, ``steps`` that follow, and the
    equations that are left to ``check``."""

    given: tuple[int, ...]
    steps: tuple[Step, ...]
    check: tuple[Equation, ...]


def constraints_of(network: Network, locks: Mapping[str, float]) -> list[Equation]:
    """The equations of a network whose joints are locked at D-H angles, rad; raises
    `GeometryError` for what is no axis of the ring."""
    equations = [Equation(total, 0.0) for total in network.closures]
    for axis, value in locks.items():
        network.require_axis(axis, "lock")
        equations.append(Equation(network.turns[axis], value))
    return equations


def assemble(network: Network, locks: Mapping[str, float]) -> np.ndarray:
    """States (k, c) of the cells at these locks (rad), on a grid over every motion.

    On a motion of one freedom the grid is that of one cell, with every state of the
    others at it. Empty where there is no real configuration.
    """
    equations = constraints_of(network, locks)
    cells = range(len(network.plan.cells))
    orders = (
        _order_from(given, equations)
        for count in range(len(cells) + 1)
        for given in combinations(cells, count)
    )
    # with all cells given none is open
    order = next(one for one in orders if len(one.given + one.steps) == len(cells))
    assembly = _Assembly(network, order)
    is_scanned = bool(order.check and order.given)
    gridded = len(order.given) - is_scanned
    circle = np.linspace(-np.pi, np.pi, GRID, endpoint=False) + 0.1
    rows = list(product(circle, repeat=gridded))
    grid = np.array(rows).reshape(GRID**gridded, gridded)
    if is_scanned:
        return np.concatenate([assembly.scan(row) for row in grid])
    return assembly.that_hold(assembly.follow(grid))


# --- order ----------------------------------------------------------------------------


def _order_from(given: tuple[int, ...], equations: Sequence[Equation]) -> Order:
    known = set(given)
    left = list(equations)
    steps: list[Step] = []
    while True:
        ready = [one for one in left if len(one.cells - known) == 1]
        if not ready:
            break
        equation = ready[0]
        (cell,) = equation.cells - known
        steps.append(Step(cell, equation))
        known.add(cell)
        left.remove(equation)
    return Order(given, tuple(steps), tuple(left))


@dataclass(frozen=True)
class _Assembly:
    """A ``network`` that is assembled in an ``order``."""

    network: Network
    order: Order

    def follow(self, given: np.ndarray) -> np.ndarray:
        """States (k, c) from those of the cells that are given (k, g)."""
        network = self.network
        states = np.zeros((len(given), len(network.plan.cells)))
        states[:, list(self.order.given)] = given
        for cell, (total, value) in self.order.steps:
            (corner,) = (number for of, number in total.corners if of == cell)
            others = tuple(place for place in total.corners if place[0] != cell)
            rest = value - network.sums(Sum(total.constant, others), states)
            turned = rest if corner < 2 else -rest
            if corner % 2 == 0:
                turned = other_angle(network.factors[cell], turned)
            states[:, cell] = turned
        return states

    def scan(self, given: np.ndarray) -> np.ndarray:
        """The states (k, c) that satisfy all equations, the last given cell being open
        and the others at ``given``."""
        values = _circle(self.network.factors[self.order.given[-1]])
        for one in self.order.check:
            gaps = self._gaps(one, self.follow(_rows(given, values)))
            if not is_network_closed(np.abs(gaps).max()):
                roots = self._roots(given, values, gaps, one)
                return self.that_hold(self.follow(_rows(given, roots)))
        return self.follow(_rows(given, values[:: len(values) // GRID]))

    def that_hold(self, states: np.ndarray) -> np.ndarray:
        """Those of the states (k, c) that satisfy the equations left to check."""
        holds = np.ones(len(states), dtype=bool)
        for one in self.order.check:
            holds &= is_network_closed(np.abs(self._gaps(one, states)))
        return states[holds]

    def _gaps(self, one: Equation, states: np.ndarray) -> np.ndarray:
        """By how much an equation is missed (k,) at states (k, c)."""
        return wrap_angles(self.network.sums(one.total, states) - one.value)

    def _roots(
        self, given: np.ndarray, values: np.ndarray, gaps: np.ndarray, one: Equation
    ) -> np.ndarray:
        """The values of the open cell at which an equation holds, by bisection of every
        interval in which its gap changes sign."""
        signs = gaps[:-1] * gaps[1:] <= 0
        # where the gap passes half a turn it changes sign as well
        near = np.abs(gaps[:-1]) + np.abs(gaps[1:]) < np.pi
        places = np.flatnonzero(signs & near)
        low, high = values[places], values[places + 1]
        at_low = gaps[places]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            at_middle = self._gaps(one, self.follow(_rows(given, middle)))
            is_below = at_low * at_middle > 0
            low = np.where(is_below, middle, low)
            at_low = np.where(is_below, at_middle, at_low)
            high = np.where(is_below, high, middle)
        roots: np.ndarray = 0.5 * (low + high)
        return roots


def _circle(factor: float) -> np.ndarray:
    """States of a cell all around, fine in both its angles, the first one again at the
    end."""
    even = np.linspace(-np.pi, np.pi, FINE, endpoint=False) + 0.1
    both = np.concatenate([even, other_angle(factor, even)])
    values = np.unique(np.mod(both, 2 * np.pi))
    return np.append(values, values[0] + 2 * np.pi)


def _rows(given: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The given cells (g,) beside each of the values (k,): (k, g + 1)."""
    return np.column_stack([np.tile(given, (len(values), 1)), values])


# --- motion ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Motion:
    """What a network can do at a configuration with joints locked: the velocities
    (c, m) of its cells, and how much they make every joint of the ring turn (n, m)."""

    cells: np.ndarray
    ring: np.ndarray

    @property
    def mobility(self) -> int:
        """How many freedoms are left."""
        return int(self.cells.shape[1])

    def still(self, axes: Sequence[str]) -> tuple[str, ...]:
        """Those of the axes of the ring at which nothing turns."""
        sizes = np.linalg.norm(self.ring, axis=1)
        at_rest = is_dependent_lock(sizes)
        return tuple(axis for axis, rests in zip(axes, at_rest, strict=True) if rests)


def motion_at(network: Network, locks: Sequence[str], states: np.ndarray) -> Motion:
    """What is left of the motion of a network at states (c,), with the axes ``locks``
    held where they are."""
    totals = [*network.closures, *(network.turns[axis] for axis in locks)]
    cells = np.eye(len(network.plan.cells))
    if totals:
        rows = np.array([network.rates(total, states) for total in totals])
        _, values, right = np.linalg.svd(rows)
        rank = int(np.count_nonzero(~is_dependent_lock(values)))
        cells = right[rank:].T
    turns = [network.rates(total, states) for total in network.turns.values()]
    return Motion(cells, np.array(turns) @ cells)
