"""The picture of the graph of forms."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.figures.drawing import note_emptiness
from bifurc.figures.graph_layout import lay_out_graph
from bifurc.figures.style import RC, Properties, Style, form_style

SURFACE = Style("0.6", "-")
MARGIN = 0.9  # around the forms, in inches
NAME_WIDTH = 16  # letters of a line in a box
CENTERED: Properties = {"ha": "center", "va": "center"}
BOX = {"boxstyle": "round,pad=0.5", "facecolor": "white", "linewidth": 2.0}
EDGE_BOX = {"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0}


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
            axes.plot(*edge.line.T, color="0.35", linewidth=1.2, zorder=1)
            x, y = edge.label.tolist()
            style = {"fontsize": 8.5, "zorder": 2, "bbox": EDGE_BOX, **CENTERED}
            axes.text(x, y, edge.name, **style)
        for i, name in enumerate(layout.names):
            color, dashes = form_style(i) if i < len(atlas.forms) else SURFACE
            text = textwrap.fill(name, NAME_WIDTH)
            box = {"edgecolor": color, "linestyle": dashes, **BOX}
            x, y = layout.places[i].tolist()
            axes.text(x, y, text, fontsize=9, zorder=3, bbox=box, **CENTERED)
        if not layout.names:
            note_emptiness(axes, atlas)
    return figure
