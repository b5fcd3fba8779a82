"""Figures that explain names of lengths and angles: chains of links, one link in
several positions, and a joint seen along its axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bifurc.figures.style import Properties
from linkages.source_figures.assembly import (
    UP,
    Assembly,
    Axis,
    Bar,
    Role,
    bar_between,
    far_axis,
    turn,
    unit,
)
from linkages.source_figures.construction import assembly_of
from linkages.source_figures.drawing import (
    HALO,
    draw_arrow,
    draw_assembly,
    look_along,
    write_at,
    write_beside,
)
from linkages.source_figures.table import Content, SourceFigure

LOOK = look_along(np.array([0.75, -1.0, 0.6]))
REACH = 0.9  # of the extent: how far the axes of a chain are drawn
ARC = 0.3  # radius of an arc, in the unit of the chain
EARLY = 0.2  # of a link: where a name stands that has no room in its middle
ARC_POINTS = 30
STUB = 0.75  # length of a ray that shows a direction
ARC_COLOR = "#D55E00"
RAY_COLOR = "0.45"
RAY: Properties = {"color": RAY_COLOR, "linestyle": (0, (3, 2)), "linewidth": 1.0}
FIRST = np.array([1.0, 0.0, 0.0])  # along the link before the first joint of a chain


def draw(source: SourceFigure) -> Figure:
    """Chains, links or the rays at a joint, whichever the figure has."""
    content = source.content
    if "rays" in content:
        return _draw_rays(content)
    if "links" in content:
        return _draw_links(content)
    panels = content.get("panels", [content])
    figure = Figure(figsize=(4.6 * len(panels), 4.2), layout="constrained")
    cells = figure.subplots(1, len(panels), squeeze=False)[0]
    for axes, panel in zip(cells, panels, strict=True):
        _draw_chain(axes, panel)
        if "panels" in content:
            axes.set_title(panel.get("title", ""), fontsize=9)
    return figure


# --- chains ---------------------------------------------------------------------------


def chain_assembly(rows: Sequence[Sequence[float]], names: Sequence[str]) -> Assembly:
    """A chain of axes: each row has length, twist, offset and angle of a link, in
    degrees; the first link leaves along the x axis turned by its angle."""
    assembly = Assembly()
    axis = Axis(np.zeros(3), UP)
    along = FIRST
    assembly.axes[names[0]] = axis
    for number, (length, twist, offset, angle) in enumerate(rows):
        along = turn(along, axis.direction, np.radians(angle))
        start = Axis(axis.point + offset * axis.direction, axis.direction)
        axis = far_axis(start, along, length, np.radians(twist))
        first, last = names[number], names[number + 1]
        assembly.axes[last] = axis
        assembly.bars.append(Bar(first, last, np.stack([start.point, axis.point])))
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
    draw_assembly(axes, assembly, LOOK, unnumbered=names, reach=REACH)
    points = assembly.points()
    centre = points.mean(axis=0)
    for bar in assembly.bars:
        pair = f"{bar.first}{bar.last}"
        # the twist of a closing link stands near, and at its start nothing
        share = EARLY if bar.last == names[0] else 0.5
        _write_along(axes, bar.ends, f"$a_{{{pair}}}$", centre @ LOOK.plane, share)
        ray = STUB * 0.8 * assembly.axes[bar.first].direction
        _draw_ray(axes, bar.ends[1], ray)
        _draw_arc(axes, _twist_arc(assembly, bar), f"$\\alpha_{{{pair}}}$")
    extent = float(np.linalg.norm(points - centre, axis=1).max())
    for name, axis in assembly.axes.items():
        tip = assembly.offset(name)[1] + 1.15 * REACH * extent * axis.direction
        spot = tip @ LOOK.plane
        _write(axes, spot, f"$z_{{{name}}}$", np.zeros(2))
        axes.plot(*spot, alpha=0)
    _draw_turns(axes, assembly, content)
    axes.margins(0.12)


def _draw_turns(axes: Axes, assembly: Assembly, content: Content) -> None:
    """The angle and the offset at every joint between two links of the chain; at the
    first joint, the direction of the link before it."""
    along = FIRST
    for number, (_, _, offset, angle) in enumerate(content["chain"]):
        start, end = assembly.bars[number].ends
        name = content["names"][number]
        direction = assembly.axes[name].direction
        foot = start - offset * direction
        if angle:
            label = content.get("kink", f"\\theta_{{{name}}}")
            _draw_ray(axes, start, STUB * along)
            arc = _arc(start, along, direction, np.radians(angle), 1.4 * ARC)
            _draw_arc(axes, arc, f"${label}$")
        if offset:
            label = content.get("distance", f"R_{{{name}}}")
            ends = np.stack([foot, start])
            _write_along(axes, ends, f"${label}$", end @ LOOK.plane)
        if number == 0 and angle:
            _draw_line(axes, [foot, start], color=ARC_COLOR, linewidth=2.6, zorder=3)
            before = foot - STUB * along
            _draw_line(axes, [before, foot], color=RAY_COLOR, linewidth=1.6)
            _write(axes, before @ LOOK.plane, f"$x_{{{name}}}$", np.array([-8.0, 0.0]))
        along = unit(end - start)


def _twist_arc(assembly: Assembly, bar: Bar, radius: float = ARC) -> np.ndarray:
    """The twist of a link at its far end, from the direction of the first axis, as an
    arc (k, 3)."""
    one = assembly.axes[bar.first].direction
    other = assembly.axes[bar.last].direction
    normal = unit(np.cross(one, other))
    return _arc(bar.ends[1], one, normal, assembly.twist(bar), radius)


def _arc(
    centre: np.ndarray, start: np.ndarray, axis: np.ndarray, angle: float, radius: float
) -> np.ndarray:
    """Points (k, 3) of an arc about an axis, from the direction ``start``."""
    angles = np.linspace(0.0, angle, ARC_POINTS)
    return np.array([centre + radius * turn(start, axis, a) for a in angles])


# --- on paper -------------------------------------------------------------------------


def _draw_line(axes: Axes, points: Sequence[np.ndarray], **style: Any) -> None:
    """A line through points (3,)."""
    axes.plot(*(np.array(points) @ LOOK.plane).T, **style)


def _draw_ray(axes: Axes, start: np.ndarray, ray: np.ndarray) -> None:
    """A dashed line that shows a direction (3,)."""
    _draw_line(axes, [start, start + ray], **RAY)


def _draw_arc(axes: Axes, arc: np.ndarray, label: str) -> None:
    """An arc (k, 3) with its name outside."""
    spots = arc @ LOOK.plane
    axes.plot(*spots.T, color=ARC_COLOR, linewidth=1.2, zorder=6)
    middle = len(spots) // 2
    outwards = spots[middle] - (spots[0] + spots[-1]) / 2
    size = max(float(np.linalg.norm(outwards)), 1e-9)
    _write(axes, spots[middle], label, 9 * outwards / size, ARC_COLOR)


def _write_along(
    axes: Axes, ends: np.ndarray, text: str, away: np.ndarray, share: float = 0.5
) -> None:
    """A text beside a line (2, 3), after a share of it, on the side away from the spot
    ``away`` (2,)."""
    spots = ends @ LOOK.plane
    along = spots[1] - spots[0]
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
    if across @ (spots.mean(axis=0) - away) < 0:
        across = -across
    _write(axes, spots[0] + share * along, text, 11 * across)


def _write(
    axes: Axes, spot: np.ndarray, text: str, shift: np.ndarray, color: str = "black"
) -> None:
    """A text off a spot (2,), by a ``shift`` (2,) in points."""
    style: Properties = {"color": color, "zorder": 7, "path_effects": HALO}
    write_beside(axes, spot, text, shift, annotation_clip=False, **style)


# --- one link, and a joint ------------------------------------------------------------


def _draw_links(content: Content) -> Figure:
    """One link with several twists, seen from the same side."""
    links = content["links"]
    figure = Figure(figsize=(2.5 * len(links), 2.6), layout="constrained")
    panels = figure.subplots(1, len(links))
    for axes, (length, twist, label) in zip(panels, links, strict=True):
        assembly = chain_assembly([[length, twist, 0.0, 0.0]], ["2", "3"])
        draw_assembly(axes, assembly, LOOK, reach=REACH)
        (bar,) = assembly.bars
        arc = _twist_arc(assembly, bar, 0.4 * ARC) @ LOOK.plane
        axes.plot(*arc.T, color=ARC_COLOR, linewidth=1.2, zorder=6)
        below = bar.ends.mean(axis=0) @ LOOK.plane - np.array([0.0, 1.0])
        _write_along(axes, bar.ends, f"b/{label}", below)
        axes.set_title(f"twist {label}", fontsize=9)
        axes.set(xlim=(-0.6, 1.0), ylim=(-0.7, 0.8))
        axes.set_aspect("equal", adjustable="datalim")
    return figure


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
    start = unit(next(iter(directions.values())))
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
        ends = np.stack([np.zeros(2), spot])
        draw_arrow(axes, ends, {"color": "#0072B2", "linewidth": 1.8})
        write_at(axes, 1.12 * spot, name, fontsize=9)
    for number, (first, last, label) in enumerate(content["arcs"]):
        span = (angles[last] - angles[first]) % (2 * np.pi)
        turns = angles[first] + np.linspace(0.0, span, 60)
        text = f"{label} = {np.degrees(span):.1f}°"
        _draw_span(axes, turns, 0.25 + 0.2 * number, text)
    axes.plot(0, 0, "o", markerfacecolor="white", markeredgecolor="black")
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.set_axis_off()
    return figure


def _draw_span(axes: Axes, turns: np.ndarray, radius: float, text: str) -> None:
    """An arc about the origin through angles (k,), rad, with an arrow and its name."""
    spots = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    axes.plot(*spots.T, color=ARC_COLOR, linewidth=1.2)
    draw_arrow(axes, spots[[-3, -1]], {"color": ARC_COLOR, "linewidth": 1.0})
    spot = (radius + 0.09) * np.array([np.cos(turns[20]), np.sin(turns[20])])
    box = {"boxstyle": "square,pad=0.1", "facecolor": "white", "linewidth": 0}
    write_at(axes, spot, text, fontsize=8, color=ARC_COLOR, bbox=box)
