"""Printed tables of types of linkages, with the links of each type in the symbols of its
family."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from linkages.families.mixed_double_goldberg import Kind, Order, link_order
from linkages.source_figures.table import SourceFigure

GREEK = str.maketrans("abcd-", "αβγδ−")
MINUS = str.maketrans("-", "−")
LETTER_WIDTH, LINE_HEIGHT = 0.085, 0.2  # inches
MARGIN = 3  # letters between columns
HEAD_COLOR, EDGE_COLOR = "0.93", "0.6"


def draw(source: SourceFigure) -> Figure:
    """The rows of the figure, and for every family the links of their types."""
    content = source.content
    families = [Kind.of_prefix(prefix) for prefix in content.get("families", [])]
    rows = [list(content["heads"]), *(list(row) for row in content["rows"])]
    for kind in families:
        rows[0] += link_heads(kind, is_alone=len(families) == 1)
        for row in rows[1:]:
            texts = link_texts(Order[row[0]], kind)
            row += texts if len(families) == 1 else [_in_line(texts)]
    return _draw_cells(rows)


def link_heads(kind: Kind, *, is_alone: bool) -> list[str]:
    """The heads of the columns of a family: one a link, or one for all links."""
    if is_alone:
        return ["12", "23", "34", "45", "56", "61"]
    return [kind.value.prefix]


def link_texts(order: Order, kind: Kind) -> list[str]:
    """Length and twist of each link, a line each."""
    names = link_order(order, kind).split()
    return [f"{name.translate(MINUS)}\n{name.translate(GREEK)}" for name in names]


def _in_line(texts: list[str]) -> str:
    """Texts of two lines beside each other."""
    lines = zip(*(text.split("\n") for text in texts), strict=True)
    return "\n".join(",  ".join(line) for line in lines)


def _draw_cells(rows: list[list[str]]) -> Figure:
    """A table whose columns are as wide, and whose rows are as high, as their texts."""
    widths = [max(map(_width, column)) + MARGIN for column in zip(*rows, strict=True)]
    heights = [1 + max(text.count("\n") + 1 for text in row) for row in rows]
    size = LETTER_WIDTH * sum(widths), LINE_HEIGHT * sum(heights)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    axes.set_axis_off()
    shares = [width / sum(widths) for width in widths]
    cells = axes.table(rows, colWidths=shares, cellLoc="center", bbox=Bbox.unit())
    cells.auto_set_font_size(False)
    cells.set_fontsize(9)
    for (row, _), cell in cells.get_celld().items():
        cell.set_height(heights[row] / sum(heights))
        cell.set_edgecolor(EDGE_COLOR)
        if row == 0:
            cell.set_facecolor(HEAD_COLOR)
    return figure


def _width(text: str) -> int:
    return max(map(len, text.split("\n")))
