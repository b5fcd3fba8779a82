"""Tables in HTML, for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


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
