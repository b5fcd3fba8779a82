"""Parameters of a catalogue entry that stand in its table as they are.

`plain_parameters` finds out which and where, by building two members. For the others
the entry has ``guesses``, or a ``scan``, see `linkages.entry.Entry`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from math import pi

import numpy as np

from linkages.entry import Entry, Parameter, ParameterKind
from linkages.identification.equivalence import table
from linkages.loop import Loop

NUDGES = (0.011, 0.023)  # relative, of the two members that are compared
SAME = 1e-13  # a parameter and a number of the table that are one


class Row(Enum):
    """The rows of a table."""

    LENGTHS = 0
    TWISTS = 1
    OFFSETS = 2


@dataclass(frozen=True)
class Place:
    """Where a parameter stands in the table: as it is, or, a twist modulo pi, with the
    ``sign`` -1."""

    row: Row
    column: int
    sign: int = 1

    def gap(self, value: float, values: np.ndarray) -> float:
        """How far a parameter is from the number at the place in a table (3, n)."""
        gap = float(self.sign * value - values[self.row.value, self.column])
        return abs(np.sin(gap)) if self.row is Row.TWISTS else abs(gap)


def plain_parameters(entry: Entry) -> dict[str, Place]:
    """The places of all parameters that stand in the table as they are, by name."""
    return plain_places(entry.construct, entry.parameters)


@cache
def plain_places(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...]
) -> dict[str, Place]:
    """The same for a constructor and its parameters."""
    members = []
    for nudge in NUDGES:
        # each differs from its default by its own part
        values = {
            p.name: p.default * (1 + nudge * i / (i + 1))
            for i, p in enumerate(parameters, start=1)
        }
        members.append((values, table(construct(**values))))
    places = {}
    for parameter in parameters:
        for place in _possible_places(parameter, members[0][1].shape[1]):
            gaps = [place.gap(values[parameter.name], made) for values, made in members]
            if max(gaps) < SAME:
                places[parameter.name] = place
                break
    return places


def _possible_places(parameter: Parameter, n: int) -> Iterator[Place]:
    if parameter.kind is ParameterKind.ANGLE:
        for column, sign in itertools.product(range(n), (1, -1)):
            yield Place(Row.TWISTS, column, sign)
        return
    for row, column in itertools.product((Row.LENGTHS, Row.OFFSETS), range(n)):
        yield Place(row, column)


def plain_guess(entry: Entry, form: np.ndarray) -> dict[str, float]:
    """The parameters that stand in the table ``form`` (3, n), which is in normal
    form."""
    out = {}
    for name, place in plain_parameters(entry).items():
        value = float(form[place.row.value, place.column])
        out[name] = value if place.sign > 0 else (-value) % pi
    return out
