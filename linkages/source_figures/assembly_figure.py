"""Figures of joint axes and links: panels with a graph that bears the names of the
links, and the same in space; one configuration from two sides; one linkage in several
configurations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.figures.style import Properties
from linkages.source_figures.assembly import Assembly, loop_assembly, turn
from linkages.source_figures.configurations import (
    atlas_of,
    configuration,
    form_named,
    loop_of_content,
)
from linkages.source_figures.construction import assembly_of
from linkages.source_figures.drawing import (
    LARGE,
    LINE_COLOR,
    SMALL,
    Look,
    best_look,
    clarity,
    clearest_of,
    draw_assembly,
    draw_row,
    look_along,
    symmetry_line,
)
from linkages.source_figures.graph_drawing import draw_graph
from linkages.source_figures.table import Content, SourceFigure

SLANT = np.array([1.0, 0.37])  # a direction on paper that no line is across
PANEL = 2.9  # width and height of a panel, in inches
MOST_COLUMNS = 4
CHOICES = 20  # configurations along a form, of which the clearest is drawn
FRONTS = 48  # looks across the line of symmetry among which the clearest is taken


# --- panels ---------------------------------------------------------------------------


def draw(source: SourceFigure) -> Figure:
    """The figure of panels: the graph above, the drawing in space below."""
    content = source.content
    panels = content["panels"]
    figure, cells = _grid(content)
    assemblies = [_clearest(panel) for panel in panels]
    looks = [best_look(assembly) for assembly in assemblies]
    if content.get("same_look"):
        looks = [looks[0]] * len(panels)
    pen = SMALL if cells.shape[2] > 3 else LARGE
    for number, (panel, assembly) in enumerate(zip(panels, assemblies, strict=True)):
        band, column = divmod(number, cells.shape[2])
        above, below = cells[band, 0, column], cells[band, -1, column]
        above.set_title(panel.get("title", ""), fontsize=9)
        names = {key: panel.get(key, ()) for key in ("filled", "unnumbered")}
        if above is not below:
            ring = _ring(panel, assembly)
            draw_graph(above, assembly, ring, panel.get("letters", {}), **names)
        look = looks[number]
        _draw_circles(below, assembly, panel.get("circles", ()), look)
        draw_assembly(below, assembly, look, pen=pen, **names)
        if panel.get("transversal"):
            _draw_transversal(below, assembly, look)
    return figure


def _clearest(panel: Content) -> Assembly:
    """The assembly of a panel; where the panel names no configuration, in that of
    several along the form that is clearest."""
    if "linkage" not in panel or "at" in panel or "part" in panel:
        return assembly_of(panel)
    places = (np.arange(CHOICES) + 0.5) / CHOICES
    assemblies = [assembly_of({**panel, "part": float(part)}) for part in places]
    merits = np.round([clarity(assembly) for assembly in assemblies], 9)
    return assemblies[int(np.argmax(merits))]


def _grid(content: Content) -> tuple[Figure, np.ndarray]:
    """A figure and its empty axes (bands, 1 or 2, columns): one below the other where
    panels have a graph."""
    count = len(content["panels"])
    each = 2 if content.get("graph", True) else 1
    size = content.get("size", PANEL)
    columns = content.get("columns", min(count, MOST_COLUMNS))
    bands = -(-count // columns)
    height = size * bands * each + 0.3 * bands
    figure = Figure(figsize=(max(size * columns, 3.6), height))
    cells = figure.subplots(bands * each, columns, squeeze=False)
    figure.subplots_adjust(
        left=0.01, right=0.99, bottom=0.01, top=1 - 0.3 / height, hspace=0.12
    )
    for axes in cells.flat:
        axes.set_axis_off()
    return figure, cells.reshape(bands, each, columns)


def _ring(panel: Content, assembly: Assembly) -> list[str]:
    """The joints that stand on a circle: all numbered ones, unless the panel says
    others."""
    if "ring" in panel:
        return list(panel["ring"].split())
    return [name for name in assembly.axes if name.isdigit() and name != "0"]


def _draw_circles(
    axes: Axes, assembly: Assembly, circles: Sequence[str], look: Look
) -> None:
    """The circles of joints about axes, each in words as ``3 about H``."""
    angles = np.linspace(0, 2 * np.pi, 181)
    for line in circles:
        name, _, other = line.split()
        axis = assembly.axes[other]
        arm = assembly.joint(name) - axis.point
        along = (arm @ axis.direction) * axis.direction
        centre = axis.point + along
        points = [centre + turn(arm - along, axis.direction, a) for a in angles]
        spots = np.array(points) @ look.plane
        axes.plot(*spots.T, color="0.75", linewidth=1, zorder=1)


def _draw_transversal(axes: Axes, assembly: Assembly, look: Look) -> None:
    """The line that meets all axes."""
    spots = transversal_points(assembly) @ look.plane
    first, last = int(np.argmin(spots @ SLANT)), int(np.argmax(spots @ SLANT))
    ends = spots[[first, last]]
    axes.plot(*ends.T, color=LINE_COLOR, linestyle="-.", linewidth=1.6, zorder=6)
    axes.plot(*spots.T, ".", color=LINE_COLOR, markersize=6, zorder=6)
    for joint, spot in zip(assembly.points() @ look.plane, spots, strict=True):
        reach = np.stack([joint, spot])
        axes.plot(*reach.T, color="0.6", linewidth=0.7, linestyle=":", zorder=1)


def transversal_points(assembly: Assembly) -> np.ndarray:
    """Where the common transversal of the joint axes of a loop of mobility 1 meets them
    (n, 3).

    The joint screws have rank 5; the wrench that does no work at any joint is a force
    along a line that meets every axis (Wohlhart 1987 found it from the symmetry).
    """
    axes = list(assembly.axes.values())
    screws = [np.append(a.direction, np.cross(a.point, a.direction)) for a in axes]
    wrench = np.linalg.svd(np.array(screws))[2][-1]
    moment, force = wrench[:3], wrench[3:]
    size = np.linalg.norm(force)
    line = force / size
    start = np.cross(force, moment) / size**2
    points = []
    for axis in axes:
        columns = np.column_stack([line, -axis.direction])
        solved = np.linalg.lstsq(columns, axis.point - start, rcond=None)[0]
        points.append(start + solved[0] * line)
    return np.array(points)


# --- two views ------------------------------------------------------------------------


def draw_views(source: SourceFigure) -> Figure:
    """A line-symmetric configuration from the front, the line of symmetry upright, and
    from above, along it."""
    loop = loop_of_content(source.content)
    assembly = loop_assembly(loop, configuration(source.content))
    centre, line = symmetry_line(assembly, loop.n)
    figure = Figure(figsize=(7.4, 3.3))
    panels = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.02, right=0.98, bottom=0.02, top=0.92)
    front = _front(assembly, line)
    views = (("front view", front), ("top view", look_along(line, front.near)))
    for axes, (title, look) in zip(panels, views, strict=True):
        draw_assembly(axes, assembly, look)
        _draw_line(axes, assembly, centre, line, look)
        axes.set_title(title, fontsize=9)
    return figure


def _front(assembly: Assembly, line: np.ndarray) -> Look:
    """The clearest look across the line of symmetry, which stands upright."""
    start = look_along(line).right
    other = np.cross(line, start)
    angles = np.linspace(0, 2 * np.pi, FRONTS, endpoint=False)
    looks = [look_along(np.cos(a) * start + np.sin(a) * other, line) for a in angles]
    return clearest_of([assembly], looks)


def _draw_line(
    axes: Axes, assembly: Assembly, centre: np.ndarray, line: np.ndarray, look: Look
) -> None:
    """The line of symmetry, a dot where it is seen end on."""
    half = 1.3 * float(np.abs((assembly.points() - centre) @ line).max())
    ends = (centre + np.array([[-half], [half]]) * line) @ look.plane
    style: Properties = {"color": LINE_COLOR, "zorder": 6}
    if np.linalg.norm(ends[1] - ends[0]) < 1e-6 * half:
        axes.plot(*ends[0], "o", markersize=7, fillstyle="none", **style)
        axes.plot(*ends[0], ".", markersize=3, **style)
    else:
        axes.plot(*ends.T, linestyle="-.", linewidth=1.4, **style)


# --- configurations along a form ------------------------------------------------------


def draw_motion(source: SourceFigure) -> Figure:
    """One linkage at equal distances along a form, always seen from the same side."""
    content = source.content
    loop = loop_of_content(content)
    branch = form_named(atlas_of(content), content.get("form", "")).branch
    count = content["count"]
    s = (np.arange(count) + 0.5) / count * branch.length
    assemblies = [loop_assembly(loop, theta) for theta in branch(s)]
    rows = -(-count // MOST_COLUMNS)
    figure = Figure(figsize=(2.3 * MOST_COLUMNS, 2.4 * rows))
    grid = figure.subplots(rows, MOST_COLUMNS, squeeze=False)
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.94)
    titles = [f"({number + 1})" for number in range(count)]
    draw_row(list(grid.flat), assemblies, titles, 8)
    return figure
