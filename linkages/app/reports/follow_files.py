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
from linkages.app.output import say_written, writing_to
from linkages.app.reports.tolerance_figure import COLOURS
from linkages.entry import Parameter, ParameterKind
from linkages.parameters.followed import Followed
from linkages.parameters.members import Members

SAMPLES = 600  # of a curve
COLUMNS = 3
LEAST = 20.0  # deg, the range of an axis
ROUNDING = 1e-6  # deg, by which an angle of half a turn may be more or less
STYLES = ("-", "--", "-.", ":")


def write_followed(
    members: Members,
    points: Sequence[Followed],
    text: str,
    document: Mapping[str, object],
    out: Path,
) -> None:
    """Write what became of points to a folder: the text, JSON, and a figure."""
    figure = draw_followed(members, points)

    def write(stage: Path) -> None:
        (stage / "follow.txt").write_text(text + "\n", encoding="utf-8")
        (stage / "follow.json").write_text(json.dumps(document) + "\n")
        figure.savefig(stage / "follow.png", dpi=150)

    with writing_to(out):
        replace_files(out, write)
    names = ("follow.txt", "follow.json", "follow.png")
    say_written([out / name for name in names], out)


def draw_followed(members: Members, points: Sequence[Followed]) -> Figure:
    """The angles of the joints over the free parameter, one picture for each joint; or
    the plane of two parameters."""
    curves = [(one.point.name, one.curve) for one in points if one.curve is not None]
    if len(members.free) == 2:
        figure = Figure(figsize=(5.6, 4.6), layout="constrained")
        _draw_plane(figure.subplots(), members.free, curves)
        return figure
    n = members.problem.n
    rows = -(-n // COLUMNS)
    figure = Figure(figsize=(10.0, 2.7 * rows), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, COLUMNS, sharex=True)).ravel()
    for joint, axes in enumerate(panels):
        if joint >= n:
            axes.set_axis_off()
            continue
        _draw_joint(axes, members, joint, curves)
    if curves:
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
    return figure


def _draw_joint(
    axes: Axes,
    members: Members,
    joint: int,
    curves: Sequence[tuple[str, FollowedPoint]],
) -> None:
    """The angle of a joint (from 0) at each point, over the free parameter."""
    (parameter,) = members.free
    for number, (name, curve) in enumerate(curves):
        s = np.linspace(0.0, curve.branch.length, SAMPLES)
        angles = np.degrees(curve.unknowns(s)[:, joint])
        turns = 360.0 * np.round((angles.mean() - ROUNDING) / 360.0)
        values = _in_unit(parameter, curve.parameters(s)[:, 0])
        colour = COLOURS[number % len(COLOURS)]
        style = STYLES[number % len(STYLES)]  # curves may lie on each other
        axes.plot(values, angles - turns, style, color=colour, lw=1.6, label=name)
        births = _in_unit(parameter, np.array([one.p[0] for one in curve.places]))
        at = np.degrees([one.u[joint] for one in curve.places])
        axes.plot(births, at - turns, "o", color=colour, ms=5)
    _label_joint(axes, joint)
    if joint >= members.problem.n - COLUMNS:
        axes.set_xlabel(_label(parameter))
        axes.tick_params(labelbottom=True)
    axes.grid(alpha=0.3)


def _label_joint(axes: Axes, joint: int) -> None:
    """The name of a joint (from 0), and a range that does not show rounding."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, high - LEAST), max(high, low + LEAST))
    axes.set_ylabel(f"joint {joint + 1} (deg)")


def _draw_plane(
    axes: Axes,
    free: Sequence[Parameter],
    curves: Sequence[tuple[str, FollowedPoint]],
) -> None:
    """The curves in the plane of two parameters."""
    for number, (name, curve) in enumerate(curves):
        s = np.linspace(0.0, curve.branch.length, SAMPLES)
        x, y = (_in_unit(one, curve.parameters(s)[:, k]) for k, one in enumerate(free))
        axes.plot(x, y, color=COLOURS[number % len(COLOURS)], lw=1.6, label=name)
        for place in curve.places:
            at = [_in_unit(one, place.p[k]) for k, one in enumerate(free)]
            axes.plot(*at, "o", color=COLOURS[number % len(COLOURS)], ms=5)
    axes.set(xlabel=_label(free[0]), ylabel=_label(free[1]))
    axes.grid(alpha=0.3)
    if curves:
        axes.legend(frameon=False)


def _in_unit(parameter: Parameter, values: np.ndarray) -> np.ndarray:
    is_angle = parameter.kind is ParameterKind.ANGLE
    return np.degrees(values) if is_angle else np.asarray(values)


def _label(parameter: Parameter) -> str:
    is_angle = parameter.kind is ParameterKind.ANGLE
    return f"{parameter.name} (deg)" if is_angle else parameter.name
