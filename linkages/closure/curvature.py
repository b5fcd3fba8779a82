"""Bounds on the second derivatives of closure equations, from the geometry.

Derivatives of a product of displacements are products with the screws of its joints. A
screw is as large as its axis is far from the origin: no farther than the bodies between
them reach, with every slide at its limit. What certificates and complex paths rest on.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from linkages.structure.elements import Element, Elements, extent, reaches
from linkages.structure.rods import Rod
from linkages.structure.structure import Closure, ClosureKind, Structure

# The translation of a displacement, over its residual where that is at most 0.2: the
# scalar of the dual part is not among the equations.
TRANSLATION = 1.1
LARGEST_EXPONENT = 300.0  # beyond it a bound is of no use


class CurvatureBounds:
    """Bounds on F'' of the closures of a ``structure``, in its unit, where residuals
    are at most ``misclosure``.

    The numbers of a rotation have no limits. Where F is nearly solved they are those of
    one but for the misclosure, and rods hold what has no other place.
    """

    def __init__(self, structure: Structure, misclosure: float):
        self.structure = structure
        self.misclosure = misclosure
        self._elements = Elements(structure, misclosure)

    @cached_property
    def near_solutions(self) -> float:
        """A constant K with |F'(x) - F'(y)| <= K |x - y| where F is nearly solved."""
        squares = self._squares_of_rotations
        for chain in self._chains:
            squares = squares + chain.near(self.misclosure) ** 2
        return _largest_eigenvalue(np.sqrt(squares))

    def at_complex_points(self, reach: np.ndarray) -> np.ndarray:
        """Bounds (k,) on |F''| no farther than ``reach`` (k,) from a real point within
        the limits where F is nearly solved.

        All derivatives by further unknowns have the same bounds as the second ones;
        the Taylor series in the changes y of all blocks of variables sums up to
        exp(|y_1| + ...) times them, and for squares of distances to the square of that.
        """
        kinds = {closure.kind for closure in self.structure.closures}
        power = 2.0 if ClosureKind.ROD in kinds else 1.0
        exponents = np.minimum(power * self._spread * reach, LARGEST_EXPONENT)
        growth: np.ndarray = np.exp(exponents)
        return self._of_all_orders * growth

    @cached_property
    def _of_all_orders(self) -> float:
        """A bound on the derivatives of the second and all higher orders at the real
        points."""
        squares = self._squares_of_rotations
        for chain in self._chains:
            squares = squares + chain.of_all_orders() ** 2
        return _largest_eigenvalue(np.sqrt(squares))

    @cached_property
    def _chains(self) -> list[_Chain]:
        return [
            _Chain(self.structure, closure, self._elements)
            for closure in self.structure.closures
        ]

    @cached_property
    def _squares_of_rotations(self) -> np.ndarray:
        """Squares of bounds on the second derivatives, by two blocks, of the equations
        that make two vectors a, b orthonormal: (a.a - 1) / 2, (b.b - 1) / 2, a.b."""
        blocks = self._elements.blocks
        squares = np.zeros((blocks.count, blocks.count))
        for columns in self.structure.embedded.values():
            rotation = blocks.of(columns)[:2]
            squares[np.ix_(rotation, rotation)] = 1.0
        return squares

    @cached_property
    def _spread(self) -> float:
        """The largest sum of the changes of all variables, and of those of blocks of
        unknowns, where the unknowns change by a vector of length 1."""
        blocks = self._elements.blocks
        rates = np.zeros(blocks.count)
        for number in self.structure.column_of:
            share = self.structure.share(number)
            assert share is not None
            rates[blocks.of_column[share.column]] += abs(share.rate)
        own = [*self.structure.shifts.values(), *self.structure.embedded.values()]
        for columns in own:
            rates[blocks.of_column[list(columns)]] = 1.0
        return float(np.linalg.norm(rates))


def _largest_eigenvalue(matrix: np.ndarray) -> float:
    return float(np.linalg.eigvalsh(matrix)[-1])


class _Chain:
    """The elementary motions of one closure, and bounds by two blocks of unknowns
    (b, b) on its second derivatives."""

    def __init__(self, structure: Structure, closure: Closure, elements: Elements):
        self.structure = structure
        self.closure = closure
        self.blocks = elements.blocks
        self.rods = elements.rods
        placement = structure.placement(closure)
        self.elements: list[Element] = elements.of(closure, placement)
        self._turns = np.array([element.is_turn for element in self.elements])
        self._pitches = np.array([abs(element.advance) for element in self.elements])
        self._stretches = np.array([element.stretch for element in self.elements])
        # by how much what comes before each element (e,) may make a vector longer
        self._before_stretched = np.cumprod([1.0, *self._stretches])[:-1]
        # the places at both ends: the origin of a cycle, the points of another one
        start = end = np.zeros(3)
        if closure.kind is not ClosureKind.CYCLE:
            start = placement.point(closure.first)
            end = placement.point(closure.second)
        # how far every axis (e,) can be from them, where nothing stretches the way
        self._before = reaches(self.elements[::-1], start)[::-1]
        self._after = reaches(self.elements, end)
        # how far the end of the chain can be from its beginning
        self._total = extent(self.elements, start, end)

    def near(self, misclosure: float) -> np.ndarray:
        """Bounds on |d2F / dxi dxj| where F is at most ``misclosure``."""
        if self.closure.kind is ClosureKind.CYCLE:
            gap = TRANSLATION * misclosure
            reach = np.minimum(self._before, self._after + gap)
            return self._scattered(self._of_cycle(reach, gap))
        rod = self.closure.rod
        gap = misclosure if rod is None else self.rods.longest(rod)
        reach = self._after
        if not np.any(self._stretches > 1.0):
            reach = np.minimum(reach, self._before + gap)
        sizes = self._sizes(reach)
        second = self._of_point(sizes)
        if rod is None:
            return self._scattered(second)
        return self._of_rod(rod, sizes, second, gap)

    def of_all_orders(self) -> np.ndarray:
        """The same for derivatives of the second and all higher orders that are by
        these two blocks at least."""
        if self.closure.kind is ClosureKind.CYCLE:
            reach = np.full(len(self.elements), self._before.max(initial=0.0))
            return self._scattered(self._of_cycle(reach, self._total))
        sizes = self._sizes(self._after)
        largest = max(1.0, float(sizes.max(initial=0.0)))
        sizes = np.full(len(sizes), largest)
        second = np.full((len(sizes), len(sizes)), largest)
        rod = self.closure.rod
        if rod is None:
            return self._scattered(second)
        distance = max(self.rods.longest(rod), largest)
        return self._of_rod(rod, sizes, second, distance)

    def _of_cycle(self, reach: np.ndarray, gap: float) -> np.ndarray:
        """Twice a quarter of the product of two screws and a displacement with a
        translation of ``gap`` at most."""
        sizes = reach + self._pitches
        dual = 0.5 * (0.5 * gap + np.add.outer(sizes, sizes))
        bounds = np.sqrt(0.25 + dual**2)
        both = np.logical_and.outer(self._turns, self._turns)
        one = np.logical_xor.outer(self._turns, self._turns)
        return np.where(both, bounds, np.where(one, 0.5, 0.0))

    def _sizes(self, reach: np.ndarray) -> np.ndarray:
        """How fast the point moves with each element (e,): as far as it is from the
        axis, and with a slide as fast as that; longer by what other elements stretch."""
        turning = self._stretches * reach + self._pitches
        return self._before_stretched * np.where(self._turns, turning, 1.0)

    def _of_point(self, sizes: np.ndarray) -> np.ndarray:
        """What the earlier of two elements turns: how fast the point moves with the
        later one."""
        places = np.arange(len(sizes))
        later = np.maximum.outer(places, places)
        both = np.logical_and.outer(self._turns, self._turns)
        one = np.logical_xor.outer(self._turns, self._turns)
        of_slide = np.where(one, self._before_stretched[later], 0.0)
        return np.where(both, sizes[later], of_slide)

    def _of_rod(
        self, rod: Rod, sizes: np.ndarray, second: np.ndarray, distance: float
    ) -> np.ndarray:
        """Bounds by blocks on half the square of the distance of two points, and of the
        length of a leg, over that of the rod, where it is ``distance`` at most."""
        length = rod.length / self.structure.unit
        products = np.outer(sizes, sizes) + distance * second
        of_rod = self._scattered(products / length)
        share = None if rod.leg is None else self.structure.share(rod.leg.variable)
        if share is not None:
            block = self.blocks.of_column[share.column]
            of_rod[block, block] += share.rate**2 / length
        return of_rod

    def _scattered(self, bounds: np.ndarray) -> np.ndarray:
        """Bounds by two elements (e, e) as bounds by two blocks."""
        result = np.zeros((self.blocks.count, self.blocks.count))
        for i, first in enumerate(self.elements):
            for j, second in enumerate(self.elements):
                if first.block is not None and second.block is not None:
                    rates = first.rate * second.rate
                    result[first.block, second.block] += rates * bounds[i, j]
        return result
