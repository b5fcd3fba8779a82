"""What figures are made of: forms and singular points in a plane, the legend, and a
word where there is nothing to draw."""

from __future__ import annotations

import textwrap
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

from bifurc.atlas import Atlas
from bifurc.decisions import closes_to_rounding
from bifurc.figures.panels import fix_names_of_axes
from bifurc.figures.planes import (
    Plane,
    Scale,
    curve_points,
    cut_to_frame,
    place_in_frame,
)
from bifurc.figures.style import RC, Mark, Style, form_style, mark_of

NAME_WIDTH = 24  # letters of a line of the legend
LETTER_SIZE = RC["legend.fontsize"]
HANDLE_LENGTH = 3.2  # of the line beside a name, over the size of a letter
HANDLE_GAP = 0.8  # between the two, over the same
LEGEND_GAP = 0.2  # at both sides of the legend, in inches
LINE_HEIGHT = 0.18  # of the legend, in inches
RIGID_LABEL = "rigid assembly"
SURFACE_LABEL = "mobility 2 or more"


@dataclass(frozen=True)
class PanelSettings:
    """How forms and points are drawn in one panel: ``line_width`` and ``mark_size`` in
    points, each mark in its own size unless that is given."""

    line_width: float = 1.8
    mark_size: float | None = None


DEFAULT_PANEL = PanelSettings()


FLAT_SAMPLES = 32  # of each form, by which the largest unknown is seen
FLAT = 1e-9  # of the largest unknown: an axis that shows less shows rounding
FLAT_HALF = 0.1  # of the largest unknown: half of what is shown instead


def widen_flat_axes(
    axes: Axes, atlas: Atlas, factors: tuple[float, float] = (1.0, 1.0)
) -> None:
    """Show more of an axis along which nothing changes but for rounding; ``factors``
    are those of the axes, by which unknowns are multiplied to be shown."""
    samples = [form.branch.sample(FLAT_SAMPLES) for form in atlas.forms]
    largest = max((float(np.abs(one).max(initial=0.0)) for one in samples), default=0.0)
    width, height = (factor * (largest or 1.0) for factor in factors)
    if np.ptp(axes.get_xlim()) < FLAT * width:
        middle = float(np.mean(axes.get_xlim()))
        axes.set_xlim(middle - FLAT_HALF * width, middle + FLAT_HALF * width)
    if np.ptp(axes.get_ylim()) < FLAT * height:
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - FLAT_HALF * height, middle + FLAT_HALF * height)


# --- forms ----------------------------------------------------------------------------


def draw_forms(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """All forms in a plane, with axes to match."""
    for i, form in enumerate(atlas.forms):
        points = plane.project(curve_points(form.branch))
        if len(points):
            rows = cut_to_frame(points, plane.scales)
            draw_curve(axes, rows, form_style(i), settings.line_width)
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


def _label_axis(axis: Axis, scale: Scale) -> None:
    """Name and ticks; a whole turn is divided by right angles."""
    axis.set_label_text(scale.label)
    if scale.half == 180.0:
        axis.set_major_locator(MultipleLocator(90))
        axis.set_minor_locator(MultipleLocator(30))


def draw_curve(
    axes: Axes, rows: np.ndarray, style: Style, width: float, cut: bool = False
) -> None:
    """One line through rows (k, 2) with breaks at NaN; not cut at the frame, in which a
    torus's curves lie anyway."""
    axes.plot(
        rows[:, 0],
        rows[:, 1],
        color=style.color,
        linestyle=style.dashes,
        linewidth=width,
        clip_on=cut,
        zorder=2,
    )


# --- marks ----------------------------------------------------------------------------


def draw_marks(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """Singular points, isolated solutions and surfaces in a plane, on both edges where
    they lie on one."""
    for surface in atlas.surfaces:
        _draw_surface(axes, plane, surface.samples)
    for solution in atlas.rigid:
        _draw_assembly(axes, plane.copies(solution), settings.mark_size or 5.5)
    spots: dict[Mark, list[np.ndarray]] = {}
    for point in atlas.points:
        symbol, usual_size = mark_of(point.kind)
        mark = Mark(symbol, settings.mark_size or usual_size)
        spots.setdefault(mark, []).append(plane.copies(point.point.u))
    for mark, places in spots.items():
        _draw_singular_points(axes, np.concatenate(places), mark)


def _draw_surface(axes: Axes, plane: Plane, samples: np.ndarray) -> None:
    spots = place_in_frame(plane.project(samples), plane.scales)
    axes.plot(spots[:, 0], spots[:, 1], ".", color="0.6", markersize=2, zorder=1)


def _draw_assembly(axes: Axes, spots: np.ndarray, size: float) -> None:
    axes.plot(
        spots[:, 0],
        spots[:, 1],
        "x",
        color="0.3",
        markersize=size,
        clip_on=False,
        zorder=3,
    )


def _draw_singular_points(axes: Axes, spots: np.ndarray, mark: Mark) -> None:
    axes.plot(
        spots[:, 0],
        spots[:, 1],
        mark.symbol,
        markersize=mark.size,
        markerfacecolor="white",
        markeredgecolor="black",
        markeredgewidth=1.1,
        clip_on=False,
        zorder=4,
    )


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


# --- the legend -----------------------------------------------------------------------


def draw_legend(figure: Figure, atlas: Atlas, edge: float) -> None:
    """Names of the forms and of the marks, at the right of the figure, ``edge`` (inches)
    below its top."""
    entries = _form_entries(atlas) + _mark_entries(atlas)
    if not entries:
        return
    width, height = figure.get_size_inches()
    left = 1 - (legend_size(atlas).width - LEGEND_GAP) / width
    top = 1 - edge / height
    figure.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=(left, top),
        borderpad=0,
        borderaxespad=0,
        handlelength=HANDLE_LENGTH,
        handletextpad=HANDLE_GAP,
        frameon=False,
    )


def draw_legend_outside(figure: Figure, atlas: Atlas) -> None:
    """The same at the right of a figure whose layout makes room for it."""
    entries = _form_entries(atlas) + _mark_entries(atlas)
    if entries:
        figure.legend(
            handles=entries,
            loc="outside right upper",
            frameon=False,
            handlelength=HANDLE_LENGTH,
        )


def _form_entries(atlas: Atlas) -> list[Line2D]:
    entries = []
    for i, name in enumerate(_wrapped_names(atlas)):
        style = form_style(i)
        entries.append(
            Line2D(
                [],
                [],
                color=style.color,
                linestyle=style.dashes,
                linewidth=1.8,
                label=name,
            )
        )
    return entries


def _mark_entries(atlas: Atlas) -> list[Line2D]:
    """Entries of the singular points, kind by kind, of isolated solutions and of
    surfaces, as far as there are any."""
    entries = []
    for kind in dict.fromkeys(point.kind for point in atlas.points):
        mark = mark_of(kind)
        entries.append(
            Line2D(
                [],
                [],
                linestyle="",
                marker=mark.symbol,
                markersize=mark.size,
                markerfacecolor="white",
                markeredgecolor="black",
                label=kind.value,
            )
        )
    if len(atlas.rigid):
        entries.append(_plain_entry("x", "0.3", RIGID_LABEL))
    if atlas.surfaces:
        entries.append(_plain_entry(".", "0.6", SURFACE_LABEL))
    return entries


def _plain_entry(symbol: str, color: str, label: str) -> Line2D:
    return Line2D([], [], linestyle="", marker=symbol, color=color, label=label)


class LegendSize(NamedTuple):
    """Room that the legend takes, in inches."""

    width: float
    height: float


def legend_size(atlas: Atlas) -> LegendSize:
    """Room that the legend of an atlas takes, with the gaps beside it."""
    letters = FontProperties(size=LETTER_SIZE)
    longest = 0.0
    height = LINE_HEIGHT
    for entry in _form_entries(atlas) + _mark_entries(atlas):
        for line in str(entry.get_label()).splitlines():
            size = text_to_path.get_text_width_height_descent(line, letters, False)
            longest = max(longest, size[0])
            height += LINE_HEIGHT
    points = longest + LETTER_SIZE * (HANDLE_LENGTH + HANDLE_GAP)
    return LegendSize(points / 72 + 2 * LEGEND_GAP, height)


def _wrapped_names(atlas: Atlas) -> list[str]:
    return [textwrap.fill(form.name, NAME_WIDTH) for form in atlas.forms]


# --- nothing to draw ------------------------------------------------------------------


def note_emptiness(axes: Axes, atlas: Atlas) -> None:
    """Say so in the middle of the frame where there is no form."""
    if atlas.forms:
        return
    note = "no form"
    if closes_to_rounding(atlas.closure_gap) and atlas.closure_gap > 0:
        note += " within the bounds"
    elif 0 < atlas.closure_gap < np.inf:
        note += f"\nclosure gap {atlas.closure_gap:.1e}"
    axes.text(
        0.5,
        0.5,
        note,
        transform=axes.transAxes,
        ha="center",
        va="center",
        color="0.4",
        fontsize=11,
    )
