"""Every named linkage.

A family module lists its linkages in ``ENTRIES`` and is named in `FAMILIES`; importing
the catalogue imports numpy and these modules, nothing else.
"""

from __future__ import annotations

import difflib
from functools import cache
from importlib import import_module

from bifurc.errors import BifurcError
from linkages.entry import Entry

__all__ = ["FAMILIES", "UnknownLinkageError", "catalogue", "entry"]

FAMILIES = (
    "linkages.families.four_bar",
    "linkages.families.spherical",
    "linkages.families.bennett",
    "linkages.families.goldberg",
    "linkages.families.goldberg_5r",
    "linkages.families.tori",
    "linkages.families.goldberg_6r",
    "linkages.families.double_goldberg",
    "linkages.families.generalized_double_goldberg",
    "linkages.families.mixed_double_goldberg",
    "linkages.families.back_to_back",
    "linkages.families.waldron",
    "linkages.families.yu_baker",
    "linkages.families.mavroidis_roth",
    "linkages.families.dietmaier",
    "linkages.families.bricard",
    "linkages.families.bricard_plane",
    "linkages.families.bricard_collapsible",
    "linkages.families.bricard_other",
    "linkages.families.reconfigurable",
    "linkages.families.wohlhart",
)


class UnknownLinkageError(BifurcError, KeyError):
    """No linkage of that name: ``name`` is what was asked for, ``nearest`` the names
    most like it."""

    def __init__(self, name: str, nearest: tuple[str, ...]):
        self.name, self.nearest = name, nearest
        super().__init__(name)

    def __str__(self) -> str:
        hint = (
            "the nearest names are " + ", ".join(self.nearest)
            if self.nearest
            else "no name is like it"
        )
        return f"no linkage is called {self.name!r}; {hint}"


@cache
def _entries() -> tuple[Entry, ...]:
    return tuple(
        found for family in FAMILIES for found in import_module(family).ENTRIES
    )


def catalogue() -> dict[str, Entry]:
    """Every entry by its name, in the order of the families."""
    out: dict[str, Entry] = {}
    for found in _entries():
        if found.name in out:
            raise ValueError(f"two linkages are called {found.name!r}")
        out[found.name] = found
    return out


def entry(name: str) -> Entry:
    """The entry called ``name``; raises `UnknownLinkageError`, which lists the nearest
    names."""
    known = catalogue()
    if name in known:
        return known[name]
    plain = name.strip().lower().replace("_", "-").replace(" ", "-")
    nearest = difflib.get_close_matches(plain, known, n=3, cutoff=0.5)
    nearest += [
        key
        for key in known
        if plain and (plain in key or key in plain) and key not in nearest
    ]
    raise UnknownLinkageError(name, tuple(nearest[:5]))
