"""Figures of joint axes and links: panels with a graph that bears the names of the
links, and the same in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from linkages.source_figures.assembly import Assembly, turn
from linkages.source_figures.construction import assembly_of
from linkages.source_figures.drawing import (
    LARGE,
    SMALL,
    Look,
    best_look,
    clarity,
    draw_assembly,
)
from linkages.source_figures.graph_drawing import draw_graph
from linkages.source_figures.table import Content, SourceFigure

SLANT = np.array([1.0, 0.37])  # a direction on paper that no line is across

PANEL = 2.9  # width and height of a panel, in inches
MOST_COLUMNS = 4
CHOICES = 20  # configurations along a form, of which the clearest is drawn


def draw(source: SourceFigure) -> Figure:
    """The figure of panels: the graph above, the drawing in space below."""
    content = source.content
    panels = content["panels"]
    grid = _grid(content)
    assemblies = [_clearest(panel) for panel in panels]
    looks = [best_look(assembly) for assembly in assemblies]
    if content.get("same_look"):
        looks = [looks[0]] * len(panels)
    pen = SMALL if grid.columns > 3 else LARGE
    for number, (panel, assembly) in enumerate(zip(panels, assemblies, strict=True)):
        above, below = grid.panel(number)
        filled = tuple(panel.get("filled", ()))
        unnumbered = tuple(panel.get("unnumbered", ()))
        if above is not None:
            draw_graph(
                above,
                assembly,
                _ring(panel, tuple(assembly.axes)),
                filled=filled,
                unnumbered=unnumbered,
                letters=_letters(panel),
            )
        (above or below).set_title(panel.get("title", ""), fontsize=9)
        look = looks[number]
        _draw_circles(below, assembly, panel.get("circles", ()), look)
        draw_assembly(
            below, assembly, look, filled=filled, unnumbered=unnumbered, pen=pen
        )
        if panel.get("transversal"):
            _draw_transversal(below, assembly, look)
    return grid.figure


def _clearest(panel: Content) -> Assembly:
    """The assembly of a panel; where the panel names no configuration, in that of
    several along the form that is clearest."""
    if "linkage" not in panel or "at" in panel or "part" in panel:
        return assembly_of(panel)
    places = (np.arange(CHOICES) + 0.5) / CHOICES
    assemblies = [assembly_of({**panel, "part": float(part)}) for part in places]
    merits = np.round([clarity(assembly) for assembly in assemblies], 9)
    return assemblies[int(np.argmax(merits))]


@dataclass(frozen=True)
class Grid:
    """The ``figure`` and its ``cells``, rows of axes; ``has_graph`` says whether each
    panel has two, one below the other."""

    figure: Figure
    cells: np.ndarray
    has_graph: bool

    @property
    def columns(self) -> int:
        """Panels side by side."""
        return int(self.cells.shape[1])

    def panel(self, number: int) -> tuple[Axes | None, Axes]:
        """The axes of the graph, if there is one, and of the drawing of a panel."""
        band, column = divmod(number, self.columns)
        if not self.has_graph:
            return None, self.cells[band, column]
        return self.cells[2 * band, column], self.cells[2 * band + 1, column]


def _grid(content: Content) -> Grid:
    """Empty axes for all panels of a figure."""
    count = len(content["panels"])
    has_graph = content.get("graph", True)
    size = content.get("size", PANEL)
    columns = content.get("columns", min(count, MOST_COLUMNS))
    bands = -(-count // columns)
    rows = bands * (2 if has_graph else 1)
    height = size * rows + 0.3 * bands
    figure = Figure(figsize=(max(size * columns, 3.6), height))
    cells = figure.subplots(rows, columns, squeeze=False)
    figure.subplots_adjust(
        left=0.01, right=0.99, bottom=0.01, top=1 - 0.3 / height, hspace=0.12
    )
    for axes in cells.flat:
        axes.set_axis_off()
    return Grid(figure, cells, has_graph)


def _draw_circles(
    axes: Axes, assembly: Assembly, circles: Sequence[str], look: Look
) -> None:
    """The circles of joints about axes, each in words as ``3 about H``."""
    plane = np.stack([look.right, look.up], axis=1)
    angles = np.linspace(0, 2 * np.pi, 181)
    for line in circles:
        name, _, other = line.split()
        axis = assembly.axes[other]
        arm = assembly.joint(name) - axis.point
        along = (arm @ axis.direction) * axis.direction
        centre = axis.point + along
        points = [centre + turn(arm - along, axis.direction, a) for a in angles]
        axes.plot(*(np.array(points) @ plane).T, color="0.75", linewidth=1, zorder=1)


def _draw_transversal(axes: Axes, assembly: Assembly, look: Look) -> None:
    """The line that meets all axes."""
    plane = np.stack([look.right, look.up], axis=1)
    points = transversal_points(assembly)
    spots = points @ plane
    first, last = int(np.argmin(spots @ SLANT)), int(np.argmax(spots @ SLANT))
    ends = spots[[first, last]]
    axes.plot(*ends.T, color="#009E73", linestyle="-.", linewidth=1.6, zorder=6)
    axes.plot(*spots.T, ".", color="#009E73", markersize=6, zorder=6)
    for name, point in zip(assembly.axes, points, strict=True):
        reach = np.stack([assembly.joint(name), point]) @ plane
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


def _ring(panel: Content, names: tuple[str, ...]) -> tuple[str, ...]:
    """The joints that stand on a circle: all numbered ones, unless the panel says
    others."""
    if "ring" in panel:
        return tuple(panel["ring"].split())
    return tuple(name for name in names if name.isdigit() and name != "0")


def _letters(panel: Content) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Letters of parts of the graph, with the joints that they stand between."""
    return tuple(
        (letter, tuple(joints.split()))
        for letter, joints in panel.get("letters", {}).items()
    )
