"""Figures of a transition map with the linkage in configurations along its forms,
lettered as in the sources."""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_lowercase
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.figures.drawing import draw_forms, draw_marks
from bifurc.figures.planes import Plane, plane_of
from bifurc.figures.plotting import plot_transition_map
from linkages.source_figures.assembly import loop_assembly
from linkages.source_figures.configurations import (
    atlas_of,
    form_named,
    loop_of_content,
)
from linkages.source_figures.drawing import draw_row, write_beside
from linkages.source_figures.table import Content, SourceFigure

ALONG = (0.25, 0.5, 0.75)  # of an arc: where a form is shown
COLUMNS = 4
LETTER_BOX = {
    "boxstyle": "circle,pad=0.1",
    "facecolor": "white",
    "alpha": 0.8,
    "linewidth": 0,
}
SNAPSHOT = 1.45  # width and height, in inches


class Stop(NamedTuple):
    """A configuration (n,) of a tour, the form or the bifurcation where it is, and
    which of both."""

    theta: np.ndarray
    place: str
    is_bifurcation: bool


def draw(source: SourceFigure) -> Figure:
    """The map at the left and, where the figure has a tour, its configurations at the
    right, all seen from the same side of the link between the last joint and the
    first."""
    content = source.content
    atlas = atlas_of(content)
    horizontal, vertical = content["axes"]
    stops = tour_of(atlas, content) if "tour" in content else []
    if not stops:
        return plot_transition_map(atlas, joints=(horizontal, vertical))
    plane = plane_of(atlas, horizontal - 1, vertical - 1)
    rows = -(-len(stops) // COLUMNS)
    height = max(rows * (SNAPSHOT + 0.15), 5.4)
    figure = Figure(figsize=(5.2 + COLUMNS * SNAPSHOT, height))
    left = 5.0 / (5.2 + COLUMNS * SNAPSHOT)
    axes = figure.add_axes((0.055, 0.3, left - 0.075, 0.66))
    _draw_map(axes, atlas, plane, stops)
    _draw_form_names(axes)
    grid = figure.subplots(
        rows,
        COLUMNS,
        squeeze=False,
        gridspec_kw={"left": left, "right": 0.995, "bottom": 0.01, "top": 0.96},
    )
    loop = loop_of_content(content)
    assemblies = [loop_assembly(loop, stop.theta) for stop in stops]
    letters = zip(ascii_lowercase, stops, strict=False)
    titles = [f"({letter}) {stop.place}" for letter, stop in letters]
    draw_row(list(grid.flat), assemblies, titles, 7.5)
    return figure


def _draw_form_names(axes: Axes) -> None:
    """The names of the forms below the map, by the lines that it has for them."""
    axes.legend(
        loc="upper left", bbox_to_anchor=(-0.05, -0.14), frameon=False, handlelength=3.2
    )


def _draw_map(axes: Axes, atlas: Atlas, plane: Plane, stops: Sequence[Stop]) -> None:
    draw_forms(axes, atlas, plane)
    draw_marks(axes, atlas, plane)
    for letter, stop in zip(ascii_lowercase, stops, strict=False):
        spot = plane.spot(stop.theta)
        if not stop.is_bifurcation:
            axes.plot(*spot, "o", color="black", markersize=3, zorder=5)
        inwards = -np.sign(np.where(np.abs(spot) > 150, spot, -1.0))
        write_beside(axes, spot, letter, 8 * inwards, zorder=6, bbox=LETTER_BOX)


# --- the tour -------------------------------------------------------------------------


def tour_of(atlas: Atlas, content: Content) -> list[Stop]:
    """Three configurations on each form of a tour, and after each the bifurcation to
    the next one; where the tour is not ``open`` it comes back to its first form."""
    forms = [form_named(atlas, name) for name in content["tour"]]
    is_open = content.get("open", False)
    meetings: list[MeetingPoint | None] = []
    for form, following in zip(forms, [*forms[1:], forms[0]], strict=True):
        meetings.append(_meeting(atlas, form, following))
    if is_open:
        meetings[-1] = None
    stops = []
    for number, form in enumerate(forms):
        begin = meetings[number - 1]
        end = meetings[number]
        for s in _along(atlas, form, begin, end):
            name = form.name.split(" (")[0]
            stops.append(Stop(form.branch(s), name, is_bifurcation=False))
        if end is not None:
            stops.append(Stop(end.point.u, end.name, is_bifurcation=True))
    return stops


def _meeting(atlas: Atlas, form: Form, other: Form) -> MeetingPoint | None:
    """A bifurcation at which two forms meet."""
    wanted = {atlas.forms.index(form), atlas.forms.index(other)}
    for point in atlas.bifurcations:
        if wanted <= {index for index, _ in point.passes}:
            return point
    return None


def _along(
    atlas: Atlas, form: Form, begin: MeetingPoint | None, end: MeetingPoint | None
) -> list[float]:
    """Arclengths on the arc of a form from one bifurcation to another; on the whole
    form where there is only one."""
    index = atlas.forms.index(form)
    known = [point for point in (begin, end) if point is not None]
    places = [dict(point.passes)[index] for point in known]
    length = form.branch.length
    if len(places) < 2 or places[0] == places[1]:
        return [places[0] + part * length for part in ALONG]
    span = (places[1] - places[0]) % length
    return [places[0] + part * span for part in ALONG]
