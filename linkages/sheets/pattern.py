"""Crease patterns that repeat over a lattice, from one cell of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from linkages.construction.equations import evaluate
from linkages.files.faces import faces_of_edges

Vertex: TypeAlias = tuple[str, int, int]

RIM = 2  # cells that are laid around those of the sheet


class CellCrease(NamedTuple):
    """A crease from the vertex ``start`` of a cell (i, j) to the vertex ``end`` of the
    cell (i + ``columns``, j + ``rows``), with its letter, or one for each parity of
    i + j."""

    start: str
    end: str
    columns: int
    rows: int
    letters: str


@dataclass(frozen=True)
class Cell:
    """One cell of a pattern: its ``lattice`` (2, 2) and its vertices ``points``, x and y
    as formulas of the ``values`` of parameters and the parity p = 1 or -1 of i + j, and
    its ``creases``."""

    lattice: Sequence[Sequence[str]]
    points: Mapping[str, Sequence[str]]
    creases: Sequence[CellCrease]
    values: Mapping[str, float]

    def fold_content(self, columns: int, rows: int, title: str) -> dict[str, Any]:
        """The content of a FOLD file: the cells of so many columns and rows, each row
        shifted to stand above the one before, with all panels about their vertices."""
        first, second = (self._place(one, 1.0) for one in self.lattice)
        slope = float(first @ second / (first @ first))
        cells = [
            (i - round(j * slope), j)
            for j in range(-RIM, rows + RIM)
            for i in range(-RIM, columns + RIM)
        ]
        numbers: dict[Vertex, int] = {}
        points: list[np.ndarray] = []
        inner = set()
        for name, (i, j) in product(self.points, cells):
            if 0 <= j < rows and 0 <= i + round(j * slope) < columns:
                inner.add(len(points))
            numbers[name, i, j] = len(points)
            place = self._place(self.points[name], 1.0 - 2.0 * ((i + j) % 2))
            points.append(i * first + j * second + place)
        return _about(np.array(points), self._edges(cells, numbers), inner, title)

    def _place(self, formulas: Sequence[str], parity: float) -> np.ndarray:
        """The point (2,) of two formulas."""
        names = {**self.values, "p": parity}
        return np.array([float(evaluate(one, names)) for one in formulas])

    def _edges(
        self, cells: Sequence[tuple[int, int]], numbers: Mapping[Vertex, int]
    ) -> dict[tuple[int, int], str]:
        """The letter of every crease between two vertices that are there."""
        edges = {}
        for crease, (i, j) in product(self.creases, cells):
            end = numbers.get((crease.end, i + crease.columns, j + crease.rows))
            if end is not None:
                letter = crease.letters[(i + j) % len(crease.letters)]
                edges[numbers[crease.start, i, j], end] = letter
        return edges


def _about(
    points: np.ndarray,
    edges: Mapping[tuple[int, int], str],
    inner: set[int],
    title: str,
) -> dict[str, Any]:
    """The content of a FOLD file with the faces about ``inner`` vertices, of ``points``
    (v, 2), the edges on one face alone its rim."""
    in_space = np.pad(points, ((0, 0), (0, 1)))
    faces = [face for face in faces_of_edges(in_space, list(edges)) if inner & {*face}]
    used = sorted({vertex for face in faces for vertex in face})
    numbers = {vertex: number for number, vertex in enumerate(used)}
    sides = {
        pair for face in faces for pair in zip(face, [*face[1:], face[0]], strict=True)
    }
    letters = {}
    for start, end in edges:
        count = ((start, end) in sides) + ((end, start) in sides)
        if count:
            letter = edges[start, end] if count == 2 else "B"
            letters[numbers[start], numbers[end]] = letter
    return {
        "file_spec": 1.1,
        "file_title": title,
        "frame_classes": ["creasePattern"],
        "vertices_coords": points[used].tolist(),
        "edges_vertices": [list(pair) for pair in letters],
        "edges_assignment": list(letters.values()),
        "faces_vertices": [[numbers[vertex] for vertex in face] for face in faces],
    }
