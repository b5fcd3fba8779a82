"""Every named linkage.

A module of `linkages.families` is a family: it lists its linkages in ``ENTRIES``, which
it reads from the table beside it. The families are found by looking into that package,
so that a new one is two new files and nothing else. They come in the order of
``POSITION``, a number that a family may state; those that state none come last, by name.
Importing the catalogue imports numpy and these modules, nothing else.
"""

from __future__ import annotations

import difflib
import math
import pkgutil
from functools import cache
from importlib import import_module
from types import ModuleType

import linkages.families
from bifurc.errors import UnknownNameError
from linkages.arrays.entries import MECHANISMS
from linkages.entry import Entry
from linkages.networks.entries import NETWORKS

NEAREST = 5  # names that are shown where there is none of that name


class UnknownLinkageError(UnknownNameError):
    """No linkage of that name: ``name`` is what was asked for, ``nearest`` the names
    most like it."""

    def __str__(self) -> str:
        if self.name.endswith(".toml"):
            return f"{self.name}: a name of the catalogue is needed here, and no file"
        if self.name in NETWORKS:
            return (
                f"{self.name}: it is a network of several loops, and this takes a single "
                f"loop; `bifurc show {self.name}` shows it"
            )
        if self.name in MECHANISMS:
            return (
                f"{self.name}: it is a mechanism of many loops, and this takes a single "
                f"loop; `bifurc show {self.name}` shows it"
            )
        hint = "no name is like it"
        if self.nearest:
            hint = "the nearest names are " + ", ".join(self.nearest)
        return f"no linkage is called {self.name!r}; {hint}"


@cache
def families() -> tuple[ModuleType, ...]:
    """The modules of the families, in the order of the catalogue."""
    package = linkages.families
    modules = []
    for module in pkgutil.iter_modules(package.__path__):
        modules.append(import_module(f"{package.__name__}.{module.name}"))
    return tuple(sorted(modules, key=_place))


def _place(family: ModuleType) -> tuple[float, str]:
    return getattr(family, "POSITION", math.inf), family.__name__


@cache
def _entries() -> dict[str, Entry]:
    out: dict[str, Entry] = {}
    for family in families():
        for linkage in family.ENTRIES:
            if linkage.name in out:
                raise ValueError(f"two linkages are called {linkage.name!r}")
            out[linkage.name] = linkage
    return out


def catalogue() -> dict[str, Entry]:
    """Every entry by its name, in the order of the families."""
    return dict(_entries())


@cache
def distinct_entries() -> tuple[Entry, ...]:
    """The entries without those that are others in more parameters."""
    return tuple(entry for entry in _entries().values() if not entry.is_other_view)


def entry(name: str) -> Entry:
    """The entry called ``name``; raises `UnknownLinkageError`, which lists the nearest
    names, also of networks, sheets and arrays."""
    entries = _entries()
    if name in entries:
        return entries[name]
    plain = name.strip().lower().replace("_", "-").replace(" ", "-")
    known = [*entries, *NETWORKS, *MECHANISMS]
    nearest = difflib.get_close_matches(plain, known, n=3, cutoff=0.5)
    for other in known:
        is_part = bool(plain) and (plain in other or other in plain)
        if is_part and other not in nearest:
            nearest.append(other)
    raise UnknownLinkageError(name, tuple(nearest[:NEAREST]))
