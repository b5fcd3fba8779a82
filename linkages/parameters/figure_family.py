"""Mechanisms of bars in a plane, and of arcs on a sphere, as families: the lengths of bars
and the angles of arcs are their parameters.

A bar has its start where it is drawn, and its other points are moved on it; so joints are
off their places on the bodies that they join, as they are by errors.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bifurc.decisions import is_start_solved
from linkages.closure.changes import Changes, Elements
from linkages.closure.motors import Number, is_zero
from linkages.entry import Parameter, ParameterKind
from linkages.files.arcs import ArcAssembly
from linkages.files.bars import BarAssembly
from linkages.files.figures import FRAME, Figure, Piece, bodies_of_figure
from linkages.mechanisms.joint import Motion, Vector
from linkages.mechanisms.mechanism import Mechanism
from linkages.parameters.mechanism_family import MechanismFamily
from linkages.parameters.table_family import table_parameter
from linkages.readout.poses import Poses
from linkages.structure.structure import Structure
from linkages.values import GeometryError, require

if TYPE_CHECKING:
    import mpmath

STARTS = 64  # random ones, from which a member is assembled
ACROSS = (np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
CENTRE = np.zeros(3)


class FigureFamily(MechanismFamily):
    """The mechanisms of a figure with ``bodies`` that hold points, by their names; those
    that are a piece of their own have its measure for a parameter."""

    def __init__(
        self,
        mechanism: Mechanism,
        figure: Figure[Any, Any],
        bodies: Mapping[str, Sequence[str]],
    ):
        super().__init__(mechanism, ())
        self.figure, self.bodies = figure, bodies
        self.pieces = {one.name: one for one in figure.pieces if one.name in bodies}
        self.parameters = tuple(self._parameters())

    @abstractmethod
    def _parameters(self) -> Iterator[Parameter]:
        """The parameters."""

    @abstractmethod
    def moved(
        self, body: str, point: str, values: Mapping[str, Number], unit: float
    ) -> Elements:
        """The displacement of a point on a body from where it is drawn, in a
        ``unit``."""

    def changes(self, values: Mapping[str, Number], structure: Structure) -> Changes:
        return _MovedPoints(self, values, structure.unit)

    def offsets(self, values: Mapping[str, float]) -> np.ndarray:
        """A closed configuration (n,), the nearest to the one that is drawn where there is
        one near it."""
        closure = self.closure.at(np.array(list(values.values())))
        reference = self.structure.reference
        turns = np.random.default_rng(0).uniform(-np.pi, np.pi, (STARTS, closure.n))
        for starts in (reference[None], reference + turns):
            points, gaps = closure.project(starts)
            best = int(np.argmin(gaps))
            if is_start_solved(float(gaps[best])):
                assembled: np.ndarray = points[best]
                return assembled
        given = [
            f"{name} = {value:.10g}"
            for name, value in values.items()
            if value != self.defaults[name]
        ]
        allowed = "such that it can be assembled"
        raise GeometryError(f"{self.name} with", ", ".join(given), allowed)

    def drawn(self, values: Mapping[str, float]) -> Mechanism:
        poses = Poses(self.structure, self.changes(values, self.structure))
        drawn = poses.at(self.offsets(values)[None])[0]
        bodies = self.structure.mechanism.bodies
        first: dict[str, int] = {}
        for number, pair in enumerate(self.structure.mechanism.pairs):
            first.setdefault(pair.joint, number)
        joints = []
        for joint in self.mechanism.joints:
            base = drawn[bodies.index(joint.bodies[0])]
            pose = base @ poses.change(first[joint.name], 0)
            point = pose[:3, :3] @ joint.place + pose[:3, 3]
            direction = pose[:3, :3] @ np.array(joint.direction)
            joints.append(replace(joint, point=_row(point), direction=_row(direction)))
        return replace(self.mechanism, joints=tuple(joints))


def _row(vector: np.ndarray) -> Vector:
    x, y, z = vector.tolist()
    return x, y, z


class _MovedPoints(Changes):
    """The points of a ``family`` where they are on its bodies with these ``values``."""

    def __init__(self, family: FigureFamily, values: Mapping[str, Number], unit: float):
        self.family, self.values, self.unit = family, values, unit
        self.pairs = family.structure.mechanism.pairs

    def displacement(self, pair: int, side: int) -> Elements:
        one = self.pairs[pair]
        body = one.moved if side else one.base
        moved = self.family.moved(body, one.joint, self.values, self.unit)
        if not side:
            return moved
        return [(motion, -value) for motion, value in reversed(moved)]


# --- bars -----------------------------------------------------------------------------


class _Place(NamedTuple):
    """A point of the plane, in numbers of any kind."""

    x: Number
    y: Number

    def beside(self, other: _Place, factor: _Place) -> _Place:
        """This point and a complex ``factor`` of the way to the ``other`` one.

        Coordinates are multiplied before they are subtracted: the difference of two
        doubles is rounded, before a factor of more digits comes to it.
        """
        return _Place(
            self.x
            + (factor.x * other.x - factor.x * self.x)
            - (factor.y * other.y - factor.y * self.y),
            self.y
            + (factor.x * other.y - factor.x * self.y)
            + (factor.y * other.x - factor.y * self.x),
        )


def _over(bar: str) -> str:
    """What 1 over the length with which a bar is drawn is called."""
    return f"1/{bar}"


class BarFamily(FigureFamily):
    """The mechanisms of bars of other lengths: A-B is the length of the bar from A to B,
    P.x and P.y are the coordinates of a fixed point, and C.along and C.aside, over the
    length of its bar, where C is on it."""

    def __init__(self, mechanism: Mechanism, assembly: BarAssembly):
        self.places = {name: complex(*at) for name, at in assembly.places.items()}
        bodies = bodies_of_figure(assembly.figure, assembly.hold_together)
        super().__init__(mechanism, assembly.figure, bodies)
        for body, points in bodies.items():
            known = self._places_on(body, self.defaults)
            for point in points:
                allowed = (
                    f"at an end or on a bar of {body}, for lengths to be parameters"
                )
                require(
                    point in known, f"point {point}", "held by other points", allowed
                )

    def _parameters(self) -> Iterator[Parameter]:
        size = self.structure.unit
        for name, bar in self.pieces.items():
            drawn = abs(self.places[bar.end] - self.places[bar.start])
            length = drawn if bar.measure is None else bar.measure
            yield table_parameter(name, length, f"length of bar {name}", size)
        for name in self.figure.fixed:
            if name in self.figure.points:
                place = self.places[name]
                for axis, value in zip("xy", (place.real, place.imag), strict=True):
                    meaning = f"{axis} of point {name}"
                    yield table_parameter(f"{name}.{axis}", value, meaning, size)
        for name, one in self.figure.on_pieces.items():
            where = f"bar {one.start}-{one.end}, over its length"
            for word, value in (
                ("along", one.numbers.real),
                ("aside", one.numbers.imag),
            ):
                meaning = f"where {name} is {word} {where}"
                low, high = value - 0.5, value + 0.5
                kind = ParameterKind.NUMBER
                yield Parameter(f"{name}.{word}", value, kind, meaning, low, high)

    def moved(
        self, body: str, point: str, values: Mapping[str, Number], unit: float
    ) -> Elements:
        place, drawn = self._places_on(body, values)[point], self.places[point]
        gaps = (place.x - drawn.real, place.y - drawn.imag)
        return [
            (Motion(False, axis, CENTRE), gap / unit)
            for axis, gap in zip(ACROSS, gaps, strict=True)
            if not is_zero(gap)
        ]

    @property
    def _precise_structure(self) -> Structure:
        return self.structure.unscaled

    def _ends(self, bar: Piece) -> tuple[complex, complex]:
        """Where the ends of a bar are drawn."""
        return self.places[bar.start], self.places[bar.end]

    def constants(self) -> dict[str, mpmath.mpf]:
        """1 over the lengths with which bars are drawn: a bar is so often longer."""
        import mpmath

        constants = {}
        for name, bar in self.pieces.items():
            start, end = self._ends(bar)
            sides = [
                mpmath.mpf(end.real) - start.real,
                mpmath.mpf(end.imag) - start.imag,
            ]
            constants[_over(name)] = 1 / mpmath.hypot(*sides)
        return constants

    def _places_of_ends(
        self, body: str, values: Mapping[str, Number]
    ) -> dict[str, _Place]:
        """Where the ends of a bar are on it: its start where it is drawn."""
        bar = self.pieces[body]
        start, end = [_Place(z.real, z.imag) for z in self._ends(bar)]
        over = values.get(_over(body))
        if over is None:
            over = 1.0 / abs(complex(end.x - start.x, end.y - start.y))
        moved = start.beside(end, _Place(values[body] * over, 0.0))
        return {bar.start: start, bar.end: moved}

    def _places_on(self, body: str, values: Mapping[str, Number]) -> dict[str, _Place]:
        """Where the points of a body are on it."""
        places = {}
        if body == FRAME:
            for name in self.figure.fixed:
                at = self.places[name]
                x, y = (
                    values.get(f"{name}.x", at.real),
                    values.get(f"{name}.y", at.imag),
                )
                places[name] = _Place(x, y)
        else:
            places = self._places_of_ends(body, values)
        for name, one in self.figure.on_pieces.items():
            is_new = name in self.bodies[body] and name not in places
            if is_new and one.start in places and one.end in places:
                factor = _Place(values[f"{name}.along"], values[f"{name}.aside"])
                places[name] = places[one.start].beside(places[one.end], factor)
        return places


# --- arcs -----------------------------------------------------------------------------


class ArcFamily(FigureFamily):
    """The mechanisms of arcs of other angles: A-B is the angle of the arc from A to B."""

    def __init__(self, mechanism: Mechanism, assembly: ArcAssembly):
        self.assembly = assembly
        bodies = bodies_of_figure(assembly.figure, assembly.hold_together)
        super().__init__(mechanism, assembly.figure, bodies)

    def _parameters(self) -> Iterator[Parameter]:
        for name, arc in self.pieces.items():
            others = self.figure.on_pieces.values()
            is_fixed = any(
                arc.end in (one.start, one.end)
                and {one.start, one.end} != set(arc.ends)
                for one in others
                if {one.start, one.end} <= set(self.bodies[name])
            )
            if not is_fixed:
                meaning = f"angle of arc {name}"
                yield table_parameter(name, self.assembly.angle(arc), meaning)

    def moved(
        self, body: str, point: str, values: Mapping[str, Number], unit: float
    ) -> Elements:
        if body not in self.defaults:
            return ()
        arc = self.pieces[body]
        gap = values[body] - self.defaults[body]
        # the end moves with the points that are counted from there
        one = self.figure.on_pieces.get(point)
        is_moved = point == arc.end or (one is not None and one.start == arc.end)
        if not is_moved or is_zero(gap):
            return ()
        return [(Motion(True, self.assembly.normal(arc), CENTRE), gap)]
