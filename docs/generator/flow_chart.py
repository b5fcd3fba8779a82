"""Flow charts written in Mermaid, drawn from the top down as SVG.

Mermaid itself is a script of some megabytes that is fetched when a page is opened; of
its language this reads what the pages need: boxes ``A["text<br/>text"]`` and chains
``A --> B --> C``.
"""

from __future__ import annotations

import re
from html import escape
from itertools import pairwise
from typing import NamedTuple

import networkx as nx

BOX = re.compile(r'(\w+)\["(.*?)"\]')
HEIGHT, LINE = 46, 16  # px: of a box, and of a line of text
LETTER, MARGIN = 7.2, 12  # px: width of a letter of 12 px, and room beside a text
GAP, STEP = 16, 74  # px: between the boxes of a row, and from row to row


class Chart(NamedTuple):
    """The lines of text in each box, by its key, and the arrows between boxes."""

    texts: dict[str, list[str]]
    arrows: list[tuple[str, str]]


class Box(NamedTuple):
    """Where a box stands: its left upper corner and its width, px."""

    x: float
    y: float
    width: float


def read_chart(text: str) -> Chart:
    """The chart that ``text`` describes; raises `ValueError` for a line that is no
    chain."""
    head, *lines = [line.strip() for line in text.strip().splitlines()]
    if head != "graph LR":
        raise ValueError(f"a flow chart begins with {head!r}; it must be 'graph LR'")
    texts: dict[str, list[str]] = {}
    arrows = []
    for line in lines:
        for key, words in BOX.findall(line):
            texts[key] = words.split("<br/>")
        keys = [key.strip() for key in BOX.sub(r"\1", line).split("-->")]
        if not all(re.fullmatch(r"\w+", key) for key in keys):
            raise ValueError(f"a line of a flow chart is {line!r}, which is no chain")
        arrows += list(pairwise(keys))
    for arrow in arrows:
        for key in arrow:
            texts.setdefault(key, [key])
    return Chart(texts, arrows)


def chart_svg(chart: Chart) -> str:
    """The chart as an SVG element in the colour of the text around it."""
    places = _places(chart)
    width = max(box.x + box.width for box in places.values()) + 1
    height = max(box.y for box in places.values()) + HEIGHT + 1
    arrows = "".join(_arrow(places[a], places[b]) for a, b in chart.arrows)
    boxes = "".join(_box(places[key], lines) for key, lines in chart.texts.items())
    return (
        f'<svg class="flow-chart" viewBox="-1 -1 {width + 1:g} {height + 1:g}"'
        f' width="{width:g}" role="img" aria-label="flow chart">'
        f"{arrows}{boxes}</svg>"
    )


def _places(chart: Chart) -> dict[str, Box]:
    """A row for each step from the first boxes, in it the boxes beside each other, from
    the left, where a narrow page begins. Boxes alone in their row are of one width."""
    rows = list(nx.topological_generations(nx.DiGraph(chart.arrows)))
    widths = {key: _text_width(lines) for key, lines in chart.texts.items()}
    alone = [row[0] for row in rows if len(row) == 1]
    widest = max((widths[key] for key in alone), default=0.0)
    widths.update(dict.fromkeys(alone, widest))
    places = {}
    for i, row in enumerate(rows):
        x = 0.0
        for key in sorted(row, key=list(chart.texts).index):
            places[key] = Box(x, i * STEP, widths[key])
            x += widths[key] + GAP
    return places


def _text_width(lines: list[str]) -> float:
    return LETTER * max(len(line) for line in lines) + 2 * MARGIN


def _box(box: Box, lines: list[str]) -> str:
    x = box.x + box.width / 2
    first = box.y + HEIGHT / 2 - LINE * (len(lines) - 1) / 2
    texts = "".join(
        f'<text x="{x:g}" y="{first + LINE * i:g}">{escape(line)}</text>'
        for i, line in enumerate(lines)
    )
    rectangle = (
        f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" '
        f'height="{HEIGHT}" rx="6"/>'
    )
    return rectangle + texts


def _arrow(start: Box, end: Box) -> str:
    """A curve from the bottom of a box to the top of another, and its tip."""
    x1, y1 = start.x + start.width / 2, start.y + HEIGHT
    x2, y2 = end.x + end.width / 2, end.y
    middle = (y1 + y2) / 2
    line = f"M{x1:g} {y1:g}C{x1:g} {middle:g} {x2:g} {middle:g} {x2:g} {y2 - 6:g}"
    tip = f"M{x2:g} {y2:g}l-4 -7h8z"
    return f'<path class="arrow" d="{line}"/><path class="tip" d="{tip}"/>'
