"""The linkage that a command line names: an entry of the catalogue with parameters, or a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from linkages.catalogue import entry
from linkages.entry import Entry, FormPattern
from linkages.file import read_linkage
from linkages.loop import GeometryError, Loop

__all__ = ["Choice", "choose_linkage"]


@dataclass(frozen=True)
class Choice:
    """A loop and the forms that its source names."""

    loop: Loop
    patterns: tuple[FormPattern, ...] = ()


def choose_linkage(text: str, parameters: Sequence[str] = ()) -> Choice:
    """The linkage called ``text``, or read from the file ``text`` if that is one (or ends with .toml).

    ``parameters`` are "key=value", angles in degrees. Raises `GeometryError`, `UnknownLinkageError` and
    `LinkageFileError`.
    """
    if text.endswith(".toml") or Path(text).is_file():
        if parameters:
            raise GeometryError("--param", parameters[0], "left out with a file, which holds the whole geometry")
        return Choice(read_linkage(text)[0])
    found = entry(text)
    values = found.complete(dict(_parameter(found, item) for item in parameters))
    patterns = found.patterns(**values) if found.patterns is not None else ()
    return Choice(found.build(**values), patterns)


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
