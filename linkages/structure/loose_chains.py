"""Chains of bodies that move by themselves, whatever the rest of a mechanism does.

A chain is a row of bodies and joints, nothing else on any of them, between two bodies of
the rest. With these at rest its freedoms are those of its joints less six, or three in a
plane and on a sphere (Grübler's count); where that is more than none, solutions are at
least of that dimension (Krull's height theorem), and for any place that the chain reaches
it does not hold the rest. Two rods with a spherical joint between them turn about the line
between their ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from networkx.utils import UnionFind

from linkages.structure.plane import is_on_sphere, normal_of_plane
from linkages.structure.structure import Structure

if TYPE_CHECKING:
    import networkx as nx

OF_ROD = 5  # freedoms that a rod leaves its ends, its own turning left out
OF_ROTATION = 3  # freedoms that a point has not


@dataclass(frozen=True)
class LooseChain:
    """The ``bodies`` of a chain, the names ``between`` which it is, and the number of
    ``freedoms`` that are its own."""

    bodies: tuple[str, ...]
    between: tuple[str, ...]
    freedoms: int


def loose_chains(structure: Structure) -> tuple[LooseChain, ...]:
    """The chains of a mechanism that have freedoms of their own, those left out of the
    ``structure`` not counted."""
    import networkx as nx

    graph = _links(structure)
    mechanism = structure.mechanism
    is_flat = mechanism.is_planar or normal_of_plane(mechanism) is not None
    of_body = 3 if is_flat or is_on_sphere(mechanism) else 6
    inner = [node for node in graph if graph.degree(node) == 2]
    chains = []
    for nodes in nx.connected_components(graph.subgraph(inner)):
        ends = [other for node in nodes for other in graph[node] if other not in nodes]
        if not ends:
            continue  # a loop by itself: nothing is beside it
        freedoms = _own_freedoms(structure, graph, nodes) - of_body
        if freedoms > 0:
            numbers = _bodies(structure, graph, nodes)
            bodies = tuple(mechanism.bodies[number] for number in numbers)
            between = tuple(_name(structure, end) for end in sorted({*ends}))
            chains.append(LooseChain(bodies, between, freedoms))
    return tuple(sorted(chains, key=lambda chain: chain.bodies))


def _links(structure: Structure) -> nx.MultiGraph:
    """What is left without rods as nodes: groups of bodies that are one, each called
    after one of them, and points; an edge for every pair and rod between them, with its
    ``freedoms`` and its ``bodies``."""
    import networkx as nx

    parts = UnionFind(range(structure.body_count))
    for base, moved, unknowns in structure.ends.values():
        if unknowns == 0:
            parts.union(base, moved)
    in_rods = {body for rod in structure.rods for body in rod.bodies}
    graph = nx.MultiGraph()
    graph.add_nodes_from(
        parts[body] for body in range(structure.body_count) if body not in in_rods
    )
    for number, ends in structure.ends.items():
        base, moved = parts[ends.base], parts[ends.moved]
        if base != moved:
            freedoms = ends.unknowns - _coupled_freedoms(structure, number)
            graph.add_edge(base, moved, freedoms=freedoms, bodies=())
    for rod in structure.rods:
        base, moved = (parts[body] for body in rod.ends)
        freedoms = OF_ROD + (rod.leg is not None)
        graph.add_edge(base, moved, freedoms=freedoms, bodies=rod.bodies)
    for body in range(structure.body_count):
        if parts[body] in graph:
            graph.nodes[parts[body]].setdefault("bodies", []).append(body)
    return graph


def _coupled_freedoms(structure: Structure, pair: int) -> int:
    """How many free variables of a pair follow others, or are followed: what is beside
    the chain may move them."""
    variables = structure.mechanism.variables
    followed = {
        one.leader.number for k, one in enumerate(variables) if one.leader.number != k
    }
    free = [k for k in structure.variables_of(pair) if variables[k].locked is None]
    return sum(variables[k].leader.number != k or k in followed for k in free)


def _own_freedoms(structure: Structure, graph: nx.MultiGraph, nodes: set[int]) -> int:
    """The sum of the freedoms of all joints of a chain, less what points lack."""
    edges = graph.edges(nodes, data="freedoms")
    of_joints = sum(int(freedoms) for _, _, freedoms in edges)
    lacking = sum(
        OF_ROTATION + 3 - len(point.directions)
        for point in structure.free_points
        if point.body in nodes
    )
    return of_joints - lacking


def _bodies(structure: Structure, graph: nx.MultiGraph, nodes: set[int]) -> list[int]:
    """The bodies of a chain and of the rods in it, by number."""
    bodies = {body for node in nodes for body in graph.nodes[node]["bodies"]}
    for _, _, of_edge in graph.edges(nodes, data="bodies"):
        bodies |= set(of_edge)
    count = len(structure.mechanism.bodies)
    return sorted(body for body in bodies if body < count)


def _name(structure: Structure, node: int) -> str:
    """The name of a body, or of a point at which only rods meet."""
    if node < len(structure.mechanism.bodies):
        return structure.mechanism.bodies[node]
    return next(point.name for point in structure.free_points if point.body == node)
