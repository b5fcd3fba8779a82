"""Rods: bodies that two spherical joints hold, and nothing else.

Of a rod only its length matters to the rest of the mechanism. Bodies that rigid or
locked joints make one are one; a slide along the line between the spherical joints, as
the legs of platforms have, makes the rod longer.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from networkx.utils import UnionFind

from linkages.decisions import is_parallel_axis
from linkages.loop import GeometryError
from linkages.mechanisms.cycles import Ends
from linkages.mechanisms.displacements import displacement_of
from linkages.mechanisms.mechanism import Mechanism

__all__ = ["Leg", "Rod", "find_rods"]


class Leg(NamedTuple):
    """The slide that makes a rod longer: a variable, by number, and +1 or -1."""

    variable: int
    sign: int


@dataclass(frozen=True, eq=False)
class Rod:
    """Bodies that two spherical joints hold and nothing else: the ``pairs`` of these,
    by number, the bodies at the ``ends`` that they are joined to, the ``inner`` pairs,
    and the ``leg`` where the rod has a slide along the line between the joints.

    ``parts`` are the bodies that hold on to the first joint and to the second one; they
    are the same where there is no slide. ``length`` is the distance of the joints with
    all variables at 0, in the user's unit.
    """

    parts: tuple[tuple[int, ...], tuple[int, ...]]
    pairs: tuple[int, int]
    ends: tuple[int, int]
    inner: tuple[int, ...]
    length: float
    leg: Leg | None = None

    @property
    def bodies(self) -> tuple[int, ...]:
        """The bodies of the rod, by number."""
        return tuple(sorted({*self.parts[0], *self.parts[1]}))


class _Group(NamedTuple):
    """Bodies, by number, that rigid and locked pairs make one, these pairs, and the
    pairs that lead elsewhere."""

    bodies: tuple[int, ...]
    inner: tuple[int, ...]
    outer: tuple[int, ...]


def find_rods(mechanism: Mechanism, ends: dict[int, Ends]) -> tuple[Rod, ...]:
    """The rods of a mechanism whose pairs have these ``ends``.

    Raises `GeometryError` for a rod whose spherical joints are at one point.
    """
    groups = _groups(mechanism, ends)
    group_of = {body: group for group in groups for body in group.bodies}
    rods: list[Rod] = []
    taken: set[int] = set()
    for group in groups:
        chain = _chain_of(mechanism, ends, group, group_of)
        if chain is None:
            continue
        rod = _rod(mechanism, ends, chain)
        if rod is None or taken & set(rod.pairs) or rod.ends[0] == rod.ends[1]:
            continue
        taken |= set(rod.pairs)
        rods.append(rod)
    return tuple(rods)


def _groups(mechanism: Mechanism, ends: dict[int, Ends]) -> list[_Group]:
    parts = UnionFind(range(len(mechanism.bodies)))
    for number, (base, moved, unknowns) in ends.items():
        if unknowns == 0 and mechanism.pairs[number].center is None:
            parts.union(base, moved)
    members: dict[int, list[int]] = defaultdict(list)
    for body in range(len(mechanism.bodies)):
        members[parts[body]].append(body)
    groups = []
    for bodies in members.values():
        inside = set(bodies)
        touching = {k: set(one[:2]) & inside for k, one in ends.items()}
        inner = tuple(k for k, both in touching.items() if len(both) == 2)
        outer = tuple(k for k, both in touching.items() if len(both) == 1)
        groups.append(_Group(tuple(bodies), inner, outer))
    return groups


class _Chain(NamedTuple):
    """One group between two spherical pairs, or two with a slide between them."""

    first: _Group
    second: _Group
    pairs: tuple[int, int]
    slide: int | None


def _chain_of(
    mechanism: Mechanism,
    ends: dict[int, Ends],
    group: _Group,
    group_of: dict[int, _Group],
) -> _Chain | None:
    """What may be a rod that begins with a group; None where nothing does."""
    if len(group.outer) != 2:
        return None
    spherical = [k for k in group.outer if mechanism.pairs[k].center is not None]
    if len(spherical) == 2:
        return _Chain(group, group, (spherical[0], spherical[1]), None)
    if len(spherical) != 1:
        return None
    (slide,) = (k for k in group.outer if k != spherical[0])
    base, moved, unknowns = ends[slide]
    other = group_of[moved if base in group.bodies else base]
    if unknowns != 1 or len(other.outer) != 2:
        return None
    # the same leg is met once more from its other end
    if other.bodies < group.bodies:
        return None
    far = [k for k in other.outer if mechanism.pairs[k].center is not None]
    return _Chain(group, other, (spherical[0], far[0]), slide) if far else None


def _rod(mechanism: Mechanism, ends: dict[int, Ends], chain: _Chain) -> Rod | None:
    """The rod that a chain is; None where its slide has another direction."""
    first, second = (mechanism.pairs[k].center for k in chain.pairs)
    assert first is not None and second is not None
    inner = {*chain.first.inner, *chain.second.inner}
    leg = None
    along = second - first
    if chain.slide is None:
        along = _second_center(mechanism, ends, chain, second) - first
    else:
        inner.add(chain.slide)
        leg = _leg(mechanism, ends, chain, along)
        if leg is None:
            return None
    length = float(np.linalg.norm(along))
    if length == 0.0:
        names = " and ".join(mechanism.pairs[k].joint for k in chain.pairs)
        body = mechanism.bodies[chain.first.bodies[0]]
        raise GeometryError(
            f"joints {names} of body {body}", "at one point", "at two points"
        )
    outside = []
    for k, group in zip(chain.pairs, (chain.first, chain.second), strict=True):
        base, moved, _ = ends[k]
        outside.append(moved if base in group.bodies else base)
    return Rod(
        parts=(chain.first.bodies, chain.second.bodies),
        pairs=chain.pairs,
        ends=(outside[0], outside[1]),
        inner=tuple(sorted(inner)),
        length=length,
        leg=leg,
    )


def _leg(
    mechanism: Mechanism, ends: dict[int, Ends], chain: _Chain, along: np.ndarray
) -> Leg | None:
    """The slide of a leg; None where it is no slide along the leg, or where anything
    inside is locked elsewhere than at 0."""
    assert chain.slide is not None
    (number,) = mechanism.pairs[chain.slide].variables[:1] or (-1,)
    if number < 0 or len(mechanism.pairs[chain.slide].variables) != 1:
        return None
    for k in (*chain.first.inner, *chain.second.inner):
        locks = [mechanism.variables[v].locked for v in mechanism.pairs[k].variables]
        if any(lock != 0.0 for lock in locks):
            return None
    motion = mechanism.variables[number].motion
    size = float(np.linalg.norm(along))
    if motion.is_turn or size == 0.0:
        return None
    if not is_parallel_axis(
        float(np.linalg.norm(np.cross(along, motion.direction))), size
    ):
        return None
    sign = 1 if along @ motion.direction > 0 else -1
    if ends[chain.slide].moved in chain.first.bodies:
        sign = -sign
    return Leg(number, sign)


def _second_center(
    mechanism: Mechanism, ends: dict[int, Ends], chain: _Chain, center: np.ndarray
) -> np.ndarray:
    """Where the second joint (3,) of a rod is with respect to the body of the first
    one, with the pairs inside locked where they are."""
    bodies = set(chain.first.bodies)
    (start,) = bodies & set(ends[chain.pairs[0]][:2])
    (goal,) = bodies & set(ends[chain.pairs[1]][:2])
    poses = {start: np.eye(4)}
    while goal not in poses:
        for k in chain.first.inner:
            base, moved, _ = ends[k]
            step = displacement_of(mechanism, k)
            if base in poses and moved not in poses:
                poses[moved] = poses[base] @ step
            elif moved in poses and base not in poses:
                poses[base] = poses[moved] @ np.linalg.inv(step)
    place: np.ndarray = (poses[goal] @ np.append(center, 1.0))[:3]
    return place
