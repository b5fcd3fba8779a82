"""Special points: their kinds, and a singular point as data: where it is, what leaves
it, and its kind."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bifurc.decisions import leaves_to_other_side, leaves_to_same_side
from bifurc.tables import count_of


class Mark(NamedTuple):
    """A symbol as matplotlib calls it, its size in points, and the colour inside."""

    symbol: str = "s"
    size: float = 5.0
    fill: str = "white"


TABLE: dict[str, Any] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
)


class Kind(Enum):
    """What a special point of a curve is.

    The ``value`` is its name in texts and in JSON, that of the member the one in
    datasets. ``initial`` begins the names of such points, ``mark`` stands for them in
    figures, ``title`` above their table in a summary. Those that a diagram lists have a
    ``plural``, and ``columns`` of their own in the table.
    """

    initial: str
    mark: Mark
    title: str
    plural: str
    columns: tuple[str, ...]

    def __init__(self, value: str):
        facets = TABLE.get(value, {})
        self.initial = facets.get("initial", "S")
        self.mark = Mark(**facets.get("mark", {}))
        self.title = facets.get("title", "Other singular points")
        self.plural = facets.get("plural", "")
        self.columns = tuple(facets.get("columns", ()))

    # --- where the rank of F' drops ---------------------------------------------------

    # Two or more branches meet.
    BIFURCATION = "bifurcation"
    # One smooth branch passes; of a large problem, second order shows no other.
    RANK_DROP = "rank drop"
    # Branches meet a component of dimension 2 or more.
    DIMENSION_CHANGE = "dimension change"
    # Two half-branches leave to the same side.
    CUSP = "cusp"
    # No branch passes.
    ISOLATED = "isolated"
    # The point lies on a component of dimension 2 or more, and no branch passes.
    SURFACE = "singular point of a surface"
    # The same, of a curve of such points: it stands for all of them.
    CURVE_SAMPLE = "sample of a curve of singular points"
    # Two ways of looking disagree.
    UNDECIDED = "undecided"
    # Of a large problem: other curves pass in directions of their own.
    CROSSING = "crossing"
    # The rank drops by two or more, and the directions of other curves are not computed.
    MULTIPLE = "multiple singular point, directions not computed"
    # The smallest singular value has a minimum above zero.
    NEAR_MISS = "near miss"

    # --- along a parameter ------------------------------------------------------------

    # The parameter turns back: a limit point.
    FOLD = "fold"
    # A pair of eigenvalues crosses the imaginary axis.
    HOPF = "Hopf point"
    # A function of the user's takes a value.
    EVENT = "event"
    # It takes the value and turns back, or stays within rounding of it.
    TOUCH = "touch"

    # --- how branches cross, seen along a parameter -----------------------------------

    # Both go on to either side.
    TRANSCRITICAL = "transcritical"
    # One of them turns back. Whether it is stable where the other is not, is not known.
    PITCHFORK = "pitchfork"
    # The one that turns back has fewer unstable directions than the other beside it.
    SUPERCRITICAL = "supercritical pitchfork"
    # It has more of them.
    SUBCRITICAL = "subcritical pitchfork"
    # More than two branches, or one that stands still without turning back.
    OTHER = "branch point"


@dataclass(frozen=True)
class Invariants:
    """What stays as it is where the coordinates change.

    ``multiplicity``: in how many points a line nearby meets the curve, at most, complex
    ones counted; ``branches`` through the point, complex ones counted; ``delta``: how
    many crossings the curve has nearby once it is deformed in general; ``contacts``: the
    orders of contact (intersection numbers) of any two real branches, in order, 1 where
    they cross.
    """

    multiplicity: int
    branches: int
    delta: int
    contacts: tuple[int, ...]

    @property
    def milnor_number(self) -> int:
        """mu = 2 delta - branches + 1 (Milnor 1968, theorem 10.5)."""
        return 2 * self.delta - self.branches + 1


CROSSING = Invariants(multiplicity=2, branches=2, delta=1, contacts=(1,))
LONE_POINT = Invariants(multiplicity=2, branches=2, delta=1, contacts=())


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
    which the equations reduce, None where that is not known. ``is_sample`` says that it
    is one of a curve of singular points of a surface.
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
    is_sample: bool = False

    @property
    def kind(self) -> Kind:
        """What the half-branches alone say."""
        count = len(self.half_branches)
        if self.dimension > 1 and count:
            return Kind.DIMENSION_CHANGE
        if self.dimension > 1:
            return Kind.CURVE_SAMPLE if self.is_sample else Kind.SURFACE
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
            f"{count_of(len(self.tangents), 'tangent')})"
        )
