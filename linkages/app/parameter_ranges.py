"""Families with free parameters, from the command line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from linkages.app.choice import read_number, read_parameters
from linkages.app.exit_codes import CommandError
from linkages.catalogue import entry
from linkages.entry import Entry, Parameter, ParameterKind, UnknownParameterError
from linkages.linkage import is_linkage_file
from linkages.parameters.members import Members, range_of_members


class ChosenMembers(NamedTuple):
    """Members, and why there are none beyond the range of a parameter, by its name."""

    members: Members
    refusals: dict[str, str]


def choose_members(source: str, texts: Sequence[str], most: int) -> ChosenMembers:
    """The members of the family called ``source``: "key=value" is a parameter, "key=low:high"
    or "key" a free one, of which there may be ``most``, from its value on the page of the
    family or from the middle. Angles are in degrees.

    Raises `CommandError`, and as `read_parameters`.
    """
    if is_linkage_file(source):
        raise CommandError(
            f"{source}: it takes the name of a linkage in the catalogue, whose parameters "
            "can move; a file holds one linkage"
        )
    family = entry(source)
    fixed = [text for text in texts if "=" in text and ":" not in text]
    free = [text for text in texts if text not in fixed]
    if not 1 <= len(free) <= most:
        how_many = "one parameter is" if most == 1 else f"1 to {most} parameters are"
        names = ", ".join(one.name for one in family.parameters)
        raise CommandError(
            f"--param: {len(free)} parameters are free, and {how_many} to be, as "
            f"--param {family.parameters[0].name} or with =low:high, out of {names}"
        )
    values = family.complete(read_parameters(family.parameters, fixed))
    ranges = _ranges(family, free)
    for name, (low, high) in ranges.items():
        if not low < values[name] < high:
            values[name] = 0.5 * (low + high)
    family.build(**values)
    refusals = {}
    for name, (low, high) in ranges.items():
        found = range_of_members(family, values, name, low, high)
        if not found.low < values[name] < found.high:
            raise CommandError(
                f"--param {name}: there are no members beside its value: {found.refusal}"
            )
        ranges[name] = (found.low, found.high)
        refusals[name] = found.refusal
    return ChosenMembers(Members(family, values, ranges), refusals)


def _ranges(family: Entry, texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """The free parameters that texts name, and from where to where they go."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        parameter, low, high = _range(family, text)
        if parameter.name in ranges:
            raise CommandError(f"--param {parameter.name}: it is given twice")
        ranges[parameter.name] = (low, high)
    return ranges


def _range(family: Entry, text: str) -> tuple[Parameter, float, float]:
    """The free parameter that a text names, and from where to where it goes."""
    name, _, span = text.partition("=")
    known = {one.name: one for one in family.parameters}
    if name not in known:
        raise UnknownParameterError(family.name, name, tuple(known))
    parameter = known[name]
    if not span:
        low = min(parameter.low, parameter.default)
        return parameter, low, max(parameter.high, parameter.default)
    ends = [read_number(name, part) for part in span.split(":")]
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise CommandError(f"--param {name}: {span!r} is not allowed; write low:high")
    if parameter.kind is ParameterKind.ANGLE:
        ends = [math.radians(end) for end in ends]
    return parameter, ends[0], ends[1]
