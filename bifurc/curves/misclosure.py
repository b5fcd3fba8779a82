"""By how much a system is not solved along a curve on which it is nearly solved.

The redundant equations of a linkage agree as far as its geometry fulfils the condition
of its motion: to rounding, or not quite. With F' = U diag(sigma) V^T a move across the
curve changes u_i . F for i = 1 .. n - 1; what is left of F, along the other columns of
U, no move removes to first order: it is the misclosure. A system of no more than n - 1
equations has none. Doubles see it down to rounding, some 1e-15; where that is not
enough, and the problem evaluates F at any precision, it is measured in more digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.curves.monitor import NODES
from bifurc.decisions import closes_to_rounding, is_plainly_closed, is_same_point
from bifurc.errors import NOT_DEFINED
from bifurc.numerics.null_spaces import Decomposition, decompose
from bifurc.numerics.singular_values import singular_values
from bifurc.system import PreciseResidual, System, relative_gaps, relative_residuals

if TYPE_CHECKING:
    import mpmath

HIGHEST = 48  # points with the largest residuals at which a misclosure is looked for
# misclosures that doubles give to four digits and better
PLAIN = 1e-11
DIGITS = 40  # in which smaller ones are measured,
MOST = 4  # at no more points than this, those with the largest ones in doubles
ROUNDS = 3  # Gauss-Newton steps in many digits; each gains ten of them or more
FLOOR = 1e-12  # singular values below this share of the largest are taken for that
# Times the root of the residual: how far a point may lie beside a near motion on a bridge.
SPREAD = 4.0
# Times the tolerance over the smallest regular singular value: how far elsewhere. Times
# the tolerance: residuals of pieces that are no bridges.
KNOWN, EXACT = 20.0, 30.0
TINY = 1e-300
UNFINISHED = (Outcome.STALLED, Outcome.STEP_LIMIT, Outcome.TIME_LIMIT)


def misclosures(problem: System, points: np.ndarray) -> np.ndarray:
    """The misclosure (k,), over the magnitude, at points (k, n) of a curve."""
    decomposition = decompose(problem, points)
    left_over = decomposition.left[:, :, problem.n - 1 :]
    components = np.einsum("kmi,km->ki", left_over, decomposition.residuals)
    sizes: np.ndarray = np.linalg.norm(components, axis=1)
    return sizes


def visible_misclosure(problem: System, points: np.ndarray) -> float:
    """The largest misclosure that doubles see at points (k, n) of a curve, 0 where it
    is rounding."""
    if not len(points) or is_plainly_closed(
        float(relative_gaps(problem, points).max())
    ):
        return 0.0
    largest = float(misclosures(problem, points).max())
    return 0.0 if closes_to_rounding(largest) else largest


def largest_misclosure(problem: System, branch: Branch) -> float:
    """The largest misclosure along a curve; rounding, some 1e-15, where it is a curve
    of solutions.

    It is looked for at the centres of the pieces, and where the residual is largest.
    """
    centres = branch.pieces[:, 0]
    largest = float(relative_gaps(problem, centres).max(initial=0.0))
    if is_plainly_closed(largest):
        return largest
    points = branch(branch.places(NODES).ravel())
    highest = np.argsort(-relative_gaps(problem, points), kind="stable")[:HIGHEST]
    candidates = np.concatenate([centres, points[highest]])
    return largest_of(problem, candidates, misclosures(problem, candidates))


def largest_of(problem: System, points: np.ndarray, seen: np.ndarray) -> float:
    """The largest misclosure at points (k, n), of which doubles see ``seen`` (k,);
    measured in more digits where these do not tell."""
    largest = float(seen.max(initial=0.0))
    if closes_to_rounding(largest) or largest > PLAIN:
        return largest
    residual = problem.precise_residual()
    if residual is None:
        return largest
    worst = points[np.argsort(-seen, kind="stable")[:MOST]]
    return max(_precise_misclosures(problem, residual, worst, problem.n - 1))


def misclosure_at(problem: System, point: np.ndarray, rank: int) -> float:
    """What no move removes of F near a point (n,) where F' has a ``rank``: in many
    digits where the problem has them, else the residual."""
    residual = problem.precise_residual()
    if residual is None:
        return float(relative_gaps(problem, point[None])[0])
    return _precise_misclosures(problem, residual, point[None], rank)[0]


def _precise_misclosures(
    problem: System, residual: PreciseResidual, points: np.ndarray, rank: int
) -> list[float]:
    """The misclosures next to points (k, n) where F' has a ``rank``, in `DIGITS`
    digits.

    Gauss-Newton steps of that rank lead there, with F in many digits and F' in
    doubles.
    """
    import mpmath

    decomposition = decompose(problem, points)
    inverses = newton_inverses(decomposition, rank)
    measured = []
    with mpmath.workdps(DIGITS):
        for point, inverse in zip(points, inverses, strict=True):
            try:
                value = _after_steps(problem, residual, point, inverse)
            except NOT_DEFINED:
                value = relative_residuals(problem, point[None])[0]  # at a rim of F
            measured.append(float(np.linalg.norm(value)))
    return measured


def _after_steps(
    problem: System, residual: PreciseResidual, point: np.ndarray, inverse: np.ndarray
) -> np.ndarray:
    """F (m,), over the magnitude, after Gauss-Newton steps from a point (n,) by an
    ``inverse`` (n, m) of F'."""
    import mpmath

    u = [mpmath.mpf(float(x)) for x in point]
    for _ in range(ROUNDS):
        step = inverse @ as_floats(residual(u), problem.magnitude)
        u = [x - mpmath.mpf(float(d)) for x, d in zip(u, step, strict=True)]
    return as_floats(residual(u), problem.magnitude)


def newton_inverses(decomposition: Decomposition, rank: int) -> np.ndarray:
    """Matrices (k, n, m) that turn residuals into Gauss-Newton steps of a ``rank``, to
    be subtracted."""
    sigma = decomposition.sigma[:, :rank]
    steep = np.maximum(sigma, FLOOR * sigma[:, :1])
    right = decomposition.right[:, :rank] / steep[:, :, None]
    left = decomposition.left[:, :, :rank]
    inverses: np.ndarray = np.einsum("kin,kmi->knm", right, left)
    return inverses


def as_floats(value: Sequence[mpmath.mpf], magnitude: float) -> np.ndarray:
    """F over the magnitude (m,) in doubles, which keep its leading digits however small
    it is."""
    return np.array([float(part / magnitude) for part in value])


# --- what is traced where a system is nearly solved -----------------------------------


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
        return distance < reach


def bridges_of(branch: Branch, tolerance: float) -> np.ndarray:
    """Which pieces (p,) of a near motion followed to a ``tolerance`` lead straight on
    where the valley is not single."""
    return branch.residuals > EXACT * tolerance


@dataclass(frozen=True)
class NearSurface:
    """A component of a ``dimension`` all over which a system is nearly solved.

    The least residuals across it, at the places looked at, go up to ``misclosure``,
    over the magnitude. ``sample`` (n,) is one of these places.
    """

    dimension: int
    misclosure: float
    sample: np.ndarray
