"""Bounds on the second derivatives of closure equations, from the geometry.

Derivatives of a product of displacements are products with the screws of its joints. A
screw is as large as its axis is far from the origin: no farther than the bodies between
them reach, with every slide at its limit. What certificates and complex paths rest on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkages.mechanisms.joint import Motion
from linkages.mechanisms.placement import Placement
from linkages.mechanisms.structure import Closure, ClosureKind, Share, Structure

__all__ = ["CurvatureBounds"]

# The translation of a displacement, over its residual where that is at most 0.2: the
# scalar of the dual part is not among the equations.
TRANSLATION = 1.1
LARGEST_EXPONENT = 300.0  # beyond it a bound is of no use


@dataclass(frozen=True, eq=False)
class _Element:
    """An elementary motion in a chain: its unknown, None where it is locked, how fast
    (``rate``) it follows it, whether it turns, its ``direction`` and a ``point`` (3,)
    of its axis, its ``advance`` a radian, and how far it shifts what follows at
    most."""

    column: int | None
    rate: float
    is_turn: bool
    direction: np.ndarray
    point: np.ndarray
    advance: float
    shift: float


class CurvatureBounds:
    """Bounds on F'' of the closures of a ``structure`` without embedded spherical
    joints, all lengths of which have limits, in its unit, where residuals are at most
    ``misclosure``."""

    def __init__(self, structure: Structure, misclosure: float):
        self.structure = structure
        self.misclosure = misclosure

    @cached_property
    def near_solutions(self) -> float:
        """A constant K with |F'(x) - F'(y)| <= K |x - y| where F is nearly solved."""
        squares = np.zeros((self._n, self._n))
        for closure in self.structure.closures:
            squares += _Chain(self.structure, closure).near(self.misclosure) ** 2
        return _largest_eigenvalue(np.sqrt(squares))

    def at_complex_points(self, reach: np.ndarray) -> np.ndarray:
        """Bounds (k,) on |F''| no farther than ``reach`` (k,) from a real point within
        the limits.

        All derivatives by further unknowns have the same bounds as the second ones;
        the Taylor series in the imaginary parts y of all variables sums up to
        exp(|y_1| + ...) times them, and for squares of distances to the square of that.
        """
        squares = np.zeros((self._n, self._n))
        for closure in self.structure.closures:
            squares += _Chain(self.structure, closure).anywhere() ** 2
        kinds = {closure.kind for closure in self.structure.closures}
        power = 2.0 if ClosureKind.ROD in kinds else 1.0
        exponents = np.minimum(power * self._spread * reach, LARGEST_EXPONENT)
        growth: np.ndarray = np.exp(exponents)
        return _largest_eigenvalue(np.sqrt(squares)) * growth

    @property
    def _n(self) -> int:
        return len(self.structure.unknowns)

    @property
    def _spread(self) -> float:
        """The largest sum of the changes of all variables where the unknowns change by
        a vector of length 1."""
        rates = np.zeros(self._n)
        for number in self.structure.column_of:
            share = self.structure.share(number)
            assert share is not None
            rates[share.column] += abs(share.rate)
        for columns in self.structure.shifts.values():
            rates[list(columns)] = 1.0
        return float(np.linalg.norm(rates))


def _largest_eigenvalue(matrix: np.ndarray) -> float:
    return float(np.linalg.eigvalsh(matrix)[-1])


class _Chain:
    """The elementary motions of one closure, and how far they reach."""

    def __init__(self, structure: Structure, closure: Closure):
        self.structure = structure
        self.closure = closure
        self.placement = structure.placement(closure)
        self.elements = [
            element
            for step in closure.chain
            for element in _elements(structure, self.placement, step.pair, step.sign)
        ]

    # --- bounds by two unknowns (n, n) ------------------------------------------------

    def near(self, misclosure: float) -> np.ndarray:
        """Bounds on |d2F / dxi dxj| where F is at most ``misclosure``."""
        if self.closure.kind is ClosureKind.CYCLE:
            gap = TRANSLATION * misclosure
            reach = np.minimum(self._before, self._after + gap)
            return self._scattered(self._of_cycle(reach, gap))
        reach = np.minimum(self._after, self._before + misclosure)
        second = self._of_point(reach)
        if self.closure.kind is ClosureKind.POINT:
            return self._scattered(second)
        distance = np.sqrt(self._longest**2 + 2 * self._length * misclosure)
        of_rod = self._scattered(self._of_rod(reach, second, distance))
        of_rod += self._of_leg()
        return of_rod

    def anywhere(self) -> np.ndarray:
        """The same at all real points within the limits, for derivatives of the second
        and all higher orders that are by these two unknowns at least."""
        if self.closure.kind is ClosureKind.CYCLE:
            reach = np.full(len(self.elements), self._before.max(initial=0.0))
            return self._scattered(self._of_cycle(reach, self._total))
        reach = np.full(len(self.elements), self._after.max(initial=0.0))
        second = np.full((len(reach), len(reach)), max(1.0, reach.max(initial=0.0)))
        if self.closure.kind is ClosureKind.POINT:
            return self._scattered(second)
        of_rod = self._scattered(self._of_rod(reach, second, self._total))
        of_rod += self._of_leg()
        return of_rod

    def _of_cycle(self, reach: np.ndarray, gap: float) -> np.ndarray:
        """Twice a quarter of the product of two screws and a displacement with a
        translation of ``gap`` at most."""
        turns = np.array([element.is_turn for element in self.elements])
        pitches = np.array([abs(element.advance) for element in self.elements])
        sizes = reach + pitches
        dual = 0.5 * (0.5 * gap + np.add.outer(sizes, sizes))
        bounds = np.sqrt(0.25 + dual**2)
        both = np.logical_and.outer(turns, turns)
        one = np.logical_xor.outer(turns, turns)
        result: np.ndarray = np.where(both, bounds, np.where(one, 0.5, 0.0))
        return result

    def _of_point(self, reach: np.ndarray) -> np.ndarray:
        """The distance of the point from the later axis; for a turn and a slide 1."""
        turns = np.array([element.is_turn for element in self.elements])
        pitches = np.array([abs(element.advance) for element in self.elements])
        places = np.arange(len(turns))
        later = np.maximum.outer(places, places)
        both = np.logical_and.outer(turns, turns)
        one = np.logical_xor.outer(turns, turns)
        sizes = (reach + pitches)[later]
        result: np.ndarray = np.where(both, sizes, np.where(one, 1.0, 0.0))
        return result

    def _of_rod(
        self, reach: np.ndarray, second: np.ndarray, distance: float
    ) -> np.ndarray:
        """Half the square of the distance of two points, over the length of the rod,
        where it is ``distance`` at most."""
        turns = np.array([element.is_turn for element in self.elements])
        pitches = np.array([abs(element.advance) for element in self.elements])
        first = np.where(turns, reach + pitches, 1.0)
        products: np.ndarray = np.outer(first, first) + distance * second
        return products / self._length

    def _of_leg(self) -> np.ndarray:
        """The bound (n, n) by the variable of a leg, half the square of its length,
        over what that is in the reference configuration; 0 where there is none."""
        n = len(self.structure.unknowns)
        result = np.zeros((n, n))
        share = self._share_of_leg
        if share is not None and share.column >= 0:
            result[share.column, share.column] = share.rate**2 / self._length
        return result

    def _scattered(self, bounds: np.ndarray) -> np.ndarray:
        """Bounds by two elements (e, e) as bounds by two unknowns (n, n)."""
        n = len(self.structure.unknowns)
        result = np.zeros((n, n))
        for i, first in enumerate(self.elements):
            for j, second in enumerate(self.elements):
                if first.column is not None and second.column is not None:
                    rates = first.rate * second.rate
                    result[first.column, second.column] += rates * bounds[i, j]
        return result

    # --- reach ------------------------------------------------------------------------

    @property
    def _length(self) -> float:
        assert self.closure.rod is not None
        return self.closure.rod.length / self.structure.unit

    @property
    def _longest(self) -> float:
        """How long the rod can be."""
        share = self._share_of_leg
        change = 0.0 if share is None else _largest(self.structure, share)
        return self._length + change

    @property
    def _share_of_leg(self) -> Share | None:
        rod = self.closure.rod
        if rod is None or rod.leg is None:
            return None
        return _share(self.structure, rod.leg.variable)

    @property
    def _before(self) -> np.ndarray:
        """How far every axis (e,) can be from the place at the beginning of the chain:
        the origin of a cycle, the point of another one."""
        return _reaches(self.elements, self._beginning)[:-1]

    @property
    def _after(self) -> np.ndarray:
        """The same from the place at the end of the chain."""
        return _reaches(self.elements[::-1], self._end)[:-1][::-1]

    @property
    def _total(self) -> float:
        """How far the end of the chain can be from its beginning."""
        return _extent(self.elements, self._beginning, self._end)

    @property
    def _beginning(self) -> np.ndarray:
        if self.closure.kind is ClosureKind.CYCLE:
            return np.zeros(3)
        return self.placement.point(self.closure.first)

    @property
    def _end(self) -> np.ndarray:
        if self.closure.kind is ClosureKind.CYCLE:
            return np.zeros(3)
        return self.placement.point(self.closure.second)


def _elements(
    structure: Structure, placement: Placement, pair: int, sign: int
) -> list[_Element]:
    """The elementary motions of a pair, in the order of the chain."""
    if pair in structure.shifts:
        return _shifts(structure, placement, pair)
    elements = []
    for number in structure.variables_of(pair)[::sign]:
        motion = structure.mechanism.variables[number].motion
        share = _share(structure, number)
        largest = _largest(structure, share)
        elements.append(_element(placement, motion, share, largest))
    return elements


def _shifts(structure: Structure, placement: Placement, pair: int) -> list[_Element]:
    """The slides of a free point."""
    columns = structure.shifts[pair]
    directions = structure.point_pairs[pair].directions
    elements = []
    for column, direction in zip(columns, directions, strict=True):
        largest = _largest(structure, Share(column, 1.0, 0.0))
        along = placement.axes @ direction
        elements.append(_Element(column, 1.0, False, along, np.zeros(3), 0.0, largest))
    return elements


def _share(structure: Structure, number: int) -> Share:
    """What an unknown makes of a variable, by number; of column -1 where it is
    locked."""
    share = structure.share(number)
    if share is not None:
        return share
    variable = structure.mechanism.variables[number]
    assert variable.locked is not None
    unit = 1.0 if variable.motion.is_turn else structure.unit
    return Share(-1, 0.0, variable.locked / unit)


def _largest(structure: Structure, share: Share) -> float:
    """The largest absolute value that a variable takes within the limits."""
    if share.column < 0:
        return abs(share.offset)
    unknown = structure.unknowns[share.column]
    largest = max(abs(unknown.low), abs(unknown.high))
    return abs(share.rate) * largest + abs(share.offset)


def _element(
    placement: Placement, motion: Motion, share: Share, largest: float
) -> _Element:
    column = share.column if share.column >= 0 else None
    rate = abs(share.rate)
    direction = placement.direction(motion)
    if not motion.is_turn:
        return _Element(column, rate, False, direction, np.zeros(3), 0.0, largest)
    advance = motion.advance / placement.unit
    shift = abs(advance) * largest if advance else 0.0
    point = placement.point_on_axis(motion)
    return _Element(column, rate, True, direction, point, advance, shift)


def _extent(elements: list[_Element], start: np.ndarray, end: np.ndarray) -> float:
    """How far a point that the whole chain carries, at ``end`` (3,) in the reference
    configuration, can be from the ``start`` (3,): along the joints."""
    points = [start, *(one.point for one in elements if one.is_turn), end]
    hops = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shifts = sum(element.shift for element in elements)
    return float(hops.sum() + shifts)


def _reaches(elements: list[_Element], start: np.ndarray) -> np.ndarray:
    """How far every axis can be from a ``start`` (3,) before all of them, and, last,
    how far the chain reaches (e + 1,): from axis to axis on the shortest way, each
    slide by as much as it can."""
    reaches = []
    place, total = start, 0.0
    for element in elements:
        if element.is_turn:
            # the point of the axis nearest to the last one
            along = (place - element.point) @ element.direction
            foot = element.point + along * element.direction
            total += float(np.linalg.norm(foot - place))
            place = foot
        reaches.append(total)
        total += element.shift
    return np.array([*reaches, total])
