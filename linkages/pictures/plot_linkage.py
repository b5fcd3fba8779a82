"""The picture of a linkage in a configuration, with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.errors import ProblemError
from bifurc.figures.labels import label_spots
from bifurc.figures.layout import Canvas, figure_of
from bifurc.figures.rc import drawing_style, size_of_user
from bifurc.figures.selection import Selection
from bifurc.figures.style import Properties
from linkages.links.traced_points import traced_point
from linkages.pictures.flex_arrows import flex_strokes
from linkages.pictures.picture import Painter, Part, Picture, Stroke
from linkages.subject import subject_at
from linkages.viewing.start import Place, first_place, start_of

SIZE = (4.2, 3.6)  # inches
MOST_NAMED = 60  # joints; more names would cover what is drawn
ROOM = 0.08  # around the picture, in its extent, for names of joints
SAMPLES = 60  # configurations of a form for which rails are long enough
FINE_SAMPLES = 720  # at which paths of points are drawn
HALO = 2.6  # points, on both sides of a link: what is behind it ends there
LINK = "#0072B2"
STYLES: dict[Part, Properties] = {
    Part.LINK: {"color": LINK, "linewidth": 2.6, "solid_capstyle": "round"},
    Part.FRAME: {"color": "0.6", "linewidth": 2.6, "solid_capstyle": "round"},
    Part.RAIL: {"color": "0.6", "linewidth": 1.0},
    Part.AXIS: {"color": "0.5", "linewidth": 0.8, "linestyle": (0, (8, 2, 1.5, 2))},
    Part.GROUND: {"color": "0.25", "linewidth": 0.9},
    Part.PATH: {"color": "#D55E00", "linewidth": 1.2},
    Part.FLEX: {"color": "#D55E00", "linewidth": 1.6},
}
OUTLINES: dict[Part, Properties] = {
    Part.JOINT: {"color": "0.15", "linewidth": 1.1},
    Part.GROUND: {"color": "0.25", "linewidth": 1.1},
    Part.PANEL: {"color": LINK, "linewidth": 0.9},
    Part.FLEX: {"color": "#D55E00", "linewidth": 0.0},
}
FILLS = {Part.PANEL: "#D6E6F2", Part.FLEX: "#D55E00"}  # white for all others


def plot_linkage(
    atlas: Atlas,
    form: str | int | None = None,
    s: float | None = None,
    figure: Canvas | None = None,
    *,
    ax: Axes | None = None,
    trace: Sequence[str] = (),
) -> Figure:
    """The linkage of an atlas in one configuration: ``s`` (arclength, rad) along a
    ``form``, by its name or its number from 1; where the page of `bifurc view` begins,
    where nothing is said.

    Planar linkages are seen straight from above, with the symbols for ground, pins and
    sliders; others with the axes of their joints. Infinitesimal flexes of a mechanism that
    is rigid there are arrows. It is drawn into ``ax``, or into a
    ``figure`` or a part of one, or into a new one. The paths of points along the form are
    drawn that ``trace`` names as "BODY:X,Y" or "BODY:X,Y,Z". Raises `ProblemError` for a
    form that is not there, `linkages.GeometryError` for a point of no body, and
    `linkages.NoLinkageError` where the atlas is of no linkage.

    >>> import linkages
    >>> figure = linkages.plot_linkage(linkages.map_linkage(linkages.load("four-bar")))
    >>> len(figure.axes)
    1
    """
    check_type("atlas", atlas, Atlas)
    place = place_of(atlas, form, s)
    painter = painter_of(atlas, place, trace)
    with drawing_style():
        ax = ax or _new_axes(figure)
        picture = painter.picture(place.point)
        readout = subject_at(atlas).readout
        if place.form is None and readout is not None:
            flexes = flex_strokes(painter, readout, place.point)
            picture = replace(picture, strokes=[*picture.strokes, *flexes])
        draw_picture(ax, picture, picture.corners)
    return figure_of(ax)


def place_of(atlas: Atlas, form: str | int | None, s: float | None) -> Place:
    """The configuration at an arclength along a form; raises `ProblemError`."""
    if form is None and s is not None:
        raise ProblemError("s", s, "the arclength along a form, which has to be named")
    if form is None:
        return first_place(atlas)
    number = Selection([form]).indices(atlas)[0]
    branch = atlas.forms[number].branch
    return Place(branch(start_of(atlas, number) if s is None else s), number)


def painter_of(atlas: Atlas, place: Place, trace: Sequence[str] = ()) -> Painter:
    """What makes pictures of the linkage along the form on which a place is, with the
    paths of the points of a ``trace`` along it, seen from where that place is clear."""
    points = place.point[None]
    if place.form is not None:
        samples = FINE_SAMPLES if trace else SAMPLES
        points = atlas.forms[place.form].branch.sample(samples)
    parts = subject_at(atlas).parts_for(trace)
    traced = [traced_point(parts, text) for text in trace]
    return Painter(parts, place.point, points, traced)


def _new_axes(figure: Canvas | None) -> Axes:
    figure = figure or Figure(figsize=size_of_user() or SIZE)
    return figure.add_axes((0, 0, 1, 1))


def draw_picture(ax: Axes, picture: Picture, corners: np.ndarray) -> None:
    """Draw a picture, with room for all between two ``corners`` (2, 2)."""
    room = ROOM * float(np.ptp(corners, axis=0).max())
    low, high = corners[0] - room, corners[1] + room
    ax.set_axis_off()
    ax.set_aspect("equal")
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for order, stroke in enumerate(picture.strokes):
        zorder = 2 + order / len(picture.strokes)
        if stroke.closed:
            _draw_polygon(ax, stroke, zorder)
        else:
            _draw_line(ax, stroke, zorder)
    named = picture.names if len(picture.names) <= MOST_NAMED else ()
    label_spots(ax, [one.text for one in named], [one.place for one in named])


def _draw_polygon(ax: Axes, stroke: Stroke, zorder: float) -> None:
    fill = FILLS.get(stroke.part, "white")
    ax.add_patch(Polygon(stroke.points, zorder=zorder, color=fill, linewidth=0))
    around = np.concatenate([stroke.points, stroke.points[:1]])
    # a line, which names keep clear of
    ax.plot(*around.T, zorder=zorder, **OUTLINES[stroke.part])


def _draw_line(ax: Axes, stroke: Stroke, zorder: float) -> None:
    style = STYLES[stroke.part]
    if stroke.part in (Part.LINK, Part.FRAME):
        halo: Properties = {"color": "white", "linewidth": style["linewidth"] + HALO}
        ax.plot(*stroke.points.T, zorder=zorder, solid_capstyle="butt", **halo)
    ax.plot(*stroke.points.T, zorder=zorder, **style)
