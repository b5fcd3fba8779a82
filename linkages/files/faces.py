"""The faces of a flat crease pattern, from its edges."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from linkages.values import GeometryError, require

SLENDER = (
    1e-9  # area of a triangle, over that of the square on its longest side, of none
)


def faces_of_edges(
    points: np.ndarray, ends: Sequence[Sequence[int]]
) -> list[list[int]]:
    """The faces that edges between vertices at ``points`` (v, 3) in the plane z = 0
    enclose, each by its vertices counterclockwise.

    At the end of an edge a face goes on along the next one clockwise. Edges inside of a
    face that are joined to none of its sides make faces of their own; an edge with one
    face on both sides, as one that ends inside of it, is a side of none. Raises
    `GeometryError` where points have heights, where there is no face, and where one
    comes to a vertex twice.
    """
    is_flat = not np.any(points[:, 2])
    allowed = "given where vertices have heights"
    require(is_flat, "faces_vertices", "a missing key", allowed)
    between = {
        (min(start, end), max(start, end))
        for cycle in _cycles(points, ends)
        for start, end in cycle
        if (end, start) not in cycle
    }
    faces = []
    for cycle in _cycles(points, sorted(between)):
        face = [start for start, _ in cycle]
        if _double_area(points[face]) > 0.0:
            faces.append(face)
    require(len(faces) > 0, "edges_vertices", "without a face", "those of a face")
    for face in faces:
        for vertex in face:
            if face.count(vertex) > 1:
                allowed = "such that edges end at others on all sides of a face"
                raise GeometryError("edges at vertex", vertex, allowed)
    return faces


def _cycles(
    points: np.ndarray, ends: Sequence[Sequence[int]]
) -> Iterator[dict[tuple[int, int], None]]:
    """The sides along which faces go round, in order; a face inside of which nothing else
    is has one such cycle, and so has what is around everything."""
    around = _neighbours(points, ends)
    sides = sorted({(start, end) for pair in ends for start, end in (pair, pair[::-1])})
    waiting = set(sides)
    for first in sides:
        side = first
        cycle: dict[tuple[int, int], None] = {}
        while side in waiting:
            waiting.remove(side)
            cycle[side] = None
            side = _next_side(around, side)
        if cycle:
            yield cycle


def triangles_of(points: np.ndarray, face: Sequence[int]) -> list[list[int]]:
    """The triangles into which the shortest diagonals cut a face, each by its vertices,
    of ``points`` (v, 3): corner after corner is cut off that holds no other one."""
    corners = points[list(face)] - points[face[0]]
    spokes = np.cross(corners[1:-1], corners[2:]).sum(axis=0)
    size = float(np.linalg.norm(spokes))
    require(
        size > 0.0, "face", list(face), "one with an area, to be cut into triangles"
    )
    first = corners[np.argmax(np.linalg.norm(corners, axis=1))]
    right = first / np.linalg.norm(first)
    plane = np.array([right, np.cross(spokes / size, right)])
    places = dict(zip(face, corners @ plane.T, strict=True))
    left, triangles = list(face), []
    while len(left) > 3:
        ears = [
            ear for ear in map(partial(_ear, left, places), range(len(left))) if ear
        ]
        require(bool(ears), "face", list(face), "one whose sides do not cross")
        _, at, triangle = min(ears)
        triangles.append(triangle)
        del left[at]
    return [*triangles, left]


def _ear(
    face: list[int], places: Mapping[int, np.ndarray], at: int
) -> tuple[float, int, list[int]] | None:
    """How long the diagonal is that cuts off a corner, by number, and the triangle; None
    where the corner is none that points outward, or another vertex lies there."""
    triangle = [face[at - 1], face[at], face[(at + 1) % len(face)]]
    a, b, c = (places[vertex] for vertex in triangle)
    area = _double_area(np.array([a, b, c]))
    if not area > SLENDER * float((c - a) @ (c - a)):
        return None
    for vertex in face:
        if vertex not in triangle:
            sides = ((a, b), (b, c), (c, a))
            areas = [_double_area(np.array([*side, places[vertex]])) for side in sides]
            if min(areas) > -SLENDER * area:
                return None
    return float(np.linalg.norm(c - a)), at, triangle


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
