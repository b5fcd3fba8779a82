"""Assemblies on paper: seen from where they are clearest, far links behind near ones,
joint numbers beside the joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from linkages.source_figures.assembly import Assembly, Role

DIRECTIONS = 240  # from which an assembly is looked at
FEW = 5  # every such direction, where many assemblies are compared
REACH = 0.2  # of the extent: half the drawn length of an axis beyond its links
LINK_COLORS = {Role.KEPT: "#0072B2", Role.COMMON: "0.55", Role.REMOVED: "0.55"}
LINK_DASHES = {Role.KEPT: "-", Role.COMMON: "-", Role.REMOVED: (0, (3, 2))}
OFFSET_COLOR = "#D55E00"
AXIS_COLOR = "0.5"
HALO = [withStroke(linewidth=2.5, foreground="white")]  # text on lines stays legible
NUMBER_DISTANCE = 0.09  # of the extent, from a joint to its number
FROM_NUMBERS = 0.5  # a number covers more of another one than of a line
PLACES = 16  # about a joint, where its number may stand


class Look(NamedTuple):
    """The directions in space (3,) that point right, up and towards the reader."""

    right: np.ndarray
    up: np.ndarray
    near: np.ndarray


def look_along(near: np.ndarray, up: np.ndarray) -> Look:
    """The look from direction ``near``, with ``up`` (3,) upwards as far as it can."""
    near = near / np.linalg.norm(near)
    up = up - (up @ near) * near
    if np.linalg.norm(up) < 1e-9:
        up = np.eye(3)[int(np.argmin(np.abs(near)))]
        up = up - (up @ near) * near
    up = up / np.linalg.norm(up)
    return Look(np.cross(up, near), up, near)


def best_look(assembly: Assembly) -> Look:
    """The look in which joints lie furthest apart from each other and from links, and
    no axis is seen end on."""
    return common_look([assembly])


def clarity(assembly: Assembly) -> float:
    """How clear an assembly is when it is seen from where it is clearest, of a few
    directions."""
    outline = _outline(assembly)
    up = np.array([0.0, 0.0, 1.0])
    looks = [look_along(near, up) for near in _spiral()[::FEW]]
    return max(_clarity(outline, look) for look in looks)


def common_look(assemblies: Sequence[Assembly]) -> Look:
    """The look in which several assemblies are clearest, on average."""
    up = np.array([0.0, 0.0, 1.0])
    return clearest_of(assemblies, [look_along(near, up) for near in _spiral()])


def clearest_of(assemblies: Sequence[Assembly], looks: Sequence[Look]) -> Look:
    """The look, of those given, in which assemblies are clearest, on average."""
    merits = np.zeros(len(looks))
    for assembly in assemblies:
        outline = _outline(assembly)
        merits += [_clarity(outline, look) for look in looks]
    return looks[int(np.argmax(np.round(merits, 9)))]


class _Outline(NamedTuple):
    """What a look is judged by: joints (n, 3), directions of their axes (n, 3), links
    (m, 2, 3), and whether joint i is on link j (n, m)."""

    points: np.ndarray
    directions: np.ndarray
    segments: np.ndarray
    is_own: np.ndarray


def _outline(assembly: Assembly) -> _Outline:
    names = list(assembly.axes)
    is_own = []
    for name in names:
        seat = assembly.seats.get(name)
        carrier = {seat.first, seat.last} if seat else set()
        is_own.append(
            [
                name in (bar.first, bar.last) or {bar.first, bar.last} == carrier
                for bar in assembly.bars
            ]
        )
    return _Outline(
        np.array([assembly.joint(name) for name in names]),
        np.array([axis.direction for axis in assembly.axes.values()]),
        np.array([bar.ends for bar in assembly.bars]),
        np.array(is_own),
    )


def _spiral() -> np.ndarray:
    """Unit vectors (k, 3) over the upper half of the sphere."""
    k = np.arange(DIRECTIONS)
    z = (k + 0.5) / DIRECTIONS * 0.9
    turns = k * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - z**2)
    return np.column_stack([ring * np.cos(turns), ring * np.sin(turns), z])


def _clarity(outline: _Outline, look: Look) -> float:
    """How clearly an assembly is seen: least distances of joints on paper, and how much
    is seen of every axis."""
    points, directions, segments, is_own = outline
    plane = np.stack([look.right, look.up], axis=1)  # (3, 2)
    spots = points @ plane
    size = max(float(np.linalg.norm(points - points.mean(axis=0), axis=1).max()), 1e-12)
    first, second = np.triu_indices(len(spots), 1)
    gap = np.linalg.norm(spots[first] - spots[second], axis=1).min() / size
    to_links = _to_segments(spots, segments @ plane)
    free = np.where(is_own, np.inf, to_links).min() / size
    free = min(free, 1.0)
    seen = np.linalg.norm(directions @ plane, axis=1).min()
    spread = np.linalg.svd(spots - spots.mean(axis=0), compute_uv=False)[-1] / size
    return float(4 * gap + 4 * free + spread + min(seen, 0.5))


def _to_segments(spots: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Distances (p, q) of spots (p, 2) from segments (q, 2, 2)."""
    starts = segments[:, 0]
    along = segments[:, 1] - starts
    squares = np.maximum((along**2).sum(axis=1), 1e-300)
    towards = spots[:, None] - starts[None]
    fractions = np.clip(np.einsum("ijk,jk->ij", towards, along) / squares, 0, 1)
    rest = towards - fractions[..., None] * along
    return np.asarray(np.linalg.norm(rest, axis=-1))


def symmetry_line(assembly: Assembly, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A point and the unit direction (3,) of the line about which a half turn takes
    each of the first ``count`` joints to the one half round the loop."""
    names = list(assembly.axes)[:count]
    half = count // 2
    points = np.array([assembly.joint(name) for name in names])
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
    filled: tuple[str, ...] = (),
    unnumbered: tuple[str, ...] = (),
    pen: Pen = LARGE,
    reach: float = REACH,
) -> None:
    """Draw an assembly; ``filled`` joints are solid dots, ``unnumbered`` ones bear no
    number; axes are drawn to ``reach`` of the extent beyond their links."""
    look = look or best_look(assembly)
    plane = np.stack([look.right, look.up], axis=1)
    joints = {name: assembly.joint(name) for name in assembly.axes}
    points = np.array(list(joints.values()))
    centre = points.mean(axis=0)
    extent = max(float(np.linalg.norm(points - centre, axis=1).max()), 1e-12)
    axis_ends = _draw_axes(axes, assembly, plane, reach * extent, pen)
    for bar in assembly.bars:
        depth = float((bar.ends.mean(axis=0) - centre) @ look.near) / extent
        _draw_link(axes, bar.ends @ plane, bar.role, 3 + 0.4 * depth, pen)
    for name, point in joints.items():
        depth = float((point - centre) @ look.near) / extent
        offset = assembly.offset(name) @ plane
        axes.plot(
            *offset.T,
            color=OFFSET_COLOR,
            linewidth=pen.link,
            zorder=3 + 0.4 * depth,
        )
        _draw_joint(axes, point @ plane, name in filled, pen)
    lines = [bar.ends @ plane for bar in assembly.bars]
    lines += axis_ends
    numbered = [name for name in assembly.axes if name not in unnumbered]
    spots = {name: joints[name] @ plane for name in assembly.axes}
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
    for name, axis in assembly.axes.items():
        offset = assembly.offset(name)
        ends = offset + np.array([[-reach], [reach]]) * axis.direction
        spots = ends @ plane
        axes.annotate(
            "",
            xy=tuple(spots[1]),
            xytext=tuple(spots[0]),
            arrowprops={
                "arrowstyle": "-|>",
                "color": AXIS_COLOR,
                "linewidth": pen.axis,
                "mutation_scale": 2.2 * pen.dot * 0.7,
                "shrinkA": 0,
                "shrinkB": 0,
            },
            zorder=2,
            annotation_clip=False,
        )
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


def write_at(axes: Axes, spot: np.ndarray, text: str, **style: Any) -> None:
    """Write a text on a spot (2,), in the middle unless the style says otherwise."""
    x, y = spot.tolist()
    axes.text(x, y, text, **{"ha": "center", "va": "center", **style})


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
            to_lines = _to_segments(places, segments).min(axis=1)
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
        style = {"fontsize": pen.text, "zorder": 6, "path_effects": HALO}
        write_at(axes, best[1], name, **style)


def _to_spots(places: np.ndarray, spots: np.ndarray) -> np.ndarray:
    """Distances (p,) of places (p, 2) from the nearest of some spots (q, 2); inf where
    there is none."""
    distances = np.linalg.norm(places[:, None] - spots, axis=2)
    nearest: np.ndarray = distances.min(axis=1, initial=np.inf)
    return nearest
