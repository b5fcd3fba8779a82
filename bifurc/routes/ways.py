"""The ways of an atlas as a graph, and the best chains of them between two places."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator
from itertools import combinations
from typing import NamedTuple

import networkx as nx
import numpy as np

from bifurc.graphs import ArcAttributes, arc_attributes
from bifurc.routes.places import Place, RouteSearch
from bifurc.routes.surface_legs import Crossing, measure
from bifurc.routes.wishes import NONE, Cost, Wishes
from bifurc.surfaces.geodesic import SurfacePathError

# Nodes of their own: those of the arcs are strings.
START, GOAL = ("start",), ("goal",)
BEGIN, END = ("begin",), ("end",)

# Over the longest arc: chains whose lengths differ by less are as good as each other,
# and the one of the earlier arcs is taken, so that rounding does not choose.
TIE = 1e-9

Way = ArcAttributes | Crossing


class Stage(NamedTuple):
    """One way of a chain, passed from the node ``origin`` to the node ``target``."""

    origin: Hashable
    target: Hashable
    way: Way

    @property
    def length(self) -> float:
        """Length of the way."""
        return _length(self.way)


class _Edge(NamedTuple):
    """An edge of the graph: its nodes, its key, and the way."""

    first: Hashable
    last: Hashable
    key: int
    way: Way


class _Passage(NamedTuple):
    """An edge in the direction in which it is passed, and the names of what has been
    passed before."""

    edge: _Edge
    passed: frozenset[str]

    def __hash__(self) -> int:
        return hash((self.edge.first, self.edge.last, self.edge.key, self.passed))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Passage):
            return False
        return self.edge[:3] == other.edge[:3] and self.passed == other.passed


class WayGraph:
    """The arcs of the forms and the crossings of the surfaces between singular points,
    ends of forms, and the places that are added.

    ``obstacles`` says which ways over surfaces turned out to be none, and why.
    """

    def __init__(self, search: RouteSearch):
        self._search = search
        self._places: dict[Hashable, Place] = {}
        self._graph = nx.MultiGraph()
        self._graph.add_nodes_from(search.arcs)
        self._count = 0  # of the ways that were added
        arcs = [arc for *_, arc in search.arcs.edges(data=True)]
        self._unit = max((_length(arc) for arc in arcs), default=1.0)
        arcs.sort(key=lambda arc: (arc["form"], arc["start"]))
        for arc in arcs:
            self._add(arc)
        self._points = {point.name for point in search.atlas.points}
        self.obstacles: list[str] = []

    # --- making the graph -------------------------------------------------------------

    def add_place(self, node: Hashable, place: Place) -> None:
        """Add a ``node`` for a place; the arc on which it lies is split there."""
        self._places[node] = place
        self._graph.add_node(node)
        if place.form is not None:
            self._split_arc(node, place.form, place.arclength)

    def add_crossings(self) -> None:
        """Join all singular points and places that lie on one surface by crossings that
        are still to be measured."""
        for k, charts in self._search.charts.items():
            for (first, a), (last, b) in combinations(self._points_on(k), 2):
                straight = float(np.linalg.norm(charts.difference(a, b)))
                self._add(Crossing(k, first, last, a, b, straight))

    def _points_on(self, surface: int) -> list[tuple[Hashable, np.ndarray]]:
        """Node and point (n,) of all singular points and places on a surface."""
        points: list[tuple[Hashable, np.ndarray]] = []
        for singular in self._search.atlas.points:
            if surface in singular.surfaces:
                points.append((singular.name, singular.point.u))
        for node, place in self._places.items():
            if surface in place.on_surfaces:
                points.append((node, place.on_surfaces[surface]))
        return points

    def _split_arc(self, node: Hashable, form: int, s: float) -> None:
        """Split the arc of a form that holds arclength ``s`` by a ``node``."""
        arcs: list[tuple[int, ArcAttributes]] = []
        for edge in self._edges():
            if not isinstance(edge.way, Crossing) and edge.way["form"] == form:
                arcs.append((edge.key, edge.way))
        branch = self._search.atlas.forms[form].branch
        if branch.closed:
            begin = min(arc["start"] for _, arc in arcs)
            s = begin + (s - begin) % branch.length
        # the arcs of a form follow each other without gaps but for rounding: the
        # nearest one holds s
        key, arc = min(arcs, key=lambda entry: _distance_to_arc(entry[1], s))
        s = float(np.clip(s, arc["start"], arc["end"]))
        first, last = arc["first"], arc["last"]
        self._graph.remove_edge(first, last, key)
        atlas = self._search.atlas
        self._add(arc_attributes(atlas, form, arc["start"], s, first, node))
        self._add(arc_attributes(atlas, form, s, arc["end"], node, last))

    def _add(self, way: Way) -> None:
        """Add an edge for a way."""
        if isinstance(way, Crossing):
            first, last = way.first, way.last
        else:
            first, last = way["first"], way["last"]
        # chains of one length, as symmetry makes them, differ by the roots of numbers
        self._count += 1
        length = _length(way) + TIE * self._unit * math.sqrt(self._count)
        self._graph.add_edge(first, last, way=way, length=length)

    def _edges(self) -> list[_Edge]:
        """All edges of the graph."""
        edges = self._graph.edges(keys=True, data="way")
        return [_Edge(*edge) for edge in edges]

    # --- the best chains --------------------------------------------------------------

    def best_chains(self, count: int, wishes: Wishes = NONE) -> list[list[Stage]]:
        """Up to ``count`` chains of ways from start to goal, the best first, no node
        passed twice between two of the things that have to be passed; none where there
        is no chain.

        Paths over surfaces are made only where one of the best chains asks for them:
        until then a crossing costs less than it will, so that chains all of whose ways
        are measured are the best (Dellin and Srinivasa 2016, LazySP). Raises
        `RouteError` where a path over a surface is asked for without a problem.
        """
        while True:
            chains = self._candidates(count, wishes)
            unmeasured = {}
            for chain in chains:
                for edge in chain:
                    if isinstance(edge.way, Crossing) and edge.way.path is None:
                        unmeasured[edge.key] = edge
            if not unmeasured:
                return [
                    [Stage(edge.first, edge.last, edge.way) for edge in chain]
                    for chain in chains
                ]
            for edge in unmeasured.values():
                assert isinstance(edge.way, Crossing)
                self._measure(edge, edge.way)

    def _candidates(self, count: int, wishes: Wishes) -> list[list[_Edge]]:
        """The best chains as far as ways are measured.

        Chains come in the order of a sum that is no larger than their cost (Yen 1971):
        the search ends where that sum passes the worst cost that is kept.
        """
        graph, goals = self._passages(wishes)
        best: list[tuple[float, int, list[_Edge]]] = []
        for number, chain in enumerate(self._chains_in_order(graph, goals)):
            bound = sum(self._bound(edge, wishes.cost) for edge in chain)
            if len(best) == count and bound >= best[-1][0]:
                break
            best.append((self._cost(chain, wishes.cost), number, chain))
            best.sort(key=lambda entry: entry[:2])
            del best[count:]
        return [chain for *_, chain in best]

    def _chains_in_order(
        self, graph: nx.DiGraph, goals: list[Hashable]
    ) -> Iterator[list[_Edge]]:
        """Chains from start to one of the goals, smaller sums of weights first."""
        for goal in goals:
            graph.add_edge(goal, END, weight=0.0)
        if END not in graph or not nx.has_path(graph, BEGIN, END):
            return
        for nodes in nx.shortest_simple_paths(graph, BEGIN, END, weight="weight"):
            yield [node.edge for node in nodes if isinstance(node, _Passage)]

    def _passages(self, wishes: Wishes) -> tuple[nx.DiGraph, list[Hashable]]:
        """The graph of nodes, each with what has been passed so far, and of the
        passages between them; and the nodes where the goal is reached with all that is
        wished."""
        graph = nx.DiGraph()
        first: tuple[Hashable, frozenset[str]] = (START, frozenset())
        graph.add_edge(BEGIN, first, weight=0.0)
        wished = frozenset(wishes.through)
        fresh = [first]
        while fresh:
            node, passed = fresh.pop()
            for edge in self._edges_from(node, wishes):
                names = {self._name(edge.way), edge.last} & wished
                state = (edge.last, passed | frozenset(map(str, names)))
                is_new = state not in graph
                passage = _Passage(edge, passed)
                weight = self._bound(edge, wishes.cost)
                graph.add_edge((node, passed), passage, weight=weight)
                graph.add_edge(passage, state, weight=0.0)
                if is_new:
                    fresh.append(state)
        goals = [(GOAL, wished)] if (GOAL, wished) in graph else []
        return graph, list(goals)

    def _edges_from(self, node: Hashable, wishes: Wishes) -> Iterator[_Edge]:
        """The ways that leave a node and are not avoided, in that direction."""
        if node == GOAL:
            return
        for _, last, key, way in self._graph.edges(node, keys=True, data="way"):
            if last not in wishes.avoid and self._name(way) not in wishes.avoid:
                yield _Edge(node, last, key, way)

    def _name(self, way: Way) -> str:
        """The name of the form or the surface of a way."""
        atlas = self._search.atlas
        if isinstance(way, Crossing):
            return atlas.surfaces[way.surface].name
        return atlas.forms[way["form"]].name

    def _cost(self, chain: list[_Edge], cost: Cost) -> float:
        """What a chain costs, as far as its ways are measured."""
        if cost is not Cost.TRAVEL:
            return sum(self._bound(edge, cost) for edge in chain)
        travels = [_travel(edge.way) for edge in chain]
        known = [travel for travel in travels if travel is not None]
        if len(known) < len(travels):
            return sum(self._bound(edge, cost) for edge in chain)
        return float(np.sum(known, axis=0).max()) + self._tie(chain)

    def _tie(self, chain: list[_Edge]) -> float:
        """What decides between chains that are as good as each other."""
        return TIE * sum(self._weight(edge) for edge in chain)

    def _bound(self, edge: _Edge, cost: Cost) -> float:
        """What an edge adds to a sum that is no larger than the cost of a chain."""
        weight = self._weight(edge)
        if cost is Cost.LENGTH:
            return weight
        if cost is Cost.BIFURCATIONS:
            is_point = edge.last in self._points
            return float(is_point) + TIE * weight
        travel = _travel(edge.way)
        n = len(self._search.atlas.names)
        mean = _length(edge.way) / n if travel is None else float(travel.mean())
        return mean + TIE * weight

    def _weight(self, edge: _Edge) -> float:
        """The length of an edge, and what tells it from others of the same length."""
        attributes = self._graph[edge.first][edge.last][edge.key]
        return float(attributes["length"])

    def _measure(self, edge: _Edge, crossing: Crossing) -> None:
        """Give a crossing its path and length, or remove it as an obstacle."""
        k = crossing.surface
        charts = self._search.charts[k]
        problem = self._search.surface_problem(k)
        try:
            path_crossing = measure(problem, charts, crossing)
        except (SurfacePathError, np.linalg.LinAlgError) as error:
            # equations without value next to the surface end in numbers that have no
            # singular values
            name = self._search.atlas.surfaces[k].name
            self.obstacles.append(f"{name} ({charts.outcome.value}): {error}")
            self._graph.remove_edge(edge.first, edge.last, edge.key)
            return
        attributes = self._graph[edge.first][edge.last][edge.key]
        attributes["way"] = path_crossing
        attributes["length"] = path_crossing.length

    # --- what can be reached ----------------------------------------------------------

    def names_in_reach(self) -> list[str]:
        """Names of the forms, then the surfaces, that can be reached from the start."""
        forms: set[int] = set()
        surfaces = set(self._places[START].on_surfaces)
        reach = nx.node_connected_component(self._graph, START)
        for edge in self._edges():
            if edge.first not in reach:
                continue
            if isinstance(edge.way, Crossing):
                surfaces.add(edge.way.surface)
            else:
                forms.add(edge.way["form"])
        atlas = self._search.atlas
        names = [atlas.forms[i].name for i in sorted(forms)]
        names += [atlas.surfaces[k].name for k in sorted(surfaces)]
        return names


def _length(way: Way) -> float:
    return way.length if isinstance(way, Crossing) else way["length"]


def _travel(way: Way) -> np.ndarray | None:
    """By how much each unknown (n,) turns on a way; None for one that is not
    measured."""
    if not isinstance(way, Crossing):
        return way["travel"]
    if way.path is None:
        return None
    return np.asarray(np.abs(np.diff(way.path, axis=0)).sum(axis=0))


def _distance_to_arc(arc: ArcAttributes, s: float) -> float:
    """Distance of arclength ``s`` from an arc; negative inside it."""
    return max(arc["start"] - s, s - arc["end"])
