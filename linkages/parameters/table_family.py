"""A table of Denavit and Hartenberg as a family, whose parameters are its entries."""

from __future__ import annotations

import math

from linkages.construction.numbers import Number
from linkages.entry import Entry, Parameter, ParameterKind
from linkages.loop import Loop

ANGLE = math.radians(30.0)  # to either side, where no range is given
SHARE = 0.5  # the same of a length or an offset; 0 of the characteristic length


def family_of_table(loop: Loop) -> Entry:
    """The loops whose table is that of ``loop`` but for some entries: a12 is the length of
    link 12, alpha12 (rad) its twist, and R1 the offset of joint 1. No condition is kept."""
    n = loop.n
    links = [f"{k}{k % n + 1}" for k in range(1, n + 1)]
    parameters = []
    for k, (length, twist, offset) in enumerate(zip(*loop.arrays, strict=True)):
        link, room = f"link {links[k]}", loop.characteristic_length
        parameters += [
            table_parameter(f"a{links[k]}", length, f"length of {link}", room),
            table_parameter(f"alpha{links[k]}", twist, f"twist of {link}"),
            table_parameter(f"R{k + 1}", offset, f"offset of joint {k + 1}", room),
        ]

    def construct(**values: Number) -> Loop:
        return Loop(
            lengths=tuple(values[f"a{link}"] for link in links),
            twists=tuple(values[f"alpha{link}"] for link in links),
            offsets=tuple(values[f"R{k}"] for k in range(1, n + 1)),
        )

    name = loop.name or "linkage"
    return Entry(name, "", name, "", construct, tuple(parameters))


def table_parameter(
    name: str, entry: float, meaning: str, size: float = 0.0
) -> Parameter:
    """An entry of a table, of a loop of this ``size`` unless it is an angle, with the
    range that it has where none is given."""
    value = float(entry)
    kind = ParameterKind.LENGTH if size else ParameterKind.ANGLE
    room = SHARE * (abs(value) or size) if size else ANGLE
    return Parameter(name, value, kind, meaning, value - room, value + room)
