"""The files of `bifurc follow`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.files.atomic import replace_files
from bifurc.following.follow import FollowedPoint
from bifurc.following.places import FollowedPlace, PlaceKind
from linkages.app.output import say_written, writing_to
from linkages.app.reports.tolerance_figure import COLOURS
from linkages.entry import Parameter, ParameterKind
from linkages.parameters.followed import Followed
from linkages.parameters.members import FreeParameters

SAMPLES = 600  # of a curve
COLUMNS = 3
LEAST = 20.0  # deg, the range of an axis
LEAST_SHARE = 0.1  # of the scale of unknowns that are no angles, the same
LABEL_OFFSET = (7.0, -10.0)  # points, from a mark to its label
ROUNDING = 1e-8  # rad, by which an angle of half a turn may be more or less
STYLES = ("-", "--", "-.", ":")


def write_followed(
    members: FreeParameters,
    points: Sequence[Followed],
    text: str,
    document: Mapping[str, object],
    out: Path,
) -> None:
    """Write what became of points to a folder: the text, JSON, and a figure."""
    write_report("follow", text, document, draw_followed(members, points), out)


def write_report(
    name: str, text: str, document: Mapping[str, object], figure: Figure, out: Path
) -> None:
    """Write the text, JSON and figure called ``name`` to a folder."""
    names = [f"{name}.txt", f"{name}.json", f"{name}.png"]

    def write(stage: Path) -> None:
        (stage / names[0]).write_text(text + "\n", encoding="utf-8")
        (stage / names[1]).write_text(json.dumps(document) + "\n")
        figure.savefig(stage / names[2], dpi=150)

    with writing_to(out):
        replace_files(out, write)
    say_written([out / one for one in names], out)


def draw_followed(members: FreeParameters, points: Sequence[Followed]) -> Figure:
    """The unknowns over the free parameter, one picture for each; or the plane of two
    parameters."""
    curves = [(one.point.name, one.curve) for one in points if one.curve is not None]
    if len(members.free) == 2:
        figure = Figure(figsize=(5.6, 4.6), layout="constrained")
        _draw_plane(figure.subplots(), members.free, curves)
        return figure
    n = members.problem.n
    columns = min(n, COLUMNS)
    rows = -(-n // columns)
    figure = Figure(figsize=(1.0 + 3.0 * columns, 2.7 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, sharex=True)).ravel()
    for number, axes in enumerate(panels):
        if number >= n:
            axes.set_axis_off()
            continue
        _draw_unknown(axes, members, number, curves)
    if curves:
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
    return figure


def _draw_unknown(
    axes: Axes,
    members: FreeParameters,
    number: int,
    curves: Sequence[tuple[str, FollowedPoint]],
) -> None:
    """An unknown (from 0) at each point, over the free parameter."""
    (parameter,) = members.free
    period = float(members.problem.domain.periods[number])
    for k, (name, curve) in enumerate(curves):
        s = curve.branch.arclengths(SAMPLES)
        births = np.array([place.s for place in curve.places])
        turns = _whole_turns(curve.unknowns(s)[:, number], period)
        colour = COLOURS[k % len(COLOURS)]
        style = STYLES[k % len(STYLES)]  # curves may lie on each other
        for along, look in ((s, style), (births, "o")):
            values = in_unit(parameter, curve.parameters(along)[:, 0])
            shown = _as_shown(curve.unknowns(along)[:, number] - turns, period)
            axes.plot(values, shown, look, color=colour, lw=1.6, ms=5)
        axes.plot([], [], style, color=colour, label=name)
    _label_unknown(axes, members, number)
    if number >= members.problem.n - COLUMNS:
        axes.set_xlabel(label_of(parameter))
        axes.tick_params(labelbottom=True)
    axes.grid(alpha=0.3)


def _whole_turns(values: np.ndarray, period: float) -> float:
    """What to take from an unknown that its mean lies within half a period of 0."""
    if not np.isfinite(period):
        return 0.0
    return period * float(np.round((values.mean() - ROUNDING) / period))


def _as_shown(values: np.ndarray, period: float) -> np.ndarray:
    """Values of an unknown, angles in degrees."""
    return np.degrees(values) if np.isfinite(period) else values


def _label_unknown(axes: Axes, members: FreeParameters, number: int) -> None:
    """The name of an unknown (from 0), and a range that does not show rounding."""
    domain = members.problem.domain
    is_angle = np.isfinite(domain.periods[number])
    unit = " (deg)" if is_angle else ""
    axes.set_ylabel(f"{domain.names[number]}{unit}")
    low, high = axes.get_ylim()
    least = LEAST if is_angle else LEAST_SHARE * domain.scale
    room = max(0.0, 0.5 * (least - (high - low)))
    axes.set_ylim(low - room, high + room)


def _draw_plane(
    axes: Axes,
    free: Sequence[Parameter],
    curves: Sequence[tuple[str, FollowedPoint]],
) -> None:
    """The curves in the plane of two parameters."""
    for number, (name, curve) in enumerate(curves):
        s = np.linspace(0.0, curve.branch.length, SAMPLES)
        x, y = (in_unit(one, curve.parameters(s)[:, k]) for k, one in enumerate(free))
        axes.plot(x, y, color=COLOURS[number % len(COLOURS)], lw=1.6, label=name)
        for place in curve.places:
            first, second = (
                float(in_unit(one, place.p[k])) for k, one in enumerate(free)
            )
            axes.plot(first, second, "o", color=COLOURS[number % len(COLOURS)], ms=5)
            _label_place(axes, place, (first, second))
    axes.set(xlabel=label_of(free[0]), ylabel=label_of(free[1]))
    axes.grid(alpha=0.3)
    if curves:
        axes.legend(frameon=False)


def _label_place(axes: Axes, place: FollowedPlace, at: tuple[float, float]) -> None:
    """What a place of a curve is, but where one parameter turns back."""
    if place.kind is not PlaceKind.TURN:
        axes.annotate(
            place.kind.value,
            at,
            xytext=LABEL_OFFSET,
            textcoords="offset points",
            fontsize="small",
        )


def in_unit(parameter: Parameter, values: np.ndarray) -> np.ndarray:
    """Values of a parameter as they are drawn, angles in degrees."""
    is_angle = parameter.kind is ParameterKind.ANGLE
    return np.degrees(values) if is_angle else np.asarray(values)


def label_of(parameter: Parameter) -> str:
    """What stands at the axis of a parameter."""
    is_angle = parameter.kind is ParameterKind.ANGLE
    return f"{parameter.name} (deg)" if is_angle else parameter.name
