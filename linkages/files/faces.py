"""The faces of a flat crease pattern, from its edges."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from linkages.values import GeometryError, require


def faces_of_edges(
    points: np.ndarray, ends: Sequence[Sequence[int]]
) -> list[list[int]]:
    """The faces that edges between vertices at ``points`` (v, 3) in the plane z = 0
    enclose, each by its vertices counterclockwise.

    At the end of an edge a face goes on along the next one clockwise. Raises
    `GeometryError` where points have heights, where there is no face, and for an edge
    that ends inside one.
    """
    is_flat = not np.any(points[:, 2])
    allowed = "given where vertices have heights"
    require(is_flat, "faces_vertices", "a missing key", allowed)
    around = _neighbours(points, ends)
    faces = []
    waiting = {(start, end) for pair in ends for start, end in (pair, pair[::-1])}
    while waiting:
        side = min(waiting)
        face = []
        while side in waiting:
            waiting.remove(side)
            face.append(side[0])
            side = _next_side(around, side)
        if _double_area(points[face]) > 0.0:
            faces.append(face)
    require(len(faces) > 0, "edges_vertices", "without a face", "those of a face")
    for face in faces:
        for vertex in face:
            if face.count(vertex) > 1:
                allowed = "such that edges end at others on all sides of a face"
                raise GeometryError("edges at vertex", vertex, allowed)
    return faces


def _neighbours(
    points: np.ndarray, ends: Sequence[Sequence[int]]
) -> dict[int, list[int]]:
    """The vertices to which edges lead from each one, counterclockwise."""
    around: dict[int, list[int]] = {}
    for start, end in ends:
        around.setdefault(start, []).append(end)
        around.setdefault(end, []).append(start)
    for vertex, others in around.items():
        x, y = points[vertex, :2]
        others.sort(key=lambda k: math.atan2(points[k, 1] - y, points[k, 0] - x))
    return around


def _next_side(around: dict[int, list[int]], side: tuple[int, int]) -> tuple[int, int]:
    """The side after one of a face that lies on its left."""
    start, end = side
    others = around[end]
    return end, others[others.index(start) - 1]


def _double_area(corners: np.ndarray) -> float:
    x, y = corners[:, 0], corners[:, 1]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
