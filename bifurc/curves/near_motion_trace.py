"""What is known of a near motion, and of a near surface, once it is traced."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.decisions import is_same_point
from bifurc.numerics.singular_values import singular_values
from bifurc.system import System

# Times the root of the residual: how far a point may lie beside a near motion on a bridge.
SPREAD = 4.0
# Times the tolerance over the smallest regular singular value: how far elsewhere. Times
# the tolerance: residuals of pieces that are no bridges.
KNOWN, EXACT = 20.0, 30.0
TINY = 1e-300
UNFINISHED = (Outcome.STALLED, Outcome.STEP_LIMIT, Outcome.TIME_LIMIT)


@dataclass(frozen=True)
class NearMotionTrace:
    """A curve along which a system is nearly solved.

    ``branch``: as far as it nearly closes, or all round if it is closed; where it
    ``is_short`` it counts as none. The least residuals across it go up to
    ``misclosure``, over the magnitude; where it passes a place at which the rank drops
    it ``is_blurred`` there, and what it misses is looked for before and beyond. Where
    it ``is_repeated`` it passes stretches twice, as no curve does: it went over to
    another one, and its length is wrong. At the ``assemblies`` (k, n) on it the system
    is solved. ``tolerance``: how closely it was followed.
    """

    branch: Branch
    misclosure: float
    is_short: bool
    is_blurred: bool
    is_repeated: bool
    assemblies: np.ndarray
    tolerance: float

    @property
    def has_loose_end(self) -> bool:
        """Whether it stops where it neither closes nor misses too much."""
        return self.branch.outcome in UNFINISHED

    def runs_through(self, problem: System, points: np.ndarray) -> np.ndarray:
        """Which of the points (k, n) lie on it, as far as it is known there."""
        within = SPREAD * np.sqrt(self.misclosure * problem.domain.scale)
        distance, s = self.branch.nearest(
            points, within=max(within, problem.domain.scale)
        )
        number = np.searchsorted(self.branch.breaks, s, side="right") - 1
        number = np.clip(number, 0, len(self.branch.pieces) - 1)
        misses = self.branch.residuals[number]
        is_bridge = bridges_of(self.branch, self.tolerance)[number]
        weakest = singular_values(problem, points)[:, max(problem.n - 2, 0)]
        known = KNOWN * self.tolerance / np.maximum(weakest, TINY)
        reach = np.where(
            is_bridge, SPREAD * np.sqrt(misses * problem.domain.scale), known
        )
        reach = np.clip(reach, is_same_point.threshold * problem.domain.scale, within)
        is_on: np.ndarray = distance < reach
        return is_on


def bridges_of(branch: Branch, tolerance: float) -> np.ndarray:
    """Which pieces (p,) of a near motion followed to a ``tolerance`` lead straight on
    where the valley is not single."""
    is_bridge: np.ndarray = branch.residuals > EXACT * tolerance
    return is_bridge


@dataclass(frozen=True)
class NearSurface:
    """A component of a ``dimension`` all over which a system is nearly solved.

    The least residuals across it, at the places looked at, go up to ``misclosure``,
    over the magnitude. ``sample`` (n,) is one of these places.
    """

    dimension: int
    misclosure: float
    sample: np.ndarray
