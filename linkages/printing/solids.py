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
    Solid,
    export_step,
    export_stl,
)

from bifurc.figures.style import COLORS
from linkages.printing.assembly import Assembly, Dimensions, link_corners

BEYOND = 1.1  # how far a bore is cut, in heights of the eye
FLAT_FROM = 45  # deg of latitude; a wall is left beyond the bore of a cap
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
    return PrintedParts(tuple(links), _make_pin(dimensions), _make_cap(dimensions))


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


def _make_pin(dimensions: Dimensions) -> Solid:
    """A pin from its head up into the cap."""
    bottom, top = dimensions.bottom, dimensions.top
    into_head = OVERLAP * dimensions.pin_radius
    end = top - (dimensions.cap_bore_radius - dimensions.pin_radius)
    head = _round_end(bottom, -1.0, dimensions.hinge_radius)
    start = np.array([0.0, 0.0, bottom - into_head])
    shaft = _cylinder(start, np.array([0.0, 0.0, end]), dimensions.pin_radius)
    return _one_solid(head.fuse(shaft))


def _make_cap(dimensions: Dimensions) -> Solid:
    """A cap with a bore that is closed by its round top."""
    start = np.array([0.0, 0.0, -dimensions.bottom])
    end = np.array([0.0, 0.0, dimensions.top])
    straight = _cylinder(start, end, dimensions.hinge_radius)
    round_top = _round_end(dimensions.top, 1.0, dimensions.hinge_radius)
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
    whole = Compound(label=title, children=children)
    try:
        export_step(whole, path, timestamp=NO_TIME)
    except RuntimeError as error:
        raise OSError(str(error)) from None


def write_stl(parts: PrintedParts, path: Path) -> None:
    """Write all parts side by side on the plane z = 0, mm: the links in their order,
    then the pins, then the caps. Raises `OSError`."""
    whole = Compound(children=lay_out(parts))
    if not export_stl(whole, path, DEFLECTION, ANGLE):
        raise OSError("the kernel of solids cannot write it")


def lay_out(parts: PrintedParts) -> list[Solid]:
    """Copies of all parts that are to be printed, in rows on the plane z = 0; the last
    axis of a link, pins and caps stand upright, caps on their flat faces."""
    count = len(parts.links)
    rows = []
    x = y = depth = 0.0
    for solid in (*parts.links, *[parts.pin] * count, *[parts.cap] * count):
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
