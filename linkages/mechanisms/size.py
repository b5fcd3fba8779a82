"""How large a mechanism is: lengths that hang on no choice of points on its axes."""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np

from linkages.mechanisms.joint_places import joint_places
from linkages.mechanisms.mechanism import Mechanism

ROUNDING = 1e-12  # of the spread of the points: a distance that is none
MANY = 300  # unknowns from which on least squares are solved by a sparse matrix
SETTLED = 1e-14  # what conjugate gradients leave of them


class _Span(NamedTuple):
    """Two places of joints, by number, on one body."""

    body: str
    first: int
    second: int


class _Block(NamedTuple):
    """Entries (3, k) of a matrix from a ``row`` and a ``column`` on."""

    row: int
    column: int
    entries: np.ndarray


class Size:
    """The lengths of a mechanism's bodies.

    Every joint is represented by the point of its axis that makes all bodies together
    as short as can be (least squares). The point of a slide is anywhere. A joint that
    is written as several is one: see `joint_places`.
    """

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        self.places = joint_places(mechanism)

    @property
    def characteristic_length(self) -> float:
        """The mean distance of joints on one body, of those that are apart; where all
        meet in a point or a line, the mean pitch, or that of the points that are given;
        1 where these meet as well."""
        distances = self._distances(self.points)
        if len(distances):
            return float(distances.mean())
        pitches = [abs(one.pitch) for one in self.mechanism.joints if one.pitch]
        if pitches:
            return float(np.mean(pitches))
        distances = self._distances(self._given)
        return float(distances.mean()) if len(distances) else 1.0

    @cached_property
    def points(self) -> np.ndarray:
        """A point (k, 3) for each of the k places of joints."""
        bases = [place.free for place in self.places]
        starts = np.cumsum([0, *(len(basis) for basis in bases)])
        gaps = np.zeros(3 * len(self._spans))
        blocks = []
        for k, span in enumerate(self._spans):
            for joint, sign in ((span.first, 1.0), (span.second, -1.0)):
                blocks.append(_Block(3 * k, int(starts[joint]), sign * bases[joint].T))
            gaps[3 * k : 3 * k + 3] = self._given[span.second] - self._given[span.first]
        shifts = _least_squares(blocks, gaps, int(starts[-1]))
        points = self._given.copy()
        for joint, basis in enumerate(bases):
            points[joint] += shifts[starts[joint] : starts[joint + 1]] @ basis
        return points

    @cached_property
    def body_lengths(self) -> dict[str, float]:
        """The largest distance of two joints on each body; the characteristic length
        where they all meet."""
        lengths = dict.fromkeys(self.mechanism.bodies, 0.0)
        if not len(self._distances(self.points)):
            ends = {body for place in self.places for body in place.bodies}
            return lengths | dict.fromkeys(ends, self.characteristic_length)
        for span in self._spans:
            gap = self.points[span.first] - self.points[span.second]
            distance = float(np.linalg.norm(gap))
            lengths[span.body] = max(lengths[span.body], distance)
        return lengths

    @cached_property
    def _given(self) -> np.ndarray:
        return np.array([place.point for place in self.places])

    @cached_property
    def _spans(self) -> list[_Span]:
        here: dict[str, list[int]] = {body: [] for body in self.mechanism.bodies}
        for k, place in enumerate(self.places):
            for body in place.bodies:
                here[body].append(k)
        spans = []
        for body, numbers in here.items():
            spans += [_Span(body, *two) for two in combinations(numbers, 2)]
        return spans

    def _distances(self, points: np.ndarray) -> np.ndarray:
        """The distances of joints on one body that are apart."""
        spread = float(np.ptp(self._given, axis=0).max())
        first = points[[span.first for span in self._spans]]
        second = points[[span.second for span in self._spans]]
        distances = np.linalg.norm(first - second, axis=1)
        apart: np.ndarray = distances[distances > ROUNDING * spread]
        return apart


def _least_squares(blocks: list[_Block], right: np.ndarray, columns: int) -> np.ndarray:
    """The shortest least-squares solution (columns,) of a matrix of ``blocks``, which add
    up, for a ``right``-hand side."""
    if columns <= MANY:
        matrix = np.zeros((len(right), columns))
        for row, column, entries in blocks:
            matrix[row : row + 3, column : column + entries.shape[1]] += entries
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import lsmr

    rows, numbers, values = [], [], []
    for row, column, entries in blocks:
        places = np.indices(entries.shape)
        rows.append((row + places[0]).ravel())
        numbers.append((column + places[1]).ravel())
        values.append(entries.ravel())
    where = (np.concatenate(rows), np.concatenate(numbers))
    sparse = coo_array((np.concatenate(values), where), shape=(len(right), columns))
    steps = 10 * columns
    solution = lsmr(
        sparse.tocsr(), right, atol=SETTLED, btol=SETTLED, conlim=0.0, maxiter=steps
    )
    return np.asarray(solution[0])
