"""Figures of Wohlhart's symmetric mechanism as a translator (Racila and Dahan 2010,
sections 3 and 4)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from bifurc.figures.planes import Scale, cut_to_frame
from bifurc.figures.style import Properties, form_style
from linkages.closed_forms.translator import (
    Stroke,
    joint_axes,
    joint_centres,
    meeting_points,
    plane_distance,
    slide,
    stroke_angles,
    upright,
)
from linkages.source_figures.drawing import (
    HALO,
    LINE_COLOR,
    Look,
    draw_arrow,
    look_along,
    write_beside,
)
from linkages.source_figures.table import Content, SourceFigure

DEGREES = 180.0 / np.pi
COUNT = 721
ODD_COLOR = "#0072B2"
EVEN_COLOR = "#D55E00"
AXIS_COLOR = "0.5"
DASHES = {Stroke.SHORT: "-", Stroke.LONG: (0, (6, 2))}
ROUND = Scale(DEGREES, 180.0, "")
PLAIN = Scale(1.0, np.inf, "")
# where the mechanism is flat again, by section 4 of the paper, rad, and some rounding
LAST_POSITION = np.radians(120) + 1e-9
RING = [0, 1, 2, 3, 4, 5, 0]
OBLIQUE = look_along(np.array([1.0, -0.55, 0.42]))
ABOVE = look_along(np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]))
FIRST_PLACE = np.array([2 / np.sqrt(3), 0.0, 0.0])  # of O1, over a
SHORTEST = 0.05  # distance that gets arrows, over a
Ordinate: TypeAlias = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
Mark: TypeAlias = Callable[[Axes, np.ndarray, Look], None]


def draw(source: SourceFigure) -> Figure:
    """The chart or the drawing that the figure names."""
    return CHARTS[source.content["chart"]](source.content)


def _one_panel(width: float = 6.2, height: float = 4.2) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots()


def _draw_legend(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)


# --- charts ---------------------------------------------------------------------------


def _angles(content: Content) -> Figure:
    """phi against theta."""
    figure, axes = _one_panel(5.4, 4.2)
    _draw_motions(axes, content, lambda theta, phi, alpha: phi, ROUND)
    axes.set_ylim(-180, 180)
    axes.yaxis.set_major_locator(MultipleLocator(60))
    axes.set(ylabel="φ (deg)", box_aspect=1)
    return figure


def _height(content: Content) -> Figure:
    """The coordinate z of O3 against theta."""
    figure, axes = _one_panel()

    def height(theta: np.ndarray, phi: np.ndarray, alpha: float) -> np.ndarray:
        return joint_centres(theta, phi, alpha)[:, 2, 2]

    _draw_motions(axes, content, height, PLAIN)
    axes.set(ylabel="z of O₃ / a")
    return figure


def _draw_motions(
    axes: Axes, content: Content, ordinate: Ordinate, scale: Scale
) -> None:
    """An ordinate against theta along both strokes and their mirror images, which
    together are all of the motion, for several twists."""
    for index, degrees in enumerate(content["twists"]):
        style = form_style(index)
        alpha = np.radians(degrees)
        label = f"α = {degrees}°"
        for stroke in Stroke:
            angles = np.stack(stroke_angles(alpha, stroke, COUNT))
            for theta, phi in (angles, -angles):
                points = np.stack([theta, ordinate(theta, phi, alpha)], axis=1)
                rows = cut_to_frame(points, (ROUND, scale))
                axes.plot(*rows.T, label=label, **style.line)
                label = "_"
    axes.set(xlim=(-180, 180), xlabel="θ (deg)")
    axes.xaxis.set_major_locator(MultipleLocator(60))
    axes.grid(True)
    _draw_legend(axes)


def _distances(content: Content) -> Figure:
    """H against theta and against b, for several lengths of links."""
    (degrees,) = content["twists"]
    figure = Figure(figsize=(9.4, 3.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    for index, length in enumerate(content["lengths"]):
        _draw_distance(right, left, degrees, length, index, f"a = {length}")
    left.set(xlabel="θ (deg)", ylabel="H", xlim=(0, 120), ylim=(0, None))
    left.xaxis.set_major_locator(MultipleLocator(30))
    left.grid(True)
    _finish_slides(right)
    return figure


def _distances_by_twist(content: Content) -> Figure:
    """H against b, for several twists."""
    (length,) = content["lengths"]
    figure, axes = _one_panel()
    for index, degrees in enumerate(content["twists"]):
        _draw_distance(axes, None, degrees, length, index, f"α = {degrees}°")
    _finish_slides(axes)
    return figure


def _finish_slides(axes: Axes) -> None:
    """Names, limits and the legend of a chart of H against b."""
    axes.set(xlabel="b", ylabel="H", xlim=(0, None), ylim=(0, None))
    axes.grid(True)
    _draw_legend(axes)


def _draw_distance(
    by_slide: Axes,
    by_angle: Axes | None,
    degrees: float,
    length: float,
    index: int,
    label: str,
) -> None:
    """H along the strokes that end where the paper says that they do."""
    alpha = np.radians(degrees)
    color = form_style(index).color
    for stroke in Stroke:
        theta, phi = stroke_angles(alpha, stroke, COUNT)
        if theta[-1] > LAST_POSITION:
            continue
        height = plane_distance(theta, phi, alpha, length)
        charts = [(by_slide, slide(theta, length))]
        if by_angle is not None:
            charts.append((by_angle, DEGREES * theta))
        style: Properties = {
            "color": color,
            "linestyle": DASHES[stroke],
            "linewidth": 1.6,
        }
        for axes, x in charts:
            axes.plot(x, height, label=f"{label}, {stroke} stroke", **style)


# --- drawings -------------------------------------------------------------------------


def _configuration(content: Content, degrees: float) -> np.ndarray:
    """Angles theta and phi (2,), rad, of the short stroke where theta is ``degrees``;
    that is a straight function of where on the stroke it is, to be turned round."""
    (twist,) = content["twists"]
    theta, phi = stroke_angles(np.radians(twist), Stroke.SHORT, 20001)
    return np.array([np.radians(degrees), np.interp(np.radians(degrees), theta, phi)])


def _bodies(
    content: Content, degrees: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint centres (6, 3), upright, directions of the axes (6, 3), and O', O'' (2, 3)
    in a configuration."""
    (twist,) = content["twists"]
    alpha = np.radians(twist)
    theta, phi = _configuration(content, degrees)[:, None]
    centres = joint_centres(theta, phi, alpha)[0]
    axes = joint_axes(theta, phi, alpha)[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        meetings = np.concatenate(meeting_points(theta, phi, alpha))
    placed = upright(centres, centres)
    directions = upright(centres + axes, centres) - placed
    return placed, directions, upright(meetings, centres)


def _draw_mechanism(
    axes: Axes, centres: np.ndarray, look: Look = OBLIQUE, position: str = ""
) -> None:
    """The six links and the joints with their names, with the number of the position as
    superscript."""
    spots = centres @ look.plane
    axes.plot(*spots[RING].T, color="black", linewidth=2.2, zorder=3)
    middle = spots.mean(axis=0)
    for number, spot in enumerate(spots, start=1):
        color = ODD_COLOR if number % 2 else EVEN_COLOR
        axes.plot(*spot, "o", markerfacecolor="white", markeredgecolor=color, zorder=4)
        away = spot - middle
        away = away / max(float(np.linalg.norm(away)), 1e-9)
        style: Properties = {"color": color, "zorder": 5, "path_effects": HALO}
        name = rf"$\mathregular{{O_{number}^{{{position}}}}}$"
        write_beside(axes, spot, name, 13 * away, **style)
    axes.set_aspect("equal")
    axes.margins(0.12)
    axes.set_axis_off()


def _draw_plane(axes: Axes, centres: np.ndarray, color: str) -> None:
    """The triangle of three joints (3, 3), shaded."""
    axes.fill(*(centres @ OBLIQUE.plane).T, color=color, alpha=0.18, zorder=1)


def _planes(content: Content) -> Figure:
    """The mechanism with both triangles."""
    figure, axes = _one_panel(5.4, 4.2)
    centres, _, _ = _bodies(content, content["theta"])
    _draw_plane(axes, centres[0::2], ODD_COLOR)
    _draw_plane(axes, centres[1::2], EVEN_COLOR)
    _draw_mechanism(axes, centres)
    return figure


def _axes(content: Content) -> Figure:
    """The mechanism with its axes and the line on which they meet."""
    figure, axes = _one_panel(5.4, 5.2)
    centres, _, meetings = _bodies(content, content["theta"])
    sides = ((1, meetings[0], EVEN_COLOR), (0, meetings[1], ODD_COLOR))
    for parity, meeting, color in sides:
        for centre in centres[parity::2]:
            beyond = centre - 0.15 * (meeting - centre)
            ends = np.stack([beyond, meeting]) @ OBLIQUE.plane
            axes.plot(*ends.T, color=color, linestyle="-.", linewidth=0.9, zorder=2)
        _draw_plane(axes, centres[parity::2], color)
    line = meetings @ OBLIQUE.plane
    axes.plot(*line.T, color=LINE_COLOR, linewidth=1.8, zorder=2)
    for name, spot in zip(("O'", "O''"), line, strict=True):
        axes.plot(*spot, "s", color=LINE_COLOR, markersize=4, zorder=4)
        _name(axes, spot, name, (9, 4))
    _draw_mechanism(axes, centres)
    return figure


def _disposition(content: Content) -> Figure:
    """The mechanism over the three lines on which O1, O3, O5 slide, with H and b."""
    figure, axes = _one_panel(6.0, 4.4)
    centres, _, _ = _bodies(content, content["theta"])
    _draw_slides(axes, OBLIQUE.plane)
    _draw_plane(axes, centres[1::2], EVEN_COLOR)
    _draw_mechanism(axes, centres)
    top = centres[1::2].mean(axis=0)
    below = np.array([0.0, 0.0, -0.08])
    _draw_measure(axes, np.stack([np.zeros(3), top]), "H", (7, 0))
    slide_ends = np.stack([FIRST_PLACE, centres[0]]) + below
    _draw_measure(axes, slide_ends, "b", (-11, -9))
    return figure


def _draw_measure(
    axes: Axes,
    ends: np.ndarray,
    name: str,
    shift: tuple[int, int],
    look: Look = OBLIQUE,
) -> None:
    """A distance of two points (2, 3), with its name."""
    spots = ends @ look.plane
    draw_arrow(axes, spots, {"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0})
    _name(axes, spots.mean(axis=0), name, shift)


def _name(axes: Axes, spot: np.ndarray, name: str, shift: tuple[int, int]) -> None:
    """A name that begins off a spot (2,), by a ``shift`` in points."""
    write_beside(axes, spot, name, np.array(shift), ha="left", va="baseline")


def _draw_slides(axes: Axes, plane: np.ndarray) -> None:
    """The lines on which the odd joints slide, from the centre to their first place."""
    reach = 2 / np.sqrt(3)
    for turn in (0, 1, 2):
        angle = turn * 2 * np.pi / 3
        far = reach * np.array([np.cos(angle), np.sin(angle), 0.0])
        ends = np.stack([np.zeros(3), far]) @ plane
        axes.plot(*ends.T, color=AXIS_COLOR, linestyle="-.", linewidth=0.9, zorder=1)
        axes.plot(*ends[1], "|", color=AXIS_COLOR, zorder=1)


def _row(content: Content, look: Look, mark: Mark) -> Figure:
    """Several configurations, numbered from the first, with what ``mark`` adds."""
    angles = content["thetas"]
    figure = Figure(figsize=(2.75 * len(angles), 2.9), layout="constrained")
    panels = figure.subplots(1, len(angles))
    for number, (axes, degrees) in enumerate(zip(panels, angles, strict=True), start=1):
        centres, _, _ = _bodies(content, degrees)
        _draw_slides(axes, look.plane)
        _draw_mechanism(axes, centres, look, str(number))
        mark(axes, centres, look)
        axes.set_title(f"θ = {degrees}°", fontsize=9)
        axes.set(xlim=(-1.55, 1.55), ylim=(-1.4, 1.4))
    return figure


def _mark_slide(axes: Axes, centres: np.ndarray, look: Look) -> None:
    """b, from the first place of O1 to where it is."""
    if np.linalg.norm(FIRST_PLACE - centres[0]) > SHORTEST:
        below = np.array([0.0, -0.3, 0.0])
        ends = np.stack([FIRST_PLACE, centres[0]]) + below
        _draw_measure(axes, ends, "b", (-3, -12), look)


def _mark_height(axes: Axes, centres: np.ndarray, look: Look) -> None:
    """H = OT, from the plane of the odd joints to that of the even ones, and M1 in the
    middle of O1 and O5."""
    top = centres[1::2].mean(axis=0)
    if np.linalg.norm(top) < SHORTEST:
        return
    _draw_measure(axes, np.stack([np.zeros(3), top]), "H", (4, -3), look)
    middle = 0.5 * (centres[0] + centres[4])
    points = {
        "O": (np.zeros(3), (-9, -11)),
        "T": (top, (-3, 5)),
        "M₁": (middle, (5, -4)),
    }
    for name, (point, shift) in points.items():
        spot = point @ look.plane
        axes.plot(*spot, ".", color="black", zorder=4)
        _name(axes, spot, name, shift)


CHARTS: dict[str, Callable[[Content], Figure]] = {
    "angles": _angles,
    "height": _height,
    "planes": _planes,
    "axes": _axes,
    "disposition": _disposition,
    "above": partial(_row, look=ABOVE, mark=_mark_slide),
    "positions": partial(_row, look=OBLIQUE, mark=_mark_height),
    "distances": _distances,
    "distances_by_twist": _distances_by_twist,
}
