"""A linkage to be mapped: its loop, its name, and the forms that its source names."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from linkages.catalogue import UnknownLinkageError, entry
from linkages.entry import FormPattern
from linkages.file import read_linkage
from linkages.loop import GeometryError, Loop

__all__ = ["Linkage", "is_linkage_file", "load"]


@dataclass(frozen=True)
class Linkage:
    """A loop with the ``patterns`` of the forms that its source names."""

    loop: Loop
    patterns: tuple[FormPattern, ...] = ()

    @property
    def name(self) -> str:
        """What the linkage is called, in the catalogue or in its file."""
        return self.loop.name


def load(source: str | Path, **parameters: float) -> Linkage:
    """The linkage called ``source`` in the catalogue, or read from a TOML file.

    ``parameters`` are those of a family, angles in rad, the others at their defaults; a
    file takes none. Raises `UnknownLinkageError` with the nearest names,
    `LinkageFileError` for a file that cannot be used, `UnknownParameterError` for a
    parameter that the family does not have, and `GeometryError` for values that make no
    linkage.
    """
    if is_linkage_file(source):
        if parameters:
            raise GeometryError(
                f"parameters of {source}",
                ", ".join(parameters),
                "left out with a file, which holds the whole geometry",
            )
        loop, _ = read_linkage(source)
        return Linkage(loop)
    name = str(source)
    try:
        family = entry(name)
    except UnknownLinkageError as error:
        file = f"{name}.toml"
        if Path(file).is_file():
            raise UnknownLinkageError(name, (file, *error.nearest)) from None
        raise
    values = family.complete(parameters)
    loop = family.build(**values)
    patterns = family.patterns(**values) if family.patterns is not None else ()
    return Linkage(loop, patterns)


def is_linkage_file(source: str | Path) -> bool:
    """Whether ``source`` names a file: it ends with .toml, or there is a file."""
    return str(source).endswith(".toml") or Path(source).is_file()
