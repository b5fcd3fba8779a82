"""Figures that explain names of lengths and angles: chains of links, one link in
several positions, and a joint seen along its axis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from linkages.source_figures.assembly import (
    Assembly,
    Axis,
    Bar,
    Role,
    bar_between,
    joint_on,
    turn,
)
from linkages.source_figures.construction import assembly_of
from linkages.source_figures.drawing import HALO, draw_assembly, look_along, write_at
from linkages.source_figures.table import Content, SourceFigure

UP = np.array([0.0, 0.0, 1.0])
OBLIQUE = look_along(np.array([0.75, -1.0, 0.6]), UP)
REACH = 0.9  # of the extent: how far the axes of a chain are drawn
ARC = 0.3  # radius of an arc, in the unit of the chain
EARLY = 0.2  # of a link: where a name stands that has no room in its middle
ARC_POINTS = 30
STUB = 0.75  # length of a ray that shows a direction
ARC_COLOR = "#D55E00"
RAY_COLOR = "0.45"


def draw(source: SourceFigure) -> Figure:
    """Chains, links or the rays at a joint, whichever the figure has."""
    content = source.content
    if "rays" in content:
        return _draw_rays(content)
    if "links" in content:
        return _draw_links(content)
    panels = content.get("panels", [content])
    figure = Figure(figsize=(4.6 * len(panels), 4.2), layout="constrained")
    for axes, panel in zip(
        figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True
    ):
        _draw_chain(axes, panel)
        axes.set_title(
            panel.get("title", "") if "panels" in content else "", fontsize=9
        )
    return figure


# --- chains ---------------------------------------------------------------------------


def chain_assembly(rows: Sequence[Sequence[float]], names: Sequence[str]) -> Assembly:
    """A chain of axes: each row has length, twist, offset and angle of a link, in
    degrees; the first link leaves along the x axis turned by its angle."""
    assembly = Assembly()
    axis = Axis(np.zeros(3), UP)
    along = np.array([1.0, 0.0, 0.0])
    assembly.axes[names[0]] = axis
    for number, (length, twist, offset, angle) in enumerate(rows):
        along = turn(along, axis.direction, np.radians(angle))
        start = axis.point + offset * axis.direction
        following = joint_on(
            Axis(start, axis.direction),
            Axis(start + along, axis.direction),
            length,
            np.radians(twist),
        )
        first, last = names[number], names[number + 1]
        ends = np.stack([start, following.point])
        assembly.axes[last] = following
        assembly.bars.append(Bar(first, last, ends))
        axis = following
    return assembly


def _draw_chain(axes: Axes, content: Content) -> None:
    rows = content["chain"]
    names = content["names"][: len(rows) + 1]
    assembly = chain_assembly(rows, names)
    if content.get("closing"):
        assembly.bars.append(bar_between(assembly, names[-1], names[0]))
    if content.get("replaced"):
        for place, bar in enumerate(assembly.bars[:-1]):
            assembly.bars[place] = Bar(bar.first, bar.last, bar.ends, "", Role.COMMON)
    look = OBLIQUE
    plane = np.stack([look.right, look.up], axis=1)
    draw_assembly(axes, assembly, look, unnumbered=tuple(names), reach=REACH)
    points = np.array([assembly.joint(name) for name in names])
    centre = points.mean(axis=0) @ plane
    for bar in assembly.bars:
        pair = f"{bar.first}{bar.last}"
        is_closing = (
            bar.last == names[0]
        )  # its twist stands near, and at its start nothing
        share = EARLY if is_closing else 0.5
        _write_beside(axes, bar.ends @ plane, f"$a_{{{pair}}}$", centre, share)
        _draw_twist(axes, assembly, bar, f"$\\alpha_{{{pair}}}$", plane)
    for name in names:
        _name_axis(axes, assembly, name, plane)
    _draw_turns(axes, assembly, content, plane)
    axes.margins(0.12)


def _write_beside(
    axes: Axes, ends: np.ndarray, text: str, centre: np.ndarray, share: float = 0.5
) -> None:
    """A text beside a line (2, 2), after a share of it, on the side away from
    ``centre``."""
    along = ends[1] - ends[0]
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
    middle = ends.mean(axis=0)
    if across @ (middle - centre) < 0:
        across = -across
    _write(axes, ends[0] + share * along, text, 11 * across)


def _name_axis(axes: Axes, assembly: Assembly, name: str, plane: np.ndarray) -> None:
    """The name of an axis beyond its arrow, and of its offset."""
    offset = assembly.offset(name)
    direction = assembly.axes[name].direction
    points = np.array([assembly.joint(other) for other in assembly.axes])
    extent = float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
    tip = (offset[1] + 1.15 * REACH * extent * direction) @ plane
    _write(axes, tip, f"$z_{{{name}}}$", np.zeros(2))
    axes.plot(*tip, alpha=0)


def _draw_turns(
    axes: Axes, assembly: Assembly, content: Content, plane: np.ndarray
) -> None:
    """The angle and the offset at every joint between two links of the chain; at the
    first joint, the direction of the link before it."""
    names = content["names"]
    along = np.array([1.0, 0.0, 0.0])
    for number, (_, _, offset, angle) in enumerate(content["chain"]):
        axis = assembly.axes[names[number]]
        if number > 0:
            before = assembly.bars[number - 1].ends
            along = (before[1] - before[0]) / np.linalg.norm(before[1] - before[0])
        start = assembly.bars[number].ends[0]
        foot = start - offset * axis.direction
        name = names[number]
        if angle:
            label = content.get("kink", f"\\theta_{{{name}}}")
            ray = np.stack([start, start + STUB * along]) @ plane
            axes.plot(*ray.T, color=RAY_COLOR, linestyle=(0, (3, 2)), linewidth=1.0)
            arc = _arc(start, along, axis.direction, np.radians(angle), 1.4 * ARC)
            _draw_arc(axes, arc, f"${label}$", plane)
        if offset:
            label = content.get("distance", f"R_{{{name}}}")
            ends = np.stack([foot, start]) @ plane
            away = assembly.bars[number].ends[1] @ plane
            _write_beside(axes, ends, f"${label}$", away)
        if number == 0 and angle:
            _draw_first_direction(axes, foot, along, start, name, plane)


def _draw_first_direction(
    axes: Axes,
    foot: np.ndarray,
    along: np.ndarray,
    start: np.ndarray,
    name: str,
    plane: np.ndarray,
) -> None:
    """The link that comes to the first joint of a chain, and the offset there."""
    offset = np.stack([foot, start]) @ plane
    axes.plot(*offset.T, color=ARC_COLOR, linewidth=2.6, zorder=3)
    ends = np.stack([foot - STUB * along, foot]) @ plane
    axes.plot(*ends.T, color=RAY_COLOR, linewidth=1.6)
    _write(axes, ends[0], f"$x_{{{name}}}$", np.array([-8.0, 0.0]))


def _draw_twist(
    axes: Axes, assembly: Assembly, bar: Bar, label: str, plane: np.ndarray
) -> None:
    """The twist of a link at its far end, from the direction of the first axis."""
    start = bar.ends[1]
    one = assembly.axes[bar.first].direction
    other = assembly.axes[bar.last].direction
    ray = np.stack([start, start + STUB * 0.8 * one]) @ plane
    axes.plot(*ray.T, color=RAY_COLOR, linestyle=(0, (3, 2)), linewidth=1.0)
    normal = np.cross(one, other)
    size = float(np.linalg.norm(normal))
    angle = float(np.arctan2(size, one @ other))
    _draw_arc(axes, _arc(start, one, normal / size, angle), label, plane)


def _arc(
    centre: np.ndarray,
    start: np.ndarray,
    axis: np.ndarray,
    angle: float,
    radius: float = ARC,
) -> np.ndarray:
    """Points (k, 3) of an arc about an axis, from the direction ``start``."""
    angles = np.linspace(0.0, angle, ARC_POINTS)
    return np.array([centre + radius * turn(start, axis, a) for a in angles])


def _draw_arc(axes: Axes, arc: np.ndarray, label: str, plane: np.ndarray) -> None:
    spots = arc @ plane
    axes.plot(*spots.T, color=ARC_COLOR, linewidth=1.2, zorder=6)
    middle = spots[len(spots) // 2]
    chord = (spots[0] + spots[-1]) / 2
    outwards = middle - chord
    size = max(float(np.linalg.norm(outwards)), 1e-9)
    _write(axes, middle, label, 9 * outwards / size, ARC_COLOR)


def _write(
    axes: Axes,
    spot: np.ndarray,
    text: str,
    shift: np.ndarray,
    color: str = "black",
) -> None:
    axes.annotate(
        text,
        (float(spot[0]), float(spot[1])),
        (float(shift[0]), float(shift[1])),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=9,
        color=color,
        zorder=7,
        path_effects=HALO,
        annotation_clip=False,
    )


# --- one link, and a joint ------------------------------------------------------------


def _draw_links(content: Content) -> Figure:
    """One link with several twists, seen from the same side."""
    links = content["links"]
    assemblies = [
        chain_assembly([[length, twist, 0.0, 0.0]], ["2", "3"])
        for length, twist, _ in links
    ]
    look = OBLIQUE
    plane = np.stack([look.right, look.up], axis=1)
    figure = Figure(figsize=(2.5 * len(links), 2.6), layout="constrained")
    panels = figure.subplots(1, len(links))
    for axes, assembly, (_, _, label) in zip(panels, assemblies, links, strict=True):
        draw_assembly(axes, assembly, look, reach=REACH)
        bar = assembly.bars[0]
        _draw_small_twist(axes, assembly, bar, plane)
        below = bar.ends.mean(axis=0) @ plane - np.array([0.0, 1.0])
        _write_beside(axes, bar.ends @ plane, f"b/{label}", below)
        axes.set_title(f"twist {label}", fontsize=9)
        axes.set(xlim=(-0.6, 1.0), ylim=(-0.7, 0.8))
        axes.set_aspect("equal", adjustable="datalim")
    return figure


def _draw_small_twist(
    axes: Axes, assembly: Assembly, bar: Bar, plane: np.ndarray
) -> None:
    """The twist of a link at its far end, without a name."""
    start = bar.ends[1]
    one = assembly.axes[bar.first].direction
    other = assembly.axes[bar.last].direction
    normal = np.cross(one, other)
    size = float(np.linalg.norm(normal))
    angle = float(np.arctan2(size, one @ other))
    points = start + 0.4 * (_arc(np.zeros(3), one, normal / size, angle))
    axes.plot(*(points @ plane).T, color=ARC_COLOR, linewidth=1.2, zorder=6)


def ray_angles(content: Content) -> dict[str, float]:
    """The angle (rad) of each ray at a joint about its axis, from the first ray: a ray
    is the direction of the link between two joints."""
    panel = {key: content[key] for key in ("linkage", "form") if key in content}
    assembly = assembly_of(panel)
    axis = assembly.axes[content["joint"]].direction
    directions = {}
    for first, last, name in content["rays"]:
        ends = bar_between(assembly, first, last).ends
        direction = ends[1] - ends[0]
        directions[name] = direction - (direction @ axis) * axis
    start = next(iter(directions.values()))
    start = start / np.linalg.norm(start)
    across = np.cross(axis, start)
    return {
        name: float(np.arctan2(direction @ across, direction @ start))
        for name, direction in directions.items()
    }


def _draw_rays(content: Content) -> Figure:
    """The directions of the links at a joint, along its axis, with the angles between
    them."""
    angles = ray_angles(content)
    figure = Figure(figsize=(4.6, 4.4), layout="constrained")
    axes = figure.subplots()
    for name, angle in angles.items():
        spot = np.array([np.cos(angle), np.sin(angle)])
        axes.annotate(
            "",
            xy=tuple(spot),
            xytext=(0, 0),
            arrowprops={"arrowstyle": "-|>", "color": "#0072B2", "linewidth": 1.8},
        )
        write_at(axes, 1.12 * spot, name, fontsize=9)
    for number, (first, last, label) in enumerate(content["arcs"]):
        span = (angles[last] - angles[first]) % (2 * np.pi)
        turns = angles[first] + np.linspace(0.0, span, 60)
        _draw_span(
            axes, turns, 0.25 + 0.2 * number, f"{label} = {np.degrees(span):.1f}°"
        )
    axes.plot(0, 0, "o", markerfacecolor="white", markeredgecolor="black")
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    return figure


def _draw_span(axes: Axes, turns: np.ndarray, radius: float, text: str) -> None:
    """An arc about the origin through angles (k,), rad, with an arrow and its name."""
    x = radius * np.cos(turns)
    y = radius * np.sin(turns)
    axes.plot(x, y, color=ARC_COLOR, linewidth=1.2)
    axes.annotate(
        "",
        xy=(x[-1], y[-1]),
        xytext=(x[-3], y[-3]),
        arrowprops={"arrowstyle": "-|>", "color": ARC_COLOR, "linewidth": 1.0},
    )
    spot = (radius + 0.09) * np.array([np.cos(turns[20]), np.sin(turns[20])])
    box = {"boxstyle": "square,pad=0.1", "facecolor": "white", "linewidth": 0}
    write_at(axes, spot, text, fontsize=8, color=ARC_COLOR, bbox=box)
