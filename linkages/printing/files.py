"""Files of printed parts: STEP of the assembly, STL of the parts laid out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from build123d import Color, Compound, Location, Solid, export_step

from bifurc.figures.style import COLORS
from linkages.printing.assembly import Assembly
from linkages.printing.solids import (
    PrintedParts,
    link_poses_at,
    place_solid,
)

PIN_COLOR = "#444444"
NO_TIME = "2000-01-01T00:00:00"  # the time of day is no part of a linkage
DEFLECTION, ANGLE = 0.02, 0.2  # mm and rad: of facets from round surfaces
SPACE = 4.0  # mm between parts that are laid out
FACET = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")]
HEADER = b"bifurc: links, pins and caps, mm"
TINY = 1e-300
ROW = 220.0  # mm: about how wide the bed of a printer is


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
    corners = []
    for solid in lay_out(parts):
        vertices, triangles = solid.tessellate(DEFLECTION, ANGLE)
        points = np.array([tuple(vertex) for vertex in vertices], dtype="<f4")
        corners.append(points[np.array(triangles)])
    path.write_bytes(_binary_stl(np.concatenate(corners)))


def _binary_stl(corners: np.ndarray) -> bytes:
    """Binary STL (3D Systems 1989) of triangles (k, 3, 3), floats of 32 bits."""
    # the poles of balls have triangles with two corners in one point
    following = np.roll(corners, 1, axis=1)
    is_flat = np.all(corners == following, axis=2).any(axis=1)
    corners = corners[~is_flat]
    sides = np.diff(corners.astype(float), axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), TINY)
    facets = np.zeros(len(corners), FACET)
    facets["normal"] = normals
    facets["corners"] = corners
    count = len(facets).to_bytes(4, "little")
    return HEADER.ljust(80) + count + facets.tobytes()


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
