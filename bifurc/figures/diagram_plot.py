"""The bifurcation diagram as it is usually drawn: what is stable solid, what is not
dashed, and marks where something happens."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bifurc.atlas import Atlas
from bifurc.checks import check_type
from bifurc.diagrams.diagram import Stability, Stretch
from bifurc.figures.drawing import note_emptiness, widen_flat_axes
from bifurc.figures.labels import label_spots
from bifurc.figures.layout import Canvas, Margins, PanelPlan, figure_of, lay_out
from bifurc.figures.quantities import AxisRequest, Quantity, quantity_of
from bifurc.figures.rc import drawing_style, line_style
from bifurc.figures.selection import EVERYTHING
from bifurc.figures.style import Dashes, Properties, Style
from bifurc.singular.point import Kind

PIECE_POINTS = 16  # drawn on each piece of a form, at least
STRETCH_POINTS = 200  # and on each stretch
LINE_WIDTH = 1.6
MARGINS = Margins(0.75, 0.15, 0.5, 0.15)
LEAST_HEIGHT = 1.4  # of the frame, in inches
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
    vertical: AxisRequest | None = None,
    figure: Canvas | None = None,
    *,
    ax: Axes | None = None,
) -> Figure:
    """The bifurcation diagram of an atlas in the plane of two quantities.

    Each is an unknown by its name, or by its symbol of sympy, "|x|" for the size of the
    unknown x, "|u|" for the Euclidean norm of all unknowns but the parameter where no
    unknown is called u, or a function of the unknowns (n,); where nothing is said,
    ``horizontal`` is the parameter and ``vertical`` that norm. Stable stretches are
    solid, unstable ones dashed, neutral ones dotted; where no stability is known all
    are solid. It is drawn into ``ax``, or with a legend into a ``figure`` or a part of
    one, or into a new one. Raises `ProblemError` for a quantity that is not there.

    >>> import bifurc
    >>> problem = bifurc.FunctionProblem(
    ...     lambda u, p: [p * u[0] - u[0] ** 3], {"x": (-2, 2)}, parameters={"p": (-1, 3)}
    ... )
    >>> figure = bifurc.plot_diagram(bifurc.explore(problem, parameter="p"), "p", "|x|")
    >>> figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()
    ('p', '|x|')
    """
    check_type("atlas", atlas, Atlas)
    if horizontal is None:
        named = atlas.diagram.parameter if atlas.diagram else ""
        horizontal = named or atlas.names[-1]
    x, y = quantity_of(atlas, horizontal), quantity_of(atlas, vertical)
    with drawing_style():
        entries = _legend_entries(atlas)
        if ax is None:
            plan = PanelPlan(1, 1, 4.5, 3.6, MARGINS, least_height=LEAST_HEIGHT)
            figure, (ax,), _ = lay_out(figure, plan, entries)
        _draw_stretches(ax, atlas, x, y)
        _draw_marks(ax, atlas, x, y)
        ax.set_xlabel(x.label)
        ax.set_ylabel(y.label)
        ax.grid(True)
        ax.margins(0.04)
        widen_flat_axes(ax, atlas)
        note_emptiness(ax, atlas)
        marked = _marked(atlas)
        names = [name for name, _, _ in marked]
        label_spots(ax, names, [_spot(u, x, y) for _, _, u in marked])
    return figure_of(ax)


# --- curves ---------------------------------------------------------------------------


def _stretches(atlas: Atlas) -> list[Stretch]:
    """All that is drawn of the forms, by its stability."""
    stretches = list(atlas.diagram.stretches) if atlas.diagram else []
    covered = {stretch.form for stretch in stretches}
    for number, form in enumerate(atlas.forms):
        if number not in covered:
            length = form.branch.length
            stretches.append(Stretch(number, 0.0, length, Stability.UNKNOWN, -1))
    return stretches


def _draw_stretches(axes: Axes, atlas: Atlas, x: Quantity, y: Quantity) -> None:
    named: set[int] = set()
    for stretch in _stretches(atlas):
        rows = _rows(atlas, stretch, x, y)
        style = Style(_color(stretch.form), DASHES[stretch.stability])
        # a form is named once, for a legend
        name = atlas.forms[stretch.form].name if stretch.form not in named else None
        named.add(stretch.form)
        axes.plot(*rows.T, linewidth=LINE_WIDTH, label=name, **style.line)


def _color(form: int) -> str:
    return line_style(form).color


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


def _draw_marks(axes: Axes, atlas: Atlas, x: Quantity, y: Quantity) -> None:
    for _, mark, point in _marked(atlas):
        spot = _spot(point, x, y)
        axes.plot(*spot, zorder=5, **_properties(mark))


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


def _legend_entries(atlas: Atlas) -> list[Line2D]:
    """Forms by their colours, stabilities by their lines, points by their marks."""
    entries = []
    if len(atlas.forms) > 1:
        for i in EVERYTHING.indices(atlas):
            name = atlas.forms[i].name
            entries.append(Line2D([], [], color=_color(i), linewidth=2.6, label=name))
    drawn = {stretch.stability for stretch in _stretches(atlas)}
    for stability in Stability:
        if stability in drawn and stability is not Stability.UNKNOWN:
            style = Style("0.3", DASHES[stability]).line
            line = Line2D([], [], linewidth=1.6, label=stability.value, **style)
            entries.append(line)
    marks = {mark.label: mark for _, mark, _ in _marked(atlas)}
    for mark in marks.values():
        entries.append(Line2D([], [], label=mark.label, **_properties(mark)))
    return entries
