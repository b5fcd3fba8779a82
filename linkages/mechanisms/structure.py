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

import networkx as nx
import numpy as np

from linkages.loop import GeometryError
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
from linkages.mechanisms.size import Size

__all__ = ["Closure", "ClosureKind", "Rod", "Structure", "Unknown"]

SLIDE_REACH = 2.0  # limits of a slide, over the lengths of the bodies around its cycle
EMBEDDED = ("ax", "ay", "az", "bx", "by", "bz")


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


@dataclass(frozen=True)
class Rod:
    """A body that two spherical joints hold, pairs of these numbers, and the bodies,
    by number, at its ends."""

    body: str
    pairs: tuple[int, int]
    ends: tuple[int, int]


@dataclass(frozen=True)
class Unknown:
    """An unknown: the number of its ``variable`` (-1 for a number of an embedded
    spherical joint), its period and its limits, in rad or in the structure's unit."""

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
        """The bodies that are held by two spherical joints and nothing else."""
        rods: list[Rod] = []
        taken: set[int] = set()
        for body, number in self._numbers.items():
            pairs = [k for k, ends in self._ends.items() if number in ends[:2]]
            if len(pairs) != 2 or not set(pairs) <= set(self._spherical):
                continue
            others = [self._other(pair, number) for pair in pairs]
            if taken & set(pairs) or others[0] == others[1]:
                continue
            taken |= set(pairs)
            rods.append(Rod(body, (pairs[0], pairs[1]), (others[0], others[1])))
        return tuple(rods)

    def _other(self, pair: int, body: int) -> int:
        base, moved, _ = self._ends[pair]
        return moved if base == body else base

    # --- chains -----------------------------------------------------------------------

    @cached_property
    def _plain(self) -> dict[int, Ends]:
        """The pairs without spherical ones."""
        return {k: ends for k, ends in self._ends.items() if k not in self._spherical}

    @cached_property
    def _kept_spherical(self) -> list[int]:
        """The spherical pairs that are not cut: they hold the bodies together."""
        graph = nx.utils.UnionFind(range(len(self.mechanism.bodies)))
        for ends in self._plain.values():
            graph.union(ends.base, ends.moved)
        in_rods = {pair for rod in self.rods for pair in rod.pairs}
        kept = []
        for number in self._spherical:
            ends = self._ends[number]
            if number in in_rods or graph[ends.base] == graph[ends.moved]:
                continue
            graph.union(ends.base, ends.moved)
            kept.append(number)
        # parts that only rods hold together are reached through one end of a rod
        for rod in self.rods:
            if graph[rod.ends[0]] != graph[rod.ends[1]]:
                for number in rod.pairs:
                    graph.union(*self._ends[number][:2])
                    kept.append(number)
        return kept

    @cached_property
    def closures(self) -> tuple[Closure, ...]:
        """The chains that have to close, as short as can be: cycles, then points, then
        rods."""
        kept = set(self._kept_spherical)
        free_rods = [rod for rod in self.rods if not kept & set(rod.pairs)]
        in_rods = {pair for rod in free_rods for pair in rod.pairs}
        bodies = len(self.mechanism.bodies)
        cycles = cycle_basis(bodies, self._plain)
        closures = [
            Closure(ClosureKind.CYCLE, chain, self._joints(chain)) for chain in cycles
        ]
        tree = self.tree_pairs
        for number in self._spherical:
            if number not in kept and number not in in_rods:
                closures.append(self._point_closure(tree, number))
        closures += [self._rod_closure(tree, rod) for rod in free_rods]
        return tuple(closures)

    @cached_property
    def tree_pairs(self) -> dict[int, Ends]:
        """The pairs that lead from body to body: all but the spherical ones that are
        cut."""
        return self._plain | {k: self._ends[k] for k in self._kept_spherical}

    @property
    def idle_bodies(self) -> tuple[str, ...]:
        """The rods whose own turning about the line between their ends is left out."""
        kept = set(self._kept_spherical)
        return tuple(rod.body for rod in self.rods if not kept & set(rod.pairs))

    def _point_closure(self, tree: dict[int, Ends], number: int) -> Closure:
        base, moved, _ = self._ends[number]
        chain = chain_between(len(self.mechanism.bodies), tree, base, moved)
        assert chain is not None
        pair = self.mechanism.pairs[number]
        assert pair.center is not None
        joints = (pair.joint, *self._joints(chain))
        return Closure(ClosureKind.POINT, chain, joints, pair.center, pair.center)

    def _rod_closure(self, tree: dict[int, Ends], rod: Rod) -> Closure:
        chain = chain_between(len(self.mechanism.bodies), tree, *rod.ends)
        assert chain is not None
        first, second = (self.mechanism.pairs[number] for number in rod.pairs)
        assert first.center is not None and second.center is not None
        joints = (first.joint, *self._joints(chain), second.joint)
        if not np.any(first.center != second.center):
            what = f"joints {first.joint} and {second.joint} of body {rod.body}"
            raise GeometryError(what, "at one point", "at two points")
        return Closure(ClosureKind.ROD, chain, joints, first.center, second.center)

    def _joints(self, chain: Chain) -> tuple[str, ...]:
        return tuple(self.mechanism.pairs[step.pair].joint for step in chain)

    def motions(self, step: Step) -> list[Motion]:
        """The motions of a step, but for those locked at 0."""
        variables = [
            self.mechanism.variables[number]
            for number in self.mechanism.pairs[step.pair].variables
        ]
        return [one.motion for one in variables if one.locked != 0.0]

    def placement(self, closure: Closure) -> Placement:
        """The frame in which a closure is written."""
        motions = [m for step in closure.chain for m in self.motions(step)]
        return Placement.of_chain(motions, self.unit)

    # --- unknowns ---------------------------------------------------------------------

    @cached_property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The variables that are not locked, then the numbers of embedded joints."""
        unknowns = []
        for number, variable in enumerate(self.mechanism.variables):
            if variable.locked is None:
                unknowns.append(self._unknown(number))
        for pair in self._kept_spherical:
            joint = self.mechanism.pairs[pair].joint
            for part in EMBEDDED:
                label = f"{joint}.{part}"
                unknowns.append(Unknown(label, -1, np.inf, -np.inf, np.inf, False))
        return tuple(unknowns)

    @property
    def scales(self) -> np.ndarray:
        """What the unknowns (n,) are multiplied with to be in rad and in the user's
        unit."""
        is_slide = [not one.is_angle and one.variable >= 0 for one in self.unknowns]
        return np.where(is_slide, self.unit, 1.0)

    @cached_property
    def column_of(self) -> dict[int, int]:
        """The number of the unknown that every free variable is, by its number."""
        numbers = [one.variable for one in self.unknowns if one.variable >= 0]
        return {variable: column for column, variable in enumerate(numbers)}

    def values(self, points: np.ndarray, variable: int) -> np.ndarray:
        """The values (k,) of a variable, by number, at configurations (k, n): in rad
        and in the user's unit, the same everywhere where it is locked."""
        column = self.column_of.get(variable)
        if column is None:
            return np.full(len(points), self.mechanism.variables[variable].locked)
        is_turn = self.mechanism.variables[variable].motion.is_turn
        values: np.ndarray = points[:, column] * (1.0 if is_turn else self.unit)
        return values

    @cached_property
    def embedded(self) -> dict[int, tuple[int, ...]]:
        """The numbers of the six unknowns of every embedded spherical pair."""
        first = len(self.column_of)
        embedded = {}
        for pair in self._kept_spherical:
            embedded[pair] = tuple(range(first, first + 6))
            first += 6
        return embedded

    def _unknown(self, number: int) -> Unknown:
        variable = self.mechanism.variables[number]
        motion = variable.motion
        unit = 1.0 if motion.is_turn else self.unit
        is_periodic = motion.is_turn and motion.advance == 0.0
        if variable.limits is not None:
            low, high = (value / unit for value in variable.limits)
            return Unknown(variable.label, number, np.inf, low, high, motion.is_turn)
        if is_periodic:
            return Unknown(variable.label, number, 2 * np.pi, -np.inf, np.inf, True)
        limit = self._reach(number) / self.unit
        if motion.is_turn:
            limit /= abs(motion.advance) / self.unit
        return Unknown(variable.label, number, np.inf, -limit, limit, motion.is_turn)

    def _reach(self, number: int) -> float:
        """How far a slide is looked at from the reference configuration: farther than
        the bodies of its shortest cycle reach."""
        lengths = self.size.body_lengths
        sums = []
        for closure in self.closures:
            numbers = [
                k
                for step in closure.chain
                for k in self.mechanism.pairs[step.pair].variables
            ]
            if number in numbers:
                bodies = {
                    body
                    for step in closure.chain
                    for body in self.mechanism.pairs[step.pair][1:3]
                }
                sums.append(sum(lengths[body] for body in sorted(bodies)))
        total = min(sums, default=sum(lengths.values()))
        return SLIDE_REACH * (total or sum(lengths.values()))
