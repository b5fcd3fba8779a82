"""From an assembly to a mechanism: a closed configuration, and which bodies are one."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace

import networkx as nx
import numpy as np

from linkages.decisions import (
    is_closed_as_it_stands,
    is_file_closed,
    is_file_nearly_closed,
    is_rounding_of_zero,
)
from linkages.formats.assembly import Assembly, BodyJoint, listed
from linkages.formats.closing import ClosedPoses, Closing, Starts
from linkages.formats.joint_values import joint_values, limits_left
from linkages.formats.tree_closing import TreeClosing
from linkages.mechanisms.couplings import Coupling, leaders
from linkages.mechanisms.joint import Joint, JointKind, Vector
from linkages.mechanisms.mechanism import FRAMES, Mechanism
from linkages.values import GeometryError, require

log = logging.getLogger(__name__)

MOST_STARTS = 50  # random starts until one closes within the limits
SEED = 0


def mechanism_of_assembly(assembly: Assembly) -> Mechanism:
    """The mechanism of an ``assembly``, in a closed configuration: the one that the
    file gives, the nearest to it, or where it gives none, one from random starts.

    Bodies that are rigid with each other become one. What was left out or moved is said
    in the log. Raises `GeometryError` where no joint is left, or where they do not fit.
    """
    notes = list(assembly.notes)
    closed = _closed(assembly)
    if not is_file_closed(closed.gap):
        notes.append(
            f"closure gap {closed.gap * closed.size:.2g}: the joints do not fit "
            "exactly, and each is put halfway between its bodies"
        )
    names = _merged_bodies(assembly, notes)
    joints = []
    values: dict[str, float] = {}
    for joint in assembly.joints:
        bodies = tuple(names[body] for body in joint.bodies)
        if bodies[0] == bodies[1]:
            continue
        frames = assembly.placed(joint, closed.poses)
        joints.append(_placed(joint, bodies, *frames))
        values |= zip(joint.labels, joint_values(joint, *frames), strict=False)
    allowed = "one with a joint that can move"
    require(len(joints) > 0, "mechanism", "rigid: no joint is left", allowed)
    joints = _coupled(joints, assembly, values, notes)
    for note in notes:
        log.warning("%s: %s", assembly.name, note)
    labels = {label for joint in joints for label in joint.labels}
    return Mechanism(
        tuple(joints),
        assembly.name,
        origin=assembly.origin,
        rounding=assembly.rounding,
        motors=tuple(motor for motor in assembly.motors if motor in labels),
    )


# --- bodies that are one --------------------------------------------------------------


def _merged_bodies(assembly: Assembly, notes: list[str]) -> dict[str, str]:
    """The name of the body that each body is one with."""
    rigid = [joint for joint in assembly.joints if joint.kind is JointKind.RIGID]
    between = [joint for joint in assembly.joints if joint.kind is not JointKind.RIGID]
    graph = nx.MultiGraph()
    graph.add_nodes_from(assembly.bodies)
    graph.add_edges_from(joint.bodies for joint in rigid)
    names = _names_of_parts(graph, assembly.bodies)
    inside = [j.name for j in between if names[j.bodies[0]] == names[j.bodies[1]]]
    if inside:
        notes.append(f"left out, as their bodies are one: joints {listed(inside)}")
    return names


def _names_of_parts(graph: nx.MultiGraph, order: Iterable[str]) -> dict[str, str]:
    """For every body the name of its part of the graph: that of a frame, or the first
    one in this order."""
    rank = {body: k for k, body in enumerate(order)}
    names = {}
    for part in nx.connected_components(graph):
        frames = [body for body in FRAMES if body in part]
        name = frames[0] if frames else min(part, key=rank.__getitem__)
        names.update(dict.fromkeys(part, name))
    return names


# --- a closed configuration -----------------------------------------------------------


def _closed(assembly: Assembly) -> ClosedPoses:
    """Poses in which the joints fit; raises `GeometryError` where there are none.

    The bodies in loops are closed by themselves, and what hangs on them follows.
    """
    graph = nx.MultiGraph()
    graph.add_nodes_from(assembly.bodies)
    for joint in assembly.joints:
        graph.add_edge(*joint.bodies, key=joint.name)
    core = {body for pair in _doubled(graph) for body in pair}
    core |= set(nx.k_core(nx.Graph(graph), 2))
    if not assembly.poses or not core:
        return _closed_at_once(assembly)
    bodies = tuple(body for body in assembly.bodies if body in core)
    joints = tuple(one for one in assembly.joints if core.issuperset(one.bodies))
    closed = _closed_at_once(replace(assembly, bodies=bodies, joints=joints))
    poses = dict(zip(bodies, closed.poses, strict=True))
    every = _with_branches(assembly, poses, nx.Graph(graph))
    return replace(closed, poses=every)


def _with_branches(
    assembly: Assembly, poses: dict[str, np.ndarray], graph: nx.Graph
) -> np.ndarray:
    """The poses (b, 4, 4) of all bodies, where those in loops have ``poses`` and the
    others stand as they are given with respect to those on which they hang."""
    ways = nx.multi_source_dijkstra_path(graph, set(poses))
    for body in sorted(ways, key=lambda one: len(ways[one])):
        if body not in poses:
            before = ways[body][-2]
            moved = poses[before] @ np.linalg.inv(assembly.poses[before])
            poses[body] = moved @ assembly.poses[body]
    return np.array([poses.get(b, assembly.poses[b]) for b in assembly.bodies])


def _doubled(graph: nx.MultiGraph) -> list[tuple[str, str]]:
    """The pairs of bodies that several joints join."""
    return [(a, b) for a, b in nx.Graph(graph).edges if graph.number_of_edges(a, b) > 1]


def _closed_at_once(assembly: Assembly) -> ClosedPoses:
    """The same, all joints together."""
    closing = Closing(assembly)
    if assembly.poses:
        given = np.array([assembly.poses[body] for body in assembly.bodies])
        closed = closing.measure(given)
        if not is_file_nearly_closed(closed.gap):
            closed = TreeClosing(assembly).closed()
        is_worth_it = is_file_nearly_closed(closed.gap)
        if is_worth_it and not is_closed_as_it_stands(closed.gap):
            closed = closing.close(closed.poses)
    else:
        closed = _from_random_starts(assembly, closing)
    gap = f"{closed.gap * closed.size:.3g}"
    value = f"open by up to {gap}, at {listed(closing.missing(closed.poses))},"
    is_closed = is_file_nearly_closed(closed.gap)
    require(is_closed, "mechanism", value, "one that can be closed")
    return closed


def _from_random_starts(assembly: Assembly, closing: Closing) -> ClosedPoses:
    """The first closed poses within the limits of the joints, or the best ones."""
    rng = np.random.default_rng(SEED)
    starts = Starts(assembly, closing.size)
    best: ClosedPoses | None = None
    is_met = False
    for _ in range(MOST_STARTS):
        closed = closing.close(starts.draw(rng))
        within = not limits_left(assembly, closed.poses)
        if within and is_file_closed(closed.gap):
            return closed
        is_met = is_met or is_file_closed(closed.gap)
        if within and (best is None or closed.gap < best.gap):
            best = closed
    if best is None or (is_met and not is_file_closed(best.gap)):
        value = f"outside them in all configurations of {MOST_STARTS} random starts"
        raise GeometryError("limits of the joints", value, "met by a configuration")
    return best


# --- couplings ------------------------------------------------------------------------


def _coupled(
    joints: list[Joint],
    assembly: Assembly,
    values: Mapping[str, float],
    notes: list[str],
) -> list[Joint]:
    """The ``joints`` with the couplings of an assembly. ``values``, by label, are those
    of the file where the variables of the joints are 0.

    Variables that follow one that is left out follow the first of them.
    """
    couplings = {
        label: coupling
        for joint in assembly.joints
        for label, coupling in joint.coupled.items()
    }
    if not couplings:
        return joints
    kept = {label for joint in joints for label in joint.labels}
    labels = sorted({*couplings, *(one.to for one in couplings.values())} - kept)
    labels += sorted(kept)
    found = dict(zip(labels, leaders(labels, couplings), strict=True))
    first_of: dict[int, str] = {
        labels.index(label): label for label in kept - {*couplings}
    }
    result: dict[str, Coupling] = {}
    for label in couplings:
        if label not in kept:
            notes.append(f"left out: the coupling of {label}, whose bodies are one")
            continue
        own = found[label]
        to = first_of.setdefault(own.number, label)
        if to == label:
            notes.append(f"left out: the coupling of {label} to what is left out")
            continue
        ratio = own.ratio / found[to].ratio
        offset = own.offset - ratio * found[to].offset
        offset += ratio * values[to] - values[label]
        if is_rounding_of_zero(abs(offset)):
            offset = 0.0
        result[label] = Coupling(to, ratio, offset)
    return [
        replace(joint, coupled=tuple(result.get(label) for label in joint.labels))
        for joint in joints
    ]


# --- joints ---------------------------------------------------------------------------


def _placed(
    joint: BodyJoint, bodies: tuple[str, ...], first: np.ndarray, second: np.ndarray
) -> Joint:
    """The joint with its frames (4, 4) at these places, halfway between them."""
    middle = (first[:3] + second[:3]) / 2
    values = joint_values(joint, first, second)
    limits = [
        None if pair is None else (pair[0] - value, pair[1] - value)
        for pair, value in zip(joint.limits, values, strict=False)
    ]
    locked = [
        None if lock is None else lock - value
        for lock, value in zip(joint.locked, values, strict=False)
    ]
    direction, second_direction = _vector(middle[:, 2]), None
    if joint.kind is JointKind.UNIVERSAL:
        direction, second_direction = _vector(first[:3, 2]), _vector(second[:3, 2])
    elif joint.kind is JointKind.PLANAR:
        second_direction = _vector(first[:3, 0])
    return Joint(
        joint.name,
        joint.kind,
        bodies,
        point=_vector(middle[:, 3]) if joint.kind is not JointKind.RIGID else None,
        direction=direction if "direction" in joint.kind.facets.required else None,
        second_direction=second_direction,
        pitch=joint.pitch,
        limits=tuple(limits),
        locked=tuple(locked),
    )


def _vector(numbers: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in numbers)
    return (x, y, z)
