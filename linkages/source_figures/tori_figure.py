"""Figures of tori made by tilted circles, and of the linkages on them (Bil and Budniak
2014), by their equation (2.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from bifurc.figures.style import Properties
from linkages.families.tori import companion, torus_link
from linkages.source_figures.assembly import UP, turn, unit
from linkages.source_figures.drawing import (
    LARGE,
    draw_arrow,
    look_along,
    write_names,
)
from linkages.source_figures.table import SourceFigure

LOOK = look_along(np.array([1.0, -0.8, 0.75]))
TURN = np.linspace(0.0, 2 * np.pi, 181)
CIRCLES = 36  # of which the surface is drawn
PLACE = -0.7  # sigma of the circles by which a single point is shown, rad
POINT_ANGLE = 0.9  # of S on its circle, rad
FIRST_COLOR = "#0072B2"
SECOND_COLOR = "#D55E00"
SIDE_COLOR = "0.35"  # of directions between which angles are measured
SHORT = 0.5  # length of such a direction
ARC, ARC_POINTS = 0.32, 25  # radius of the arc of an angle, and points of it


@dataclass(frozen=True)
class Torus:
    """A circle of radius ``s`` whose centre R stands at distance ``r`` from the axis of
    the torus, its own axis turned by ``chi`` and ``theta`` (rad)."""

    r: float
    s: float
    chi: float
    theta: float

    def centre(self, sigma: float) -> np.ndarray:
        """R (3,) at the angle ``sigma`` about the axis of the torus, rad."""
        return turn(np.array([self.r, 0.0, 0.0]), UP, sigma)

    def axis(self, sigma: float) -> np.ndarray:
        """The axis (3,) of the circle there, a unit vector."""
        return turn(self._tilt.apply(UP), UP, sigma)

    def axis_turned_by_chi(self, sigma: float) -> np.ndarray:
        """Where the axis (3,) of the circle is before it is turned by ``theta``."""
        return turn(Rotation.from_euler("X", self.chi).apply(UP), UP, sigma)

    def points(self, sigma: float, phi: np.ndarray) -> np.ndarray:
        """Points (k, 3) of the circle at angles (k,), rad."""
        flat = np.column_stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)])
        placed = self._tilt.apply(self.s * flat) + np.array([self.r, 0.0, 0.0])
        return np.asarray(Rotation.from_euler("z", sigma).apply(placed))

    def point(self, sigma: float, phi: float) -> np.ndarray:
        """The point (3,) of the circle at an angle, rad."""
        (point,) = self.points(sigma, np.array([phi]))
        return np.asarray(point)

    @property
    def _tilt(self) -> Rotation:
        return Rotation.from_euler("XY", [self.chi, self.theta])


def companion_torus(torus: Torus) -> Torus:
    """The other circle that makes the same surface."""
    link = torus_link(torus.r, torus.chi, torus.theta)
    _, other, other_pin = companion(link, torus.s)
    numbers = (other.radius, other_pin.radius, other.chi, other.theta)
    return Torus(*(float(number) for number in numbers))


# --- drawings -------------------------------------------------------------------------


def draw(source: SourceFigure) -> Figure:
    """The drawing that the figure names."""
    content = source.content
    torus = Torus(*(float(content[key]) for key in ("r1", "s1", "chi1", "theta1")))
    return CHARTS[content["chart"]](torus)


class TorusDrawing:
    """A torus with circles, lines and points on paper; names are written last, where
    all that leaves room."""

    def __init__(self, axes: Axes, torus: Torus):
        self.axes = axes
        self.extent = torus.r + torus.s
        self.spots: dict[str, np.ndarray] = {}
        self.lines: list[np.ndarray] = []
        for sigma in np.linspace(0, 2 * np.pi, CIRCLES, endpoint=False):
            spots = torus.points(sigma, TURN) @ LOOK.plane
            axes.plot(*spots.T, color="0.88", linewidth=0.6, zorder=1)

    def draw_arm(
        self, torus: Torus, sigma: float, phi: float, number: int, color: str
    ) -> None:
        """The circle at one place, with the lines Q R and R S, and its axis."""
        centre = torus.centre(sigma)
        self._draw_line(torus.points(sigma, TURN), color=color, linewidth=1.4)
        chain = np.stack([np.zeros(3), centre, torus.point(sigma, phi)])
        self._draw_line(chain, color=color, linewidth=2.4, zorder=4)
        self._draw_vector(centre, torus.axis(sigma), f"Z{number}1")
        self._draw_point(centre, f"R{number}")

    def draw_measures(self, torus: Torus, sigma: float, phi: float) -> None:
        """The names of the lengths and angles of an arm, each angle as an arc between
        two directions."""
        centre, point = torus.centre(sigma), torus.point(sigma, phi)
        along = np.array([1.0, 0.0, 0.0])
        start = torus.point(sigma, 0.0) - centre
        tilted = torus.axis_turned_by_chi(sigma)
        self._draw_vector(np.zeros(3), along, "X")
        for direction in (start, SHORT * UP, SHORT * tilted):
            ends = np.stack([centre, centre + direction])
            self._draw_line(ends, color=SIDE_COLOR, linestyle="--", linewidth=0.9)
        self._draw_angle(np.zeros(3), along, unit(centre), "σ")
        self._draw_angle(centre, unit(start), unit(point - centre), "φ")
        self._draw_angle(centre, UP, tilted, "χ")
        self._draw_angle(centre, tilted, torus.axis(sigma), "θ")
        self.spots["r"] = 0.5 * centre @ LOOK.plane
        self.spots["s"] = 0.5 * (centre + point) @ LOOK.plane

    def finish(self, point: np.ndarray, title: str) -> None:
        """Draw the axis, Q on it and the ``point`` S, and write names and title."""
        self._draw_vector(np.zeros(3), UP, "Z")
        self._draw_point(np.zeros(3), "Q")
        self._draw_point(point, "S")
        names = list(self.spots)
        write_names(self.axes, self.spots, names, self.lines, self.extent, LARGE)
        self.axes.set_title(title, fontsize=9)
        self.axes.set_aspect("equal")
        self.axes.margins(0.04)
        self.axes.set_axis_off()

    def _draw_vector(self, point: np.ndarray, direction: np.ndarray, name: str) -> None:
        """An arrow through a point (3,), named at its head."""
        ends = np.stack([point - 0.25 * direction, point + 0.65 * direction])
        spots = ends @ LOOK.plane
        draw_arrow(self.axes, spots, {"color": "0.35", "linewidth": 1.0}, zorder=5)
        self.lines.append(spots)
        self.spots[name] = spots[1]

    def _draw_angle(
        self, centre: np.ndarray, start: np.ndarray, end: np.ndarray, name: str
    ) -> None:
        """An arc about a point between two unit vectors (3,), named at its middle."""
        angle = np.arctan2(np.linalg.norm(np.cross(start, end)), start @ end)
        turns = angle * np.linspace(0.0, 1.0, ARC_POINTS)[:, None]
        arc = (np.sin(angle - turns) * start + np.sin(turns) * end) / np.sin(angle)
        points = centre + ARC * arc
        self._draw_line(points, color="black", linewidth=0.9, zorder=5)
        self.spots[name] = points[ARC_POINTS // 2] @ LOOK.plane

    def _draw_point(self, point: np.ndarray, name: str) -> None:
        """A point (3,) with its name."""
        spot = point @ LOOK.plane
        style: Properties = {"markerfacecolor": "white", "markeredgecolor": "black"}
        self.axes.plot(*spot, "o", zorder=6, **style)
        self.spots[name] = spot

    def _draw_line(self, points: np.ndarray, **style: Any) -> None:
        spots = points @ LOOK.plane
        self.axes.plot(*spots.T, **style)
        self.lines += [np.stack(pair) for pair in pairwise(spots)]


def _point(torus: Torus) -> Figure:
    """One point S by each of the two circles through it."""
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    arms = (
        (torus, FIRST_COLOR, "(a) r larger than s"),
        (companion_torus(torus), SECOND_COLOR, "(b) r smaller than s"),
    )
    panels = zip(figure.subplots(1, 2), arms, strict=True)
    for number, (axes, (one, color, title)) in enumerate(panels, start=1):
        drawing = TorusDrawing(axes, one)
        drawing.draw_arm(one, PLACE, POINT_ANGLE, number, color)
        drawing.draw_measures(one, PLACE, POINT_ANGLE)
        drawing.finish(one.point(PLACE, POINT_ANGLE), title)
    return figure


def _variants(torus: Torus) -> Figure:
    """The 4R linkage Q, R1, S, R2 with either circle of each of the two radii: one and
    its mirror image in the plane of Q, phi reversed with it."""
    figure = Figure(figsize=(9.0, 8.6), layout="constrained")
    other = companion_torus(torus)
    names = {1: "", -1: "-"}
    combinations = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    panels = zip(figure.subplots(2, 2).flat, combinations, strict=True)
    for axes, (first, second) in panels:
        one = replace(torus, chi=first * torus.chi)
        two = replace(other, chi=second * other.chi)
        ours = one.point(0.0, first * POINT_ANGLE)
        theirs = two.point(0.0, second * POINT_ANGLE)
        angle = np.arctan2(ours[1], ours[0]) - np.arctan2(theirs[1], theirs[0])
        drawing = TorusDrawing(axes, one)
        drawing.draw_arm(one, 0.0, first * POINT_ANGLE, 1, FIRST_COLOR)
        drawing.draw_arm(two, angle, second * POINT_ANGLE, 2, SECOND_COLOR)
        drawing.finish(ours, f"{names[first]}χ₁, {names[second]}χ₂")
    return figure


CHARTS: dict[str, Callable[[Torus], Figure]] = {
    "point": _point,
    "variants": _variants,
}
