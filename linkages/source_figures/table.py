"""The figures of the sources: what each shows, by which kind of drawing, and whether it
agrees with the source."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Any, TypeAlias

from bifurc.errors import UnknownNameError

FILES = (
    "thesis_chapter_2",
    "thesis_chapter_3",
    "thesis_chapter_4",
    "thesis_chapter_5",
    "thesis_networks",
    "thesis_tables",
    "paper_000",
    "paper_001",
    "paper_003",
    "paper_004",
)
Content: TypeAlias = Mapping[str, Any]  # a table of TOML, as its kind reads it
NEAREST = 3  # figures that are named where there is none of that name


class Kind(StrEnum):
    """How a figure is drawn; `draw.DRAWINGS` has the function that does it."""

    # Joint axes and links in space, as a graph and as a drawing.
    ASSEMBLY = "assembly"
    # A line-symmetric configuration from the front and from above.
    VIEWS = "views"
    # One linkage in several configurations.
    MOTION = "motion"
    # Joint angles against the angle of one joint.
    PATHS = "paths"
    # All singular values against the angle of one joint.
    SINGULAR_VALUES = "singular_values"
    # The transition map with configurations along the way.
    TRANSITIONS = "transitions"
    # A chain of links with the names of its lengths and angles.
    NOTATION = "notation"
    # Wohlhart's symmetric mechanism as a translator.
    TRANSLATOR = "translator"
    # Circles that make tori, and the linkages on them.
    TORI = "tori"
    # A printed table of types, with their links.
    TABLE = "table"


class Agreement(StrEnum):
    """How a figure compares with what the source says of it."""

    # All that text and caption say of the figure holds in ours.
    AGREES = "agrees"
    # The same, but the source prints no geometry: ours is that of the catalogue.
    OWN_GEOMETRY = "own geometry"
    # Text or caption is wrong, and ours is right.
    DIFFERS = "differs"


@dataclass(frozen=True)
class SourceFigure:
    """A figure of a source.

    ``name`` is what the command takes, as thesis-4.2.5, ``title`` what is seen,
    ``remark`` what differs and why. ``content`` is what the drawing of its ``kind``
    reads.
    """

    name: str
    kind: Kind
    title: str
    agreement: Agreement
    remark: str = ""
    content: Content = field(default_factory=dict, compare=False)

    @property
    def caption(self) -> str:
        """What stands below the figure."""
        parts = [f"{self.name}: {self.title}."]
        if self.remark:
            parts.append(self.remark)
        return " ".join(parts)


class UnknownFigureError(UnknownNameError):
    """No figure of that ``name``; ``nearest`` are those most like it."""

    def __str__(self) -> str:
        hint = "no name is like it; bifurc figure --list has them all"
        if self.nearest:
            hint = "the nearest names are " + ", ".join(self.nearest)
        return f"no figure is called {self.name!r}; {hint}"


@cache
def source_figures() -> dict[str, SourceFigure]:
    """Every figure by its name, in the order of the sources."""
    folder = resources.files("linkages.source_figures") / "data"
    tables: dict[str, dict[str, Any]] = {}
    for file in FILES:
        text = (folder / f"{file}.toml").read_text(encoding="utf-8")
        for name, table in tomllib.loads(text).items():
            # a figure takes over what it does not say from the one that it is like
            model = tables[table.pop("like")] if "like" in table else {}
            tables[name] = model | table
    return {name: _figure(name, dict(table)) for name, table in tables.items()}


def _figure(name: str, content: dict[str, Any]) -> SourceFigure:
    kind = Kind(content.pop("kind"))
    title = content.pop("title")
    agreement = Agreement(content.pop("agreement"))
    remark = content.pop("remark", "")
    return SourceFigure(name, kind, title, agreement, remark, content)


def figure_named(name: str) -> SourceFigure:
    """The figure called ``name``; raises `UnknownFigureError`."""
    figures = source_figures()
    plain = name.strip().lower()
    if plain in figures:
        return figures[plain]
    nearest = difflib.get_close_matches(plain, figures, n=NEAREST, cutoff=0.5)
    raise UnknownFigureError(name, tuple(nearest))
