"""Where panels and the legend of a figure stand: in inches, known beforehand.

A layout engine measures every text of a figure to find the same places, twice, which
takes longer than to draw it.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path
from matplotlib.transforms import ScaledTranslation

from bifurc.figures.rc import letter_size, size_of_user

Canvas: TypeAlias = Figure | SubFigure  # what panels are put into

USUAL_LETTERS = 9 / 72  # of these sizes are for, in inches; others scale them
HANDLE_LENGTH = 2.6  # of the line beside a name, over the size of a letter
HANDLE_GAP = 0.6  # between the two, over the same
COLUMN_GAP = 1.2  # between columns of names, over the same
ENTRY_HEIGHT = 1.65  # of a name, over the same
LINE_HEIGHT = 1.25  # of a further line of it, over the same
LEGEND_GAP = 0.12  # around the legend, in inches
# In inches, from the frame to the name of an axis; between them are the ticks.
NAME_BELOW = 0.24
NAME_LEFT = 0.42
NAME_WIDTH = 24  # letters of a line of the legend
SHORTEST_LINE = 12  # letters of a line of it, at least, in several columns
MOST_COLUMNS = 4
LETTER_WIDTH = 0.58  # on average, over the size of letters
LEAST_WIDTH = 0.8  # of a panel among others, in inches
LEAST_HEIGHT = 0.8
LEAST_SHARE = 0.5  # of the width that panels take; else the legend goes below them


@dataclass(frozen=True)
class Margins:
    """Room around the panels and between them, in inches."""

    left: float
    right: float
    bottom: float
    top: float
    between_columns: float = 0.0
    between_rows: float = 0.0

    def for_letters(self) -> Margins:
        """The same for letters of the size that is set."""
        scale = letter_size() / USUAL_LETTERS
        rooms = (self.left, self.right, self.bottom, self.top)
        gaps = (self.between_columns, self.between_rows)
        return Margins(*(scale * room for room in (*rooms, *gaps)))


@dataclass(frozen=True)
class PanelPlan:
    """``count`` panels of one ``width`` and ``height``, inches, in so many ``columns``,
    where the figure is as large as they need; in a smaller one there are fewer columns.
    """

    count: int
    columns: int
    width: float
    height: float
    margins: Margins
    has_common_ordinate: bool = False
    least_width: float = LEAST_WIDTH
    least_height: float = LEAST_HEIGHT

    def panel_width(self, room: float, columns: int) -> float:
        """The width of each of so many columns in a room of this width."""
        margins = self.margins
        gaps = margins.left + margins.right + (columns - 1) * margins.between_columns
        return (room - gaps) / columns

    def panel_height(self, room: float, rows: int) -> float:
        """The height of each of so many rows in a room of this height."""
        margins = self.margins
        gaps = margins.bottom + margins.top + (rows - 1) * margins.between_rows
        return (room - gaps) / rows

    def height_of(self, rows: int, panel: float) -> float:
        """The height of so many rows of panels of this height."""
        return rows * (panel - self.panel_height(0.0, rows))


class Legend:
    """Names beside lines and marks in so many ``columns``, with ``letters`` a line at
    most, and the room that they take."""

    def __init__(self, entries: Sequence[Line2D], columns: int, letters: int):
        self._handles = entries
        self._labels = [
            textwrap.fill(str(entry.get_label()), letters) for entry in entries
        ]
        self._columns = columns
        self._letter = letter_size("legend.fontsize")

    @classmethod
    def beside(cls, entries: Sequence[Line2D]) -> Legend:
        """One column."""
        return cls(entries, 1, NAME_WIDTH)

    @classmethod
    def below(cls, entries: Sequence[Line2D], width: float) -> Legend:
        """The columns, in a room of this width, that take the least height."""
        letter = letter_size("legend.fontsize")
        legends = [cls.beside(entries)]
        for columns in range(2, min(len(entries), MOST_COLUMNS) + 1):
            gaps = LEGEND_GAP + (columns - 1) * COLUMN_GAP * letter
            room = (width - gaps) / columns - (HANDLE_LENGTH + HANDLE_GAP) * letter
            letters = int(room / (LETTER_WIDTH * letter))
            if letters >= SHORTEST_LINE:
                legends.append(cls(entries, columns, min(letters, NAME_WIDTH)))
        return min(legends, key=lambda legend: legend.height)

    @property
    def width(self) -> float:
        """Of one column of names, with the gaps beside it, inches."""
        if not self._labels:
            return 0.0
        properties = FontProperties(size=72 * self._letter)
        longest = 0.0
        for line in "\n".join(self._labels).splitlines():
            size = text_to_path.get_text_width_height_descent(line, properties, False)
            longest = max(longest, size[0] / 72)
        handle = self._letter * (HANDLE_LENGTH + HANDLE_GAP)
        return longest + handle + 2 * LEGEND_GAP

    @property
    def height(self) -> float:
        """Of the longest column, with a gap below, inches."""
        if not self._labels:
            return 0.0
        heights = []
        for label in self._labels:
            further = label.count("\n")
            heights.append(self._letter * (ENTRY_HEIGHT + LINE_HEIGHT * further))
        columns = np.array_split(heights, self._columns)
        return float(max(column.sum() for column in columns)) + LEGEND_GAP / 2

    def draw(self, canvas: Canvas, left: float, top: float) -> None:
        """Draw the names; the upper left corner as parts of width and height."""
        if self._labels:
            canvas.legend(
                handles=self._handles,
                labels=self._labels,
                loc="upper left",
                bbox_to_anchor=(left, top),
                ncols=self._columns,
                handlelength=HANDLE_LENGTH,
                handletextpad=HANDLE_GAP,
                columnspacing=COLUMN_GAP,
                borderpad=0,
                borderaxespad=0,
            )


class Size(NamedTuple):
    """Width and height, inches."""

    width: float
    height: float


def figure_of(part: Canvas | Axes) -> Figure:
    """The whole figure of a part of it."""
    figure = part.get_figure(root=True)
    assert figure is not None
    return figure


def size_of(canvas: Canvas | Axes) -> Size:
    """The size of a figure or of a part of one."""
    root = figure_of(canvas)
    return Size(canvas.bbox.width / root.dpi, canvas.bbox.height / root.dpi)


class Sheet(NamedTuple):
    """A figure with its empty panels, row by row, in so many ``columns``."""

    canvas: Canvas
    panels: list[Axes]
    columns: int


def lay_out(
    canvas: Canvas | None,
    plan: PanelPlan,
    entries: Sequence[Line2D] = (),
    projection: Mapping[str, Any] = MappingProxyType({}),
) -> Sheet:
    """The panels of a plan in a figure, or in a new one, with a legend at its right, or
    below the panels where these would be narrow.

    A new figure has the size that the user has set for all figures, and more height
    where panels would be low; else the size of the plan. ``projection`` are
    arguments of the panels.
    """
    plan = replace(plan, margins=plan.margins.for_letters())
    legend = Legend.beside(entries)
    width = _width(canvas, plan, legend)
    columns = _columns(plan, width)
    panel_width = plan.panel_width(width - legend.width, columns)
    is_beside = columns * panel_width >= LEAST_SHARE * width
    if not is_beside:
        legend = Legend.below(entries, width)
    beside, below = (legend.width, 0.0) if is_beside else (0.0, legend.height)
    if canvas is None:
        height = _height(plan, -(-plan.count // columns), below)
        height = max(height, legend.height)
        canvas = Figure(figsize=(width, height))
    size = size_of(canvas)
    room = Size(size.width - beside, size.height - below)
    panels = _make_panels(canvas, plan, columns, room, projection)
    if is_beside:
        left = 1 - (beside - LEGEND_GAP) / size.width
        legend.draw(canvas, left, 1 - plan.margins.top / size.height)
    else:
        legend.draw(canvas, LEGEND_GAP / 2 / size.width, below / size.height)
    return Sheet(canvas, panels, columns)


def _width(canvas: Canvas | None, plan: PanelPlan, legend: Legend) -> float:
    if canvas is not None:
        return size_of(canvas).width
    of_user = size_of_user()
    if of_user is not None:
        return of_user[0]
    gaps = -plan.columns * plan.panel_width(0.0, plan.columns)
    return plan.columns * plan.width + gaps + legend.width


def _columns(plan: PanelPlan, width: float) -> int:
    """How many columns have room in a figure of this width."""
    for columns in range(plan.columns, 1, -1):
        panel = plan.panel_width(width, columns)
        if panel >= plan.least_width and columns * panel >= LEAST_SHARE * width:
            return columns
    return 1


def _height(plan: PanelPlan, rows: int, below: float) -> float:
    """Of a new figure with so much room below its panels."""
    of_user = size_of_user()
    if of_user is None:
        return plan.height_of(rows, plan.height) + below
    return max(of_user[1], plan.height_of(rows, plan.least_height) + below)


def _make_panels(
    canvas: Canvas,
    plan: PanelPlan,
    columns: int,
    room: Size,
    projection: Mapping[str, Any],
) -> list[Axes]:
    """The empty panels, in the upper left ``room`` of a figure."""
    size = size_of(canvas)
    margins = plan.margins
    rows = -(-plan.count // columns)
    width = plan.panel_width(room.width, columns)
    height = plan.panel_height(room.height, rows)
    panels: list[Axes] = []
    for k in range(plan.count):
        row, column = divmod(k, columns)
        left = margins.left + column * (width + margins.between_columns)
        top = margins.top + row * (height + margins.between_rows)
        bottom = size.height - top - height
        place = (
            left / size.width,
            bottom / size.height,
            width / size.width,
            height / size.height,
        )
        first = panels[0] if panels and plan.has_common_ordinate else None
        axes = canvas.add_axes(place, sharey=first, **projection)
        if plan.has_common_ordinate and column > 0:
            axes.tick_params(labelleft=False)
        panels.append(axes)
    return panels


def fix_names_of_axes(axes: Axes) -> None:
    """Put the names of both axes where three digits and a sign have room beside them,
    whatever the ticks are: their labels need not be measured."""
    figure = figure_of(axes)
    scale = letter_size() / USUAL_LETTERS
    below = ScaledTranslation(0, -scale * NAME_BELOW, figure.dpi_scale_trans)
    left = ScaledTranslation(-scale * NAME_LEFT, 0, figure.dpi_scale_trans)
    axes.xaxis.set_label_coords(0.5, 0, axes.transAxes + below)
    axes.yaxis.set_label_coords(0, 0.5, axes.transAxes + left)
