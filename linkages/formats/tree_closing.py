"""Poses in which the joints of an assembly fit, found in the variables of a spanning tree
of its joints.

The joints of the tree fit whatever their variables are, and the equations are those of
the others, which close the loops (Featherstone 2008, chapter 8). There are far fewer
unknowns than freedoms of bodies, and no joint comes apart on the way: so mechanisms are
closed that are drawn far from closed. Variables that are coupled move together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import networkx as nx
import numpy as np

from linkages.decisions import is_file_nearly_closed
from linkages.formats.assembly import BodyJoint
from linkages.formats.closing import ClosedPoses, Closing, Rows, turn
from linkages.formats.joint_values import joint_values, limits_left
from linkages.mechanisms.couplings import Coupling, leaders
from linkages.mechanisms.joint import Fit, JointKind, Move

MOST_STARTS = 12
FARTHEST = (
    2.0  # rad, or sizes: how wide the last starts are drawn about the given poses
)
SEED = 0
SMALL = 1e-4  # rad: where a function is its series
OF_BALL = 3  # freedoms of a spherical joint


@dataclass(frozen=True, eq=False)
class _Branch:
    """A joint of the tree: ``body`` hangs on ``base`` by it. Its variables have these
    ``columns`` of all, and ``sign`` is -1 where they move the base with respect to the
    body."""

    joint: BodyJoint
    base: int
    body: int
    columns: slice
    sign: float


class TreeClosing(Closing):
    """The equations of an ``assembly`` with poses in the variables of a spanning tree:
    of the joints that fit best there. Steps are those of variables that follow none."""

    def closed(self) -> ClosedPoses:
        """Closed poses next to those of the assembly, or, where none within limits are
        found from there, from starts about them, drawn wider and wider; the best ones
        where there are none."""
        return min(self._tries(), key=self._lack)

    def _tries(self) -> Iterator[ClosedPoses]:
        """What each start leads to, up to the first that lacks nothing."""
        rng = np.random.default_rng(SEED)
        given = self._stepped(self._given, self._to_couplings(self._given))
        for number in range(MOST_STARTS):
            spread = FARTHEST * number / MOST_STARTS
            step = np.array(spread * rng.normal(size=self._led.shape[1]))
            start = self._moved(given, step)
            start[:, :3, 3] *= self.size
            closed = self.close(start)
            yield closed
            if self._lack(closed) == (0.0, 0):
                return

    def _lack(self, closed: ClosedPoses) -> tuple[float, int]:
        """The gap, 0 where that is from rounding, and how many variables are outside
        their limits."""
        gap = 0.0 if is_file_nearly_closed(closed.gap) else closed.gap
        return gap, len(limits_left(self.assembly, closed.poses))

    # --- the tree ---------------------------------------------------------------------

    @cached_property
    def _given(self) -> np.ndarray:
        """The poses (b, 4, 4) of the assembly, lengths over the size."""
        poses = np.array([self.assembly.poses[body] for body in self.assembly.bodies])
        poses[:, :3, 3] /= self.size
        return poses

    @cached_property
    def _tree(self) -> tuple[_Branch, ...]:
        assembly = self.assembly
        misfits = self._misfits(self._given)
        graph = nx.MultiGraph()
        graph.add_nodes_from(assembly.bodies)
        for joint in assembly.joints:
            graph.add_edge(*joint.bodies, key=joint.name, weight=misfits[joint.name])
        tree = nx.minimum_spanning_tree(graph)
        by_name = {joint.name: joint for joint in assembly.joints}
        branches: list[_Branch] = []
        for base, body in nx.bfs_edges(tree, assembly.bodies[0]):
            joint = by_name[next(iter(tree[base][body]))]
            start = branches[-1].columns.stop if branches else 0
            columns = slice(start, start + _freedoms(joint))
            sign = 1.0 if base == joint.bodies[0] else -1.0
            ends = assembly.numbers[base], assembly.numbers[body]
            branches.append(_Branch(joint, *ends, columns, sign))
        return tuple(branches)

    @cached_property
    def _labels(self) -> list[str]:
        """What the variables of the tree are called; the turns of a ball have no label of
        their own."""
        labels = []
        for branch in self._tree:
            joint = branch.joint
            own = list(joint.labels)
            if joint.kind is JointKind.SPHERICAL:
                own = [f"{joint.name}/{k}" for k in range(OF_BALL)]
            labels += own
        return labels

    @cached_property
    def _led(self) -> np.ndarray:
        """How far each variable (n, k) moves with those that follow none."""
        couplings = {
            label: coupling
            for branch in self._tree
            for label, coupling in branch.joint.coupled.items()
            if coupling.to in self._labels
        }
        rows = leaders(self._labels, couplings)
        matrix = np.zeros((len(rows), len(rows)))
        for row, leader in enumerate(rows):
            matrix[row, leader.number] = leader.ratio
        return matrix[:, np.abs(matrix).any(axis=0)]

    def _to_couplings(self, poses: np.ndarray) -> np.ndarray:
        """The steps (n,) of all variables after which those that follow others are where
        they have to be."""
        values: dict[str, float] = {}
        couplings: dict[str, Coupling] = {}
        for branch in self._tree:
            joint = branch.joint
            placed = self._frames(joint, poses)
            values |= zip(joint.labels, joint_values(joint, *placed), strict=False)
            couplings |= joint.coupled
        steps = np.zeros(len(self._labels))
        for label, coupling in couplings.items():
            if coupling.to in values:
                target = coupling.ratio * values[coupling.to] + coupling.offset
                steps[self._labels.index(label)] = target - values[label]
        return steps

    # --- equations --------------------------------------------------------------------

    @cached_property
    def _closing_joints(self) -> list[BodyJoint]:
        inside = {branch.joint.name for branch in self._tree}
        return [one for one in self.assembly.joints if one.name not in inside]

    def _system(self, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (m,) of the joints that close loops, and their derivatives (m, k)."""
        screws = self._screws(poses)
        residuals, blocks = [np.empty(0)], [np.empty((0, screws.shape[1]))]
        for joint in self._closing_joints:
            first, second = (self.assembly.numbers[body] for body in joint.bodies)
            rows = self._rows(joint, poses[first], poses[second])
            by_first = rows.by_first @ (screws * self._carries[first])
            by_second = rows.by_second @ (screws * self._carries[second])
            residuals.append(rows.residuals)
            blocks.append(by_first + by_second)
        return np.concatenate(residuals), np.concatenate(blocks) @ self._led

    def _rows(self, joint: BodyJoint, first: np.ndarray, second: np.ndarray) -> Rows:
        """The equations of a joint, with the vector of the rotation between frames that
        have to agree: the difference of axes does not change to first order where they
        are half a turn apart."""
        facets = joint.kind.facets
        if not {Fit.AXIS, Fit.TURN} <= set(facets.fit):
            return super()._rows(joint, first, second)
        place = [fit for fit in facets.fit if fit not in (Fit.AXIS, Fit.TURN)]
        own, far = self._scaled(joint)
        one, other = first @ own, second @ far
        parts = [*self._parts(place, one, other), _rotation(one, other)]
        return Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    @cached_property
    def _carries(self) -> np.ndarray:
        """By which variables every body (b, n) moves: 1, or -1 where they move what it
        hangs on with respect to it; else 0."""
        carries = np.zeros((len(self.assembly.bodies), len(self._labels)))
        for branch in self._tree:
            carries[branch.body] = carries[branch.base]
            carries[branch.body, branch.columns] = branch.sign
        return carries

    def _screws(self, poses: np.ndarray) -> np.ndarray:
        """The turn and the slide (6, n) of the second body of a joint by each variable."""
        screws = [np.empty((0, 6))]
        for branch in self._tree:
            if branch.columns.stop > branch.columns.start:
                screws.append(_screws(branch.joint, *self._frames(branch.joint, poses)))
        return np.concatenate(screws).T

    def _moved(self, poses: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self._stepped(poses, self._led @ step)

    def _stepped(self, poses: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The ``poses`` after a ``step`` (n,) of all variables of the tree."""
        moved = poses.copy()
        for branch in self._tree:
            one, other = self._frames(branch.joint, poses)
            motion = _inverse(one) @ other
            motion = _after(branch.joint, motion, step[branch.columns])
            own, far = self._scaled(branch.joint)
            across = own @ motion @ _inverse(far)
            if branch.sign < 0:
                across = _inverse(across)
            moved[branch.body] = moved[branch.base] @ across
        return moved

    def _frames(
        self, joint: BodyJoint, poses: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Both frames (4, 4) of a joint, lengths over the size."""
        own, far = self._scaled(joint)
        first, second = (self.assembly.numbers[body] for body in joint.bodies)
        return poses[first] @ own, poses[second] @ far


# --- joints ---------------------------------------------------------------------------


def _rotation(one: np.ndarray, other: np.ndarray) -> Rows:
    """The vector of the rotation from the first frame to the second one."""
    from scipy.spatial.transform import Rotation

    vector = Rotation.from_matrix(one[:3, :3].T @ other[:3, :3]).as_rotvec()
    angle = float(np.linalg.norm(vector))
    # the derivative of the vector by turns in the second frame (Chirikjian 2012, 10.86)
    x, y, z = vector
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    square = (
        1 / 12 if angle < SMALL else (1 - angle / 2 / math.tan(angle / 2)) / angle**2
    )
    rates = (np.eye(3) + cross / 2 + square * (cross @ cross)) @ other[:3, :3].T
    rates = np.hstack([rates, np.zeros((3, 3))])
    return Rows(vector, -rates, rates)


def _inverse(frame: np.ndarray) -> np.ndarray:
    """The inverse (4, 4) of a rigid motion."""
    result = np.eye(4)
    result[:3, :3] = frame[:3, :3].T
    result[:3, 3] = -result[:3, :3] @ frame[:3, 3]
    return result


def _freedoms(joint: BodyJoint) -> int:
    if joint.kind is JointKind.SPHERICAL:
        return OF_BALL
    return len(joint.kind.facets.moves)


def _screws(joint: BodyJoint, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The turn and the slide (k, 6) of the second body, whose frame is the ``other``, by
    each variable."""
    if joint.kind is JointKind.SPHERICAL:
        return np.array([_turning(other, column) for column in range(OF_BALL)])
    rows = []
    for move in joint.kind.facets.moves:
        if move is Move.TURN:
            frame = one if joint.kind is JointKind.UNIVERSAL else other
            row = _turning(frame, 2)
            row[3:] += _advance(joint) * frame[:3, 2]
        elif move is Move.SECOND_TURN:
            row = _turning(other, 2)
        else:
            row = np.concatenate([np.zeros(3), one[:3, move.value]])
        rows.append(row)
    return np.array(rows).reshape(-1, 6)


def _turning(frame: np.ndarray, column: int) -> np.ndarray:
    """The turn about an axis of a frame, by its number, and the slide that this is of
    what is at the origin."""
    axis = frame[:3, column]
    return np.concatenate([axis, np.cross(frame[:3, 3], axis)])


def _advance(joint: BodyJoint) -> float:
    return (joint.pitch or 0.0) / (2 * math.pi)


def _after(joint: BodyJoint, motion: np.ndarray, step: np.ndarray) -> np.ndarray:
    """A ``motion`` (4, 4) of the second frame in the first one after a step of the
    variables."""
    from scipy.spatial.transform import Rotation

    motion = motion.copy()
    if joint.kind is JointKind.SPHERICAL:
        motion[:3, :3] = motion[:3, :3] @ Rotation.from_rotvec(step).as_matrix()
        return motion
    for move, change in zip(joint.kind.facets.moves, step, strict=True):
        if move is Move.TURN and joint.kind is JointKind.UNIVERSAL:
            motion[:3] = turn(change) @ motion[:3]
        elif move in (Move.TURN, Move.SECOND_TURN):
            motion[:3, :3] = motion[:3, :3] @ turn(change)
            motion[2, 3] += _advance(joint) * change
        else:
            motion[move.value, 3] += change
    return motion
