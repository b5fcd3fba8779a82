"""The graphs of an atlas: forms with the bifurcations that join them, and arcs."""

from __future__ import annotations

from collections.abc import Hashable
from itertools import combinations, pairwise, product
from typing import NamedTuple, TypedDict

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Form, MeetingPoint
from bifurc.checks import check_type
from bifurc.torus import wrap

# Two arclengths of an open form closer than this share of its length are one node.
SAME_STOP = 1e-6


class ArcAttributes(TypedDict):
    """What the edge of an arc holds.

    ``form`` is the index of the form; the arc runs from arclength ``start`` to ``end``
    >= start, which may exceed the length of a closed form; ``travel`` (n,) is the total
    turning of each unknown; ``first`` and ``last`` are the nodes at its two ends.
    """

    form: int
    start: float
    end: float
    length: float
    travel: np.ndarray
    first: Hashable
    last: Hashable


def transition_graph(atlas: Atlas) -> nx.MultiGraph:
    """Graph of forms: nodes are the names of the forms, edges the bifurcations at which
    two of them meet.

    A bifurcation that one form passes more than once is a loop on that form. Surfaces
    are nodes as well, with their ``dimension``, joined to the forms that meet them and
    to the surfaces with which they share a singular point.

    >>> import bifurc, linkages
    >>> graph = bifurc.transition_graph(linkages.map_linkage(linkages.load("rhombus")))
    >>> for form, other, data in graph.edges(data=True):
    ...     print(form, "-", other, "at", data["bifurcation"])
    rhombus form - folded form (joints 2,4 inactive) at B1
    rhombus form - folded form (joints 1,3 inactive) at B2
    folded form (joints 2,4 inactive) - folded form (joints 1,3 inactive) at B3
    """
    check_type("atlas", atlas, Atlas)
    graph = nx.MultiGraph()
    for form in atlas.forms:
        graph.add_node(
            form.name,
            component=form.component,
            length=form.branch.length,
            closed=form.branch.closed,
        )
    for surface in atlas.surfaces:
        graph.add_node(surface.name, dimension=surface.dimension)
    for point in atlas.bifurcations:
        passing = sorted(form for form, _ in point.passes)
        for i, j in sorted(set(combinations(passing, 2))):
            first, second = atlas.forms[i].name, atlas.forms[j].name
            graph.add_edge(first, second, key=point.name, bifurcation=point.name)
    for point in atlas.points:
        for first, second in _meetings_on_surfaces(atlas, point):
            graph.add_edge(first, second, key=point.name, bifurcation=point.name)
    return graph


def _meetings_on_surfaces(atlas: Atlas, point: MeetingPoint) -> list[tuple[str, str]]:
    """Names of every form and surface, and of every two surfaces, that meet at a
    singular point."""
    surfaces = [atlas.surfaces[k].name for k in point.surfaces]
    passing = sorted({form for form, _ in point.passes})
    forms = [atlas.forms[i].name for i in passing]
    return [*product(forms, surfaces), *combinations(surfaces, 2)]


def arc_graph(atlas: Atlas) -> nx.MultiGraph:
    """Graph of arcs: nodes are singular points (and ends of open forms), edges the arcs
    between them.

    Node attributes: ``kind``, ``u`` (n,). Edge attributes: `ArcAttributes`. A closed
    form that passes no singular point is a loop on a node of its own.

    >>> import bifurc, linkages
    >>> graph = bifurc.arc_graph(linkages.map_linkage(linkages.load("kite")))
    >>> sorted(graph.nodes)
    ['B1', 'B2']
    >>> sorted({data["form"] for _, _, data in graph.edges(data=True)})
    [0, 1]
    """
    check_type("atlas", atlas, Atlas)
    graph = nx.MultiGraph()
    for point in atlas.points:
        graph.add_node(point.name, kind=point.kind.value, u=point.point.u)
    for index, form in enumerate(atlas.forms):
        branch = form.branch
        stops = _singular_stops(atlas, index)
        for end in _free_ends(form, stops):
            kind = "regular" if branch.closed else "end"
            u = wrap(branch(end.s), atlas.periods)
            graph.add_node(end.node, kind=kind, u=u)
            stops.append(end)
        stops.sort()
        if branch.closed:
            stops.append(_Stop(stops[0].s + branch.length, stops[0].node))
        for begin, end in pairwise(stops):
            arc = arc_attributes(atlas, index, begin.s, end.s, begin.node, end.node)
            graph.add_edge(begin.node, end.node, **arc)
    return graph


def arc_attributes(
    atlas: Atlas, form: int, start: float, end: float, first: Hashable, last: Hashable
) -> ArcAttributes:
    """What the edge of the arc of a form (by its index) from arclength ``start`` to
    ``end`` holds, between the nodes ``first`` and ``last``."""
    return {
        "form": form,
        "start": start,
        "end": end,
        "length": end - start,
        "travel": _travel(atlas, form, start, end),
        "first": first,
        "last": last,
    }


def _travel(atlas: Atlas, form: int, start: float, end: float) -> np.ndarray:
    """Total turning (n,) of each unknown between two arclengths of a form: an unknown
    turns one way between its dead points."""
    branch = atlas.forms[form].branch
    turns = (0.0, branch.length) if branch.closed else (0.0,)
    travel = np.empty(branch.n)
    for i in range(branch.n):
        stops = [start, end]
        for event in atlas.dead_points:
            if (event.form, event.index) == (form, i):
                passes = [event.s + turn for turn in turns]
                stops += [s for s in passes if start < s < end]
        values = branch(np.array(sorted(stops)))[:, i]
        travel[i] = np.abs(np.diff(values)).sum()
    return travel


class _Stop(NamedTuple):
    """An arclength of a form at which an arc begins or ends, and the node there."""

    s: float
    node: str


def _singular_stops(atlas: Atlas, form: int) -> list[_Stop]:
    """The singular points that a form passes."""
    stops = []
    for point in atlas.points:
        stops += [_Stop(s, point.name) for i, s in point.passes if i == form]
    return stops


def _free_ends(form: Form, stops: list[_Stop]) -> list[_Stop]:
    """Where the arcs of a form begin or end besides its singular points: the ends of an
    open form, and anywhere on a closed one that has none."""
    branch = form.branch
    begin = _Stop(0.0, f"{form.name} start")
    if branch.closed:
        return [] if stops else [begin]
    near = SAME_STOP * max(branch.length, 1.0)
    free_ends = []
    for end in (begin, _Stop(branch.length, f"{form.name} end")):
        if all(abs(end.s - stop.s) > near for stop in stops):
            free_ends.append(end)
    return free_ends
