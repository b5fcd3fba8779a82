"""Figures of an atlas: the transition map, unknowns against the input, singular values,
and the graph of forms.

Each function draws into the figure given, or makes one, and returns it; nothing depends
on the state of pyplot. Settings of matplotlib are the user's where there are any
(`bifurc.figures.rc`). Forms are told apart by colour (safe for the colour-blind) and by
line style (safe in print).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.checks import UnknownName, check_type
from bifurc.figures.diagram_plot import plot_diagram
from bifurc.figures.drawing import (
    PanelSettings,
    draw_forms,
    draw_marks,
    legend_entries,
    note_emptiness,
)
from bifurc.figures.form_graph import plot_form_graph, shows_transitions
from bifurc.figures.labels import label_points
from bifurc.figures.layout import Canvas, Margins, PanelPlan, figure_of, lay_out
from bifurc.figures.planes import (
    choose_plane,
    compared_unknowns,
    indices_of,
    plane_of,
    scale_of,
    shown_branches,
)
from bifurc.figures.rc import drawing_style
from bifurc.figures.rendering import contents_of
from bifurc.figures.selection import EVERYTHING, Selection
from bifurc.figures.singular_values import plot_singular_values
from bifurc.files.atomic import replace_file

RESOLUTION = 140  # dots per inch of the files
NARROW_TICKS = 0.62  # in inches, at the left of a frame: ticks and the name of the axis
WIDE_TICKS = 0.9  # the same where these are not angles in degrees
TICKS_BELOW = 0.45  # the same below it
EDGE = 0.15  # beside a frame where nothing stands
LEAST_HEIGHT = 1.4  # of the frame of the transition map


def plot_transition_map(
    atlas: Atlas,
    figure: Canvas | None = None,
    joints: Sequence[UnknownName | int] | None = None,
    *,
    ax: Axes | None = None,
    selection: Selection = EVERYTHING,
) -> Figure:
    """The forms in the plane of two unknowns, with the singular points marked and
    named.

    ``joints`` are two unknowns, by their names or by their numbers from 1; left out,
    the plane is chosen that tells the forms apart best. Angles are drawn in degrees on
    the torus. It is drawn into ``ax``, whose lines are then named for a legend, or with
    a legend into a ``figure`` or a part of one, or into a new one. Raises
    `ProblemError` for what are not two of the unknowns.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> figure = bifurc.plot_transition_map(atlas, joints=(1, 3))
    >>> [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    [('θ₁ (deg)', 'θ₃ (deg)')]
    """
    check_type("atlas", atlas, Atlas)
    if joints is None:
        horizontal, vertical = choose_plane(atlas)
    else:
        horizontal, vertical = indices_of(atlas, "joints", joints, 2)
    plane = plane_of(atlas, horizontal, vertical, selection.window)
    settings = PanelSettings(selection=selection)
    with drawing_style():
        if ax is None:
            margins = Margins(_room_for_ticks(atlas), EDGE, TICKS_BELOW, EDGE)
            plan = PanelPlan(1, 1, 4.3, 4.3, margins, least_height=LEAST_HEIGHT)
            figure, (ax,), _ = lay_out(figure, plan, legend_entries(atlas, selection))
        draw_forms(ax, atlas, plane, settings)
        draw_marks(ax, atlas, plane, settings)
        _note_emptiness(ax, atlas)
        label_points(ax, atlas, plane, selection)
    return figure_of(ax)


def plot_joint_angles(
    atlas: Atlas,
    figure: Canvas | None = None,
    input_joint: UnknownName | int = 1,
    *,
    selection: Selection = EVERYTHING,
) -> Figure:
    """Every unknown, of many some, against the input one, in panels of their own, in a ``figure`` or a
    part of one, or in a new one.

    ``input_joint`` is a name or a number from 1. Raises `ProblemError` where there is
    no such unknown.

    >>> import bifurc, linkages
    >>> atlas = linkages.map_linkage(linkages.load("rhombus"))
    >>> figure = bifurc.plot_joint_angles(atlas, input_joint=2)
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['θ₁ (deg)', 'θ₃ (deg)', 'θ₄ (deg)']
    """
    (first,) = indices_of(atlas, "input_joint", [input_joint], 1)
    others = [i for i in compared_unknowns(atlas) if i != first] or [first]
    columns = min(len(others), 3 if len(others) <= 9 else 4)
    settings = PanelSettings(line_width=1.4, mark_size=3.5, selection=selection)
    with drawing_style():
        ticks = _room_for_ticks(atlas)
        margins = Margins(ticks, EDGE, TICKS_BELOW, EDGE, EDGE + ticks, 2 * EDGE)
        plan = PanelPlan(len(others), columns, 1.6, 1.6, margins)
        sheet = lay_out(figure, plan, legend_entries(atlas, selection))
        for k, (axes, other) in enumerate(zip(sheet.panels, others, strict=True)):
            plane = plane_of(atlas, first, other, selection.window)
            draw_forms(axes, atlas, plane, settings)
            draw_marks(axes, atlas, plane, settings)
            has_panel_below = k + sheet.columns < len(others)
            if has_panel_below:
                axes.set_xlabel("")
                axes.tick_params(labelbottom=False)
        _note_emptiness(sheet.panels[0], atlas)
    return figure_of(sheet.canvas)


def _note_emptiness(axes: Axes, atlas: Atlas) -> None:
    """Say so where nothing is drawn: marks of isolated solutions are in the legend."""
    if not shown_branches(atlas) and not len(atlas.rigid) and not atlas.points:
        note_emptiness(axes, atlas)


def _room_for_ticks(atlas: Atlas) -> float:
    """Width of ticks, their labels and the name of an axis, in inches."""
    is_angle = [scale_of(atlas, i).is_degrees for i in range(len(atlas.names))]
    return NARROW_TICKS if all(is_angle) else WIDE_TICKS


# --- files ----------------------------------------------------------------------------

FORMATS = ("png", "svg", "pdf")
USUAL_FORMATS = ("png", "svg")

Plot: TypeAlias = Callable[[Atlas], Figure]


def save_figures(
    atlas: Atlas,
    folder: str | os.PathLike[str],
    others: Mapping[str, Plot] = MappingProxyType({}),
    formats: Sequence[str] = USUAL_FORMATS,
    selection: Selection = EVERYTHING,
) -> list[Path]:
    """Paths of the figures just written into an existing ``folder``, in all of the
    ``formats``, some of `FORMATS`; ``others`` are drawn in place of those of the same
    name, or besides.

    The unknowns of equations are drawn in `unknowns`, of anything else in
    `joint_angles`; with a parameter there is `diagram`. What would show nothing is not
    written: singular values without a form, a graph of one box.

    The same atlas gives the same bytes, by the same settings of matplotlib. There is
    never a half-written file. Raises `OSError` that names the file that cannot be
    written.
    """
    paths = []
    for name, plot in {**_figures_of(atlas, selection), **others}.items():
        with drawing_style():
            figure = plot(atlas)
        paths += save_figure(figure, Path(folder) / name, formats)
    return paths


def save_figure(
    figure: Figure, stem: Path, formats: Sequence[str] = USUAL_FORMATS
) -> list[Path]:
    """The paths of a figure just written, in each format to ``stem`` with its ending.

    The same figure gives the same bytes; a file is written whole or not at all. Raises
    `OSError` that names the file that cannot be written.
    """
    with drawing_style():
        contents = contents_of(figure, RESOLUTION, formats)
    paths = []
    for ending, content in contents.items():
        path = stem.with_name(f"{stem.name}.{ending}")
        paths.append(replace_file(path, partial(_write, content)))
    return paths


def _figures_of(atlas: Atlas, selection: Selection) -> dict[str, Plot]:
    """The functions that draw the figures of an atlas, by the names of the files."""
    figures: dict[str, Plot] = {
        "transition_map": partial(plot_transition_map, selection=selection)
    }
    is_system = atlas.subject.get("kind") == "system"
    name = "unknowns" if is_system else "joint_angles"
    figures[name] = partial(plot_joint_angles, selection=selection)
    if atlas.forms:
        figures["singular_values"] = partial(plot_singular_values, selection=selection)
    if shows_transitions(atlas, selection):
        figures["form_graph"] = partial(plot_form_graph, selection=selection)
    if atlas.diagram is not None and atlas.diagram.parameter:
        figures["diagram"] = plot_diagram
    return figures


def _write(content: bytes, path: Path) -> None:
    path.write_bytes(content)
