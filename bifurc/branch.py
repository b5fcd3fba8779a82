"""A traced curve as a piecewise polynomial of its arclength."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from bifurc.pieces import evaluate, feet

__all__ = ["Branch", "Outcome"]


class Outcome(Enum):
    """Why tracing ended, with what to do next."""

    CLOSED = "closed: the curve came back to its start"
    LEFT_REGION = "left the region: both ends lie on the bounds; widen the bounds to follow it further"
    STALLED = "stalled: no trusted step is left; look for a cusp or a singular point of higher order at the end"
    STEP_LIMIT = (
        "step limit: the curve is longer than the allowed length; raise max_length"
    )
    OPEN = "closure gap: the start does not solve the equations; correct the start or the geometry"


@dataclass(frozen=True)
class Branch:
    """A smooth solution curve u(s), s the arclength from 0 to ``length``.

    ``pieces`` (k, order + 1, n) are polynomial coefficients in (s - centers[i]) /
    radii[i]; piece i is used from breaks[i] to breaks[i + 1]. ``residuals`` (k,) bound
    the relative residual on each piece as sampled when it was made; ``gap`` is the
    residual at a start that could not be corrected.
    """

    pieces: np.ndarray
    centers: np.ndarray
    radii: np.ndarray
    breaks: np.ndarray
    residuals: np.ndarray
    periods: np.ndarray
    outcome: Outcome
    gap: float = field(default=0.0)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return self.pieces.shape[2]

    @property
    def length(self) -> float:
        """Arclength of the whole curve."""
        return float(self.breaks[-1])

    @property
    def closed(self) -> bool:
        """Whether the curve comes back to its start (modulo the periods)."""
        return self.outcome is Outcome.CLOSED

    @property
    def max_residual(self) -> float:
        """Largest relative residual seen on any piece."""
        return float(self.residuals.max(initial=self.gap))

    def __call__(self, s: np.ndarray | float, derivative: int = 0) -> np.ndarray:
        """u(s), or its derivative in s, shape (..., n); s is taken modulo the length of
        a closed curve."""
        s = np.asarray(s, dtype=float)
        return evaluate(
            self._curve, np.ascontiguousarray(s.ravel()), derivative
        ).reshape(*s.shape, self.n)

    @cached_property
    def _curve(self) -> tuple[np.ndarray, ...]:
        """The curve as the kernels of `bifurc.pieces` take it."""
        travel = self._ends[1] - self._ends[0] if self.closed else np.empty(0)
        arrays = (self.breaks, self.centers, self.radii, self.pieces, travel)
        return tuple(
            np.require(array, dtype=float, requirements=["C", "W"]) for array in arrays
        )

    @cached_property
    def _ends(self) -> np.ndarray:
        x = (self.breaks[[0, -1]] - self.centers[[0, -1]]) / self.radii[[0, -1]]
        powers = x[:, None] ** np.arange(self.pieces.shape[1])
        return np.einsum("ek,ekn->en", powers, self.pieces[[0, -1]])

    @cached_property
    def winding(self) -> np.ndarray:
        """Turns (n,) that each periodic unknown makes along a closed curve; 0 for the
        others and for open curves."""
        turns = np.zeros(self.n, dtype=int)
        if self.closed:
            periodic = np.isfinite(self.periods)
            travel = self._ends[1] - self._ends[0]
            turns[periodic] = np.rint(travel[periodic] / self.periods[periodic]).astype(
                int
            )
        return turns

    def arclengths(self, count: int) -> np.ndarray:
        """``count`` equally spaced arclengths; a closed curve's last one stops short of
        the start."""
        return np.linspace(0.0, self.length, count, endpoint=not self.closed)

    def sample(self, count: int) -> np.ndarray:
        """Points (count, n) at equally spaced arclengths."""
        return self(self.arclengths(count))

    @cached_property
    def _index(self) -> tuple[cKDTree, np.ndarray, np.ndarray]:
        s = np.concatenate(
            [
                np.linspace(a, b, 12, endpoint=False)
                for a, b in zip(self.breaks[:-1], self.breaks[1:], strict=True)
            ]
            + [self.breaks[-1:]]
        )
        box = np.where(np.isfinite(self.periods), self.periods, 0.0)
        return cKDTree(_into_box(self(s), box), boxsize=box), s, box

    def nearest(
        self, points: np.ndarray, neighbours: int = 3, within: float = np.inf
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance (k,) of each point (k, n) to the curve modulo the periods, and the
        arclength (k,) there.

        Of a point farther away than ``within`` it is only said that it is, which takes
        a twentieth of the time.
        """
        points = np.atleast_2d(np.asarray(points, dtype=float))
        tree, grid, box = self._index
        count, spacing = min(neighbours, len(grid)), np.diff(grid).max()
        reach = (
            max(within, spacing) + spacing
        )  # of a sample next to a foot that is near enough
        found = tree.query(_into_box(points, box), k=count, distance_upper_bound=reach)
        distance, near = (np.reshape(a, (len(points), count)) for a in found)
        s = grid[
            np.minimum(near, len(grid) - 1)
        ]  # there is no sample of that number where none is in reach
        close = (
            distance[:, 0] < 2 * spacing
        )  # the others are surely off the curve: the nearest sample will do
        if np.any(close):
            targets = np.repeat(points[close], count, axis=0)
            at, apart = feet(
                self._curve, targets, s[close].ravel(), 2 * spacing, self.periods, 5
            )
            s[close], distance[close] = at.reshape(-1, count), apart.reshape(-1, count)
        best, rows = np.argmin(distance, axis=1), np.arange(len(points))
        distance, s = distance[rows, best], s[rows, best]
        # beside a crossing the nearest samples may all lie on another pass: try every
        # one that can lead to the foot
        for i in np.flatnonzero(close & (distance > 1e-7 * spacing)):
            around = grid[
                tree.query_ball_point(_into_box(points[i], box), distance[i] + spacing)
            ]
            at, apart = feet(
                self._curve,
                np.tile(points[i], (len(around), 1)),
                around,
                2 * spacing,
                self.periods,
                8,
            )
            if apart.min(initial=np.inf) < distance[i]:
                distance[i], s[i] = apart.min(), at[np.argmin(apart)]
        return distance, s

    def passes(self, point: np.ndarray, within: float) -> np.ndarray:
        """All arclengths at which the curve passes ``point`` (n,) at a distance below
        ``within``, in order."""
        tree, grid, box = self._index
        spacing = np.diff(grid).max()
        near = tree.query_ball_point(_into_box(point, box), 2.5 * spacing + within)
        targets = np.tile(np.asarray(point, dtype=float), (len(near), 1))
        s, distance = feet(self._curve, targets, grid[near], spacing, self.periods, 8)
        s = np.sort(s[distance < within])
        apart = np.diff(
            s, prepend=s[-1] - self.length if self.closed and len(s) > 1 else -np.inf
        )
        return s[apart > 1e-6]

    def reversed(self) -> Branch:
        """The same curve run the other way."""
        signs = (-1.0) ** np.arange(self.pieces.shape[1])
        return Branch(
            (self.pieces * signs[:, None])[::-1],
            (self.length - self.centers)[::-1],
            self.radii[::-1],
            (self.length - self.breaks)[::-1],
            self.residuals[::-1],
            self.periods,
            self.outcome,
            self.gap,
        )


def _into_box(points: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Points with periodic unknowns taken into [0, box)."""
    out = np.array(points, dtype=float)
    periodic = box > 0
    if np.all(
        periodic
    ):  # as in every loop: picking columns would take most of the time
        out %= box
        return np.where(out >= box, 0.0, out)
    out[..., periodic] %= box[periodic]
    out[..., periodic] = np.where(
        out[..., periodic] >= box[periodic], 0.0, out[..., periodic]
    )
    return out
