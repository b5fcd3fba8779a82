"""The page of misprints cut into one page a source."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from docs.generator.markdown import plain, section, slug, table

CELLS = re.compile(r"(?<!\\)\|")
MEASURED, IN_WORDS = "Equations", "In words"


@dataclass
class SourcePage:
    """The rows of both tables that belong to one source, without the source itself."""

    source: str
    heads: dict[str, Sequence[str]] = field(default_factory=dict)
    rows: dict[str, list[Sequence[str]]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The file of the page, below errata/, without its ending."""
        return slug(self.source)

    @property
    def count(self) -> int:
        """How many rows there are."""
        return sum(len(rows) for rows in self.rows.values())

    def markdown(self) -> str:
        """The page, which links each linkage to its own."""
        parts = [f"# {plain(self.source)}"]
        for title, rows in self.rows.items():
            parts.append(section(title, table(self.heads[title], rows)))
        words = "[What the columns mean, and other sources](../errata.md)"
        return "\n\n".join([*parts, words]) + "\n"


def errata_pages(page: str) -> list[SourcePage]:
    """A page for each source that the tables of ``page`` (docs/errata.md) name; a row
    of two sources stands on both pages."""
    found: dict[str, SourcePage] = {}
    for title, table_text in zip((MEASURED, IN_WORDS), _tables(page), strict=True):
        heads, _, *rows = (_cells(line) for line in table_text)
        for row in rows:
            for source, cells in _split_sources(row):
                one = found.setdefault(source, SourcePage(source))
                one.heads[title] = heads[1:]
                one.rows.setdefault(title, []).append(_linked(title, cells))
    return list(found.values())


def errata_index(page: str, pages: Iterable[SourcePage]) -> str:
    """``page`` (docs/errata.md) with a list of the sources in place of its tables."""
    pages = list(pages)
    words = [line for line in page.splitlines() if not line.startswith("|")]
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(words)).strip()
    links = [
        f"- [{plain(one.source)}](errata/{one.name}.md): {one.count} rows"
        for one in pages
    ]
    names = "\n".join(f"{one.source} <errata/{one.name}>" for one in pages)
    toctree = f"```{{toctree}}\n:hidden:\n\n{names}\n```"
    return "\n\n".join([text, "## Sources", "\n".join(links), toctree]) + "\n"


def _tables(page: str) -> list[list[str]]:
    """The lines of every table of a page."""
    parts = re.findall(r"(?:^\|.*\n)+", page, re.MULTILINE)
    return [part.splitlines() for part in parts]


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in CELLS.split(line)[1:-1]]


def _split_sources(row: Sequence[str]) -> Iterable[tuple[str, list[str]]]:
    """(source, other cells) for each source of a row; equations and sources that are
    joined by semicolons belong together one by one."""
    sources = row[0].split("; ")
    places = row[1].split("; ")
    if len(places) != len(sources):
        places = [row[1]] * len(sources)
    for source, place in zip(sources, places, strict=True):
        yield source, [place, *row[2:]]


def _linked(title: str, cells: Sequence[str]) -> list[str]:
    """Cells as Markdown; the linkage of an equation links to its page."""
    texts = [plain(cell.replace(r"\|", "|")) for cell in cells]
    if title == MEASURED:
        name = cells[1]
        texts[1] = f"[{name}](../linkages/{name}.md)"
    return texts
