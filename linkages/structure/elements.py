"""The elementary motions of a chain, and how far they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkages.structure.cycles import Step
from linkages.structure.placement import Placement
from linkages.structure.rod_reach import RodReach
from linkages.structure.structure import Closure, Structure

ORIGIN = np.zeros(3)
COLUMNS = 2  # unit vectors of a rotation that are unknowns


class Blocks:
    """The unknowns of a ``structure`` in blocks: the three numbers of a unit vector or
    of a translation are one, and every other unknown is one by itself. ``of_column``
    (n,) are the numbers of the blocks, ``count`` of them."""

    def __init__(self, structure: Structure):
        n = len(structure.unknowns)
        first = np.arange(n)
        for columns in structure.embedded.values():
            triples = np.array(columns).reshape(-1, 3)
            first[triples] = triples[:, :1]
        starts, self.of_column = np.unique(first, return_inverse=True)
        self.count = len(starts)

    def of(self, columns: Sequence[int]) -> list[int]:
        """The blocks of some unknowns that are such triples, one after the other."""
        return [int(self.of_column[column]) for column in columns[::3]]


@dataclass(frozen=True, eq=False)
class Element:
    """An elementary motion in a chain: the ``block`` of unknowns that it follows, None
    where it is locked, how fast (``rate``), and whether it turns, about an axis through
    a ``point`` (3,) along a ``direction`` (3,), which is 0 where it turns freely about
    the point. ``advance`` is that a radian, ``shift`` how far it moves what follows at
    most, ``stretch`` by how much it makes that longer."""

    block: int | None
    rate: float
    is_turn: bool
    direction: np.ndarray
    point: np.ndarray
    advance: float = 0.0
    shift: float = 0.0
    stretch: float = 1.0


class Elements:
    """The elementary motions of the chains of a ``structure`` where residuals are at
    most ``misclosure``.

    The unit vectors a, b of a rotation R = (a, b, a x b) that are unknowns are two
    elements about one point. With residuals e and f of their lengths and g of their
    angle, a Gram matrix of 1 + 2e, 1 + 2f, g, |R| is at most 1 + sqrt(2) times the
    misclosure; so are its derivatives.
    """

    def __init__(self, structure: Structure, misclosure: float):
        self.structure = structure
        self.blocks = Blocks(structure)
        self.rods = RodReach(structure, misclosure)
        self._stretch = 1.0 + np.sqrt(2.0) * misclosure

    def of(self, closure: Closure, placement: Placement) -> list[Element]:
        """The elementary motions of a closure, the last to act first."""
        return [
            element
            for step in closure.chain
            for element in self._of_step(placement, step)
        ]

    def _of_step(self, placement: Placement, step: Step) -> list[Element]:
        if step.pair in self.structure.shifts:
            return self._of_point(placement, step.pair)
        if step.pair in self.structure.embedded:
            return self._of_rotation(placement, step)
        numbers = self.structure.variables_of(step.pair)[:: step.sign]
        return [self._of_variable(placement, number) for number in numbers]

    def _of_point(self, placement: Placement, pair: int) -> list[Element]:
        """The slides of a free point."""
        point = self.structure.point_pairs[pair]
        largest = self.rods.shift_of_point(point)
        elements = []
        columns = self.structure.shifts[pair]
        for column, direction in zip(columns, point.directions, strict=True):
            block = int(self.blocks.of_column[column])
            along = placement.axes @ direction
            elements.append(Element(block, 1.0, False, along, ORIGIN, shift=largest))
        return elements

    def _of_rotation(self, placement: Placement, step: Step) -> list[Element]:
        """The unit vectors of an embedded rotation, and the translation of a free
        pair, which comes after it."""
        blocks = self.blocks.of(self.structure.embedded[step.pair])
        center = placement.point(self.structure.center(step.pair))
        stretches = (self._stretch, 1.0)  # both are of one rotation
        elements = [
            Element(block, 1.0, True, ORIGIN, center, stretch=stretch)
            for block, stretch in zip(blocks[:COLUMNS], stretches, strict=True)
        ]
        for block in blocks[COLUMNS:]:
            largest = self.rods.shift_of_body(self.structure.free_pairs[step.pair])
            slide = Element(block, 1.0, False, ORIGIN, ORIGIN, shift=largest)
            elements.insert(0, slide)
        return elements[:: step.sign]

    def _of_variable(self, placement: Placement, number: int) -> Element:
        motion = self.structure.mechanism.variables[number].motion
        share = self.structure.share(number)
        largest = self.structure.largest_value(number)
        block = None if share is None else int(self.blocks.of_column[share.column])
        rate = 0.0 if share is None else abs(share.rate)
        direction = placement.direction(motion)
        if not motion.is_turn:
            return Element(block, rate, False, direction, ORIGIN, 0.0, largest)
        advance = motion.advance / placement.unit
        shift = abs(advance) * largest if advance else 0.0
        point = placement.point_on_axis(motion)
        return Element(block, rate, True, direction, point, advance, shift)


def extent(elements: Sequence[Element], start: np.ndarray, end: np.ndarray) -> float:
    """How far a point that the whole chain carries, at ``end`` (3,) in the reference
    configuration, can be from the ``start`` (3,): along the joints."""
    points = [start, *(one.point for one in elements if one.is_turn), end]
    hops = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shifts = sum(element.shift for element in elements)
    return float(hops.sum() + shifts)


def reaches(elements: Sequence[Element], start: np.ndarray) -> np.ndarray:
    """How far every axis (e,) can be from a ``start`` (3,) that comes after all of
    them: from axis to axis on the shortest way, each slide by as much as it can."""
    reach = []
    place, total = start, 0.0
    for element in reversed(elements):
        if element.is_turn:
            # the point of the axis nearest to the last one
            along = (place - element.point) @ element.direction
            foot = element.point + along * element.direction
            total += float(np.linalg.norm(foot - place))
            place = foot
        reach.append(total)
        total = element.stretch * total + element.shift
    return np.array(reach[::-1])
