"""Tables and counts as text, for a terminal and for a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Left-aligned columns, two spaces apart, without trailing spaces."""
    lines = [tuple(heads)]
    lines += [tuple(row) for row in rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(heads))]
    shown = []
    for line in lines:
        cells = [cell.ljust(width) for cell, width in zip(line, widths, strict=True)]
        shown.append(("  " + "  ".join(cells)).rstrip())
    return "\n".join(shown)


def distinct_heads(names: Sequence[str], others: Iterable[str]) -> list[str]:
    """Heads of columns for things with ``names`` that a user chose, told apart from the
    ``others``, which are the program's."""
    taken = {other.casefold() for other in others}
    return [f"{name} (unknown)" if name.casefold() in taken else name for name in names]


def section(
    title: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    most: int | None = None,
) -> str:
    """A table below its title; empty where there are no rows. Of more than ``most`` rows
    the first are shown, and how many there are besides."""
    if not rows:
        return ""
    text = f"{title}\n{table(heads, rows[:most])}"
    if most is not None and len(rows) > most:
        text += f"\n  and {len(rows) - most} more"
    return text


def section_of(
    title: str, records: Sequence[Mapping[str, str]], most: int | None = None
) -> str:
    """The `section` of records that have their cells by the heads of the columns."""
    heads = list(records[0]) if records else []
    return section(title, heads, [list(record.values()) for record in records], most)


def count_of(number: int, noun: str) -> str:
    """``number`` and the noun in its number: "1 form", "2 assemblies",
    "3 near misses", "4 touches", "5 boxes"."""
    if number == 1:
        return f"{number} {noun}"
    if noun.endswith("y") and noun[-2] not in "aeiou":
        return f"{number} {noun[:-1]}ies"
    if noun.endswith(("s", "ch", "x")):
        return f"{number} {noun}es"
    return f"{number} {noun}s"


def html_table(
    title: str, heads: Sequence[str], rows: Iterable[Sequence[str]], most: int
) -> str:
    """A table with its title above; of more than ``most`` rows the others are counted.

    Empty without rows. Titles and cells are text: what HTML would read in them is
    escaped.
    """
    lines = [_row("td", row) for row in rows]
    if not lines:
        return ""
    shown = lines[:most]
    if len(lines) > most:
        shown.append(_row("td", [f"and {len(lines) - most} more"]))
    caption = f"<caption><b>{escape(title)}</b></caption>"
    head = f"<thead>{_row('th', heads)}</thead>"
    return f"<table>{caption}{head}<tbody>{''.join(shown)}</tbody></table>"


def html_paragraph(title: str, text: str) -> str:
    """A paragraph that begins with its title."""
    return f"<p><b>{escape(title)}</b> {escape(text)}</p>"


def _row(cell: str, texts: Sequence[str]) -> str:
    cells = "".join(f"<{cell}>{escape(text)}</{cell}>" for text in texts)
    return f"<tr>{cells}</tr>"
