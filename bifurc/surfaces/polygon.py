"""Convex polygons about the origin of a tangent plane, each of whose edges knows what
made it."""

from __future__ import annotations

import numpy as np

__all__ = ["OUTLINE", "clip", "octagon"]

OUTLINE = -1  # label of an edge that nothing has cut yet


def octagon(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (8, 2) of the octagon around the circle of ``radius``, and the labels
    (8,) of its edges.

    Edge i runs from vertex i to the next one, counterclockwise.
    """
    angles = np.pi / 4 * (np.arange(8) + 0.5)
    size = radius / np.cos(np.pi / 8)
    return size * np.stack([np.cos(angles), np.sin(angles)], axis=1), np.full(
        8, OUTLINE
    )


def clip(
    vertices: np.ndarray,
    labels: np.ndarray,
    normal: np.ndarray,
    offset: float,
    label: int,
) -> tuple[np.ndarray, np.ndarray]:
    """The part of a polygon where ``normal . y <= offset``; the edge along the cut gets
    ``label``.

    The same polygon where the line misses it, nothing where nothing is left.
    """
    height = (vertices @ normal - offset).tolist()
    if max(height) <= 0.0:
        return vertices, labels
    if min(height) > 0.0:
        return vertices[:0], labels[:0]
    count = len(height)
    after = height[1:] + height[:1]
    leaves = next(
        i for i in range(count) if height[i] <= 0.0 < after[i]
    )  # the edge on which the polygon goes out
    enters = next(i for i in range(count) if height[i] > 0.0 >= after[i])

    def crossing(i: int) -> np.ndarray:
        return vertices[i] + height[i] / (height[i] - after[i]) * (
            vertices[(i + 1) % count] - vertices[i]
        )

    kept = [(enters + 1 + i) % count for i in range((leaves - enters) % count)]
    new = np.concatenate([vertices[kept], [crossing(leaves), crossing(enters)]])
    return new, np.concatenate([labels[kept], [label, labels[enters]]])
