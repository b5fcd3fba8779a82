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
from typing import Any

import numpy as np

from linkages.values import require

ALONG, UP = "e", "n"  # creases that run from west to east, and from south to north


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
        east, north, west, south = self._directions
        c, r = east.shape[:2]
        points = np.empty((c + 2, r + 2, 2))
        points[1, 1] = 0.0
        shifts = np.abs(self.rows)
        lengths = shifts.mean() / shifts
        for i in range(1, c):
            points[i + 1, 1] = points[i, 1] + east[i - 1, 0]
        for j in range(1, r):
            points[1, j + 1] = points[1, j] + lengths[j - 1] * north[0, j - 1]
        for j in range(1, r):
            for i in range(1, c):
                points[i + 1, j + 1] = _meeting(
                    points[i + 1, j], north[i, j - 1], points[i, j + 1], east[i - 1, j]
                )
        inner = points[1:-1, 1:-1]
        points[0, 1:-1] = inner[0] + west[0]
        points[-1, 1:-1] = inner[-1] + east[-1]
        points[1:-1, 0] = inner[:, 0] + south[:, 0]
        points[1:-1, -1] = inner[:, -1] + north[:, -1]
        for i, j in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
            beside_i, beside_j = (1 if i == 0 else -2), (1 if j == 0 else -2)
            points[i, j] = (
                points[i, beside_j] + points[beside_i, j] - points[beside_i, beside_j]
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
        along, up = self.folds(t)
        flat = np.concatenate([self.flat, np.zeros((*self.flat.shape[:2], 1))], axis=2)
        columns, rows = flat.shape[0] - 1, flat.shape[1] - 1
        turns = np.empty((columns, rows, 3, 3))
        offsets = np.empty((columns, rows, 3))
        turns[0, 0], offsets[0, 0] = np.eye(3), 0.0
        for i, j in np.ndindex(columns, rows):
            if j:
                before = i, j - 1
                ends, angle = (flat[i, j], flat[i + 1, j]), along[i, j - 1]
            elif i:
                before = i - 1, 0
                ends, angle = (flat[i, 1], flat[i, 0]), up[i - 1, 0]
            else:
                continue
            turn = _turn(ends[1] - ends[0], angle)
            turns[i, j] = turns[before] @ turn
            offsets[i, j] = offsets[before] + turns[before] @ (ends[0] - turn @ ends[0])
        panels = np.minimum(np.arange(columns + 1), columns - 1)
        beside = np.minimum(np.arange(rows + 1), rows - 1)
        of_vertex = np.ix_(panels, beside)
        moved = turns[of_vertex] @ flat[..., None]
        folded: np.ndarray = moved[..., 0] + offsets[of_vertex]
        return folded

    def fold_content(self, t: float, title: str) -> dict[str, Any]:
        """The content of a FOLD file of the sheet folded to the half tangent ``t``,
        positive, its creases assigned as they are folded."""
        along, up = self.folds(t)
        columns, rows = self.flat.shape[0] - 1, self.flat.shape[1] - 1
        numbers = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
        number = numbers.tolist()
        edges, letters = [], []

        def add(first: tuple[int, int], second: tuple[int, int], fold: float) -> None:
            edges.append([number[first[0]][first[1]], number[second[0]][second[1]]])
            letters.append("B" if fold == 0.0 else "V" if fold > 0.0 else "M")

        for i, j in np.ndindex(numbers.shape):
            if i < columns:
                is_inner = 0 < j < rows
                add((i, j), (i + 1, j), along[i, j - 1] if is_inner else 0.0)
            if j < rows:
                is_inner = 0 < i < columns
                add((i, j), (i, j + 1), up[i - 1, j] if is_inner else 0.0)
        faces = [
            [number[i][j], number[i + 1][j], number[i + 1][j + 1], number[i][j + 1]]
            for i, j in np.ndindex(columns, rows)
        ]
        return {
            "file_spec": 1.1,
            "file_title": title,
            "frame_classes": ["foldedForm"],
            "vertices_coords": self.folded(t).reshape(-1, 3).tolist(),
            "edges_vertices": edges,
            "edges_assignment": letters,
            "faces_vertices": faces,
        }


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
