"""A curve while it is followed: its pieces so far, and how cautiously it goes on."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch, Outcome, point_and_slope
from bifurc.system import March, Piece, System


class BridgeRule(Enum):
    """Where a bridge is tried when no step is left."""

    # Where a singular point can be located.
    AT_SINGULAR_POINTS = "at singular points"
    # Whatever is there.
    ANYWHERE = "anywhere"
    # Not at all: the track ends.
    NOWHERE = "nowhere"


@dataclass(frozen=True)
class Caution:
    """The trusted radius, in scales, below which no step is taken, and where a bridge
    is tried then."""

    shortest: float
    bridges: BridgeRule


# Next to a crossing rounding bends the curve F = 1e-16 from one branch into the other:
# a radius below the first of these is taken for a sign of one, and a smooth piece
# across is tried where a singular point can be located; below the second, where steps
# come to what rounding leaves of them, it is tried in any case.
CAUTIOUS = (
    Caution(1e-4, BridgeRule.AT_SINGULAR_POINTS),
    Caution(1e-6, BridgeRule.ANYWHERE),
    Caution(0.0, BridgeRule.NOWHERE),
)


MOST_STALLS = 15  # that are overcome on the way along one curve


class Place(NamedTuple):
    """A ``point`` (n,) of a curve and the unit ``tangent`` (n,) there."""

    point: np.ndarray
    tangent: np.ndarray


class SplitCurve(System):
    """A system whose curve may split where it is not single, and leads straight on
    there."""

    @abstractmethod
    def missed(self, points: np.ndarray) -> np.ndarray:
        """What points (k, n) miss where the curve is not single (k,), else 0."""

    @abstractmethod
    def bridge(
        self, start: np.ndarray, heading: np.ndarray, width: float, order: int
    ) -> Piece | None:
        """One piece of about ``width`` from ``start`` (n,) along ``heading`` (n,), None
        where there is none."""


class Bridge(NamedTuple):
    """A ``piece`` that begins at arclength ``begin`` of a track, within piece number
    ``last``."""

    last: int
    begin: float
    piece: Piece


class End(NamedTuple):
    """Why a curve ends, and its stretch of the track: the arclengths from ``begin`` to
    ``stop``."""

    outcome: Outcome
    stop: float
    begin: float = 0.0


class Track:
    """A curve while it is followed: its pieces so far, with the arclengths of their
    ``centers`` (k,), and how cautiously it goes on."""

    def __init__(self, start: Place, order: int, has_crossings: bool = True):
        self._start = start
        self._cautions = CAUTIOUS if has_crossings else CAUTIOUS[-1:]
        self._level = 0
        self._stalls = 0
        self.pieces = np.empty((0, order + 1, len(start.point)))
        self.centers = np.empty(0)
        self.radii = np.empty(0)
        self.residuals = np.empty(0)

    def __len__(self) -> int:
        return len(self.pieces)

    @property
    def order(self) -> int:
        """Order of the pieces."""
        return self.pieces.shape[1] - 1

    @property
    def reached(self) -> float:
        """Arclength up to which the last piece is trusted."""
        if not len(self):
            return 0.0
        return float(self.centers[-1] + self.radii[-1])

    @property
    def last_width(self) -> float:
        """Arclength of the last piece; infinite where there is none."""
        return float(2 * self.radii[-1]) if len(self) else np.inf

    @property
    def front(self) -> Place:
        """Where the next piece begins."""
        return self.at(-1, self.reached) if len(self) else self._start

    @property
    def begin(self) -> Place:
        """Where the first piece begins."""
        return self.at(0, 0.0) if len(self) else self._start

    @property
    def is_at_a_bend(self) -> bool:
        """Whether steps are taken that would be a sign of a singular point elsewhere."""
        return self._level > 0

    @property
    def caution(self) -> Caution:
        """How cautiously the next pieces are made."""
        return self._cautions[self._level]

    def at(self, number: int, s: float) -> Place:
        """The place on piece ``number`` at arclength ``s``."""
        x = (s - self.centers[number]) / self.radii[number]
        point, slope = point_and_slope(self.pieces[number], x)
        return Place(point, slope / np.linalg.norm(slope))

    def piece_at(self, s: float) -> int:
        """Number of the piece whose centre is nearest to arclength ``s``, over its
        radius: pieces reach back as well as on."""
        distances = np.abs(self.centers - s)
        return int(np.argmin(distances / self.radii))

    def breaks(self, stop: float) -> np.ndarray:
        """Where neighbouring pieces hand over (k + 1,), from 0 to ``stop``: at equal
        fractions of their radii."""
        radii_before, radii_after = self.radii[:-1], self.radii[1:]
        shares = radii_before / (radii_before + radii_after)
        inner = self.centers[:-1] + shares * (self.centers[1:] - self.centers[:-1])
        return np.concatenate([[0.0], inner, [stop]])

    def append(self, march: March) -> None:
        """The track goes on with the pieces of a march from its front."""
        centers = self.reached + march.steps.cumsum()
        residuals = march.residuals[: len(march.pieces)]  # not the gap of an open one
        if not len(self):
            self.pieces, self.centers = march.pieces, centers
            self.radii, self.residuals = march.radii, residuals
            return
        self.pieces = np.concatenate([self.pieces, march.pieces])
        self.centers = np.concatenate([self.centers, centers])
        self.radii = np.concatenate([self.radii, march.radii])
        self.residuals = np.concatenate([self.residuals, residuals])

    def append_bridge(self, bridge: Bridge) -> None:
        """The track goes on with a bridge; pieces after its begin are dropped."""
        kept = slice(bridge.last + 1)
        radius = bridge.piece.length / 2
        piece = bridge.piece.coefficients[None]
        self.pieces = np.concatenate([self.pieces[kept], piece])
        self.centers = np.append(self.centers[kept], bridge.begin + radius)
        self.radii = np.append(self.radii[kept], radius)
        self.residuals = np.append(self.residuals[kept], bridge.piece.residual)

    def may_overcome_stall(self) -> bool:
        """Whether it is worth trying to get over one more stall.

        A curve meets a few singular points. What stalls again and again is rounding,
        followed where nothing else is left of the equations.
        """
        self._stalls += 1
        return self._stalls <= MOST_STALLS

    @property
    def may_take_shorter_steps(self) -> bool:
        """Whether there are shorter steps than those that are taken."""
        return self._level + 1 < len(self._cautions)

    def allow_shorter_steps(self) -> None:
        """There is no singular point to jump over: a sharp bend, to be followed."""
        self._level += 1

    def allow_long_steps_only(self) -> None:
        """The bend is passed, and short steps are a sign of a singular point again."""
        self._level = 0

    def branch(self, end: End, periods: np.ndarray) -> Branch:
        """The branch of the pieces between the ends of the curve."""
        if not end.stop > end.begin:  # it leaves the region where it starts
            return self.empty_branch(end.outcome, periods)
        breaks = self.breaks(end.stop)
        first = breaks[1:].searchsorted(end.begin, side="right")
        beyond = breaks[:-1].searchsorted(end.stop)
        kept = slice(first, beyond)
        inner = breaks[kept][1:] - end.begin
        length = end.stop - end.begin
        return Branch(
            pieces=self.pieces[kept],
            centers=self.centers[kept] - end.begin,
            radii=self.radii[kept],
            breaks=np.concatenate([[0.0], inner, [length]]),
            residuals=self.residuals[kept],
            periods=periods,
            outcome=end.outcome,
        )

    def empty_branch(
        self, outcome: Outcome, periods: np.ndarray, gap: float = 0.0
    ) -> Branch:
        """A branch of no pieces, for a start at which ``gap`` is left."""
        nothing = np.empty(0)
        return Branch(
            pieces=self.pieces[:0],
            centers=nothing,
            radii=nothing,
            breaks=np.zeros(1),
            residuals=nothing,
            periods=periods,
            outcome=outcome,
            gap=gap,
        )
