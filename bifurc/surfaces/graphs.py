"""Sheets of a surface as graphs above the tangent planes of charts."""

from __future__ import annotations

import numpy as np

from bifurc.numerics.corrector import normal_corrections
from bifurc.problem import Problem
from bifurc.surfaces.polygon import BORDER, FlatCharts
from bifurc.surfaces.sheet import SOLVED, follow_along, slopes_above

# Rounds by which points of a graph are moved onto bounds, how far, over the radius, one
# goes, and how far off, over the scale, the last may be.
ROUNDS, FARTHEST, AT_BOUND = 12, 0.5, 1e-12


class Graphs:
    """Graphs above the planes of ``charts`` with these numbers (k,), one for each of
    the points that are asked for."""

    def __init__(
        self, problem: Problem, charts: FlatCharts, numbers: np.ndarray | None = None
    ):
        self._problem = problem
        self._charts = charts
        every = np.arange(len(charts.radii)) if numbers is None else numbers
        self._centers = charts.centers[every]
        self._planes = charts.bases[every]
        self._radii = charts.radii[every]
        self._are_clear = charts.are_clear[every]

    def part(self, numbers: np.ndarray) -> Graphs:
        """Those above the charts of these numbers (k,)."""
        return Graphs(self._problem, self._charts, numbers)

    def flat(self, positions: np.ndarray) -> np.ndarray:
        """Points (k, n) of the planes."""
        flat: np.ndarray = self._centers + np.einsum(
            "kij,kj->ki", self._planes, positions
        )
        return flat

    def positions(self, points: np.ndarray) -> np.ndarray:
        """Positions (k, 2) of points (k, n) in the planes."""
        offsets = self._problem.domain.difference(points, self._centers)
        positions: np.ndarray = np.einsum("kij,ki->kj", self._planes, offsets)
        return positions

    def above(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, n) above ``positions`` (k, 2), and whether they are there
        (k,)."""
        points, is_there = self.along(positions, np.ones(1))
        return points[:, 0], is_there[:, 0]

    def along(
        self, positions: np.ndarray, shares: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solutions (k, s, n) above the way from the centres to ``positions`` (k, 2),
        at ``shares`` (s,) of it, and whether they are there (k, s).

        Beside other sheets they are followed from the centres; where that fails, the
        solutions straight above stand for them.
        """
        ways = np.einsum("kij,kj->ki", self._planes, positions)
        flat = self._centers[:, None] + shares[:, None] * ways[:, None]
        points, is_there = flat.copy(), np.zeros(flat.shape[:2], dtype=bool)
        beside = np.flatnonzero(~self._are_clear)
        if len(beside):
            points[beside], is_there[beside] = follow_along(
                self._problem,
                self._centers[beside],
                self._planes[beside],
                positions[beside],
                shares,
            )
        row, share = np.nonzero(~is_there)
        straight = normal_corrections(
            self._problem, flat[row, share], self._planes[row]
        )
        points[row, share] = straight.points
        is_there[row, share] = (straight.gaps <= SOLVED) & self._are_clear[row]
        return points, is_there

    def slopes(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (k, n, 2) of the graphs by the position, at their points (k,
        n)."""
        return slopes_above(self._problem, points, self._planes)

    def heights(
        self, positions: np.ndarray, points: np.ndarray, slopes: np.ndarray
    ) -> np.ndarray:
        """Heights (k, n) of the graphs above positions (k, 2), from their ``points`` (k, n)
        and ``slopes`` (k, n, 2) next to them: a correction may move a point a little along
        the plane."""
        heights: np.ndarray = points - self.flat(positions)
        aside = np.einsum("kij,ki->kj", self._planes, heights)
        heights -= np.einsum("kij,kj->ki", slopes, aside)
        return heights

    def onto_bounds(
        self, positions: np.ndarray, on_bound: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Points (k, n) of the graphs next to ``positions`` (k, 2) that lie on bounds,
        and whether they are there (k,).

        ``on_bound`` (k, 2 n) says on which: of each unknown the lower, then the upper
        one, numbered as labels of edges below `BORDER` are.
        """
        positions = positions.copy()
        bounds = self._problem.domain.bounds.ravel()
        at = np.where(on_bound, bounds, 0.0)
        for _ in range(ROUNDS):
            points, is_there = self.above(positions)
            gaps = np.where(on_bound, at - np.repeat(points, 2, axis=1), 0.0)
            if np.abs(gaps).max(initial=0.0) < AT_BOUND * self._problem.domain.scale:
                break
            rates = np.repeat(self.slopes(points), 2, axis=1) * on_bound[:, :, None]
            steps = np.einsum("kij,kj->ki", np.linalg.pinv(rates), gaps)
            lengths = np.linalg.norm(steps, axis=1)
            most = FARTHEST * self._radii
            steps *= np.minimum(1.0, most / np.maximum(lengths, 1e-300))[:, None]
            positions += steps
        close = np.abs(gaps).max(axis=1) < SOLVED * self._problem.domain.scale
        return points, is_there & close


def bounds_of(labels: np.ndarray, n: int) -> np.ndarray:
    """Along which of 2 n bounds (k, 2 n) edges with ``labels`` (k,) run."""
    on_bound: np.ndarray = BORDER - labels[:, None] == np.arange(2 * n)
    return on_bound
