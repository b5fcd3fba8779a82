"""Where the bodies of a mechanism are."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from linkages.mechanisms.joint import Motion
from linkages.mechanisms.structure import Structure

__all__ = ["Poses", "rotation_vectors"]

SMALL = 1e-12  # sine below which two directions are parallel


class Poses:
    """The displacements of all bodies of a mechanism with a ``structure`` from the
    reference configuration, the frame at rest. Lengths are in the user's unit."""

    def __init__(self, structure: Structure):
        self.structure = structure
        self.mechanism = structure.mechanism

    def at(self, points: np.ndarray) -> np.ndarray:
        """Homogeneous transforms (k, b, 4, 4) of the b bodies at configurations (k, n),
        in the unknowns of the structure."""
        bodies = self.mechanism.bodies
        poses = np.tile(np.eye(4), (len(points), len(bodies), 1, 1))
        for origin, goal, number, sign in self._tree:
            motion = self._displacement(points, number)
            if sign < 0:
                motion = _inverse(motion)
            poses[:, goal] = poses[:, origin] @ motion
        for rod in self.structure.rods:
            if rod.body in self.structure.idle_bodies:
                place = bodies.index(rod.body)
                poses[:, place] = self._rod_pose(poses, rod.pairs, rod.ends)
        return poses

    def rotations(self, points: np.ndarray, number: int) -> np.ndarray:
        """The rotations (k, 3, 3) of the moved body of a pair with respect to its
        base."""
        bodies = self.mechanism.bodies
        pair = self.mechanism.pairs[number]
        poses = self.at(points)
        base = poses[:, bodies.index(pair.base), :3, :3]
        moved = poses[:, bodies.index(pair.moved), :3, :3]
        rotations: np.ndarray = np.swapaxes(base, 1, 2) @ moved
        return rotations

    @cached_property
    def _tree(self) -> list[tuple[int, int, int, int]]:
        """Steps (from body, to body, across pair, sign) that reach every body but the
        idle ones, from the frame on."""
        bodies = self.mechanism.bodies
        pairs = self.structure.tree_pairs
        steps = []
        reached = [bodies.index(self.mechanism.frame)]
        for body in reached:  # it grows on the way
            for number, ends in pairs.items():
                for here, there, sign in (
                    (ends.base, ends.moved, 1),
                    (ends.moved, ends.base, -1),
                ):
                    if here == body and there not in reached:
                        steps.append((here, there, number, sign))
                        reached.append(there)
        return steps

    def _displacement(self, points: np.ndarray, number: int) -> np.ndarray:
        """The transform (k, 4, 4) of the moved body of a pair with respect to its
        base."""
        pair = self.mechanism.pairs[number]
        result = np.tile(np.eye(4), (len(points), 1, 1))
        if pair.center is not None:
            columns = list(self.structure.embedded[number])
            a, b = points[:, columns[:3]], points[:, columns[3:]]
            rotation = np.stack([a, b, np.cross(a, b)], axis=-1)
            result[:, :3, :3] = rotation
            result[:, :3, 3] = pair.center - rotation @ pair.center
            return result
        for variable in pair.variables:
            motion = self.mechanism.variables[variable].motion
            values = self.structure.values(points, variable)
            result = result @ _transforms(motion, values)
        return result

    def _rod_pose(
        self, poses: np.ndarray, pairs: Sequence[int], ends: Sequence[int]
    ) -> np.ndarray:
        """The transform (k, 4, 4) of a rod between two spherical joints on bodies whose
        ``poses`` are known, turned as little as can be."""
        centers = []
        for pair in pairs:
            center = self.mechanism.pairs[pair].center
            assert center is not None
            centers.append(center)
        places = [
            poses[:, body, :3, :3] @ center + poses[:, body, :3, 3]
            for body, center in zip(ends, centers, strict=True)
        ]
        along = (centers[1] - centers[0]) / np.linalg.norm(centers[1] - centers[0])
        now = places[1] - places[0]
        now = now / np.linalg.norm(now, axis=1)[:, None]
        result = np.tile(np.eye(4), (len(poses), 1, 1))
        rotation = _shortest_rotations(along, now)
        result[:, :3, :3] = rotation
        result[:, :3, 3] = places[0] - rotation @ centers[0]
        return result


def rotation_vectors(rotations: np.ndarray) -> np.ndarray:
    """Rotation vectors (k, 3), rad, of rotations (k, 3, 3)."""
    from scipy.spatial.transform import Rotation

    vectors: np.ndarray = Rotation.from_matrix(rotations).as_rotvec()
    return vectors


def _transforms(motion: Motion, values: np.ndarray) -> np.ndarray:
    """The transforms (k, 4, 4) of an elementary motion by ``values`` (k,), in rad or
    the user's unit."""
    result = np.tile(np.eye(4), (len(values), 1, 1))
    if not motion.is_turn:
        result[:, :3, 3] = values[:, None] * motion.direction
        return result
    rotation = _turns(motion.direction, values)
    result[:, :3, :3] = rotation
    advance = (motion.advance * values)[:, None] * motion.direction
    result[:, :3, 3] = motion.point - rotation @ motion.point + advance
    return result


def _turns(direction: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Rotations (k, 3, 3) about a unit vector (3,) by ``angles`` (k,)."""
    x, y, z = direction
    turned = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    along = np.outer(direction, direction)
    cosines, sines = np.cos(angles)[:, None, None], np.sin(angles)[:, None, None]
    rotations: np.ndarray = along + cosines * (np.eye(3) - along) + sines * turned
    return rotations


def _shortest_rotations(start: np.ndarray, goals: np.ndarray) -> np.ndarray:
    """The smallest rotations (k, 3, 3) that turn a unit vector (3,) to ``goals``
    (k, 3)."""
    rotations = []
    for goal in goals:
        axis = np.cross(start, goal)
        sine, cosine = float(np.linalg.norm(axis)), float(start @ goal)
        if sine < SMALL:
            axis = np.cross(start, np.eye(3)[np.argmin(np.abs(start))])
        axis = axis / np.linalg.norm(axis)
        rotations.append(_turns(axis, np.array([np.arctan2(sine, cosine)]))[0])
    return np.array(rotations).reshape(-1, 3, 3)


def _inverse(transforms: np.ndarray) -> np.ndarray:
    """The inverses of displacements (k, 4, 4)."""
    result = np.tile(np.eye(4), (len(transforms), 1, 1))
    transposed = np.swapaxes(transforms[:, :3, :3], 1, 2)
    result[:, :3, :3] = transposed
    result[:, :3, 3] = -np.einsum("kij,kj->ki", transposed, transforms[:, :3, 3])
    return result
