"""The bifurcation diagram as it is usually drawn: what is stable solid, what is not
dashed, and marks where something happens."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.diagrams.diagram import Stability, Stretch
from bifurc.figures.drawing import note_emptiness, widen_flat_axes
from bifurc.figures.labels import label_spots
from bifurc.figures.quantities import AxisRequest, Quantity, quantity_of
from bifurc.figures.rendering import RC
from bifurc.figures.style import COLORS, Dashes, Properties, Style
from bifurc.singular.point import Kind

PIECE_POINTS = 16  # drawn on each piece of a form, at least
STRETCH_POINTS = 200  # and on each stretch
LINE_WIDTH = 1.6
DASHES: dict[Stability, Dashes] = {
    Stability.STABLE: "-",
    Stability.UNSTABLE: (0, (4, 2)),
    Stability.NEUTRAL: (0, (1.2, 1.4)),
    Stability.UNKNOWN: "-",
}
EVENT_SYMBOLS = ("x", "+", "*", "P", "v", "1")


class _Mark(NamedTuple):
    """A symbol of matplotlib for the points of one ``label`` in the legend, and the
    colours of its ``edge`` and its inside."""

    label: str
    symbol: str
    edge: str = "black"
    fill: str = "white"


def plot_diagram(
    atlas: Atlas,
    horizontal: AxisRequest | None = None,
    vertical: AxisRequest = "|u|",
    figure: Figure | None = None,
) -> Figure:
    """The bifurcation diagram of an atlas in the plane of two quantities.

    Each is the name of an unknown, "|x|" for the size of the unknown x, "|u|" for the
    Euclidean norm of all unknowns but the parameter, or a function of the unknowns
    (n,); ``horizontal`` is the parameter where nothing is said. Stable stretches are
    solid, unstable ones dashed, neutral ones dotted; where no stability is known all
    are solid. Raises `ProblemError` for a quantity that is not there.
    """
    check_type("atlas", atlas, Atlas)
    if horizontal is None:
        named = atlas.diagram.parameter if atlas.diagram else ""
        horizontal = named or atlas.names[-1]
    x, y = quantity_of(atlas, horizontal), quantity_of(atlas, vertical)
    with rc_context(RC):
        figure = figure or Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        stabilities = _draw_stretches(axes, atlas, x, y)
        marks = _draw_marks(axes, atlas, x, y)
        axes.set_xlabel(x.label)
        axes.set_ylabel(y.label)
        axes.grid(True)
        axes.margins(0.04)
        widen_flat_axes(axes, atlas)
        _draw_legend(figure, atlas, stabilities, marks)
        note_emptiness(axes, atlas)
        marked = _marked(atlas)
        names = [name for name, _, _ in marked]
        label_spots(axes, names, [_spot(u, x, y) for _, _, u in marked])
    return figure


# --- curves ---------------------------------------------------------------------------


def _draw_stretches(
    axes: Axes, atlas: Atlas, x: Quantity, y: Quantity
) -> list[Stability]:
    """Which stabilities were drawn, in the order of the legend."""
    stretches = list(atlas.diagram.stretches) if atlas.diagram else []
    covered = {stretch.form for stretch in stretches}
    for number, form in enumerate(atlas.forms):
        if number not in covered:
            length = form.branch.length
            stretches.append(Stretch(number, 0.0, length, Stability.UNKNOWN, -1))
    for stretch in stretches:
        rows = _rows(atlas, stretch, x, y)
        style = Style(_color(stretch.form), DASHES[stretch.stability])
        axes.plot(*rows.T, linewidth=LINE_WIDTH, **style.line)
    drawn = {stretch.stability for stretch in stretches}
    return [stability for stability in Stability if stability in drawn]


def _color(form: int) -> str:
    return COLORS[form % len(COLORS)]


def _rows(atlas: Atlas, stretch: Stretch, x: Quantity, y: Quantity) -> np.ndarray:
    """Points (k, 2) along a stretch, with NaN where a line breaks at a period."""
    branch = atlas.forms[stretch.form].branch
    inner = branch.places(np.linspace(0.0, 1.0, PIECE_POINTS)).ravel()
    if branch.closed:
        inner = np.concatenate([inner, inner + branch.length])
    even = np.linspace(stretch.start, stretch.end, STRETCH_POINTS)
    is_inside = (inner > stretch.start) & (inner < stretch.end)
    points = branch(np.unique(np.concatenate([even, inner[is_inside]])))
    rows = np.stack([x.values(points), y.values(points)], axis=1)
    periods = np.array([x.period, y.period])
    is_jump = np.any(np.abs(np.diff(rows, axis=0)) > 0.5 * periods, axis=1)
    return np.insert(rows, np.flatnonzero(is_jump) + 1, np.nan, axis=0)


# --- marks ----------------------------------------------------------------------------


def _draw_marks(axes: Axes, atlas: Atlas, x: Quantity, y: Quantity) -> list[_Mark]:
    """The marks that were drawn, in the order of the legend."""
    drawn: dict[str, _Mark] = {}
    for _, mark, point in _marked(atlas):
        drawn[mark.label] = mark
        spot = _spot(point, x, y)
        axes.plot(*spot, zorder=5, **_properties(mark))
    return list(drawn.values())


def _properties(mark: _Mark) -> Properties:
    """How a line of one point is drawn as a mark."""
    return {
        "marker": mark.symbol,
        "color": mark.edge,
        "markerfacecolor": mark.fill,
        "markeredgecolor": mark.edge,
        "markersize": 6.0,
        "markeredgewidth": 1.3,
        "linestyle": "none",
    }


def _spot(point: np.ndarray, x: Quantity, y: Quantity) -> np.ndarray:
    """Where in the plane (2,) a point (n,) is shown."""
    return np.array([x.values(point[None])[0], y.values(point[None])[0]])


def _marked(atlas: Atlas) -> list[tuple[str, _Mark, np.ndarray]]:
    """Name, mark and unknowns (n,) of every point that is marked."""
    diagram = atlas.diagram
    kinds = {}
    if diagram is not None:
        kinds = {one.point: one.kind for one in diagram.branchings}
    marked = []
    for number, meeting in enumerate(atlas.points):
        if meeting.kind is Kind.BIFURCATION:
            kind = kinds.get(number, meeting.kind)
            mark = _Mark(kind.value, kind.mark.symbol, fill=kind.mark.fill)
            marked.append((meeting.name, mark, meeting.point.u))
        elif meeting.passes:
            mark = _Mark(meeting.kind.value, "D", edge="0.35")
            marked.append((meeting.name, mark, meeting.point.u))
    if diagram is None:
        return marked
    labels = sorted({event.label for event in diagram.events()})
    for point in diagram.points:
        label, symbol = point.kind.value, point.kind.mark.symbol
        if point.kind is Kind.EVENT:
            number = labels.index(point.label)
            label, symbol = point.label, EVENT_SYMBOLS[number % len(EVENT_SYMBOLS)]
        elif point.label:
            label = f"{point.label} ({point.kind.value})"
        mark = _Mark(label, symbol)
        marked.append((point.name, mark, point.u))
    return marked


# --- legend ---------------------------------------------------------------------------


def _draw_legend(
    figure: Figure, atlas: Atlas, stabilities: list[Stability], marks: list[_Mark]
) -> None:
    """Forms by their colours, stabilities by their lines, points by their marks."""
    handles = []
    if len(atlas.forms) > 1:
        for number, form in enumerate(atlas.forms):
            line = Line2D([], [], color=_color(number), linewidth=2.6, label=form.name)
            handles.append(line)
    for stability in stabilities:
        if stability is not Stability.UNKNOWN:
            style = Style("0.3", DASHES[stability]).line
            handles.append(
                Line2D([], [], linewidth=1.6, label=stability.value, **style)
            )
    for mark in marks:
        handles.append(Line2D([], [], label=mark.label, **_properties(mark)))
    if handles:
        figure.legend(handles=handles, loc="outside right upper", frameon=False)
