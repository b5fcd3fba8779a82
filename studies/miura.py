"""Miura-ori of any size as the content of a FOLD file (Miura 1970)."""

from __future__ import annotations

from typing import Any

import numpy as np

SECTOR = np.radians(70)  # angle of the parallelograms


def miura(columns: int, rows: int, fold: float = 0.0) -> dict[str, Any]:
    """A sheet of parallelograms, straight creases along x, zigzags along y, assigned as it folds, with
    fold angles where ``fold`` (rad, 0 or more), that of the zigzags, is not 0.

    The half tangents of the fold angles at a vertex have the cosine of the sector angle
    as their ratio (Schenk and Guest 2013).
    """
    straight = 2 * np.arctan(np.tan(fold / 2) * np.cos(SECTOR))
    place: dict[tuple[int, int], tuple[int, list[float]]] = {}
    for j in range(rows + 1):
        for i in range(columns + 1):
            x = i + (j % 2) * np.cos(SECTOR)
            place[i, j] = (len(place), [x, j * np.sin(SECTOR)])
    faces, edges, letters, angles = [], [], [], []

    def edge(
        first: tuple[int, int],
        second: tuple[int, int],
        is_inner: bool,
        sign: int,
        angle: float,
    ) -> None:
        edges.append([place[first][0], place[second][0]])
        letters.append(("V" if sign > 0 else "M") if is_inner else "B")
        angles.append(float(np.degrees(sign * angle)) if is_inner else 0.0)

    for i, j in place:
        if i < columns:
            edge((i, j), (i + 1, j), 0 < j < rows, -((-1) ** (i + j)), straight)
        if j < rows:
            edge((i, j), (i, j + 1), 0 < i < columns, (-1) ** i, fold)
        if i < columns and j < rows:
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            faces.append([place[corner][0] for corner in corners])
    return {
        "file_spec": 1.1,
        "file_title": f"Miura-ori {columns} x {rows}",
        "frame_classes": ["creasePattern"],
        "vertices_coords": [at for _, at in place.values()],
        "edges_vertices": edges,
        "edges_assignment": letters,
        "edges_foldAngle": angles,
        "faces_vertices": faces,
    }
