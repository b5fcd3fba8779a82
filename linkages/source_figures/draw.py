"""A figure of a source, drawn by the function of its kind."""

from __future__ import annotations

import textwrap
from collections.abc import Callable

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from bifurc.figures.rc import RC
from linkages.source_figures import (
    assembly_figure,
    curves_figure,
    notation_figure,
    table_figure,
    tori_figure,
    transitions_figure,
    translator_figure,
)
from linkages.source_figures.table import Kind, SourceFigure

DRAWINGS: dict[Kind, Callable[[SourceFigure], Figure]] = {
    Kind.ASSEMBLY: assembly_figure.draw,
    Kind.VIEWS: assembly_figure.draw_views,
    Kind.MOTION: assembly_figure.draw_motion,
    Kind.PATHS: curves_figure.draw_paths,
    Kind.SINGULAR_VALUES: curves_figure.draw_singular_values,
    Kind.TRANSITIONS: transitions_figure.draw,
    Kind.NOTATION: notation_figure.draw,
    Kind.TRANSLATOR: translator_figure.draw,
    Kind.TORI: tori_figure.draw,
    Kind.TABLE: table_figure.draw,
}
# sources write formulas, and no user's name stands in their figures
OF_SOURCES = {"text.parse_math": True}
LETTER_WIDTH = 0.068  # inches of a letter of the caption, on average
LINE_HEIGHT = 0.155  # inches


def draw_source_figure(source: SourceFigure) -> Figure:
    """The figure with its caption below."""
    with rc_context(RC | OF_SOURCES):
        figure = DRAWINGS[source.kind](source)
        _add_caption(figure, source.caption)
    return figure


def _add_caption(figure: Figure, caption: str) -> None:
    """The caption below a figure, which grows by as much as it needs."""
    width, height = figure.get_size_inches()
    lines = textwrap.wrap(caption, max(int((width - 0.2) / LETTER_WIDTH), 20))
    extra = LINE_HEIGHT * len(lines) + 0.15
    share = extra / (height + extra)
    figure.set_size_inches(width, height + extra)
    engine = figure.get_layout_engine()
    if not isinstance(engine, ConstrainedLayoutEngine):
        for axes in figure.axes:
            x, y, w, h = axes.get_position(original=True).bounds
            axes.set_position((x, share + y * (1 - share), w, h * (1 - share)))
    else:
        engine.set(rect=(0, share, 1, 1 - share))
    figure.text(
        0.1 / width, 0.08 / (height + extra), "\n".join(lines), fontsize=8, va="bottom"
    )
