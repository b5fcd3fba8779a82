"""A traced curve as a piecewise polynomial of its arclength."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bifurc.checks import check_whole
from bifurc.errors import ProblemError
from bifurc.pieces import evaluate, feet
from bifurc.torus import into_box, tree_box, whole_turns

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = ["Branch", "Outcome"]

SAMPLES = 12  # of a piece, from which the feet of points are looked for
FOOT_STEPS = 5  # of Newton's method from a sample to a foot
PATIENT_FOOT_STEPS = 8  # where the foot may be as far away as a sample's neighbour
ON_THE_CURVE = 1e-7  # of the spacing of samples: so far off a point is still on it
SLIVER = 1e-3  # of its radius: so little of a piece is left to the next one
SAME_PASS = 1e-6  # arclength: feet no farther apart are one


class Outcome(Enum):
    """Why tracing ended, with what to do next."""

    CLOSED = "closed: the curve came back to its start"
    LEFT_REGION = (
        "left the region: both ends lie on the bounds; "
        "widen the bounds to follow it further"
    )
    STALLED = (
        "stalled: no trusted step is left; "
        "look for a cusp or a singular point of higher order at the end"
    )
    STEP_LIMIT = (
        "step limit: the curve is longer than the allowed length; raise max_length"
    )
    OPEN = (
        "closure gap: the start does not solve the equations; "
        "correct the start or the geometry"
    )


@dataclass(frozen=True, eq=False, repr=False)
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

    def __repr__(self) -> str:
        winding = ", ".join(str(turns) for turns in self.winding)
        return (
            f"<Branch in {self.n} unknowns, {self.outcome.value}\n"
            f" length {self.length:.6g}, winding ({winding})\n"
            f" {len(self.pieces)} pieces, largest residual {self.max_residual:.2g}>"
        )

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return int(self.pieces.shape[2])

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

    @cached_property
    def winding(self) -> np.ndarray:
        """Turns (n,) that each periodic unknown makes along a closed curve; 0 for the
        others and for open curves."""
        if not self.closed:
            return np.zeros(self.n, dtype=int)
        return whole_turns(self.travel, self.periods)

    @property
    def gained(self) -> np.ndarray:
        """What each unknown (n,) gains in one turn of a closed curve: `travel` without
        its rounding."""
        gained = np.zeros(self.n)
        turning = self.winding != 0
        gained[turning] = self.winding[turning] * self.periods[turning]
        return gained

    # --- points -----------------------------------------------------------------------

    def __call__(self, s: np.ndarray | float, derivative: int = 0) -> np.ndarray:
        """u(s), or its derivative in s, shape (..., n); s is taken modulo the length of
        a closed curve."""
        if derivative < 0:
            raise ProblemError("derivative", derivative, "0 or more")
        s = np.asarray(s, dtype=float)
        flat = np.ascontiguousarray(s.ravel())
        points: np.ndarray = evaluate(self._curve, flat, derivative)
        return points.reshape(*s.shape, self.n)

    def arclengths(self, count: int) -> np.ndarray:
        """``count`` equally spaced arclengths; a closed curve's last one stops short of
        the start."""
        check_whole("count", count, 0)
        return np.linspace(0.0, self.length, count, endpoint=not self.closed)

    def sample(self, count: int) -> np.ndarray:
        """Points (count, n) at equally spaced arclengths."""
        return self(self.arclengths(count))

    def places(self, fractions: np.ndarray) -> np.ndarray:
        """Arclengths (p, k) at ``fractions`` (k,) of each of the p pieces, from 0 where
        it begins to 1 where it ends."""
        begins = self.breaks[:-1, None]
        lengths = np.diff(self.breaks)[:, None]
        places: np.ndarray = begins + lengths * fractions
        return places

    def reversed(self) -> Branch:
        """The same curve run the other way."""
        signs = (-1.0) ** np.arange(self.pieces.shape[1])
        pieces = self.pieces * signs[:, None]
        centers = self.length - self.centers
        breaks = self.length - self.breaks
        return Branch(
            pieces=pieces[::-1],
            centers=centers[::-1],
            radii=self.radii[::-1],
            breaks=breaks[::-1],
            residuals=self.residuals[::-1],
            periods=self.periods,
            outcome=self.outcome,
            gap=self.gap,
        )

    def begun_at(self, s: float) -> Branch:
        """The same closed curve with its arclengths counted from ``s``.

        The piece that holds ``s`` comes first and, as far as ``s``, last. Raises
        `ProblemError` for an open curve.
        """
        if not self.closed:
            raise ProblemError("outcome", self.outcome.name, "a closed curve")
        count = len(self.pieces)
        first, last = self._pieces_around(s)
        numbers = np.arange(first, last + count + 1)
        turns, kept = np.divmod(numbers, count)
        ahead = turns * self.length - s
        pieces = self.pieces[kept]
        pieces[:, 0] += turns[:, None] * self.gained
        inner = self.breaks[kept + 1] + ahead
        return replace(
            self,
            pieces=pieces,
            centers=self.centers[kept] + ahead,
            radii=self.radii[kept],
            breaks=np.concatenate([[0.0], inner[:-1], [self.length]]),
            residuals=self.residuals[kept],
        )

    def _pieces_around(self, s: float) -> tuple[int, int]:
        """Numbers of the pieces that begin and end a closed curve cut at ``s``: one and
        the same, but where one part of it would be a sliver."""
        number = int(np.searchsorted(self.breaks, s, side="right")) - 1
        number = min(max(number, 0), len(self.pieces) - 1)
        sliver = SLIVER * self.radii[number]
        first, last = number, number
        if self.breaks[number + 1] - s < sliver:
            first += 1
        elif s - self.breaks[number] < sliver:
            last -= 1
        return first, last

    def moved_by_periods(self, turns: np.ndarray) -> Branch:
        """The same curve with whole numbers (n,) of periods added to the unknowns."""
        pieces = self.pieces.copy()
        moving = turns != 0
        pieces[:, 0, moving] += turns[moving] * self.periods[moving]
        return replace(self, pieces=pieces)

    # --- feet of points ---------------------------------------------------------------

    def nearest(
        self, points: np.ndarray, neighbours: int = 3, within: float = np.inf
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance (k,) of each point (k, n) to the curve modulo the periods, and the
        arclength (k,) there.

        Of a point farther away than ``within`` it is only said that it is, which takes
        a twentieth of the time. Nothing is near a branch of no pieces. Raises
        `ProblemError` for points of another shape or not finite.
        """
        points = np.atleast_2d(np.asarray(points, dtype=float))
        if points.ndim != 2 or points.shape[1] != self.n:
            raise ProblemError("shape of the points", points.shape, f"(k, {self.n})")
        if not np.all(np.isfinite(points)):
            raise ProblemError("points", points, "finite")
        if not len(self.pieces):
            return np.full(len(points), np.inf), np.zeros(len(points))
        samples = self._samples
        spacing = samples.spacing
        # next to a foot that is near enough there is a sample in reach
        reach = max(within, spacing) + spacing
        count = min(neighbours, len(samples.arclengths))
        distances, s = samples.nearest(points, count, reach)
        # of the other points, surely off the curve, the nearest sample will do
        is_close = distances[:, 0] < 2 * spacing
        if np.any(is_close):
            repeated = np.repeat(points[is_close], count, axis=0)
            feet_s, feet_distances = self._feet(
                repeated, s[is_close].ravel(), 2 * spacing, FOOT_STEPS
            )
            s[is_close] = feet_s.reshape(-1, count)
            distances[is_close] = feet_distances.reshape(-1, count)
        best = (np.arange(len(points)), np.argmin(distances, axis=1))
        distance = distances[best]
        s = s[best]
        in_doubt = is_close & (distance > ON_THE_CURVE * spacing)
        for i in np.flatnonzero(in_doubt):
            foot = self._nearest_on_all_passes(points[i], distance[i], s[i])
            distance[i], s[i] = foot
        return distance, s

    def _nearest_on_all_passes(
        self, point: np.ndarray, distance: float, s: float
    ) -> tuple[float, float]:
        """Distance of a point (n,) to the curve and the arclength there, where a foot
        at ``distance`` and ``s`` is known.

        Beside a crossing the nearest samples may all lie on another pass: every sample
        that can lead to the foot is tried.
        """
        samples = self._samples
        starts = samples.within(point, distance + samples.spacing)
        repeated = np.tile(point, (len(starts), 1))
        feet_s, distances = self._feet(
            repeated, starts, 2 * samples.spacing, PATIENT_FOOT_STEPS
        )
        if not distances.min(initial=np.inf) < distance:
            return distance, s
        best = np.argmin(distances)
        return distances[best], feet_s[best]

    def passes(self, point: np.ndarray, within: float) -> np.ndarray:
        """All arclengths at which the curve passes ``point`` (n,) at a distance below
        ``within``, in order."""
        point = np.asarray(point, dtype=float)
        samples = self._samples
        starts = samples.within(point, 2.5 * samples.spacing + within)
        repeated = np.tile(point, (len(starts), 1))
        feet_s, distances = self._feet(
            repeated, starts, samples.spacing, PATIENT_FOOT_STEPS
        )
        s = np.sort(feet_s[distances < within])
        before_first = -np.inf
        if self.closed and len(s) > 1:
            before_first = s[-1] - self.length
        steps = np.diff(s, prepend=before_first)
        return s[steps > SAME_PASS]

    def _feet(
        self, points: np.ndarray, s: np.ndarray, reach: float, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Arclengths (k,) near ``s`` (k,) where the curve is nearest to points (k, n),
        and the distances (k,) there; no step is longer than ``reach``."""
        arclengths, distances = feet(self._curve, points, s, reach, self.periods, steps)
        return arclengths, distances

    # --- what is derived from the pieces ----------------------------------------------

    @cached_property
    def _curve(self) -> tuple[np.ndarray, ...]:
        """The curve as the kernels of `bifurc.pieces` take it."""
        travel = self.travel if self.closed else np.empty(0)
        arrays = (self.breaks, self.centers, self.radii, self.pieces, travel)
        return tuple(np.require(array, float, ["C", "W"]) for array in arrays)

    @cached_property
    def travel(self) -> np.ndarray:
        """What each unknown (n,) gains from the begin to the end of the curve."""
        ends = [0, -1]
        offsets = self.breaks[ends] - self.centers[ends]
        x = offsets / self.radii[ends]
        exponents = np.arange(self.pieces.shape[1])
        powers = x[:, None] ** exponents
        begin, end = np.einsum("ek,ekn->en", powers, self.pieces[ends])
        travel: np.ndarray = end - begin
        return travel

    @cached_property
    def _samples(self) -> _Samples:
        """Samples of every piece, for the search of feet."""
        on_pieces = self.places(np.arange(SAMPLES) / SAMPLES)
        arclengths = np.append(on_pieces.ravel(), self.length)
        return _Samples.of(self(arclengths), arclengths, self.periods)


@dataclass(frozen=True)
class _Samples:
    """Points of a curve in a tree, modulo the periods, with their ``arclengths`` (k,);
    ``spacing`` is the largest distance of two neighbours along the curve."""

    tree: cKDTree
    arclengths: np.ndarray
    spacing: float
    periods: np.ndarray

    @staticmethod
    def of(points: np.ndarray, arclengths: np.ndarray, periods: np.ndarray) -> _Samples:
        """The samples ``points`` (k, n) at ``arclengths`` (k,)."""
        # takes as long to import as all the rest of this package, and tracing alone
        # does not need it
        from scipy.spatial import cKDTree

        tree = cKDTree(into_box(points, periods), boxsize=tree_box(periods))
        spacing = np.diff(arclengths).max()
        return _Samples(tree, arclengths, spacing, periods)

    def nearest(
        self, points: np.ndarray, count: int, reach: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distances and arclengths (k, count) of the samples nearest to points (k, n);
        the distance is infinite where none is in ``reach``."""
        inside = into_box(points, self.periods)
        distances, numbers = self.tree.query(
            inside, k=count, distance_upper_bound=reach
        )
        shape = (len(points), count)
        last = len(self.arclengths) - 1  # the tree gives a larger one for none in reach
        arclengths = self.arclengths[np.minimum(numbers, last)]
        return np.reshape(distances, shape), np.reshape(arclengths, shape)

    def within(self, point: np.ndarray, reach: float) -> np.ndarray:
        """Arclengths (j,) of all samples in ``reach`` of a point (n,)."""
        inside = into_box(point, self.periods)
        numbers = self.tree.query_ball_point(inside, reach)
        near: np.ndarray = self.arclengths[numbers]
        return near
