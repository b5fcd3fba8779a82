"""Convex polygons about the origin of a tangent plane, each of whose edges knows what made it."""

from __future__ import annotations

import numpy as np

__all__ = ["OUTLINE", "clip", "octagon"]

OUTLINE = -1  # label of an edge that nothing has cut yet


def octagon(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (8, 2) of the octagon around the circle of ``radius``, and the labels (8,) of its edges.

    Edge i runs from vertex i to the next one, counterclockwise.
    """
    angles = np.pi / 4 * (np.arange(8) + 0.5)
    size = radius / np.cos(np.pi / 8)
    return size * np.stack([np.cos(angles), np.sin(angles)], axis=1), np.full(8, OUTLINE)


def clip(
    vertices: np.ndarray, labels: np.ndarray, normal: np.ndarray, offset: float, label: int
) -> tuple[np.ndarray, np.ndarray]:
    """The part of a polygon where ``normal . y <= offset``; the edge along the cut gets ``label``.

    The same polygon where the line misses it, nothing where nothing is left.
    """
    height = vertices @ normal - offset
    inside = height <= 0.0
    if np.all(inside):
        return vertices, labels
    if not np.any(inside):
        return vertices[:0], labels[:0]
    count = len(vertices)
    leaves = int(np.flatnonzero(inside & ~np.roll(inside, -1))[0])  # the edge on which the polygon goes out
    enters = int(np.flatnonzero(~inside & np.roll(inside, -1))[0])

    def crossing(i: int) -> np.ndarray:
        j = (i + 1) % count
        return vertices[i] + height[i] / (height[i] - height[j]) * (vertices[j] - vertices[i])

    kept = (enters + 1 + np.arange((leaves - enters) % count)) % count
    new = np.concatenate([vertices[kept], crossing(leaves)[None], crossing(enters)[None]])
    return new, np.concatenate([labels[kept], [label, labels[enters]]])
