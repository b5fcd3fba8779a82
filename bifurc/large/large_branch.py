"""A traced curve of a large problem, with the special points on it: where the parameter
turns back, where curves cross, and where they nearly do."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from bifurc.branch import Branch, Outcome
from bifurc.singular.point import Kind
from bifurc.tables import count_of
from bifurc.units import Units

KINDS = (
    Kind.FOLD,
    Kind.HOPF,
    Kind.CROSSING,
    Kind.RANK_DROP,
    Kind.MULTIPLE,
    Kind.NEAR_MISS,
)


@dataclass(frozen=True, eq=False)
class LargePoint:
    """A special point at arclength ``s`` of a branch, at ``u`` (n,), the parameter last.

    ``gap`` is what F misses there, over the magnitude, to be singular: the smallest
    singular value at a near miss, rounding at the others; at a Hopf point, where a pair of
    eigenvalues is +-i ``frequency``, their real part over their size. ``bend``: the second
    derivative of the parameter in the arclength at a fold. ``null_vectors`` (q, n) are
    the directions across the branch in which F' vanishes where its rank drops by q.
    ``directions`` (k, n): du/ds of the curves that pass at a crossing, the first that of
    the branch; u + 0.1 directions[1] is a start on another one. ``order`` is that of
    the derivatives of F that give them, 0 where they give none besides the first.
    """

    kind: Kind
    s: float
    u: np.ndarray
    gap: float
    bend: float = 0.0
    directions: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    null_vectors: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    order: int = 0
    frequency: float = 0.0

    @property
    def multiplicity(self) -> int:
        """By how much the rank of F' drops there."""
        return len(self.null_vectors)

    @property
    def parameter(self) -> float:
        """The parameter there."""
        return float(self.u[-1])

    def __repr__(self) -> str:
        place = f"{self.parameter:.12g} at s = {self.s:.6g}"
        times = f", multiplicity {self.multiplicity}" if self.multiplicity > 1 else ""
        return (
            f"<LargePoint: {self.kind.value}{times}, parameter {place}, "
            f"gap {self.gap:.2g}>"
        )


@dataclass(frozen=True, eq=False)
class Eigenvalues:
    """The ``values`` (k, q) of A next to a ``shift`` at ``places`` (k,) of a curve, by
    arclength, the nearest first."""

    shift: complex
    places: np.ndarray
    values: np.ndarray

    @property
    def unstable(self) -> np.ndarray:
        """How many of them (k,) have a positive real part."""
        counts: np.ndarray = np.count_nonzero(self.values.real > 0.0, axis=1)
        return counts

    @property
    def reach(self) -> np.ndarray:
        """How far (k,) from the shift all eigenvalues are known."""
        distances: np.ndarray = np.abs(self.values - self.shift).max(
            axis=1, initial=0.0
        )
        return distances


NO_EIGENVALUES = Eigenvalues(0.0, np.empty(0), np.empty((0, 0)))


@dataclass(frozen=True, eq=False, repr=False)
class LargeBranch:
    """A smooth curve u(s) of a `LargeProblem`, s from 0 to ``length``.

    ``s`` is the arclength in the problem's units: root mean squares of the field over
    its size, and the parameter over a quarter of its bounds. ``points`` are the special
    ones, in the order of s. ``branch`` is the curve in ``units``. ``values`` (k, q) are
    the smallest singular values of F', over the magnitude, at ``places`` (k,).
    ``eigenvalues`` are those of F' without the parameter, in the user's units. Along
    ``unsettled`` stretches, by arclength, some change sides, and how is not told.
    """

    branch: Branch
    units: Units
    points: tuple[LargePoint, ...]
    places: np.ndarray
    values: np.ndarray
    eigenvalues: Eigenvalues = NO_EIGENVALUES
    unsettled: tuple[tuple[float, float], ...] = ()

    @property
    def length(self) -> float:
        """Arclength of the whole curve."""
        return self.branch.length

    @property
    def outcome(self) -> Outcome:
        """Why tracing ended, with what to do next."""
        return self.branch.outcome

    def __call__(self, s: float) -> np.ndarray:
        """u (n,) at an arclength."""
        return self.units.outwards(self.branch(s))

    def tangent(self, s: float) -> np.ndarray:
        """du/ds (n,) at an arclength."""
        tangent: np.ndarray = self.units.sizes * self.branch(s, 1)
        return tangent

    def parameters(self, s: np.ndarray) -> np.ndarray:
        """The parameter (k,) at arclengths (k,)."""
        in_units = last_unknown(self.branch)(s)[:, 0]
        values: np.ndarray = self.units.sizes[-1] * in_units
        return values

    @property
    def folds(self) -> tuple[LargePoint, ...]:
        """The points where the parameter turns back."""
        return self.points_of(Kind.FOLD)

    @property
    def crossings(self) -> tuple[LargePoint, ...]:
        """The points where another curve passes."""
        return self.points_of(Kind.CROSSING)

    @property
    def hopf_points(self) -> tuple[LargePoint, ...]:
        """The points where a pair of eigenvalues is imaginary."""
        return self.points_of(Kind.HOPF)

    @property
    def near_misses(self) -> tuple[LargePoint, ...]:
        """The minima of the smallest singular value above zero."""
        return self.points_of(Kind.NEAR_MISS)

    def points_of(self, kind: Kind) -> tuple[LargePoint, ...]:
        """The special points of one kind."""
        return tuple(point for point in self.points if point.kind is kind)

    def __repr__(self) -> str:
        kinds = [point.kind.value for point in self.points]
        counts = [f"{kind.value}: {kinds.count(kind.value)}" for kind in KINDS]
        return (
            f"<LargeBranch in {self.branch.n} unknowns, {self.outcome.value}\n"
            f" length {self.length:.6g}, {count_of(len(self.branch.pieces), 'piece')}; "
            f"{', '.join(counts)}>"
        )


def last_unknown(branch: Branch) -> Branch:
    """The last unknown of a branch as a branch of one unknown, with its arclengths."""
    return replace(branch, pieces=branch.pieces[:, :, -1:], periods=np.array([np.inf]))
