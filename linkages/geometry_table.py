"""The Denavit-Hartenberg table of a linkage for the screen: twists in degrees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

from bifurc.tables import table
from linkages.kinematics import Number


class GeometryRow(NamedTuple):
    """One joint and the link that follows it, as texts."""

    joint: str
    link: str
    length: str
    twist: str
    offset: str


HEADS = GeometryRow("joint", "link", "length", "twist (deg)", "offset")


def link_name(joint: int, joints: int) -> str:
    """The link from ``joint`` (from 0) to the next one, both counted from 1: "12", or
    "9-10" where numbers have two digits."""
    dash = "-" if joints > 9 else ""
    return f"{joint + 1}{dash}{(joint + 1) % joints + 1}"


def geometry_rows(
    lengths: Sequence[Number], twists: Sequence[Number], offsets: Sequence[Number]
) -> list[GeometryRow]:
    """A row for every joint; symbols stand as they are, their twists in rad."""
    n = len(lengths)
    rows = []
    for i in range(n):
        length = _number(lengths[i])
        offset = _number(offsets[i])
        twist = _degrees(twists[i])
        rows.append(GeometryRow(str(i + 1), link_name(i, n), length, twist, offset))
    return rows


def geometry_text(rows: Sequence[GeometryRow]) -> str:
    """The table as lines, columns two spaces apart."""
    return table(HEADS, rows)


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
