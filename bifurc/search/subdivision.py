"""Boxes in which exact equations have no solution, or a single arc of a known branch.

The bounds are divided until every box is settled. A box is empty where bounds on F, or
on F in the middle and on F' in the box, leave out zero. It holds a single arc where
Krawczyk's test (1969), with one unknown as the parameter, finds one solution of the
others for each of its values: a branch through one of these solutions is that arc. The
branches are held against the same bounds all along. What remains lies about singular
points. F and F' are bounded with directed rounding, the few matrices of a box are not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bifurc.branch import Branch
from bifurc.decisions import is_same_point
from bifurc.problem import Problem
from bifurc.search.stretches import verify_branch
from bifurc.singular.invariants import CROSSING, LONE_POINT
from bifurc.singular.point import SingularPoint

__all__ = ["Subdivision", "can_be_subdivided", "subdivide"]

MOST_UNKNOWNS = 4
FIRST_BOXES = 256
ENOUGH = 30  # solutions on unknown arcs, to trace before boxes are divided further
MOST_LEFT = 24  # places that are listed of what is not settled
SMALLEST = 1e-7  # radius of a box, over the scale, that is not divided any more
# Times as wide as in the unknown along which F changes most: there a box is cut.
THIN = 32
WIDER = 4.0  # times as wide as a box is where its arc may run: one that touches a corner, too
NEWTON_STEPS = 5
SOLVED = 1e-9  # over the scale: |F| where Newton's method has settled
DETOUR = 2.0  # times as long as its chord a branch may be from one place to the next
# Radii, over the scale, about singular points in which nothing is claimed: of ordinary
# crossings and others, where branches may run very close to each other.
BESIDE_CROSSING = 1e-5
BESIDE_OTHER = 0.03
STRICTLY = 0.999  # of the width in which an arc may run: where it has to
PLACES = np.array([-1.0, 0.0, 1.0])  # of the parameter, at which an arc is looked at


@dataclass(frozen=True, eq=False)
class Subdivision:
    """What became of ``count`` boxes.

    ``found`` (k, n) are solutions on arcs of no known branch, ``left`` (j, n) middles of
    boxes that are not settled, `MOST_LEFT` at most, ``refuted`` numbers of branches with
    arclengths at which they solve nothing. Within ``beside`` of singular points, in
    scales, nothing was looked at.
    """

    count: int
    found: np.ndarray
    left: np.ndarray
    refuted: tuple[tuple[int, float], ...]
    beside: float

    @property
    def is_complete(self) -> bool:
        """Whether the known branches are all, and each of them is one."""
        return not len(self.found) and not len(self.left) and not self.refuted


def can_be_subdivided(problem: Problem) -> bool:
    """Whether there are few enough unknowns within finite bounds, one equation less,
    and bounds on F."""
    if not 2 <= problem.n <= MOST_UNKNOWNS or not np.all(np.isfinite(_box(problem))):
        return False
    if np.any(problem.has_assumed_bounds):
        return False
    middle = _box(problem).mean(axis=1)[None]
    bounds = problem.value_bounds(middle, middle)
    return bounds is not None and bounds[0].shape[1] == problem.n - 1


def subdivide(
    problem: Problem,
    branches: Sequence[Branch],
    points: Sequence[SingularPoint],
    most: int,
    is_over: Callable[[], bool] = lambda: False,
) -> Subdivision:
    """The bounds divided into boxes, until all are settled, or enough is found to be
    traced first, or there would be more than ``most``, or the time ``is_over``."""
    division = _Division(problem, branches, points)
    with np.errstate(over="ignore", invalid="ignore"):  # bounds on F may be infinite
        division.verify_branches()
        low, high = _grid(_box(problem))
        while (
            len(low) and division.is_worth_while and division.count + len(low) <= most
        ):
            if is_over():
                break
            division.count += len(low)
            low, high = division.open_quarters(low, high)
    division.left.append(0.5 * (low + high))
    return division.result()


def _box(problem: Problem) -> np.ndarray:
    """The bounds (n, 2); of a circle one period."""
    periods = problem.periods
    turn = np.column_stack([np.zeros(problem.n), periods])
    is_circle = np.isfinite(periods) & np.isinf(problem.bounds[:, 0])
    box: np.ndarray = np.where(is_circle[:, None], turn, problem.bounds)
    return box


class _Boxes(NamedTuple):
    """Boxes with ``middles`` and ``radii`` (k, n) in which one unknown, the
    ``parameter``, tells solutions apart."""

    parameter: int
    middles: np.ndarray
    radii: np.ndarray

    @property
    def others(self) -> list[int]:
        """The unknowns but the parameter."""
        return [i for i in range(self.middles.shape[1]) if i != self.parameter]

    def at(self, numbers: np.ndarray) -> _Boxes:
        """Those with these numbers."""
        return _Boxes(self.parameter, self.middles[numbers], self.radii[numbers])


class _Slopes(NamedTuple):
    """What arcs in k boxes rise over the parameter, in radii of the box: ``middles``
    (k, n - 1), give or take ``spreads`` (k, n - 1)."""

    middles: np.ndarray
    spreads: np.ndarray

    def at(self, numbers: np.ndarray) -> _Slopes:
        """Those with these numbers."""
        return _Slopes(self.middles[numbers], self.spreads[numbers])


class _Feet(NamedTuple):
    """The numbers of the branches (k,) on which points lie, -1 for none, and the
    arclengths there (k,)."""

    branch: np.ndarray
    s: np.ndarray


class _Division:
    """A subdivision under way."""

    def __init__(
        self,
        problem: Problem,
        branches: Sequence[Branch],
        points: Sequence[SingularPoint],
    ):
        self.problem = problem
        self.branches = branches
        self.centers = np.array([p.u for p in points]).reshape(-1, problem.n)
        ordinary = (CROSSING, LONE_POINT)
        reaches = [
            BESIDE_CROSSING if p.invariants in ordinary else BESIDE_OTHER
            for p in points
        ]
        self.reaches = problem.scale * np.array(reaches)
        self.count = 0
        self.found: list[np.ndarray] = []
        self.left: list[np.ndarray] = []
        self.refuted: dict[int, float] = {}

    @property
    def is_worth_while(self) -> bool:
        """Whether there is more to see than what was found, which is to be traced
        first."""
        return sum(len(points) for points in self.found) < ENOUGH

    def verify_branches(self) -> None:
        """Note which branches are none, and where one is not known to be one."""
        for number, branch in enumerate(self.branches):
            known = verify_branch(self.problem, branch, self._are_beside_points)
            if known.misses is not None:
                self.refuted[number] = known.misses
            if known.open is not None:
                self.left.append(known.open[None])

    def result(self) -> Subdivision:
        nowhere = np.empty((0, self.problem.n))
        return Subdivision(
            count=self.count,
            found=np.concatenate([nowhere, *self.found]),
            left=self._apart(np.concatenate([nowhere, *self.left[::-1]])),
            refuted=tuple(self.refuted.items()),
            beside=float(self.reaches.max(initial=0.0)) / self.problem.scale,
        )

    def _apart(self, middles: np.ndarray) -> np.ndarray:
        """The first of points (k, n) that do not lie beside each other."""
        kept: list[np.ndarray] = []
        while len(middles) and len(kept) < MOST_LEFT:
            kept.append(middles[0])
            offsets = self.problem.difference(middles, middles[0])
            reach = BESIDE_CROSSING * self.problem.scale
            middles = middles[np.linalg.norm(offsets, axis=1) > reach]
        return np.array(kept).reshape(-1, self.problem.n)

    # --- one generation ---------------------------------------------------------------

    def open_quarters(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The quarters (j, n), (j, n) of those of the boxes (k, n), (k, n) that are not
        settled."""
        diagonals = 0.5 * np.linalg.norm(high - low, axis=1)
        is_open = ~self._are_beside_points(0.5 * (low + high), diagonals)
        low, high = low[is_open], high[is_open]
        is_empty = self._are_empty(low, high)
        low, high = low[~is_empty], high[~is_empty]
        radii = 0.5 * (high - low)
        jacobians, changes = self._jacobians(low, high, radii)
        is_open = ~self._are_settled(low, high, jacobians, changes)
        low, high, radii = low[is_open], high[is_open], radii[is_open]
        slopes = np.max(np.abs(jacobians[is_open]) + changes[is_open], axis=1)
        is_small = radii.max(axis=1, initial=0.0) < SMALLEST * self.problem.scale
        self.left.append(0.5 * (low + high)[is_small])
        low, high, slopes = low[~is_small], high[~is_small], slopes[~is_small]
        low, high, slopes = _halves(low, high, slopes)
        low, high, _ = _halves(low, high, slopes)
        return low, high

    def _are_beside_points(self, middles: np.ndarray, radii: np.ndarray) -> np.ndarray:
        """Which balls about ``middles`` (k, n) of ``radii`` (k,) lie beside a singular
        point."""
        beside: np.ndarray = np.zeros(len(middles), dtype=bool)
        for center, reach in zip(self.centers, self.reaches, strict=True):
            apart = np.linalg.norm(self.problem.difference(middles, center), axis=1)
            beside |= apart + radii < reach
        return beside

    def _are_empty(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Which boxes hold no solution, by the bounds on F alone."""
        lowest, highest = self._value_bounds(low, high)
        is_empty: np.ndarray = np.any((lowest > 0.0) | (highest < 0.0), axis=1)
        return is_empty

    # --- Krawczyk's test --------------------------------------------------------------

    def _are_settled(
        self,
        low: np.ndarray,
        high: np.ndarray,
        jacobians: np.ndarray,
        changes: np.ndarray,
    ) -> np.ndarray:
        """Which boxes (k, n), (k, n) are empty, or hold a single arc of which it is
        known which one; F' and its changes are in their radii."""
        settled = np.zeros(len(low), dtype=bool)
        middles, radii = 0.5 * (low + high), 0.5 * (high - low)
        parameters, is_regular = _parameters(jacobians)
        is_regular &= np.all(np.isfinite(changes), axis=(1, 2))
        for parameter in range(self.problem.n):
            chosen = np.flatnonzero(is_regular & (parameters == parameter))
            if len(chosen):
                boxes = (middles[chosen], radii[chosen])
                matrices = (jacobians[chosen], changes[chosen])
                settled[chosen] = self._are_settled_over(parameter, *boxes, *matrices)
        return settled

    def _are_settled_over(
        self,
        parameter: int,
        middles: np.ndarray,
        radii: np.ndarray,
        jacobians: np.ndarray,
        changes: np.ndarray,
    ) -> np.ndarray:
        """The same of boxes with one ``parameter``; F' is in their radii."""
        others = [i for i in range(self.problem.n) if i != parameter]
        inverses = np.linalg.inv(jacobians[:, :, others])
        lowest, highest = self._value_bounds(middles, middles)
        step = _times(inverses, -0.5 * (lowest + highest))
        blur = _times(np.abs(inverses), 0.5 * (highest - lowest))
        slopes = _times(inverses, jacobians[:, :, parameter])
        reach = np.abs(slopes) + _times(np.abs(inverses), changes.sum(axis=2)) + blur
        settled: np.ndarray = np.any(np.abs(step) > 1.0 + reach, axis=1)
        is_small = np.all(np.abs(step) + reach < WIDER, axis=1)
        may_hold = np.flatnonzero(is_small & ~settled)
        boxes = _Boxes(parameter, middles[may_hold], radii[may_hold])
        slope = self._slopes(
            boxes, inverses[may_hold], np.abs(step[may_hold]) + blur[may_hold]
        )
        holds = np.flatnonzero(np.all(np.isfinite(slope.spreads), axis=1))
        if len(holds):
            single = boxes.at(holds)
            points = self._solutions(
                single, step[may_hold[holds]], slope.middles[holds]
            )
            settled[may_hold[holds]] = self._are_known(single, points, slope.at(holds))
        return settled

    def _slopes(
        self, boxes: _Boxes, inverses: np.ndarray, offsets: np.ndarray
    ) -> _Slopes:
        """The slopes of the arcs over the parameter, at ``offsets`` (k, n - 1) from the
        middle at most; their spreads are infinite where Krawczyk's test does not find
        a single arc."""
        others = boxes.others
        widths = WIDER * boxes.radii
        widths[:, boxes.parameter] = boxes.radii[:, boxes.parameter]
        low, high = boxes.middles - widths, boxes.middles + widths
        jacobians, changes = self._jacobians(low, high, boxes.radii)
        products = inverses @ jacobians[:, :, others] - np.eye(len(others))
        margins = np.abs(inverses) @ changes
        slopes = -_times(inverses, jacobians[:, :, boxes.parameter])
        bends = np.sum(np.abs(products) + margins[:, :, others], axis=2)
        spreads = margins[:, :, boxes.parameter]
        reach = offsets + np.abs(slopes) + spreads + WIDER * bends
        holds = np.all(reach < STRICTLY * WIDER, axis=1)
        steepest = np.max(np.abs(slopes) + spreads, axis=1)
        bend = np.where(holds, bends.max(axis=1, initial=0.0), 0.0)
        spreads = spreads + bends * (steepest / (1.0 - bend))[:, None]
        return _Slopes(slopes, np.where(holds[:, None], spreads, np.inf))

    def _solutions(
        self, boxes: _Boxes, first: np.ndarray, slopes: np.ndarray
    ) -> np.ndarray:
        """Solutions (k, 3, n) at `PLACES` of the parameter in boxes with a single arc;
        ``first`` (k, n - 1) is about where, over the radii, it is in the middle."""
        others, parameter = boxes.others, boxes.parameter
        points = np.repeat(boxes.middles[:, None], len(PLACES), axis=1)
        offsets = first[:, None] + PLACES[:, None] * slopes[:, None]
        points[:, :, others] += offsets * boxes.radii[:, None, others]
        points[:, :, parameter] += PLACES * boxes.radii[:, None, parameter]
        flat = points.reshape(-1, self.problem.n)
        for _ in range(NEWTON_STEPS):
            values = self.problem.residuals(flat)
            matrices = self.problem.jacobians(flat)[:, :, others]
            flat[:, others] -= np.linalg.solve(matrices, values[:, :, None])[:, :, 0]
        return flat.reshape(points.shape)

    def _are_known(
        self, boxes: _Boxes, points: np.ndarray, slopes: _Slopes
    ) -> np.ndarray:
        """Of which boxes (k,), with ``points`` (k, 3, n) of a single arc, it is known
        all along; a solution on each one that is in part inside the bounds and on no
        branch is found, and settles the box too."""
        flat = points.reshape(-1, points.shape[2])
        sides = self._sides(flat).reshape(points.shape)
        outside = np.any(sides != 0, axis=2)
        feet = self._feet(flat)
        numbers = feet.branch.reshape(outside.shape)
        is_solved = self.problem.gaps(flat) < SOLVED * self.problem.scale
        is_solved = np.all(is_solved.reshape(outside.shape), axis=1)
        is_new = (numbers < 0) & ~outside & is_solved[:, None]
        new = np.any(is_new, axis=1)
        self.found.append(points[new, np.argmax(is_new[new], axis=1)])
        # an unknown that rises or falls all along passes a bound once
        is_steady = np.abs(slopes.middles) > slopes.spreads
        is_steady = np.insert(is_steady, boxes.parameter, True, axis=1)
        settled = is_solved.copy()
        for k in range(len(PLACES) - 1):
            before, after = sides[:, k], sides[:, k + 1]
            is_covered = self._are_covered(feet, points, k)
            stays = np.any((before == after) & (before != 0) & is_steady, axis=1)
            leaves = outside[:, k] != outside[:, k + 1]
            leaves &= np.all(is_steady | (before == after), axis=1)
            settled &= is_covered | stays | leaves
        known: np.ndarray = new | settled
        return known

    def _are_covered(self, feet: _Feet, points: np.ndarray, k: int) -> np.ndarray:
        """On which arcs (j,) one branch runs straight from place ``k`` of the ``points``
        (j, 3, n), of which the ``feet`` are given, to the next."""
        numbers = feet.branch.reshape(points.shape[:2])
        arclengths = feet.s.reshape(points.shape[:2])
        travelled = np.abs(arclengths[:, k + 1] - arclengths[:, k])
        lengths = np.array(
            [*(b.length if b.closed else np.inf for b in self.branches), 0]
        )
        travelled = np.minimum(travelled, np.abs(lengths[numbers[:, k]] - travelled))
        chords = np.linalg.norm(points[:, k + 1] - points[:, k], axis=1)
        is_one = (numbers[:, k] == numbers[:, k + 1]) & (numbers[:, k] >= 0)
        covered: np.ndarray = is_one & (travelled < DETOUR * chords)
        return covered

    def _sides(self, points: np.ndarray) -> np.ndarray:
        """To which side (k, n) of the bounds points (k, n) lie outside, 0 inside."""
        low, high = self.problem.bounds.T
        slack = self.problem.slack
        is_above = (points > high + slack).astype(int)
        sides: np.ndarray = is_above - (points < low - slack)
        return sides

    def _feet(self, points: np.ndarray) -> _Feet:
        """The branches on which points (k, n) lie."""
        feet = _Feet(np.full(len(points), -1), np.zeros(len(points)))
        within = is_same_point.threshold * self.problem.scale
        for number, branch in enumerate(self.branches):
            rest = np.flatnonzero(feet.branch < 0)
            distances, arclengths = branch.nearest(points[rest], within=within)
            is_on = is_same_point(distances, self.problem.scale)
            feet.branch[rest[is_on]] = number
            feet.s[rest[is_on]] = arclengths[is_on]
        return feet

    # --- bounds -----------------------------------------------------------------------

    def _value_bounds(
        self, low: np.ndarray, high: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        bounds = self.problem.value_bounds(low, high)
        assert bounds is not None
        return bounds

    def _jacobians(
        self, low: np.ndarray, high: np.ndarray, radii: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The middles (k, m, n) of the bounds on F' in boxes, times ``radii`` (k, n),
        and half their widths."""
        bounds = self.problem.jacobian_bounds(low, high)
        assert bounds is not None
        lowest, highest = bounds
        middles = 0.5 * (lowest + highest) * radii[:, None]
        widths = 0.5 * (highest - lowest) * radii[:, None]
        return middles, np.where(np.isfinite(middles), widths, np.inf)


def _grid(box: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """About `FIRST_BOXES` equal boxes (k, n), (k, n) that fill one (n, 2)."""
    n = len(box)
    count = round(FIRST_BOXES ** (1.0 / n))
    marks = np.linspace(box[:, 0], box[:, 1], count + 1)
    numbers = np.indices((count,) * n).reshape(n, -1).T
    columns = np.arange(n)
    return marks[numbers, columns], marks[numbers + 1, columns]


def _sides_to_cut(slopes: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """The unknown (k,) along which F may change most in each box, by ``slopes`` (k, n)
    times the radii (k, n), the widest one where that is not bounded, or the box is thin
    (Kearfott and Novoa 1990)."""
    steepest, widest = np.argmax(slopes, axis=1), np.argmax(radii, axis=1)
    rows = np.arange(len(radii))
    is_thin = THIN * radii[rows, steepest] < radii[rows, widest]
    is_bounded = np.all(np.isfinite(slopes), axis=1)
    sides: np.ndarray = np.where(is_thin | ~is_bounded, widest, steepest)
    return sides


def _halves(
    low: np.ndarray, high: np.ndarray, slopes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Boxes (2 k, n), (2 k, n): each of k cut in half; and by how much F may change along
    the unknowns (2 k, n) in them, where that is known of the k boxes."""
    rows, sides = np.arange(len(low)), _sides_to_cut(slopes, 0.5 * (high - low))
    cuts = 0.5 * (low[rows, sides] + high[rows, sides])
    first_high, second_low, slopes = high.copy(), low.copy(), slopes.copy()
    first_high[rows, sides] = cuts
    second_low[rows, sides] = cuts
    slopes[rows, sides] *= 0.5
    return (
        np.concatenate([low, second_low]),
        np.concatenate([first_high, high]),
        np.concatenate([slopes, slopes]),
    )


def _parameters(jacobians: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The unknown (k,) in which the null vector of each F' (k, n - 1, n) is longest, and
    where (k,) there is one null vector only."""
    n = jacobians.shape[2]
    finite = np.where(np.isfinite(jacobians), jacobians, 0.0)
    minors = [np.delete(finite, j, axis=2) for j in range(n)]
    sizes = np.abs(np.column_stack([np.linalg.det(minor) for minor in minors]))
    return np.argmax(sizes, axis=1), sizes.max(axis=1, initial=0.0) > 0.0


def _times(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Matrices (k, p, m) times vectors (k, m)."""
    product: np.ndarray = np.einsum("kpm,km->kp", matrices, vectors)
    return product
