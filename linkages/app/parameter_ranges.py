"""Families with free parameters, from the command line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from bifurc.systems.equation_file import holds_equations, read_equations
from linkages.app.choice import read_number, read_parameters
from linkages.app.equation_source import read_constants
from linkages.app.exit_codes import CommandError
from linkages.catalogue import entry
from linkages.entry import (
    Entry,
    Parameter,
    ParameterKind,
    UnknownParameterError,
)
from linkages.linkage import is_linkage_file
from linkages.parameters.equation_members import EquationMembers
from linkages.parameters.file_family import family_of_file
from linkages.parameters.mechanism_family import MechanismFamily
from linkages.parameters.members import Members, range_of_members


class ChosenMembers(NamedTuple):
    """Members, and why there are none beyond the range of a parameter, by its name."""

    members: Members
    refusals: dict[str, str]


def choose_members(
    source: str, texts: Sequence[str], most: int, least: int = 1
) -> ChosenMembers:
    """The members of the family called ``source``: "key=value" is a parameter, "key=low:high"
    or "key" a free one, of which there are from ``least`` to ``most``, from its value on the page of the
    family or from the middle. Angles are in degrees.

    The parameters of a file are its numbers. Raises `CommandError`, and as
    `read_parameters`.
    """
    family = _family(source)
    fixed = [text for text in texts if "=" in text and ":" not in text]
    free = [text for text in texts if text not in fixed]
    _require_count(free, least, most, [one.name for one in family.parameters])
    values = family.complete(read_parameters(family.parameters, fixed))
    ranges = _ranges(family, free)
    for name, (low, high) in ranges.items():
        if not low < values[name] < high:
            values[name] = 0.5 * (low + high)
    members = Members(family, values, ranges)
    members.check(values)
    refusals = {}
    for name, (low, high) in ranges.items():
        found = range_of_members(members, name, low, high)
        if not found.low < values[name] < found.high:
            raise CommandError(
                f"--param {name}: there are no members beside its value: {found.refusal}"
            )
        ranges[name] = (found.low, found.high)
        refusals[name] = found.refusal
    return ChosenMembers(members, refusals)


def choose_equations(path: str, texts: Sequence[str]) -> EquationMembers:
    """The equations of a file: "key=value" is another value of a constant, "key=low:high"
    one that is free, of which there are one or two. Raises `CommandError` and
    `EquationFileError`."""
    free = [text for text in texts if ":" in text or "=" not in text]
    values = read_constants([text for text in texts if text not in free])
    system = read_equations(path, values)
    _require_count(free, 1, 2, list(system.values))
    bounds: dict[str, tuple[float, float]] = {}
    for text in free:
        name, _, span = text.partition("=")
        if name not in system.values:
            known = ", ".join(system.values)
            raise CommandError(f"--param {name}: it must be one of {known}")
        low, high = read_span(name, span)
        if name in bounds or name in values:
            raise CommandError(f"--param {name}: it is given twice")
        bounds[name] = (low, high)
        if not low < system.values[name] < high:
            values[name] = 0.5 * (low + high)
    return EquationMembers(path, values, bounds)


def _require_count(
    free: Sequence[str], least: int, most: int, names: Sequence[str]
) -> None:
    """Raise `CommandError` unless as many parameters are free as may be, out of those of
    the ``names``."""
    if least <= len(free) <= most:
        return
    how_many = f"{least} to {most} parameters are"
    if least == most:
        how_many = "one parameter is" if most == 1 else f"{most} parameters are"
    example = f", as --param {names[0]}=low:high," if names else ""
    raise CommandError(
        f"--param: {len(free)} parameters are free, and {how_many} to be{example} out of "
        f"{', '.join(names) or 'none'}"
    )


def _family(source: str) -> Entry | MechanismFamily:
    """The family that has a name, or of what a file describes; raises `CommandError`."""
    if not is_linkage_file(source):
        return entry(source)
    if holds_equations(source):
        raise CommandError(
            f"{source}: these are equations, whose points `bifurc follow` follows; this "
            "takes a linkage"
        )
    return family_of_file(source)


def _ranges(
    family: Entry | MechanismFamily, texts: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """The free parameters that texts name, and from where to where they go."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        parameter, low, high = _range(family, text)
        if parameter.name in ranges:
            raise CommandError(f"--param {parameter.name}: it is given twice")
        ranges[parameter.name] = (low, high)
    return ranges


def _range(
    family: Entry | MechanismFamily, text: str
) -> tuple[Parameter, float, float]:
    """The free parameter that a text names, and from where to where it goes."""
    name, _, span = text.partition("=")
    known = {one.name: one for one in family.parameters}
    if name not in known:
        raise UnknownParameterError(family.name, name, tuple(known))
    parameter = known[name]
    if not span:
        low = min(parameter.low, parameter.default)
        return parameter, low, max(parameter.high, parameter.default)
    ends = read_span(name, span)
    if parameter.kind is ParameterKind.ANGLE:
        ends = (math.radians(ends[0]), math.radians(ends[1]))
    return parameter, *ends


def read_span(name: str, text: str, option: str = "--param") -> tuple[float, float]:
    """The ends of a range "low:high" behind an option; raises `CommandError`."""
    parts = text.split(":")
    message = f"{option} {name}: {text!r} is not allowed; write low:high"
    if len(parts) != 2:
        raise CommandError(message)
    low, high = [read_number(name, part, option) for part in parts]
    if not low < high:
        raise CommandError(message)
    return low, high
