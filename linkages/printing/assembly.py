"""A linkage of rods and hinges as straight segments with radii: what is compared to
see whether parts meet, and what solids are made of.

A hinge may sit anywhere along its axis. A link leaves each of its two axes at a right
angle, until it is beside the hinge, and goes straight in between. Every part is then a
union of capsules (a segment and all that is within a radius of it), and distances of
parts are distances of segments, less the radii.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np

from linkages.links.distances import distances_by_ends
from linkages.loop import Loop
from linkages.printing.dimensions import Dimensions

RODS = 3  # of a link: an arm, the rod in between, an arm
FIRST_ARM, LAST_ARM = 0, RODS - 1
PARALLEL = 1e-9  # of a length: what is less has no direction


class Kind(Enum):
    """What a part is."""

    LINK = "link"
    HINGE = "hinge"


class Part(NamedTuple):
    """A link by the joint (from 0) that it follows, or the hinge of a joint."""

    kind: Kind
    joint: int


@dataclass(frozen=True, eq=False)
class Seats:
    """Where the hinges sit: ``heights`` (..., n) of the middles, along their axes from
    the foot of the common normal before them, in the unit of the loop; ``sides``
    (..., n), 1 where the link behind a joint is farther along the axis than the link
    before it, and else -1."""

    heights: np.ndarray
    sides: np.ndarray

    def __getitem__(self, which: np.ndarray | int | slice) -> Seats:
        """Those of some of many choices."""
        return Seats(self.heights[which], self.sides[which])


class _Rod(NamedTuple):
    """A segment of a part; ``place`` numbers those of a link."""

    part: Part
    place: int


@dataclass(frozen=True, eq=False)
class Assembly:
    """The segments of all parts of a loop, mm: first three of each link, then one of
    each hinge. Of many choices of seats at once where these have a leading axis."""

    loop: Loop
    dimensions: Dimensions
    seats: Seats

    @cached_property
    def segments(self) -> np.ndarray:
        """Ends (..., 4 n, 2, 3) of all segments, each in the frame it moves with."""
        corners = link_corners(self.loop, self.dimensions, self.seats)
        rods = np.stack([corners[..., :-1, :], corners[..., 1:, :]], axis=-2)
        leading = self.seats.heights.shape[:-1]
        n = self.loop.n
        hinges = np.zeros((*leading, n, 2, 3))
        heights, sides = self.seats.heights, self.seats.sides
        hinges[..., 0, 2] = heights + sides * self.dimensions.bottom
        hinges[..., 1, 2] = heights + sides * self.dimensions.top
        flat = rods.reshape(*leading, RODS * n, 2, 3)
        return np.concatenate([flat, hinges], axis=-3)

    @cached_property
    def frames(self) -> np.ndarray:
        """Which link (4 n,) each segment moves with."""
        links = np.arange(self.loop.n)
        return np.concatenate([np.repeat(links, RODS), links - 1]) % self.loop.n

    @cached_property
    def radii(self) -> np.ndarray:
        """The radii (4 n,) around the segments."""
        n = self.loop.n
        rods = np.full(RODS * n, self.dimensions.elbow_radius)
        return np.concatenate([rods, np.full(n, self.dimensions.hinge_radius)])

    @cached_property
    def pairs(self) -> np.ndarray:
        """The pairs (p, 2) of segments that may meet."""
        return pairs_that_may_meet(self.loop.n)

    def part(self, segment: int) -> Part:
        """What a segment belongs to."""
        return _rods_of(self.loop.n)[segment].part

    def placed(self, theta: np.ndarray) -> np.ndarray:
        """The segments (..., k, 4 n, 2, 3) at joint angles (k, n), rad, in the frame of
        the last link."""
        return place_segments(self.segments, self.poses(theta))

    def poses(self, theta: np.ndarray) -> np.ndarray:
        """Poses (k, 4 n, 4, 4) of what the segments move with at joint angles (k, n),
        rad."""
        links = self.loop.frames(theta)[:, 1:]
        poses: np.ndarray = links[:, self.frames]
        return poses

    def clearances(self, placed: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """What is left (..., p) between the surfaces of pairs (p, 2) of segments; below
        zero they meet."""
        first, second = placed[..., pairs[:, 0], :, :], placed[..., pairs[:, 1], :, :]
        radii = self.radii[pairs].sum(axis=-1)
        clearances: np.ndarray = distances_by_ends(first, second) - radii
        return clearances


def place_segments(segments: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Segments (..., m, 2, 3) at poses (k, m, 4, 4), as (..., k, m, 2, 3)."""
    rotations = np.swapaxes(poses[..., :3, :3], -1, -2)
    turned = np.matmul(segments[..., None, :, :, :], rotations)
    placed: np.ndarray = turned + poses[..., None, :3, 3]
    return placed


def link_corners(loop: Loop, dimensions: Dimensions, seats: Seats) -> np.ndarray:
    """Corners (..., n, 4, 3) of each link, mm: the middle of its first eye, the ends of
    the rod in between and the middle of its last eye, in the frame that moves with the
    link, as in `linkages.links.rods.link_corners`."""
    lengths, twists, offsets = loop.arrays
    z_axis = np.array([0.0, 0.0, 1.0])
    step = seats.sides * dimensions.step
    corners = np.zeros((*seats.heights.shape, RODS + 1, 3))
    for i in range(loop.n):
        following = (i + 1) % loop.n
        axis = np.array([0.0, np.sin(twists[i]), np.cos(twists[i])])
        foot = np.array([-lengths[i], 0.0, 0.0])
        height = seats.heights[..., i] - offsets[i] + step[..., i]
        next_height = seats.heights[..., following] - step[..., following]
        first = foot + height[..., None] * axis
        last = next_height[..., None] * z_axis
        way = last - first
        corners[..., i, 0, :] = first
        corners[..., i, 1, :] = first + dimensions.arm * _across(way, axis)
        corners[..., i, 2, :] = last - dimensions.arm * _across(way, z_axis)
        corners[..., i, 3, :] = last
    return corners


def _across(way: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """The directions (..., 3) of ways (..., 3) seen along an axis; that of the x axis,
    which is perpendicular to both axes of a link, for a way along the axis."""
    across = way - (way @ axis)[..., None] * axis
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    limit = PARALLEL * np.linalg.norm(way, axis=-1, keepdims=True)
    has_direction = length > limit
    x_axis = np.array([1.0, 0.0, 0.0])
    return np.where(has_direction, across / np.where(has_direction, length, 1), x_axis)


# --- which segments are compared ------------------------------------------------------


@cache
def pairs_that_may_meet(n: int) -> np.ndarray:
    """Pairs (p, 2) of segments of a loop of n joints, but for those that are joined or
    turn on each other about one axis, whose distance the dimensions give."""
    rods = _rods_of(n)
    pairs = []
    for first, second in combinations(range(len(rods)), 2):
        if not _is_at_one_hinge(rods[first], rods[second], n):
            pairs.append((first, second))
    return np.array(pairs)


def _rods_of(n: int) -> list[_Rod]:
    rods = []
    for i in range(n):
        rods += [_Rod(Part(Kind.LINK, i), place) for place in range(RODS)]
    return rods + [_Rod(Part(Kind.HINGE, i), 0) for i in range(n)]


def _is_at_one_hinge(first: _Rod, second: _Rod, n: int) -> bool:
    """Whether two segments are of one part, or both are a hinge or an arm at one
    joint."""
    if first.part == second.part:
        return True
    joint = _joint_of(first, n)
    return joint is not None and joint == _joint_of(second, n)


def _joint_of(rod: _Rod, n: int) -> int | None:
    """The joint at which a hinge or an arm is, None for a rod in between."""
    if rod.part.kind is Kind.HINGE or rod.place == FIRST_ARM:
        return rod.part.joint
    return (rod.part.joint + 1) % n if rod.place == LAST_ARM else None
