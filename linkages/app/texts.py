"""Numbers and tables as text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

__all__ = ["count_of", "in_degrees", "link_name", "section", "table"]


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


def section(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table below its title; empty where there are no rows."""
    if not rows:
        return ""
    return f"{title}\n{table(heads, rows)}"


def in_degrees(angle: float, digits: int = 4) -> str:
    """An angle (rad) in degrees, to so many decimals and without a negative zero."""
    shown = f"{np.degrees(angle) + 0.0:.{digits}f}"
    zero = f"{0.0:.{digits}f}"
    return zero if shown == f"-{zero}" else shown


def link_name(joint: int, joints: int) -> str:
    """The link from ``joint`` (from 0) to the next one, both counted from 1: "12", or
    "9-10" where numbers have two digits."""
    dash = "-" if joints > 9 else ""
    return f"{joint + 1}{dash}{(joint + 1) % joints + 1}"


def count_of(number: int, noun: str) -> str:
    """``number`` and the noun in its number: "1 form", "2 assemblies"."""
    if number == 1:
        return f"{number} {noun}"
    if noun.endswith("y"):
        return f"{number} {noun[:-1]}ies"
    return f"{number} {noun}s"
