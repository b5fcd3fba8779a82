"""The loop whose joint axes are given in one configuration.

Neighbouring axes are joined by their common normal. Its foot on either axis, its length
and its direction give the table: lengths and twists belong to a normal, offsets lie on
an axis between the feet of its two normals, and a joint angle is the angle between
them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from linkages.coordinates import are_near_origin, is_fine, rounding_of_doubles
from linkages.loop import MAX_JOINTS, MIN_JOINTS, Loop
from linkages.values import GeometryError, check_direction, checked_vector, quoted

# n points or directions, (n, 3), as lists or as an array
Vectors: TypeAlias = Iterable[Iterable[float]]

PARALLEL = 1e-9  # sine of the angle below which neighbouring axes are parallel
# distance of parallel axes, over the extent of the linkage, below which they are one
# line
SAME_LINE = 1e-12
# lengths and offsets, over the largest coordinate, that are the rounding of zero: a
# loop of axes that all meet would be measured by them
ROUNDING = 1e-13


@dataclass(frozen=True)
class Axes:
    """Joint axes in loop order, each through one of the ``points`` (n, 3) along one of
    the unit vectors ``directions`` (n, 3)."""

    points: np.ndarray
    directions: np.ndarray

    @property
    def n(self) -> int:
        """Number of axes."""
        return len(self.points)

    @property
    def extent(self) -> float:
        """The largest difference of coordinates of the points."""
        return max(float(np.ptp(self.points, axis=0).max()), 1e-300)

    @property
    def largest(self) -> float:
        """The largest coordinate of the points, without its sign."""
        return float(np.abs(self.points).max())

    def counted_from_first(self) -> Axes:
        """The axes with points that are counted from the first one, where they are far
        from the origin; differences of such coordinates are exact."""
        if are_near_origin(self.points):
            return self
        return Axes(self.points - self.points[0], self.directions)

    def rounding(self, missed: float) -> float:
        """How far off distances of these axes are, of which the largest one that was
        taken as zero is ``missed``; 0 where doubles of their size are no better."""
        if are_near_origin(self.points) and is_fine(missed, self.points):
            return 0.0
        return max(rounding_of_doubles(self.points), missed)


@dataclass(frozen=True)
class CommonNormal:
    """The common normal of an axis and the next one.

    ``foot`` (3,) is its point on the axis, ``next_foot`` (3,) that on the next one,
    ``direction`` (3,) its unit vector from the first to the second, ``length`` their
    distance.
    """

    foot: np.ndarray
    next_foot: np.ndarray
    direction: np.ndarray
    length: float


def loop_from_axes(
    points: Vectors, directions: Vectors, name: str = ""
) -> tuple[Loop, np.ndarray]:
    """The loop whose joint axes, in one configuration, pass through ``points`` along
    ``directions``, and the joint angles (n,), rad, of that configuration.

    Both are (n, 3), in loop order, any unit and frame; directions need not be unit
    vectors. Where neighbouring axes are parallel, the common normal is drawn through
    the foot of the previous one. Raises `GeometryError` for wrong numbers of vectors,
    coordinates that are not finite numbers, a direction of length zero, and
    neighbouring axes that coincide.

    The loop's ``rounding`` says how far off lengths and offsets are, where that is more
    than doubles of the size of the linkage are: as points are far from the origin, or as
    some were taken as zero.

    >>> import linkages, numpy as np
    >>> directions = np.array([[1, 0, 1], [0, 1, 1], [-1, 0, 1.2], [0, -1, 1.5]])
    >>> loop, angles = linkages.loop_from_axes(points=directions, directions=directions)
    >>> np.degrees(loop.arrays.twists).round(4).tolist()
    [60.0, -57.0973, 50.2679, 53.9601]
    """
    given = _axes(points, directions)
    axes = given.counted_from_first()
    normals = _common_normals(axes)
    across = np.array([normal.direction for normal in normals])
    lengths = np.array([normal.length for normal in normals])
    twists = _twists(axes, across)
    offsets = _offsets(axes, normals)
    distances = np.array([lengths, offsets])
    is_zero = np.abs(distances) < ROUNDING * given.largest
    rounding = given.rounding(float(np.abs(distances[is_zero]).max(initial=0.0)))
    distances[is_zero] = 0.0
    lengths, offsets = distances
    loop = Loop(tuple(lengths), tuple(twists), tuple(offsets), name, rounding)
    return loop, _joint_angles(axes, across)


# --- what is given --------------------------------------------------------------------


def _axes(points: Vectors, directions: Vectors) -> Axes:
    places = _vectors("points", points)
    along = _vectors("directions", directions)
    n = len(places)
    if len(along) != n:
        allowed = f"{n}, the number of points"
        raise GeometryError("number of directions", len(along), allowed)
    if not MIN_JOINTS <= n <= MAX_JOINTS:
        allowed = f"one for each joint, {MIN_JOINTS} to {MAX_JOINTS} joints"
        raise GeometryError("number of points", n, allowed)
    for i, direction in enumerate(along, start=1):
        check_direction(f"directions[{i}]", direction)
    sizes = np.linalg.norm(along, axis=1)
    return Axes(places, along / sizes[:, None])


def _vectors(name: str, rows: Vectors) -> np.ndarray:
    """The vectors as an array (n, 3)."""
    if not isinstance(rows, Iterable):
        raise GeometryError(name, quoted(rows), "a list of vectors [x, y, z]")
    vectors = [
        checked_vector(f"{name}[{i}]", row) for i, row in enumerate(rows, start=1)
    ]
    return np.array(vectors, dtype=float).reshape(-1, 3)


# --- common normals -------------------------------------------------------------------


def _common_normals(axes: Axes) -> list[CommonNormal]:
    """The common normals of every axis and the next one.

    They are drawn one after the other, for the foot of one decides where that of the
    next parallel axes is; the first is one of axes that are not parallel, if any.
    """
    n = axes.n
    crossings = [_crossing(axes, i) for i in range(n)]
    is_parallel = [float(np.linalg.norm(c)) <= PARALLEL for c in crossings]
    not_parallel = [i for i in range(n) if not is_parallel[i]]
    start = not_parallel[-1] if not_parallel else n - 1
    normals: dict[int, CommonNormal] = {}
    for step in range(start, start + n):
        i = step % n
        if is_parallel[i]:
            previous = normals.get((i - 1) % n)
            foot = axes.points[i] if previous is None else previous.next_foot
            normals[i] = _normal_of_parallel_axes(axes, i, foot)
        else:
            normals[i] = _normal_of_skew_axes(axes, i, crossings[i])
    return [normals[i] for i in range(n)]


def _crossing(axes: Axes, i: int) -> np.ndarray:
    """The cross product of the directions of axis ``i`` and the next one."""
    return np.cross(axes.directions[i], axes.directions[(i + 1) % axes.n])


def _normal_of_skew_axes(axes: Axes, i: int, crossing: np.ndarray) -> CommonNormal:
    """The normal of axis ``i`` and the next one along their ``crossing`` (3,). Where
    they intersect it has the length zero, and rounding decides its sense."""
    j = (i + 1) % axes.n
    here, there = axes.points[i], axes.points[j]
    along, along_next = axes.directions[i], axes.directions[j]
    # here + u along and there + v along_next are the nearest points of the two lines
    both = np.column_stack([along, -along_next])
    u, v = np.linalg.lstsq(both, there - here, rcond=None)[0]
    foot = here + u * along
    next_foot = there + v * along_next
    across = next_foot - foot
    direction = crossing / np.linalg.norm(crossing)
    if across @ direction < 0:
        direction = -direction
    return CommonNormal(foot, next_foot, direction, float(across @ direction))


def _normal_of_parallel_axes(axes: Axes, i: int, foot: np.ndarray) -> CommonNormal:
    """The normal of axis ``i`` and the next one, parallel to it, from the ``foot`` (3,)
    on axis ``i``."""
    j = (i + 1) % axes.n
    along = axes.directions[i]
    across = axes.points[j] - axes.points[i] + axes.points[i] - foot
    across -= (across @ along) * along
    length = float(np.linalg.norm(across))
    if length < SAME_LINE * axes.extent:
        name = f"axes {i + 1} and {j + 1}"
        raise GeometryError(name, "the same line", "different lines")
    return CommonNormal(foot, foot + across, across / length, length)


# --- what the normals give ------------------------------------------------------------


def _twists(axes: Axes, across: np.ndarray) -> np.ndarray:
    """The angles (n,) from every axis to the next one about the unit normals ``across``
    (n, 3)."""
    twists = np.empty(axes.n)
    for i in range(axes.n):
        sine = _crossing(axes, i) @ across[i]
        cosine = axes.directions[i] @ axes.directions[(i + 1) % axes.n]
        twists[i] = np.arctan2(sine, cosine)
    return twists


def _offsets(axes: Axes, normals: list[CommonNormal]) -> np.ndarray:
    """How far (n,) along every axis from the foot of the previous normal to that of the
    next one."""
    leaving = np.array([normal.foot for normal in normals])
    arriving = np.roll([normal.next_foot for normal in normals], 1, axis=0)
    offsets: np.ndarray = np.einsum("ij,ij->i", leaving - arriving, axes.directions)
    return offsets


def _joint_angles(axes: Axes, across: np.ndarray) -> np.ndarray:
    """The angles (n,) about every axis from the previous unit normal to the next one,
    of ``across`` (n, 3)."""
    before = np.roll(across, 1, axis=0)
    sines = np.einsum("ij,ij->i", np.cross(before, across), axes.directions)
    cosines = np.einsum("ij,ij->i", before, across)
    angles: np.ndarray = np.arctan2(sines, cosines)
    return angles
