"""The ways of an atlas as a graph, and the shortest chain of them between two
places."""

from __future__ import annotations

import math
from collections.abc import Hashable
from itertools import combinations, pairwise
from typing import NamedTuple

import networkx as nx
import numpy as np

from bifurc.graphs import ArcAttributes, arc_attributes
from bifurc.routes.places import Place, RouteSearch
from bifurc.routes.surface_legs import Crossing, measure
from bifurc.surfaces.geodesic import SurfacePathError

# Nodes of their own: those of the arcs are strings.
START, GOAL = ("start",), ("goal",)

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

    # --- the shortest chain -----------------------------------------------------------

    def shortest_chain(self) -> list[Stage] | None:
        """The shortest chain of ways from start to goal; None where there is none.

        Paths over surfaces are made only where the shortest chain asks for them: until
        then a crossing has a length below its own, so that a chain all of whose ways
        are measured is the shortest (Dellin and Srinivasa 2016, LazySP). Raises
        `RouteError` where a path over a surface is asked for without a problem.
        """
        while True:
            chain = self._shortest_edges()
            if chain is None:
                return None
            is_measured = True
            for edge in chain:
                if isinstance(edge.way, Crossing) and edge.way.path is None:
                    self._measure(edge, edge.way)
                    is_measured = False
            if is_measured:
                return [Stage(edge.first, edge.last, edge.way) for edge in chain]

    def _shortest_edges(self) -> list[_Edge] | None:
        """The edges of the shortest chain, in order and direction."""
        try:
            nodes = nx.shortest_path(self._graph, START, GOAL, weight="length")
        except nx.NetworkXNoPath:
            return None
        edges = []
        for a, b in pairwise(nodes):
            between = self._graph[a][b]
            lengths = {key: edge["length"] for key, edge in between.items()}
            key = min(lengths, key=lengths.__getitem__)
            edges.append(_Edge(a, b, key, between[key]["way"]))
        return edges

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


def _distance_to_arc(arc: ArcAttributes, s: float) -> float:
    """Distance of arclength ``s`` from an arc; negative inside it."""
    return max(arc["start"] - s, s - arc["end"])
