"""Poses of bodies in which all joints of an assembly fit, and random ones to start from.

Unknowns are the six freedoms of every body, small turns and slides of it; equations say
that the two frames of a joint agree as far as its kind asks. They are linear in the
frames' points and axes, so that derivatives are cross products. Steps are those of
Levenberg and Marquardt (Marquardt 1963), the last ones of Gauss and Newton.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from linkages.formats.assembly import MOVES, SLIDES, TURN, Assembly, BodyJoint
from linkages.mechanisms.joint import JointKind, Limits

MOST_STEPS = 100
POLISHING_STEPS = 4
START_DAMPING = 1e-2
LEAST_DAMPING, MOST_DAMPING = 1e-14, 1e8
AT_REST = 1e-15  # of the residual: no longer smaller by a step
RANK = 1e-9  # singular value, over the largest, of a motion: no step along it
ORIGIN = JointKind.REVOLUTE, JointKind.SPHERICAL, JointKind.UNIVERSAL, JointKind.RIGID
ORIGIN_OR_SCREW = (*ORIGIN, JointKind.HELICAL)
ACROSS = JointKind.PRISMATIC, JointKind.CYLINDRICAL
TURNLESS = JointKind.PRISMATIC, JointKind.RIGID, JointKind.HELICAL


@dataclass(frozen=True, eq=False)
class ClosedPoses:
    """The ``poses`` (b, 4, 4) of all bodies and by how much, at most, the joints miss
    each other there: the ``gap``, over the ``size``, the mean distance of joints on a
    body; of directions it is a sine."""

    poses: np.ndarray
    gap: float
    size: float


class _Rows(NamedTuple):
    """Some equations: ``residuals`` (k,), and their derivatives (k, 6) by the turn and
    the slide of the first and of the second body."""

    residuals: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray


class _Moving(NamedTuple):
    """Two vectors (3,), ``first`` of one body and ``second`` of another one, with their
    derivatives (3, 6)."""

    first: np.ndarray
    second: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray


class Closing:
    """The equations of an ``assembly``. The first body does not move."""

    def __init__(self, assembly: Assembly):
        self.assembly = assembly

    @cached_property
    def size(self) -> float:
        """The mean distance of joints on a body, of those that are apart; 1 where none
        are."""
        points: dict[str, list[np.ndarray]] = {}
        for joint in self.assembly.joints:
            for body, point in zip(joint.bodies, joint.points, strict=True):
                points.setdefault(body, []).append(point)
        distances = []
        for here in points.values():
            for k, point in enumerate(here):
                distances += [np.linalg.norm(point - other) for other in here[:k]]
        apart = [float(distance) for distance in distances if distance > 0]
        return float(np.mean(apart)) if apart else 1.0

    def close(self, poses: np.ndarray) -> ClosedPoses:
        """The poses next to ``poses`` (b, 4, 4) in which the joints fit best, by least
        squares."""
        poses = poses.copy()
        poses[:, :3, 3] /= self.size
        poses = self._damped_steps(poses)
        for _ in range(POLISHING_STEPS):
            residuals, matrix = self._system(poses)
            step = np.linalg.lstsq(matrix, -residuals, rcond=RANK)[0]
            poses = _moved(poses, step)
        poses[:, :3, 3] *= self.size
        return self.measure(poses)

    def measure(self, poses: np.ndarray) -> ClosedPoses:
        """``poses`` (b, 4, 4) as they are, with their gap."""
        scaled = poses.copy()
        scaled[:, :3, 3] /= self.size
        gap = float(np.abs(self._system(scaled)[0]).max(initial=0.0))
        return ClosedPoses(poses, gap, self.size)

    def _damped_steps(self, poses: np.ndarray) -> np.ndarray:
        damping = START_DAMPING
        residuals, matrix = self._system(poses)
        cost = float(residuals @ residuals)
        for _ in range(MOST_STEPS):
            if cost < AT_REST**2 or damping > MOST_DAMPING:
                break
            normal = matrix.T @ matrix
            normal[np.diag_indices_from(normal)] += damping
            step = np.linalg.solve(normal, -matrix.T @ residuals)
            trial = _moved(poses, step)
            new_residuals, new_matrix = self._system(trial)
            new_cost = float(new_residuals @ new_residuals)
            if new_cost < cost:
                is_at_rest = cost - new_cost < 1e-12 * cost
                poses, residuals, matrix = trial, new_residuals, new_matrix
                cost = new_cost
                damping = max(damping / 10, LEAST_DAMPING)
                if is_at_rest:
                    break
            else:
                damping *= 10
        return poses

    def _system(self, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (m,) and their derivatives (m, 6 b) at ``poses``, lengths over the
        size."""
        residuals, blocks = [], []
        row = 0
        for joint in self.assembly.joints:
            first, second = (self.assembly.numbers[body] for body in joint.bodies)
            rows = self._rows(joint, poses[first], poses[second])
            residuals.append(rows.residuals)
            blocks.append((row, first, rows.by_first))
            blocks.append((row, second, rows.by_second))
            row += len(rows.residuals)
        matrix = np.zeros((row, 6 * len(poses)))
        for start, body, block in blocks:
            matrix[start : start + len(block), 6 * body : 6 * body + 6] += block
        matrix[:, :6] = 0.0  # the first body does not move
        return np.concatenate([*residuals, np.empty(0)]), matrix

    def _rows(self, joint: BodyJoint, first: np.ndarray, second: np.ndarray) -> _Rows:
        """The equations of a joint."""
        frames = []
        for pose, frame in zip((first, second), joint.frames, strict=True):
            scaled = frame.copy()
            scaled[:3, 3] /= self.size
            frames.append(pose @ scaled)
        one, other = frames
        origins = _points(one, other)
        axes = _axes(one, other, 2)
        parts = []
        if joint.kind in ORIGIN_OR_SCREW:
            parts.append(_difference(origins))
        elif joint.kind in ACROSS:
            parts += [_along(origins, one, column) for column in (0, 1)]
        elif joint.kind is JointKind.PLANAR:
            parts.append(_along(origins, one, 2))
        if joint.kind is JointKind.UNIVERSAL:
            parts.append(_angle(axes, joint.cosine))
        elif joint.kind is not JointKind.SPHERICAL:
            parts.append(_difference(axes))
        if joint.kind in TURNLESS:
            parts.append(_difference(_axes(one, other, 0)))
        return _Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


# --- pieces of equations --------------------------------------------------------------


def _skew(vector: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) of the cross product with ``vector`` (3,)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _points(one: np.ndarray, other: np.ndarray) -> _Moving:
    points = one[:3, 3], other[:3, 3]
    rates = [np.hstack([-_skew(point), np.eye(3)]) for point in points]
    return _Moving(*points, *rates)


def _axes(one: np.ndarray, other: np.ndarray, column: int) -> _Moving:
    axes = one[:3, column], other[:3, column]
    rates = [np.hstack([-_skew(axis), np.zeros((3, 3))]) for axis in axes]
    return _Moving(*axes, *rates)


def _difference(moving: _Moving) -> _Rows:
    """The second vector less the first one."""
    return _Rows(moving.second - moving.first, -moving.by_first, moving.by_second)


def _along(origins: _Moving, one: np.ndarray, column: int) -> _Rows:
    """How far the second origin is from the first one along an axis of the first
    frame."""
    axis = one[:3, column]
    gap = origins.second - origins.first
    by_axis = np.hstack([-_skew(axis), np.zeros((3, 3))])
    by_first = gap @ by_axis - axis @ origins.by_first
    by_second = axis @ origins.by_second
    return _Rows(np.array([axis @ gap]), by_first[None], by_second[None])


def _angle(axes: _Moving, cosine: float) -> _Rows:
    residual = np.array([axes.first @ axes.second - cosine])
    by_first = axes.second @ axes.by_first
    by_second = axes.first @ axes.by_second
    return _Rows(residual, by_first[None], by_second[None])


def _moved(poses: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The ``poses`` (b, 4, 4) turned and moved by ``step`` (6 b,)."""
    from scipy.spatial.transform import Rotation

    steps = step.reshape(-1, 6)
    rotations = Rotation.from_rotvec(steps[:, :3]).as_matrix()
    moved = poses.copy()
    moved[:, :3, :3] = rotations @ poses[:, :3, :3]
    moved[:, :3, 3] = np.einsum("kij,kj->ki", rotations, poses[:, :3, 3])
    moved[:, :3, 3] += steps[:, 3:]
    return moved


# --- random poses ---------------------------------------------------------------------


class Starts:
    """Poses of an ``assembly`` in which the joints of a spanning tree fit, with random
    variables; slides without limits are within ``size`` of 0."""

    def __init__(self, assembly: Assembly, size: float):
        self.assembly = assembly
        self.size = size
        self._tree = self._spanning_tree()

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """Poses (b, 4, 4); the first body is at rest."""
        poses = np.tile(np.eye(4), (len(self.assembly.bodies), 1, 1))
        for joint, is_forward in self._tree:
            first, second = (self.assembly.numbers[body] for body in joint.bodies)
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
        if joint.kind is JointKind.UNIVERSAL:
            first, second = (_turn(_random_angle(rng, None)) for _ in range(2))
            motion[:3, :3] = first @ _tilt(joint.cosine) @ second
        elif joint.kind is JointKind.SPHERICAL:
            motion[:3, :3] = _any_rotation(rng)
        elif joint.kind is not JointKind.HELICAL:
            limits = [*joint.limits, None, None, None]
            for move, pair in zip(MOVES.get(joint.kind, ()), limits, strict=False):
                if move == TURN:
                    motion[:3, :3] = _turn(_random_angle(rng, pair))
                else:
                    motion[SLIDES.index(move), 3] = self._slide(rng, pair)
        return motion

    def _slide(self, rng: np.random.Generator, limits: Limits | None) -> float:
        low, high = limits or (-self.size, self.size)
        return float(rng.uniform(low, high))


def _random_angle(rng: np.random.Generator, limits: Limits | None) -> float:
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
