"""Groups: bodies that rigid and locked joints make one; and the points at which
spherical joints hold them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from networkx.utils import UnionFind

from linkages.decisions import meets_in_one_point
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.cycles import Ends


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


def find_groups(
    mechanism: Mechanism, ends: dict[int, Ends], points: tuple[JointPoint, ...]
) -> tuple[Group, ...]:
    """The groups of a mechanism whose pairs have these ``ends``."""
    parts = UnionFind(range(len(mechanism.bodies)))
    plain = {k: one for k, one in ends.items() if mechanism.pairs[k].center is None}
    for base, moved, unknowns in plain.values():
        if unknowns == 0:
            parts.union(base, moved)
    members: dict[int, list[int]] = defaultdict(list)
    for body in range(len(mechanism.bodies)):
        members[parts[body]].append(body)
    groups = []
    for bodies in members.values():
        inside = set(bodies)
        touching = {k: set(one[:2]) & inside for k, one in plain.items()}
        groups.append(
            Group(
                bodies=tuple(bodies),
                inner=tuple(k for k, both in touching.items() if len(both) == 2),
                outer=tuple(k for k, both in touching.items() if len(both) == 1),
                points=tuple(k for k, p in enumerate(points) if inside & {*p.bodies}),
            )
        )
    return tuple(groups)


def find_points(
    mechanism: Mechanism, ends: dict[int, Ends], unit: float
) -> tuple[JointPoint, ...]:
    """The points of the spherical joints of a mechanism whose pairs have these
    ``ends``; joints of one body in one place, for lengths in this ``unit``, have one
    point. Bodies that joints hold as they are given are one."""
    spherical = [k for k in ends if mechanism.pairs[k].center is not None]
    same = UnionFind(spherical)
    body_of = _held_together(mechanism, ends)
    for first, second in combinations(spherical, 2):
        bodies = {body_of[body] for body in ends[first][:2]}
        if bodies & {body_of[body] for body in ends[second][:2]}:
            gap = _center(mechanism, first) - _center(mechanism, second)
            if meets_in_one_point(float(np.linalg.norm(gap)), unit):
                same.union(first, second)
    members: dict[int, list[int]] = defaultdict(list)
    for number in spherical:
        members[same[number]].append(number)
    return tuple(_point(mechanism, ends, pairs) for pairs in members.values())


def _held_together(mechanism: Mechanism, ends: dict[int, Ends]) -> UnionFind:
    """The bodies, by number, as parts that rigid joints and locks at 0 make one."""
    parts = UnionFind(range(len(mechanism.bodies)))
    for number, (base, moved, unknowns) in ends.items():
        locks = [
            mechanism.variables[v].locked for v in mechanism.pairs[number].variables
        ]
        if unknowns == 0 and not any(locks):
            parts.union(base, moved)
    return parts


def _point(mechanism: Mechanism, ends: dict[int, Ends], pairs: list[int]) -> JointPoint:
    joints = dict.fromkeys(mechanism.pairs[k].joint for k in pairs)
    bodies = {body for k in pairs for body in ends[k][:2]}
    return JointPoint(
        _center(mechanism, pairs[0]), tuple(pairs), tuple(joints), tuple(sorted(bodies))
    )


def _center(mechanism: Mechanism, pair: int) -> np.ndarray:
    center = mechanism.pairs[pair].center
    assert center is not None
    return center
