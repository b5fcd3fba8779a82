"""The faces of a flat crease pattern, from its edges."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from linkages.values import GeometryError, require


def faces_of_edges(
    points: np.ndarray, ends: Sequence[Sequence[int]]
) -> list[list[int]]:
    """The faces that edges between vertices at ``points`` (v, 3) in the plane z = 0
    enclose, each by its vertices counterclockwise.

    At the end of an edge a face goes on along the next one clockwise. Edges inside of a
    face that are joined to none of its sides make faces of their own. Raises
    `GeometryError` where points have heights, where there is no face, and for an edge
    that ends inside one.
    """
    is_flat = not np.any(points[:, 2])
    allowed = "given where vertices have heights"
    require(is_flat, "faces_vertices", "a missing key", allowed)
    around = _neighbours(points, ends)
    faces = []
    sides = sorted({(start, end) for pair in ends for start, end in (pair, pair[::-1])})
    waiting = set(sides)
    for first in sides:
        side = first
        face = []
        while side in waiting:
            waiting.remove(side)
            face.append(side[0])
            side = _next_side(around, side)
        if face and _double_area(points[face]) > 0.0:
            faces.append(face)
    require(len(faces) > 0, "edges_vertices", "without a face", "those of a face")
    for face in faces:
        for vertex in face:
            if face.count(vertex) > 1:
                allowed = "such that edges end at others on all sides of a face"
                raise GeometryError("edges at vertex", vertex, allowed)
    return faces


def check_joined(
    points: np.ndarray,
    edges: Collection[tuple[int, int]],
    creases: Collection[tuple[int, int]],
    faces: Sequence[list[int]],
) -> None:
    """Raises `GeometryError` for one of the ``edges`` that are ``creases`` where it
    begins inside of a face: what is on its other side is not known."""
    corners = {vertex for edge in edges for vertex in edge}
    if len(corners) - len(edges) + len(faces) == 1 or not creases:
        return  # by Euler's formula all edges hang together
    starts = np.unique([start for start, _ in creases])
    for number, face in enumerate(faces):
        is_inside = _are_inside(points[starts], points[face]) & ~np.isin(starts, face)
        if np.any(is_inside):
            value = f"inside of face f{number}"
            allowed = "joined to its sides, or without creases"
            raise GeometryError(
                f"vertex {starts[np.argmax(is_inside)]}", value, allowed
            )


def _are_inside(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Whether points (k, 3) are inside of a polygon (c, 3): a ray from there along x
    crosses an odd number of its sides."""
    x, y = points[:, 0, None], points[:, 1, None]
    following = np.roll(corners, -1, axis=0)
    rise = following[:, 1] - corners[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (y - corners[:, 1]) / rise
        is_right = corners[:, 0] + part * (following[:, 0] - corners[:, 0]) > x
    is_crossed = ((corners[:, 1] > y) != (following[:, 1] > y)) & is_right
    is_inside: np.ndarray = np.count_nonzero(is_crossed, axis=1) % 2 == 1
    return is_inside


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
