"""Points at which only rods meet: they have a place and no rotation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from linkages.decisions import meets_in_one_point
from linkages.structure.groups import JointPoint
from linkages.structure.rods import RodNet

if TYPE_CHECKING:
    import networkx as nx

BEYOND = 1.01  # of how far rods can carry a point: limits that it does not meet


@dataclass(frozen=True, eq=False)
class FreePoint:
    """A point at which only rods meet, called after its joints: the number of the
    ``body`` that it counts as, the body ``base`` from which its place is measured along
    unit vectors ``directions`` (k, 3), and the ``limits`` (k, 2) of these distances
    from the reference configuration, in the user's unit.

    A cluster of rods that hangs on one body at two points turns about the line between
    these, which moves nothing else: one of its points stays in a plane through them,
    two directions.
    """

    name: str
    body: int
    base: int
    directions: np.ndarray
    limits: np.ndarray


def free_points(points: tuple[JointPoint, ...], net: RodNet) -> tuple[FreePoint, ...]:
    """The free points of a mechanism, in the order of their bodies."""
    if not net.free:
        return ()
    import networkx as nx

    graph = nx.Graph()
    for rod in net.rods:
        length = np.inf if rod.leg is not None else rod.length
        graph.add_edge(*rod.points, length=length)
    clusters = nx.connected_components(graph.subgraph(net.free))
    found = [
        p for cluster in clusters for p in _of_cluster(points, net, graph, cluster)
    ]
    return tuple(sorted(found, key=lambda point: point.body))


def _of_cluster(
    points: tuple[JointPoint, ...], net: RodNet, graph: nx.Graph, cluster: set[int]
) -> list[FreePoint]:
    """The free points of a ``cluster``, numbers of points that rods join."""
    holders = _holders(net, cluster)
    base = min(holders.values())
    fixed = [number for number, body in holders.items() if body == base]
    reach = _reach(graph, cluster, fixed)
    free = {}
    for number in cluster:
        name = points[number].joints[0]
        limits = np.array([-reach[number], reach[number]]) * np.ones((3, 1))
        free[number] = FreePoint(name, net.free[number], base, np.eye(3), limits)
    if len(holders) == len(fixed) == 2:
        number = _held_in_plane(points, graph, cluster, fixed)
        free[number] = _in_plane(points, graph, number, fixed, free[number])
    return list(free.values())


def _in_plane(
    points: tuple[JointPoint, ...],
    graph: nx.Graph,
    number: int,
    hinge: list[int],
    free: FreePoint,
) -> FreePoint:
    """A free point that stays in the plane through it and a ``hinge``, two points."""
    start, end = (points[k].center for k in hinge)
    directions = _plane(start, end, points[number].center)
    limits = free.limits[:2].copy()
    lengths = [graph.edges.get((number, k), {"length": np.inf}) for k in hinge]
    if all(np.isfinite(edge["length"]) for edge in lengths):
        # rods hold it away from the line, so that it stays on its side
        limits[1, 0] = -directions[1] @ (points[number].center - start)
    return replace(free, directions=directions, limits=limits)


def _holders(net: RodNet, cluster: set[int]) -> dict[int, int]:
    """The points at which bodies hold the rods of a cluster, with these bodies."""
    holders: dict[int, int] = {}
    for rod in net.rods:
        if cluster & set(rod.points):
            pairs = zip(rod.points, rod.ends, strict=True)
            holders |= {point: body for point, body in pairs if point not in net.free}
    return holders


def _reach(graph: nx.Graph, cluster: set[int], fixed: list[int]) -> Mapping[int, float]:
    """How far from where it is given every point of a cluster can be, if rods hold it
    on ``fixed`` points; infinite where legs do."""
    import networkx as nx

    inside = graph.subgraph({*cluster, *fixed})
    lengths = nx.multi_source_dijkstra_path_length(inside, fixed, weight="length")
    return {number: 2 * BEYOND * lengths[number] for number in cluster}


def _held_in_plane(
    points: tuple[JointPoint, ...],
    graph: nx.Graph,
    cluster: set[int],
    hinge: list[int],
) -> int:
    """The point of a cluster that is best held in a plane through the two points of a
    hinge: joined to both, if there is one, and far from their line."""
    start, end = (points[k].center for k in hinge)
    along = (end - start) / np.linalg.norm(end - start)

    def fitness(number: int) -> tuple[int, float, int]:
        joined = sum(graph.has_edge(number, k) for k in hinge)
        arm = np.linalg.norm(np.cross(points[number].center - start, along))
        return joined, round(float(arm / np.linalg.norm(end - start)), 6), -number

    return max(cluster, key=fitness)


def _plane(start: np.ndarray, end: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Unit vectors (2, 3) along a line from ``start`` to ``end`` (3,) and square to it,
    towards ``place`` (3,); anywhere where this is on the line."""
    along = (end - start) / np.linalg.norm(end - start)
    across = place - start - ((place - start) @ along) * along
    if meets_in_one_point(
        float(np.linalg.norm(across)), float(np.linalg.norm(end - start))
    ):
        across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    return np.array([along, across / np.linalg.norm(across)])
