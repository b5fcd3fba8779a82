"""Rods: bodies that spherical joints hold at two points, and nothing else.

Of a rod only its length matters to the rest of the mechanism. Bodies that rigid or
locked joints make one are one; a slide along the line between the points, as the legs
of platforms have, makes the rod longer. A point at which only rods meet is a point
without a body. Where all bodies are rods, one of them remains a body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from linkages.decisions import is_parallel_axis
from linkages.structure.groups import Group, Groups
from linkages.values import require


class Leg(NamedTuple):
    """The slide that makes a rod longer: a variable, by number, and +1 or -1."""

    variable: int
    sign: int


@dataclass(frozen=True, eq=False)
class Rod:
    """Bodies that spherical joints hold at two ``points``, by number, and nothing else:
    the bodies at the ``ends`` that they are joined to, the ``inner`` pairs, and the
    ``leg`` where the rod has a slide along the line between the points.

    ``parts`` are the bodies that hold on to the first point and to the second one; they
    are the same where there is no slide. ``centers`` (2, 3) are the points, ``length``
    is their distance with all variables at 0, in the user's unit, ``joints`` are the
    names of the joints there.
    """

    parts: tuple[tuple[int, ...], tuple[int, ...]]
    points: tuple[int, int]
    ends: tuple[int, int]
    centers: np.ndarray
    joints: tuple[str, str]
    inner: tuple[int, ...]
    length: float
    leg: Leg | None = None

    @property
    def bodies(self) -> tuple[int, ...]:
        """The bodies of the rod, by number."""
        return tuple(sorted({*self.parts[0], *self.parts[1]}))


class RodNet(NamedTuple):
    """The ``rods`` of a mechanism; the ``free`` points, by number, at which only rods
    meet, each with the number of the body that it is; and the bodies of the rod that
    ``remains`` a body because all bodies are rods, none elsewhere."""

    rods: tuple[Rod, ...]
    free: dict[int, int]
    remains: tuple[int, ...]


class _Chain(NamedTuple):
    """What may be a rod: one group between two points, or two with a slide between
    them."""

    first: Group
    second: Group
    points: tuple[int, int]
    slide: int | None = None
    leg: Leg | None = None

    @property
    def groups(self) -> tuple[Group, ...]:
        return (self.first,) if self.slide is None else (self.first, self.second)

    @property
    def bodies(self) -> tuple[int, ...]:
        return tuple(sorted({*self.first.bodies, *self.second.bodies}))


def find_rods(groups: Groups) -> RodNet:
    """The rods of a mechanism.

    Raises `GeometryError` for a body that spherical joints hold at one point only.
    """
    for group in groups.all:
        _check_held(groups, group)
    begun = [_chain_of(groups, group) for group in groups.all]
    chains, remains = _with_a_body(groups, [one for one in begun if one is not None])
    in_rods = {body for chain in chains for body in chain.bodies}
    free: dict[int, int] = {}
    held: dict[int, int] = {}
    for number, point in enumerate(groups.points):
        bodies = [body for body in point.bodies if body not in in_rods]
        if bodies:
            held[number] = bodies[0]
        else:
            free[number] = len(groups.mechanism.bodies) + len(free)
    body_at = held | free
    rods = [_rod(groups, chain, body_at) for chain in chains]
    return RodNet(tuple(rods), free, remains)


def _check_held(groups: Groups, group: Group) -> None:
    """Raises `GeometryError` for a group that hangs in one point by several joints."""
    if group.outer or len(group.points) != 1:
        return
    joints = groups.points[group.points[0]].joints
    body = groups.mechanism.bodies[group.bodies[0]]
    what = f"joints {' and '.join(joints)} of body {body}"
    require(len(joints) < 2, what, "at one point", "at two points")


def _with_a_body(
    groups: Groups, chains: list[_Chain]
) -> tuple[list[_Chain], tuple[int, ...]]:
    """The chains that are rods, so that a body remains and something can move; and the
    bodies of the chain that remains a body."""
    in_chains = {group for chain in chains for group in chain.groups}
    if len(in_chains) < len(groups.all):
        return chains, ()
    mechanism = groups.mechanism
    frame = mechanism.bodies.index(mechanism.frame)
    rigid = [chain for chain in chains if chain.slide is None] or chains
    remaining = next((c for c in rigid if frame in c.bodies), rigid[0])
    others = [chain for chain in chains if chain is not remaining]
    is_free = any(groups.ends[k].unknowns for k in groups.plain)
    if len({point for chain in chains for point in chain.points}) == 2 and not is_free:
        # nothing but bodies between the same two points: they turn about their line
        return [], ()
    return others, remaining.bodies


def _chain_of(groups: Groups, group: Group) -> _Chain | None:
    """The rod that begins with a group; None where none does."""
    if _has_free_joint(groups, group):
        return None
    if not group.outer and len(group.points) == 2:
        first, second = group.points
        return _Chain(group, group, (first, second))
    if len(group.outer) != 1 or len(group.points) != 1:
        return None
    (slide,) = group.outer
    base, moved, unknowns = groups.ends[slide]
    other = groups.of_body[moved if base in group.bodies else base]
    if unknowns != 1 or len(other.outer) != 1 or len(other.points) != 1:
        return None
    # the same leg is met once more from its other end
    if other.bodies < group.bodies or other.points == group.points:
        return None
    if _has_free_joint(groups, other):
        return None
    chain = _Chain(group, other, (group.points[0], other.points[0]), slide)
    leg = _leg(groups, chain)
    return None if leg is None else chain._replace(leg=leg)


def _has_free_joint(groups: Groups, group: Group) -> bool:
    """Whether a joint inside a group is held by rigid ones beside it alone: it closes a
    loop, which a rod would leave out."""
    return any(groups.ends[k].unknowns for k in group.inner)


def _leg(groups: Groups, chain: _Chain) -> Leg | None:
    """The slide of a leg; None where it is no slide along the leg, or where anything
    inside is locked elsewhere than at 0."""
    assert chain.slide is not None
    mechanism, points = groups.mechanism, groups.points
    variables = mechanism.variables
    numbers = mechanism.pairs[chain.slide].variables
    inside = [v for k in _inner(chain) for v in mechanism.pairs[k].variables]
    free = [number for number in numbers if variables[number].locked is None]
    if len(free) != 1:
        return None
    if any(variables[v].locked != 0.0 for v in inside if v != free[0]):
        return None
    motion = variables[free[0]].motion
    along = points[chain.points[1]].center - points[chain.points[0]].center
    size = float(np.linalg.norm(along))
    if motion.is_turn or size == 0.0:
        return None
    sine = float(np.linalg.norm(np.cross(along, motion.direction)))
    if not is_parallel_axis(sine, size):
        return None
    sign = 1 if along @ motion.direction > 0 else -1
    if groups.ends[chain.slide].moved in chain.first.bodies:
        sign = -sign
    return Leg(free[0], sign)


def _inner(chain: _Chain) -> tuple[int, ...]:
    """The pairs inside a chain, its slide among them."""
    inner = {*chain.first.inner, *chain.second.inner}
    if chain.slide is not None:
        inner.add(chain.slide)
    return tuple(sorted(inner))


def _rod(groups: Groups, chain: _Chain, body_at: dict[int, int]) -> Rod:
    first, second = (groups.points[number] for number in chain.points)
    far = second.center
    if chain.slide is None:
        # with the pairs inside locked where they are
        start, goal = first.body_of(chain.first), second.body_of(chain.first)
        pose = groups.poses_inside(start, chain.first.inner)[goal]
        far = (pose @ np.append(second.center, 1.0))[:3]
    return Rod(
        parts=(chain.first.bodies, chain.second.bodies),
        points=chain.points,
        ends=(body_at[chain.points[0]], body_at[chain.points[1]]),
        centers=np.array([first.center, second.center]),
        joints=(first.joints[0], second.joints[0]),
        inner=_inner(chain),
        length=float(np.linalg.norm(far - first.center)),
        leg=chain.leg,
    )
