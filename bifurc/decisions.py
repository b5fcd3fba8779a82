"""Every comparison on which a count, a kind, a level or a word hangs, in one table.

A decision compares a quantity without units with a threshold. A threshold is meant to
stand in a gap: what is true gives quantities decades below it, what is false decades
above. `record_margins` notes the quantities that were decided on, so that a study can
show the gaps; see docs/decisions.md.

Singular values and residuals are over the problem's ``magnitude``, lengths over its
``scale``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "TABLE",
    "Decision",
    "Margins",
    "Role",
    "decisions_in",
    "record_margins",
]

Floats: TypeAlias = NDArray[np.float64]

# Names of decisions, with the quantities that each was taken on.
Margins: TypeAlias = dict[str, list[Floats]]

_recorded: ContextVar[Margins | None] = ContextVar("recorded", default=None)


@contextmanager
def record_margins() -> Iterator[Margins]:
    """The quantities of every decision that is taken inside the ``with`` block, by the
    decision's name."""
    margins: Margins = defaultdict(list)
    token = _recorded.set(margins)
    try:
        yield margins
    finally:
        _recorded.reset(token)


class Role(Enum):
    """What hangs on a decision."""

    # A count, a kind, a level or a word.
    VERDICT = "verdict"
    # Whether something is looked at more closely; both sides end in the same answer.
    LOOK = "look"
    # Nothing but what is listed: a convention.
    CONVENTION = "convention"


@dataclass(frozen=True)
class Decision:
    """Whether a ``quantity`` is below a ``threshold``.

    ``claim`` is what is taken for true where it is, ``reason`` why the threshold stands
    where it does, ``role`` what hangs on it.
    """

    name: str
    claim: str
    quantity: str
    threshold: float
    reason: str
    role: Role = Role.VERDICT

    @overload
    def __call__(self, value: float, unit: float = 1.0) -> bool: ...
    @overload
    def __call__(
        self, value: Floats, unit: float | Floats = 1.0
    ) -> NDArray[np.bool_]: ...

    def __call__(
        self, value: float | Floats, unit: float | Floats = 1.0
    ) -> bool | NDArray[np.bool_]:
        """Whether the claim holds, of a value or of each of an array of them, measured
        in ``unit``."""
        margins = _recorded.get()
        if margins is not None:
            quantities = np.asarray(value, dtype=float) / unit
            margins[self.name].append(np.ravel(quantities))
        if isinstance(value, np.ndarray):
            return np.less(value, self.threshold * unit)
        return bool(value < self.threshold * unit)


def decisions_in(names: Mapping[str, object]) -> dict[str, Decision]:
    """The decisions among the ``names`` of a module, by their own names."""
    decisions = [value for value in names.values() if isinstance(value, Decision)]
    return {decision.name: decision for decision in decisions}


# --- solutions ------------------------------------------------------------------------

is_solution = Decision(
    "closing",
    "the system is solved: by a point, or all along a curve, which then is a motion",
    "residual; along a curve the largest of the least ones across it",
    1e-12,
    "the closing tolerance: a thousand times rounding, which geometry in doubles has, "
    "too; doubles still measure it to three digits",
)
closes_to_rounding = Decision(
    "closing to rounding",
    "what is left of a residual is rounding, and no misclosure of the system",
    "least residual across a curve",
    1e-14,
    "rounding leaves 1e-15 to 5e-15; above, the misclosure is measured in more digits",
)
nearly_closes = Decision(
    "near motion",
    "the system is nearly solved all along a curve, which is a near motion",
    "the largest of the least residuals across the curve",
    1e-2,
    "a convention: larger errors are none of making or of rounding",
)
is_blurred = Decision(
    "blurred assembly",
    "an isolated solution on a near motion is not told from its neighbours by Newton's "
    "method",
    "smallest of all n singular values",
    1e-8,
    "rounding over it, 1e-7, is how well the place is known; places 1e-6 apart are two",
)
may_nearly_move = Decision(
    "assembly that nearly moves",
    "an isolated solution may lie on a near motion, which is then looked for",
    "smallest of all n singular values",
    0.02,
    "half the shortest stretch from a stiffer one the residual is 1e-2 and larger; "
    "assemblies of random loops have 0.03 and more",
)
is_stretch_short = Decision(
    "stretch of a near motion",
    "a curve along which the system is nearly solved is no near motion",
    "length over the scale, where it does not close",
    2.0,
    "a convention: beside any solution the residual is small along some stretch",
)
is_solution_at_probe = Decision(
    "solution at a probe",
    "the end of a probe along the null space is a solution",
    "residual",
    1e-10,
    "at places of low rank Newton's method is slow and leaves more than rounding",
)

# --- rank -----------------------------------------------------------------------------

is_null = Decision(
    "null direction",
    "a direction belongs to the null space of F'",
    "singular value",
    1e-7,
    "at a point of higher order the place, and with it F', is known to half the digits",
)
is_null_at_probe = Decision(
    "null direction at a probe",
    "a direction belongs to the null space of F' at the end of a probe",
    "singular value",
    1e-6,
    "the ends of probes are known less well than the points they leave from",
)
is_zero_along = Decision(
    "rank along a curve",
    "a singular value is zero all along a curve",
    "median of the singular value along the curve",
    1e-11,
    "a curve is known to rounding, and so is F' on it; beside a surface it is larger",
)
is_shaky = Decision(
    "lower rank at a seed",
    "a direction belongs to the null space of F' on a double curve",
    "singular value",
    1e-5,
    "seeds reach a double curve to half the digits, 1e-8, and with few more steps less",
)
is_mobile = Decision(
    "rigid or mobile",
    "a seed lies on a curve or a surface, and is no isolated solution",
    "smallest of all n singular values",
    1e-6,
    "on a curve it is rounding; for a smaller one than this a curve is traced",
)
may_be_singular = Decision(
    "seed of low rank",
    "a seed may lie at a singular point, which is then looked for",
    "smallest regular singular value",
    1e-4,
    "a seed beside a singular point is known to half the digits",
    Role.LOOK,
)
is_beside_singular = Decision(
    "seed beside a singular point",
    "a small singular value at a seed vanishes nearby, and is not as small all around",
    "the value over its rate of change, which is a distance, over the scale",
    1e-2,
    "beside a surface both are small; the place is known to 1e-4 at a point of order 4",
    Role.LOOK,
)
may_be_crossed = Decision(
    "place to look",
    "a minimum of the singular value may be a singular point, which is then looked for",
    "smallest regular singular value",
    1e-3,
    "the place of a minimum is exact to 1e-5 and better; location decides",
    Role.LOOK,
)

# --- surfaces -------------------------------------------------------------------------

is_closed_on_surface = Decision(
    "surface or curves on it",
    "the solutions fill all directions of the null space",
    "residual above the null space, up to a twentieth of the scale away",
    is_solution.threshold,
    "on a surface it is rounding, 1e-15; curves beside one leave their distance from it",
)
misses_by_rounding = Decision(
    "exact but for rounding",
    "what a surface or a singular point misses is rounding",
    "largest residual on the surface, or at the point",
    5e-15,
    "rounding of F is 1e-15 or less; what is between this and 1e-12 is in doubt",
)
is_known_curve = Decision(
    "curve without doubt",
    "a form is a curve, and not a part of a surface",
    "rounding over the median of its smallest regular singular value, over the scale",
    1e-6,
    "at this distance two points count as one; points of ordinary curves: 1e-13",
)

# --- singular points ------------------------------------------------------------------

solves_at_point = Decision(
    "solution at a singular point",
    "a located singular point solves the system",
    "residual",
    1e-13,
    "rounding is some 1e-15; the residual beside a near miss is its square or more",
)
vanishes = Decision(
    "zero at a singular point",
    "a direction belongs to the null space of F' at a located singular point",
    "singular value, over one and ten times the doubt of the place where that is more",
    1e-12,
    "at a simple singular point it is rounding, some 1e-16; doubles resolve a near miss "
    "down to 1e-12, and the closing tolerance is no finer",
)
is_located = Decision(
    "located",
    "the iteration for a singular point has converged",
    "last step over the scale",
    1e-4,
    "at points of high order it stagnates where rounding hides the rest",
)
has_no_form = Decision(
    "no quadratic form",
    "second order says nothing about the tangents",
    "size of the forms W^T F''(V x, V x)",
    1e-7,
    "they are exact to rounding times the error of the point",
)
is_zero_form = Decision(
    "value of a quadratic form",
    "a discriminant, a resultant or a value of a form is zero",
    "the number, for coefficients of unit length",
    1e-6,
    "the coefficients are exact to rounding times the error of the point",
)
is_surface_probe = Decision(
    "surface or curve",
    "a probe along the null space stays what it was when it is projected",
    "share that projection takes from a probe",
    0.05,
    "curvature takes a share of the order of the probe's length, 0.005",
)
is_same_half_branch = Decision(
    "same half-branch",
    "two solutions on a small sphere are one",
    "distance over the radius of the sphere",
    1e-4,
    "they are exact to rounding over the radius",
)

# --- identity of points and curves ----------------------------------------------------

is_same_point = Decision(
    "same point",
    "two points are one, or a point lies on a curve",
    "distance over the scale",
    1e-6,
    "points are exact to 1e-13, near singular points to half the digits",
)
is_back = Decision(
    "closed",
    "a curve has come back to its start",
    "distance over the scale",
    1e-6,
    "the start is exact to rounding over the singular value there",
)
is_stub = Decision(
    "form or stub",
    "what stalls at both ends is the trace of rounding beside a singular point",
    "length over the scale",
    2e-2,
    "rounding bends a curve away within about the third root of 1e-15 of the point",
)
stands_still = Decision(
    "stands still",
    "an unknown keeps its value along a form",
    "its largest rate",
    1e-8,
    "rates are exact to 1e-12",
)
is_slow = Decision(
    "slow",
    "an unknown may stand still on another stretch of the same branch",
    "its largest rate on this stretch",
    1e-4,
    "what moves does so at a rate of about 1 somewhere, but for a moment",
)
is_same_line = Decision(
    "same line",
    "two passes of a curve through a place, or two pieces, run along the same line",
    "one less the cosine of the angle between them",
    1e-6,
    "tangents are exact to 1e-8; branches that cross do so at larger angles",
)
is_tied = Decision(
    "order",
    "two features of forms or points are equal, and the next one decides their order",
    "difference over the scale",
    1e-6,
    "features of mirror images differ by rounding, about 1e-13",
)
is_unclear_start = Decision(
    "start of a form",
    "a function has no clear top on a curve, and the next one says where it begins",
    "the lead of the top over all others, in thousandths of the range of the function; "
    "or its bend, if that is less clear",
    1.0,
    "a top is exact to 1e-12, and symmetry makes two of them equal to 1e-12",
    Role.CONVENTION,
)
is_slow_at_start = Decision(
    "direction of a form",
    "an unknown does not clearly move at the start, and the next one says which way",
    "its rate over the largest",
    0.05,
    "rates are exact to 1e-11, and symmetry makes them zero to 1e-11",
    Role.CONVENTION,
)

# --- near misses ----------------------------------------------------------------------

is_level = Decision(
    "level singular value",
    "a singular value does not change along a curve",
    "its slope over magnitude and scale",
    1e-8,
    "the slope comes from a central difference of F', exact to 1e-10",
)
stands_out = Decision(
    "near miss",
    "a minimum of the singular value is low enough to be listed",
    "value over half the largest on the curve",
    1.0 - 1e-6,
    "at half of the largest but for rounding it is not low",
    Role.CONVENTION,
)

# --- certificates ---------------------------------------------------------------------

is_unique = Decision(
    "one arc",
    "there is one solution in the slice across a curve",
    "its omega |G| in the theorem of Newton and Kantorovich",
    0.25,
    "the theorem asks for 1/2; on a regular arc it is 1e-8 and less",
)
is_closed_to_rounding = Decision(
    "solution to rounding",
    "only rounding is in the way of a certificate, and no jump",
    "residual along a refused arc",
    2e-14,
    "rounding is some 1e-15; over a jump between sheets the residual is what they differ",
)

TABLE = decisions_in(globals())
