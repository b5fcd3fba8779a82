"""Lattices of Bennett linkages, locked such that one freedom is left (Chen and You 2005;
Song 2013, section 5.4, which has the one of four cells).

All links along a column of cells are one, and so are those along a row, with the twist
over the length of Bennett's condition the same for all. A lattice of c x r cells has c + r
- 1 freedoms: the angles about every axis inside add up. Joints on two sides are locked, one
where two columns or two rows meet, and one angle is left. Its closed form takes cell by
cell: `linkages.networks.network`.
"""

from __future__ import annotations

import numpy as np

from linkages.construction.link import Link
from linkages.mechanisms.mechanism import Mechanism
from linkages.networks.assembly import assemble
from linkages.networks.network import Network
from linkages.networks.placement import PlacedNetwork
from linkages.networks.plan import Cell, Plan

# twists (rad) of the first column and the first row, and the spread of the others
ALPHA, BETA, SPREAD = np.radians([35.0, 70.0, 10.0]).tolist()
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)  # its multiples, modulo 1, are spread
# Joints are locked nearly folded, to one side and to the other: where they are straight a
# cell turns some three times as fast as the one before it, the last of 100 1.6e6 times.
KINK = np.radians(170.0)
STATE = 3  # number of the state, of those round the motion, that is the reference


def locked_lattice(
    columns: int,
    rows: int,
    alpha: float = ALPHA,
    beta: float = BETA,
    spread: float = SPREAD,
) -> Mechanism:
    """The lattice of so many cells with one freedom left, in a configuration of its
    closed form; twists in rad."""
    network = lattice(columns, rows, alpha, beta, spread)
    kinks = lattice_kinks(columns, rows)
    states = assemble(network, kinks)
    return PlacedNetwork(network, states[STATE], kinks).mechanism


def lattice(
    columns: int,
    rows: int,
    alpha: float = ALPHA,
    beta: float = BETA,
    spread: float = SPREAD,
) -> Network:
    """The network of so many Bennett loops, all of a different shape; twists in rad."""
    cells = []
    for j in range(rows):
        for i in range(columns):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            first, second, third, fourth = (_axis(*corner) for corner in corners)
            name = f"{i}/{j}"
            axes = (first, second, third, fourth)
            cells.append(Cell(name, axes, (f"h{i}", f"v{j}")))
    inside = [_axis(i, j) for j in range(1, rows) for i in range(1, columns)]
    plan = Plan(
        "bennett-array",
        f"{columns} x {rows} Bennett loops",
        _ring(columns, rows),
        tuple(cells),
        tuple(inside),
    )
    links = {f"h{i}": _link(alpha, spread, i) for i in range(columns)}
    links |= {f"v{j}": _link(beta, spread, j) for j in range(rows)}
    return Network(plan, links)


def lattice_kinks(columns: int, rows: int) -> dict[str, float]:
    """The angles (rad) at which joints of two sides are locked, by their axes."""
    kinks = {_axis(i, 0): KINK * (-1) ** i for i in range(1, columns)}
    return kinks | {_axis(0, j): KINK * (-1) ** j for j in range(1, rows)}


def _axis(column: int, row: int) -> str:
    return f"c{column}r{row}"


def _ring(columns: int, rows: int) -> tuple[str, ...]:
    """The axes of the outer loop, in the sense in which every cell is passed."""
    corners = [(i, 0) for i in range(columns)]
    corners += [(columns, j) for j in range(rows)]
    corners += [(i, rows) for i in range(columns, 0, -1)]
    corners += [(0, j) for j in range(rows, 0, -1)]
    return tuple(_axis(*corner) for corner in corners)


def _link(first: float, spread: float, number: int) -> Link:
    """A link of Bennett ratio 1: its length is the sine of its twist."""
    twist = first + spread * float(number * GOLDEN % 1.0)
    return Link(float(np.sin(twist)), twist)
