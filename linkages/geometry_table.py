"""The Denavit-Hartenberg table of a linkage for the screen: twists in degrees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

from linkages.kinematics import Number


class GeometryRow(NamedTuple):
    """One joint and the link that follows it, as texts."""

    joint: str
    link: str
    length: str
    twist: str
    offset: str


HEADS = GeometryRow("joint", "link", "length", "twist (deg)", "offset")


def geometry_rows(
    lengths: Sequence[Number], twists: Sequence[Number], offsets: Sequence[Number]
) -> list[GeometryRow]:
    """A row for every joint; symbols stand as they are, their twists in rad."""
    n = len(lengths)
    rows = []
    for i in range(n):
        joint = i + 1
        following = (i + 1) % n + 1
        link = f"{joint}-{following}" if n > 9 else f"{joint}{following}"
        length = _number(lengths[i])
        offset = _number(offsets[i])
        rows.append(GeometryRow(str(joint), link, length, _degrees(twists[i]), offset))
    return rows


def geometry_text(rows: Sequence[GeometryRow]) -> str:
    """The table as lines, columns two spaces apart."""
    lines = [HEADS, *rows]
    widths = []
    for column in zip(*lines, strict=True):
        widths.append(max(len(cell) for cell in column))
    texts = []
    for line in lines:
        cells = [cell.ljust(width) for cell, width in zip(line, widths, strict=True)]
        texts.append(f"  {'  '.join(cells)}".rstrip())
    return "\n".join(texts)


def geometry_html(rows: Sequence[GeometryRow]) -> str:
    """The table as an HTML element."""
    heads = "".join(f"<th>{escape(head)}</th>" for head in HEADS)
    lines = [f"<tr>{heads}</tr>"]
    for row in rows:
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in row)
        lines.append(f"<tr>{cells}</tr>")
    return f"<table>{''.join(lines)}</table>"


def _number(value: Number) -> str:
    try:
        return f"{float(value):.10g}"
    except TypeError:  # a symbol
        return str(value)


def _degrees(twist: Number) -> str:
    try:
        degrees = math.degrees(float(twist))
    except TypeError:  # a symbol
        return f"{twist} rad"
    return f"{degrees:.4f}".replace("-0.0000", "0.0000")
