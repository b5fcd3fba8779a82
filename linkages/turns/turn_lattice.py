"""Whole turns after which a mechanism is closed again, exactly and wherever it stands.

After a whole turn a helical joint has advanced along its axis, and so has a slide that
follows a turn. A translation passes along a chain unchanged through slides and through
turns about axes along it. So the advances of joints between which there is nothing else
add up, and whole turns whose advances cancel, or that slides take up, lead from every
closed configuration to another one. These shifts form a lattice.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bifurc.torus import common_period
from linkages.decisions import cancels_in_whole_turns, is_parallel_axis
from linkages.mechanisms.joint import Motion
from linkages.structure.structure import Closure, ClosureKind, Structure

DIGITS = 10**13  # to which advances count where whole turns are looked for
MOST_TURNS = 1000  # of a joint, in a shift that the lattice is made of
MOST_SHIFTS = 200_000  # that are listed
INDEPENDENT = 1e-9  # singular value, of the largest, from which slides are independent
WITHIN = 1e-9  # by which a shift may pass a limit, rad or characteristic lengths
ALIKE = 1e-6  # distances from the middle of the limits that differ by less are one
SHIFTS_AT_ONCE = 100  # after which points are compared with the limits


class Shifts(NamedTuple):
    """Shifts (k, n) of a lattice, and whether they ``are_all`` that were asked for."""

    vectors: np.ndarray
    are_all: bool


class Count(NamedTuple):
    """How many translates there are at least, and whether these ``are_all``."""

    number: int
    are_all: bool


@dataclass(frozen=True, eq=False)
class TurnLattice:
    """The shifts (n,) of unknowns that are sums of the rows of a ``basis`` (d, n), rad
    and characteristic lengths; a row is the first one that changes the unknown of its
    number in ``pivots``. ``limits`` (n, 2) are those of the unknowns."""

    basis: np.ndarray
    pivots: tuple[int, ...]
    limits: np.ndarray

    def __len__(self) -> int:
        return len(self.basis)

    @property
    def columns(self) -> np.ndarray:
        """The numbers of the unknowns that shifts change."""
        return np.flatnonzero(np.any(self.basis != 0.0, axis=0))

    def region(self, box: np.ndarray, reference: np.ndarray) -> np.ndarray:
        """The part of a ``box`` (n, 2) near the middle of the limits that holds a
        translate of every configuration whose advances nearly cancel, as those of the
        ``reference`` (n,) do."""
        region = box.copy()
        columns = self.columns
        reach = 0.5 * np.abs(self.basis[:, columns]).sum(axis=0) + np.pi
        low, high = box[columns].T
        center = np.clip(self._center(reference), low, high)
        region[columns, 0] = np.maximum(low, center - reach)
        region[columns, 1] = np.minimum(high, center + reach)
        return region

    def _center(self, reference: np.ndarray) -> np.ndarray:
        """The place nearest to the middle of the limits, of the unknowns that shifts
        change, where advances cancel as in the ``reference`` (n,): the middle itself
        need be none. Distances count over the widths of the limits."""
        columns = self.columns
        low, high = self.limits[columns].T
        weights = 1.0 / (high - low)
        rows = self.basis[:, columns]
        begin = reference[columns]
        beside = weights * (0.5 * (low + high) - begin)
        times = np.linalg.lstsq((weights * rows).T, beside, rcond=None)[0]
        center: np.ndarray = begin + times @ rows
        return center

    def shifts_between(self, lowest: np.ndarray, highest: np.ndarray) -> Shifts:
        """The shifts from ``lowest`` (n,) to ``highest`` (n,), or as many of them as
        are listed."""
        shifts = np.zeros((1, self.basis.shape[1]))
        are_all = True
        for row, pivot in zip(self.basis, self.pivots, strict=True):
            # no row after this one changes the unknown of its pivot
            ends = np.array([lowest[pivot], highest[pivot]]) / row[pivot]
            done = shifts[:, pivot] / row[pivot]
            first = np.ceil(ends.min() - done - WITHIN).astype(int)
            last = np.floor(ends.max() - done + WITHIN).astype(int)
            counts = np.maximum(last - first + 1, 0)
            if counts.sum() > MOST_SHIFTS:
                are_all = False
                few = np.cumsum(counts) <= MOST_SHIFTS
                shifts, first, counts = shifts[few], first[few], counts[few]
            begins = np.cumsum(counts) - counts
            steps = np.arange(counts.sum()) - np.repeat(begins, counts)
            times = np.repeat(first, counts) + steps
            shifts = np.repeat(shifts, counts, axis=0) + times[:, None] * row
        moved = shifts[:, self.columns]
        is_above = moved >= lowest[self.columns] - WITHIN
        is_below = moved <= highest[self.columns] + WITHIN
        return Shifts(shifts[np.all(is_above & is_below, axis=1)], are_all)

    def shifts_towards(self, places: np.ndarray, point: np.ndarray) -> np.ndarray:
        """The shifts (k, n) that bring each of the places (k, n) next to a ``point``
        (n,)."""
        columns = self.columns
        gaps = (point - places)[:, columns]
        times = np.linalg.lstsq(self.basis[:, columns].T, gaps.T, rcond=None)[0]
        return np.round(times).T @ self.basis

    def translates(self, points: np.ndarray) -> Shifts:
        """The shifts after which all ``points`` (k, n) are within the limits."""
        low, high = self.limits.T
        return self.shifts_between(low - points.min(axis=0), high - points.max(axis=0))

    def count_of_translates(self, points: np.ndarray) -> Count:
        """How many `translates` of ``points`` (k, n) there are, themselves among
        them."""
        shifts = self.translates(points)
        return Count(len(shifts.vectors), shifts.are_all)

    def home(self, points: np.ndarray) -> np.ndarray:
        """The shift (n,) that brings ``points`` (k, n), one or samples of a curve, as
        near as can be to the middle of the limits, all of them within these; none where
        they are within limits nowhere.

        Points that are no farther from it than others count as nearer by their
        coordinates. Of a curve that goes to the limits of some unknowns the others
        count first.
        """
        columns = self.columns
        passed = self._is_passed(points)[columns]
        shifts = self.translates(points).vectors
        if not len(shifts):
            return np.zeros(points.shape[1])
        center = self.limits[columns].mean(axis=1)
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        middles = (middle + shifts)[:, columns]
        beside = middles - center
        distances = np.linalg.norm(beside[:, ~passed], axis=1)
        passed_distances = np.linalg.norm(beside[:, passed], axis=1)
        nearest = _nearest_first([distances, passed_distances], middles)[0]
        shift: np.ndarray = shifts[nearest]
        return shift

    def inmost(self, point: np.ndarray) -> np.ndarray:
        """The translate (n,) of a point (n,) that is farthest from all limits of the
        unknowns that shifts change; the point itself where it has none within them."""
        moved = point + self.translates(point[None]).vectors
        if not len(moved):
            return point
        inmost: np.ndarray = moved[int(np.argmin(self._excess(moved)))]
        return inmost

    def count_of_closed(self, points: np.ndarray, reach: float) -> Count:
        """How many parts of a closed curve and of its translates are within the limits:
        as many as `translates` stay within them, and no fewer than show of those that
        pass them.

        Of the curve ``points`` (k, n) are given in order, with those where an unknown
        is least or largest; all of it is no farther than ``reach`` from some of them.
        They are all where no translate passes the limits.
        """
        whole = self.translates(points)
        partial = self._partial(points)
        shifts = partial.vectors
        number = len(whole.vectors)
        are_all = whole.are_all and partial.are_all
        for excess in self._excesses(points, shifts[~self._are_whole(points, shifts)]):
            number += _count_of_parts(excess <= WITHIN)
            are_all = are_all and float(excess.min()) > reach
        return Count(number, are_all)

    def fewest_translates(self, points: np.ndarray, reach: float) -> Count:
        """How many translates at least pass the limits, of a curve that goes to them,
        with ``points`` (k, n) and ``reach`` as in `count_of_closed`: those that differ
        in an unknown that stays within them, or, of a curve that a shift brings onto
        itself, by more than this shift. They are all where no other shift leads any
        part of the curve within the limits."""
        is_passed = self._is_passed(points)
        shifts = self._overlapping(points, is_passed)
        rest = shifts.vectors[:, ~is_passed]
        own = self._shift_onto_itself(points, reach)
        if own is not None:
            times = np.floor(shifts.vectors @ own / (own @ own) + ALIKE)
            rest = shifts.vectors - times[:, None] * own
        places: set[bytes] = set()
        # with 0 added no zero has a sign
        keys = np.round(rest / ALIKE) + 0.0
        for shift, place in zip(shifts.vectors, keys, strict=True):
            key = place.tobytes()
            if key not in places and self._excess(points + shift).min() <= WITHIN:
                places.add(key)
        partial = self._partial(points)
        excesses = self._excesses(points, _shortest_first(partial.vectors))
        is_another = any(float(excess.min()) <= reach for excess in excesses)
        are_all = shifts.are_all and partial.are_all and not is_another
        return Count(len(places), are_all)

    def _shift_onto_itself(self, points: np.ndarray, reach: float) -> np.ndarray | None:
        """The shortest shift (n,) that brings a curve with ``points`` (k, n), no place
        of which is farther than ``reach`` from some of them, onto itself as far as it
        stays within the limits; None where there is none."""
        columns = self.columns
        extent = points.max(axis=0) - points.min(axis=0)
        shifts = self.shifts_between(-extent, extent).vectors
        for shift in _shortest_first(shifts):
            moved = points + shift
            inside = moved[self._excess(moved) <= WITHIN]
            # one of them tells most shifts apart
            for few in (inside[:1], inside):
                gaps = few[:, None, columns] - points[None, :, columns]
                distances = np.linalg.norm(gaps, axis=2).min(axis=1, initial=np.inf)
                if not len(few) or distances.max() > reach:
                    break
            else:
                own: np.ndarray = shift
                return own
        return None

    def _partial(self, points: np.ndarray) -> Shifts:
        """The shifts after which, of each unknown, some of the range that it has in
        ``points`` (k, n) is within its limits."""
        low, high = self.limits.T
        least = low - points.max(axis=0) + 2.0 * WITHIN
        most = high - points.min(axis=0) - 2.0 * WITHIN
        return self.shifts_between(least, most)

    def _are_whole(self, points: np.ndarray, shifts: np.ndarray) -> np.ndarray:
        """Whether all ``points`` (k, n) are within the limits, after each of the
        ``shifts`` (j, n)."""
        columns = self.columns
        low, high = self.limits[columns].T
        moved = shifts[:, columns]
        is_above = moved >= low - points[:, columns].min(axis=0) - WITHIN
        is_below = moved <= high - points[:, columns].max(axis=0) + WITHIN
        are_whole: np.ndarray = np.all(is_above & is_below, axis=1)
        return are_whole

    def _excesses(self, points: np.ndarray, shifts: np.ndarray) -> Iterator[np.ndarray]:
        """How far ``points`` (k, n) are beyond the limits after the ``shifts`` (j, n),
        less than 0 within them: arrays (i, k) for some shifts after others."""
        for begin in range(0, len(shifts), SHIFTS_AT_ONCE):
            own = shifts[begin : begin + SHIFTS_AT_ONCE]
            yield self._excess(points + own[:, None, :])

    def _is_passed(self, points: np.ndarray) -> np.ndarray:
        """Whether a curve with samples (k, n) goes to limits of an unknown (n,)."""
        low, high = self.limits.T
        lowest, highest = points.min(axis=0), points.max(axis=0)
        is_at_limit = (lowest <= low + ALIKE) | (highest >= high - ALIKE)
        is_passed: np.ndarray = is_at_limit & (lowest < highest)
        return is_passed

    def _overlapping(self, points: np.ndarray, is_passed: np.ndarray) -> Shifts:
        """The shifts after which ``points`` (k, n) are within the limits or, in unknowns
        that pass them, some may be."""
        low, high = self.limits.T
        lowest, highest = points.min(axis=0), points.max(axis=0)
        least = low - np.where(is_passed, highest, lowest)
        most = high - np.where(is_passed, lowest, highest)
        return self.shifts_between(least, most)

    def _excess(self, points: np.ndarray) -> np.ndarray:
        """How far points (..., n) are beyond the limits (...), less than 0 within
        them."""
        low, high = self.limits[self.columns].T
        places = points[..., self.columns]
        excess: np.ndarray = np.maximum(low - places, places - high).max(axis=-1)
        return excess

    def homes(self, points: np.ndarray) -> np.ndarray:
        """Points (k, n), each as near as can be to the middle of the limits."""
        shifted = [point + self.home(point[None]) for point in points]
        return np.array(shifted).reshape(points.shape)


def _shortest_first(shifts: np.ndarray) -> np.ndarray:
    """The shifts (j, n) by their lengths, without that by nothing."""
    lengths = np.linalg.norm(shifts, axis=1)
    order = np.argsort(lengths, kind="stable")
    moving: np.ndarray = shifts[order[lengths[order] > 0.0]]
    return moving


def _count_of_parts(is_inside: np.ndarray) -> int:
    """How many runs of points are inside, of closed curves, the rows of (j, k)."""
    is_begin = is_inside & ~np.roll(is_inside, 1, axis=1)
    return int(np.count_nonzero(is_begin))


def _nearest_first(distances: list[np.ndarray], places: np.ndarray) -> np.ndarray:
    """The order of places (k, c) by their ``distances`` (k,), the first ones before the
    next, and of those as far away by their coordinates, so that it is that of the
    places themselves."""
    digits = [*-places.T[::-1], *distances[::-1]]
    return np.lexsort([np.round(key / ALIKE) for key in digits])


def have_room_for_turns(structure: Structure) -> bool:
    """Whether the limits of some unknown leave room for a whole turn of it."""
    for column, period in _own_periods(structure).items():
        unknown = structure.unknowns[column]
        if unknown.high - unknown.low >= period:
            return True
    return False


def _own_periods(structure: Structure) -> dict[int, float]:
    """The periods of unknowns, by column, without what is periodic by itself; infinite
    for what is not back after any turns, 0 for slides."""
    return {
        column: common_period(rates) if rates else 0.0
        for column, rates in sorted(turning_rates(structure).items())
        if not np.isfinite(structure.unknowns[column].period)
    }


@lru_cache(maxsize=16)
def turn_lattice(structure: Structure) -> TurnLattice:
    """The lattice of a mechanism; of no rows where no turn has limits, or whatever
    advances does not cancel."""
    n = len(structure.unknowns)
    limits = np.array([[one.low, one.high] for one in structure.unknowns])
    own_periods = _own_periods(structure)
    sliding = [column for column, period in own_periods.items() if period == 0.0]
    turning = [
        column for column, period in own_periods.items() if 0.0 < period < np.inf
    ]
    if not turning:
        return TurnLattice(np.empty((0, n)), (), limits)
    rows = np.array(_advance_rows(structure)).reshape(-1, n)
    periods = np.array([own_periods[column] for column in turning])
    advances, slides = rows[:, turning] * periods, rows[:, sliding]
    left, sigma, _ = np.linalg.svd(slides)
    rank = int(np.count_nonzero(sigma > INDEPENDENT * max(1.0, *sigma, 0.0)))
    turns = _echelon(_whole_turns(left[:, rank:].T @ advances))
    basis = np.zeros((len(turns), n))
    basis[:, turning] = turns * periods
    basis[:, sliding] = -(np.linalg.pinv(slides) @ advances @ turns.T).T
    pivots = tuple(turning[np.flatnonzero(row)[0]] for row in turns)
    return TurnLattice(basis, pivots, limits)


# --- equations ------------------------------------------------------------------------


def turning_rates(structure: Structure) -> dict[int, list[float]]:
    """How fast each unknown that moves a joint, by number, turns joints; nothing of one
    that only slides them."""
    rates: dict[int, list[float]] = {}
    for number, variable in enumerate(structure.mechanism.variables):
        share = structure.share(number)
        if share is not None:
            turning = rates.setdefault(share.column, [])
            if variable.motion.is_turn:
                turning.append(share.rate)
    return rates


class _Element(NamedTuple):
    """A motion of a chain, in the sense of the chain (``sign``): that of the variable of
    this ``number``."""

    number: int
    sign: int
    motion: Motion


def _advance_rows(structure: Structure) -> list[np.ndarray]:
    """Rows (n,), each the advance, in characteristic lengths, of all that adds up to 0
    somewhere in a chain, by the unknowns."""
    rows: list[np.ndarray] = []
    for closure in structure.closures:
        rows += _rows_of_chain(structure, closure)
        if closure.rod is not None and closure.rod.leg is not None:
            leg = _rates(structure, closure.rod.leg.variable)
            rows.append(leg)
    return rows


def _rows_of_chain(structure: Structure, closure: Closure) -> list[np.ndarray]:
    elements = _elements(structure, closure)
    sums: list[tuple[int, np.ndarray, np.ndarray]] = []
    for place, element in enumerate(elements):
        if element is None:
            continue
        motion = element.motion
        rates = element.sign * _rates(structure, element.number)
        if not np.any(rates):
            continue
        begin = _begin_of_run(elements, place, closure.kind is ClosureKind.CYCLE)
        for other_begin, direction, row in sums:
            if begin == other_begin and _is_along(motion.direction, direction):
                row += np.sign(motion.direction @ direction) * rates
                break
        else:
            sums.append((begin, motion.direction, rates))
    return [row for _, _, row in sums]


def _rates(structure: Structure, number: int) -> np.ndarray:
    """How far a variable, by number, advances (n,) for a unit of the unknowns."""
    rates = np.zeros(len(structure.unknowns))
    share = structure.share(number)
    motion = structure.mechanism.variables[number].motion
    if share is not None:
        advance = motion.advance / structure.unit if motion.is_turn else 1.0
        rates[share.column] = share.rate * advance
    return rates


def _elements(structure: Structure, closure: Closure) -> list[_Element | None]:
    """The motions along a chain, but for those locked at 0; None for a joint that turns
    a body anyhow."""
    elements: list[_Element | None] = []
    special = structure.embedded | structure.shifts
    for step in closure.chain:
        numbers = structure.variables_of(step.pair)
        if step.pair in special:
            elements.append(None)
        for number in numbers[:: step.sign]:
            variable = structure.mechanism.variables[number]
            if variable.locked != 0.0:
                elements.append(_Element(number, step.sign, variable.motion))
    return elements


def _begin_of_run(elements: list[_Element | None], place: int, is_cyclic: bool) -> int:
    """The place of the first element of those, up to the one at a ``place``, through
    which a translation along this one passes; -1 where that is the whole cycle."""
    own = elements[place]
    assert own is not None
    begin = place
    for before in range(place - 1, place - len(elements), -1):
        element = elements[before]
        is_outside = before < 0 and not is_cyclic
        if is_outside or not _lets_pass(element, own.motion.direction):
            return begin
        begin = before % len(elements)
    return -1


def _lets_pass(element: _Element | None, direction: np.ndarray) -> bool:
    """Whether a translation along a direction is the same before and after a motion."""
    if element is None:
        return False
    motion = element.motion
    return not motion.is_turn or _is_along(motion.direction, direction)


def _is_along(one: np.ndarray, other: np.ndarray) -> bool:
    return is_parallel_axis(float(np.linalg.norm(np.cross(one, other))))


# --- integers -------------------------------------------------------------------------


def _whole_turns(advances: np.ndarray) -> np.ndarray:
    """A basis (d, p) of the whole numbers of turns after which nothing has advanced, of
    p joints whose turns count in ``advances`` (r, p).

    By lattice reduction (Lenstra, Lenstra and Lovász 1982): a short vector of the
    lattice of the turns, each with the advance it makes in many digits, makes none. A
    joint that advances nothing needs none.
    """
    unit = np.eye(advances.shape[1], dtype=int)
    advance_something = np.any(advances, axis=0)
    idle: np.ndarray = unit[~advance_something]
    if not np.any(advance_something):
        return idle
    turns = _turns_that_cancel(advances[:, advance_something])
    return np.concatenate([idle, turns @ unit[advance_something]])


def _turns_that_cancel(advances: np.ndarray) -> np.ndarray:
    """The same of joints each of which advances something."""
    from sympy.polys.domains import ZZ
    from sympy.polys.matrices import DomainMatrix

    count = advances.shape[1]
    largest = np.abs(advances).max(axis=1, initial=0.0)
    counted = advances[largest > 0.0] / largest[largest > 0.0, None]
    digits = [[round(x * DIGITS) for x in column] for column in counted.T]
    unit = np.eye(count, dtype=int).tolist()
    rows = [one + other for one, other in zip(unit, digits, strict=True)]
    reduced = DomainMatrix(rows, (count, count + len(counted)), ZZ).lll()
    turns = np.array(reduced.to_Matrix()[:, :count].tolist(), dtype=float)
    is_short = np.abs(turns).max(axis=1) <= MOST_TURNS
    missed = np.abs(turns @ counted.T).max(axis=1, initial=0.0)
    kept: np.ndarray = turns[is_short & cancels_in_whole_turns(missed)].astype(int)
    return kept


def _echelon(rows: np.ndarray) -> np.ndarray:
    """The integer rows (d, p) with the same sums, such that each begins with more zeros
    than the one before it."""
    rows = rows.copy()
    done = 0
    for column in range(rows.shape[1]):
        while np.count_nonzero(rows[done:, column]) > 1:
            below = rows[done:]
            entries = np.abs(below[:, column])
            smallest = int(np.argmin(np.where(entries > 0, entries, entries.max() + 1)))
            pivot = below[smallest].copy()
            times = below[:, column] // pivot[column]
            times[smallest] = 0
            below -= times[:, None] * pivot
        nonzero = np.flatnonzero(rows[done:, column])
        if len(nonzero):
            rows[[done, done + nonzero[0]]] = rows[[done + nonzero[0], done]]
            done += 1
    return rows
