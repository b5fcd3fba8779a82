"""The linkage that a command line names: an entry of the catalogue with parameters, or
a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from linkages.app.exit_codes import CommandError
from linkages.catalogue import entry
from linkages.entry import Entry, Parameter, ParameterKind
from linkages.file import read_precisely
from linkages.linkage import Linkage, is_linkage_file, load
from linkages.loop import LARGEST, SMALLEST, Loop
from linkages.networks.entries import NETWORKS, NetworkEntry
from linkages.values import GeometryError, check_angle

if TYPE_CHECKING:
    from linkages.mechanisms.mechanism import Mechanism

Kind = TypeVar("Kind")


def require_kind(value: object, kind: type[Kind], refusal: str) -> Kind:
    """A value of this kind; raises `CommandError` for another one."""
    if not isinstance(value, kind):
        raise CommandError(refusal)
    return value


def require_table(text: str, table: Loop | None) -> Loop:
    """The table of what is called ``text``; raises `CommandError` where there is
    none."""
    if table is None:
        raise CommandError(
            f"{text}: it is a mechanism, which `bifurc map`, `view`, `route`, `sweep`, "
            "`clearance`, `tolerance`, `convert` and `export` to .glb and .csv take; "
            "this takes single loops of 4 to 12 revolute joints so far"
        )
    return table


def choose_linkage(text: str, parameters: Sequence[str] = ()) -> Linkage | Mechanism:
    """The linkage called ``text``, or the linkage or mechanism read from the file
    ``text`` if that is one (or ends with .toml).

    ``parameters`` are "key=value", angles in degrees. Raises `CommandError`,
    `GeometryError`, `UnknownLinkageError` and `LinkageFileError`.
    """
    if is_linkage_file(text) and parameters:
        raise GeometryError(
            "--param",
            parameters[0],
            "left out with a file, which holds the whole geometry",
        )
    values = {}
    if parameters:
        values = read_parameters(_family(text).parameters, parameters)
    try:
        linkage = load(text, **values)
    except OverflowError:
        raise CommandError(f"{text}: it holds a number that is too large") from None
    _require_size(text, linkage)
    return linkage


def _family(text: str) -> Entry | NetworkEntry:
    """The entry or the network called ``text``; raises `UnknownLinkageError`."""
    return NETWORKS[text] if text in NETWORKS else entry(text)


def _require_size(text: str, linkage: Linkage | Mechanism) -> None:
    """Raise `CommandError` for lengths whose squares leave the range of doubles."""
    with np.errstate(over="ignore"):
        size = linkage.extent
    if not SMALLEST < size < LARGEST:
        raise CommandError(
            f"{text}: the lengths are about {size:.1g}; choose a unit in which they "
            f"are between {SMALLEST:g} and {LARGEST:g}"
        )


def choose_precisely(text: str, parameters: Sequence[str] = ()) -> Loop:
    """The loop that `choose_linkage` finds, in mpmath numbers at the precision that is
    set.

    Parameters of a named linkage keep the values that its doubles have, and the
    constructor works on them exactly.
    """
    import mpmath

    if is_linkage_file(text):
        return read_precisely(text)
    family = entry(text)
    values = family.complete(read_parameters(family.parameters, parameters))
    exact = {name: mpmath.mpf(value) for name, value in values.items()}
    return family.build(**exact)


def read_parameters(
    known: Sequence[Parameter], texts: Sequence[str]
) -> dict[str, float]:
    """The parameters in "key=value", those ``known`` as angles turned from degrees to
    rad; raises `CommandError`.

    Whether a family has parameters of these names is for `Entry.complete` to say.
    """
    kinds = {parameter.name: parameter.kind for parameter in known}
    values: dict[str, float] = {}
    for text in texts:
        name, value = split_parameter(text)
        if name in values:
            raise CommandError(f"--param {name}: it is given twice")
        number = read_number(name, value)
        is_angle = kinds.get(name) is ParameterKind.ANGLE
        if is_angle:
            check_angle(f"--param {name}", number, in_degrees=True)
            number = math.radians(number)
        values[name] = number
    return values


def split_parameter(text: str, option: str = "--param") -> tuple[str, str]:
    """Name and value of "key=value" behind an option; raises `GeometryError`."""
    name, equals, value = text.partition("=")
    if not equals:
        raise GeometryError(option, repr(text), "of the form key=value")
    return name.strip(), value


def read_number(name: str, text: str, option: str = "--param") -> float:
    """The finite number that ``text`` is, for what is called ``name`` behind an
    option; raises `GeometryError`."""
    try:
        number = float(text)
    except ValueError:
        raise GeometryError(f"{option} {name}", repr(text), "a number") from None
    if not math.isfinite(number):
        raise GeometryError(f"{option} {name}", number, "a finite number")
    return number
