"""Figures of a line-symmetric configuration from the front and from above, with its
line of symmetry; and of one linkage in several configurations."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from linkages.source_figures.assembly import Assembly, loop_assembly
from linkages.source_figures.configurations import (
    atlas_of,
    configuration,
    form_named,
    loop_of_content,
)
from linkages.source_figures.drawing import (
    SMALL,
    Look,
    clearest_of,
    common_look,
    draw_assembly,
    look_along,
    symmetry_line,
)
from linkages.source_figures.table import SourceFigure

LINE_COLOR = "#009E73"
FRONTS = 48  # looks across the line of symmetry among which the clearest is taken


def draw_views(source: SourceFigure) -> Figure:
    """The front view, the line of symmetry upright, and the view along it."""
    loop = loop_of_content(source.content)
    theta = configuration(source.content)
    names = [str(i + 1) for i in range(loop.n)]
    assembly = loop_assembly(loop, theta, names, [""] * loop.n)
    centre, line = symmetry_line(assembly, loop.n)
    figure = Figure(figsize=(7.4, 3.3))
    front, top = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.02, right=0.98, bottom=0.02, top=0.92)
    look = _front(assembly, line)
    draw_assembly(front, assembly, look)
    _draw_line(front, assembly, centre, line, look)
    front.set_title("front view", fontsize=9)
    look = look_along(line, look.near)
    draw_assembly(top, assembly, look)
    _draw_line(top, assembly, centre, line, look)
    top.set_title("top view", fontsize=9)
    return figure


def _front(assembly: Assembly, line: np.ndarray) -> Look:
    """The clearest look across the line of symmetry, which stands upright."""
    start = look_along(line, np.array([0.0, 0.0, 1.0])).right
    other = np.cross(line, start)
    angles = np.linspace(0, 2 * np.pi, FRONTS, endpoint=False)
    looks = [look_along(np.cos(a) * start + np.sin(a) * other, line) for a in angles]
    return clearest_of([assembly], looks)


def _draw_line(
    axes: Axes, assembly: Assembly, centre: np.ndarray, line: np.ndarray, look: Look
) -> None:
    """The line of symmetry, a dot where it is seen end on."""
    points = np.array([assembly.joint(name) for name in assembly.axes])
    half = 1.3 * float(np.abs((points - centre) @ line).max())
    plane = np.stack([look.right, look.up], axis=1)
    ends = (centre + np.array([[-half], [half]]) * line) @ plane
    if np.linalg.norm(ends[1] - ends[0]) < 1e-6 * half:
        axes.plot(
            *ends[0], "o", color=LINE_COLOR, markersize=7, fillstyle="none", zorder=6
        )
        axes.plot(*ends[0], ".", color=LINE_COLOR, markersize=3, zorder=6)
    else:
        axes.plot(*ends.T, color=LINE_COLOR, linestyle="-.", linewidth=1.4, zorder=6)


def draw_motion(source: SourceFigure) -> Figure:
    """One linkage at equal distances along a form, always seen from the same side."""
    content = source.content
    loop = loop_of_content(content)
    form = form_named(atlas_of(content), content.get("form", ""))
    count = content["count"]
    s = (np.arange(count) + 0.5) / count * form.branch.length
    names = [str(i + 1) for i in range(loop.n)]
    assemblies = [
        loop_assembly(loop, theta, names, [""] * loop.n) for theta in form.branch(s)
    ]
    look = common_look(assemblies)
    columns = 4
    rows = -(-count // columns)
    figure = Figure(figsize=(2.3 * columns, 2.4 * rows))
    grid = figure.subplots(rows, columns, squeeze=False)
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.94)
    for axes in grid.flat:
        axes.set_axis_off()
    for number, assembly in enumerate(assemblies):
        axes = grid.flat[number]
        draw_assembly(axes, assembly, look, pen=SMALL)
        axes.set_title(f"({number + 1})", fontsize=8, pad=2)
    return figure
