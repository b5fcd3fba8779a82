"""The closure equations of a mechanism, written on a tape.

A cycle of pairs is closed when the product of the displacements along it is the
identity (the product of exponentials in the reference configuration, Brockett 1984).
Where a chain ends in a spherical joint, a point comes back to itself; between two of
them, two points keep their distance. A mechanism that is made with errors has small
displacements at both ends of every joint, and so has one of other lengths.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, pairwise

import numpy as np

from bifurc.domain import Domain
from bifurc.equations.recorded import RecordedNumber, Recorder
from bifurc.equations.system import ScaledTape
from bifurc.equations.tape import Tape
from bifurc.function_problem import EXACT_HESSIAN
from bifurc.problem import Problem
from bifurc.system import Accuracy, Curvature
from linkages.closure.changes import AS_GIVEN, Changes
from linkages.closure.curvature import CurvatureBounds
from linkages.closure.motors import (
    IDENTITY,
    Motor,
    Number,
    Point,
    combination,
    is_zero,
    product,
    rotated_about,
    slide,
    turn,
)
from linkages.closure.parts import NEARLY_CLOSED, ClosureParts
from linkages.decisions import is_rounding_of_zero
from linkages.mechanisms.joint import Motion
from linkages.structure.cycles import Step
from linkages.structure.placement import Placement
from linkages.structure.structure import Closure, ClosureKind, Structure

# unknowns up to which compiled methods with dense matrices take no longer than those in
# Python: for sections with spheres, and for curves of equations that are not sparse
LARGEST_COMPILED = 250
MANY = 300  # unknowns beyond which no dense matrix is to be made
STRIDE_OF = 12  # joints, the most of a loop: up to there a stride is the scale


@dataclass(frozen=True)
class Equations:
    """The ``tape`` of all equations, and how many of them belong to each closure."""

    tape: Tape
    counts: tuple[int, ...]


def parts_of_structure(
    structure: Structure, changes: Changes = AS_GIVEN
) -> ClosureParts:
    """The closure equations of the mechanism of a ``structure`` in the variables of its
    joints, with what ``changes``.

    Angles are in radians, slides in characteristic lengths. All derivatives are exact.
    """
    domain = domain_of(structure)
    equations = write_equations(structure, changes)
    tape = equations.tape
    accuracy = Accuracy(
        derivatives="recorded",
        equations=f"recorded ({tape.size} operations)",
        data_rounding=structure.mechanism.coordinate_rounding / structure.unit,
        hessian_error=EXACT_HESSIAN,
    )
    is_many = tape.n > MANY
    # a closure of each counts as it does alone
    magnitude = domain.stride if is_many else Problem.magnitude
    compiled = ScaledTape(
        tape,
        magnitude,
        domain,
        largest_dense=LARGEST_COMPILED,
        largest_sparse=math.inf,
        is_bordered=True,
    )
    ends = np.cumsum([0, *equations.counts]).tolist()
    return ClosureParts(
        domain=domain,
        accuracy=accuracy,
        compiled=compiled,
        bounds=partial(bounds_of_structure, structure),
        structure=structure,
        rows=tuple(slice(first, last) for first, last in pairwise(ends)),
        magnitude=magnitude,
    )


def domain_of(structure: Structure) -> Domain:
    """The unknowns of a structure and their region."""
    unknowns = structure.unknowns
    # in a step of the same angles more joints make it longer, by the root of their number
    stride = math.sqrt(max(1.0, len(unknowns) / STRIDE_OF))
    return Domain(
        names=tuple(unknown.label for unknown in unknowns),
        units=tuple(unknown.unit for unknown in unknowns),
        periods=np.array([unknown.period for unknown in unknowns]),
        bounds=np.array([[one.low, one.high] for one in unknowns]),
        stride=stride,
        has_crossings=len(unknowns) <= MANY,  # bridges take dense matrices
    )


def bounds_of_structure(structure: Structure) -> Curvature:
    """Bounds on F'' from the geometry."""
    bounds = CurvatureBounds(structure, NEARLY_CLOSED)
    return Curvature(bounds.near_solutions, bounds.at_complex_points, NEARLY_CLOSED)


def write_equations(
    structure: Structure, changes: Changes = AS_GIVEN, writer: Recorder | None = None
) -> Equations:
    """The equations of all closures, then those of the embedded spherical joints, with
    what ``changes``; on a tape of ``writer``, if it is given, whose first unknowns are
    those of the structure."""
    writer = writer or Recorder(len(structure.unknowns), math.inf)
    values = _values(structure, writer, changes)
    outputs: list[int] = []
    counts = []
    for number in range(len(structure.closures)):
        equations = _ChainWriter(structure, number, writer, values, changes)
        slots = _slots(writer, equations.residuals())
        counts.append(len(slots))
        outputs += slots
    for columns in structure.embedded.values():
        numbers = [_unknown(writer, column) for column in columns]
        outputs += _slots(writer, _orthonormal(numbers[:3], numbers[3:6]))
    return Equations(writer.tape(outputs), tuple(counts))


def _unknown(writer: Recorder, number: int) -> RecordedNumber:
    return RecordedNumber(writer, writer.unknown(number))


def _values(structure: Structure, writer: Recorder, changes: Changes) -> list[Number]:
    """The value of every variable: an unknown, or the number at which it is locked."""
    values: list[Number] = []
    for number, variable in enumerate(structure.mechanism.variables):
        share = structure.share(number)
        if share is not None:
            unknown = _unknown(writer, share.column)
            rate, offset = changes.share(number) or (share.rate, share.offset)
            values.append(_followed(unknown, rate, offset))
            continue
        value = changes.lock(number)
        if value is None:
            assert variable.locked is not None
            unit = 1.0 if variable.motion.is_turn else structure.unit
            value = variable.locked / unit
        values.append(value)
    return values


def _followed(value: Number, rate: Number, offset: Number) -> Number:
    """The value of a variable from that of its unknown."""
    if not (isinstance(rate, float) and rate == 1.0):
        value = rate * value
    return value if is_zero(offset) else value + offset


def _slots(writer: Recorder, residuals: Sequence[Number]) -> list[int]:
    """The slots of equations, without those that hold whatever the unknowns are."""
    slots = []
    for residual in residuals:
        if not isinstance(residual, RecordedNumber):
            residual = RecordedNumber(writer, writer.constant(float(residual)))
        value = writer.value(residual.slot)
        if value is None or not is_rounding_of_zero(abs(value)):
            slots.append(residual.slot)
    return slots


def _orthonormal(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    """The equations of two orthogonal unit vectors; 0 where they are."""
    return [
        0.5 * (_dot(a, a) - 1.0),
        0.5 * (_dot(b, b) - 1.0),
        _dot(a, b),
    ]


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Sequence[Number], b: Sequence[Number]) -> list[Number]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


# --- one chain ------------------------------------------------------------------------


class _ChainWriter:
    """The equations of the closure of this ``number`` while they are written."""

    def __init__(
        self,
        structure: Structure,
        number: int,
        writer: Recorder,
        values: Sequence[Number],
        changes: Changes,
    ):
        self.structure = structure
        self.number = number
        self.writer = writer
        self.values = values
        self.changes = changes
        self.placement = self._placement()

    @property
    def closure(self) -> Closure:
        """What has to close."""
        return self.structure.closures[self.number]

    def _placement(self) -> Placement:
        """The frame of the equations; no chain is planar or spherical with displacements
        that are not."""
        placement = self.structure.placement(self.closure)
        moved = []
        for step in self.closure.chain:
            elements = [*self.changes.before(step), *self.changes.after(step)]
            moved += [motion for motion, _ in elements if motion.is_turn]
            for number in self.structure.variables_of(step.pair):
                if self.changes.lock(number) is not None:
                    moved.append(self.structure.mechanism.variables[number].motion)
        if not moved:
            return placement
        own = [m for step in self.closure.chain for m in self.structure.motions(step)]
        both = Placement.of_chain([*own, *moved], self.structure.unit)
        return replace(
            placement,
            is_planar=placement.is_planar and both.is_planar,
            is_spherical=placement.is_spherical and both.is_spherical,
        )

    def residuals(self) -> list[Number]:
        """The equations, 0 where the chain is closed; lengths in the structure's
        unit."""
        if self.closure.kind is ClosureKind.CYCLE:
            return self._of_cycle()
        off_first, off_second = self.changes.ends(self.number)
        first = self._point(self.closure.first, off_first)
        second = self._point(self.closure.second, off_second)
        arrival = self._moved(second)
        gaps = [x - c for x, c in zip(arrival, first, strict=True)]
        if self.closure.kind is ClosureKind.POINT:
            return gaps
        return [self._of_rod(_dot(gaps, gaps))]

    def _point(self, place: np.ndarray, off: Sequence[Number]) -> Point:
        """A place (3,) of the file and how far off it is, in the frame."""
        point = self.placement.point(place)
        axes = self.placement.axes
        return [
            float(c) + combination(row, off) for c, row in zip(point, axes, strict=True)
        ]

    def _of_rod(self, square: Number) -> Number:
        """How much too long a rod is, for small errors, from the ``square`` of the
        distance of its ends."""
        rod = self.closure.rod
        assert rod is not None
        rest = rod.length / self.structure.unit + self.changes.rod(self.number)
        length: Number = rest
        if rod.leg is not None:
            length = rest + rod.leg.sign * self.values[rod.leg.variable]
        return (square - length * length) / (2 * rest)

    def _of_cycle(self) -> list[Number]:
        """Twice the vector part of the product of motors: for small errors the rotation
        vector and the translation. It is zero at closure alone, at half turns it is
        not."""
        motor = IDENTITY
        steps = map(self._elements_with_changes, self.closure.chain)
        for motion, value in _joined(chain.from_iterable(steps)):
            motor = product(motor, self._motor(motion, value))
        return [2.0 * number for number in (*motor.real[1:], *motor.dual[1:])]

    def _elements_with_changes(self, step: Step) -> Iterator[tuple[Motion, Number]]:
        """The same with the displacements at both ends of the joint."""
        yield from self.changes.before(step)
        yield from self._elements(step)
        yield from self.changes.after(step)

    def _elements(self, step: Step) -> Iterator[tuple[Motion, Number]]:
        """The elementary motions of a step, the last to act first, with their
        values."""
        variables = self.structure.variables_of(step.pair)
        for number in variables[:: step.sign]:
            value = self.values[number]
            if is_zero(value):
                continue
            motion = self.structure.mechanism.variables[number].motion
            yield motion, value if step.sign > 0 else -value

    def _motor(self, motion: Motion, value: Number) -> Motor:
        direction = self.placement.direction(motion)
        if not motion.is_turn:
            return slide(direction, value)
        moment = np.cross(self.placement.point_on_axis(motion), direction)
        half = 0.5 * value
        advance = self._advance(motion, value)
        return turn(direction, moment, np.cos(half), np.sin(half), advance)

    def _advance(self, motion: Motion, value: Number) -> Number:
        """How far a turn by ``value`` advances, in the unit of the structure."""
        if motion.advance == 0.0:
            return 0.0
        return (motion.advance / self.structure.unit) * value

    # --- points -----------------------------------------------------------------------

    def _moved(self, point: Point) -> Point:
        """Where the chain takes a ``point`` (3,) of its last body."""
        for step in reversed(self.closure.chain):
            point = self._moved_by_all(point, self.changes.after(step))
            if step.pair in self.structure.shifts:
                point = self._carried(point, step)
            elif step.pair in self.structure.embedded:
                point = self._turned_freely(point, step)
            else:
                point = self._moved_by_all(point, self._elements(step))
            point = self._moved_by_all(point, self.changes.before(step))
        return point

    def _moved_by_all(
        self, point: Point, elements: Iterable[tuple[Motion, Number]]
    ) -> Point:
        """A point moved by elementary motions, the last one first."""
        for motion, value in reversed(list(elements)):
            point = self._moved_by(point, motion, value)
        return point

    def _moved_by(self, point: Point, motion: Motion, value: Number) -> Point:
        direction = self.placement.direction(motion)
        if not motion.is_turn:
            return _shifted(point, direction, value)
        center = self.placement.point_on_axis(motion)
        turned = rotated_about(point, direction, center, np.cos(value), np.sin(value))
        return _shifted(turned, direction, self._advance(motion, value))

    def _carried(self, point: Point, step: Step) -> Point:
        """A point moved by the pair of a free point."""
        columns = self.structure.shifts[step.pair]
        directions = self.structure.point_pairs[step.pair].directions
        for column, direction in zip(columns, directions, strict=True):
            distance = step.sign * _unknown(self.writer, column)
            point = _shifted(point, self.placement.axes @ direction, distance)
        return point

    def _turned_freely(self, point: Point, step: Step) -> Point:
        """A point turned by an embedded spherical joint, and moved by a free pair: the
        columns of the rotation are two unit vectors and their cross product."""
        center = self.placement.point(self.structure.center(step.pair))
        columns = self.structure.embedded[step.pair]
        numbers: list[Number] = [_unknown(self.writer, one) for one in columns]
        a, b, shift = numbers[:3], numbers[3:6], numbers[6:] or [0.0, 0.0, 0.0]
        vectors = [a, b, _cross(a, b)]
        offset = [x - float(c) for x, c in zip(point, center, strict=True)]
        if step.sign < 0:
            offset = [x - t for x, t in zip(offset, shift, strict=True)]
            turned = [_dot(vector, offset) for vector in vectors]
        else:
            rows = zip(*vectors, strict=True)
            turned = [_dot(row, offset) for row in rows]
            turned = [x + t for x, t in zip(turned, shift, strict=True)]
        return [float(c) + x for c, x in zip(center, turned, strict=True)]


def _joined(
    elements: Iterable[tuple[Motion, Number]],
) -> Iterator[tuple[Motion, Number]]:
    """The elementary motions, those that follow each other about one axis made one, by
    the sum of their values: as where a chain crosses an axis of several bodies."""
    before: tuple[Motion, Number] | None = None
    for motion, value in elements:
        if before is not None and _is_same(before[0], motion):
            before = motion, before[1] + value
            continue
        if before is not None:
            yield before
        before = motion, value
    if before is not None:
        yield before


def _is_same(motion: Motion, other: Motion) -> bool:
    if motion.is_turn != other.is_turn or motion.advance != other.advance:
        return False
    is_same_axis = np.array_equal(motion.point, other.point) or not motion.is_turn
    return is_same_axis and np.array_equal(motion.direction, other.direction)


def _shifted(point: Point, direction: np.ndarray, distance: Number) -> Point:
    if is_zero(distance):
        return point
    return [x + distance * float(d) for x, d in zip(point, direction, strict=True)]
