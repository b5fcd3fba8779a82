"""The solids of printed parts: links, pins and caps, mm; and their files, STEP of the
assembly and STL of the parts laid out.

Cylinders along the segments of `linkages.printing.assembly`, balls at the corners of
rods, and eyes with bores. Needs build123d, the extra "cad".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from build123d import (
    Color,
    Compound,
    Location,
    Plane,
    Shape,
    SlotCenterToCenter,
    Solid,
    export_step,
    export_stl,
    extrude,
)

from bifurc.figures.style import COLORS
from linkages.printing.assembly import (
    FLAT_FROM,
    Assembly,
    Dimensions,
    link_corners,
)
from linkages.printing.stack import Bar, FlatBody, Stack

BEYOND = 1.1  # how far a bore is cut, in heights of the eye
OVERLAP = 0.25  # how far a pin goes into its head, in radii of the pin
PIN_COLOR = "#444444"
NO_TIME = "2000-01-01T00:00:00"  # the time of day is no part of a linkage
DEFLECTION, ANGLE = 0.02, 0.2  # mm and rad: of facets from round surfaces
SPACE = 4.0  # mm between parts that are laid out
ROW = 220.0  # mm: about how wide the bed of a printer is


@dataclass(frozen=True, eq=False)
class PrintedParts:
    """The solid of each link, in the frame that moves with it, and those of a pin and
    a cap, in the frame of their hinge: its middle, and its axis as z."""

    links: tuple[Solid, ...]
    pin: Solid
    cap: Solid

    @property
    def solids(self) -> tuple[Solid, ...]:
        """All that are to be printed."""
        count = len(self.links)
        return (*self.links, *[self.pin] * count, *[self.cap] * count)


@dataclass(frozen=True, eq=False)
class StackedParts:
    """The solids of a planar mechanism in layers: bodies, and the pins and caps of all
    hinges, each in the frame of the body that it moves with."""

    bodies: tuple[Solid, ...]
    pins: tuple[Solid, ...]
    caps: tuple[Solid, ...]

    @property
    def solids(self) -> tuple[Solid, ...]:
        """All that are to be printed."""
        return (*self.bodies, *self.pins, *self.caps)


def make_parts(assembly: Assembly) -> PrintedParts:
    """The solids of an assembly; raises `ArithmeticError` where the kernel makes a
    link that is not one closed solid."""
    corners = link_corners(assembly.loop, assembly.dimensions, assembly.seats)
    twists = assembly.loop.arrays.twists
    links = []
    for i, link in enumerate(corners):
        axis = np.array([0.0, np.sin(twists[i]), np.cos(twists[i])])
        links.append(_make_link(link, axis, assembly.dimensions))
    dimensions = assembly.dimensions
    bottom, top = dimensions.bottom, dimensions.top
    pin = _make_pin(dimensions, bottom, top)
    return PrintedParts(tuple(links), pin, _make_cap(dimensions, -bottom, top))


def _make_link(corners: np.ndarray, axis: np.ndarray, dimensions: Dimensions) -> Solid:
    """A link between the corners (4, 3); ``axis`` is that of its first eye."""
    z_axis = np.array([0.0, 0.0, 1.0])
    rods = []
    for start, end in pairwise(corners):
        rods.append(_cylinder(start, end, dimensions.rod_radius))
    way = corners[2] - corners[1]
    along_rod = way / np.linalg.norm(way)
    # both poles inside rods: other programs read a sphere that is cut elsewhere wrongly
    balls = [
        Solid.make_sphere(dimensions.elbow_radius, _plane(corner, direction))
        for corner, direction in ((corners[1], along_rod), (corners[2], -along_rod))
    ]
    eyes, bores = [], []
    for corner, along in ((corners[0], axis), (corners[-1], z_axis)):
        half = dimensions.eye_height / 2 * along
        radius = dimensions.hinge_radius
        eyes.append(_cylinder(corner - half, corner + half, radius))
        half = BEYOND * half
        radius = dimensions.bore_radius
        bores.append(_cylinder(corner - half, corner + half, radius))
    return _one_solid(eyes[0].fuse(*rods, *balls, eyes[1]).cut(*bores))


def _make_pin(dimensions: Dimensions, bottom: float, top: float) -> Solid:
    """A pin from its head up into the cap, whose straight part ends at the top."""
    into_head = OVERLAP * dimensions.pin_radius
    end = top - (dimensions.cap_bore_radius - dimensions.pin_radius)
    head = _round_end(bottom, -1.0, dimensions.hinge_radius)
    start = np.array([0.0, 0.0, bottom - into_head])
    shaft = _cylinder(start, np.array([0.0, 0.0, end]), dimensions.pin_radius)
    return _one_solid(head.fuse(shaft))


def _make_cap(dimensions: Dimensions, bottom: float, top: float) -> Solid:
    """A cap with a bore that is closed by its round top."""
    start = np.array([0.0, 0.0, bottom])
    end = np.array([0.0, 0.0, top])
    straight = _cylinder(start, end, dimensions.hinge_radius)
    round_top = _round_end(top, 1.0, dimensions.hinge_radius)
    below = start - (end - start)
    bore = _cylinder(below, end, dimensions.cap_bore_radius)
    return _one_solid(straight.fuse(round_top).cut(bore))


def _cylinder(start: np.ndarray, end: np.ndarray, radius: float) -> Solid:
    way = end - start
    height = float(np.linalg.norm(way))
    return Solid.make_cylinder(radius, height, _plane(start, way / height))


def _round_end(height: float, side: float, radius: float) -> Solid:
    """The half of a ball about a point of the z axis, above it for ``side`` 1, flat at
    its end so that it can stand."""
    plane = _plane(np.array([0.0, 0.0, height]), np.array([0.0, 0.0, side]))
    return Solid.make_sphere(radius, plane, angle1=0, angle2=FLAT_FROM)


def _plane(origin: np.ndarray, normal: np.ndarray) -> Plane:
    return Plane(origin=tuple(origin.tolist()), z_dir=tuple(normal.tolist()))


def _one_solid(shape: Shape[Any]) -> Solid:
    """The only solid of a shape; raises `ArithmeticError`."""
    solids = shape.solids()
    if len(solids) != 1 or not solids[0].is_valid or solids[0].volume <= 0:
        raise ArithmeticError(f"a part came out as {len(solids)} solids, or not closed")
    return solids[0]


# --- in layers ------------------------------------------------------------------------


def make_stack(stack: Stack) -> StackedParts:
    """The solids of a planar mechanism in layers; raises `ArithmeticError` where the
    kernel makes a body that is not one closed solid."""
    dimensions = stack.dimensions
    bodies = [_make_body(body, dimensions) for body in stack.bodies]
    pins, caps = [], []
    for hinge in stack.hinges:
        pose = np.eye(4)
        pose[:3, 3] = hinge.place
        pin = _make_pin(dimensions, hinge.bottom, hinge.top)
        cap = _make_cap(dimensions, hinge.cap, hinge.top)
        pins.append(place_solid(pin, pose))
        caps.append(place_solid(cap, pose))
    return StackedParts(tuple(bodies), tuple(pins), tuple(caps))


def _make_body(body: FlatBody, dimensions: Dimensions) -> Solid:
    """A body in its layer: rods with balls at their ends, eyes and slotted bars."""
    solids = [part for rod in body.rods for part in _round_rod(rod, dimensions)]
    holes = []
    for place, (low, high) in body.eyes:
        bottom, top = (place + np.array([0.0, 0.0, z]) for z in (low, high))
        solids.append(_cylinder(bottom, top, dimensions.hinge_radius))
        beyond = np.array([0.0, 0.0, dimensions.play])
        bore = _cylinder(bottom - beyond, top + beyond, dimensions.bore_radius)
        holes.append(bore)
    for slot in body.slots:
        height = dimensions.eye_height
        solids.append(_long_hole(slot, dimensions.hinge_radius, height))
        holes.append(_long_hole(slot, dimensions.bore_radius, BEYOND * height))
    whole = solids[0].fuse(*solids[1:]) if len(solids) > 1 else solids[0]
    return _one_solid(whole.cut(*holes))


def _round_rod(rod: Bar, dimensions: Dimensions) -> list[Solid]:
    """A rod, and the balls at its ends."""
    start, end = rod
    along = (end - start) / np.linalg.norm(end - start)
    return [
        _cylinder(start, end, dimensions.rod_radius),
        Solid.make_sphere(dimensions.elbow_radius, _plane(start, along)),
        Solid.make_sphere(dimensions.elbow_radius, _plane(end, -along)),
    ]


def _long_hole(bar: Bar, radius: float, height: float) -> Solid:
    """What a vertical cylinder of this height covers that goes along a bar."""
    way = bar.end - bar.start
    middle = (bar.start + bar.end) / 2 - [0.0, 0.0, height / 2]
    plane = Plane(origin=tuple(middle.tolist()), x_dir=tuple(way.tolist()))
    length = float(np.linalg.norm(way))
    outline = plane * SlotCenterToCenter(length, 2 * radius)
    return _one_solid(extrude(outline, amount=height, dir=(0, 0, 1)))


def place_stack(
    stack: Stack, parts: StackedParts, point: np.ndarray
) -> list[tuple[str, Solid]]:
    """All solids where they are at a configuration (n,), with their names: bodies, then
    every pin and its cap."""
    poses = stack.poses(point[None])[0]
    placed = []
    for body, solid, pose in zip(stack.bodies, parts.bodies, poses, strict=True):
        placed.append((body.name, place_solid(solid, pose)))
    for hinge, pin, cap in zip(stack.hinges, parts.pins, parts.caps, strict=True):
        pose = poses[hinge.holder]
        placed.append((hinge.name, place_solid(pin, pose)))
        placed.append((hinge.name.replace("pin", "cap", 1), place_solid(cap, pose)))
    return placed


# --- placed ---------------------------------------------------------------------------


def link_poses_at(assembly: Assembly, theta: np.ndarray) -> tuple[np.ndarray, ...]:
    """Poses (n, 4, 4) of links, and of hinges, at joint angles (n,), rad."""
    links = assembly.loop.frames(theta)[1:]
    hinges = np.roll(links, 1, axis=0).copy()
    heights, sides = assembly.seats.heights, assembly.seats.sides
    hinges[:, :3, 3] += heights[:, None] * hinges[:, :3, 2]
    # half a turn about x where the hinge stands on its head
    hinges[:, :3, 1:3] *= sides[:, None, None]
    return links, hinges


def place_solid(solid: Solid, pose: np.ndarray) -> Solid:
    """A copy of a solid at a pose (4, 4)."""
    plane = Plane(
        origin=tuple(pose[:3, 3].tolist()),
        x_dir=tuple(pose[:3, 0].tolist()),
        z_dir=tuple(pose[:3, 2].tolist()),
    )
    return solid.moved(plane.location)


# --- files ----------------------------------------------------------------------------


def write_step(
    assembly: Assembly,
    parts: PrintedParts,
    theta: np.ndarray,
    names: Sequence[str],
    title: str,
    path: Path,
) -> None:
    """Write all parts as they stand at joint angles (n,), rad, as named solids of an
    assembly, mm: each link by its name, then its first pin and cap, which are one part
    of the file in many places. Raises `OSError`."""
    links, hinges = link_poses_at(assembly, theta)
    children = []
    for i, name in enumerate(names):
        link = place_solid(parts.links[i], links[i])
        children.append(_labelled(link, name, COLORS[i % len(COLORS)]))
        pin, cap = place_solid(parts.pin, hinges[i]), place_solid(parts.cap, hinges[i])
        children.append(_labelled(pin, "pin", PIN_COLOR))
        children.append(_labelled(cap, "cap", PIN_COLOR))
    _write_assembly(children, title, path)


def write_stack_step(
    stack: Stack, parts: StackedParts, point: np.ndarray, title: str, path: Path
) -> None:
    """The same of a planar mechanism in layers at a configuration (n,): bodies by their
    names, pins and caps by those of joints."""
    children = []
    for number, (name, solid) in enumerate(place_stack(stack, parts, point)):
        is_body = number < len(parts.bodies)
        color = COLORS[number % len(COLORS)] if is_body else PIN_COLOR
        children.append(_labelled(solid, name, color))
    _write_assembly(children, title, path)


def _write_assembly(children: Sequence[Solid], title: str, path: Path) -> None:
    whole = Compound(label=title, children=children)
    try:
        export_step(whole, path, timestamp=NO_TIME)
    except RuntimeError as error:
        raise OSError(str(error)) from None


def write_stl(parts: PrintedParts | StackedParts, path: Path) -> None:
    """Write all parts side by side on the plane z = 0, mm: the links in their order,
    then the pins, then the caps. Raises `OSError`."""
    whole = Compound(children=lay_out(parts.solids))
    if not export_stl(whole, path, DEFLECTION, ANGLE):
        raise OSError("the kernel of solids cannot write it")


def lay_out(solids: Sequence[Solid]) -> list[Solid]:
    """Copies of solids in rows on the plane z = 0; the last axis of a link, pins and
    caps stand upright, caps on their flat faces."""
    rows = []
    x = y = depth = 0.0
    for solid in solids:
        box = solid.bounding_box()
        if x > 0 and x + box.size.X > ROW:
            x, y, depth = 0.0, y + depth + SPACE, 0.0
        move = Location((x - box.min.X, y - box.min.Y, -box.min.Z))
        rows.append(solid.moved(move))
        x += box.size.X + SPACE
        depth = max(depth, box.size.Y)
    return rows


def _labelled(solid: Solid, label: str, color: str) -> Solid:
    solid.label = label
    solid.color = Color(color)
    return solid
