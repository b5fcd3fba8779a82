"""A Denavit-Hartenberg table as CSV, a row a joint, under the usual headings.

    joint, a, alpha (deg), d, theta
    1, 1.0, 100, 0, *

Lengths, twists and offsets are found by their headings; other columns, such as the joint
angle, do not matter. Columns stand between commas, semicolons or tabs; lines that begin
with # are comments. In row i stand the link from joint i to joint i + 1 and the offset at
joint i, as Denavit and Hartenberg (1955) have them; headings such as ``a(i-1)`` mean the
modified convention of Craig (1986), where the link before joint i stands there.
"""

from __future__ import annotations

import csv
import logging
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from linkages.loop import MAX_JOINTS, MIN_JOINTS, Loop
from linkages.values import GeometryError, require

log = logging.getLogger(__name__)

HEADINGS = {
    "lengths": ("a", "length", "lengths", "linklength", "linklengths"),
    "twists": ("alpha", "α", "twist", "twists", "linktwist", "linktwists"),
    "offsets": ("d", "r", "s", "offset", "offsets", "linkoffset", "jointoffset"),
}
DEGREES, RADIANS = ("deg", "degree", "degrees", "°"), ("rad", "radian", "radians")
MODIFIED = ("i-1", "i−1")  # in a heading: of the link before the joint
FULL_TURN = 2 * math.pi
# a multiple of pi, such as -pi/2, 3*pi/4 or 0.5π
OF_PI = re.compile(r"([+-]?)\s*(\d*\.?\d*)\s*\*?\s*(?:pi|π)\s*(?:/\s*(\d+\.?\d*))?")


class _Heading(NamedTuple):
    """What a column holds, if it is one of the three, the unit that its heading names,
    and whether it is of the link before the joint."""

    meaning: str
    unit: str
    is_modified: bool


def read_csv(text: str, name: str) -> Loop:
    """The loop of a table as CSV; raises `GeometryError`."""
    rows = _rows(text)
    require(bool(rows), "table", "an empty file", "headings and a row for each joint")
    headings = [_heading(cell) for cell in rows[0]]
    columns = _places_of_columns(headings, rows[0])
    body = rows[1:]
    allowed = f"one for each joint, {MIN_JOINTS} to {MAX_JOINTS}"
    require(MIN_JOINTS <= len(body) <= MAX_JOINTS, "number of rows", len(body), allowed)
    values = {meaning: _column(body, k, meaning) for meaning, k in columns.items()}
    if not _is_in_radians(headings[columns["twists"]], values["twists"]):
        values["twists"] = [math.radians(twist) for twist in values["twists"]]
    loop = Loop(
        tuple(values["lengths"]),
        tuple(values["twists"]),
        tuple(values["offsets"]),
        name,
    )
    return from_modified(loop) if _are_modified(headings) else loop


def says_modified(text: str) -> bool:
    """Whether the headings of a table as CSV are those of the modified convention."""
    return _are_modified([_heading(cell) for cell in _rows(text)[0]])


def _are_modified(headings: Sequence[_Heading]) -> bool:
    of_links = [one for one in headings if one.meaning in ("lengths", "twists")]
    return any(one.is_modified for one in of_links)


def _places_of_columns(
    headings: Sequence[_Heading], cells: Sequence[str]
) -> dict[str, int]:
    """Which column holds lengths, twists and offsets, under headings in these cells."""
    columns = {}
    for meaning, words in HEADINGS.items():
        found = [k for k, one in enumerate(headings) if one.meaning == meaning]
        given = f"{len(found)} under the headings {'; '.join(cells)}"
        called = ", ".join(words[:3])
        allowed = f"one, called {called}, between commas, semicolons or tabs"
        require(len(found) == 1, f"columns of {meaning}", given, allowed)
        columns[meaning] = found[0]
    return columns


def from_modified(loop: Loop) -> Loop:
    """The loop of a table in the modified convention, where the link before a joint
    stands in its row, that was read as if it were the one behind."""
    lengths = loop.lengths[1:] + loop.lengths[:1]
    twists = loop.twists[1:] + loop.twists[:1]
    return replace(loop, lengths=lengths, twists=twists)


def _rows(text: str) -> list[list[str]]:
    """The cells of all lines that hold something."""
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    lines = [line for line in lines if not line.lstrip().startswith("#")]
    separator = max(";\t,", key=lines[0].count) if lines else ","
    return [
        [cell.strip() for cell in row] for row in csv.reader(lines, delimiter=separator)
    ]


def _heading(cell: str) -> _Heading:
    lowered = cell.lower()
    is_modified = any(mark in lowered.replace(" ", "") for mark in MODIFIED)
    words = re.findall(r"[^\W\d_]+|°", lowered)
    unit = next((word for word in words if word in DEGREES + RADIANS), "")
    letters = [word for word in words if word != unit and word != "i"]
    called = "".join(letters[:2])
    for meaning, names in HEADINGS.items():
        if called in names or (letters and letters[0] in names):
            return _Heading(meaning, unit, is_modified)
    return _Heading("", unit, is_modified)


def _column(body: Sequence[Sequence[str]], column: int, meaning: str) -> list[float]:
    values = []
    for number, row in enumerate(body, start=1):
        what = f"{meaning}[{number}]"
        require(column < len(row), what, "a missing cell", "a number")
        values.append(_number(what, row[column]))
    return values


def _number(what: str, cell: str) -> float:
    text = cell.rstrip("° ").replace("−", "-")
    of_pi = OF_PI.fullmatch(text.lower())
    if of_pi:
        sign, factor, divisor = of_pi.groups()
        value = math.pi * float(factor or 1.0) / float(divisor or 1.0)
        return -value if sign == "-" else value
    if text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")  # a comma for the point, between semicolons
    try:
        value = float(text)
    except ValueError:
        raise GeometryError(what, repr(cell), "a number") from None
    require(math.isfinite(value), what, value, "a finite number")
    return value


def _is_in_radians(heading: _Heading, twists: Sequence[float]) -> bool:
    """Whether twists are in radians: as the heading says, or else as they look."""
    if heading.unit:
        return heading.unit in RADIANS
    is_in_radians = all(abs(twist) <= FULL_TURN for twist in twists)
    unit = "radians" if is_in_radians else "degrees"
    log.warning(
        "the heading of the twists names no unit; they are taken as %s; write "
        "alpha (deg) or alpha (rad)",
        unit,
    )
    return is_in_radians
