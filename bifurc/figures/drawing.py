"""What figures are made of: forms and singular points in a plane, the entries of the
legend, and a word where there is nothing to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.lines import Line2D
from matplotlib.ticker import Locator

from bifurc.atlas import Atlas
from bifurc.branch import Branch
from bifurc.decisions import closes_to_rounding
from bifurc.figures.layout import fix_names_of_axes
from bifurc.figures.planes import (
    Plane,
    Scale,
    curve_points,
    cut_to_frame,
    place_in_frame,
    shown_branches,
)
from bifurc.figures.rc import line_style
from bifurc.figures.selection import EVERYTHING, Selection
from bifurc.figures.style import Properties, Style, hollow, near_motion_style
from bifurc.singular.point import Kind

RIGID_LABEL = "rigid assembly"
SURFACE_LABEL = "mobility 2 or more"
OVERLAY_LABEL = "points laid over"
AS_DRAWN_LABEL = "as drawn"
AS_DRAWN: Properties = {"marker": "*", "markersize": 8, "color": "black"}
DEAD: Properties = {"marker": "s", "markersize": 3.2, "color": "0.25"}
RIGID: Properties = {"marker": "x", "color": "0.3", "markersize": 5.5}
OVERLAY: Properties = {
    "marker": "+",
    "color": "black",
    "markersize": 5,
    "markeredgewidth": 0.9,
}
DEGREE_STEPS = (1, 2, 5, 10, 15, 30, 45, 90, 180)
MOST_TICKS = 5  # from one end of an axis of angles to the other
FLAT_SAMPLES = 32  # of each form, by which the largest unknown is seen
FLAT = 1e-9  # of the largest unknown: an axis that shows less shows rounding
FLAT_HALF = 0.1  # of the largest unknown: half of what is shown instead


# --- axes -----------------------------------------------------------------------------


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
        fontsize="small",
        **style,
    )


# --- forms ----------------------------------------------------------------------------


@dataclass(frozen=True)
class PanelSettings:
    """What is drawn in one panel, and how: ``line_width`` and ``mark_size`` in points,
    each mark in its own size unless that is given."""

    line_width: float = 1.8
    mark_size: float | None = None
    selection: Selection = EVERYTHING


DEFAULT_PANEL = PanelSettings()


def is_part_of_turn(plane: Plane) -> bool:
    """Whether the frame is smaller than the torus: what lies outside is not drawn.
    (What lies on an edge of a whole torus is, over the edge.)"""
    return any(
        scale.is_periodic and np.ptp(scale.limits) < 2 * scale.half * (1 - FLAT)
        for scale in plane.scales
    )


def draw_forms(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """The forms in a plane that are drawn, with axes to match; lines carry the names of
    the forms, for a legend."""
    clip_on = is_part_of_turn(plane)
    for curve in drawn_curves(atlas, settings.selection):
        points = plane.project(curve_points(curve.branch))
        if len(points):
            rows = cut_to_frame(points, plane.scales)
            line = {"linewidth": settings.line_width, **curve.style.line}
            axes.plot(*rows.T, clip_on=clip_on, zorder=2, label=curve.name, **line)
    horizontal, vertical = plane.scales
    _label_axis(axes.xaxis, horizontal)
    _label_axis(axes.yaxis, vertical)
    if horizontal.is_periodic:
        axes.set_xlim(horizontal.limits)
    if vertical.is_periodic:
        axes.set_ylim(vertical.limits)
    if horizontal.is_periodic and vertical.is_periodic:
        fix_names_of_axes(axes)
    axes.grid(True)
    for spine in axes.spines.values():
        spine.set_zorder(1)  # forms that lie on the edge of the frame are drawn over it


class DrawnCurve(NamedTuple):
    """A form or a near motion as it is drawn."""

    name: str
    branch: Branch
    style: Style


def drawn_curves(atlas: Atlas, selection: Selection) -> list[DrawnCurve]:
    """The forms that are drawn, in the order of their names; and the near motions with
    a curve, dotted, where no forms are chosen."""
    curves = []
    for i in selection.indices(atlas):
        form = atlas.forms[i]
        curves.append(DrawnCurve(form.name, form.branch, line_style(i)))
    if selection.forms:
        return curves
    index = len(atlas.forms)
    for near in atlas.near_motions:
        if near.branch:
            name = f"{near.name}, misses closure by {near.misclosure:.1e}"
            curves.append(DrawnCurve(name, near.branch, near_motion_style(index)))
            index += 1
    return curves


class DegreeLocator(Locator):
    """Ticks that divide a turn, as many as have room, up to `MOST_TICKS` parts."""

    def __init__(self, has_ends: bool = True):
        self._has_ends = has_ends

    def __call__(self) -> Sequence[float]:
        """The places of the ticks."""
        assert self.axis is not None
        low, high = sorted(self.axis.get_view_interval())
        return self.tick_values(low, high)

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        """The places of the ticks between two angles."""
        assert self.axis is not None
        most = max(min(self.axis.get_tick_space(), MOST_TICKS), 2)
        steps = [step for step in DEGREE_STEPS if (vmax - vmin) / step <= most]
        step = steps[0] if steps else 360
        aside = FLAT if self._has_ends else -FLAT  # of a step
        first, last = np.ceil(vmin / step - aside), np.floor(vmax / step + aside)
        return [float(step * k) for k in np.arange(first, last + 1)]


def _label_axis(axis: Axis, scale: Scale) -> None:
    """Name and ticks; a whole turn is divided by right angles."""
    axis.set_label_text(scale.label)
    if scale.is_degrees:
        axis.set_major_locator(DegreeLocator())


# --- marks ----------------------------------------------------------------------------


class MarkedPoints(NamedTuple):
    """Points (k, n) of one kind: what they are called in the legend, how they are marked,
    and whether their marks are smaller in small panels; those of a higher ``zorder``
    lie over others."""

    label: str
    points: Sequence[np.ndarray]
    style: Properties
    zorder: float
    is_scaled: bool = True


def marked_points(atlas: Atlas, selection: Selection) -> list[MarkedPoints]:
    """What is marked in a map: singular points, kind by kind, isolated solutions, dead
    points of what drives, and the configuration as drawn."""
    marked = []
    points = selection.points(atlas)
    for kind in dict.fromkeys(point.kind for point in points):
        style = {"markeredgewidth": 1.1, **hollow(kind.mark)}
        places = [point.point.u for point in points if point.kind is kind]
        marked.append(MarkedPoints(kind.value, places, style, 4))
    rigid = selection.rigid(atlas)
    if len(rigid):
        marked.append(MarkedPoints(RIGID_LABEL, list(rigid), RIGID, 3))
    dead = selection.dead_points(atlas)
    for index in sorted({event.index for event in dead}):
        label = f"dead point of {atlas.names[index]}"
        places = [event.u for event in dead if event.index == index]
        marked.append(MarkedPoints(label, places, DEAD, 3.5, is_scaled=False))
    drawn = selection.drawn(atlas)
    if drawn is not None:
        one = MarkedPoints(AS_DRAWN_LABEL, [drawn], AS_DRAWN, 5, is_scaled=False)
        marked.append(one)
    return marked


def draw_marks(
    axes: Axes, atlas: Atlas, plane: Plane, settings: PanelSettings = DEFAULT_PANEL
) -> None:
    """Marks and surfaces in a plane, on both edges where they lie on one, and what the
    user lays over; an axis that then shows nothing but rounding is widened."""
    clip_on = is_part_of_turn(plane)
    for surface in settings.selection.surfaces(atlas):
        shown = place_in_frame(plane.project(surface.samples), plane.scales)
        axes.plot(*shown.T, ".", color="0.6", markersize=2, zorder=1)
    for marked in marked_points(atlas, settings.selection):
        places = np.concatenate([plane.copies(point) for point in marked.points]).T
        style = {**marked.style}
        if settings.mark_size and marked.is_scaled:
            style["markersize"] = settings.mark_size
        axes.plot(*places, ls="", clip_on=clip_on, zorder=marked.zorder, **style)
    _draw_overlay(axes, atlas, plane, settings.selection)
    horizontal, vertical = plane.scales
    widen_flat_axes(axes, atlas, (horizontal.factor, vertical.factor))


def _draw_overlay(axes: Axes, atlas: Atlas, plane: Plane, selection: Selection) -> None:
    clip_on = is_part_of_turn(plane)
    over = selection.points_over(
        atlas.names[plane.horizontal], atlas.names[plane.vertical]
    )
    if over is not None:
        factors = [scale.factor for scale in plane.scales]
        shown = place_in_frame(over / factors, plane.scales)
        axes.plot(*shown.T, ls="", clip_on=clip_on, zorder=5, **OVERLAY)


# --- the legend -----------------------------------------------------------------------


def legend_entries(atlas: Atlas, selection: Selection = EVERYTHING) -> list[Line2D]:
    """Entries of the forms in the order of their names, of what is marked, of surfaces
    and of what is laid over, as far as there are any."""
    entries = []
    for curve in drawn_curves(atlas, selection):
        line = {"linewidth": 1.8, **curve.style.line}
        entries.append(Line2D([], [], label=curve.name, **line))
    marks = [(one.label, one.style) for one in marked_points(atlas, selection)]
    if selection.surfaces(atlas):
        marks.append((SURFACE_LABEL, {"marker": ".", "color": "0.6"}))
    if selection.overlay:
        marks.append((OVERLAY_LABEL, OVERLAY))
    for label, style in marks:
        entries.append(Line2D([], [], linestyle="", label=label, **style))
    return entries


# --- nothing to draw ------------------------------------------------------------------


def note_emptiness(axes: Axes, atlas: Atlas) -> None:
    """Say so in the middle of the frame where there is no form."""
    if atlas.forms:
        return
    style: Properties = {"ha": "center", "va": "center", "color": "0.4"}
    note = "\n".join(emptiness(atlas))
    axes.text(0.5, 0.5, note, transform=axes.transAxes, **style)


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
