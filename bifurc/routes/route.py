"""Routes: the shortest chain of arcs, and of paths over surfaces, from one
configuration to another."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.graphs import arc_attributes, arc_graph
from bifurc.problem import Problem
from bifurc.routes.surface_legs import (
    add_crossings,
    charts_of,
    foot_on,
    measure_crossing,
    middle_of,
)
from bifurc.surfaces.chart_atlas import ChartAtlas
from bifurc.surfaces.geodesic import resample
from bifurc.torus import wrap

__all__ = ["Leg", "Route", "find_route"]

ON = 1e-6  # distance below which a configuration lies on a form or a surface
NO_WAY = 1e-9  # length below which a leg is none
START, GOAL = ("start",), ("goal",)  # nodes of their own: those of the arcs are strings


@dataclass(frozen=True)
class Leg:
    """One stretch of a route: along ``form`` from arclength ``start`` to ``end``,
    backwards where end < start.

    On a closed form arclengths may exceed its length. Over a surface (``dimension`` 2)
    ``form`` is its name, and the arclength is that of the leg itself, from 0 to its
    length. The leg leaves at the singular point ``at`` (empty at the goal). ``travel``
    (n,) is the total turning of each unknown, ``path`` (k, n) the leg's share of that
    of the route.
    """

    form: str
    start: float
    end: float
    at: str
    travel: np.ndarray
    dimension: int = 1
    path: np.ndarray = field(default_factory=lambda: np.empty((0, 0)), repr=False)

    @property
    def length(self) -> float:
        """Arclength of the leg."""
        return abs(self.end - self.start)


@dataclass(frozen=True)
class Route:
    """A chain of legs from one configuration to another, and the path (k, n) along
    them, without jumps.

    No legs and a path of one point, where start and goal are the same configuration.
    """

    legs: tuple[Leg, ...]
    path: np.ndarray

    @property
    def length(self) -> float:
        """Arclength of the whole route."""
        return float(sum(leg.length for leg in self.legs))

    @property
    def travel(self) -> np.ndarray:
        """Total turning (n,) of each unknown."""
        return (
            np.sum([leg.travel for leg in self.legs], axis=0)
            if self.legs
            else np.zeros(self.path.shape[1])
        )


def find_route(
    atlas: Atlas,
    start: str | np.ndarray,
    goal: str | np.ndarray,
    *,
    count: int = 400,
    problem: Problem | None = None,
) -> Route:
    """The shortest way from ``start`` to ``goal`` along forms and over surfaces.

    Either is a configuration (n,) on a form or a surface, or the name of one: it stands
    for the middle of a form's longest arc, or for the chart of a surface farthest from
    its singular points. Forms and surfaces are left at singular points. A leg over a
    surface is a geodesic near the shortest chain of charts; it needs the ``problem``.
    The path has about ``count`` points and no jumps; it begins at ``start`` (the point
    of a name is taken into half a period about zero). Raises `RouteError` for an
    unknown name, a configuration on no form or surface, a component that is only
    sampled, or where no route exists.
    """
    charts = charts_of(atlas)
    arcs = arc_graph(atlas)
    graph = arcs.copy()
    on: dict[Hashable, dict[int, np.ndarray]] = {}
    for node, where in ((START, start), (GOAL, goal)):
        graph.add_node(node)
        form, on[node] = _place(atlas, problem, charts, arcs, where)
        if form is not None:
            _insert(graph, atlas, node, *form)
    add_crossings(graph, atlas, charts, on)
    lost: list[str] = []
    try:
        chain = _shortest_chain(atlas, problem, graph, charts, lost)
    except nx.NetworkXNoPath:
        raise RouteError(
            _no_route(atlas, graph, list(on[START]), start, goal, lost)
        ) from None
    legs = [
        _leg(atlas, problem, charts, edge, a, b, count / _length(chain))
        for a, b, edge in chain
    ]
    return _joined(atlas, legs, start)


# --- start and goal -----------------------------------------------------------------------------------


def _place(
    atlas: Atlas,
    problem: Problem | None,
    charts: dict[int, ChartAtlas],
    arcs: nx.MultiGraph,
    where: str | np.ndarray,
) -> tuple[tuple[int, float] | None, dict[int, np.ndarray]]:
    """(index of a form, arclength) or None, and points (n,) by the indices of surfaces,
    for a name or configuration."""
    if isinstance(where, str):
        return _place_of_name(atlas, charts, arcs, where)
    point = np.asarray(where, dtype=float)
    if point.shape != (len(atlas.names),) or not np.all(np.isfinite(point)):
        raise RouteError(
            f"configuration {point}: it must be {len(atlas.names)} finite numbers"
        )
    if not atlas.forms and not charts:
        raise RouteError(f"the atlas has no forms{_only_sampled(atlas)}")
    form, on, misses = None, {}, []
    if atlas.forms:
        distances, arclengths = np.array(
            [f.branch.nearest(point) for f in atlas.forms]
        )[..., 0].T
        index = int(np.argmin(distances))
        form = (index, float(arclengths[index])) if distances[index] <= ON else None
        misses.append(
            f"{distances[index]:.2g} away from the nearest form, {atlas.forms[index].name!r}"
        )
    for k, over in charts.items():
        name = repr(atlas.surfaces[k].name)
        if problem is None:
            misses.append(f"perhaps on {name}: only the problem of the atlas can tell")
            continue
        distance, foot = foot_on(problem, over, point)
        if foot is not None and distance <= ON:
            on[k] = foot
        misses.append(
            f"{distance:.2g} away from "
            + (name if foot is not None else _charts_of(over, name))
        )
    if form is None and not on:
        raise RouteError(
            f"configuration {_describe(point)}: it lies {' and '.join(misses)}{_only_sampled(atlas)}"
        )
    return form, on


def _charts_of(charts: ChartAtlas, name: str) -> str:
    return f"the charts of {name}" + (
        "" if charts.complete else f" ({charts.outcome.value})"
    )


def _place_of_name(
    atlas: Atlas, charts: dict[int, ChartAtlas], arcs: nx.MultiGraph, name: str
) -> tuple[tuple[int, float] | None, dict[int, np.ndarray]]:
    """The middle of a form's longest arc, or of a surface."""
    full = atlas.full_name(name)
    index = next((i for i, form in enumerate(atlas.forms) if form.name == full), None)
    if index is not None:
        own = [arc for *_, arc in arcs.edges(data=True) if arc["form"] == index]
        longest = max(own, key=lambda arc: (round(arc["length"], 9), -arc["start"]))
        return (index, 0.5 * (longest["start"] + longest["end"])), {}
    k = next(k for k, surface in enumerate(atlas.surfaces) if surface.name == full)
    if k not in charts:
        raise RouteError(f"{full}: no route leads there{_only_sampled(atlas)}")
    return None, {
        k: middle_of(charts[k], [p.point.u for p in atlas.points if k in p.surfaces])
    }


def _insert(
    graph: nx.MultiGraph, atlas: Atlas, node: tuple[str], index: int, s: float
) -> None:
    """Split the arc of a form that holds arclength ``s`` by a new ``node``."""
    branch = atlas.forms[index].branch
    arcs = [
        (a, b, key, arc)
        for a, b, key, arc in graph.edges(keys=True, data=True)
        if arc["form"] == index
    ]
    if branch.closed:
        s = (
            min(arc["start"] for *_, arc in arcs)
            + (s - min(arc["start"] for *_, arc in arcs)) % branch.length
        )
    # the arcs of a form follow each other without gaps but for rounding: the nearest
    # one holds s
    a, b, key, arc = min(
        arcs, key=lambda found: max(found[3]["start"] - s, s - found[3]["end"])
    )
    s = float(np.clip(s, arc["start"], arc["end"]))
    graph.remove_edge(a, b, key)
    for first, last, low, high in (
        (arc["first"], node, arc["start"], s),
        (node, arc["last"], s, arc["end"]),
    ):
        graph.add_edge(
            first, last, **arc_attributes(atlas, index, low, high, first, last)
        )


# --- the chain of edges -------------------------------------------------------------------------------

Chain = list[tuple[Hashable, Hashable, dict[str, Any]]]


def _shortest_chain(
    atlas: Atlas,
    problem: Problem | None,
    graph: nx.MultiGraph,
    charts: dict[int, ChartAtlas],
    lost: list[str],
) -> Chain:
    """The shortest chain from start to goal: nodes and edges; why ways over surfaces
    are ``lost`` is added to the list.

    Paths over surfaces are made only where the shortest chain asks for them: until then
    an edge has a length below its own, so that a chain all of whose edges are measured
    is the shortest (Dellin and Srinivasa 2016, LazySP).
    """
    while True:
        nodes = nx.shortest_path(graph, START, GOAL, weight="length")
        keys = [
            min(graph[a][b], key=lambda key: graph[a][b][key]["length"])
            for a, b in pairwise(nodes)
        ]
        chain = [
            (a, b, graph[a][b][key])
            for (a, b), key in zip(pairwise(nodes), keys, strict=True)
        ]
        waiting = [
            (a, b, key)
            for (a, b, edge), key in zip(chain, keys, strict=True)
            if edge.get("path", 0) is None
        ]
        if not waiting:
            return chain
        for a, b, key in waiting:
            k = graph[a][b][key]["surface"]
            if problem is None:
                raise RouteError(
                    f"the route leads over {atlas.surfaces[k].name!r}: the problem of the atlas is needed there"
                )
            try:
                measure_crossing(problem, charts[k], graph[a][b][key])
            except ValueError as error:
                lost.append(
                    f"{atlas.surfaces[k].name} ({charts[k].outcome.value}): {error}"
                )
                graph.remove_edge(a, b, key)


def _length(chain: Chain) -> float:
    return max(sum(edge["length"] for *_, edge in chain), NO_WAY)


def _leg(
    atlas: Atlas,
    problem: Problem | None,
    charts: dict[int, ChartAtlas],
    edge: dict[str, Any],
    first: Hashable,
    last: Hashable,
    density: float,
) -> Leg:
    """The leg along an edge from the node ``first``, with about so many samples a
    length on its path."""
    forwards = edge["first"] == first
    at = last if isinstance(last, str) else ""  # the goal is no point of the atlas
    samples = (
        1 + max(1, round(density * edge["length"])) if edge["length"] > NO_WAY else 1
    )
    if "form" in edge:
        start, end = (
            (edge["start"], edge["end"]) if forwards else (edge["end"], edge["start"])
        )
        form = atlas.forms[edge["form"]]
        return Leg(
            form.name,
            start,
            end,
            at,
            edge["travel"],
            1,
            form.branch(np.linspace(start, end, samples)),
        )
    assert problem is not None  # without it no path over a surface is measured
    k, along = edge["surface"], edge["path"] if forwards else edge["path"][::-1]
    path = (
        resample(problem, charts[k], along, samples - 1) if samples > 1 else along[:1]
    )
    return Leg(atlas.surfaces[k].name, 0.0, edge["length"], at, edge["travel"], 2, path)


def _joined(atlas: Atlas, legs: Sequence[Leg], start: str | np.ndarray) -> Route:
    """The route along the legs, each shifted by whole periods to where the one before
    it ended; empty ones go."""
    periodic = np.isfinite(atlas.periods)
    period = atlas.periods[periodic]
    first = legs[0].path[0]
    end = (
        wrap(first, atlas.periods)
        if isinstance(start, str)
        else np.asarray(start, dtype=float)
    )
    kept: list[Leg] = []
    parts: list[np.ndarray] = []
    for leg in legs:
        path = leg.path.copy()
        path[:, periodic] += period * np.round(
            (end[periodic] - path[0, periodic]) / period
        )
        if parts:
            path[0] = end  # the same point but for rounding
        end = path[-1]
        parts.append(path[1:] if parts else path)
        if leg.length > NO_WAY:
            kept.append(replace(leg, path=path))
    return Route(tuple(kept), np.concatenate(parts))


# --- what is said where there is none -----------------------------------------------------------------


def _no_route(
    atlas: Atlas,
    graph: nx.MultiGraph,
    on: Sequence[int],
    start: str | np.ndarray,
    goal: str | np.ndarray,
    lost: Sequence[str],
) -> str:
    edges = [
        edge
        for *_, edge in graph.edges(
            nx.node_connected_component(graph, START), data=True
        )
    ]
    names = [
        atlas.forms[i].name
        for i in sorted({edge["form"] for edge in edges if "form" in edge})
    ]
    names += [
        atlas.surfaces[k].name
        for k in sorted(
            {*on, *(edge["surface"] for edge in edges if "surface" in edge)}
        )
    ]
    reached = f"only {', '.join(map(repr, names))} can be reached from the start{_only_sampled(atlas)}"
    return "; ".join(
        [
            f"there is no route from {_describe(start)} to {_describe(goal)}: {reached}",
            *lost,
        ]
    )


def _only_sampled(atlas: Atlas) -> str:
    """A hint at components over which no route is looked for, empty where there are
    none."""
    names = [
        f"{s.name} (dimension {s.dimension})"
        for s in atlas.surfaces
        if s.charts is None
    ]
    return (
        f"; without charts no route goes over {', '.join(names)}: it is only sampled"
        if names
        else ""
    )


def _describe(where: str | np.ndarray) -> str:
    return (
        repr(where)
        if isinstance(where, str)
        else np.array2string(np.asarray(where), precision=6)
    )
