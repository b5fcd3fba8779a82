"""Special points of a large problem: where the parameter turns back, where curves cross,
and where they nearly do."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bifurc.singular.point import Kind


@dataclass(frozen=True, eq=False)
class LargePoint:
    """A special point at arclength ``s`` of a branch, at ``u`` (n,), the parameter last.

    ``gap`` is what F misses there, over the magnitude, to be singular: the smallest
    singular value at a near miss, rounding at the others. ``bend``: the second
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
