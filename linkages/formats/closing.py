"""Poses of bodies in which all joints of an assembly fit, and random ones to start from.

Unknowns are the six freedoms of every body, small turns and slides of it; equations say
that the two frames of a joint agree as far as its kind asks. They are linear in the
frames' points and axes, so that derivatives are cross products. Steps are those of
Levenberg and Marquardt (Marquardt 1963), the last ones of Gauss and Newton.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import networkx as nx
import numpy as np

from linkages.decisions import is_file_nearly_closed
from linkages.formats.assembly import Assembly, BodyJoint
from linkages.mechanisms.joint import Fit, JointKind, Limits, Move

MOST_STEPS = 100
POLISHING_STEPS = 4
START_DAMPING = 1e-2
LEAST_DAMPING, MOST_DAMPING = 1e-14, 1e8
LEAST_GAIN = 1e-12  # of a step, over the sum of squares: where no step is better
AT_REST = 1e-15  # of the residual: no longer smaller by a step
RANK = 1e-9  # singular value, over the largest, of a motion: no step along it
ORIGIN_COLUMN = 3  # of a frame


@dataclass(frozen=True, eq=False)
class ClosedPoses:
    """The ``poses`` (b, 4, 4) of all bodies and by how much, at most, the joints miss
    each other there: the ``gap``, over the ``size``, the mean distance of joints on a
    body; of directions it is a sine."""

    poses: np.ndarray
    gap: float
    size: float


class Rows(NamedTuple):
    """Some equations: ``residuals`` (k,), and their derivatives (k, 6) by the turn and
    the slide of the first and of the second body."""

    residuals: np.ndarray
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
        from scipy.linalg import lstsq

        poses = poses.copy()
        poses[:, :3, 3] /= self.size
        poses = self._damped_steps(poses)
        for _ in range(POLISHING_STEPS):
            residuals, matrix = self._system(poses)
            # by pivots: several times faster than by singular values
            step = lstsq(matrix, -residuals, cond=RANK, lapack_driver="gelsy")[0]
            poses = self._moved(poses, step)
            if np.abs(step).max(initial=0.0) < AT_REST:
                break
        poses[:, :3, 3] *= self.size
        return self.measure(poses)

    def measure(self, poses: np.ndarray) -> ClosedPoses:
        """``poses`` (b, 4, 4) as they are, with their gap."""
        scaled = poses.copy()
        scaled[:, :3, 3] /= self.size
        gap = float(np.abs(self._system(scaled)[0]).max(initial=0.0))
        return ClosedPoses(poses, gap, self.size)

    def missing(self, poses: np.ndarray) -> list[str]:
        """The joints that do not fit at ``poses`` (b, 4, 4), the worst first."""
        scaled = poses.copy()
        scaled[:, :3, 3] /= self.size
        misfits = self._misfits(scaled)
        apart = [name for name in misfits if not is_file_nearly_closed(misfits[name])]
        return sorted(apart, key=misfits.__getitem__, reverse=True)

    def _misfits(self, poses: np.ndarray) -> dict[str, float]:
        """By how much each joint misses, lengths over the size."""
        misfits = {}
        for joint in self.assembly.joints:
            first, second = (poses[self.assembly.numbers[b]] for b in joint.bodies)
            residuals = self._rows(joint, first, second).residuals
            misfits[joint.name] = float(np.abs(residuals).max(initial=0.0))
        return misfits

    def _damped_steps(self, poses: np.ndarray) -> np.ndarray:
        damping = START_DAMPING
        residuals, matrix = self._system(poses)
        cost = float(residuals @ residuals)
        for _ in range(MOST_STEPS):
            if cost < AT_REST**2 or damping > MOST_DAMPING:
                break
            normal = matrix.T @ matrix
            normal[np.diag_indices_from(normal)] += damping
            slope = matrix.T @ residuals
            step = np.linalg.solve(normal, -slope)
            if step @ (damping * step - slope) < LEAST_GAIN * cost:
                break
            trial = self._moved(poses, step)
            new_residuals, new_matrix = self._system(trial)
            new_cost = float(new_residuals @ new_residuals)
            if new_cost < cost:
                is_at_rest = cost - new_cost < LEAST_GAIN * cost
                poses, residuals, matrix = trial, new_residuals, new_matrix
                cost = new_cost
                damping = max(damping / 10, LEAST_DAMPING)
                if is_at_rest:
                    break
            else:
                damping *= 10
        return poses

    def _moved(self, poses: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The ``poses`` (b, 4, 4) turned and moved by ``step`` (6 b,)."""
        from scipy.spatial.transform import Rotation

        steps = step.reshape(-1, 6)
        rotations = Rotation.from_rotvec(steps[:, :3]).as_matrix()
        moved = poses.copy()
        moved[:, :3, :3] = rotations @ poses[:, :3, :3]
        moved[:, :3, 3] = np.einsum("kij,kj->ki", rotations, poses[:, :3, 3])
        moved[:, :3, 3] += steps[:, 3:]
        return moved

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

    def _scaled(self, joint: BodyJoint) -> tuple[np.ndarray, np.ndarray]:
        """Both frames (4, 4) of a joint in its bodies, lengths over the size."""
        return self._scaled_frames[joint.name]

    @cached_property
    def _scaled_frames(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        units = np.ones((4, 4))
        units[:3, 3] = self.size
        return {
            joint.name: (joint.frames[0] / units, joint.frames[1] / units)
            for joint in self.assembly.joints
        }

    def _rows(self, joint: BodyJoint, first: np.ndarray, second: np.ndarray) -> Rows:
        """The equations of a joint."""
        own, far = self._scaled(joint)
        one, other = first @ own, second @ far
        parts = self._parts(joint.kind.facets.fit, one, other, joint.cosine)
        return Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    def _parts(
        self,
        fits: Sequence[Fit],
        one: np.ndarray,
        other: np.ndarray,
        cosine: float = 0.0,
    ) -> list[Rows]:
        """What two frames (4, 4) have to have in common."""
        parts = []
        for fit in fits:
            if fit in SHARED:
                parts.append(_difference(one, other, SHARED[fit]))
            elif fit is Fit.ANGLE:
                parts.append(_angle(one, other, cosine))
            else:
                parts += [_along(one, other, column) for column in ACROSS[fit]]
        return parts


# --- pieces of equations --------------------------------------------------------------

# the column that both frames have in common, and those along which there is no gap
SHARED = {Fit.POINT: ORIGIN_COLUMN, Fit.AXIS: 2, Fit.TURN: 0}
ACROSS = {Fit.LINE: (0, 1), Fit.PLANE: (2,)}


def _rates(frame: np.ndarray, column: int) -> np.ndarray:
    """The derivatives (3, 6) of a column of a frame, an axis or the origin, by the turn
    and the slide of its body."""
    x, y, z = frame[:3, column]
    rates = np.zeros((3, 6))
    rates[:, :3] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    if column == ORIGIN_COLUMN:
        rates[:, 3:] = np.eye(3)
    return rates


def _difference(one: np.ndarray, other: np.ndarray, column: int) -> Rows:
    """A column of the second frame less that of the first one."""
    difference = other[:3, column] - one[:3, column]
    return Rows(difference, -_rates(one, column), _rates(other, column))


def _along(one: np.ndarray, other: np.ndarray, column: int) -> Rows:
    """How far the second origin is from the first one along an axis of the first
    frame."""
    axis = one[:3, column]
    gap, by_first, by_second = _difference(one, other, ORIGIN_COLUMN)
    by_first = gap @ _rates(one, column) + axis @ by_first
    return Rows(np.array([axis @ gap]), by_first[None], (axis @ by_second)[None])


def _angle(one: np.ndarray, other: np.ndarray, cosine: float) -> Rows:
    """The cosine between the third axes, less what it has to be."""
    first, second = one[:3, 2], other[:3, 2]
    by_first, by_second = second @ _rates(one, 2), first @ _rates(other, 2)
    return Rows(np.array([first @ second - cosine]), by_first[None], by_second[None])


# --- random poses ---------------------------------------------------------------------


class Starts:
    """Poses of an ``assembly`` in which the joints of a spanning tree fit, with random
    variables; slides without limits are within ``size`` of 0."""

    def __init__(self, assembly: Assembly, size: float):
        self.assembly = assembly
        self.size = size
        graph = nx.MultiGraph()
        for joint in assembly.joints:
            graph.add_edge(*joint.bodies, joint=joint)
        # a joint to every body, from the first one on
        self._tree: list[tuple[str, BodyJoint]] = [
            (start, next(iter(graph[start][end].values()))["joint"])
            for start, end in nx.bfs_edges(graph, assembly.bodies[0])
        ]

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """Poses (b, 4, 4); the first body is at rest."""
        poses = np.tile(np.eye(4), (len(self.assembly.bodies), 1, 1))
        for start, joint in self._tree:
            first, second = (self.assembly.numbers[body] for body in joint.bodies)
            own, far = joint.frames
            motion = own @ self._motion(joint, rng) @ np.linalg.inv(far)
            if start == joint.bodies[0]:
                poses[second] = poses[first] @ motion
            else:
                poses[first] = poses[second] @ np.linalg.inv(motion)
        return poses

    def _motion(self, joint: BodyJoint, rng: np.random.Generator) -> np.ndarray:
        """A random motion (4, 4) of the second frame in the first one."""
        from scipy.spatial.transform import Rotation

        motion = np.eye(4)
        if joint.kind is JointKind.UNIVERSAL:
            first, second = (turn(_random_angle(rng, None)) for _ in range(2))
            motion[:3, :3] = first @ _tilt(joint.cosine) @ second
        elif joint.kind is JointKind.SPHERICAL:
            motion[:3, :3] = Rotation.random(rng=rng).as_matrix()
        elif joint.kind is not JointKind.HELICAL:
            limits = [*joint.limits, None, None, None]
            for move, pair in zip(joint.kind.facets.moves, limits, strict=False):
                if move is Move.TURN:
                    motion[:3, :3] = turn(_random_angle(rng, pair))
                else:
                    low, high = pair or (-self.size, self.size)
                    motion[move.value, 3] = rng.uniform(low, high)
        return motion


def _random_angle(rng: np.random.Generator, limits: Limits | None) -> float:
    low, high = limits or (-math.pi, math.pi)
    return float(rng.uniform(low, high))


def turn(angle: float) -> np.ndarray:
    """The rotation (3, 3) about the third axis."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _tilt(cosine: float) -> np.ndarray:
    """The rotation (3, 3) about the first axis by an angle of this cosine."""
    sine = math.sqrt(max(0.0, 1 - cosine**2))
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
