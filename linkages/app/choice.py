"""The linkage that a command line names: an entry of the catalogue with parameters, or
a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from linkages.catalogue import UnknownLinkageError, entry
from linkages.entry import Entry, FormPattern
from linkages.file import read_linkage, read_precisely
from linkages.loop import GeometryError, Loop

__all__ = ["Choice", "choose_linkage", "choose_precisely"]


@dataclass(frozen=True)
class Choice:
    """A loop and the forms that its source names."""

    loop: Loop
    patterns: tuple[FormPattern, ...] = ()


def choose_linkage(text: str, parameters: Sequence[str] = ()) -> Choice:
    """The linkage called ``text``, or read from the file ``text`` if that is one (or
    ends with .toml).

    ``parameters`` are "key=value", angles in degrees. Raises `GeometryError`,
    `UnknownLinkageError` and `LinkageFileError`.
    """
    if _is_file(text):
        if parameters:
            raise GeometryError(
                "--param",
                parameters[0],
                "left out with a file, which holds the whole geometry",
            )
        return Choice(read_linkage(text)[0])
    found = _entry(text)
    values = found.complete(dict(_parameter(found, item) for item in parameters))
    patterns = found.patterns(**values) if found.patterns is not None else ()
    return Choice(found.build(**values), patterns)


def choose_precisely(text: str, parameters: Sequence[str] = ()) -> Loop:
    """The loop that `choose_linkage` finds, in mpmath numbers at the precision that is
    set.

    Parameters of a named linkage keep the values that its doubles have, and the
    constructor works on them exactly.
    """
    import mpmath

    if _is_file(text):
        return read_precisely(text)
    found = entry(text)
    values = found.complete(dict(_parameter(found, item) for item in parameters))
    return found.build(**{key: mpmath.mpf(value) for key, value in values.items()})


def _entry(text: str) -> Entry:
    """The entry called ``text``; where there is none but a file of that name, it is
    among the nearest."""
    try:
        return entry(text)
    except UnknownLinkageError as error:
        file = f"{text}.toml"
        raise (
            UnknownLinkageError(text, (file, *error.nearest))
            if Path(file).is_file()
            else error
        ) from None


def _is_file(text: str) -> bool:
    return text.endswith(".toml") or Path(text).is_file()


def _parameter(found: Entry, item: str) -> tuple[str, float]:
    key, equals, text = item.partition("=")
    key = key.strip()
    if not equals:
        raise GeometryError("--param", repr(item), "of the form key=value")
    try:
        value = float(text)
    except ValueError:
        raise GeometryError(f"--param {key}", repr(text), "a number") from None
    if not math.isfinite(value):
        raise GeometryError(f"--param {key}", value, "a finite number")
    kinds = {parameter.name: parameter.kind for parameter in found.parameters}
    return key, math.radians(value) if kinds.get(key) == "angle" else value
