"""The picture of the graph of forms."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.drawing import note_emptiness
from bifurc.figures.graph_layout import GraphEdge, lay_out_graph
from bifurc.figures.style import RC, Style, form_style

SURFACE = Style("0.6", "-")
MARGIN = 0.9  # around the forms, in inches
NAME_WIDTH = 16  # letters of a line in a box


def plot_form_graph(atlas: Atlas, figure: Figure | None = None) -> Figure:
    """Forms as boxes, joined by a line for every bifurcation at which two of them meet;
    components stand apart.

    Surfaces that meet a form or another surface are grey boxes.
    """
    layout = lay_out_graph(atlas)
    low = np.zeros(2)
    high = np.full(2, 2.0)
    if layout.names:
        low = layout.places.min(axis=0) - MARGIN
        high = layout.places.max(axis=0) + MARGIN
    with rc_context(RC):
        figure = figure or Figure(figsize=tuple(np.maximum(high - low, [3.2, 1.6])))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axes.set_axis_off()
        for edge in layout.edges:
            _draw_edge(axes, edge)
        for i, name in enumerate(layout.names):
            style = form_style(i) if i < len(atlas.forms) else SURFACE
            _draw_box(axes, name, layout.places[i], style)
        if not layout.names:
            note_emptiness(axes, atlas)
    return figure


def _draw_box(axes: Axes, name: str, place: np.ndarray, style: Style) -> None:
    axes.text(
        place[0],
        place[1],
        textwrap.fill(name, NAME_WIDTH),
        ha="center",
        va="center",
        fontsize=9,
        zorder=3,
        bbox={
            "boxstyle": "round,pad=0.5",
            "facecolor": "white",
            "edgecolor": style.color,
            "linewidth": 2.0,
            "linestyle": style.dashes,
        },
    )


def _draw_edge(axes: Axes, edge: GraphEdge) -> None:
    axes.plot(edge.line[:, 0], edge.line[:, 1], color="0.35", linewidth=1.2, zorder=1)
    _draw_name(axes, edge.name, edge.label)


def _draw_name(axes: Axes, name: str, place: np.ndarray) -> None:
    axes.text(
        place[0],
        place[1],
        name,
        ha="center",
        va="center",
        fontsize=8.5,
        zorder=2,
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0},
    )
