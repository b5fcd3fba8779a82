"""Parameters of a catalogue entry that stand in its table as they are.

`plain_parameters` finds out which and where, by building two members. For the others
the entry has ``guesses``, or a ``scan``, see `linkages.entry.Entry`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
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


class Sense(Enum):
    """What stands in the table for a parameter x."""

    SAME = "x"
    OPPOSITE = "-x"
    SUPPLEMENT = "pi - x"

    def of(self, x: float) -> float:
        """The number in the table for the parameter ``x``."""
        if self is Sense.OPPOSITE:
            return -x
        if self is Sense.SUPPLEMENT:
            return pi - x
        return x


@dataclass(frozen=True)
class Place:
    """Where a parameter stands in the table, and as what."""

    row: Row
    column: int
    sense: Sense


@dataclass(frozen=True)
class _Member:
    """Parameters and the table (3, n) that they make."""

    parameters: dict[str, float]
    table: np.ndarray


def plain_parameters(entry: Entry) -> dict[str, Place]:
    """The places of all parameters that stand in the table as they are, by name."""
    return _plain_parameters(entry.construct, entry.parameters)


@cache
def _plain_parameters(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...]
) -> dict[str, Place]:
    members = [_nudged_member(construct, parameters, nudge) for nudge in NUDGES]
    places = {}
    for parameter in parameters:
        place = _place(parameter, members)
        if place is not None:
            places[parameter.name] = place
    return places


def _nudged_member(
    construct: Callable[..., Loop], parameters: tuple[Parameter, ...], nudge: float
) -> _Member:
    """The member whose parameters differ from the defaults, each by its own part of
    ``nudge``."""
    values = {}
    for i, p in enumerate(parameters):
        values[p.name] = p.default * (1 + nudge * (i + 1) / (i + 2))
    return _Member(values, table(construct(**values)))


def _place(parameter: Parameter, members: list[_Member]) -> Place | None:
    """The first place where the parameter stands in all members; None for none."""
    n = members[0].table.shape[1]
    if parameter.kind is ParameterKind.ANGLE:
        choices = itertools.product([Row.TWISTS], range(n), Sense)
    else:
        rows = [Row.LENGTHS, Row.OFFSETS]
        choices = itertools.product(rows, range(n), [Sense.SAME])
    for row, column, sense in choices:
        place = Place(row, column, sense)
        gaps = [_gap(member, parameter.name, place) for member in members]
        if max(gaps) < SAME:
            return place
    return None


def _gap(member: _Member, name: str, place: Place) -> float:
    """How far the parameter is from the number at the place; angles modulo pi."""
    number = member.table[place.row.value, place.column]
    gap = float(place.sense.of(member.parameters[name]) - number)
    return abs(np.sin(gap)) if place.row is Row.TWISTS else abs(gap)


def plain_guess(entry: Entry, form: np.ndarray) -> dict[str, float]:
    """The parameters that stand in the table ``form`` (3, n), which is in normal
    form."""
    out = {}
    for name, place in plain_parameters(entry).items():
        value = float(form[place.row.value, place.column])
        out[name] = value if place.sense is Sense.SAME else (-value) % pi
    return out
