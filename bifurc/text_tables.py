"""Tables and counts as text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


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


def count_of(number: int, noun: str) -> str:
    """``number`` and the noun in its number: "1 form", "2 assemblies",
    "3 near misses"."""
    if number == 1:
        return f"{number} {noun}"
    if noun.endswith("y"):
        return f"{number} {noun[:-1]}ies"
    if noun.endswith("s"):
        return f"{number} {noun}es"
    return f"{number} {noun}s"
