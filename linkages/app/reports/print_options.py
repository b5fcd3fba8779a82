"""The options of printed parts."""

from __future__ import annotations

from dataclasses import dataclass

import click

from linkages.app.options import Command, NumberRange, with_record

POSITIVE = NumberRange(min=0, min_open=True)
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}  # mm


@dataclass(frozen=True)
class PrintOptions:
    """How parts are printed: what stands on the command line, mm; None for what does
    not stand there."""

    diameter: float | None = None
    play: float | None = None
    wall: float | None = None
    size: float | None = None
    unit: str | None = None
    offsets: str | None = None

    @property
    def unit_in_mm(self) -> float | None:
        """The unit of the linkage, where one is given."""
        return None if self.unit is None else UNITS[self.unit]


OPTIONS = {
    "diameter": click.option(
        "--diameter",
        type=POSITIVE,
        metavar="MM",
        help="For .stl and .step: diameter of the rods.  [default: 6]",
    ),
    "play": click.option(
        "--play",
        type=POSITIVE,
        metavar="MM",
        help=(
            "For .stl and .step: gap between surfaces that turn on each other, and "
            "the least one between parts on the way.  [default: 0.3]"
        ),
    ),
    "wall": click.option(
        "--wall",
        type=POSITIVE,
        metavar="MM",
        help="For .stl and .step: least thickness of a wall.  [default: 1.2]",
    ),
    "size": click.option(
        "--size",
        type=POSITIVE,
        metavar="MM",
        help=(
            "For .stl and .step: the linkage's mean length of a link.  [default: 100]"
        ),
    ),
    "unit": click.option(
        "--unit",
        type=click.Choice(list(UNITS)),
        help="For .stl and .step: the unit of the linkage's lengths, instead of --size.",
    ),
    "offsets": click.option(
        "--offsets",
        metavar="MM,MM,...",
        help=(
            "For .stl and .step: where each hinge sits along its axis, from the foot "
            "of the common normal before it.  [default: so that no parts meet]"
        ),
    ),
}


def print_options(command: Command) -> Command:
    """``command`` with the options of printed parts, which it takes as one
    `PrintOptions` called ``printing``."""

    return with_record(command, "printing", PrintOptions, OPTIONS)
