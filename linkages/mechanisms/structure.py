"""What is unknown in a mechanism, and which chains have to close.

Every cycle that passes a spherical joint is cut there, if that can be: a point comes
back to itself, three equations and no unknowns. A body between two spherical joints is
a rod: it keeps two points at a distance, and its own turning about the line between
them, which moves nothing else, is left out. A spherical joint that no cut removes is
embedded: two orthonormal vectors, six numbers under three equations, which have no
singular place and no double cover.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np
from networkx.utils import UnionFind

from linkages.closure.coupled import common_period
from linkages.loop import GeometryError
from linkages.mechanisms.couplings import Leader
from linkages.mechanisms.cycles import (
    Chain,
    Ends,
    Step,
    chain_between,
    cycle_basis,
)
from linkages.mechanisms.joint import Motion
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.placement import Placement
from linkages.mechanisms.rods import Rod, find_rods
from linkages.mechanisms.size import Size

__all__ = ["Closure", "ClosureKind", "FreePair", "Share", "Structure", "Unknown"]

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
    """An unknown: the number of its ``variable`` (-1 for a number of an embedded
    spherical joint), which others may follow, its period and its limits, in rad or in
    the structure's unit."""

    label: str
    variable: int
    period: float
    low: float
    high: float
    is_angle: bool


class Structure:
    """The unknowns and the closures of a ``mechanism``; raises `GeometryError` where
    nothing is left that could move.

    ``unit`` is the characteristic length, in which slides are counted.
    """

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        self.size = Size(mechanism)
        self.unit = self.size.characteristic_length
        if not self.unknowns:
            locked = "every one locked or rigid"
            if self.idle_bodies:
                idle = ", ".join(self.idle_bodies)
                locked += f" but for {idle}, whose turning about its own line is idle,"
            raise GeometryError("joints", locked, "such that one is left to move")

    # --- bodies and pairs -------------------------------------------------------------

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {body: number for number, body in enumerate(self.mechanism.bodies)}

    @cached_property
    def _ends(self) -> dict[int, Ends]:
        """The bodies and the number of unknowns of every pair."""
        variables = self.mechanism.variables
        ends = {}
        for number, pair in enumerate(self.mechanism.pairs):
            count = sum(variables[k].locked is None for k in pair.variables)
            if pair.center is not None:
                count = 3
            base, moved = self._numbers[pair.base], self._numbers[pair.moved]
            ends[number] = Ends(base, moved, count)
        return ends

    @cached_property
    def _spherical(self) -> list[int]:
        pairs = enumerate(self.mechanism.pairs)
        return [number for number, pair in pairs if pair.center is not None]

    @cached_property
    def rods(self) -> tuple[Rod, ...]:
        """The bodies that only two spherical joints hold."""
        return find_rods(self.mechanism, self._ends)

    # --- chains -----------------------------------------------------------------------

    @cached_property
    def _plain(self) -> dict[int, Ends]:
        """The pairs without spherical ones and those inside rods."""
        inner = {pair for rod in self.rods for pair in rod.inner}
        left_out = inner | set(self._spherical)
        return {k: ends for k, ends in self._ends.items() if k not in left_out}

    @cached_property
    def _kept_spherical(self) -> list[int]:
        """The spherical pairs that are not cut: they hold the bodies together."""
        parts = UnionFind(range(len(self.mechanism.bodies)))
        for ends in self._plain.values():
            parts.union(ends.base, ends.moved)
        in_rods = {pair for rod in self.rods for pair in rod.pairs}
        kept = []
        for number in self._spherical:
            base, moved, _ = self._ends[number]
            if number not in in_rods and parts[base] != parts[moved]:
                parts.union(base, moved)
                kept.append(number)
        return kept

    @cached_property
    def free_pairs(self) -> dict[int, FreePair]:
        """Pairs, numbered after those of the mechanism, between bodies that only rods
        join."""
        parts = UnionFind(range(len(self.mechanism.bodies)))
        for ends in self._plain.values():
            parts.union(ends.base, ends.moved)
        for number in self._kept_spherical:
            parts.union(*self._ends[number][:2])
        free: dict[int, FreePair] = {}
        for rod in self.rods:
            base, moved = rod.ends
            if parts[base] != parts[moved]:
                parts.union(base, moved)
                center = self.mechanism.pairs[rod.pairs[1]].center
                assert center is not None
                number = len(self.mechanism.pairs) + len(free)
                free[number] = FreePair(base, moved, center)
        return free

    @cached_property
    def closures(self) -> tuple[Closure, ...]:
        """The chains that have to close, as short as can be: cycles, then points, then
        rods."""
        bodies = len(self.mechanism.bodies)
        cycles = cycle_basis(bodies, self._plain)
        closures = [
            Closure(ClosureKind.CYCLE, chain, self._joints(chain)) for chain in cycles
        ]
        in_rods = {pair for rod in self.rods for pair in rod.pairs}
        for number in self._spherical:
            if number not in self._kept_spherical and number not in in_rods:
                closures.append(self._point_closure(number))
        closures += [self._rod_closure(rod) for rod in self.rods]
        return tuple(closures)

    @cached_property
    def tree_pairs(self) -> dict[int, Ends]:
        """The pairs that lead from body to body: all but the spherical ones that are
        cut, and the free ones."""
        kept = {number: self._ends[number] for number in self._kept_spherical}
        free = {
            number: Ends(pair.base, pair.moved, FREE)
            for number, pair in self.free_pairs.items()
        }
        return self._plain | kept | free

    @property
    def idle_bodies(self) -> tuple[str, ...]:
        """The bodies of rods, whose own turning about the line between the spherical
        joints is left out."""
        bodies = self.mechanism.bodies
        return tuple(bodies[number] for rod in self.rods for number in rod.bodies)

    def _point_closure(self, number: int) -> Closure:
        base, moved, _ = self._ends[number]
        chain = chain_between(len(self.mechanism.bodies), self.tree_pairs, base, moved)
        assert chain is not None
        pair = self.mechanism.pairs[number]
        assert pair.center is not None
        joints = (pair.joint, *self._joints(chain))
        return Closure(ClosureKind.POINT, chain, joints, pair.center, pair.center)

    def _rod_closure(self, rod: Rod) -> Closure:
        chain = chain_between(len(self.mechanism.bodies), self.tree_pairs, *rod.ends)
        assert chain is not None
        first, second = (self.mechanism.pairs[number] for number in rod.pairs)
        assert first.center is not None and second.center is not None
        inner = tuple(self.mechanism.pairs[number].joint for number in rod.inner)
        joints = (first.joint, *self._joints(chain), second.joint, *inner)
        return Closure(ClosureKind.ROD, chain, joints, first.center, second.center, rod)

    def _joints(self, chain: Chain) -> tuple[str, ...]:
        return tuple(
            self.mechanism.pairs[step.pair].joint
            for step in chain
            if step.pair not in self.free_pairs
        )

    def variables_of(self, pair: int) -> tuple[int, ...]:
        """The variables of a pair, by number; none for a free one."""
        if pair in self.free_pairs:
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
        if any(step.pair in self.embedded for step in closure.chain):
            return Placement(closure.first, np.eye(3), self.unit)
        motions = [m for step in closure.chain for m in self.motions(step)]
        return Placement.of_chain(motions, self.unit)

    # --- unknowns ---------------------------------------------------------------------

    @cached_property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The variables that are neither locked nor coupled to others, then the numbers
        of embedded joints."""
        unknowns = [self._unknown(number) for number in self._leading]
        for pair in self._kept_spherical:
            joint = self.mechanism.pairs[pair].joint
            unknowns += [_number_of(joint, part) for part in ROTATION]
        for free in self.free_pairs.values():
            body = self.mechanism.bodies[free.moved]
            unknowns += [_number_of(body, part) for part in (*ROTATION, *TRANSLATION)]
        return tuple(unknowns)

    @property
    def scales(self) -> np.ndarray:
        """What the unknowns (n,) are multiplied with to be in rad and in the user's
        unit."""
        is_slide = [not one.is_angle and one.variable >= 0 for one in self.unknowns]
        return np.where(is_slide, self.unit, 1.0)

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
        values: np.ndarray = shares * self._unit_of(variable)
        return values

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
        first = len(self._leading)
        embedded = {}
        for pair in (*self._kept_spherical, *self.free_pairs):
            count = len(ROTATION)
            if pair in self.free_pairs:
                count += len(TRANSLATION)
            embedded[pair] = tuple(range(first, first + count))
            first += count
        return embedded

    def center(self, pair: int) -> np.ndarray:
        """The point (3,) about which an embedded spherical pair or a free one turns."""
        if pair in self.free_pairs:
            return self.free_pairs[pair].center
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
        for follower, other in enumerate(self.mechanism.variables):
            if other.leader.number != number:
                continue
            ratios.append(other.leader.ratio)
            start, end = _range_of_leader(other.leader, self._range(follower))
            low, high = max(low, start), min(high, end)
            if not low < high:
                what = f"limits of {variable.label} and what is coupled to it"
                raise GeometryError(what, [low, high], "such that they overlap")
        if np.isfinite(high):
            low, high = low / unit, high / unit
            return Unknown(variable.label, number, np.inf, low, high, is_angle)
        period = common_period(ratios)
        if not np.isfinite(period):
            low, high = -TURNS_REACH, TURNS_REACH
        return Unknown(variable.label, number, period, low, high, is_angle)

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

    def _variables_around(self, closure: Closure) -> set[int]:
        """The variables, by number, of the joints round a loop."""
        numbers = {k for step in closure.chain for k in self.variables_of(step.pair)}
        if closure.rod is not None and closure.rod.leg is not None:
            numbers.add(closure.rod.leg.variable)
        return numbers

    def _reach(self, number: int) -> float:
        """How far a slide is looked at from the reference configuration: farther than
        the bodies of its shortest cycle reach."""
        lengths = self.size.body_lengths
        sums = []
        for closure in self.closures:
            if number in self._variables_around(closure):
                joints = [self.mechanism.joint(name) for name in closure.joints]
                bodies = {body for joint in joints for body in joint.bodies}
                sums.append(sum(lengths[body] for body in sorted(bodies)))
        total = min(sums, default=sum(lengths.values()))
        return SLIDE_REACH * (total or sum(lengths.values()))


def _range_of_leader(
    leader: Leader, limits: tuple[float, float]
) -> tuple[float, float]:
    """Between which values of its leader a variable is within its limits."""
    low, high = sorted(leader.value_of_leader(value) for value in limits)
    return low, high


def _number_of(name: str, part: str) -> Unknown:
    """An unknown that is a number of a rotation or a translation."""
    return Unknown(f"{name}.{part}", -1, np.inf, -np.inf, np.inf, False)
