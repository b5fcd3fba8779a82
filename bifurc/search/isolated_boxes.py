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

MOST_UNKNOWNS = 4
WIDER = 0.05  # of a box to either side: a solution on its rim is inside then
FEWEST_ULPS = 64.0  # widths of a box, in units in the last place, that is not cut
LEAST = 1e-20  # of the bounds: a box about zero that is not cut
TURN = 0.5 + 1e-9  # of a period to either side of 0
AT_ONCE = 2048
MOST_OPEN = 6000  # boxes that wait: where there are more, solutions are no points
NEWTON_STEPS = 6
PRODUCTS = 1e-14  # rounding of products of matrices, over their sizes


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
        return kind.claim(Scope.ASSEMBLIES, Level.PROVED, boxes=self.count)


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
    if np.any(tape.operations == Operation.ANGLE):
        return None
    bounds = _region(domain)
    if tape.m != tape.n or tape.n > MOST_UNKNOWNS or not np.all(np.isfinite(bounds)):
        return None
    boxes = _Boxes(bounds[None, :, 0].copy(), bounds[None, :, 1].copy())
    widths = np.diff(bounds, axis=1)[:, 0]
    singles = left = boxes.at(np.zeros(1, dtype=bool))
    count = 0
    while len(boxes.low) and count < most and len(boxes.low) < MOST_OPEN:
        if is_time_over():
            break
        now, boxes = _divided(boxes)
        count += len(now.low)
        verdicts = _judged(tape, now, widths)
        singles = singles.and_others(now.at(verdicts.is_single))
        is_open = ~verdicts.is_empty & ~verdicts.is_single
        rest = verdicts.left.at(is_open)
        is_small = _is_small(rest, LEAST * widths)
        left = left.and_others(rest.at(is_small))
        shares = verdicts.shares[is_open][~is_small]
        boxes = _halves(rest.at(~is_small), shares).and_others(boxes)
    left = left.and_others(boxes)
    points = _solutions(tape, singles, domain)
    return IsolatedInBoxes(count, points, np.stack(left, axis=2))


def _region(domain: Domain) -> np.ndarray:
    """The bounds (n, 2), of a circle one period and a little more."""
    is_circle = np.isfinite(domain.periods) & np.isinf(domain.bounds).all(axis=1)
    half = np.where(is_circle, TURN * domain.periods, 0.0)
    turn = np.column_stack([-half, half])
    return np.where(is_circle[:, None], turn, domain.bounds)


def _divided(boxes: _Boxes) -> tuple[_Boxes, _Boxes]:
    """The boxes that are looked at now, and those that wait."""
    return (
        _Boxes(boxes.low[:AT_ONCE], boxes.high[:AT_ONCE]),
        _Boxes(boxes.low[AT_ONCE:], boxes.high[AT_ONCE:]),
    )


def _judged(tape: Tape, boxes: _Boxes, widths: np.ndarray) -> _Verdicts:
    """What bounds on F and F' show of boxes; ``widths`` (n,) are those of the bounds."""
    low, high = map(np.ascontiguousarray, boxes)
    middles = 0.5 * (low + high)
    at_middle = tape.compiled.value_bounds(middles, middles)
    lowest, highest = tape.compiled.value_bounds(low, high)
    half = 0.5 * (high - low)
    least, most = tape.compiled.jacobian_bounds(low, high)
    changes = np.maximum(np.abs(least), np.abs(most)) * half[:, None]  # (k, m, n)
    reach = changes.sum(axis=2)
    lowest = np.fmax(lowest, at_middle[0] - reach)
    highest = np.fmin(highest, at_middle[1] + reach)
    is_empty = ((lowest > 0.0) | (highest < 0.0)).any(axis=1)
    wide = boxes.wider()
    mapped = _krawczyk(tape, wide, middles, at_middle)
    is_single = ((mapped.low > wide.low) & (mapped.high < wide.high)).all(axis=1)
    rest = _Boxes(np.maximum(low, mapped.low), np.minimum(high, mapped.high))
    is_empty |= (rest.low > rest.high).any(axis=1)
    with np.errstate(all="ignore"):  # an equation may not change at all
        shares = (changes / reach[:, :, None]).max(axis=1)
    is_known = np.isfinite(shares).all(axis=1)
    shares = np.where(is_known[:, None], shares, half / widths)
    return _Verdicts(is_empty, is_single & ~is_empty, rest, shares)


def _krawczyk(
    tape: Tape,
    boxes: _Boxes,
    middles: np.ndarray,
    values: tuple[np.ndarray, np.ndarray],
) -> _Boxes:
    """The boxes that Krawczyk's operator makes of others, with bounds on F in the
    ``middles`` (k, n); infinite ones where F' is singular or not finite."""
    low, high = map(np.ascontiguousarray, boxes)
    count, n = low.shape
    mapped = _Boxes(np.full((count, n), -np.inf), np.full((count, n), np.inf))
    least, most = tape.compiled.jacobian_bounds(low, high)
    rows = np.maximum(np.abs(least), np.abs(most)).max(axis=2, keepdims=True)
    center = 0.5 * (least + most) / rows
    is_regular = np.isfinite(center).all(axis=(1, 2))
    is_regular[is_regular] = np.linalg.det(center[is_regular]) != 0.0
    chosen = np.flatnonzero(is_regular)
    if not len(chosen):
        return mapped
    center, rows = center[chosen], rows[chosen]
    inverse = np.linalg.inv(center)
    sizes = np.abs(inverse)
    # the rounding of these products is far less than the last term
    radius = 0.5 * (most - least)[chosen] / rows + PRODUCTS * np.abs(center)
    value = 0.5 * (values[0] + values[1])[chosen, :, None] / rows
    spread = 0.5 * (values[1] - values[0])[chosen, :, None] / rows
    left_over = np.abs(np.eye(n) - inverse @ center) + sizes @ radius
    half = 0.5 * (high - low)[chosen, :, None]
    reach = left_over @ half + sizes @ (spread + PRODUCTS * np.abs(value))
    ends = middles[chosen] - (inverse @ value)[:, :, 0]
    is_known = np.isfinite(ends + reach[:, :, 0]).all(axis=1)
    mapped.low[chosen[is_known]] = (ends - reach[:, :, 0])[is_known]
    mapped.high[chosen[is_known]] = (ends + reach[:, :, 0])[is_known]
    return mapped


def _is_small(boxes: _Boxes, least: np.ndarray) -> np.ndarray:
    """Which boxes (k,) rounding does not let be cut any more."""
    farthest = np.maximum(np.abs(boxes.low), np.abs(boxes.high))
    limit = np.maximum(FEWEST_ULPS * np.spacing(farthest), least)
    is_small: np.ndarray = (boxes.high - boxes.low <= limit).all(axis=1)
    return is_small


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
