"""A singular point as data: where it is, what leaves it, and its kind."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from bifurc.decisions import leaves_to_other_side, leaves_to_same_side
from bifurc.singular.invariants import Invariants


class Kind(Enum):
    """What a singular point is."""

    # Two or more branches meet.
    BIFURCATION = "bifurcation"
    # One smooth branch passes.
    RANK_DROP = "rank drop"
    # Two half-branches leave to the same side.
    CUSP = "cusp"
    # No branch passes.
    ISOLATED = "isolated"
    # Branches meet a component of dimension 2 or more.
    DIMENSION_CHANGE = "dimension change"
    # The point lies on a component of dimension 2 or more, and no branch passes.
    SURFACE = "singular point of a surface"
    # Two ways of looking disagree.
    UNDECIDED = "undecided"


@dataclass(frozen=True, eq=False)
class SingularPoint:
    """A located singular point.

    ``u`` (n,), ``rank`` of F' there, ``null_space`` (n, k), ``error``: estimate of the
    distance to the exact point, ``half_branches`` (h, n): unit directions in which
    solutions leave it, as seen on a small sphere, ``tangents`` (t, n) of the branches
    from the second-order equations (t = 0 where these do not decide), ``dimension`` of
    the solution set nearby (-1 where sections of two radii disagree), ``order`` of the
    argument that decided: 2, or 0 for the section alone, which was made at ``radius``;
    ``is_clear`` where nothing in it is a zero but for rounding, ``is_confirmed`` unless
    the equations are known exactly and more digits did not show the point.
    ``is_through`` says whether two half-branches leave to opposite sides, where exact
    equations tell: seen from a sphere they may still turn. Else they do so, or not,
    where the sections leave no doubt. The ``invariants`` are those of the plane curve to
    which the equations reduce, None where that is not known.
    """

    u: np.ndarray
    rank: int
    null_space: np.ndarray
    error: float
    half_branches: np.ndarray
    tangents: np.ndarray
    dimension: int
    order: int
    radius: float
    is_clear: bool = True
    is_confirmed: bool = True
    is_through: bool | None = None
    invariants: Invariants | None = None

    @property
    def kind(self) -> Kind:
        """What the half-branches alone say."""
        count = len(self.half_branches)
        if self.dimension > 1:
            return Kind.DIMENSION_CHANGE if count else Kind.SURFACE
        if self.dimension < 0:
            return Kind.UNDECIDED
        if count == 0:
            return Kind.ISOLATED
        if count == 2:
            return self._kind_of_two
        return Kind.BIFURCATION if count % 2 == 0 else Kind.UNDECIDED

    @property
    def _kind_of_two(self) -> Kind:
        """What two half-branches make: they are halves of one branch, and their tangents
        the same or opposite."""
        if self.is_through is not None:
            return Kind.RANK_DROP if self.is_through else Kind.CUSP
        one, other = self.half_branches
        cosine = float(one @ other)
        if leaves_to_same_side(1.0 - cosine):
            return Kind.CUSP
        if leaves_to_other_side(1.0 + cosine):
            return Kind.RANK_DROP
        return Kind.UNDECIDED

    def __repr__(self) -> str:
        return (
            f"SingularPoint({self.kind.value}, rank {self.rank}, "
            f"error {self.error:.1e}, {len(self.half_branches)} half-branches, "
            f"{len(self.tangents)} tangents)"
        )
