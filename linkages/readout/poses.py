"""Where the bodies of a mechanism are."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from linkages.closure.changes import AS_GIVEN, Changes
from linkages.mechanisms.joint import transforms
from linkages.structure.rods import Rod
from linkages.structure.structure import Structure

SMALL = 1e-12  # sine below which two directions are parallel


class TreeStep(NamedTuple):
    """From a body to another one, by number, across a pair: from its base to its moved
    body or, with the sign -1, the other way."""

    origin: int
    goal: int
    pair: int
    sign: int


class Poses:
    """The displacements of all bodies of a mechanism with a ``structure``, and with what
    ``changes``, from the reference configuration, the frame at rest. Lengths are in the
    user's unit."""

    def __init__(self, structure: Structure, changes: Changes = AS_GIVEN):
        self.structure = structure
        self.mechanism = structure.mechanism
        self.changes = changes

    def at(self, points: np.ndarray) -> np.ndarray:
        """Homogeneous transforms (k, b, 4, 4) of the b bodies at configurations (k, n),
        in the unknowns of the structure."""
        bodies = self.mechanism.bodies
        count = self.structure.body_count
        poses = np.tile(np.eye(4), (len(points), count, 1, 1))
        for origin, goal, number, sign in self.tree:
            first, last = (self.change(number, side) for side in (0, 1))
            motion = first @ self._displacement(points, number) @ last
            if sign < 0:
                motion = _inverse(motion)
            poses[:, goal] = poses[:, origin] @ motion
        for rod in self.structure.rods:
            self._place_rod(poses, points, rod)
        frame = bodies.index(self.mechanism.frame)
        of_bodies = poses[:, : len(bodies)]
        return _inverse(poses[:, frame])[:, None] @ of_bodies

    def change(self, pair: int, side: int) -> np.ndarray:
        """The transform (4, 4) of what changes on the base (``side`` 0) of a pair, by
        number, or on its moved body (1)."""
        result = np.eye(4)
        for motion, value in self.changes.displacement(pair, side):
            size = value if motion.is_turn else self.structure.unit * value
            result = result @ transforms(motion, np.array([size]))[0]
        return result

    def rotations(self, points: np.ndarray, numbers: Sequence[int]) -> np.ndarray:
        """The rotations (p, k, 3, 3) of the moved bodies of some pairs, by ``numbers``
        (p,), with respect to their bases."""
        bodies = self.mechanism.bodies
        pairs = [self.mechanism.pairs[number] for number in numbers]
        base = [bodies.index(pair.base) for pair in pairs]
        moved = [bodies.index(pair.moved) for pair in pairs]
        of_bodies = np.moveaxis(self.at(points)[..., :3, :3], 1, 0)
        rotations: np.ndarray = np.swapaxes(of_bodies[base], 2, 3) @ of_bodies[moved]
        return rotations

    @cached_property
    def tree(self) -> list[TreeStep]:
        """Steps that reach every body but the idle ones, from one that is not."""
        ways: dict[int, list[TreeStep]] = {}
        for number, ends in self.structure.tree_pairs.items():
            there, back = (ends.base, ends.moved), (ends.moved, ends.base)
            ways.setdefault(ends.base, []).append(TreeStep(*there, number, 1))
            ways.setdefault(ends.moved, []).append(TreeStep(*back, number, -1))
        idle = {body for rod in self.structure.rods for body in rod.bodies}
        steps = []
        first = min(set(range(len(self.mechanism.bodies))) - idle)
        reached = {first}
        queue = deque([first])
        while queue:
            for step in ways.get(queue.popleft(), []):
                if step.goal not in reached:
                    steps.append(step)
                    reached.add(step.goal)
                    queue.append(step.goal)
        return steps

    def _displacement(self, points: np.ndarray, number: int) -> np.ndarray:
        """The transform (k, 4, 4) of the moved body of a pair with respect to its
        base."""
        result = np.tile(np.eye(4), (len(points), 1, 1))
        shifts = self.structure.shifts.get(number)
        if shifts is not None:
            directions = self.structure.point_pairs[number].directions
            result[:, :3, 3] = points[:, list(shifts)] @ directions
            result[:, :3, 3] *= self.structure.unit
            return result
        columns = list(self.structure.embedded.get(number, ()))
        if columns:
            a, b = points[:, columns[:3]], points[:, columns[3:6]]
            rotation = np.stack([a, b, np.cross(a, b)], axis=-1)
            center = self.structure.center(number)
            result[:, :3, :3] = rotation
            result[:, :3, 3] = center - rotation @ center
            if len(columns) > 6:
                result[:, :3, 3] += points[:, columns[6:]] * self.structure.unit
            return result
        for variable in self.structure.variables_of(number):
            motion = self.mechanism.variables[variable].motion
            values = self.structure.values(points, variable)
            result = result @ transforms(motion, values)
        return result

    def _place_rod(self, poses: np.ndarray, points: np.ndarray, rod: Rod) -> None:
        """Fill in the ``poses`` (k, b, 4, 4) of the bodies of a rod at configurations
        (k, n), turned as little as can be."""
        centers = rod.centers
        places = [
            poses[:, body, :3, :3] @ center + poses[:, body, :3, 3]
            for body, center in zip(rod.ends, centers, strict=True)
        ]
        now = places[1] - places[0]
        now = now / np.linalg.norm(now, axis=1)[:, None]
        if rod.leg is not None:  # beyond length 0 it points the other way
            slide = self.structure.values(points, rod.leg.variable)
            now = now * np.sign(rod.length + rod.leg.sign * slide)[:, None]
        inside = self.inside_rod(rod)
        holder = self.holder(rod, 1)
        far = (inside[holder] @ np.append(centers[1], 1.0))[:3]
        along = (far - centers[0]) / np.linalg.norm(far - centers[0])
        rotation = _shortest_rotations(along, now)
        starts = [centers[0], far]
        for part, start, place in zip(rod.parts, starts, places, strict=True):
            pose = np.tile(np.eye(4), (len(poses), 1, 1))
            pose[:, :3, :3] = rotation
            pose[:, :3, 3] = place - rotation @ start
            for body in part:
                poses[:, body] = pose @ inside[body]

    def holder(self, rod: Rod, end: int) -> int:
        """The body of a rod that its first or second spherical joint holds."""
        point = self.structure.points[rod.points[end]]
        return min(set(point.bodies) & set(rod.parts[end]))

    def inside_rod(self, rod: Rod) -> dict[int, np.ndarray]:
        """The displacements (4, 4) of the bodies of a rod with respect to the one that
        its first joint holds, slides at 0."""
        slide = -1 if rod.leg is None else rod.leg.variable
        start = self.holder(rod, 0)
        return self.structure.groups.poses_inside(start, rod.inner, slide)


def rotation_vectors(rotations: np.ndarray) -> np.ndarray:
    """Rotation vectors (k, 3), rad, of rotations (k, 3, 3)."""
    from scipy.spatial.transform import Rotation

    vectors: np.ndarray = Rotation.from_matrix(rotations).as_rotvec()
    return vectors


def quaternions_without_jumps(matrices: np.ndarray) -> np.ndarray:
    """Unit quaternions (n, k, 4), x, y, z, w, of rotations (n, k, 3, 3) of n bodies at k
    moments, each near the one before."""
    from scipy.spatial.transform import Rotation

    count, moments = matrices.shape[:2]
    quaternions = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat()
    rotations: np.ndarray = quaternions.reshape(count, moments, 4)
    turns = (rotations[:, 1:] * rotations[:, :-1]).sum(axis=-1)
    signs = np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=1)
    rotations[:, 1:] *= signs[..., None]
    return rotations


def _shortest_rotations(start: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """The smallest rotations (k, 3, 3) that turn a unit vector (3,) to ``goals``
    (k, 3)."""
    from scipy.spatial.transform import Rotation

    axes = np.cross(start, goals)
    sines, cosines = np.linalg.norm(axes, axis=1), goals @ start
    across = np.cross(start, np.eye(3)[np.argmin(np.abs(start))])
    axes = np.where(sines[:, None] < SMALL, across, axes)
    axes = axes / np.linalg.norm(axes, axis=1)[:, None]
    angles = np.arctan2(sines, cosines)
    rotations: np.ndarray = Rotation.from_rotvec(angles[:, None] * axes).as_matrix()
    return rotations


def _inverse(transforms: np.ndarray) -> np.ndarray:
    """The inverses of displacements (k, 4, 4)."""
    result = np.tile(np.eye(4), (len(transforms), 1, 1))
    transposed = np.swapaxes(transforms[:, :3, :3], 1, 2)
    result[:, :3, :3] = transposed
    result[:, :3, 3] = -np.einsum("kij,kj->ki", transposed, transforms[:, :3, 3])
    return result
