"""Spherical four-bar: four axes through one point, for comparison with the Bennett
linkage."""

from __future__ import annotations

from math import radians
from typing import Any

from linkages.construction.link import Link, closed_chain
from linkages.entry import Entry, Parameter
from linkages.loop import Loop

__all__ = ["ENTRIES", "spherical_four_bar"]


def spherical_four_bar(alpha12: Any, alpha23: Any, alpha34: Any, alpha41: Any) -> Loop:
    """Spherical 4R: lengths and offsets zero, twists (rad) free. Source: Savage (1972),
    among others."""
    return closed_chain(
        *(Link(0, twist) for twist in (alpha12, alpha23, alpha34, alpha41))
    )


ENTRIES = (
    Entry(
        "spherical-four-bar",
        "Spherical four-bar",
        "Savage (1972)",
        spherical_four_bar,
        tuple(
            Parameter(
                f"alpha{k}",
                radians(v),
                "angle",
                f"twist of link {k}",
                radians(60),
                radians(100),
            )
            for k, v in ((12, 65), (23, 75), (34, 85), (41, 95))
        ),
        ("all lengths and offsets zero",),
        facts={"joints": 4, "mobility": 1},
    ),
)
