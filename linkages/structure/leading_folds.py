"""Small folds of a flat sheet, to leading order: where motions may leave the flat state.

They solve the equations of first and second order at every inner vertex
(`linkages.structure.flat_sheet`), with the signs of the assignment. Random ones are
brought there by least squares within these signs. Many creases of a large sheet are 0
then: they rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from bifurc.limits import is_time_over
from linkages.structure.flat_sheet import FlatVertex, products_of

STARTS = 20  # random ones, at most
MOST_EVALUATIONS = 200  # for each
NEAR = 1e-6  # residual from which on those that seem to rest are set to 0
REST = 3e-3  # fold angle over the largest, below which a crease seems to rest
SOLVED = 1e-10  # residual, of angles whose squares add up to 1
SHARP = 1e-15  # relative tolerance of least squares


class LeadingFolds:
    """The folds of a sheet with inner ``vertices``: angles (v,) of its creases, each of
    the ``signs`` (v,) or 0, and whose squares add up to 1. Those that are at no vertex
    are 0, ``about`` (v,) are the others."""

    def __init__(self, vertices: Sequence[FlatVertex], signs: np.ndarray):
        most = max(len(vertex.variables) for vertex in vertices)
        self.vertices, self.signs = vertices, signs
        self.count = len(signs)
        self.numbers = np.full((len(vertices), most), self.count)  # past the last: none
        self.directions = np.zeros((len(vertices), most, 2))
        self.products = np.zeros((len(vertices), most, most))
        for k, (numbers, directions) in enumerate(vertices):
            degree = len(numbers)
            upper = np.triu(products_of(directions), 1)
            self.numbers[k, :degree] = numbers
            self.directions[k, :degree] = directions
            self.products[k, :degree, :degree] = upper + upper.T
        self.about = np.isin(np.arange(self.count), self.numbers)
        self.low = np.where(signs > 0, 0.0, -1.0)
        self.high = np.where(signs < 0, 0.0, 1.0)

    def random(self, rng: np.random.Generator) -> Iterator[np.ndarray]:
        """Those (v,) to which random angles lead."""
        for _ in range(STARTS):
            if is_time_over():
                return
            angles = np.where(self.about, rng.uniform(self.low, self.high), 0.0)
            fold = self.near(angles)
            if fold is not None:
                yield fold

    def near(self, angles: np.ndarray) -> np.ndarray | None:
        """That (v,) to which ``angles`` (v,) lead; None where they lead to none."""
        fold = None
        angles, residual = self._solved(np.clip(angles, self.low, self.high))
        while residual < NEAR:
            if residual < SOLVED:
                fold = angles.copy()
            rests = np.abs(angles) < REST * np.abs(angles).max()
            if not angles[rests].any():
                break
            angles[rests] = 0.0
            angles, residual = self._solved(angles)
        return fold

    def residuals(self, angles: np.ndarray) -> np.ndarray:
        """By how much angles (v,) miss the equations (3 p + 1,): of first order, of
        second order, and the sum of their squares."""
        about = np.append(angles, 0.0)[self.numbers]
        first = np.einsum("pd,pdk->pk", about, self.directions)
        second = np.einsum("pi,pij,pj->p", about, self.products, about)
        return np.concatenate([first.ravel(), second, [angles @ angles - 1.0]])

    def jacobian(self, angles: np.ndarray) -> np.ndarray:
        """Their derivatives (3 p + 1, v)."""
        about = np.append(angles, 0.0)[self.numbers]
        second = 2.0 * np.einsum("pij,pj->pi", self.products, about)
        count = len(self.numbers)
        rows = np.arange(count)[:, None]
        matrix = np.zeros((3 * count + 1, self.count + 1))
        matrix[2 * rows, self.numbers] = self.directions[:, :, 0]
        matrix[2 * rows + 1, self.numbers] = self.directions[:, :, 1]
        matrix[2 * count + rows, self.numbers] = second
        matrix[-1, :-1] = 2.0 * angles
        return matrix[:, :-1]

    def _solved(self, angles: np.ndarray) -> tuple[np.ndarray, float]:
        """Angles (v,) that solve them best, from others, of which those that are 0 stay
        so; and the residual."""
        from scipy.optimize import least_squares  # few searches need it

        moves = angles != 0.0
        if not moves.any():
            return angles, np.inf

        def whole(part: np.ndarray) -> np.ndarray:
            all_angles = np.zeros(self.count)
            all_angles[moves] = part
            return all_angles

        found = least_squares(
            lambda part: self.residuals(whole(part)),
            angles[moves] / np.linalg.norm(angles),
            lambda part: self.jacobian(whole(part))[:, moves],
            bounds=(self.low[moves], self.high[moves]),
            ftol=SHARP,
            xtol=SHARP,
            gtol=SHARP,
            max_nfev=MOST_EVALUATIONS,
        )
        return whole(found.x), float(np.linalg.norm(found.fun))
