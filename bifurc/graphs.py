"""The graphs of an atlas: forms with the bifurcations that join them, and arcs."""

from __future__ import annotations

from collections.abc import Hashable
from itertools import combinations, pairwise, product
from typing import TypedDict

import networkx as nx
import numpy as np

from bifurc.atlas import Atlas, Form
from bifurc.torus import wrap

__all__ = ["ArcAttributes", "arc_attributes", "arc_graph", "transition_graph"]

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
    """
    graph = nx.MultiGraph()
    for form in atlas.forms:
        graph.add_node(
            form.name,
            component=form.component,
            length=form.branch.length,
            closed=form.branch.closed,
        )
    for point in atlas.bifurcations:
        passing = sorted(form for form, _ in point.passes)
        for i, j in sorted(set(combinations(passing, 2))):
            one, other = atlas.forms[i].name, atlas.forms[j].name
            graph.add_edge(one, other, key=point.name, bifurcation=point.name)
    for surface in atlas.surfaces:
        graph.add_node(surface.name, dimension=surface.dimension)
    for point in atlas.points:
        surfaces = [atlas.surfaces[k].name for k in point.surfaces]
        forms = [atlas.forms[i].name for i in sorted({i for i, _ in point.passes})]
        for one, other in [*product(forms, surfaces), *combinations(surfaces, 2)]:
            graph.add_edge(one, other, key=point.name, bifurcation=point.name)
    return graph


def arc_graph(atlas: Atlas) -> nx.MultiGraph:
    """Graph of arcs: nodes are singular points (and ends of open forms), edges the arcs
    between them.

    Node attributes: ``kind``, ``u`` (n,). Edge attributes: `ArcAttributes`. A closed
    form that passes no singular point is a loop on a node of its own.
    """
    graph = nx.MultiGraph()
    for point in atlas.points:
        graph.add_node(point.name, kind=point.kind.value, u=point.point.u)
    for index, form in enumerate(atlas.forms):
        stops = _singular_stops(atlas, index)
        for s, node in _free_ends(form, [s for s, _ in stops]):
            kind = "regular" if form.branch.closed else "end"
            u = wrap(form.branch(s), atlas.periods)
            graph.add_node(node, kind=kind, u=u)
            stops.append((s, node))
        stops.sort()
        if form.branch.closed:
            start, first = stops[0]
            stops.append((start + form.branch.length, first))
        for (start, first), (end, last) in pairwise(stops):
            arc = arc_attributes(atlas, index, start, end, first, last)
            graph.add_edge(first, last, **arc)
    return graph


def arc_attributes(
    atlas: Atlas, form: int, start: float, end: float, first: Hashable, last: Hashable
) -> ArcAttributes:
    """What the edge of the arc of a form (by its index) from arclength ``start`` to
    ``end`` holds, between the nodes ``first`` and ``last``."""
    branch = atlas.forms[form].branch
    turns = (0.0, branch.length) if branch.closed else (0.0,)
    travel = np.empty(branch.n)
    for i in range(branch.n):
        own = [e.s for e in atlas.dead_points if (e.form, e.index) == (form, i)]
        dead = sorted(s + turn for s in own for turn in turns)
        stops = [start, *(s for s in dead if start < s < end), end]
        travel[i] = np.abs(np.diff(branch(np.array(stops))[:, i])).sum()
    return {
        "form": form,
        "start": start,
        "end": end,
        "length": end - start,
        "travel": travel,
        "first": first,
        "last": last,
    }


def _singular_stops(atlas: Atlas, form: int) -> list[tuple[float, str]]:
    """Arclength and name of every singular point that a form passes."""
    return [(s, p.name) for p in atlas.points for i, s in p.passes if i == form]


def _free_ends(form: Form, stops: list[float]) -> list[tuple[float, str]]:
    """Arclengths and nodes at which the arcs of a form begin or end beside its singular
    points: the ends of an open form, and anywhere on a closed one that has none."""
    branch = form.branch
    if branch.closed:
        return [] if stops else [(0.0, f"{form.name} start")]
    near = SAME_STOP * max(branch.length, 1.0)
    ends = [(0.0, f"{form.name} start"), (branch.length, f"{form.name} end")]
    return [(s, node) for s, node in ends if all(abs(s - at) > near for at in stops)]
