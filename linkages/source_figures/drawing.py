"""Assemblies on paper: seen from where they are clearest, far links behind near ones,
joint numbers beside the joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from bifurc.figures.style import Properties
from linkages.scene import distances_to_segments, looks_around
from linkages.source_figures.assembly import UP, Assembly, Bar, Role

DIRECTIONS = 240  # from which an assembly is looked at
FEW = 5  # every such direction, where many assemblies are compared
REACH = 0.2  # of the extent: half the drawn length of an axis beyond its links
LINK_COLORS = {Role.KEPT: "#0072B2", Role.COMMON: "0.55", Role.REMOVED: "0.55"}
LINK_DASHES = {Role.KEPT: "-", Role.COMMON: "-", Role.REMOVED: (0, (3, 2))}
OFFSET_COLOR = "#D55E00"
AXIS_COLOR = "0.5"
LINE_COLOR = "#009E73"  # of lines of symmetry, and of those that meet all axes
HALO = [withStroke(linewidth=2.5, foreground="white")]  # text on lines stays legible
CENTERED: Properties = {"ha": "center", "va": "center"}
NUMBER_DISTANCE = 0.09  # of the extent, from a joint to its number
FROM_NUMBERS = 0.5  # a number covers more of another one than of a line
PLACES = 16  # about a joint, where its number may stand


class Look(NamedTuple):
    """The directions in space (3,) that point right, up and towards the reader."""

    right: np.ndarray
    up: np.ndarray
    near: np.ndarray

    @property
    def plane(self) -> np.ndarray:
        """The matrix (3, 2) that takes what is in space to the paper."""
        return np.stack([self.right, self.up], axis=1)


def look_along(near: np.ndarray, up: np.ndarray = UP) -> Look:
    """The look from direction ``near``, with ``up`` (3,) upwards as far as it can."""
    near = near / np.linalg.norm(near)
    up = up - (up @ near) * near
    if np.linalg.norm(up) < 1e-9:
        up = np.eye(3)[int(np.argmin(np.abs(near)))]
        up = up - (up @ near) * near
    up = up / np.linalg.norm(up)
    return Look(np.cross(up, near), up, near)


def clarity(assembly: Assembly) -> float:
    """How clear an assembly is when it is seen from where it is clearest, of a few
    directions."""
    looks = [look_along(near) for near in looks_around(DIRECTIONS)[::FEW]]
    return float(_clarities(assembly, looks).max())


def best_look(*assemblies: Assembly) -> Look:
    """The look in which joints lie furthest apart from each other and from links, and
    no axis is seen end on; of several assemblies on average."""
    looks = [look_along(near) for near in looks_around(DIRECTIONS)]
    return clearest_of(assemblies, looks)


def clearest_of(assemblies: Sequence[Assembly], looks: Sequence[Look]) -> Look:
    """The look, of those given, in which assemblies are clearest, on average."""
    merits = sum(_clarities(assembly, looks) for assembly in assemblies)
    return looks[int(np.argmax(np.round(merits, 9)))]


def _clarities(assembly: Assembly, looks: Sequence[Look]) -> np.ndarray:
    """How clearly an assembly is seen in each look (k,): least distances of joints on
    paper, from each other and from links that they are not on, and how much is seen of
    every axis."""
    points = assembly.points()
    directions = np.array([axis.direction for axis in assembly.axes.values()])
    segments = np.array([bar.ends for bar in assembly.bars])
    is_own = np.array(
        [
            [_is_on(assembly, joint, bar) for bar in assembly.bars]
            for joint in assembly.axes
        ]
    )
    size = _extent(points)
    first, second = np.triu_indices(len(points), 1)
    clarities = []
    for look in looks:
        spots = points @ look.plane
        gap = np.linalg.norm(spots[first] - spots[second], axis=1).min() / size
        to_links = distances_to_segments(spots, segments @ look.plane)
        free = min(np.where(is_own, np.inf, to_links).min() / size, 1.0)
        seen = np.linalg.norm(directions @ look.plane, axis=1).min()
        offsets = spots - spots.mean(axis=0)
        spread = np.linalg.svd(offsets, compute_uv=False)[-1] / size
        clarities.append(4 * gap + 4 * free + spread + min(seen, 0.5))
    return np.array(clarities)


def _is_on(assembly: Assembly, joint: str, bar: Bar) -> bool:
    """Whether a joint is an end of a link, or has its seat on it."""
    ends = {bar.first, bar.last}
    seat = assembly.seats.get(joint)
    return joint in ends or (seat is not None and ends == {seat.first, seat.last})


def _extent(points: np.ndarray) -> float:
    """The largest distance of one of the points (k, 3) from their middle."""
    distances = np.linalg.norm(points - points.mean(axis=0), axis=1)
    return max(float(distances.max()), 1e-12)


def symmetry_line(assembly: Assembly, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A point and the unit direction (3,) of the line about which a half turn takes
    each of the first ``count`` joints to the one half round the loop."""
    half = count // 2
    points = assembly.points()[:count]
    across = points[half:] - points[:half]
    _, _, directions = np.linalg.svd(across)
    direction = directions[-1]
    middles = (points[half:] + points[:half]) / 2
    if direction @ (middles[0] - middles.mean(axis=0)) < 0:
        direction = -direction
    return middles.mean(axis=0), direction


# --- on paper -------------------------------------------------------------------------


@dataclass(frozen=True)
class Pen:
    """How thick lines are drawn, in points, and the size of text."""

    link: float = 2.6
    axis: float = 0.9
    dot: float = 5.0
    text: float = 8.5


SMALL = Pen(1.6, 0.5, 2.6, 6.5)
LARGE = Pen()


def draw_assembly(
    axes: Axes,
    assembly: Assembly,
    look: Look | None = None,
    *,
    filled: Sequence[str] = (),
    unnumbered: Sequence[str] = (),
    pen: Pen = LARGE,
    reach: float = REACH,
) -> None:
    """Draw an assembly; ``filled`` joints are solid dots, ``unnumbered`` ones bear no
    number; axes are drawn to ``reach`` of the extent beyond their links."""
    look = look or best_look(assembly)
    points = assembly.points()
    centre = points.mean(axis=0)
    extent = _extent(points)
    axis_ends = _draw_axes(axes, assembly, look.plane, reach * extent, pen)
    for bar in assembly.bars:
        depth = float((bar.ends.mean(axis=0) - centre) @ look.near) / extent
        _draw_link(axes, bar.ends @ look.plane, bar.role, 3 + 0.4 * depth, pen)
    joints = dict(zip(assembly.axes, points, strict=True))
    spots = {name: point @ look.plane for name, point in joints.items()}
    for name, point in joints.items():
        depth = float((point - centre) @ look.near) / extent
        offset = assembly.offset(name) @ look.plane
        style: Properties = {"color": OFFSET_COLOR, "linewidth": pen.link}
        axes.plot(*offset.T, zorder=3 + 0.4 * depth, **style)
        _draw_joint(axes, spots[name], name in filled, pen)
    lines = [bar.ends @ look.plane for bar in assembly.bars]
    lines += axis_ends
    numbered = [name for name in assembly.axes if name not in unnumbered]
    write_names(axes, spots, numbered, lines, extent, pen)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_axis_off()


def _draw_axes(
    axes: Axes, assembly: Assembly, plane: np.ndarray, reach: float, pen: Pen
) -> list[np.ndarray]:
    """Draw every joint axis with an arrow at its positive end; returns their ends (2,
    2) on paper."""
    drawn = []
    style: Properties = {
        "color": AXIS_COLOR,
        "linewidth": pen.axis,
        "mutation_scale": 2.2 * pen.dot * 0.7,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    for name, axis in assembly.axes.items():
        ends = assembly.offset(name) + np.array([[-reach], [reach]]) * axis.direction
        spots = ends @ plane
        draw_arrow(axes, spots, style, zorder=2, annotation_clip=False)
        axes.plot(*spots.T, alpha=0)  # the frame holds the whole axis
        drawn.append(spots)
    return drawn


def _draw_joint(axes: Axes, spot: np.ndarray, is_filled: bool, pen: Pen) -> None:
    axes.plot(
        *spot,
        "o",
        markersize=pen.dot,
        markerfacecolor="black" if is_filled else "white",
        markeredgecolor="black",
        markeredgewidth=0.9,
        zorder=5,
    )


def _draw_link(
    axes: Axes, spots: np.ndarray, role: Role, zorder: float, pen: Pen
) -> None:
    """One link, with a white edge where it passes over another."""
    width = pen.link if role is not Role.REMOVED else 0.7 * pen.link
    if role is Role.KEPT:
        axes.plot(*spots.T, color="white", linewidth=width + 2, zorder=zorder)
    axes.plot(
        *spots.T,
        color=LINK_COLORS[role],
        linestyle=LINK_DASHES[role],
        linewidth=width,
        solid_capstyle="round",
        zorder=zorder + 0.001,
    )


def draw_arrow(
    axes: Axes, spots: np.ndarray, style: Properties, **options: Any
) -> None:
    """Draw an arrow from the first to the last of the spots (2, 2)."""
    arrow = {"arrowstyle": "-|>", **style}
    start, end = spots.tolist()
    axes.annotate("", xy=end, xytext=start, arrowprops=arrow, **options)


def write_at(axes: Axes, spot: np.ndarray, text: str, **style: Any) -> None:
    """Write a text on a spot (2,), in the middle unless the style says otherwise."""
    x, y = spot.tolist()
    axes.text(x, y, text, **{**CENTERED, **style})


def write_beside(
    axes: Axes, spot: np.ndarray, text: str, shift: np.ndarray, **style: Any
) -> None:
    """Write a text off a spot (2,), by a ``shift`` (2,) in points, in the middle."""
    place, offset = tuple(spot.tolist()), tuple(shift.tolist())
    options = {"fontsize": 9, **CENTERED, **style}
    axes.annotate(text, place, offset, textcoords="offset points", **options)


def write_names(
    axes: Axes,
    spots: dict[str, np.ndarray],
    names: Sequence[str],
    lines: Sequence[np.ndarray],
    extent: float,
    pen: Pen,
) -> None:
    """Names beside their spots (2,), each where all spots, lines (2, 2) and other names
    leave most room; the ``extent`` is that of the drawing."""
    all_spots = np.array(list(spots.values()))
    taken = np.empty((0, 2))
    angles = np.linspace(0, 2 * np.pi, PLACES, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    segments = np.array(lines)
    for name in names:
        best = None
        for factor in (1.0, 1.5):
            places = spots[name] + factor * NUMBER_DISTANCE * extent * ring
            to_lines = distances_to_segments(places, segments).min(axis=1)
            to_spots = _to_spots(places, all_spots)
            to_names = FROM_NUMBERS * _to_spots(places, taken)
            nearest = np.minimum(np.minimum(to_lines, to_spots), to_names)
            room = nearest - 0.02 * factor * extent
            place = int(np.argmax(np.round(room / extent, 6)))
            if best is None or room[place] > best[0] + 0.03 * extent:
                best = (room[place], places[place])
        assert best is not None
        taken = np.vstack([taken, best[1]])
        axes.plot(*best[1], alpha=0)  # the frame holds the number
        style: Properties = {"fontsize": pen.text, "zorder": 6, "path_effects": HALO}
        write_at(axes, best[1], name, **style)


def _to_spots(places: np.ndarray, spots: np.ndarray) -> np.ndarray:
    """Distances (p,) of places (p, 2) from the nearest of some spots (q, 2); inf where
    there is none."""
    distances = np.linalg.norm(places[:, None] - spots, axis=2)
    nearest: np.ndarray = distances.min(axis=1, initial=np.inf)
    return nearest


def draw_row(
    panels: Sequence[Axes],
    assemblies: Sequence[Assembly],
    titles: Sequence[str],
    size: float,
) -> None:
    """Assemblies in the first of the panels, all seen from the side from which they are
    clearest, with titles in letters of a ``size``."""
    look = best_look(*assemblies)
    for axes in panels:
        axes.set_axis_off()
    for axes, assembly, title in zip(panels, assemblies, titles, strict=False):
        draw_assembly(axes, assembly, look, pen=SMALL)
        axes.set_title(title, fontsize=size, pad=2)
