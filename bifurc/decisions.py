"""Every comparison on which a count, a kind, a level or a word hangs, in one table.

A decision compares a quantity without units with a threshold. The threshold of a
verdict stands in a gap: what is true gives quantities decades below it, what is false
decades above. Where the truth itself has no gap, as when a linkage misses a condition
by any amount, there is a third answer. `record_margins` notes the quantities that were
decided on, so that a study can show the gaps; see docs/decisions.md.

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
    # What is listed, or in which order: either side is as good, and one was chosen.
    CONVENTION = "convention"


@dataclass(frozen=True)
class Decision:
    """Whether a ``quantity`` is below a ``threshold``.

    ``claim`` is what is taken for true where it is, ``reason`` why the threshold stands
    where it does, ``role`` what hangs on it. ``third_answer`` is what is said where the
    quantity is neither plainly small nor plainly large, empty where that is not met.
    """

    name: str
    claim: str
    quantity: str
    threshold: float
    reason: str
    role: Role = Role.VERDICT
    third_answer: str = ""

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
            with np.errstate(divide="ignore", invalid="ignore"):
                quantities = np.asarray(value, dtype=float) / unit
            margins[self.name].append(np.ravel(quantities))
        if isinstance(value, np.ndarray):
            return np.less(value, self.threshold * unit)
        return bool(value < self.threshold * unit)


def decisions_in(names: Mapping[str, object]) -> dict[str, Decision]:
    """The decisions among the ``names`` of a module, by their own names."""
    decisions = [value for value in names.values() if isinstance(value, Decision)]
    return {decision.name: decision for decision in decisions}


def unit_over_rounding(decision: Decision, by_rounding: float) -> float:
    """The unit in which a quantity is smaller than the threshold that rounding may have
    made: 1 where what comes ``by_rounding`` is below that."""
    return max(1.0, by_rounding / decision.threshold)


# --- solutions ------------------------------------------------------------------------

is_solution = Decision(
    "closing",
    "the system is solved: by a point, or all along a curve, which then is a motion",
    "residual; along a curve the largest of the least ones across it",
    1e-12,
    "the closing tolerance: a thousand times rounding, which geometry in doubles has, "
    "too; doubles still measure it to three digits",
    third_answer="what misses by more than rounding moves within the closing "
    "tolerance, and by how much is said",
)
is_start_solved = Decision(
    "start that closes",
    "the iteration from a random start has reached a solution",
    "residual",
    is_solution.threshold,
    "next to singular points it converges slowly; what stops on the way counts as "
    "missed, and other starts reach what it would have reached",
    Role.LOOK,
)
closes_to_rounding = Decision(
    "closing to rounding",
    "what is left of a residual is rounding, and no misclosure of the system",
    "least residual across a curve",
    1e-14,
    "rounding leaves 1e-15 to 5e-15",
    third_answer="from here to the closing tolerance the misclosure is measured in more "
    "digits, and said",
)
is_plainly_closed = Decision(
    "plainly closed",
    "there is no misclosure to look for",
    "residual",
    closes_to_rounding.threshold,
    "the misclosure is no larger than the residual, and is taken where this is larger",
    Role.LOOK,
)
nearly_closes = Decision(
    "near motion",
    "the system is nearly solved all along a curve, which is a near motion",
    "the largest of the least residuals across the curve",
    1e-2,
    "larger errors are none of making or of rounding",
    Role.CONVENTION,
)
is_faint = Decision(
    "faint near motion",
    "a near motion misses so little that doubles may not follow it through a crossing",
    "misclosure",
    1e-9,
    "a crossing opens by the root of it, where points are known to rounding over that: "
    "traces were seen to go over to the other arc at 1e-11, and none at 1e-9",
    third_answer="the statement says so of each",
)
has_valley = Decision(
    "valley",
    "across a near motion the least residual is at one place",
    "residual over the square of the smallest regular singular value",
    300.0,
    "where forms crossed it is 6 to 28, whatever the error, if the crossing has opened, "
    "and 1e6 and more where it has not, or the rank drops",
    third_answer="the statement says that the near motion may be interrupted there",
)
is_beside_drop = Decision(
    "beside a rank drop",
    "a place on a near motion is so near to a rank drop that the valley may split",
    "square of the smallest regular singular value over the residual",
    3.0,
    "within the root of the residual the two equations there have no common solution",
    Role.LOOK,
)
is_flat = Decision(
    "flat direction",
    "the system is nearly solved all over a surface, and not along single curves on it",
    "square of a singular value over the residual",
    0.05,
    "both are of the order of the error on such a surface: 1e-3 and less for errors of "
    "1e-3 and less; a fifth of the scale beside a rank drop it is 0.4 and more",
    third_answer="the level is estimated",
)
has_one_form = Decision(
    "one form on the null space",
    "the equations of second order on the two weakest directions are one equation, so "
    "that forms crossed here",
    "second over first singular value of their coefficients",
    0.045,
    "at a crossing it is the square of the distance or less, at a rank drop 0.08 to 0.4",
    third_answer="the statement says that the near motion may be interrupted there",
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
    "half the shortest stretch from a stiffer one the residual is 1e-2 and larger, so "
    "that no near motion is found",
    Role.LOOK,
)
is_stretch_short = Decision(
    "stretch of a near motion",
    "a curve along which the system is nearly solved is no near motion",
    "length over the scale, where it does not close",
    2.0,
    "beside any solution the residual is small along some stretch",
    Role.CONVENTION,
)
is_solution_at_probe = Decision(
    "solution at a probe",
    "the end of a probe along the null space is a solution",
    "residual",
    1e-10,
    "at places of low rank Newton's method is slow; a surface is told by what it misses "
    "above its null space, whether its probes arrive or not",
    Role.LOOK,
)

is_same_function = Decision(
    "recording",
    "recorded equations are the function that they were recorded from",
    "difference of the values, over the width of the interval of all that rounding may "
    "make of the recorded ones",
    30.0,
    "the same operations in another order differ by 1 or less; another function by 1e6 "
    "and more",
)

is_on_the_way = Decision(
    "on the way to a solution",
    "a start that ends short of a solution shows where solutions may be",
    "residual",
    1e-6,
    "beside a small curve with a crossing F is so flat that starts stop at 1e-11",
    Role.LOOK,
)
stops_short = Decision(
    "start that stops short",
    "where a start ends, about nothing that is known, there may be a solution",
    "residual",
    1e-9,
    "where F loses digits, or is flat, solutions leave 1e-11; elsewhere starts end at "
    "minima of |F|, of any size",
    third_answer="the statement on completeness says so",
)
is_flat_equation = Decision(
    "power of an equation",
    "the gradient of an equation vanishes at all solutions, as that of a square does, "
    "and its derivatives are equations as well",
    "length of the gradient where nine tenths of the starts end, over that elsewhere",
    1e-4,
    "at a k-fold solution starts stop at 1e-11, where it is 1e-11 to the power of "
    "1 - 1 / k: 3e-6 for a square",
)
is_at_rest = Decision(
    "start at rest",
    "a start has ended at a minimum of |F|, where nothing more is looked for",
    "slope of |F|, over the size of F'",
    1e-2,
    "beside an isolated point in a narrow valley of |F| starts come down so slowly that "
    "they end on the way, where it falls as fast as it can",
    Role.LOOK,
)
may_repeat_factors = Decision(
    "repeated factors",
    "an equation may have a factor more than once, and as a polynomial is factored",
    "length of the gradient where a start ends, over that elsewhere",
    is_flat_equation.threshold,
    "as for the power of an equation, but two ends are enough: other factors may be "
    "there once",
    Role.LOOK,
)
is_factor_of_form = Decision(
    "factor of a form",
    "a factor of an equation vanishes all along a form, and its power counts for the "
    "multiplicity",
    "value over gradient, in the median of places along the form, over the scale",
    1e-6,
    "rounding, some 1e-15, or 1e-8 where the factor is a square that was not seen to be "
    "one; else the typical distance of two curves",
)
is_far_smaller = Decision(
    "far smaller",
    "solutions fill so little of where they are looked for that they are looked at in "
    "units of their own",
    "what they span over the width of the region, in one unknown",
    0.03,
    "a curve as large as a thirtieth of the region is followed as well as a larger one",
    Role.LOOK,
)

# --- rank -----------------------------------------------------------------------------

is_null = Decision(
    "null direction",
    "a direction belongs to the null space of F', at a chart of a surface or a solution "
    "beside a singular point",
    "singular value",
    1e-7,
    "it is rounding there",
)
may_be_null = Decision(
    "direction to probe",
    "solutions may lie in a direction, which is then probed",
    "singular value",
    1e-7,
    "on a surface it is rounding; beside a singular point it is anything, and the "
    "probes tell what there is",
    Role.LOOK,
)
is_null_at_probe = Decision(
    "direction to probe again",
    "solutions at the end of a probe may lie in a direction, which is then probed",
    "singular value; over that at which a double solution with this residual is hidden, "
    "where that is more",
    1e-6,
    "beside singular points it is anything; a surface is told by what it misses above "
    "its null space",
    Role.LOOK,
)
is_zero_along = Decision(
    "rank along a curve",
    "a singular value is zero all along a curve",
    "median of the singular value along the curve",
    1e-11,
    "a curve is known to rounding, and so is F' on it; beside a surface it is larger",
    third_answer="a curve with a value from this to 1e-9 may be a part of a surface, and "
    "that is said",
)
may_be_shaky = Decision(
    "lower rank at a seed",
    "a seed may lie on a curve along which the rank is lower, which is then looked for",
    "singular value",
    1e-5,
    "seeds reach a double curve to half the digits, 1e-8, and with few more steps less",
    Role.LOOK,
)
is_shaky = Decision(
    "lower rank beside a seed",
    "the rank is lower at what a small sphere shows of the curve through a seed, too",
    "smallest regular singular value there",
    1e-5,
    "the sphere is a hundredth of the scale: on another curve the value grows with it; "
    "beside a surface it need not, but there the deflated system has no solution",
    Role.LOOK,
)
may_be_scaled_down = Decision(
    "weak equation",
    "an equation may be small because somebody scaled it, and its rounding is measured",
    "smallest regular singular value",
    1e-3,
    "for larger ones rounding is 1e-15 over it, as it is for smaller ones as a rule",
    Role.LOOK,
)
is_without_equation = Decision(
    "direction without equation",
    "nothing is said of a direction by F, and how well a place is known along it is not asked",
    "smallest regular singular value",
    1e-11,
    "rounding over it is 1e-4: the rank is lower there, and that is looked at",
    Role.LOOK,
)
may_be_mobile = Decision(
    "seed that may move",
    "a seed may lie on a curve, which is then traced",
    "smallest of all n singular values",
    1e-4,
    "on a curve it is rounding over the next singular value, 1e-6 and less; at an "
    "isolated solution there is nothing but a stub to trace",
    Role.LOOK,
)
is_weakly_isolated = Decision(
    "weak assembly",
    "an isolated solution may be one at which others come together, which is looked for",
    "smallest of all n singular values",
    1e-5,
    "rounding leaves 1e-7 of a double solution, and spreads what is found about it to "
    "1e-6",
    Role.LOOK,
)
is_known_assembly = Decision(
    "hidden assembly",
    "an isolated solution is one, and known",
    "half the stretch of the valley about it, over the scale, on which the residual is "
    "rounding",
    1e-6,
    "points as near as that count as one; about a double solution it is 1e-7, about "
    "three together 1e-5",
    third_answer="such solutions count as one, and the statement says that rounding "
    "does not tell how many they are",
)
is_plainly_closed_curve = Decision(
    "closed curve",
    "what closes is a curve, and no trace of rounding",
    "how far its place is known, over its length",
    1e-3,
    "rounding turns round within what it leaves of a singular point",
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
is_deep_place = Decision(
    "deep place",
    "a place where the singular value is far smaller than on both sides may be a "
    "singular point, which is then looked for",
    "the value over the smaller one of the largest on the two sides",
    0.1,
    "beside a surface the slope is lost in rounding, by which minima are found; "
    "location decides",
    Role.LOOK,
)
is_singular_to_rounding = Decision(
    "deep place at a singular point",
    "at a deep place of a form without a certificate there is a singular point, located "
    "or not",
    "singular value",
    1e-11,
    "a function is known to 1e-15 of its size, and its derivatives leave their zeros "
    "with their distance",
    third_answer="where none is located the form is in doubt",
)

# --- surfaces -------------------------------------------------------------------------

is_closed_on_surface = Decision(
    "surface or curves on it",
    "the solutions fill all directions of the null space",
    "residual above the null space, up to a twentieth of the scale away",
    is_solution.threshold,
    "on a surface it is rounding, 1e-15; curves beside one leave their distance from it",
    third_answer="a surface that misses by more than rounding may be curves, and that "
    "is said",
)
misses_by_rounding = Decision(
    "exact but for rounding",
    "what a surface or a singular point misses is rounding",
    "largest residual on the surface, or at the point",
    5e-15,
    "rounding of F is 1e-15 or less",
    third_answer="what is more, up to the closing tolerance, is in doubt",
)
hangs_on_data = Decision(
    "near miss by rounding of the data",
    "a near miss may be a bifurcation of the numbers that are meant",
    "change of F that would make it one, over the rounding of the numbers that F is made "
    "of",
    16.0,
    "so many numbers at most add up, each off by half a unit in the last place",
    third_answer="the near miss is listed, and in doubt",
)
is_known_curve = Decision(
    "curve without doubt",
    "a form is a curve, and not a part of a surface",
    "rounding over the median of its smallest regular singular value, over the scale",
    1e-6,
    "at this distance two points count as one; points of ordinary curves: 1e-13",
    third_answer="what is more is in doubt",
)

# --- singular points ------------------------------------------------------------------

is_singular_point = Decision(
    "singular point",
    "a point solves the system, and F' has the null space that was looked for",
    "ten times the residual, over a hundred times the misclosure of the curves where "
    "that is more; or the largest singular value in the null space, over ten times the "
    "doubt of the place",
    is_solution.threshold,
    "both are rounding, 1e-15; beside a near miss one of them is of the order of what "
    "doubles resolve of it, 1e-10, or more",
    third_answer="a point that misses by more than rounding may be a near miss, and "
    "that is said",
)
is_crossing_of_many = Decision(
    "crossing of a large problem",
    "curves cross at a singular point of a large problem, and do not pass it nearly",
    "what F misses there, over the smallest singular value at the start",
    1e-7,
    "rounding of F over that value is 1e-10 with a million unknowns, and 1e-13 with a "
    "thousand",
    third_answer="what misses by more is listed as a near miss, with its singular value",
)
is_derivative = Decision(
    "derivative",
    "a Jacobian that a user gives is the derivative of the function",
    "its difference to differences of the function, less the error of these, over the "
    "size of both",
    1e-2,
    "right ones differ by 1e-6 and less, those that lack a term by 1e-1 and more",
)
is_derivative_along = Decision(
    "derivative along a curve",
    "a Jacobian of a large problem is the derivative of the function all along a curve",
    "error of the unknowns over the way along the curve, by what its product with the "
    "tangent is off, less the error of differences",
    1e-2,
    "right ones are off by 1e-6 and less; a branch is followed to 1e-6 of its size",
)
is_far_below_size = Decision(
    "field far below its size",
    "the typical size that a user gives for the field of a large problem is far too "
    "large, and the curve is traced again with the size that was seen",
    "largest root mean square of the field along the curve, over the size",
    3e-2,
    "with a tenth of the size steps are short, and the points are the same",
    Role.LOOK,
)
is_trivial_field = Decision(
    "trivial field",
    "the field of a large problem is zero along a curve, and says nothing of its size",
    "largest root mean square of the field along the curve, over the size",
    1e-9,
    "rounding leaves 1e-16",
    Role.LOOK,
)
is_singular_start = Decision(
    "singular start of a large problem",
    "a large problem begins at a singular point, and F' is measured beside it",
    "smallest singular value at the start, over that a little way along the curve",
    1e-3,
    "either value serves as a unit; that of a singular start would be rounding",
    Role.LOOK,
)
is_multiple_of_many = Decision(
    "multiple singular point of a large problem",
    "several singular values of a large problem are zero at one point, and not next to "
    "each other",
    "the largest of them at the point where they are least, over the smallest one at the "
    "start",
    1e-7,
    "rounding of F' over that value is 1e-10 with a thousand unknowns",
    third_answer="points of one value each are located next to each other",
)
is_without_crossing_speed = Decision(
    "without crossing speed",
    "a singular value of a large problem does not go to zero at a rate of its own along "
    "the branch, and the directions of other branches are not computed",
    "smallest rate at which the values go to zero at a multiple singular point, over the "
    "largest",
    1e-4,
    "rates come from differences, to eight digits or so; for fields on symmetric regions "
    "they are equal",
    third_answer="the point is listed, and its directions are said to be not computed",
)
is_without_quadratic_terms = Decision(
    "without quadratic terms",
    "the directions of branches at a double singular point of a large problem are those "
    "of third order",
    "quadratic terms of the equations on the null space, over the crossing speed",
    1e-5,
    "differences leave 1e-9 where symmetry forbids them",
    third_answer="the point is listed with the order from which its directions come",
)
is_multiple_line = Decision(
    "multiple line of a form",
    "two lines on which a binary form vanishes are one, or nearly, and their number is "
    "open",
    "an extremum of the form on the unit circle, over the size of what it is made of",
    1e-3,
    "third derivatives by differences are right to 1e-5",
    third_answer="the point is listed, and its directions are said to be not computed",
)
is_located = Decision(
    "located",
    "the iteration for a singular point has settled, and what it came to is looked at",
    "last step over the scale",
    1e-4,
    "at singular points it is 1e-9 and less, at points of high order, too",
    Role.LOOK,
)
is_hidden_by = Decision(
    "points that rounding does not separate",
    "two singular points of which no section from nearby shows more are one",
    "how far they are apart over the errors of both",
    10.0,
    "along a contact of high order doubles see singular points up to a few errors apart",
    third_answer="others stay two, with the half-branches that second order gives",
)
solves_exactly = Decision(
    "solution of exact equations",
    "what is left of F at a singular point in many digits is rounding",
    "what no move removes of F, over the magnitude and the scale, over the sum of what "
    "rounded coefficients leave, the square of the error and 1e-26",
    100.0,
    "where there is such a point F is of the second order of the error; where branches "
    "pass each other by 1e-12 of the scale it is 1e-24",
    third_answer="what misses by more, and by no more than doubles see, is a point in "
    "doubt; beyond that there is none, and a near miss at most",
)
is_precise_enough = Decision(
    "located to rounding",
    "doubles know the place of a singular point, which need not be found in more digits",
    "its error over the scale",
    1e-9,
    "at a simple point it is 1e-11 and less, at others 1e-8 and more",
    Role.LOOK,
)
is_double_assembly = Decision(
    "double assembly",
    "two isolated solutions come together where nothing moves, and no more than two",
    "error over the scale of the place that is located",
    3e-8,
    "at a double solution it is 1e-9 and less; where three come together 1e-6 and more",
    third_answer="what comes together counts as one assembly, in doubt",
)
is_lost_in_rounding = Decision(
    "lost in rounding",
    "doubles lose a branch beside a singular point of high order, and the germ has it",
    "smallest regular singular value on the branch",
    1e-5,
    "there a place is known to 1e-10, and another branch is no nearer than 1e-5 or so; "
    "branches were seen to be lost below 1e-7",
    Role.LOOK,
)
is_simple = Decision(
    "simple singular point",
    "the iteration comes back to a point at once, which is known to rounding",
    "second step over the first, in hundredths; or the distance from the point over "
    "what is allowed",
    1.0,
    "at a point of higher order the second step is half as long as the first",
    third_answer="of any other point the stretch is measured that rounding hides, which "
    "is its error",
)
has_no_form = Decision(
    "no quadratic form",
    "second order says nothing about the tangents",
    "size of the forms W^T F''(V x, V x)",
    1e-7,
    "they are exact to rounding times the error of the point; a section decides, and "
    "the forms give the tangents where they agree with it",
    Role.LOOK,
)
is_zero_form = Decision(
    "value of a quadratic form",
    "a discriminant, a resultant or a value of a form is zero",
    "the number, for coefficients of unit length",
    1e-6,
    "the coefficients are exact to rounding times the error of the point",
)
leaves_to_same_side = Decision(
    "cusp",
    "two half-branches leave a singular point to the same side",
    "one less the cosine of the angle between them, on a small sphere",
    0.5,
    "they are halves of one branch, so that it tends to 0 or 2; at a fiftieth of the "
    "scale it is 0.04 at an ordinary cusp",
    third_answer="between this and a pass the point is undecided, unless exact "
    "equations tell",
)
leaves_to_other_side = Decision(
    "pass of a single branch",
    "two half-branches leave a singular point to opposite sides",
    "one and the cosine of the angle between them, on a small sphere",
    0.5,
    "as for a cusp; where a smooth branch passes it is of the order of the square of "
    "the radius",
    third_answer="between this and a cusp the point is undecided, unless exact "
    "equations tell",
)
settles = Decision(
    "half-branches that settle",
    "two half-branches on a smaller sphere are as near to each other as on a larger one, "
    "or to opposite directions, or nearer",
    "change of the cosine of the angle between them against that",
    1e-3,
    "on half the sphere the angle at a cusp shrinks by a quarter or more; where a "
    "branch with infinite curvature passes it grows as much",
    third_answer="else the sections are in doubt, and other radii are tried",
)
is_zero_coefficient = Decision(
    "term of a germ",
    "a coefficient of the equation that is left at a singular point is zero, or a root "
    "of it real",
    "its size over the largest, in many digits",
    1e-50,
    "what vanishes is 1e-60 and less, what decides and does not 1e-10 and more",
    third_answer="where one that decides is up to 1e25 times larger the germ says "
    "nothing, and sections in doubles decide",
)
is_same_coefficient = Decision(
    "two halves of a branch",
    "two half-branches have the same coefficient, and so are halves of one branch",
    "difference over the coefficient, in many digits",
    1e-20,
    "it is 1e-35 and less; the roots on an edge differ by 1e-10 and more",
)
may_fill_null_space = Decision(
    "probe that stays",
    "the solutions may fill the null space, and are looked at above it",
    "share that projection takes from a probe",
    0.05,
    "curvature takes a share of the order of the probe's length, 0.005; where it takes "
    "more the ends of the probes tell the dimension, and are looked at as well",
    Role.LOOK,
)
fills_null_space = Decision(
    "surface or curve",
    "the solutions at the end of a probe fill the null space there",
    "share that projection takes from probes a hundred times shorter",
    1e-2,
    "curvature takes a share of the order of their length, 5e-5; on a curve all of one "
    "is taken",
)
is_across_span = Decision(
    "direction of a span",
    "the ends of probes do not spread in a direction, but for curvature",
    "spread over the length of the probes",
    0.05,
    "curvature spreads them by a share of the order of that length, 0.005",
    third_answer="where they seem to fill the null space they are looked at above it",
)
is_same_half_branch = Decision(
    "same half-branch",
    "two solutions on a small sphere are one",
    "distance over the radius of the sphere",
    1e-4,
    "they are exact to rounding over the radius, but on a curve of singular points",
    third_answer="where the section does not show what was traced the point is "
    "undecided",
)
fills_circle = Decision(
    "full circle",
    "all of a small circle in the null space solves the reduced equations",
    "largest value on the circle, over rounding there",
    1.0,
    "on a surface it is rounding, a tenth of this",
    third_answer="a surface that misses by more than rounding may be curves, and that "
    "is said",
)
is_on_circle = Decision(
    "zero on a circle",
    "a zero of one combination of the reduced equations is one of all",
    "what the others leave there, over what rounding makes of a zero",
    1.0,
    "at a zero of all of them it is rounding; at others of the order of the largest "
    "value on the circle, 1e10",
    third_answer="where sections of two radii disagree, or other half-branches are traced "
    "than seen, the point is undecided or the disagreement is said",
)
is_on_sphere = Decision(
    "solution on a sphere",
    "the iteration from a start on a small sphere has reached a solution",
    "residual over 1e-8 of the square of the radius, or last step over 1e-4 of it",
    1.0,
    "next to the point F is of the order of the square, whatever the direction",
    Role.LOOK,
)

# --- identity of points and curves ----------------------------------------------------

may_be_weak = Decision(
    "weak direction",
    "rounding may hide more of a direction than the distance at which two points are "
    "one, and what it hides is looked at",
    "smallest regular singular value",
    1e-5,
    "twenty times rounding over it is 2e-9",
    Role.LOOK,
)
may_be_known = Decision(
    "known place",
    "a seed or a start lies on a known curve, or a minimum at a known point, and nothing "
    "is traced or located from it",
    "distance over the scale; over what rounding leaves of it where that is more",
    1e-6,
    "seeds are exact to 1e-13, near singular points to half the digits; what is traced "
    "or located in vain turns out to be the known one",
    Role.LOOK,
)
is_same_point = Decision(
    "same point",
    "two points are one, or two curves",
    "distance over the scale",
    1e-6,
    "points are exact to 1e-13, near singular points to half the digits; on a curve of "
    "singular points they lie at any distance",
    third_answer="such points have no half-branches that were traced, and are "
    "undecided",
)
is_in_bounds = Decision(
    "in the bounds",
    "a point of a curve lies within the bounds, or in one of them",
    "how far it lies outside, over the scale",
    1e-9,
    "points of a curve that runs in a bound lie outside by rounding, 1e-13 and beside "
    "singular points 1e-10; a curve that leaves is farther outside soon after, and its "
    "exit is where it crosses the bound",
)
is_back = Decision(
    "closed",
    "a curve has come back to its start",
    "distance from the start over 1e-9 of the scale; or, if that is less, over what is "
    "known of the place, or F' times it over thirty times the tolerance of the pieces",
    1.0,
    "it is a hundredth of this; other turns of a curve are farther away",
    third_answer="a curve that goes on and passes the same places again is not certified, "
    "and in doubt",
)
is_nearly_back = Decision(
    "closed near motion",
    "a curve along which the system is nearly solved has come back to its start",
    "as for an exact curve",
    1.0,
    "such a curve comes back beside itself, and its pieces are as exact as that",
    Role.CONVENTION,
)
is_other_way = Decision(
    "other way",
    "a curve passes its start in another direction, and goes on",
    "cosine of the angle between the two passes",
    0.9,
    "where it closes it is 1 to rounding over what is known of the curve",
)
is_passed = Decision(
    "pass of a singular point",
    "a curve passes a singular point, and not only beside it",
    "distance over the scale, less the error of the point",
    5e-4,
    "half of the distance up to which arcs are certified; a minimum that leads to a "
    "point farther away lies beside another arc",
    third_answer="an arc that is not handed over there is looked at like any other, and "
    "in the end said to be not certified",
)
may_pass_beside = Decision(
    "pass beside a singular point",
    "a branch that comes nearest to a singular point within its error may pass it",
    "smallest regular singular value on the branch there",
    1e-5,
    "where rounding hides the place of a point it is 2e-6 and less on its branches, "
    "and 1e-3 on another one",
    third_answer="the point has a note: other half-branches were traced than seen",
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
    "its largest rate; over a hundred times what is known of the form where that is "
    "more",
    1e-8,
    "rates are exact to 1e-11",
    third_answer="an unknown with a larger rate that rounding may have made is in doubt",
)
rests = Decision(
    "rests",
    "an unknown stands still on a stretch of a curve",
    "its largest rate there",
    1e-8,
    "rates are exact to 1e-12",
    third_answer="of what neither rests nor moves nothing is said: a curve has jumped "
    "where what rests moves on the next stretch",
)
is_slow = Decision(
    "slow",
    "an unknown may stand still on another stretch of the same curve",
    "its largest rate on this stretch",
    1e-4,
    "what moves does so at a rate of about 1 somewhere, but for a moment",
    third_answer="as for what rests",
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
    "features of mirror images differ by rounding, about 1e-13; either order is one",
    Role.CONVENTION,
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
    "the slope comes from a central difference of F', exact to 1e-10; it is as small "
    "beside every minimum, which is told from the slopes on its two sides",
    Role.LOOK,
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
    third_answer="what is refused is divided and looked at again, and in the end said to "
    "be not certified",
)
is_closed_to_rounding = Decision(
    "solution to rounding",
    "only rounding is in the way of a certificate, and no jump",
    "residual along a refused arc",
    2e-14,
    "rounding is some 1e-15; over a jump between sheets the residual is what they differ",
    third_answer="on either side the arc is said to be not certified, and where",
)

is_solved_from_afar = Decision(
    "solution of unknown size",
    "what a start about 0 leads to is a solution, and shows how large the unknowns are",
    "residual over F' times the size of the unknowns",
    1e-8,
    "only a scale is taken from it; at a solution it is 1e-13, or 1e-8 at singular ones",
    Role.LOOK,
)
is_whole_circle = Decision(
    "whole circle",
    "the bounds of an unknown with a period hold its whole circle, and limit nothing",
    "what the bounds are less than one period apart, over the period",
    1e-6,
    "a full turn is written with 7 digits or more; a limit leaves a visible part "
    "of it out",
    Role.CONVENTION,
)

is_period = Decision(
    "period of the equations",
    "the equations are the same one period on, but for their signs or a constant",
    "by how much they differ, over their size and F' times the period",
    1e-4,
    "a period is written with 7 digits or more; equations of another period differ by "
    "as much as they are large at some of the points",
)

# --- diagrams -------------------------------------------------------------------------

is_on_axis = Decision(
    "on the imaginary axis",
    "an eigenvalue has no real part",
    "size of its real part over what a change of the place by 1e-12 of the sizes, and "
    "rounding of the entries of F', make of the eigenvalue",
    3.0,
    "places are exact to 1e-13; where an eigenvalue crosses the axis it is this small on "
    "a stretch of 1e-12 only",
    third_answer="a stretch of a form on which most places show one is neutral, neither "
    "stable nor unstable",
)
is_real_crossing = Decision(
    "real crossing",
    "the eigenvalue that crosses the imaginary axis is real, and there is no Hopf point",
    "its imaginary part over what rounding makes of it",
    3.0,
    "two eigenvalues that meet on the real axis are exact to half the digits",
)
is_fold_of_crossing = Decision(
    "turning branch",
    "a parameter turns back at a crossing of branches, and not at a fold beside it",
    "distance from the crossing over the scale, less the error of the crossing",
    1e-6,
    "both are exact to 1e-8 where they are one; a fold beside a crossing is as far from "
    "it as its branch is bent",
)
is_event = Decision(
    "event",
    "a function that is steeper than samples show is zero where it changes sign",
    "its value there over the larger of those 1e-9 of the length of the form beside it",
    0.1,
    "it is 1 at a jump and 1e7 at a pole; of a cube root it is 5e-3, and less of what is "
    "less steep",
    third_answer="a change of sign that is no zero is said to be a jump",
)

is_event_all_along = Decision(
    "event all along",
    "a function has its value everywhere on a form, and there is no event",
    "the largest difference on the form over the largest a tenth of the scale off it",
    1e-9,
    "forms are followed to 1e-13 of the scale",
)

is_same_turn = Decision(
    "turn of a function",
    "a function gains the same in every turn of an unknown, or nothing, or two values are "
    "a whole turn apart",
    "difference over the size of the function, or over the turn",
    1e-9,
    "it is rounding, 1e-15; of a function that is none on the circle it is of order 1",
    third_answer="such a function is taken within half a period of 0, and that is said",
)
hides_turning = Decision(
    "unknown at rest",
    "rounding hides whether an unknown, or the parameter, grows or falls",
    "its rate along a form over a bound on its largest one there",
    1e-12,
    "rates are exact to 1e-13, beside crossings to 3e-14 over the distance",
    third_answer="the stretch that is hidden is the error of the fold, and a fold whose "
    "stretch reaches a singular point is that one",
)
jumps_at_turning = Decision(
    "unknown at rest between pieces",
    "the error of the pieces hides whether an unknown grows or falls",
    "its rate on a piece over what the rates of that piece and its neighbours differ by "
    "where they meet",
    3.0,
    "pieces are as exact elsewhere as where they meet, or more; they differ by 4e-14 to "
    "1.5e-9 of the largest rate over the catalogue, and the rate passes that to both "
    "sides where an unknown turns back",
    third_answer="as for an unknown at rest",
)
is_drawn_to_point = Decision(
    "fold at a singular point",
    "Newton's method for a fold goes to a singular point, and there is no fold",
    "distance from the point after it over that before; or over three errors of the point",
    0.01,
    "at a cusp it comes to the point by the power of 2/3 or less a step; a fold of its own "
    "stays where it is, and the quotient is 1",
)

TABLE = decisions_in(globals())
