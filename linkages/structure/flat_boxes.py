"""Whether there is a small fold of a flat sheet at all, by boxes of fold angles.

The equations of leading order are linear but for products of two angles at a vertex. A
box of angles holds no solution where a linear program finds none, in which every product
is a number of its own between the planes that bound it over the box (McCormick 1976), and
solves every linear equation of its vertex times each angle there (Sherali and Adams
1990). Where it finds one, the box is halved across an angle whose products it misses
most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack

from bifurc.limits import is_time_over
from linkages.structure.flat_sheet import FREE, products_of
from linkages.structure.leading_folds import NEAR, LeadingFolds

MOST_BOXES = 500
MARGIN = 0.2  # of a side of a box, which a half has at least
INFEASIBLE = 2  # the status of a linear program without a solution


class FirstFold(NamedTuple):
    """The first of the folds of a sheet (v,), and whether there ``is_none``; None where
    neither is known."""

    angles: np.ndarray | None
    is_none: bool


def first_fold(folds: LeadingFolds) -> FirstFold:
    """What boxes say, where each crease is assigned."""
    unknown = FirstFold(None, is_none=False)
    if (folds.signs[folds.about] == FREE).any():
        return unknown
    programs = _Programs(folds)
    count = programs.creases.size
    boxes = [(np.zeros(count), np.ones(count))]
    for _ in range(MOST_BOXES):
        if not boxes:
            return FirstFold(None, is_none=True)
        if is_time_over():
            return unknown
        box = boxes.pop()
        solution = programs.solution(*box)
        if solution is None:
            continue
        sizes, missed = solution
        if missed.max() < NEAR:
            angles = np.zeros(folds.count)
            angles[programs.creases] = sizes * folds.signs[programs.creases]
            return FirstFold(folds.near(angles), is_none=False)
        boxes += _halves(*box, sizes, int(np.argmax(missed)))
    return unknown


def _halves(
    low: np.ndarray, high: np.ndarray, sizes: np.ndarray, across: int
) -> list[tuple[np.ndarray, np.ndarray]]:
    """The parts of a box, divided ``across`` a side near the ``sizes`` (c,)."""
    side = high[across] - low[across]
    ends = low[across] + MARGIN * side, high[across] - MARGIN * side
    below, above = high.copy(), low.copy()
    below[across] = above[across] = np.clip(sizes[across], *ends)
    return [(low, below), (above, high)]


class _Programs:
    """The linear programs for boxes of the sizes (c,) of the fold angles of ``creases``
    (c,), by number, which add up to 1. Besides them every product of the sizes
    ``first`` and ``second`` (q,) is an unknown."""

    def __init__(self, folds: LeadingFolds):
        self.creases = np.flatnonzero(folds.about)
        self._column = {int(number): k for k, number in enumerate(self.creases)}
        self._pairs: dict[tuple[int, int], int] = {}
        equations = [
            equation
            for numbers, directions in folds.vertices
            for equation in self._about(
                [self._column[number] for number in numbers],
                directions * folds.signs[list(numbers), None],
            )
        ]
        equations.append(dict.fromkeys(range(len(self._column)), 1.0))
        self.first, self.second = np.array(list(self._pairs)).T
        self.size = len(self._column) + len(self._pairs)
        self.equations = _matrix(equations, self.size)
        self.right = np.append(np.zeros(len(equations) - 1), 1.0)

    def _about(
        self, columns: list[int], directions: np.ndarray
    ) -> Iterator[dict[int, float]]:
        """The equations at a vertex with the creases of these ``columns`` along (d, 2),
        each as the coefficients of columns."""
        for part in directions.T:
            yield dict(zip(columns, part.tolist(), strict=True))
            for other in columns:
                products = [self._product(column, other) for column in columns]
                yield dict(zip(products, part.tolist(), strict=True))
        forms = np.triu(products_of(directions), 1)
        yield {
            self._product(columns[i], columns[j]): float(forms[i, j])
            for i, j in zip(*np.nonzero(forms), strict=True)
        }

    def _product(self, one: int, other: int) -> int:
        """The column of the product of two sizes, by their columns."""
        pair = (min(one, other), max(one, other))
        return len(self._column) + self._pairs.setdefault(pair, len(self._pairs))

    def solution(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Sizes (c,) that solve the program of a box between ``low`` and ``high`` (c,),
        and by how much products with each of them are missed (c,); None where there are
        none, as where the box is shown to hold no fold."""
        from scipy.optimize import linprog  # few searches need it

        planes, beyond = self._planes(low, high)
        sides = np.stack([low, high], axis=1)
        program = linprog(
            np.zeros(self.size),
            A_ub=planes,
            b_ub=beyond,
            A_eq=self.equations,
            b_eq=self.right,
            bounds=np.concatenate([sides, np.tile([0.0, 1.0], (len(self.first), 1))]),
        )
        if program.status == INFEASIBLE:
            return None
        if not program.success:
            middles = 0.5 * (low + high)
            return middles, high - low
        sizes, products = np.split(program.x, [len(low)])
        apart = np.abs(products - sizes[self.first] * sizes[self.second])
        missed = np.zeros(len(low))
        np.add.at(missed, self.first, apart)
        np.add.at(missed, self.second, apart)
        return sizes, missed

    def _planes(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[csr_array, np.ndarray]:
        """The planes, as rows and what these may not exceed, between which products of
        two sizes are over a box."""
        first, second = self.first, self.second
        corners = [
            (low, low, 1.0),
            (high, high, 1.0),
            (low, high, -1.0),
            (high, low, -1.0),
        ]
        rows, limits = [], []
        along = np.arange(len(first))
        product = len(low) + along
        for of_first, of_second, sense in corners:
            a, b = of_first[first], of_second[second]
            values = [sense * b, sense * a, np.full(len(along), -sense)]
            places = (np.tile(along, 3), np.concatenate([first, second, product]))
            shape = (len(along), self.size)
            rows.append(coo_array((np.concatenate(values), places), shape=shape))
            limits.append(sense * a * b)
        return vstack(rows, format="csr"), np.concatenate(limits)


def _matrix(rows: Sequence[dict[int, float]], width: int) -> csr_array:
    """Rows that are given as the coefficients of columns."""
    numbers = [number for number, one in enumerate(rows) for _ in one]
    columns = [column for one in rows for column in one]
    values = [value for one in rows for value in one.values()]
    return coo_array((values, (numbers, columns)), shape=(len(rows), width)).tocsr()
