"""Groups: bodies that rigid and locked joints make one; and the points at which
spherical joints hold them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from networkx.utils import UnionFind

from linkages.decisions import meets_in_one_point
from linkages.mechanisms.joint import transforms
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.cycles import Ends

SPHERICAL = 3  # freedoms of a spherical pair


@dataclass(frozen=True)
class Group:
    """Bodies, by number, that the pairs ``inner`` make one; ``outer`` are the pairs
    other than spherical ones that lead elsewhere, ``points`` the numbers of the points
    at which spherical joints hold the group."""

    bodies: tuple[int, ...]
    inner: tuple[int, ...]
    outer: tuple[int, ...]
    points: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class JointPoint:
    """The ``center`` (3,) of one or more spherical pairs, by number, the ``joints``
    that they are of, and the ``bodies`` that meet there, by number."""

    center: np.ndarray
    pairs: tuple[int, ...]
    joints: tuple[str, ...]
    bodies: tuple[int, ...]

    def body_of(self, group: Group) -> int:
        """The first body of a group that is held here."""
        return min(set(self.bodies) & set(group.bodies))


class Groups:
    """The bodies of a ``mechanism`` as groups; lengths count in a ``unit``."""

    def __init__(self, mechanism: Mechanism, unit: float):
        self.mechanism = mechanism
        self.unit = unit

    @cached_property
    def ends(self) -> dict[int, Ends]:
        """The bodies and the number of unknowns of every pair."""
        mechanism = self.mechanism
        numbers = {body: number for number, body in enumerate(mechanism.bodies)}
        ends = {}
        for number, pair in enumerate(mechanism.pairs):
            free = [k for k in pair.variables if mechanism.variables[k].locked is None]
            count = len(free) if pair.center is None else SPHERICAL
            ends[number] = Ends(numbers[pair.base], numbers[pair.moved], count)
        return ends

    @cached_property
    def all(self) -> tuple[Group, ...]:
        """The groups."""
        parts = UnionFind(range(len(self.mechanism.bodies)))
        for base, moved, unknowns in self.plain.values():
            if unknowns == 0:
                parts.union(base, moved)
        return tuple(self._group(set(bodies)) for bodies in _sets(parts))

    def _group(self, inside: set[int]) -> Group:
        """The group of these bodies."""
        here = sorted({k for body in inside for k in self._plain_of.get(body, ())})
        touching = {k: set(self.plain[k][:2]) & inside for k in here}
        points = enumerate(self.points)
        return Group(
            bodies=tuple(sorted(inside)),
            inner=tuple(k for k, both in touching.items() if len(both) == 2),
            outer=tuple(k for k, both in touching.items() if len(both) == 1),
            points=tuple(k for k, point in points if inside & {*point.bodies}),
        )

    @property
    def of_body(self) -> dict[int, Group]:
        """The group of every body, by number."""
        return {body: group for group in self.all for body in group.bodies}

    @cached_property
    def _plain_of(self) -> dict[int, list[int]]:
        """The pairs of every body that are not spherical, by number."""
        pairs: defaultdict[int, list[int]] = defaultdict(list)
        for number, (base, moved, _) in self.plain.items():
            pairs[base].append(number)
            pairs[moved].append(number)
        return pairs

    @cached_property
    def plain(self) -> dict[int, Ends]:
        """The ends of the pairs that are not spherical."""
        pairs = self.mechanism.pairs
        return {k: one for k, one in self.ends.items() if pairs[k].center is None}

    @cached_property
    def points(self) -> tuple[JointPoint, ...]:
        """The points of spherical joints; joints of one body in one place have one
        point. Bodies that joints hold as they are given are one."""
        spherical = [k for k in self.ends if k not in self.plain]
        same = UnionFind(spherical)
        body_of = self._held_together()
        for first, second in combinations(spherical, 2):
            bodies = {body_of[body] for body in self.ends[first][:2]}
            if bodies & {body_of[body] for body in self.ends[second][:2]}:
                gap = self._center(first) - self._center(second)
                if meets_in_one_point(float(np.linalg.norm(gap)), self.unit):
                    same.union(first, second)
        return tuple(self._point(sorted(pairs)) for pairs in _sets(same))

    def _held_together(self) -> UnionFind:
        """The bodies, by number, as parts that rigid joints and locks at 0 make one."""
        mechanism = self.mechanism
        parts = UnionFind(range(len(mechanism.bodies)))
        for number, (base, moved, unknowns) in self.ends.items():
            variables = mechanism.pairs[number].variables
            is_turned = any(mechanism.variables[k].locked for k in variables)
            if unknowns == 0 and not is_turned:
                parts.union(base, moved)
        return parts

    def _point(self, pairs: list[int]) -> JointPoint:
        joints = dict.fromkeys(self.mechanism.pairs[k].joint for k in pairs)
        bodies = {body for k in pairs for body in self.ends[k][:2]}
        center = self._center(pairs[0])
        return JointPoint(center, tuple(pairs), tuple(joints), tuple(sorted(bodies)))

    def _center(self, pair: int) -> np.ndarray:
        center = self.mechanism.pairs[pair].center
        assert center is not None
        return center

    def poses_inside(
        self, start: int, pairs: Iterable[int], slide: int = -1
    ) -> dict[int, np.ndarray]:
        """The displacements (4, 4) of the bodies that ``pairs`` join, by number, with
        respect to the body ``start``; the variable ``slide`` is at 0."""
        poses = {start: np.eye(4)}
        pending = list(pairs)
        while pending:
            number = pending.pop(0)
            base, moved, _ = self.ends[number]
            is_slide = slide in self.mechanism.pairs[number].variables
            step = np.eye(4) if is_slide else displacement_of(self.mechanism, number)
            if base in poses:
                poses.setdefault(moved, poses[base] @ step)
            elif moved in poses:
                poses[base] = poses[moved] @ np.linalg.inv(step)
            else:
                pending.append(number)
        return poses


def _sets(parts: UnionFind) -> list[list[int]]:
    """The members of every part, in the order of the first ones."""
    members: dict[int, list[int]] = defaultdict(list)
    for one in parts:
        members[parts[one]].append(one)
    return list(members.values())


def find_idle_turn(groups: Groups) -> str | None:
    """The label of a variable that moves nothing but a body or a chain of bodies about
    its own line; None where there is none.

    A body that hangs on its neighbour by a turn and a spherical joint on the axis of it
    is a door, and no idle one.
    """
    mechanism, ends = groups.mechanism, groups.ends
    for group in groups.all:
        if len(group.outer) != 1 or len(group.points) != 1:
            continue
        (pair,) = group.outer
        is_moved = ends[pair].moved in group.bodies
        neighbour = groups.of_body[ends[pair].base if is_moved else ends[pair].moved]
        is_door = group.points[0] in neighbour.points
        # with a lock elsewhere than at 0 inside, the spherical joint is not where it
        # was given
        inside = [v for k in group.inner for v in mechanism.pairs[k].variables]
        if is_door or any(mechanism.variables[v].locked != 0.0 for v in inside):
            continue
        center = groups.points[group.points[0]].center
        for number in _turns_beside(mechanism, pair, is_moved):
            motion = mechanism.variables[number].motion
            arm = np.cross(center - motion.point, motion.direction)
            if meets_in_one_point(float(np.linalg.norm(arm)), groups.unit):
                return mechanism.variables[number].label
    return None


def _turns_beside(mechanism: Mechanism, pair: int, is_moved: bool) -> list[int]:
    """The free turns of a pair, by number, whose axes stand still in its moved body or
    else in its base: one may lock each at 0."""
    numbers = list(mechanism.pairs[pair].variables)
    variables = [mechanism.variables[number] for number in numbers]
    is_one_line = all(
        not np.any(np.cross(one.motion.direction, variables[0].motion.direction))
        for one in variables
    )
    if not is_one_line:
        numbers = numbers[-1:] if is_moved else numbers[:1]
    followed = {
        one.leader.number
        for follower, one in enumerate(mechanism.variables)
        if one.leader.number != follower
    }
    turns = []
    for number in numbers:
        variable = mechanism.variables[number]
        low, high = variable.limits or (-np.inf, np.inf)
        is_alone = variable.leader.number == number and number not in followed
        is_free = variable.locked is None and is_alone and low <= 0.0 <= high
        if is_free and variable.motion.is_turn and variable.motion.advance == 0.0:
            turns.append(number)
    return turns


def displacement_of(mechanism: Mechanism, pair: int) -> np.ndarray:
    """The displacement (4, 4) of the moved body of a pair whose variables are all
    locked."""
    result = np.eye(4)
    for number in mechanism.pairs[pair].variables:
        variable = mechanism.variables[number]
        assert variable.locked is not None
        result = result @ transforms(variable.motion, np.array([variable.locked]))[0]
    return result
