"""Panels at places that are known beforehand.

A layout engine measures every text of a figure to find the same places, twice, which
takes longer than to draw it.
"""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

# In inches, from the frame to the name of an axis; between them are the ticks.
NAME_BELOW = 0.27
NAME_LEFT = 0.46


@dataclass(frozen=True)
class Margins:
    """Room around the panels and between them, in inches."""

    left: float
    right: float
    bottom: float
    top: float
    between_columns: float = 0.0
    between_rows: float = 0.0


def make_panels(
    figure: Figure,
    count: int,
    columns: int,
    margins: Margins,
    has_common_ordinate: bool = False,
) -> list[Axes]:
    """As many panels in a figure, row by row; those with a common ordinate carry its
    ticks at the left."""
    rows = -(-count // columns)
    width, height = figure.get_size_inches()
    inner_width = width - margins.left - margins.right
    inner_height = height - margins.bottom - margins.top
    gap_width = margins.between_columns
    gap_height = margins.between_rows
    panel_width = (inner_width - (columns - 1) * gap_width) / columns
    panel_height = (inner_height - (rows - 1) * gap_height) / rows
    figure.set_layout_engine("none")
    grid = figure.add_gridspec(
        rows,
        columns,
        left=margins.left / width,
        right=1 - margins.right / width,
        bottom=margins.bottom / height,
        top=1 - margins.top / height,
        wspace=gap_width / panel_width,
        hspace=gap_height / panel_height,
    )
    panels: list[Axes] = []
    for k in range(count):
        row, column = divmod(k, columns)
        first = panels[0] if panels and has_common_ordinate else None
        axes = figure.add_subplot(grid[row, column], sharey=first)
        if has_common_ordinate and column > 0:
            axes.tick_params(labelleft=False)
        panels.append(axes)
    return panels


def fix_names_of_axes(axes: Axes) -> None:
    """Put the names of both axes where three digits and a sign have room beside them,
    whatever the ticks are: their labels need not be measured."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    below = ScaledTranslation(0, -NAME_BELOW, figure.dpi_scale_trans)
    left = ScaledTranslation(-NAME_LEFT, 0, figure.dpi_scale_trans)
    axes.xaxis.set_label_coords(0.5, 0, axes.transAxes + below)
    axes.yaxis.set_label_coords(0, 0.5, axes.transAxes + left)
