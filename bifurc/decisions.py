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
    "solution",
    "a start has reached a solution",
    "residual",
    1e-12,
    "Newton's method ends at rounding, about 1e-15, or at a misclosure of the system",
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
    1e-9,
    "a curve is known to rounding, and so is F' on it",
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
may_be_crossed = Decision(
    "place to look",
    "a minimum of the singular value may be a singular point, which is then looked for",
    "smallest regular singular value",
    1e-3,
    "the place of a minimum is exact to 1e-5 and better; location decides",
    Role.LOOK,
)

# --- singular points ------------------------------------------------------------------

solves_at_point = Decision(
    "solution at a singular point",
    "a located singular point solves the system",
    "residual",
    1e-13,
    "rounding is some 1e-15; the residual beside a near miss is its square or more",
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

TABLE = decisions_in(globals())
