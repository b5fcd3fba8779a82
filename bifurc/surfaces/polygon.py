"""Convex polygons about the origins of the tangent planes of charts, each of whose edges
knows what made it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc.numerics.binary_forms import unit_vectors

OUTLINE = -1  # label of an edge that nothing has cut yet
BORDER = -2  # of one along the first bound; the others follow below it


class Polygon(NamedTuple):
    """Vertices (v, 2), counterclockwise, and the labels (v,) of the edges: edge i runs
    from vertex i to the next one."""

    vertices: np.ndarray
    labels: np.ndarray

    @property
    def is_empty(self) -> bool:
        """Whether nothing is left of it."""
        return len(self.vertices) == 0

    def clip(self, normal: np.ndarray, offset: float, label: int) -> Polygon:
        """The part where ``normal . y <= offset``; the edge along the cut gets
        ``label``.

        The same polygon where the line misses it, an empty one where nothing is left.
        """
        if self.is_empty:
            return self
        height: list[float] = (self.vertices @ normal - offset).tolist()
        if max(height) <= 0.0:
            return self
        if min(height) > 0.0:
            return Polygon(self.vertices[:0], self.labels[:0])
        count = len(height)
        next_height = height[1:] + height[:1]
        edges = range(count)
        leaves = next(i for i in edges if height[i] <= 0.0 < next_height[i])
        enters = next(i for i in edges if next_height[i] <= 0.0 < height[i])
        count_inside = (leaves - enters) % count
        inside = [(enters + 1 + i) % count for i in range(count_inside)]
        begin = self._crossing(leaves, height[leaves], next_height[leaves])
        end = self._crossing(enters, height[enters], next_height[enters])
        new_labels = [label, self.labels[enters]]
        return Polygon(
            np.concatenate([self.vertices[inside], [begin, end]]),
            np.concatenate([self.labels[inside], new_labels]),
        )

    def _crossing(self, edge: int, begin: float, end: float) -> np.ndarray:
        """The point (2,) of an edge on the line, from the heights of its two ends."""
        first = self.vertices[edge]
        last = self.vertices[(edge + 1) % len(self.vertices)]
        point: np.ndarray = first + begin / (begin - end) * (last - first)
        return point


def octagon(radius: float) -> Polygon:
    """The octagon around the circle of ``radius``."""
    angles = np.pi / 4 * (np.arange(8) + 0.5)
    size = radius / np.cos(np.pi / 8)
    return Polygon(size * unit_vectors(angles), np.full(8, OUTLINE))


class FlatCharts(NamedTuple):
    """Charts as they are made: ``centers`` (c, n), ``bases`` (c, n, 2) of the tangent
    planes, ``radii`` (c,) of the disks, whether other sheets ``are_clear`` (c,) of
    them, and c polygons in these planes, whose labels are the numbers of the charts on
    the other side of each edge, or say which bound it runs along."""

    centers: np.ndarray
    bases: np.ndarray
    radii: np.ndarray
    are_clear: np.ndarray
    polygons: list[Polygon]
