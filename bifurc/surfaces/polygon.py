"""Convex polygons about the origins of the tangent planes of charts, each of whose edges
knows what made it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

BORDER = -2  # of one along the first bound; the others follow below it


class Polygon(NamedTuple):
    """Vertices (v, 2), counterclockwise, and the labels (v,) of the edges: edge i runs
    from vertex i to the next one."""

    vertices: np.ndarray
    labels: np.ndarray


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
