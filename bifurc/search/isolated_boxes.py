"""All solutions of as many equations as unknowns within bounds, by boxes.

The bounds are divided until every box is settled. A box is empty where bounds on F, or on
F in the middle and on F' in the box, leave out zero; it holds a single solution where
Krawczyk's operator (1969) maps it into itself. A box is cut in the unknown that changes
the equations most (Kearfott 1996), so that neither units nor sizes matter: a solution
1e-15 of the bounds is fifty cuts away. All bounds are intervals rounded outwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.completeness import Claim, Level, Scope
from bifurc.domain import Domain
from bifurc.equations.tape import Operation, Tape
from bifurc.limits import is_time_over
from bifurc.search.answer.completeness import SearchClaim
from bifurc.search.crossings import leave_out_zero

MOST_UNKNOWNS = 4
WIDER = 0.05  # of a box to either side: a solution on its rim is inside then
FEWEST_ULPS = 64.0  # widths of a box, in units in the last place, that is not cut
LEAST = 1e-20  # of the bounds: a box about zero that is not cut
TURN = 0.5 + 1e-9  # of a period to either side of 0
AT_ONCE = 2048
MOST_OPEN = 6000  # boxes that wait: where there are more, solutions are no points
NEWTON_STEPS = 6
PRODUCTS = 1e-14  # rounding of products of matrices, over their sizes
OUTWARDS = 1.0 + PRODUCTS  # makes a bound of what is rounded


@dataclass(frozen=True, eq=False)
class IsolatedInBoxes:
    """What became of ``count`` boxes: ``points`` (k, n) are solutions, one each in boxes
    that hold no other, ``left`` (j, n, 2) the boxes that are not settled."""

    count: int
    points: np.ndarray
    left: np.ndarray

    @property
    def is_complete(self) -> bool:
        """Whether the points are all solutions there are."""
        return not len(self.left)

    @property
    def claim(self) -> Claim:
        """What is said of the solutions where they are all."""
        kind = SearchClaim.BOXES_OF_SOLUTIONS
        return kind.claim(Scope.ASSEMBLIES, Level.COUNTED, boxes=self.count)


class _Boxes(NamedTuple):
    """Boxes from ``low`` (k, n) to ``high`` (k, n)."""

    low: np.ndarray
    high: np.ndarray

    def at(self, chosen: np.ndarray) -> _Boxes:
        return _Boxes(self.low[chosen], self.high[chosen])

    def wider(self) -> _Boxes:
        margins = WIDER * (self.high - self.low)
        return _Boxes(self.low - margins, self.high + margins)

    def and_others(self, others: _Boxes) -> _Boxes:
        low, high = zip(self, others, strict=True)
        return _Boxes(np.concatenate(low), np.concatenate(high))

    def reaches(self, middles: np.ndarray) -> np.ndarray:
        """How far each reaches (k, n) from ``middles`` (k, n), which are rounded."""
        farther: np.ndarray = np.maximum(self.high - middles, middles - self.low)
        return OUTWARDS * farther

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which boxes hold the points (k, n), one each."""
        return np.asarray(np.all((self.low <= points) & (points <= self.high), axis=1))


class _Verdicts(NamedTuple):
    """Of boxes (k,): what ``is_empty``, what ``is_single``; what is ``left`` of each, and
    how much each unknown changes the equations in it, ``shares`` (k, n)."""

    is_empty: np.ndarray
    is_single: np.ndarray
    left: _Boxes
    shares: np.ndarray


def isolated_in_boxes(tape: Tape, domain: Domain, most: int) -> IsolatedInBoxes | None:
    """The solutions of as many recorded equations as unknowns within bounds, from ``most``
    boxes; None where they are not as many, or too many, jump or have no bounds."""
    is_small = tape.m == tape.n <= MOST_UNKNOWNS
    if not is_small or np.any(tape.operations == Operation.ANGLE):
        return None
    bounds = _region(tape, domain)
    if not np.all(np.isfinite(bounds)):
        return None
    division = _Division(tape, bounds)
    while division.is_open and division.count < most and not is_time_over():
        division.judge_some()
    points = _solutions(tape, division.singles, domain)
    left = division.left.and_others(division.waiting)
    return IsolatedInBoxes(division.count, points, np.stack(left, axis=2))


class _Division:
    """A subdivision of ``bounds`` (n, 2) under way: boxes ``waiting``, ``singles`` that
    hold a solution each, and what is ``left`` as it is too small to be cut."""

    def __init__(self, tape: Tape, bounds: np.ndarray):
        self.tape = tape
        self.widths = np.diff(bounds, axis=1)[:, 0]
        self.waiting = _Boxes(bounds[None, :, 0], bounds[None, :, 1])
        self.singles = self.left = self.waiting.at(np.zeros(1, dtype=bool))
        self.count = 0

    @property
    def is_open(self) -> bool:
        """Whether boxes wait, and not as many as along a curve."""
        return 0 < len(self.waiting.low) < MOST_OPEN

    def judge_some(self) -> None:
        """Settle the first of the boxes that wait, or cut them."""
        now, later = _divided(self.waiting)
        self.count += len(now.low)
        verdicts = _judged(self.tape, now, self.widths)
        self.singles = self.singles.and_others(now.at(verdicts.is_single))
        is_open = ~verdicts.is_empty & ~verdicts.is_single
        rest = verdicts.left.at(is_open)
        can_be_cut = _can_be_cut(rest, LEAST * self.widths)
        is_small = np.asarray(~can_be_cut.any(axis=1))
        self.left = self.left.and_others(rest.at(is_small))
        shares = np.where(can_be_cut, verdicts.shares[is_open], -1.0)[~is_small]
        self.waiting = _halves(rest.at(~is_small), shares).and_others(later)


def _region(tape: Tape, domain: Domain) -> np.ndarray:
    """The bounds (n, 2), of a circle one period and a little more, of others what counts
    as inside, unless the equations are defined on one side of a bound only."""
    is_circle = np.isfinite(domain.periods) & np.isinf(domain.bounds).all(axis=1)
    half = np.where(is_circle, TURN * domain.periods, 0.0)
    turn = np.column_stack([-half, half])
    bounds = np.where(is_circle[:, None], turn, domain.bounds)
    wider = bounds.copy()
    for unknown in np.flatnonzero(~is_circle).tolist():
        for side, slack in enumerate((-domain.slack, domain.slack)):
            beyond = _defined_beside(tape, bounds, unknown, side, slack)
            inside = _defined_beside(tape, bounds, unknown, side, -slack)
            if np.all(beyond >= inside):
                wider[unknown, side] += slack
    return wider


def _defined_beside(
    tape: Tape, bounds: np.ndarray, unknown: int, side: int, slack: float
) -> np.ndarray:
    """Which of the values of F and F' are bounded from one of the ``bounds`` (n, 2) to
    ``slack`` beyond it."""
    slab = bounds.copy()
    slab[unknown] = np.sort(bounds[unknown, side] + [0.0, slack])
    ends = [np.ascontiguousarray(column[None]) for column in slab.T]
    values = (*tape.compiled.value_bounds(*ends), *tape.compiled.jacobian_bounds(*ends))
    are_bounded: np.ndarray = np.isfinite(
        np.concatenate([value.ravel() for value in values])
    )
    return are_bounded


def _divided(boxes: _Boxes) -> tuple[_Boxes, _Boxes]:
    """The boxes that are looked at now, and those that wait."""
    return (
        _Boxes(boxes.low[:AT_ONCE], boxes.high[:AT_ONCE]),
        _Boxes(boxes.low[AT_ONCE:], boxes.high[AT_ONCE:]),
    )


def _judged(tape: Tape, boxes: _Boxes, widths: np.ndarray) -> _Verdicts:
    """What bounds on F and F' show of boxes; ``widths`` (n,) are those of the bounds."""
    middles = 0.5 * (boxes.low + boxes.high)
    at_middle = tape.compiled.value_bounds(middles, middles)
    changes = _changes(tape, boxes, middles)
    reach = changes.sum(axis=2)
    values = tape.compiled.value_bounds(*map(np.ascontiguousarray, boxes))
    is_empty = np.any(leave_out_zero(values, at_middle, reach), axis=1)
    wide = boxes.wider()
    mapped = _krawczyk(tape, wide, middles, at_middle)
    is_single = ((mapped.low > wide.low) & (mapped.high < wide.high)).all(axis=1)
    rest = _Boxes(
        np.maximum(boxes.low, mapped.low), np.minimum(boxes.high, mapped.high)
    )
    is_empty = np.asarray(is_empty | (rest.low > rest.high).any(axis=1))
    shares = _shares(changes, (boxes.high - boxes.low) / widths)
    return _Verdicts(is_empty, is_single & ~is_empty, rest, shares)


def _shares(changes: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """The largest share (k, n) that each unknown has in the ``changes`` (k, m, n) of an
    equation; where these are not known, the ``widths`` (k, n)."""
    with np.errstate(all="ignore"):  # an equation may not change at all
        shares = (changes / changes.sum(axis=2, keepdims=True)).max(axis=1)
    is_known = np.isfinite(shares).all(axis=1, keepdims=True)
    return np.where(is_known, shares, widths)


def _changes(tape: Tape, boxes: _Boxes, middles: np.ndarray) -> np.ndarray:
    """Bounds (k, m, n) on what each unknown changes the equations by from the
    ``middles`` (k, n) of boxes; their sums are bounds as well."""
    least, most = tape.compiled.jacobian_bounds(*map(np.ascontiguousarray, boxes))
    reaches = OUTWARDS * boxes.reaches(middles)[:, None]
    changes: np.ndarray = np.maximum(np.abs(least), np.abs(most)) * reaches
    return changes


def _krawczyk(
    tape: Tape,
    boxes: _Boxes,
    middles: np.ndarray,
    values: tuple[np.ndarray, np.ndarray],
) -> _Boxes:
    """The boxes that Krawczyk's operator makes of others, with bounds on F in the
    ``middles`` (k, n); infinite ones where F' is singular or not finite."""
    slopes, rows = _slopes_in(tape, boxes)
    chosen = _regular(slopes.center)
    low, high = np.full(middles.shape, -np.inf), np.full(middles.shape, np.inf)
    if not len(chosen):
        return _Boxes(low, high)
    ends = [value[chosen, :, None] / rows[chosen] for value in values]
    half = boxes.reaches(middles)[chosen, :, None]
    value, spread = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
    step, reach = slopes.at(chosen).newton_step(value, spread, half)
    # what overflows shows nothing
    lowest = np.nextafter(middles[chosen] - (step + reach), -np.inf)
    highest = np.nextafter(middles[chosen] - (step - reach), np.inf)
    low[chosen] = np.where(np.isnan(lowest), -np.inf, lowest)
    high[chosen] = np.where(np.isnan(highest), np.inf, highest)
    return _Boxes(low, high)


def _slopes_in(tape: Tape, boxes: _Boxes) -> tuple[_Slopes, np.ndarray]:
    """F' in boxes over the size of each row (k, n, 1), and these sizes."""
    least, most = tape.compiled.jacobian_bounds(*map(np.ascontiguousarray, boxes))
    rows = np.maximum(np.abs(least), np.abs(most)).max(axis=2, keepdims=True)
    with np.errstate(all="ignore"):  # F' may vanish, or not be finite
        return _Slopes(0.5 * (least + most) / rows, 0.5 * (most - least) / rows), rows


def _regular(matrices: np.ndarray) -> np.ndarray:
    """The numbers of those of the matrices (k, n, n) that are finite and regular."""
    is_regular = np.isfinite(matrices).all(axis=(1, 2))
    is_regular[is_regular] = np.linalg.det(matrices[is_regular]) != 0.0
    return np.flatnonzero(is_regular)


class _Slopes(NamedTuple):
    """F' in boxes: within a ``radius`` of a ``center``, both (k, n, n)."""

    center: np.ndarray
    radius: np.ndarray

    def at(self, chosen: np.ndarray) -> _Slopes:
        """Those in some of the boxes."""
        return _Slopes(self.center[chosen], self.radius[chosen])

    def newton_step(
        self, value: np.ndarray, spread: np.ndarray, half: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Newton's step (k, n) for F within a ``spread`` of a ``value``, and how far from
        there Krawczyk's operator reaches (k, n) in boxes of ``half`` widths; all
        (k, n, 1)."""
        inverse = np.linalg.inv(self.center)
        sizes = np.abs(inverse)
        # the rounding of these products is far less than the last term
        radius = self.radius + PRODUCTS * np.abs(self.center)
        identity = np.eye(self.center.shape[1])
        left_over = np.abs(identity - inverse @ self.center) + sizes @ radius
        reach = left_over @ half + sizes @ (spread + PRODUCTS * np.abs(value))
        return (inverse @ value)[:, :, 0], OUTWARDS * reach[:, :, 0]


def _can_be_cut(boxes: _Boxes, least: np.ndarray) -> np.ndarray:
    """In which unknowns (k, n) rounding lets boxes be cut."""
    farthest = np.maximum(np.abs(boxes.low), np.abs(boxes.high))
    limit = np.maximum(FEWEST_ULPS * np.spacing(farthest), least)
    can_be_cut: np.ndarray = boxes.high - boxes.low > limit
    return can_be_cut


def _halves(boxes: _Boxes, shares: np.ndarray) -> _Boxes:
    """Each box cut in half in the unknown of the largest of its shares (k, n)."""
    rows = np.arange(len(boxes.low))
    sides = np.argmax(shares, axis=1)
    cuts = 0.5 * (boxes.low + boxes.high)[rows, sides]
    first, second = boxes.high.copy(), boxes.low.copy()
    first[rows, sides] = cuts
    second[rows, sides] = cuts
    return _Boxes(boxes.low, first).and_others(_Boxes(second, boxes.high))


def _solutions(tape: Tape, singles: _Boxes, domain: Domain) -> np.ndarray:
    """The solutions (k, n) in boxes that hold one each, those in the bounds, each
    once."""
    points = 0.5 * (singles.low + singles.high)
    for _ in range(NEWTON_STEPS):
        values = tape.compiled.residuals(np.ascontiguousarray(points))
        matrices = tape.compiled.jacobians(np.ascontiguousarray(points))
        if len(points):
            points = points - np.linalg.solve(matrices, values[:, :, None])[:, :, 0]
    wide = singles.wider()
    kept: list[int] = []
    for k in np.flatnonzero(domain.are_inside(points)).tolist():
        seen = wide.at(np.array(kept, dtype=int))
        gaps = domain.difference(
            np.repeat(points[[k]], len(kept), axis=0), points[kept]
        )
        if not np.any(seen.holds(points[kept] + gaps)):
            kept.append(k)
    solutions: np.ndarray = points[kept]
    return solutions
