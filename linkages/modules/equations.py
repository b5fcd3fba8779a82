"""The closures of a mechanism as a family of polynomials: the geometry is a parameter.

Unknowns are exp(i x) and exp(-i x) of every angle x, slides, coordinates of points and
the numbers of rotations. A chain of turns and slides takes a point or a frame somewhere;
where that has to be, the target, is a parameter of the closure, beside the axes and
points of the chain. So the target is a function of the unknowns, which are on circles
and rotations, and of all other parameters: the solutions of all members are one
irreducible variety, also where the targets alone are varied
(`bifurc.paths.monodromy`).

On a straight way of parameters every member has to be one. So a unit direction is e_x
reflected in a vector of any length, a given angle has the ratio of two numbers as the
tangent of its half, and a rotation is that of a quaternion of any length.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import chain
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np

from bifurc.equations.recorded import RecordedNumber
from bifurc.paths.family import Family
from bifurc.paths.follow import PathEnd
from bifurc.paths.monodromy import Projection
from linkages.decisions import is_short_bar, meets_in_one_point
from linkages.dyads.generic import RealFamily, UnfollowedError
from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Variable
from linkages.structure.cycles import Step
from linkages.structure.placement import Placement
from linkages.structure.rods import Rod
from linkages.structure.structure import (
    CONSTRAINTS,
    Closure,
    ClosureKind,
    Structure,
)

# recorded, complex or real
Number: TypeAlias = Any
Point: TypeAlias = Any  # three of them, in any sequence

# the blocks of the linear function that is held: its weights and its value
WEIGHTS, DRIVER = "weights", "driver"
ROTATION = 6  # numbers of an embedded rotation: two orthonormal vectors
X_AXIS, Y_AXIS, ORIGIN = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
OF_SINES = -0.5j  # the sine of x is this times exp(i x) - exp(-i x)
FLAT = {ClosureKind.CYCLE: 3, ClosureKind.POINT: 2, ClosureKind.ROD: 1}
# of a length, and of the square of a vector: it is none
NO_LENGTH, ROUNDING = 1e-12, 1e-20
# Complex ones of a generic member that are looked for. Types with more of them are at
# hand, or are not followed.
MOST_SOLUTIONS = 48
# that are followed to find those of a driven mechanism, of which others are to be found
# as well: some seconds
MOST_DRIVEN_PATHS = 600
# Imaginary parts of the numbers of generic members that are tried, one after the other.
# Along a chain of displacements products of numbers that are far from real become large;
# from numbers that are nearly real paths pass near singular members.
IMAGINARY = (0.5, 0.4, 0.6, 0.3)


@dataclass
class Parameters:
    """Blocks of numbers by name, one after the other: of a given mechanism."""

    blocks: dict[tuple[str, int], slice] = field(default_factory=dict)
    given: list[complex] = field(default_factory=list)

    def add(self, name: str, number: int, values: Iterable[complex]) -> None:
        """A further block, with the values that the given mechanism has there."""
        first = len(self.given)
        self.given.extend(map(complex, values))
        self.blocks[name, number] = slice(first, len(self.given))


class Move(NamedTuple):
    """A ``variable``, by number, that a chain passes, the other way round where the
    ``sign`` is -1."""

    sign: int
    variable: int


class Places:
    """Vectors (3,), each with a number: the same where they are the same to rounding,
    lengths over that of the mechanism."""

    def __init__(self) -> None:
        self.vectors: list[np.ndarray] = []

    def number(self, vector: np.ndarray) -> int:
        """The number of a vector, a new one where it is not known."""
        for number, known in enumerate(self.vectors):
            if meets_in_one_point(float(np.linalg.norm(vector - known)), 1.0):
                return number
        self.vectors.append(vector)
        return len(self.vectors) - 1


class ClosureFamily(RealFamily):
    """The closures of a ``structure``, and a linear function of the unknowns if it
    ``is_driven``: of those of some numbers, the ``drivers``, it is of the unknown itself
    where there is one. Its weights and its value are parameters.

    Raises `ValueError` where they are more or fewer than the other unknowns, and for
    what is no polynomial: helical joints, ratios of coupled turns other than 1 and -1.
    """

    most: ClassVar[int] = MOST_SOLUTIONS

    @property
    def most_paths(self) -> int:
        """How many paths are followed at most to find them."""
        return MOST_DRIVEN_PATHS if self.is_driven else super().most_paths

    def __init__(self, structure: Structure, is_driven: bool = False):
        self.structure, self.is_driven = structure, is_driven
        self.drivers: tuple[int, ...] = ()
        self.placement = self._placement()
        self._require_square()
        _require_polynomials(structure)
        self._directions, self._points = Places(), Places()
        self.parameters = self._parameters()

    def driven_by(self, drivers: tuple[int, ...]) -> ClosureFamily:
        """The same with these drivers."""
        other = copy(self)
        other.family, other.drivers = self.family, drivers
        return other

    @property
    def name(self) -> str:
        """What its equations, and the drivers among its unknowns, are called."""
        return "-".join([super().name, *map(str, self.drivers)])

    # --- the frame --------------------------------------------------------------------

    def _placement(self) -> Placement:
        """The frame of all equations; in a plane or on a sphere it is laid there."""
        structure = self.structure
        if structure.embedded or structure.point_pairs:
            return Placement(np.zeros(3), np.eye(3), structure.unit)
        variables = structure.mechanism.variables
        motions = [one.motion for one in variables if one.locked != 0.0]
        placement = Placement.of_chain(motions, structure.unit)
        slides = [placement.direction(one) for one in motions if not one.is_turn]
        leave_plane = placement.is_planar and (
            any(abs(one[2]) > 0.0 for one in slides)
            or any(map(partial(_rises, placement), structure.rods))
        )
        if leave_plane or (placement.is_spherical and slides):
            return Placement(np.zeros(3), np.eye(3), structure.unit)
        return placement

    def freedoms(self, closure: Closure) -> int:
        """How many unknowns a closure determines."""
        if self.placement.is_planar or self.placement.is_spherical:
            return FLAT[closure.kind]
        return CONSTRAINTS[closure.kind]

    def _require_square(self) -> None:
        """Raises `ValueError` where the closures determine more or fewer unknowns than
        there are."""
        structure = self.structure
        unknowns = len(structure.unknowns) - len(self.standing)
        unknowns -= 3 * len(structure.embedded)
        equations = sum(map(self.freedoms, self.closures))
        equations += self.is_driven
        if unknowns != equations:
            raise ValueError("it moves, or more holds it than has to")

    # --- unknowns ---------------------------------------------------------------------

    @cached_property
    def _standing_pairs(self) -> list[int]:
        """The pairs of points that stand: two rods hold one in a plane, on one side of
        the line between their other ends."""
        return [
            pair
            for pair, point in self.structure.point_pairs.items()
            if len(point.directions) == 2
            and bool(-point.limits[1, 0] != point.limits[1, 1])
        ]

    @cached_property
    def standing(self) -> set[int]:
        """The unknowns, by number, of points that stand."""
        shifts = self.structure.shifts
        return {number for pair in self._standing_pairs for number in shifts[pair]}

    @cached_property
    def closures(self) -> list[Closure]:
        """The chains that have to close, but for those of rods that hold what stands."""
        return [
            closure
            for closure in self.structure.closures
            if not closure.chain
            or any(step.pair not in self._standing_pairs for step in closure.chain)
        ]

    @property
    def is_single(self) -> bool:
        """Whether there is a single chain, of joints alone."""
        if len(self.closures) != 1:
            return False
        steps = self.closures[0].chain
        return all(self.structure.variables_of(step.pair) for step in steps)

    @cached_property
    def moves(self) -> list[Move]:
        """What all chains pass, but for what is locked at 0."""
        return [
            move
            for closure in self.closures
            for step in closure.chain
            for move in self.moves_of(step)
        ]

    def moves_of(self, step: Step) -> list[Move]:
        """The variables of a step, in the order in which it passes them, but for those
        locked at 0."""
        numbers = self.structure.variables_of(step.pair)[:: step.sign]
        variables = self.structure.mechanism.variables
        return [
            Move(step.sign, number)
            for number in numbers
            if variables[number].locked != 0.0
        ]

    def unknown_of(self, move: Move) -> int | None:
        """The unknown, by number, that a move is of; None where it is locked."""
        share = self.structure.share(move.variable)
        return None if share is None else share.column

    @cached_property
    def columns(self) -> list[slice]:
        """The coordinates of every unknown x: exp(i x) and exp(-i x) of an angle; none
        of what stands."""
        columns, first = [], 0
        for number, unknown in enumerate(self.structure.unknowns):
            size = 2 if unknown.is_angle else 1
            if number in self.standing:
                size = 0
            columns.append(slice(first, first + size))
            first += size
        return columns

    @property
    def n(self) -> int:
        """The number of coordinates."""
        last: int = self.columns[-1].stop
        return last

    def conjugates(self, coordinates: np.ndarray) -> np.ndarray:
        """The coordinates (k, c) of the complex conjugate configurations."""
        order = np.arange(self.n)
        for unknown, place in zip(self.structure.unknowns, self.columns, strict=True):
            if unknown.is_angle:
                order[place] = order[place][::-1]
        conjugates: np.ndarray = coordinates[:, order].conj()
        return conjugates

    def points(self, coordinates: np.ndarray) -> np.ndarray:
        """The unknowns (k, n) of the structure at coordinates (k, c) of real
        configurations."""
        points = np.zeros((len(coordinates), len(self.structure.unknowns)))
        for number, unknown in enumerate(self.structure.unknowns):
            if number not in self.standing:
                own = coordinates[:, self.columns[number].start]
                points[:, number] = np.angle(own) if unknown.is_angle else own.real
        return points

    # --- parameters -------------------------------------------------------------------

    def _parameters(self) -> Parameters:
        """Those of the structure."""
        structure, placement = self.structure, self.placement
        parameters = Parameters()
        self._number_geometry()
        parameters.add("of sines", 0, [OF_SINES])
        for k, direction in enumerate(self._directions.vectors):
            parameters.add("direction", k, mirror_of(direction))
        for k, point in enumerate(self._points.vectors):
            parameters.add("point", k, point[: 2 if placement.is_planar else 3])
        for pair, free in structure.point_pairs.items():
            parameters.add("shift", pair, (free.directions @ placement.axes.T).ravel())
        for number, variable in enumerate(structure.mechanism.variables):
            if variable.locked:
                parameters.add("locked", number, self._locked(variable))
        self._add_targets(parameters)
        return parameters

    def _add_targets(self, parameters: Parameters) -> None:
        """Where chains have to lead, and what is held."""
        unit, unknowns = self.structure.unit, self.structure.unknowns
        for k, closure in enumerate(self.closures):
            if closure.rod is not None and closure.rod.leg is not None:
                parameters.add("leg", k, [closure.rod.length / unit])
            parameters.add("target", k, self.target_of(closure))
        if self.is_driven:
            parameters.add(WEIGHTS, 0, [0.0] * len(unknowns))
            parameters.add(DRIVER, 0, [1.0])

    def _locked(self, variable: Variable) -> list[float]:
        """The parameters of what is locked: cosine and sine of half an angle, or a
        length."""
        value = variable.locked or 0.0
        if variable.motion.is_turn:
            return [np.cos(0.5 * value), np.sin(0.5 * value)]
        return [value / self.structure.unit]

    def target_of(self, closure: Closure) -> Sequence[float]:
        """Where the chain of a closure has to lead."""
        if closure.kind is ClosureKind.CYCLE:
            return self._rest_frame()
        first = self.placement.point(closure.first)
        if closure.kind is ClosureKind.POINT:
            place: list[float] = first[: 2 if self.placement.is_planar else 3].tolist()
            return place
        rod = closure.rod
        assert rod is not None
        if rod.leg is not None:
            return [0.0]
        length = rod.length / self.structure.unit
        if self.placement.is_spherical:
            # between points of the unit sphere
            length /= float(np.linalg.norm(first))
        return [length * length]

    def _rest_frame(self) -> list[float]:
        """The target of a cycle that comes back to where it began: a quaternion, and
        a translation where there is one."""
        if self.placement.is_planar:
            return [1.0, 0.0, 0.0, 0.0]
        shift = [] if self.placement.is_spherical else [0.0, 0.0, 0.0]
        return [1.0, 0.0, 0.0, 0.0, *shift]

    def _number_geometry(self) -> None:
        """Number all directions and points, in a fixed order."""
        for move in self.moves:
            motion = self.structure.mechanism.variables[move.variable].motion
            self.direction_of(motion)
            self.point_of(motion)
        for pair in self.structure.embedded:
            self.place_of(self.structure.center(pair))
        for closure in self.closures:
            if closure.kind is not ClosureKind.CYCLE:
                self.place_of(closure.second)
            if closure.kind is ClosureKind.ROD:
                self.place_of(closure.first)

    def direction_of(self, motion: Motion) -> tuple[str, int]:
        """The block of a direction."""
        direction = self.placement.direction(motion)
        if not self.placement.is_planar:
            return "direction", self._directions.number(direction)
        if motion.is_turn:
            return "normal", int(np.sign(direction[2]))
        return "point", self._points.number(direction)

    def point_of(self, motion: Motion) -> tuple[str, int]:
        """The block of a point on the axis of a turn."""
        if not motion.is_turn or self.placement.is_spherical:
            return "origin", 0
        return "point", self._points.number(self.placement.point_on_axis(motion))

    def place_of(self, place: np.ndarray) -> tuple[str, int]:
        """The block of a place of a body: on a sphere one on an axis."""
        point = self.placement.point(place)
        if self.placement.is_spherical:
            point /= np.linalg.norm(point)
            return "direction", self._directions.number(point)
        if self.placement.is_planar:
            point[2] = 0.0
        return "point", self._points.number(point)

    @cached_property
    def are_targets(self) -> np.ndarray:
        """Which parameters (q,) are targets."""
        are_targets = np.zeros(len(self.parameters.given), dtype=bool)
        for (name, _), place in self.parameters.blocks.items():
            are_targets[place] |= name in ("target", DRIVER)
        return are_targets

    @cached_property
    def are_fixed(self) -> np.ndarray:
        """Which parameters (q,) are the same for all members."""
        are_fixed = np.zeros(len(self.parameters.given), dtype=bool)
        for name in ("of sines", WEIGHTS):
            if (name, 0) in self.parameters.blocks:
                are_fixed[self.parameters.blocks[name, 0]] = True
        return are_fixed

    @property
    def given(self) -> np.ndarray:
        """The parameters (q,) of the structure."""
        given = np.array(self.parameters.given, dtype=complex)
        if self.is_driven:
            drawn = np.random.default_rng(len(self.drivers)).normal(
                size=len(self.drivers)
            )
            weights = given[self.parameters.blocks[WEIGHTS, 0]]
            weights[list(self.drivers)] = drawn
            weights[list(self.drivers[:1])] = 1.0
        return given

    def given_at(self, value: complex) -> np.ndarray:
        """The same with the drivers at a value, a single angle in rad."""
        given = self.given
        is_angle = self.structure.unknowns[self.drivers[0]].is_angle
        is_turn = is_angle and len(self.drivers) == 1
        at = np.exp(1j * value) if is_turn else value
        given[self.parameters.blocks[DRIVER, 0]] = at
        return given

    def driven(self, x: np.ndarray, p: np.ndarray) -> Number:
        """The linear function of coordinates x (n,) that is held, with its weights."""
        weights = p[self.parameters.blocks[WEIGHTS, 0]]
        firsts = [place.start for place in self.columns]
        value = weights[0] * x[firsts[0]]
        for weight, first in zip(weights[1:], firsts[1:], strict=True):
            value = value + weight * x[first]
        return value

    @property
    def projection(self) -> Projection:
        """The targets vary, and so many unknowns are looked at that the others follow: no
        driver that is given, and no slide where turns decide, as chains are linear in
        slides unless they lead to a distance; of the turns of a single cycle the others
        leave one displacement for the last one."""
        unknowns, kinds = self.structure.unknowns, [one.kind for one in self.closures]
        deciding = [k for k in range(len(unknowns)) if k not in self.standing]
        if ClosureKind.ROD not in kinds:
            deciding = [k for k in deciding if not unknowns[k].is_length]
        if len(self.drivers) == 1:
            deciding = [k for k in deciding if k != self.drivers[0]]
        is_coupled = len(self.moves) > len(unknowns)
        if kinds == [ClosureKind.CYCLE] and not is_coupled:
            deciding = deciding[:-1]
        block = np.array([self.columns[k].start for k in deciding], dtype=int)
        return Projection(self.are_targets, (block,))

    # --- equations --------------------------------------------------------------------

    @cached_property
    def family(self) -> Family:
        """The equations on a tape."""
        return Family.of(self._equations, self.n, len(self.parameters.given))

    def _equations(self, x: np.ndarray, p: np.ndarray) -> list[Number]:
        """What is 0 at a solution, but for what is 0 everywhere."""
        chains = _Chains(self, x, p)
        closures = enumerate(self.closures)
        gaps = [chains.gaps(k, closure) for k, closure in closures]
        gaps.append(chains.own_gaps())
        return [
            one
            for one in chain.from_iterable(gaps)
            if isinstance(one, RecordedNumber) and one.writer.value(one.slot) is None
        ]

    def generic_member(
        self, rng: np.random.Generator, attempt: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """A random solution (n,), and the parameters (q,) of the member that it is of,
        all with imaginary parts of about the size that belongs to the ``attempt``."""
        imaginary = IMAGINARY[attempt]
        p = _generic(rng, len(self.parameters.given), imaginary)
        p = np.where(self.are_fixed, self.given, p)
        x = _generic(rng, self.n, imaginary)
        for unknown, place in zip(self.structure.unknowns, self.columns, strict=True):
            if unknown.is_angle:
                x[place] = np.exp(np.array([1j, -1j]) * x[place.start])
        for columns in self.structure.embedded.values():
            frame = _rotation(_generic(rng, 4, imaginary))
            place = self.columns[columns[0]].start
            x[place : place + ROTATION] = [*frame[0], *frame[1]]
        chains = _Chains(self, x, p)
        for k, closure in enumerate(self.closures):
            p[self.parameters.blocks["target", k]] = chains.reached(k, closure)
        if self.is_driven:
            p[self.parameters.blocks[DRIVER, 0]] = self.driven(x, p)
        return x, p


def _rises(placement: Placement, rod: Rod) -> bool:
    """Whether a rod leads out of a plane."""
    first, second = map(placement.point, rod.centers)
    return not meets_in_one_point(abs(float(first[2] - second[2])), 1.0)


def _generic(rng: np.random.Generator, count: int, imaginary: float) -> np.ndarray:
    """Complex numbers (count,) about as large as 1, with such imaginary parts."""
    numbers: np.ndarray = rng.normal(size=count) + 1j * imaginary * rng.normal(
        size=count
    )
    return numbers


def mirror_of(direction: np.ndarray) -> np.ndarray:
    """A vector (3,) in which e_x reflected is a unit ``direction`` (3,)."""
    between = direction + X_AXIS
    return between if abs(between @ between) > ROUNDING else np.array(Y_AXIS)


def solutions_of(
    family: ClosureFamily, given: np.ndarray, structure: Structure
) -> np.ndarray:
    """All isolated solutions (k, n) of the member of a family with parameters (q,) that
    are those of a ``structure``.

    Raises `UnfollowedError` where it is not known that they are all.
    """
    paths = family.paths_to_regular(given)
    if np.any(paths.ends == PathEnd.AT_INFINITY):
        require_no_short_length(structure)
    return paths.regular


def require_no_short_length(structure: Structure) -> None:
    """Raise `UnfollowedError` where paths may come back that seem to end at infinity."""
    points = [
        variable.motion.point / structure.unit
        for variable in structure.mechanism.variables
        if variable.motion.is_turn
    ]
    places = [
        place / structure.unit
        for closure in structure.closures
        for place in (closure.first, closure.second)
    ]
    rows = np.array(points + places)
    gaps = np.linalg.norm(rows[:, None] - rows[None], axis=2)
    gaps = gaps[gaps > NO_LENGTH]
    if len(gaps) and is_short_bar(float((gaps.min() / gaps.max()) ** 2)):
        raise UnfollowedError("a length is so short that paths seem to end at infinity")


# --- numbers, recorded or not ---------------------------------------------------------


def _dot(a: Point, b: Point) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Point, b: Point) -> list[Number]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def _less(a: Point, b: Point) -> list[Number]:
    return [x - y for x, y in zip(a, b, strict=True)]


def _plus(a: Point, b: Point) -> list[Number]:
    return [x + y for x, y in zip(a, b, strict=True)]


def _times(factor: Number, a: Point) -> list[Number]:
    return [factor * x for x in a]


def _reflected(h: Point) -> list[Number]:
    """e_x reflected in h: a unit vector."""
    factor = 2.0 * h[0] / _dot(h, h)
    return [factor * h[0] - 1.0, factor * h[1], factor * h[2]]


def _rotation(q: Point) -> tuple[list[Number], list[Number]]:
    """The first two columns of the rotation of a quaternion of any length."""
    w, x, y, z = q
    size = w * w + x * x + y * y + z * z
    first = [
        w * w + x * x - y * y - z * z,
        2.0 * (x * y + w * z),
        2.0 * (x * z - w * y),
    ]
    second = [
        2.0 * (x * y - w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z + w * x),
    ]
    return [one / size for one in first], [one / size for one in second]


def quaternion(first: Point, second: Point) -> list[complex]:
    """A quaternion of a complex rotation by its first two columns."""
    matrix = np.array([first, second, _cross(first, second)]).T
    # times one number of the quaternion; the longest of four such
    skew = np.array(
        [
            matrix[2, 1] - matrix[1, 2],
            matrix[0, 2] - matrix[2, 0],
            matrix[1, 0] - matrix[0, 1],
        ]
    )
    table = np.empty((4, 4), dtype=complex)
    table[0, 0] = 1.0 + np.trace(matrix)
    table[0, 1:] = table[1:, 0] = skew
    table[1:, 1:] = matrix + matrix.T + (1.0 - np.trace(matrix)) * np.eye(3)
    row = table[np.argmax(np.abs(np.diag(table)))]
    numbers: list[complex] = (row / np.linalg.norm(row)).tolist()
    return numbers


class _Chains:
    """The chains of a ``family`` at coordinates x and parameters p, of any numbers."""

    def __init__(self, family: ClosureFamily, x: np.ndarray, p: np.ndarray):
        self.family, self.x, self.p = family, x, p
        self.structure = family.structure
        self._known: dict[tuple[str, int], Any] = {}

    def _block(self, name: str, number: int) -> list[Number]:
        return list(self.p[self.family.parameters.blocks[name, number]])

    def _vector(self, name: str, number: int) -> Point:
        """The vector (3,) that a block of parameters is."""
        if name == "origin":
            return ORIGIN
        if name == "normal":
            return 0.0, 0.0, float(number)
        if (name, number) not in self._known:
            block = self._block(name, number)
            vector = _reflected(block) if name == "direction" else block
            self._known[name, number] = vector if len(vector) == 3 else [*vector, 0.0]
        return self._known[name, number]

    def _value(self, variable: int) -> Any:
        """The value of a variable, by number: cosine and sine of an angle."""
        structure = self.structure
        is_turn = structure.mechanism.variables[variable].motion.is_turn
        share = structure.share(variable)
        if share is None:
            return self._locked(variable, is_turn)
        own = self.x[self.family.columns[share.column]]
        if not is_turn:
            return share.rate * own[0] + share.offset
        cosine, sine = self._cosine_and_sine(own)
        sine = share.rate * sine
        if share.offset == 0.0:
            return cosine, sine
        c, s = float(np.cos(share.offset)), float(np.sin(share.offset))
        return c * cosine - s * sine, s * cosine + c * sine

    def _cosine_and_sine(self, own: Any) -> tuple[Number, Number]:
        """Those of an angle x, from exp(i x) and exp(-i x)."""
        first, second = own
        (factor,) = self._block("of sines", 0)
        return 0.5 * (first + second), factor * (first - second)

    def _locked(self, variable: int, is_turn: bool) -> Any:
        block = self._block("locked", variable)
        if not is_turn:
            return block[0]
        c, s = block
        size = c * c + s * s
        return (c * c - s * s) / size, 2.0 * c * s / size

    # --- chains -----------------------------------------------------------------------

    def _moved(self, closure: Closure, point: Point, is_place: bool) -> Point:
        """Where the chain takes a point, or a direction, of its last body."""
        for step in reversed(closure.chain):
            point = self._moved_by(step, point, is_place)
        return point

    def _moved_by(self, step: Step, point: Point, is_place: bool) -> Point:
        structure = self.structure
        if step.pair in structure.point_pairs:
            return self._carried(step, point)
        if step.pair in structure.embedded:
            return self._turned_freely(step, point)
        for sign, number in reversed(self.family.moves_of(step)):
            motion = structure.mechanism.variables[number].motion
            value = self._value(number)
            direction = self._vector(*self.family.direction_of(motion))
            if not motion.is_turn:
                if is_place:
                    point = _plus(point, _times(sign * value, direction))
                continue
            cosine, sine = value
            center = ORIGIN
            if is_place:
                center = self._vector(*self.family.point_of(motion))
            offset = _less(point, center)
            along = (1.0 - cosine) * _dot(direction, offset)
            turned = _times(sign * sine, _cross(direction, offset))
            turned = _plus(turned, _times(cosine, offset))
            point = _plus(center, _plus(turned, _times(along, direction)))
        return point

    def _carried(self, step: Step, point: Point) -> Point:
        """A point moved by the pair of a free point."""
        if step.pair in self.family._standing_pairs:
            return point
        block = self._block("shift", step.pair)
        columns = self.structure.shifts[step.pair]
        for k, column in enumerate(columns):
            (distance,) = self.x[self.family.columns[column]]
            shift = _times(step.sign * distance, block[3 * k : 3 * k + 3])
            point = _plus(point, shift)
        return point

    def _turned_freely(self, step: Step, point: Point) -> Point:
        """A point turned by an embedded rotation, and moved by a free pair."""
        structure = self.structure
        place = self.family.place_of(structure.center(step.pair))
        center = self._vector(*place)
        columns = structure.embedded[step.pair]
        first = self.family.columns[columns[0]].start
        numbers = list(self.x[first : first + len(columns)])
        a, b, shift = numbers[:3], numbers[3:6], numbers[6:] or ORIGIN
        vectors = [a, b, _cross(a, b)]
        offset = _less(point, center)
        if step.sign < 0:
            offset = _less(offset, shift)
            return _plus(center, [_dot(vector, offset) for vector in vectors])
        turned = [_dot(row, offset) for row in zip(*vectors, strict=True)]
        return _plus(center, _plus(turned, shift))

    # --- closures ---------------------------------------------------------------------

    def _frame(self, closure: Closure) -> tuple[Point, Point, Point]:
        """Where a cycle takes two axes and the origin."""
        a = self._moved(closure, X_AXIS, is_place=False)
        b = self._moved(closure, Y_AXIS, is_place=False)
        place = ORIGIN
        if not self.family.placement.is_spherical:
            place = self._moved(closure, ORIGIN, is_place=True)
        return a, b, place

    def _square(self, number: int, closure: Closure) -> Number:
        """The square of the distance of two points less that of the length of a leg."""
        first = self._vector(*self.family.place_of(closure.first))
        second = self._vector(*self.family.place_of(closure.second))
        gap = _less(self._moved(closure, second, is_place=True), first)
        assert closure.rod is not None
        leg = closure.rod.leg
        if leg is None:
            return _dot(gap, gap)
        (length,) = self._block("leg", number)
        length = length + leg.sign * self._value(leg.variable)
        return _dot(gap, gap) - length * length

    def _arrival(self, closure: Closure) -> Point:
        """Where the point of a closure comes to."""
        second = self._vector(*self.family.place_of(closure.second))
        return self._moved(closure, second, is_place=True)

    def gaps(self, number: int, closure: Closure) -> list[Number]:
        """By how much a closure misses its target."""
        target = self._block("target", number)
        if closure.kind is ClosureKind.ROD:
            return [self._square(number, closure) - target[0]]
        if closure.kind is ClosureKind.POINT:
            arrival = self._arrival(closure)[: len(target)]
            return _less(arrival, target)
        a, b, place = self._frame(closure)
        if self.family.placement.is_planar:
            w, z, *shift = target
            first = _rotation([w, 0.0, 0.0, z])[0]
            return [*_less(a[:2], first[:2]), *_less(place[:2], shift)]
        first, second = _rotation(target[:4])
        gaps = [*_less(a, first), *_less(b, second)]
        return gaps + (_less(place, target[4:]) if len(target) > 4 else [])

    def reached(self, number: int, closure: Closure) -> list[Number]:
        """The target that a closure does not miss."""
        if closure.kind is ClosureKind.ROD:
            return [self._square(number, closure)]
        size = self.family.parameters.blocks["target", number]
        if closure.kind is ClosureKind.POINT:
            return list(self._arrival(closure))[: size.stop - size.start]
        a, b, place = self._frame(closure)
        turn = quaternion(a, b)
        if self.family.placement.is_planar:
            return [turn[0], turn[3], *place[:2]]
        is_spherical = self.family.placement.is_spherical
        return turn if is_spherical else [*turn, *place]

    def own_gaps(self) -> list[Number]:
        """By how much the coordinates are none of angles and rotations, and then the
        drivers are elsewhere."""
        gaps = []
        unknowns, places = self.structure.unknowns, self.family.columns
        for unknown, place in zip(unknowns, places, strict=True):
            if unknown.is_angle:
                first, second = self.x[place]
                gaps.append(first * second - 1.0)
        for columns in self.structure.embedded.values():
            first = self.family.columns[columns[0]].start
            numbers = list(self.x[first : first + ROTATION])
            a, b = numbers[:3], numbers[3:]
            gaps += [_dot(a, a) - 1.0, _dot(b, b) - 1.0, _dot(a, b)]
        if self.family.is_driven:
            (value,) = self._block(DRIVER, 0)
            gaps.append(self.family.driven(self.x, self.p) - value)
        return gaps


def _require_polynomials(structure: Structure) -> None:
    """Raises `ValueError`."""
    variables = structure.mechanism.variables
    for number, variable in enumerate(variables):
        if variable.motion.is_turn and variable.motion.advance != 0.0:
            raise ValueError("a joint advances as it turns")
        share = structure.share(number)
        if share is None:
            continue
        if variable.motion.is_turn != structure.unknowns[share.column].is_angle:
            raise ValueError("a turn follows a slide, or a slide a turn")
        if variable.motion.is_turn and abs(share.rate) != 1.0:
            raise ValueError("a turn is coupled with another ratio than 1 and -1")
