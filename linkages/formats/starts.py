"""Random poses of the bodies of an assembly, to start closing it from."""

from __future__ import annotations

import math

import numpy as np

from linkages.formats.assembly import Assembly, BodyJoint
from linkages.mechanisms.joint import JointKind, Limits


class Starts:
    """Poses of an ``assembly`` in which the joints of a spanning tree fit, with random
    variables; slides without limits are within ``size`` of 0."""

    def __init__(self, assembly: Assembly, size: float):
        self.assembly = assembly
        self.size = size
        self.numbers = {body: k for k, body in enumerate(assembly.bodies)}
        self._tree = self._spanning_tree()

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """Poses (b, 4, 4); the first body is at rest."""
        poses = np.tile(np.eye(4), (len(self.assembly.bodies), 1, 1))
        for joint, is_forward in self._tree:
            first, second = (self.numbers[body] for body in joint.bodies)
            own, far = joint.frames
            motion = own @ self._motion(joint, rng) @ np.linalg.inv(far)
            if is_forward:
                poses[second] = poses[first] @ motion
            else:
                poses[first] = poses[second] @ np.linalg.inv(motion)
        return poses

    def _spanning_tree(self) -> list[tuple[BodyJoint, bool]]:
        """Joints that reach every body from the first one, and whether from their first
        body to the second one."""
        tree = []
        reached = [self.assembly.bodies[0]]
        for body in reached:  # it grows on the way
            for joint in self.assembly.joints:
                if body not in joint.bodies:
                    continue
                is_forward = joint.bodies[0] == body
                there = joint.bodies[1] if is_forward else joint.bodies[0]
                if there not in reached:
                    reached.append(there)
                    tree.append((joint, is_forward))
        return tree

    def _motion(self, joint: BodyJoint, rng: np.random.Generator) -> np.ndarray:
        """A random motion (4, 4) of the second frame in the first one."""
        motion = np.eye(4)
        limits = [*joint.limits, None, None, None]
        match joint.kind:
            case JointKind.REVOLUTE:
                motion[:3, :3] = _turn(_angle(rng, limits[0]))
            case JointKind.PRISMATIC:
                motion[2, 3] = self._slide(rng, limits[0])
            case JointKind.CYLINDRICAL:
                motion[:3, :3] = _turn(_angle(rng, limits[0]))
                motion[2, 3] = self._slide(rng, limits[1])
            case JointKind.PLANAR:
                motion[0, 3] = self._slide(rng, limits[0])
                motion[1, 3] = self._slide(rng, limits[1])
                motion[:3, :3] = _turn(_angle(rng, limits[2]))
            case JointKind.UNIVERSAL:
                first, second = (_turn(_angle(rng, None)) for _ in range(2))
                motion[:3, :3] = first @ _tilt(joint.cosine) @ second
            case JointKind.SPHERICAL:
                motion[:3, :3] = _any_rotation(rng)
            case JointKind.HELICAL | JointKind.RIGID:
                pass
        return motion

    def _slide(self, rng: np.random.Generator, limits: Limits | None) -> float:
        low, high = limits or (-self.size, self.size)
        return float(rng.uniform(low, high))


def _angle(rng: np.random.Generator, limits: Limits | None) -> float:
    low, high = limits or (-math.pi, math.pi)
    return float(rng.uniform(low, high))


def _turn(angle: float) -> np.ndarray:
    """The rotation (3, 3) about the third axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _tilt(cosine: float) -> np.ndarray:
    """The rotation (3, 3) about the first axis by an angle of this cosine."""
    sine = math.sqrt(max(0.0, 1 - cosine**2))
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def _any_rotation(rng: np.random.Generator) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    rotation: np.ndarray = Rotation.random(rng=rng).as_matrix()
    return rotation
