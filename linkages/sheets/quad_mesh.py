"""Meshes of quadrilaterals that fold flat with one freedom, from arrays of angles.

At every inner vertex opposite sectors add up to pi, so that it folds flat. The half
tangents of the fold angles are constant along every line of creases but for signs: those
across the columns are ``columns`` (c,) times t, those across the rows ``rows`` (r,) times t,
with alternating signs from vertex to vertex. At a vertex whose sectors between its east
and north, and its north and west creases are a and b,

    tan(fold of east / 2) / tan(fold of north / 2) = sin((b - a) / 2) / sin((b + a) / 2),

so that b follows from a; the angles of a panel add up to 2 pi, so that a follows from the
three vertices before it (Lang and Howell 2018). Miura-ori is the mesh with all the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from linkages.values import require

LETTERS = {0: "B", 1: "V", -1: "M"}  # of an edge, by the sign of its fold


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """A mesh of (r, c) inner vertices in rows and columns.

    ``rows`` (r,) and ``columns`` (c,) are the half tangents of its fold angles where t is
    1, with signs, ``west`` (r,) and ``south`` (c,) the sectors a (rad) of the first column
    and the first row. Edges of the first row and column have unit length. Raises
    `GeometryError` where sectors come out at no more than 0 or no less than pi, and where
    the edges of panels cross.
    """

    rows: np.ndarray
    columns: np.ndarray
    west: np.ndarray
    south: np.ndarray

    def __post_init__(self) -> None:
        sectors = np.concatenate(self.sectors)
        is_convex = bool(np.all((sectors > 0.0) & (sectors < np.pi)))
        worst = float(np.degrees(sectors.ravel()[np.abs(sectors - np.pi / 2).argmax()]))
        require(is_convex, "sector", f"{worst:.4g} degrees", "between 0 and 180")
        areas = _turns(self.flat)
        require(bool(np.all(areas > 0.0)), "panel", "crossed", "convex: vary less")

    @cached_property
    def sectors(self) -> tuple[np.ndarray, np.ndarray]:
        """The sectors a and b (c, r) of all inner vertices, rad."""
        a = np.empty((len(self.columns), len(self.rows)))
        b = np.empty_like(a)
        alternating = (-1.0) ** np.arange(len(self.columns))
        ratios = np.multiply.outer(alternating / self.columns, self.rows)
        with np.errstate(all="ignore"):
            for i, j in np.ndindex(a.shape):
                if i and j:
                    a[i, j] = a[i - 1, j - 1] + b[i, j - 1] - b[i - 1, j]
                else:
                    a[i, j] = self.west[j] if j else self.south[i]
                growth = (1.0 + ratios[i, j]) / (1.0 - ratios[i, j])
                b[i, j] = 2.0 * np.arctan(np.tan(0.5 * a[i, j]) * growth)
        return a, b

    @cached_property
    def flat(self) -> np.ndarray:
        """All vertices (c + 2, r + 2, 2) of the flat sheet, those of its rim among
        them."""
        directions = self._directions
        points = np.empty((len(self.columns) + 2, len(self.rows) + 2, 2))
        points[1:-1, 1:-1] = self._inner(directions)
        inner = points[1:-1, 1:-1]
        east, north, west, south = directions
        points[0, 1:-1] = inner[0] + west[0]
        points[-1, 1:-1] = inner[-1] + east[-1]
        points[1:-1, 0] = inner[:, 0] + south[:, 0]
        points[1:-1, -1] = inner[:, -1] + north[:, -1]
        for i, beside_i in ((0, 1), (-1, -2)):
            for j, beside_j in ((0, 1), (-1, -2)):
                across = points[beside_i, beside_j]
                points[i, j] = points[i, beside_j] + points[beside_i, j] - across
        return points

    def _inner(self, directions: tuple[np.ndarray, ...]) -> np.ndarray:
        """The inner vertices (c, r, 2), from the lengths of the first row and column: so
        long that no row shears the columns more than another one does."""
        east, north, *_ = directions
        points = np.zeros_like(east)
        shears = np.abs(self.rows)
        steps = (shears.mean() / shears)[:-1, None] * north[0, :-1]
        points[1:, 0] = np.cumsum(east[:-1, 0], axis=0)
        points[0, 1:] = np.cumsum(steps, axis=0)
        for i, j in np.ndindex(east.shape[0] - 1, east.shape[1] - 1):
            below, beside = points[i + 1, j], points[i, j + 1]
            points[i + 1, j + 1] = _meeting(
                below, north[i + 1, j], beside, east[i, j + 1]
            )
        return points

    @property
    def _directions(self) -> tuple[np.ndarray, ...]:
        """The unit vectors (c, r, 2) to the east, north, west and south of every inner
        vertex."""
        a, b = self.sectors
        bends = np.pi - (a + b)  # of a line from west to east
        headings = np.empty_like(a)
        headings[0, 0] = 0.0
        headings[0, 1:] = np.cumsum(a[0, :-1] - b[0, 1:])
        headings[1:] = headings[0] + np.cumsum(bends[1:], axis=0)
        angles = (headings, headings + a, headings + a + b, headings - np.pi + b)
        return tuple(np.stack([np.cos(one), np.sin(one)], axis=-1) for one in angles)

    def folds(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """The fold angles (rad, valleys positive) at the half tangent ``t``: of the
        creases along a row, (c + 1, r) from west to east, and of those up a column,
        (c, r + 1), which are all the same."""
        signs = (-1.0) ** np.arange(len(self.columns) + 1)
        along = 2.0 * np.arctan(t * np.multiply.outer(signs, self.rows))
        up = 2.0 * np.arctan(t * self.columns)
        return along, np.repeat(up[:, None], len(self.rows) + 1, axis=1)

    def folded(self, t: float) -> np.ndarray:
        """All vertices (c + 2, r + 2, 3) of the sheet folded to the half tangent
        ``t``."""
        flat = np.concatenate([self.flat, np.zeros((*self.flat.shape[:2], 1))], axis=2)
        poses = self._poses(flat, t)
        last = max(poses)
        folded = np.empty_like(flat)
        for i, j in np.ndindex(flat.shape[:2]):
            # with the panel that begins there, or the last one
            pose = poses[min(i, last[0]), min(j, last[1])]
            folded[i, j] = pose.turn @ flat[i, j] + pose.offset
        return folded

    def _poses(self, flat: np.ndarray, t: float) -> dict[tuple[int, int], _Pose]:
        """Where the panels of the ``flat`` sheet are in space, by column and row, the
        first one as it lies."""
        along, up = self.folds(t)
        columns, rows = len(self.columns), len(self.rows)
        poses = {(0, 0): _Pose(np.eye(3), np.zeros(3))}
        for i in range(columns):
            start, end = flat[i + 1, 1], flat[i + 1, 0]
            poses[i + 1, 0] = poses[i, 0].folded_over(start, end, float(up[i, 0]))
        for i, j in np.ndindex(columns + 1, rows):
            start, end = flat[i, j + 1], flat[i + 1, j + 1]
            poses[i, j + 1] = poses[i, j].folded_over(start, end, float(along[i, j]))
        return poses

    def fold_content(self, t: float, title: str) -> dict[str, Any]:
        """The content of a FOLD file of the sheet folded to the half tangent ``t``,
        positive, its creases assigned as they are folded. Vertices and panels are counted
        along the rows."""
        return self._content(self.folded(t), "foldedForm", title)

    def crease_pattern(self, t: float, title: str) -> dict[str, Any]:
        """The same of the flat sheet, with the fold angles (degrees) at the half tangent
        ``t``, 0 or more."""
        content = self._content(self.flat, "creasePattern", title)
        angles = np.degrees(self._of_edges(*self.folds(t)))
        return {**content, "edges_foldAngle": angles.tolist()}

    def thick_pattern(self, t: float, step: float, title: str) -> dict[str, Any]:
        """The same of thick panels: hinges up the columns are in the middle, those along
        the rows one ``step`` above or below, by the way they fold. Where all sectors have
        one sine every vertex is a Bennett linkage, which folds as the flat vertex does
        (Chen, Peng and You 2015)."""
        along, up = self.folds(1.0)
        heights = step * self._of_edges(np.sign(along), 0.0 * up)
        pattern = self.crease_pattern(t, title)
        return {**pattern, "bifurc:edges_height": heights.tolist()}

    def _content(self, points: np.ndarray, kind: str, title: str) -> dict[str, Any]:
        """The content of a FOLD file with vertices at ``points`` (c + 2, r + 2, k)."""
        columns, rows = points.shape[:2]
        numbers = np.arange(columns * rows).reshape(rows, columns).T
        signs = np.sign(self._of_edges(*self.folds(1.0))).astype(int)
        return {
            "file_spec": 1.1,
            "file_title": title,
            "frame_classes": [kind],
            "vertices_coords": np.concatenate(points.swapaxes(0, 1)).tolist(),
            "edges_vertices": _ends(numbers).tolist(),
            "edges_assignment": [LETTERS[sign] for sign in signs.tolist()],
            "faces_vertices": _panels(numbers).tolist(),
        }

    @staticmethod
    def _of_edges(along: np.ndarray, up: np.ndarray) -> np.ndarray:
        """Values of the creases along the rows (c + 1, r) and up the columns (c, r + 1)
        for all edges (e,), 0 on the rim."""
        along, up = np.pad(along, ((0, 0), (1, 1))), np.pad(up, ((1, 1), (0, 0)))
        return np.concatenate([along.ravel(), up.ravel()])


class _Pose(NamedTuple):
    """A displacement: a ``turn`` (3, 3) about the origin, and then an ``offset``
    (3,)."""

    turn: np.ndarray
    offset: np.ndarray

    def folded_over(self, start: np.ndarray, end: np.ndarray, angle: float) -> _Pose:
        """That of a panel on the left of the crease from ``start`` (3,) to ``end`` (3,)
        of one that is here, which is folded up by an angle."""
        turn = _turn(end - start, angle)
        offset = self.offset + self.turn @ (start - turn @ start)
        return _Pose(self.turn @ turn, offset)


def _ends(numbers: np.ndarray) -> np.ndarray:
    """The ends (e, 2) of all edges between vertices of these numbers (k, l)."""
    across = np.stack([numbers[:-1], numbers[1:]], axis=-1)
    upwards = np.stack([numbers[:, :-1], numbers[:, 1:]], axis=-1)
    return np.concatenate([across.reshape(-1, 2), upwards.reshape(-1, 2)])


def _panels(numbers: np.ndarray) -> np.ndarray:
    """The corners (p, 4) of all panels between vertices of these numbers (k, l)."""
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    return np.stack(corners, axis=-1).swapaxes(0, 1).reshape(-1, 4)


def straight_mesh(rows: np.ndarray, columns: np.ndarray) -> QuadMesh:
    """The mesh with these half tangents in whose first row and first column the creases
    from west to east run straight on: a + b = pi."""
    alternating = (-1.0) ** np.arange(len(columns))
    west, south = rows / columns[0], alternating * rows[0] / columns
    for ratios in (west, south):
        largest = float(np.abs(ratios).max())
        allowed = "less than 1"
        require(largest < 1.0, "ratio of half tangents", f"{largest:.4g}", allowed)
    west, south = (
        2.0 * np.arctan(np.sqrt((1.0 - one) / (1.0 + one))) for one in (west, south)
    )
    return QuadMesh(rows, columns, west, south)


def _turn(axis: np.ndarray, angle: float) -> np.ndarray:
    """The rotation (3, 3) by an angle about an axis (3,)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: np.ndarray = (
        np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    )
    return turn


def _meeting(
    first: np.ndarray, along: np.ndarray, second: np.ndarray, beside: np.ndarray
) -> np.ndarray:
    """Where the line from ``first`` (2,) along a direction (2,) meets that from
    ``second`` along another one, ``beside``."""
    gap = second - first
    share = (gap[0] * beside[1] - gap[1] * beside[0]) / (
        along[0] * beside[1] - along[1] * beside[0]
    )
    meeting: np.ndarray = first + share * along
    return meeting


def _turns(points: np.ndarray) -> np.ndarray:
    """The sines of the angles at the four corners of every panel of vertices (k, l, 2),
    positive where it turns to the left."""
    corners = [points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]]
    sines = []
    for k in range(4):
        into = corners[k] - corners[k - 1]
        out = corners[(k + 1) % 4] - corners[k]
        sines.append(into[..., 0] * out[..., 1] - into[..., 1] * out[..., 0])
    return np.array(sines)
