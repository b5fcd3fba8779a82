"""What figures are made of: panels at places that are known beforehand, forms and
singular points in a plane, the legend, and a word where there is nothing to draw.

A layout engine measures every text of a figure to find the same places, twice, which
takes longer than to draw it.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path
from matplotlib.ticker import MultipleLocator
from matplotlib.transforms import ScaledTranslation

from bifurc.atlas import Atlas, Event
from bifurc.decisions import closes_to_rounding
from bifurc.figures.planes import (
    Plane,
    Scale,
    curve_points,
    cut_to_frame,
    place_in_frame,
    shown_branches,
)
from bifurc.figures.rendering import RC
from bifurc.figures.style import (
    Properties,
    Style,
    form_style,
    hollow,
    near_motion_style,
)
from bifurc.singular.point import Kind, Mark

NAME_WIDTH = 24  # letters of a line of the legend
LETTER_SIZE = RC["legend.fontsize"]
HANDLE_LENGTH = 3.2  # of the line beside a name, over the size of a letter
HANDLE_GAP = 0.8  # between the two, over the same
LEGEND_GAP = 0.2  # at both sides of the legend, in inches
LINE_HEIGHT = 0.18  # of the legend, in inches
# In inches, from the frame to the name of an axis; between them are the ticks.
NAME_BELOW = 0.27
NAME_LEFT = 0.46
AS_DRAWN_LABEL = "as drawn"
AS_DRAWN: Properties = {"marker": "*", "markersize": 8, "color": "black"}
DEAD: Properties = {"marker": "s", "markersize": 3.2, "color": "0.25"}
RIGID_LABEL = "rigid assembly"
SURFACE_LABEL = "mobility 2 or more"
FLAT_SAMPLES = 32  # of each form, by which the largest unknown is seen
FLAT = 1e-9  # of the largest unknown: an axis that shows less shows rounding
FLAT_HALF = 0.1  # of the largest unknown: half of what is shown instead


# --- panels ---------------------------------------------------------------------------


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


def columns_of(count: int) -> int:
    """How many of so many panels, one a form, stand side by side."""
    return 1 if count == 1 else 2 if count <= 8 else 3


def widen_flat_axes(
    axes: Axes, atlas: Atlas, factors: tuple[float, float] = (1.0, 1.0)
) -> None:
    """Show more of an axis along which nothing changes but for rounding; ``factors``
    are those of the axes, by which unknowns are multiplied to be shown."""
    samples = [branch.sample(FLAT_SAMPLES) for branch in shown_branches(atlas)]
    largest = max((float(np.abs(one).max(initial=0.0)) for one in samples), default=0.0)
    width, height = (factor * (largest or 1.0) for factor in factors)
    if np.ptp(axes.get_xlim()) < FLAT * width:
        middle = float(np.mean(axes.get_xlim()))
        axes.set_xlim(middle - FLAT_HALF * width, middle + FLAT_HALF * width)
    if np.ptp(axes.get_ylim()) < FLAT * height:
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - FLAT_HALF * height, middle + FLAT_HALF * height)


def name_above(axes: Axes, x: float, name: str, **style: Any) -> None:
    """The name of something at an abscissa, above the frame."""
    axes.annotate(
        name,
        (x, 1.0),
        (0, 2),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        ha="center",
        fontsize=8,
        **style,
    )


# --- forms ----------------------------------------------------------------------------


@dataclass(frozen=True)
class PanelSettings:
    """How forms and points are drawn in one panel: ``line_width`` and ``mark_size`` in
    points, each mark in its own size unless that is given."""

    line_width: float = 1.8
    mark_size: float | None = None


DEFAULT_PANEL = PanelSettings()


def draw_forms(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """All forms in a plane, near motions dotted, with axes to match."""
    for i, branch in enumerate(shown_branches(atlas)):
        points = plane.project(curve_points(branch))
        if len(points):
            rows = cut_to_frame(points, plane.scales)
            # not cut at the frame, in which curves on a torus lie anyway
            line = curve_style(atlas, i).line
            style: Properties = {"linewidth": settings.line_width, **line}
            axes.plot(*rows.T, clip_on=False, zorder=2, **style)
    horizontal, vertical = plane.scales
    _label_axis(axes.xaxis, horizontal)
    _label_axis(axes.yaxis, vertical)
    if horizontal.is_periodic:
        axes.set_xlim(-horizontal.half, horizontal.half)
    if vertical.is_periodic:
        axes.set_ylim(-vertical.half, vertical.half)
    if horizontal.is_periodic and vertical.is_periodic:
        axes.set_box_aspect(1)
        fix_names_of_axes(axes)
    widen_flat_axes(axes, atlas, (horizontal.factor, vertical.factor))
    axes.grid(True)
    for spine in axes.spines.values():
        spine.set_zorder(1)  # forms that lie on the edge of the frame are drawn over it


def curve_style(atlas: Atlas, index: int) -> Style:
    """Style of number ``index`` of the `shown_branches` of an atlas."""
    if index < len(atlas.forms):
        return form_style(index)
    return near_motion_style(index)


def _label_axis(axis: Axis, scale: Scale) -> None:
    """Name and ticks; a whole turn is divided by right angles."""
    axis.set_label_text(scale.label)
    if scale.half == 180.0:
        axis.set_major_locator(MultipleLocator(90))
        axis.set_minor_locator(MultipleLocator(30))


# --- marks ----------------------------------------------------------------------------


def draw_marks(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """Singular points, isolated solutions, surfaces, and the configuration as drawn in a
    plane, on both edges where they lie on one."""
    for surface in atlas.surfaces:
        shown = place_in_frame(plane.project(surface.samples), plane.scales)
        axes.plot(*shown.T, ".", color="0.6", markersize=2, zorder=1)
    for solution in atlas.rigid:
        size = settings.mark_size or 5.5
        style: Properties = {"color": "0.3", "markersize": size, "zorder": 3}
        axes.plot(*plane.copies(solution).T, "x", clip_on=False, **style)
    _draw_as_given(axes, atlas, plane)
    spots: dict[Mark, list[np.ndarray]] = {}
    for point in atlas.points:
        mark = point.kind.mark
        mark = mark._replace(size=settings.mark_size or mark.size)
        spots.setdefault(mark, []).append(plane.copies(point.point.u))
    for mark, places in spots.items():
        style = {"markeredgewidth": 1.1, **hollow(mark)}
        axes.plot(*np.concatenate(places).T, ls="", clip_on=False, zorder=4, **style)


def _draw_as_given(axes: Axes, atlas: Atlas, plane: Plane) -> None:
    """The configuration as drawn, if there is one, and dead points of drivers."""
    for event in _driven(atlas):
        style = {"clip_on": False, "zorder": 3.5, **DEAD}
        axes.plot(*plane.copies(event.u).T, ls="", **style)
    if atlas.drawn is not None:
        style = {"clip_on": False, "zorder": 5, **AS_DRAWN}
        axes.plot(*plane.copies(atlas.drawn).T, ls="", **style)


# --- the legend -----------------------------------------------------------------------


def draw_legend(figure: Figure, atlas: Atlas, edge: float) -> None:
    """Names of the forms and of the marks, at the right of the figure, ``edge`` (inches)
    below its top."""
    width, height = figure.get_size_inches()
    left = 1 - (legend_size(atlas).width - LEGEND_GAP) / width
    _draw_legend(
        figure,
        atlas,
        loc="upper left",
        bbox_to_anchor=(left, 1 - edge / height),
        borderpad=0,
        borderaxespad=0,
        handletextpad=HANDLE_GAP,
    )


def draw_legend_outside(figure: Figure, atlas: Atlas) -> None:
    """The same at the right of a figure whose layout makes room for it."""
    _draw_legend(figure, atlas, loc="outside right upper")


def _draw_legend(figure: Figure, atlas: Atlas, **options: Any) -> None:
    entries = list(_entries(atlas))
    if entries:
        length = HANDLE_LENGTH
        figure.legend(handles=entries, frameon=False, handlelength=length, **options)


def _entries(atlas: Atlas) -> Iterator[Line2D]:
    """Entries of the forms, of the singular points, kind by kind, of isolated solutions
    and of surfaces, as far as there are any."""
    for i, form in enumerate(atlas.forms):
        name = textwrap.fill(form.name, NAME_WIDTH)
        yield Line2D([], [], linewidth=1.8, label=name, **form_style(i).line)
    curves = [near for near in atlas.near_motions if near.branch]
    for i, near in enumerate(curves, start=len(atlas.forms)):
        name = f"{near.name}, misses\nclosure by {near.misclosure:.1e}"
        yield Line2D([], [], linewidth=1.8, label=name, **near_motion_style(i).line)
    for label, style in _marks_of(atlas):
        yield Line2D([], [], linestyle="", label=label, **style)


def _driven(atlas: Atlas) -> list[Event]:
    """The dead points of the unknowns that drive, and do not stand still."""
    drivers = atlas.subject.get("drivers", ())
    events = [event for event in atlas.dead_points if event.index in drivers]
    moving = []
    for event in events:
        values = atlas.forms[event.form].branch.sample(FLAT_SAMPLES)[:, event.index]
        if np.ptp(values) > FLAT:
            moving.append(event)
    return moving


def _marks_of(atlas: Atlas) -> list[tuple[str, Properties]]:
    """What the marks of an atlas mean, and how each is drawn."""
    marks: list[tuple[str, Properties]] = []
    for kind in dict.fromkeys(point.kind for point in atlas.points):
        marks.append((kind.value, hollow(kind.mark)))
    if len(atlas.rigid):
        marks.append((RIGID_LABEL, {"marker": "x", "color": "0.3"}))
    if atlas.surfaces:
        marks.append((SURFACE_LABEL, {"marker": ".", "color": "0.6"}))
    for index in sorted({event.index for event in _driven(atlas)}):
        marks.append((f"dead point of {atlas.names[index]}", DEAD))
    if atlas.drawn is not None:
        marks.append((AS_DRAWN_LABEL, AS_DRAWN))
    return marks


class LegendSize(NamedTuple):
    """Room that the legend takes, in inches."""

    width: float
    height: float


def legend_size(atlas: Atlas) -> LegendSize:
    """Room that the legend of an atlas takes, with the gaps beside it."""
    letters = FontProperties(size=LETTER_SIZE)
    longest = 0.0
    height = LINE_HEIGHT
    for entry in _entries(atlas):
        for line in str(entry.get_label()).splitlines():
            size = text_to_path.get_text_width_height_descent(line, letters, False)
            longest = max(longest, size[0])
            height += LINE_HEIGHT
    points = longest + LETTER_SIZE * (HANDLE_LENGTH + HANDLE_GAP)
    return LegendSize(points / 72 + 2 * LEGEND_GAP, height)


# --- nothing to draw ------------------------------------------------------------------


def note_emptiness(axes: Axes, atlas: Atlas) -> None:
    """Say so in the middle of the frame where there is no form."""
    if atlas.forms:
        return
    style: Properties = {"ha": "center", "va": "center", "color": "0.4"}
    note = "\n".join(emptiness(atlas))
    axes.text(0.5, 0.5, note, transform=axes.transAxes, fontsize=11, **style)


def emptiness(atlas: Atlas) -> list[str]:
    """What is said where there is no form, a line each."""
    if atlas.near_motions:
        least = min(near.misclosure for near in atlas.near_motions)
        return ["no form", f"near motions miss closure by {least:.1e} or more"]
    if len(atlas.rigid) or any(point.kind is Kind.ISOLATED for point in atlas.points):
        return ["no form", "it closes, and is rigid"]
    if closes_to_rounding(atlas.closure_gap) and atlas.closure_gap > 0:
        return ["no form within the bounds"]
    if 0 < atlas.closure_gap < np.inf:
        return ["no form", f"closure gap {atlas.closure_gap:.1e}"]
    return ["no form"]
