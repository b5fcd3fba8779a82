"""Figures of an atlas: the transition map, unknowns against the input, singular values,
and the graph of forms.

Each function draws into the figure given, or makes one, and returns it; nothing depends
on the state of pyplot or on the user's settings. Forms are told apart by colour (safe
for the colour-blind) and by line style (safe in print).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.figures.diagram_plot import plot_diagram
from bifurc.figures.drawing import (
    Margins,
    PanelSettings,
    draw_forms,
    draw_legend,
    draw_marks,
    legend_size,
    make_panels,
    note_emptiness,
)
from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.labels import label_points
from bifurc.figures.planes import (
    choose_plane,
    indices_of,
    plane_of,
    scale_of,
    shown_branches,
)
from bifurc.figures.rendering import RC, render
from bifurc.figures.singular_values import plot_singular_values
from bifurc.files.atomic import replace_file

SMALL_PANEL = PanelSettings(line_width=1.4, mark_size=3.5)
RESOLUTION = 140  # dots per inch of the files

# In inches.
FRAME_SIDE = 4.3  # of the transition map
PANEL_SIDE = 1.6  # of the small panels
TICKS = 0.75  # room for ticks, their labels and the name of an axis, at its left
WIDE_TICKS = 1.0  # the same where these are not angles in degrees
TICKS_BELOW = 0.5  # the same below it
EDGE = 0.15  # beside a frame where nothing stands
COLUMN_EDGE = 0.1  # between a panel and the room for the ticks of the next one
ROW_GAP = 0.3


def plot_transition_map(
    atlas: Atlas, figure: Figure | None = None, joints: Sequence[int] | None = None
) -> Figure:
    """The forms in the plane of two unknowns, with the singular points marked and
    named.

    ``joints`` are two numbers of unknowns, from 1; left out, the plane is chosen that
    tells the forms apart best. Angles are drawn in degrees on the torus. Raises
    `ProblemError` for numbers that are not two of the unknowns.
    """
    check_type("atlas", atlas, Atlas)
    if joints is None:
        plane = plane_of(atlas, *choose_plane(atlas))
    else:
        horizontal, vertical = indices_of(atlas, "joints", joints, 2)
        plane = plane_of(atlas, horizontal, vertical)
    with rc_context(RC):
        legend = legend_size(atlas)
        height = max(FRAME_SIDE + TICKS_BELOW + EDGE, legend.height)
        ticks = _room_for_ticks(atlas)
        size = (ticks + FRAME_SIDE + legend.width, height)
        figure = figure or Figure(figsize=size)
        margins = Margins(ticks, legend.width, TICKS_BELOW, EDGE)
        (axes,) = make_panels(figure, 1, 1, margins)
        draw_forms(axes, atlas, plane)
        draw_marks(axes, atlas, plane)
        draw_legend(figure, atlas, EDGE)
        if not shown_branches(atlas):
            note_emptiness(axes, atlas)
        label_points(axes, atlas, plane)
    return figure


def plot_joint_angles(
    atlas: Atlas, figure: Figure | None = None, input_joint: int = 1
) -> Figure:
    """Every unknown against the input one, in panels of their own.

    ``input_joint`` is counted from 1. Raises `ProblemError` where there is no such
    unknown.
    """
    (first,) = indices_of(atlas, "joints", [input_joint], 1)
    others = [i for i in range(len(atlas.names)) if i != first] or [first]
    columns = min(len(others), 3 if len(others) <= 9 else 4)
    rows = -(-len(others) // columns)
    with rc_context(RC):
        legend = legend_size(atlas)
        inner_height = rows * PANEL_SIDE + (rows - 1) * ROW_GAP
        height = max(inner_height + TICKS_BELOW + EDGE, legend.height)
        ticks = _room_for_ticks(atlas)
        column_gap = COLUMN_EDGE + ticks
        inner_width = columns * PANEL_SIDE + (columns - 1) * column_gap
        size = (ticks + inner_width + legend.width, height)
        figure = figure or Figure(figsize=size)
        margins = Margins(ticks, legend.width, TICKS_BELOW, EDGE, column_gap, ROW_GAP)
        panels = make_panels(figure, len(others), columns, margins)
        for k, other in enumerate(others):
            axes = panels[k]
            plane = plane_of(atlas, first, other)
            draw_forms(axes, atlas, plane, SMALL_PANEL)
            draw_marks(axes, atlas, plane, SMALL_PANEL)
            axes.xaxis.set_minor_locator(NullLocator())
            axes.yaxis.set_minor_locator(NullLocator())
            has_panel_below = k + columns < len(others)
            if has_panel_below:
                axes.set_xlabel("")
                axes.tick_params(labelbottom=False)
        draw_legend(figure, atlas, EDGE)
        if not shown_branches(atlas):
            note_emptiness(panels[0], atlas)
    return figure


def _room_for_ticks(atlas: Atlas) -> float:
    """Width of ticks, their labels and the name of an axis, in inches."""
    is_angle = [scale_of(atlas, i).half == 180.0 for i in range(len(atlas.names))]
    return TICKS if all(is_angle) else WIDE_TICKS


# --- files ----------------------------------------------------------------------------

FIGURES: dict[str, Callable[[Atlas], Figure]] = {
    "transition_map": plot_transition_map,
    "joint_angles": plot_joint_angles,
    "singular_values": plot_singular_values,
    "form_graph": plot_form_graph,
}


def save_figures(
    atlas: Atlas,
    folder: str | os.PathLike[str],
    others: Mapping[str, Callable[[Atlas], Figure]] | None = None,
) -> list[Path]:
    """Paths of the figures just written into an existing ``folder``, as PNG and SVG
    each; ``others`` are drawn in place of those of the same name.

    The unknowns of equations are drawn in `unknowns`, of anything else in
    `joint_angles`; with a parameter there is `diagram`.

    The same atlas gives the same bytes. There is never a half-written file. Raises
    `OSError` that names the file that cannot be written.
    """
    paths = []
    for name, plot in {**_figures_of(atlas), **(others or {})}.items():
        with rc_context(RC):
            figure = plot(atlas)
        paths += save_figure(figure, Path(folder) / name)
    return paths


def save_figure(figure: Figure, stem: Path) -> list[Path]:
    """The paths of a figure just written as PNG and as SVG, each ``stem`` with its
    ending.

    The same figure gives the same bytes; a file is written whole or not at all. Raises
    `OSError` that names the file that cannot be written.
    """
    with rc_context(RC):
        rendering = render(figure, RESOLUTION)
    paths = []
    for ending, content in rendering._asdict().items():
        path = stem.with_name(f"{stem.name}.{ending}")
        paths.append(replace_file(path, partial(_write, content)))
    return paths


def _figures_of(atlas: Atlas) -> dict[str, Callable[[Atlas], Figure]]:
    """The functions that draw the figures of an atlas, by the names of the files."""
    figures = dict(FIGURES)
    if atlas.subject.get("kind") == "system":
        figures["unknowns"] = figures.pop("joint_angles")
    if atlas.diagram is not None and atlas.diagram.parameter:
        figures["diagram"] = plot_diagram
    return figures


def _write(content: bytes, path: Path) -> None:
    path.write_bytes(content)
