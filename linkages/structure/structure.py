"""What is unknown in a mechanism, and which chains have to close.

Every cycle that passes a spherical joint is cut there, if that can be: a point comes
back to itself, three equations and no unknowns. A body between two spherical joints is
a rod: it keeps two points at a distance, and its own turning about the line between
them, which moves nothing else, is left out. Where only rods meet there is a point,
three numbers. A spherical joint that no cut removes is embedded: two orthonormal
vectors, six numbers under three equations, which have no singular place and no double
cover.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np
from networkx.utils import UnionFind

from bifurc.torus import common_period
from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Mechanism, Variable
from linkages.mechanisms.size import Size
from linkages.structure.cycles import (
    Chain,
    Ends,
    Step,
    chain_between,
    cycle_basis,
)
from linkages.structure.flat_sheet import (
    FlatVertex,
    creases_that_stay_flat,
    flat_vertex,
    sign_of,
)
from linkages.structure.fold_modes import ways_by_modes
from linkages.structure.free_points import FreePoint, free_points
from linkages.structure.groups import SPHERICAL, Groups, JointPoint, find_idle_turn
from linkages.structure.hanging import Hanging
from linkages.structure.placement import Placement
from linkages.structure.rods import Rod, RodNet, find_rods
from linkages.values import GeometryError, require

SLIDE_REACH = 2.0  # limits of a slide, over the lengths of the bodies around its cycle
# limits, rad, of a turn that its coupling to others brings never back to where it was
TURNS_REACH = 10 * 2 * np.pi
FREE = 6  # freedoms of a free pair
# numbers of an embedded rotation, two orthonormal vectors, and of a translation
ROTATION = ("ax", "ay", "az", "bx", "by", "bz")
TRANSLATION = ("x", "y", "z")


class ClosureKind(Enum):
    """What a chain has to do to be closed."""

    # Come back to where it began.
    CYCLE = "cycle"
    # Bring a point back to itself.
    POINT = "point"
    # Bring a point to a distance from another one.
    ROD = "rod"


# how many equations each of them is, in space
CONSTRAINTS = {ClosureKind.CYCLE: 6, ClosureKind.POINT: 3, ClosureKind.ROD: 1}


@dataclass(frozen=True, eq=False)
class Closure:
    """A ``chain`` that has to close. The point ``second`` (3,) of its last body comes
    to the point ``first`` (3,) of its first one, or to its distance from it; a cycle
    has none. ``joints`` are the names of all joints round the loop."""

    kind: ClosureKind
    chain: Chain
    joints: tuple[str, ...]
    first: np.ndarray = field(default_factory=lambda: np.zeros(3))
    second: np.ndarray = field(default_factory=lambda: np.zeros(3))
    rod: Rod | None = None


class JoinedPair(NamedTuple):
    """Two bodies, by number, that spherical joints hold at a ``point``."""

    base: int
    moved: int
    point: JointPoint


class FreePair(NamedTuple):
    """Two bodies that no chain of joints but rods joins: ``moved`` is anywhere with
    respect to ``base``, as a rotation about ``center`` (3,) and a translation."""

    base: int
    moved: int
    center: np.ndarray


class Share(NamedTuple):
    """What an unknown makes of a variable: ``rate`` times the unknown of this
    ``column``, plus ``offset``, in rad and in the structure's unit."""

    column: int
    rate: float
    offset: float


@dataclass(frozen=True)
class Unknown:
    """An unknown: the number of its ``variable`` (-1 for a number of a body or a point
    that no joint places), which others may follow, its period and its limits, in rad or
    in the structure's unit. It is an angle, a length, or else an entry of a rotation
    matrix."""

    label: str
    variable: int = -1
    period: float = np.inf
    low: float = -np.inf
    high: float = np.inf
    is_angle: bool = False
    is_length: bool = False

    @property
    def unit(self) -> str:
        """What it is counted in: "rad", "size" or, of an entry of a matrix, nothing."""
        if self.is_angle:
            return "rad"
        return "size" if self.is_length else ""


class Structure:
    """The unknowns and the closures of a ``mechanism``, of which what is ``hanging`` is
    held, if it ``holds_flaps``, and so are creases that ``stay_flat``, by their labels,
    if it ``holds_flat_creases``: where all do, it ``is_held_flat``, and nothing else is
    held for that. Raises `GeometryError` where bodies do not hang together, and where
    nothing is left that could move.

    ``unit`` is the characteristic length, in which slides are counted.
    """

    def __init__(self, mechanism: Mechanism):
        _check_graph(mechanism)
        self.has_locks = bool(mechanism.locks)
        self.hanging = Hanging(mechanism)
        # where there are no loops, what hangs is all that there is
        self.holds_flaps = not mechanism.with_flaps and mechanism.independent_loops > 0
        self.mechanism = self.hanging.held if self.holds_flaps else mechanism
        self.size = Size(self.mechanism)
        self.unit = self.size.characteristic_length
        self.is_unscaled = False
        self.idle_turns: tuple[str, ...] = ()
        self.groups = Groups(self.mechanism, self.unit)
        # the turns that move nothing else are locked at 0, one after the other
        while (label := find_idle_turn(self.groups)) is not None:
            self.idle_turns += (label,)
            self.mechanism = self.mechanism.with_locks({label: 0.0})
            self.groups = Groups(self.mechanism, self.unit)
        self._hold_flat_creases()
        locked = "every one locked or rigid"
        if not self.unknowns and self.idle_bodies:
            idle = ", ".join(self.idle_bodies)
            locked += f" but for {idle}, whose turning about its own line is idle,"
        can_move = bool(self.unknowns)
        require(can_move, "joints", locked, "such that one is left to move")

    @property
    def held(self) -> frozenset[str]:
        """The labels of variables that are held without having been locked."""
        flaps = self.hanging.labels if self.holds_flaps else ()
        return self.creases_held_flat.union(flaps)

    @property
    def creases_held_flat(self) -> frozenset[str]:
        """Those of them that are creases of a sheet held in its flat state."""
        flat = () if self.is_held_flat else self.stay_flat
        return frozenset((*flat, *self.mechanism.at_rest))

    def _hold_flat_creases(self) -> None:
        """Lock the creases of a flat sheet that stay flat, unless all of them do, and
        those that are `at_rest`."""
        self.stay_flat: tuple[str, ...] = ()
        self.flat_vertices: list[FlatVertex] = []
        self.is_flat_all_over = False
        self.is_held_flat = False
        if not self.mechanism.creases or self.mechanism.with_flat_creases:
            return
        if self.mechanism.rounding:
            return  # rounded coordinates do not tell what lies along a line
        variables = self.mechanism.variables
        if any(one.locked for one in variables):
            return  # it is not flat
        as_given = copy(self)
        vertices = as_given._flat_vertices()
        self.is_flat_all_over = len(vertices) == len(as_given.closures)
        self.stay_flat = creases_that_stay_flat(variables, vertices)
        free = [one.label for one in variables if one.locked is None]
        self.is_held_flat = set(self.stay_flat) == set(free)
        held: set[str] = set()
        if not self.is_held_flat:
            held = {*self.stay_flat, *self.mechanism.at_rest}
            self.flat_vertices = _without(vertices, variables, held)
        if held:
            self.mechanism = self.mechanism.with_locks(dict.fromkeys(held, 0.0))
            self.groups = Groups(self.mechanism, self.unit)
        else:  # what is known of it as given holds
            vars(self).update({**vars(as_given), **vars(self)})

    @property
    def fold_signs(self) -> np.ndarray:
        """The signs (v,) of variables that their limits keep from 0 on, 0 of others."""
        return np.array([sign_of(one) for one in self.mechanism.variables])

    @cached_property
    def ways_by_modes(self) -> np.ndarray | None:
        """The fold angles (w, v) of all ways out of the flat state of a sheet, to leading
        order; None where its vertices do not have modes."""
        return ways_by_modes(self.flat_vertices, self.fold_signs)

    @property
    def ways_out(self) -> int | None:
        """How many ways of one freedom lead out of the flat state of a sheet, to leading
        order; None where that is not known, as where creases are locked or at rest, and
        where there are holes."""
        is_all_free = not (self.mechanism.at_rest or self.has_locks)
        if not (self.is_flat_all_over and is_all_free and self.are_about_flat_vertices):
            return None
        return None if self.ways_by_modes is None else len(self.ways_by_modes)

    @property
    def are_about_flat_vertices(self) -> bool:
        """Whether all variables that are left are creases about flat vertices."""
        about = {number for one in self.flat_vertices for number in one.variables}
        return about >= set(self.column_of)

    def _flat_vertices(self) -> list[FlatVertex]:
        """The inner vertices about which a sheet is flat."""
        vertices = []
        for closure in self.closures:
            if self.placement(closure).is_spherical:
                steps = [
                    (number, step.sign)
                    for step in closure.chain
                    for number in self.variables_of(step.pair)
                ]
                vertices.append(flat_vertex(self.mechanism.variables, steps))
        return [vertex for vertex in vertices if vertex is not None]

    # --- bodies and pairs -------------------------------------------------------------

    @property
    def points(self) -> tuple[JointPoint, ...]:
        """The points at which spherical joints hold bodies."""
        return self.groups.points

    @cached_property
    def _net(self) -> RodNet:
        return find_rods(self.groups)

    @property
    def rods(self) -> tuple[Rod, ...]:
        """The bodies that spherical joints hold at two points, and nothing else."""
        return self._net.rods

    @property
    def body_count(self) -> int:
        """How many bodies there are, points at which only rods meet among them: they
        are numbered after the others."""
        return len(self.mechanism.bodies) + len(self._net.free)

    @cached_property
    def free_points(self) -> tuple[FreePoint, ...]:
        """The points at which only rods meet."""
        return free_points(self.points, self._net)

    @cached_property
    def ends(self) -> dict[int, Ends]:
        """The bodies and the number of unknowns of every pair that is left without the
        rods, and of spherical ones between bodies that only rods would join else."""
        in_rods = {body for rod in self.rods for body in rod.bodies}
        inner = {pair for rod in self.rods for pair in rod.inner}
        ends = {
            number: one
            for number, one in self.groups.ends.items()
            if number not in inner and not in_rods & set(one[:2])
        }
        joined = {
            number: Ends(pair.base, pair.moved, SPHERICAL)
            for number, pair in self._joined_at_points.items()
        }
        return ends | joined

    @cached_property
    def _joined_at_points(self) -> dict[int, JoinedPair]:
        """Spherical pairs, numbered after those of the mechanism, between bodies that
        meet at a point where joints name rods between them."""
        in_rods = {body for rod in self.rods for body in rod.bodies}
        ends = self.groups.ends
        joined: dict[int, JoinedPair] = {}
        for point in self.points:
            bodies = [body for body in point.bodies if body not in in_rods]
            parts = UnionFind(bodies)
            for number in point.pairs:
                if not in_rods & set(ends[number][:2]):
                    parts.union(*ends[number][:2])
            for body in bodies[1:]:
                if parts[body] != parts[bodies[0]]:
                    parts.union(body, bodies[0])
                    number = len(self.mechanism.pairs) + len(joined)
                    joined[number] = JoinedPair(bodies[0], body, point)
        return joined

    @property
    def _spherical(self) -> list[int]:
        return [
            number
            for number in self.ends
            if number in self._joined_at_points
            or self.mechanism.pairs[number].center is not None
        ]

    # --- chains -----------------------------------------------------------------------

    @cached_property
    def _plain(self) -> dict[int, Ends]:
        """The pairs without spherical ones and those inside rods."""
        spherical = set(self._spherical)
        return {k: ends for k, ends in self.ends.items() if k not in spherical}

    @cached_property
    def _kept_spherical(self) -> list[int]:
        """The spherical pairs that are not cut: they hold the bodies together."""
        parts = self._joined(self._plain)
        kept = []
        for number in self._spherical:
            base, moved, _ = self.ends[number]
            if parts[base] != parts[moved]:
                parts.union(base, moved)
                kept.append(number)
        return kept

    def _joined(self, numbers: Iterable[int]) -> UnionFind:
        """The bodies as parts that the pairs of these numbers make one."""
        parts = UnionFind(range(self.body_count))
        for number in numbers:
            parts.union(*self.ends[number][:2])
        return parts

    @cached_property
    def point_pairs(self) -> dict[int, FreePoint]:
        """Pairs, numbered after those between bodies, that move the free points."""
        first = len(self.mechanism.pairs) + len(self._joined_at_points)
        return dict(enumerate(self.free_points, start=first))

    @cached_property
    def free_pairs(self) -> dict[int, FreePair]:
        """Pairs, numbered after those of points, between bodies that only rods join."""
        parts = self._joined([*self._plain, *self._kept_spherical])
        for point in self.free_points:
            parts.union(point.base, point.body)
        first = len(self.mechanism.pairs) + len(self._joined_at_points)
        first += len(self.free_points)
        free: dict[int, FreePair] = {}
        for rod in self.rods:
            base, moved = rod.ends
            if parts[base] == parts[moved]:
                continue
            parts.union(base, moved)
            # what moves is a body: a point at which only rods meet has no rotation
            is_point = moved >= len(self.mechanism.bodies)
            ends = (moved, base) if is_point else (base, moved)
            center = rod.centers[0 if is_point else 1]
            free[first + len(free)] = FreePair(*ends, center)
        return free

    @cached_property
    def closures(self) -> tuple[Closure, ...]:
        """The chains that have to close, as short as can be: cycles, then points, then
        rods."""
        cycles = cycle_basis(self.body_count, self._plain)
        chains = [self._begun_at_a_joint(cycle) for cycle in cycles]
        closures = [
            Closure(ClosureKind.CYCLE, chain, self._joints(chain)) for chain in chains
        ]
        for number in self._spherical:
            if number not in self._kept_spherical:
                chain = self._chain(*self.ends[number][:2])
                center = self.center(number)
                joints = (*self._joint_of(number), *self._joints(chain))
                closures.append(
                    Closure(ClosureKind.POINT, chain, joints, center, center)
                )
        for rod in self.rods:
            chain = self._chain(*rod.ends)
            inner = tuple(self.mechanism.pairs[number].joint for number in rod.inner)
            joints = (rod.joints[0], *self._joints(chain), rod.joints[1], *inner)
            first, second = rod.centers
            rod_closure = Closure(ClosureKind.ROD, chain, joints, first, second, rod)
            closures.append(rod_closure)
        return tuple(closures)

    def _begun_at_a_joint(self, cycle: Chain) -> Chain:
        """The cycle from the first of its steps across the joint at which it begins:
        steps across one axis of several bodies then follow each other."""
        joints = [self._joint_of(step.pair) for step in cycle]
        first = 0
        while joints[first - 1] == joints[0] and -first < len(cycle) - 1:
            first -= 1
        return cycle[first:] + cycle[:first] if first else cycle

    @cached_property
    def tree_pairs(self) -> dict[int, Ends]:
        """The pairs that lead from body to body: all but the spherical ones that are
        cut, those of points, and the free ones."""
        kept = {number: self.ends[number] for number in self._kept_spherical}
        points = {
            number: Ends(point.base, point.body, len(point.directions))
            for number, point in self.point_pairs.items()
        }
        free = {
            number: Ends(pair.base, pair.moved, FREE)
            for number, pair in self.free_pairs.items()
        }
        return self._plain | kept | points | free

    @property
    def idle_bodies(self) -> tuple[str, ...]:
        """The bodies whose own turning about the line between the two points at which
        spherical joints hold them is left out."""
        numbers = [number for rod in self.rods for number in rod.bodies]
        if any(len(point.directions) < 3 for point in self.free_points):
            numbers += self._net.remains
        return tuple(self.mechanism.bodies[number] for number in numbers)

    def _chain(self, start: int, goal: int) -> Chain:
        """The shortest chain between two bodies, by number."""
        chain = chain_between(self.body_count, self.tree_pairs, start, goal)
        assert chain is not None
        return chain

    def _joints(self, chain: Chain) -> tuple[str, ...]:
        return tuple(name for step in chain for name in self._joint_of(step.pair))

    def _joint_of(self, pair: int) -> tuple[str, ...]:
        """The names of the joints that a pair is of; none for one that no joint makes."""
        if pair in self._joined_at_points:
            return self._joined_at_points[pair].point.joints
        if pair in self.free_pairs or pair in self.point_pairs:
            return ()
        return (self.mechanism.pairs[pair].joint,)

    def variables_of(self, pair: int) -> tuple[int, ...]:
        """The variables of a pair, by number; none for one that no joint makes."""
        if pair >= len(self.mechanism.pairs):
            return ()
        return self.mechanism.pairs[pair].variables

    def motions(self, step: Step) -> list[Motion]:
        """The motions of a step, but for those locked at 0."""
        variables = [
            self.mechanism.variables[number] for number in self.variables_of(step.pair)
        ]
        return [one.motion for one in variables if one.locked != 0.0]

    def placement(self, closure: Closure) -> Placement:
        """The frame in which a closure is written; that of the file where the numbers
        of a rotation are unknowns."""
        if any(step.pair in self._columns for step in closure.chain):
            return Placement(closure.first, np.eye(3), self.unit)
        motions = [m for step in closure.chain for m in self.motions(step)]
        placement = Placement.of_chain(motions, self.unit)
        return replace(placement, origin=np.zeros(3)) if self.is_unscaled else placement

    @property
    def unscaled(self) -> Structure:
        """The same, written about the origin of the file in a unit that is a power of two,
        so that no coordinate of it is rounded."""
        other = copy(self)
        other.unit, other.is_unscaled = 2.0 ** round(np.log2(self.unit)), True
        return other

    # --- unknowns ---------------------------------------------------------------------

    @cached_property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The variables that are neither locked nor coupled to others, then the numbers
        of embedded joints, then those of points."""
        unknowns = [self._unknown(number) for number in self._leading]
        for pair in self._kept_spherical:
            joint = self._joint_of(pair)[0]
            unknowns += [Unknown(f"{joint}.{part}") for part in ROTATION]
        for free in self.free_pairs.values():
            body = self.mechanism.bodies[free.moved]
            unknowns += [Unknown(f"{body}.{part}") for part in ROTATION]
            unknowns += [Unknown(f"{body}.{x}", is_length=True) for x in TRANSLATION]
        for point in self.free_points:
            limits = (point.limits / self.unit).tolist()
            for part, (low, high) in zip(TRANSLATION, limits, strict=False):
                label = f"{point.name}.{part}"
                unknowns.append(Unknown(label, low=low, high=high, is_length=True))
        return _each_called_once(unknowns)

    @cached_property
    def _columns(self) -> dict[int, tuple[int, ...]]:
        """The numbers of the unknowns of every pair that has others than variables."""
        counts = dict.fromkeys(self._kept_spherical, len(ROTATION))
        counts |= dict.fromkeys(self.free_pairs, len(ROTATION) + len(TRANSLATION))
        counts |= {pair: len(one.directions) for pair, one in self.point_pairs.items()}
        first = len(self._leading)
        columns = {}
        for pair, count in counts.items():
            columns[pair] = tuple(range(first, first + count))
            first += count
        return columns

    @property
    def shifts(self) -> dict[int, tuple[int, ...]]:
        """The numbers of the unknowns of every pair of a point, one a direction."""
        return {pair: self._columns[pair] for pair in self.point_pairs}

    @property
    def scales(self) -> np.ndarray:
        """What the unknowns (n,) are multiplied with to be in rad and in the user's
        unit."""
        is_length = [unknown.is_length for unknown in self.unknowns]
        return np.where(is_length, self.unit, 1.0)

    @property
    def reference(self) -> np.ndarray:
        """The unknowns (n,) where all variables are 0 and all bodies in their places."""
        reference = np.zeros(len(self.unknowns))
        for columns in self.embedded.values():
            reference[list(columns[:6])] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        return reference

    @cached_property
    def column_of(self) -> dict[int, int]:
        """The number of the unknown that every free variable is or follows, by its
        number."""
        columns = {variable: column for column, variable in enumerate(self._leading)}
        return {
            number: columns[variable.leader.number]
            for number, variable in enumerate(self.mechanism.variables)
            if variable.locked is None
        }

    @cached_property
    def _leading(self) -> list[int]:
        """The variables, by number, that are neither locked nor coupled to others."""
        return [
            number
            for number, variable in enumerate(self.mechanism.variables)
            if variable.locked is None and variable.leader.number == number
        ]

    @cached_property
    def _followers(self) -> dict[int, list[int]]:
        """The variables that follow every leading one, itself among them, by number."""
        followers: defaultdict[int, list[int]] = defaultdict(list)
        for number, variable in enumerate(self.mechanism.variables):
            followers[variable.leader.number].append(number)
        return followers

    def share(self, variable: int) -> Share | None:
        """What an unknown makes of a variable, by number; None where it is locked."""
        column = self.column_of.get(variable)
        if column is None:
            return None
        leader = self.mechanism.variables[variable].leader
        unit = self._unit_of(variable)
        rate = leader.ratio * self._unit_of(leader.number) / unit
        return Share(column, rate, leader.offset / unit)

    def _unit_of(self, variable: int) -> float:
        """What a variable, by number, is counted in: rad or the structure's unit."""
        return 1.0 if self.mechanism.variables[variable].motion.is_turn else self.unit

    def values(self, points: np.ndarray, variable: int) -> np.ndarray:
        """The values (k,) of a variable, by number, at configurations (k, n): in rad
        and in the user's unit, the same everywhere where it is locked."""
        share = self.share(variable)
        if share is None:
            return np.full(len(points), self.mechanism.variables[variable].locked)
        shares = share.rate * points[:, share.column] + share.offset
        return shares * self._unit_of(variable)

    def largest_value(self, variable: int) -> float:
        """The largest absolute value that a variable, by number, takes within the
        limits, in rad and the structure's unit; infinite where it has none."""
        share = self.share(variable)
        if share is None:
            locked = self.mechanism.variables[variable].locked
            assert locked is not None
            return abs(locked) / self._unit_of(variable)
        unknown = self.unknowns[share.column]
        largest = max(abs(unknown.low), abs(unknown.high))
        return abs(share.rate) * largest + abs(share.offset)

    def limits(self, variable: int) -> tuple[float, float] | None:
        """The limits within which a variable, by number, is followed, in rad and the
        user's unit; None where it is locked or has none."""
        share = self.share(variable)
        if share is None or not np.isfinite(self.unknowns[share.column].high):
            return None
        unknown = self.unknowns[share.column]
        ends = np.array([[unknown.low], [unknown.high]])
        points = np.zeros((2, len(self.unknowns)))
        points[:, [share.column]] = ends
        low, high = sorted(self.values(points, variable).tolist())
        return low, high

    @cached_property
    def embedded(self) -> dict[int, tuple[int, ...]]:
        """The numbers of the unknowns of every embedded spherical pair, six, and of
        every free one, nine."""
        pairs = (*self._kept_spherical, *self.free_pairs)
        return {pair: self._columns[pair] for pair in pairs}

    def center(self, pair: int) -> np.ndarray:
        """The point (3,) about which an embedded spherical pair or a free one turns."""
        if pair in self.free_pairs:
            return self.free_pairs[pair].center
        if pair in self._joined_at_points:
            return self._joined_at_points[pair].point.center
        center = self.mechanism.pairs[pair].center
        assert center is not None
        return center

    def _unknown(self, number: int) -> Unknown:
        """The unknown that the variable of this number is, within the limits of all
        that follow it."""
        variable = self.mechanism.variables[number]
        is_angle = variable.motion.is_turn
        unit = self._unit_of(number)
        ratios = []
        low, high = -np.inf, np.inf
        for follower in self._followers[number]:
            other = self.mechanism.variables[follower]
            ratios.append(other.leader.ratio)
            ends = (other.leader.value_of_leader(end) for end in self._range(follower))
            start, end = sorted(ends)
            low, high = max(low, start), min(high, end)
            what = f"limits of {variable.label} and what is coupled to it"
            require(low < high, what, [low, high], "such that they overlap")
        if np.isfinite(high):
            low, high, period = low / unit, high / unit, np.inf
        else:
            period = common_period(ratios)
            if not np.isfinite(period):
                low, high = -TURNS_REACH, TURNS_REACH
        return Unknown(
            variable.label, number, period, low, high, is_angle, not is_angle
        )

    def _range(self, number: int) -> tuple[float, float]:
        """From where to where a variable is followed, in rad and the user's unit:
        infinite for a turn without advance and limits."""
        variable = self.mechanism.variables[number]
        motion = variable.motion
        if variable.limits is not None:
            return variable.limits
        if motion.is_turn and motion.advance == 0.0:
            return -np.inf, np.inf
        reach = self._reach(number)
        if motion.is_turn:
            reach /= abs(motion.advance)
        return -reach, reach

    def _reach(self, number: int) -> float:
        """How far a slide is looked at from the reference configuration: farther than
        the bodies of its shortest cycle reach."""
        lengths = self.size.body_lengths
        sums = []
        for closure in self.closures:
            around = {k for step in closure.chain for k in self.variables_of(step.pair)}
            if closure.rod is not None and closure.rod.leg is not None:
                around.add(closure.rod.leg.variable)
            if number in around:
                joints = [self.mechanism.joint(name) for name in closure.joints]
                bodies = {body for joint in joints for body in joint.bodies}
                sums.append(sum(lengths[body] for body in sorted(bodies)))
        total = min(sums, default=sum(lengths.values()))
        return SLIDE_REACH * (total or sum(lengths.values()))


def _without(
    vertices: Sequence[FlatVertex],
    variables: Sequence[Variable],
    labels: Collection[str],
) -> list[FlatVertex]:
    """What is left of vertices without the variables of these labels."""
    numbers = [number for number, one in enumerate(variables) if one.label in labels]
    return [vertex.without(numbers) for vertex in vertices]


def _check_graph(mechanism: Mechanism) -> None:
    """Bodies hang together."""
    parts = mechanism.parts
    if len(parts) > 1:
        frames = ", ".join(part.frame for part in parts)
        value = f"{len(parts)} mechanisms apart, of {frames},"
        allowed = "one of them: --part NUMBER, or `Mechanism.parts`"
        raise GeometryError(mechanism.name or "mechanism", value, allowed)


def _each_called_once(unknowns: Sequence[Unknown]) -> tuple[Unknown, ...]:
    """The unknowns, those that are called as one before them with a number behind: a
    coordinate of a body may be called as the variable of a joint."""
    labels: set[str] = set()
    once = []
    for unknown in unknowns:
        label = unknown.label
        number = 1
        while label in labels:
            number += 1
            label = f"{unknown.label} ({number})"
        labels.add(label)
        once.append(replace(unknown, label=label))
    return tuple(once)
