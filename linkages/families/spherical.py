"""Spherical four-bar: four axes through one point, for comparison with the Bennett
linkage."""

from __future__ import annotations

from linkages.construction.link import Link, closed_chain
from linkages.construction.numbers import Number
from linkages.construction.table_equations import zero_lengths, zero_offsets
from linkages.entry import Condition, Entry, Parameter
from linkages.loop import Loop

POSITION = 20


def spherical_four_bar(
    alpha12: Number, alpha23: Number, alpha34: Number, alpha41: Number
) -> Loop:
    """Spherical 4R: lengths and offsets zero, twists (rad) free. Source: Savage (1972),
    among others."""
    twists = (alpha12, alpha23, alpha34, alpha41)
    return closed_chain(*(Link(0, twist) for twist in twists))


def _twist(link: int, degrees: float) -> Parameter:
    return Parameter.angle(f"alpha{link}", degrees, f"twist of link {link}", 60, 100)


ENTRIES = (
    Entry(
        "spherical-four-bar",
        "Spherical four-bar",
        "Savage (1972)",
        spherical_four_bar,
        (_twist(12, 65), _twist(23, 75), _twist(34, 85), _twist(41, 95)),
        conditions=(
            Condition("all lengths and offsets zero", (zero_lengths(), zero_offsets())),
        ),
        facts={"joints": 4, "mobility": 1},
    ),
)
