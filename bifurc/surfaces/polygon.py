"""Convex polygons about the origins of the tangent planes of charts, each of whose edges
knows what made it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bifurc import _core

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

        All of it where the line misses it, an empty one where nothing is left.
        """
        return Polygon(*_core.clip(*self, np.asarray(normal), offset, label))


def octagon(radius: float) -> Polygon:
    """The octagon around the circle of ``radius``."""
    return Polygon(*_core.octagon(radius))


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
