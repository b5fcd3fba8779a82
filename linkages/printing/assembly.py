"""A linkage of rods and hinges as straight segments with radii: what is compared to
see whether parts meet, and what solids are made of.

A hinge may sit anywhere along its axis. A link leaves each of its two axes at a right
angle, until it is beside the hinge, and goes straight in between. Every part is then a
union of capsules (a segment and all that is within a radius of it), and distances of
parts are distances of segments, less the radii.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from linkages.links.distances import distances_by_ends
from linkages.loop import Loop
from linkages.values import require, told_apart

RODS = 3  # of a link: an arm, the rod in between, an arm
NO_JOINT = -1  # at which the rod between two arms is
PARALLEL = 1e-9  # of a length: what is less has no direction

PIN_SHARE = 0.5  # of the diameter of rods; 3 mm, an M3 bolt, for rods of 6 mm
# what touches along a curve only, or by whole faces, is hard on boolean operations:
EYE_OVER_ROD = 1.1  # so eyes are wider and taller than rods,
ELBOW_OVER_ROD = 1.05  # and the balls at the corners of rods, too
GRIP = 1.5  # how much of the pin a cap holds, in radii of the pin
GLUE_SHARE = 1 / 3  # of the play, between pin and cap
FLAT_FROM = 45  # deg of latitude of round ends; a wall is left beyond the bore of a cap
ARM_ROOM = 4.0  # in plays: between a hinge and the corner of a rod that leaves it


@dataclass(frozen=True)
class Dimensions:
    """Sizes of rods and hinges, mm: the ``diameter`` of rods, the ``play`` between
    surfaces that move on each other and the least thickness of a ``wall``.

    A hinge is a pin with a round head through the eyes of both links, and a cap on its
    end. From the middle between the eyes it reaches from ``bottom`` to ``top`` along
    its axis, with a half ball beyond each. Raises `GeometryError` for a rod or a play
    that cannot be printed.
    """

    diameter: float
    play: float
    wall: float

    def __post_init__(self) -> None:
        for name in ("diameter", "play", "wall"):
            value = getattr(self, name)
            is_length = math.isfinite(value) and value > 0
            require(is_length, name, value, "positive and finite, in mm")
        shown, least = told_apart(self.diameter, 2 * self.wall)
        allowed = f"at least {least} mm, twice the wall"
        is_thick = self.diameter >= 2 * self.wall
        require(is_thick, "diameter", f"{shown} mm", allowed)

    @property
    def rod_radius(self) -> float:
        """That of the rods."""
        return self.diameter / 2

    @property
    def elbow_radius(self) -> float:
        """That of the balls at corners; no point of a rod is farther from its line."""
        return ELBOW_OVER_ROD * self.rod_radius

    @property
    def pin_radius(self) -> float:
        """That of the pins."""
        return PIN_SHARE * self.rod_radius

    @property
    def bore_radius(self) -> float:
        """That of the bores that turn on a pin."""
        return self.pin_radius + self.play

    @property
    def cap_bore_radius(self) -> float:
        """That of the bore by which a cap is glued or pressed on its pin."""
        return self.pin_radius + GLUE_SHARE * self.play

    @property
    def hinge_radius(self) -> float:
        """That of eyes, heads and caps."""
        return max(EYE_OVER_ROD * self.rod_radius, self.bore_radius + self.wall)

    @property
    def eye_height(self) -> float:
        """That of an eye, along its axis."""
        return 2 * EYE_OVER_ROD * self.rod_radius

    @property
    def step(self) -> float:
        """From the middle of a hinge to that of an eye."""
        return (self.eye_height + self.play) / 2

    @property
    def bottom(self) -> float:
        """Where the head of a pin ends, a flat face (below zero)."""
        return -(self.eye_height + 1.5 * self.play)

    @property
    def top(self) -> float:
        """Where the straight part of a cap ends."""
        return -self.bottom + GRIP * self.pin_radius

    @property
    def round_end(self) -> float:
        """How far heads and caps go on beyond their straight parts."""
        return self.hinge_radius * math.sin(math.radians(FLAT_FROM))

    @property
    def arm(self) -> float:
        """How far a rod goes straight out from an axis, so that what follows is beside
        the hinge."""
        return self.hinge_radius + self.elbow_radius + ARM_ROOM * self.play


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
        rods = RODS * self.loop.n
        if segment < rods:
            return Part(Kind.LINK, int(segment // RODS))
        return Part(Kind.HINGE, int(segment - rods))

    def placed(self, theta: np.ndarray) -> np.ndarray:
        """The segments (..., k, 4 n, 2, 3) at joint angles (k, n), rad, in the frame of
        the last link."""
        return place_segments(self.segments, self.poses(theta))

    def poses(self, theta: np.ndarray) -> np.ndarray:
        """Poses (k, 4 n, 4, 4) of what the segments move with at joint angles (k, n),
        rad."""
        links = self.loop.frames(theta)[:, 1:]
        return links[:, self.frames]

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
    """Pairs (p, 2) of segments of a loop of n joints, but for those of one link, and
    those at one joint, hinges and arms, whose distance the dimensions give."""
    joints = np.arange(n)
    arms = np.column_stack([joints, np.full(n, NO_JOINT), (joints + 1) % n])
    joint_of = np.concatenate([arms.ravel(), joints])
    part_of = np.concatenate([np.repeat(joints, RODS), n + joints])
    first, second = np.triu_indices(len(part_of), 1)
    is_at_one = (joint_of[first] == joint_of[second]) & (joint_of[first] != NO_JOINT)
    may_meet = ~is_at_one & (part_of[first] != part_of[second])
    pairs: np.ndarray = np.column_stack([first, second])[may_meet]
    return pairs
