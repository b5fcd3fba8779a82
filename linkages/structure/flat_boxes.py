"""Whether there is a small fold of a flat sheet at all, by boxes of fold angles.

The equations of leading order are linear but for products of two angles at a vertex. A
box of angles holds no solution where a linear program finds none, in which every product
is a number of its own between the planes that bound it over the box (McCormick 1976), and
solves every linear equation of its vertex times each angle there (Sherali and Adams
1990). Where it finds one, the box is halved across an angle whose products it misses
most.
"""

from __future__ import annotations

from itertools import combinations_with_replacement
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
        low, high = boxes.pop()
        solution = programs.solution(low, high)
        if solution is None:
            continue
        sizes, missed = solution
        if missed.max() < NEAR:
            angles = np.zeros(folds.count)
            angles[programs.creases] = sizes * folds.signs[programs.creases]
            return FirstFold(folds.near(angles), is_none=False)
        widest = int(np.argmax(missed))
        side = high[widest] - low[widest]
        ends = low[widest] + MARGIN * side, high[widest] - MARGIN * side
        middle = float(np.clip(sizes[widest], *ends))
        below, above = high.copy(), low.copy()
        below[widest] = above[widest] = middle
        boxes += [(low, below), (above, high)]
    return unknown


class _Programs:
    """The linear programs for boxes of the sizes (c,) of the fold angles of ``creases``
    (c,), by number, which add up to 1."""

    def __init__(self, folds: LeadingFolds):
        self.creases = np.flatnonzero(folds.about)
        column = {int(number): k for k, number in enumerate(self.creases)}
        pairs: dict[tuple[int, int], int] = {}
        entries: list[tuple[int, int, float]] = []
        row = 0
        for numbers, directions in folds.vertices:
            columns = [column[number] for number in numbers]
            signed = directions * folds.signs[list(numbers), None]
            forms = np.triu(products_of(signed), 1)
            product = {}
            for i, j in combinations_with_replacement(range(len(columns)), 2):
                first, second = sorted((columns[i], columns[j]))
                place = pairs.setdefault((first, second), len(pairs))
                product[i, j] = product[j, i] = len(column) + place
            for part in signed.T:
                entries += [(row, *one) for one in zip(columns, part, strict=True)]
                for j in range(len(columns)):
                    entries += [
                        (row + 1 + j, product[i, j], value)
                        for i, value in enumerate(part)
                    ]
                row += 1 + len(columns)
            places = zip(*np.nonzero(forms), strict=True)
            entries += [(row, product[int(i), int(j)], forms[i, j]) for i, j in places]
            row += 1
        entries += [(row, k, 1.0) for k in range(len(column))]
        rows, columns, values = (np.array(one) for one in zip(*entries, strict=True))
        self.first, self.second = np.array(list(pairs)).T
        self.size = len(column) + len(pairs)
        shape = (row + 1, self.size)
        self.equations = coo_array((values, (rows, columns)), shape=shape).tocsr()
        self.right = np.append(np.zeros(row), 1.0)

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
