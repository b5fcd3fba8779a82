"""The linkage that a command line names: an entry of the catalogue with parameters, or
a file."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkages.catalogue import entry
from linkages.entry import Entry
from linkages.file import read_precisely
from linkages.linkage import Linkage, is_linkage_file, load
from linkages.loop import GeometryError, Loop

__all__ = ["choose_linkage", "choose_precisely"]


def choose_linkage(text: str, parameters: Sequence[str] = ()) -> Linkage:
    """The linkage called ``text``, or read from the file ``text`` if that is one (or
    ends with .toml).

    ``parameters`` are "key=value", angles in degrees. Raises `GeometryError`,
    `UnknownLinkageError` and `LinkageFileError`.
    """
    if is_linkage_file(text):
        if parameters:
            raise GeometryError(
                "--param",
                parameters[0],
                "left out with a file, which holds the whole geometry",
            )
        return load(text)
    if not parameters:
        return load(text)
    family = entry(text)
    return load(text, **dict(_parameter(family, item) for item in parameters))


def choose_precisely(text: str, parameters: Sequence[str] = ()) -> Loop:
    """The loop that `choose_linkage` finds, in mpmath numbers at the precision that is
    set.

    Parameters of a named linkage keep the values that its doubles have, and the
    constructor works on them exactly.
    """
    import mpmath

    if is_linkage_file(text):
        return read_precisely(text)
    found = entry(text)
    values = found.complete(dict(_parameter(found, item) for item in parameters))
    return found.build(**{key: mpmath.mpf(value) for key, value in values.items()})


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
