"""A traced curve as a piecewise polynomial of its arclength."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bifurc._core import Curve
from bifurc.checks import check_distance, check_finite, check_whole, floats_of
from bifurc.decisions import hides_turning, jumps_at_turning
from bifurc.errors import ProblemError
from bifurc.tables import count_of
from bifurc.torus import whole_turns

SLIVER = 1e-3  # of its radius: so little of a piece is left to the next one
SAME_PASS = 1e-6  # arclength: feet no farther apart are one
RATES_SEEN = 64  # places of a curve at which its rates are seen


class Outcome(Enum):
    """Why tracing ended, with what to do next."""

    CLOSED = "closed: the curve came back to its start"
    LEFT_REGION = (
        "left the region: both ends lie on the bounds; "
        "widen the bounds to follow it further"
    )
    ENDS_AT_A_POINT = (
        "ends at a point: at a cusp or another singular point that is listed, or at two; "
        "an end that is at none lies on the bounds"
    )
    STALLED = (
        "stalled: no trusted step is left; "
        "look for a cusp or a singular point of higher order at the end"
    )
    STEP_LIMIT = (
        "step limit: the curve is longer than the allowed length; raise max_length"
    )
    TIME_LIMIT = "time limit: the curve goes on; raise the budget"
    OPEN = (
        "closure gap: the start does not solve the equations; "
        "correct the start or the geometry"
    )


class Turning(NamedTuple):
    """A zero of the rate of an unknown at arclength ``s``; from ``low`` to ``high``
    rounding hides the rate. Its sign ``before`` and ``after`` that, 0 beyond an end of
    the curve."""

    s: float
    low: float
    high: float
    before: float
    after: float


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
            f" {count_of(len(self.pieces), 'piece')}, largest residual {self.max_residual:.2g}>"
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
    def trusted_length(self) -> float:
        """Arclength from where the first piece is trusted to where the last one is,
        which may be beyond the ends of an open curve; 0 without pieces."""
        if not len(self.pieces):
            return 0.0
        begin = self.centers[0] - self.radii[0]
        end = self.centers[-1] + self.radii[-1]
        return float(end - begin)

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
        a closed curve.

        Raises `ProblemError` for an arclength that is no number, or beyond an end of an
        open curve.
        """
        if derivative != 0:
            check_whole("derivative", derivative, 0)
        try:
            s = np.asarray(s, dtype=float)
            points = self.compiled.evaluate(s.ravel(), derivative)
        except (TypeError, ValueError) as error:
            allowed = "a number" if self.closed else f"from 0 to {self.length:.6g}"
            raise ProblemError("arclength", s, allowed) from error
        return points if s.ndim == 1 else points.reshape(*s.shape, self.n)

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
        return replace(
            self,
            pieces=(self.pieces * signs[:, None])[::-1],
            centers=(self.length - self.centers)[::-1],
            radii=self.radii[::-1],
            breaks=(self.length - self.breaks)[::-1],
            residuals=self.residuals[::-1],
        )

    def begun_at(self, s: float) -> Branch:
        """The same closed curve with its arclengths counted from ``s``, which is taken
        modulo the length.

        The piece that holds ``s`` comes first and, as far as ``s``, last. Raises
        `ProblemError` for an open curve, and for an ``s`` that is not finite.
        """
        if not self.closed:
            raise ProblemError("outcome", self.outcome.name, "a closed curve")
        check_finite("s", s)
        s %= self.length
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
        """The same curve with whole numbers (n,) of periods added to the unknowns.

        Raises `ProblemError` for anything else.
        """
        turns = np.asarray(turns)
        if turns.shape != (self.n,) or not np.all(turns == np.round(turns)):
            raise ProblemError("turns", turns, f"{self.n} whole numbers")
        pieces = self.pieces.copy()
        moving = turns != 0
        pieces[:, 0, moving] += turns[moving] * self.periods[moving]
        return replace(self, pieces=pieces)

    # --- feet of points ---------------------------------------------------------------

    def nearest(
        self, points: np.ndarray, within: float = np.inf
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance (k,) of each point (k, n) to the curve modulo the periods, and the
        arclength (k,) there.

        The distance of a point no nearer than ``within`` is infinite, and its arclength
        0. Nothing is near a branch of no pieces. Raises `ProblemError` for points of
        another shape or not finite.
        """
        points = np.atleast_2d(floats_of("points", points))
        if points.ndim != 2 or points.shape[1] != self.n:
            raise ProblemError("shape of the points", points.shape, f"(k, {self.n})")
        check_finite("points", points)
        check_distance("within", within)
        return self.compiled.nearest(points, within)

    def passes(self, point: np.ndarray, within: float) -> np.ndarray:
        """All arclengths at which the curve passes ``point`` (n,) at a distance below
        ``within``, in order."""
        point = floats_of("point", point)
        if point.shape != (self.n,):
            raise ProblemError("shape of the point", point.shape, f"({self.n},)")
        check_finite("point", point)
        check_distance("within", within)
        return self.compiled.passes(point, within, SAME_PASS)

    def turnings(self, unknown: int) -> tuple[Turning, ...]:
        """Where the rate of an ``unknown`` (from 0) changes sign, in order, and the ends
        of an open curve at which it is zero.

        None is missed, by bounds on the polynomials; but where it only touches zero as
        far as rounding tells there is none. Raises `ProblemError` for an unknown that
        there is not.
        """
        check_whole("unknown", unknown, 0)
        if unknown >= self.n:
            raise ProblemError("unknown", unknown, f"below {self.n}")
        if unknown not in self._turnings:
            rows = self.compiled.turnings(
                unknown, share=hides_turning.threshold, jump=jumps_at_turning.threshold
            )
            self._turnings[unknown] = tuple(Turning(*row) for row in rows.tolist())
        return self._turnings[unknown]

    def turning_points(self, unknown: int) -> np.ndarray:
        """Arclengths, in order, at which the derivative of an ``unknown`` (from 0)
        changes sign, all of them as `turnings` says."""
        turnings = self.turnings(unknown)
        return np.array([one.s for one in turnings if one.before * one.after < 0.0])

    # --- what is derived from the pieces ----------------------------------------------

    @cached_property
    def compiled(self) -> Curve:
        """The curve in compiled form."""
        travel = self.travel if self.closed else np.empty(0)
        return Curve(
            breaks=self.breaks,
            centers=self.centers,
            radii=self.radii,
            pieces=self.pieces,
            periods=self.periods,
            travel=travel,
        )

    def __getstate__(self) -> dict[str, object]:
        """What a copy is made of: all but the compiled curve."""
        state = dict(vars(self))
        state.pop("compiled", None)
        return state

    @cached_property
    def _turnings(self) -> dict[int, tuple[Turning, ...]]:
        """Those of the unknowns that were asked for."""
        return {}

    @cached_property
    def largest_rates(self) -> np.ndarray:
        """The largest rate |du_i/ds| (n,) of every unknown, as seen at places all along
        the curve."""
        rates = np.abs(self(self.arclengths(RATES_SEEN), 1))
        largest: np.ndarray = rates.max(axis=0)
        return largest

    @cached_property
    def ends(self) -> np.ndarray:
        """Where the curve begins and where it ends (2, n)."""
        ends = [0, -1]
        offsets = self.breaks[ends] - self.centers[ends]
        x = offsets / self.radii[ends]
        exponents = np.arange(self.pieces.shape[1])
        powers = x[:, None] ** exponents
        points: np.ndarray = np.einsum("ek,ekn->en", powers, self.pieces[ends])
        return points

    @property
    def travel(self) -> np.ndarray:
        """What each unknown (n,) gains from the begin to the end of the curve."""
        begin, end = self.ends
        travel: np.ndarray = end - begin
        return travel


def points_on_piece(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (k, n) of one piece (order + 1, n) at coordinates x (k,) in [-1, 1]."""
    points: np.ndarray = np.vander(x, len(piece), increasing=True) @ piece
    return points


def points_on_pieces(pieces: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (p, k, n) of pieces (p, order + 1, n) at coordinates x (p, k), k of
    each."""
    powers = np.vander(x.ravel(), pieces.shape[1], increasing=True)
    points: np.ndarray = powers.reshape(*x.shape, -1) @ pieces
    return points


def point_and_slope(piece: np.ndarray, x: float) -> tuple[np.ndarray, np.ndarray]:
    """Point (n,) of one piece (order + 1, n) and its derivative (n,) in the coordinate
    at ``x``."""
    order = len(piece) - 1
    powers = x ** np.arange(order + 1)
    slope = (np.arange(1, order + 1) * powers[:-1]) @ piece[1:]
    return powers @ piece, slope
