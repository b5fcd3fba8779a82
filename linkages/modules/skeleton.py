"""A mechanism on a sphere or in a plane with links in the place of which rods do.

A body that two turning joints hold keeps two points of others at a distance. With rods
in the place of some such bodies fewer angles are unknown; the others follow.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import networkx as nx
import numpy as np

from linkages.decisions import is_parallel_axis, meets_in_one_point
from linkages.dyads.space import SpaceGeometry, SpacePose
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.placement import Placement
from linkages.structure.structure import Structure


class Link(NamedTuple):
    """A ``body`` in the place of which a rod is, and the ``joints`` (names) that hold
    it."""

    body: str
    joints: tuple[str, str]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The mechanism of ``full`` with rods in the place of ``links``."""

    full: Structure
    structure: Structure
    links: tuple[Link, ...] = ()

    @staticmethod
    def of(full: Structure, held: Collection[int] = ()) -> Skeleton:
        """That of a structure in which some unknowns, by number, are held: all moves as
        it is where it does not turn in a plane or on a sphere."""
        mechanism = full.mechanism
        variables = mechanism.variables
        motions = [one.motion for one in variables if one.locked != 0.0]
        is_free = any(pair.center is not None for pair in mechanism.pairs)
        if (
            is_free
            or mechanism.is_coupled
            or not all(one.is_turn and one.advance == 0.0 for one in motions)
        ):
            return Skeleton(full, full)
        placement = Placement.of_chain(motions, full.unit)
        if not (placement.is_spherical or placement.is_planar):
            return Skeleton(full, full)
        ends = {
            joint.name: _end(placement, joint)
            for joint in mechanism.joints
            if joint.kind is JointKind.REVOLUTE
        }
        links = tuple(
            link
            for link in _links(full, held)
            if all(name in ends for name in link.joints)
            and _are_apart(placement, *(ends[name] for name in link.joints))
        )
        if not links:
            return Skeleton(full, full)
        return Skeleton(full, Structure(_with_rods(mechanism, links, ends)), links)

    def held(self, column: int) -> int | None:
        """The unknown, by number, that one of the full structure is; None where there is
        none."""
        if not self.links:
            return column
        full = self.full.mechanism
        number = self.full.unknowns[column].variable
        pair = next(one for one in full.pairs if number in one.variables)
        for other in self.structure.mechanism.pairs:
            is_same = (other.joint, other.base, other.moved) == pair[:3]
            if is_same and other.variables:
                return self.structure.column_of.get(other.variables[0])
        return None

    # --- back to the full structure ---------------------------------------------------

    def unknowns(self, point: np.ndarray) -> np.ndarray:
        """The unknowns (n,) of the full structure where those of this one are at a
        ``point`` (m,)."""
        if not self.links:
            return point
        poses = self._poses(point)
        result = np.zeros(len(self.full.unknowns))
        mechanism = self.full.mechanism
        for pair in mechanism.pairs:
            for number in pair.variables:
                share = self.full.share(number)
                if share is not None:
                    relative = poses[pair.base].inverse().after(poses[pair.moved])
                    motion = mechanism.variables[number].motion
                    result[share.column] = self._geometry.value(relative, motion)
        return result

    @cached_property
    def _geometry(self) -> SpaceGeometry:
        return SpaceGeometry(self.full.unit)

    @cached_property
    def _placement(self) -> Placement:
        variables = self.full.mechanism.variables
        motions = [one.motion for one in variables if one.locked != 0.0]
        return Placement.of_chain(motions, self.full.unit)

    def _poses(self, point: np.ndarray) -> dict[str, SpacePose]:
        """Those of all bodies."""
        structure, geometry = self.structure, self._geometry
        mechanism = structure.mechanism
        poses = {mechanism.frame: geometry.rest}
        pending = [pair for pair in mechanism.pairs if pair.center is None]
        while pending:
            pair = pending.pop(0)
            step = geometry.rest
            for number in pair.variables:
                value = float(structure.values(point[None], number)[0])
                motion = mechanism.variables[number].motion
                step = step.after(geometry.motion(motion, value))
            if pair.base in poses:
                poses.setdefault(pair.moved, poses[pair.base].after(step))
            elif pair.moved in poses:
                poses[pair.base] = poses[pair.moved].after(step.inverse())
            else:
                pending.append(pair)
        return poses | {link.body: self._link_pose(link, poses) for link in self.links}

    def _link_pose(self, link: Link, poses: Mapping[str, SpacePose]) -> SpacePose:
        """That of a link, from the ``poses`` of the other bodies."""
        own, standing = [], []
        for name in link.joints:
            joint = self.full.mechanism.joint(name)
            other = next(body for body in joint.bodies if body in poses)
            end = _end(self._placement, joint)
            own.append(end)
            standing.append(poses[other](end))
        return self._pose(own, standing)

    def _pose(
        self, own: Sequence[np.ndarray], standing: Sequence[np.ndarray]
    ) -> SpacePose:
        """That of a link from its two points."""
        placement = self._placement
        fixed = placement.origin
        if placement.is_planar:
            fixed, across = own[0], placement.axes[2]
            before = _frame(own[1] - own[0], across)
            after = _frame(standing[1] - standing[0], across)
            rotation = after @ before.T
            return SpacePose(rotation, standing[0] - rotation @ own[0])
        before = _frame(own[0] - fixed, own[1] - fixed)
        after = _frame(standing[0] - fixed, standing[1] - fixed)
        rotation = after @ before.T
        return SpacePose(rotation, fixed - rotation @ fixed)


def _frame(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Unit vectors (3, 3), in columns: along the first one, and across it towards the
    second one."""
    first = first / np.linalg.norm(first)
    second = second - (second @ first) * first
    second = second / np.linalg.norm(second)
    return np.array([first, second, np.cross(first, second)]).T


def _end(placement: Placement, joint: Joint) -> np.ndarray:
    """The end (3,) of rods on the axis of a joint."""
    motion = joint.motions[0]
    end: np.ndarray
    if placement.is_spherical:
        end = placement.origin + placement.unit * motion.direction
        return end
    normal = placement.axes[2]
    end = motion.point - normal * (normal @ (motion.point - placement.origin))
    return end


def _are_apart(placement: Placement, first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two ends of a rod leave a link no freedom: it does not turn about both."""
    if placement.is_planar:
        gap = float(np.linalg.norm(second - first))
        return not meets_in_one_point(gap, placement.unit)
    one, other = first - placement.origin, second - placement.origin
    sine = float(np.linalg.norm(np.cross(one, other)))
    return not is_parallel_axis(sine, placement.unit**2)


# --- which links ----------------------------------------------------------------------


def _links(full: Structure, held: Collection[int]) -> tuple[Link, ...]:
    """The bodies in the place of which rods are: such that the others hang together and
    hold the ends of all rods."""
    mechanism = full.mechanism
    standing = {mechanism.frame}
    for pair in mechanism.pairs:
        columns = {full.column_of.get(number) for number in pair.variables}
        if columns & {None, *held}:
            standing |= {pair.base, pair.moved}
    graph = nx.Graph(
        (("joint", joint.name), ("body", body))
        for joint in mechanism.joints
        for body in joint.bodies
    )
    counts = Counter(body for joint in mechanism.joints for body in joint.bodies)
    links = []
    for body in mechanism.bodies:
        node = ("body", body)
        if body in standing or counts[body] != 2:
            continue
        joints = [name for _, name in graph[node]]
        rest = graph.copy()
        rest.remove_node(node)
        if min(rest.degree(("joint", name)) for name in joints) > 0 and nx.is_connected(
            rest
        ):
            graph = rest
            links.append(Link(body, (joints[0], joints[1])))
    return tuple(links)


def _with_rods(
    mechanism: Mechanism, links: Sequence[Link], ends: dict[str, np.ndarray]
) -> Mechanism:
    bodies = {link.body for link in links}
    joints = []
    for joint in mechanism.joints:
        left = tuple(body for body in joint.bodies if body not in bodies)
        if len(left) > 1:
            # what is locked, and its base, are no links
            rows = zip(joint.bodies[1:], joint.locked, strict=False)
            locked = tuple(value for body, value in rows if body in left)
            if joint.bodies[0] not in left:
                locked = ()
            joints.append(
                replace(joint, bodies=left, locked=locked, limits=(), coupled=())
            )
        for body in joint.bodies:
            if body in bodies:
                x, y, z = ends[joint.name].tolist()
                name = f"{joint.name} of {body}"
                joints.append(
                    Joint(name, JointKind.SPHERICAL, (left[0], body), (x, y, z))
                )
    return Mechanism(tuple(joints), with_flaps=True)
