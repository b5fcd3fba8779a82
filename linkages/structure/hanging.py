"""What hangs on a mechanism: joints that lie in no closed loop, and what they carry.

In the graph of bodies and pairs they are the bridges. Nothing closes over such a joint,
so that the configurations are those of the loops times all that it can do. It is held
where it is drawn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import networkx as nx

from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism, Variable

OF_BALL = 3  # freedoms of a spherical joint
ROTATIONS = "all rotations"


@dataclass(frozen=True)
class HangingJoint:
    """A ``joint`` in no closed loop: by it the first of the ``bodies`` hangs on
    ``base``, and the others on the first. Its ``freedoms`` are its own; ``verb`` says
    what it does, ``limited`` whether within limits, and ``spaces`` over what each of its
    free variables runs. ``variables`` are their labels, none of a spherical joint."""

    joint: str
    base: str
    bodies: tuple[str, ...]
    freedoms: int
    variables: tuple[str, ...]
    verb: str
    limited: bool
    spaces: tuple[str, ...]


class Hanging:
    """What hangs on a ``mechanism``."""

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism

    @cached_property
    def _graph(self) -> nx.MultiGraph:
        """The bodies, and an edge for every pair, by its number. A joint of several
        bodies joins them to one that is in a loop with another of them, from whichever
        its angles are measured."""
        mechanism = self.mechanism
        incidence = nx.Graph(
            (joint.name, (body,)) for joint in mechanism.joints for body in joint.bodies
        )
        bridges = {frozenset(edge) for edge in nx.bridges(incidence)}
        centers = {
            joint.name: next(
                (b for b in joint.bodies if {joint.name, (b,)} not in bridges),
                joint.bodies[0],
            )
            for joint in mechanism.joints
        }
        graph = nx.MultiGraph()
        graph.add_nodes_from(mechanism.bodies)
        for number, pair in enumerate(mechanism.pairs):
            center = centers[pair.joint]
            other = pair.base if pair.moved == center else pair.moved
            graph.add_edge(center, other, key=number)
        return graph

    @cached_property
    def pairs(self) -> dict[int, tuple[str, str]]:
        """The pairs in no closed loop, by number: the body that is nearer to the loops,
        and the one that hangs on it."""
        graph = self._graph
        # parallel edges are no bridges
        bridges = {frozenset(edge) for edge in nx.bridges(graph)}
        ends = {
            number: (first, second)
            for first, second, number in graph.edges(keys=True)
            if frozenset((first, second)) in bridges
        }
        in_loops = [
            body for body in self.mechanism.bodies if self._is_in_loop(body, ends)
        ]
        frame = self.mechanism.frame
        root = frame if frame in in_loops or not in_loops else in_loops[0]
        away = nx.single_source_shortest_path_length(graph, root)
        return {
            number: (first, second) if away[first] < away[second] else (second, first)
            for number, (first, second) in sorted(ends.items())
        }

    def _is_in_loop(self, body: str, bridges: Mapping[int, tuple[str, str]]) -> bool:
        """Whether a pair of the body is none of the ``bridges``."""
        edges = self._graph.edges(body, keys=True)
        return any(number not in bridges for _, _, number in edges)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The free variables that move nothing but what hangs, of those coupled to each
        other the one that the others follow."""
        mechanism = self.mechanism
        here = {k for number in self.pairs for k in mechanism.pairs[number].variables}
        led: dict[int, set[int]] = {}
        for number, variable in enumerate(mechanism.variables):
            led.setdefault(variable.leader.number, set()).add(number)
        return tuple(
            mechanism.variables[leader].label
            for leader, followers in led.items()
            if followers <= here and mechanism.variables[leader].locked is None
        )

    @property
    def held(self) -> Mechanism:
        """The mechanism with all that hangs held in the reference configuration, or as
        near to it as limits allow."""
        if not self.pairs:
            return self.mechanism
        values = {}
        for variable in self._free:
            low, high = variable.limits or (0.0, 0.0)
            values[variable.label] = min(max(0.0, low), high)
        joints = [
            held
            for joint in self.mechanism.joints
            for held in self._without_turns(joint)
        ]
        return replace(self.mechanism, joints=tuple(joints)).with_locks(values)

    @property
    def _free(self) -> list[Variable]:
        return [one for one in self.mechanism.variables if one.label in self.labels]

    def _without_turns(self, joint: Joint) -> list[Joint]:
        """A spherical joint at which bodies hang as one joint for each of its bodies,
        rigid for those; any other one as it is."""
        pairs = [
            (number, pair)
            for number, pair in enumerate(self.mechanism.pairs)
            if pair.joint == joint.name
        ]
        hangs = [number in self.pairs for number, _ in pairs]
        if joint.kind is not JointKind.SPHERICAL or not any(hangs):
            return [joint]
        joints = []
        for (_, pair), is_hanging in zip(pairs, hangs, strict=True):
            name = joint.name if len(pairs) == 1 else f"{joint.name}.{pair.moved}"
            ends = (pair.base, pair.moved)
            one = replace(
                joint, name=name, bodies=ends, limits=(), locked=(), coupled=()
            )
            rigid = Joint(name, JointKind.RIGID, ends)
            joints.append(rigid if is_hanging else one)
        return joints

    @cached_property
    def joints(self) -> tuple[HangingJoint, ...]:
        """The joints that hang and are free, in the order of the mechanism."""
        found = []
        for number, (base, moved) in self.pairs.items():
            pair = self.mechanism.pairs[number]
            own = [self.mechanism.variables[k] for k in pair.variables]
            free = [one for one in own if one.label in self.labels]
            is_ball = pair.center is not None
            if not free and not is_ball:
                continue
            one = HangingJoint(
                pair.joint,
                base,
                self._carried(base, moved),
                OF_BALL if is_ball else len(free),
                tuple(variable.label for variable in free),
                _verb(free),
                any(variable.limits for variable in free),
                (ROTATIONS,) if is_ball else tuple(map(_space, free)),
            )
            found.append(one)
        return tuple(found)

    def _carried(self, base: str, moved: str) -> tuple[str, ...]:
        """The bodies that hang on ``base`` by one of them."""
        graph = nx.Graph(self._graph)
        graph.remove_edge(base, moved)
        beyond = nx.node_connected_component(graph, moved) - {moved}
        others = sorted(beyond, key=self.mechanism.bodies.index)
        return (moved, *others)

    @property
    def freedoms(self) -> int:
        """How many freedoms they all have."""
        return sum(joint.freedoms for joint in self.joints)


def _verb(free: list[Variable]) -> str:
    """What a joint with these free variables lets a body do; a spherical joint, which
    has none, lets it turn."""
    if len(free) > 1:
        return "moves"
    return "turns" if not free or free[0].motion.is_turn else "slides"


def _space(variable: Variable) -> str:
    """Over what a variable runs: any of its values closes everything."""
    if variable.limits is not None:
        return "an interval"
    motion = variable.motion
    return "a circle" if motion.is_turn and not motion.advance else "a line"
