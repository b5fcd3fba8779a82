"""Routes that avoid, pass and count something, within limits, against all chains of arcs."""

from __future__ import annotations

from itertools import pairwise, product

import networkx as nx
import numpy as np
import pytest

from bifurc.atlas import Atlas
from bifurc.errors import RouteError
from bifurc.graphs import arc_graph
from bifurc.routes.route import Route, find_route, find_routes
from bifurc.routes.wishes import Cost, Wishes
from tests.bifurc.drawn_atlas import draw, polygon, ring
from tests.samples import one_in

STEPS = 300  # of the fine graph, on every arc


MEETINGS = {
    "B1": [("a", 0.5), ("b", 0.7)],
    "B2": [("a", 3.0), ("b", 2.9)],
    "B3": [("b", 4.0), ("c", 1.0)],
    "B4": [("b", 5.5), ("c", 3.3)],
    "B5": [("a", 4.4), ("c", 5.1)],
}


def three_rings() -> Atlas:
    """Three rings, each two of which meet."""
    return draw({"a": ring(0.0), "b": ring(1.0), "c": ring(2.0)}, MEETINGS)


def within_limits(low: float, high: float) -> Atlas:
    """The three rings as far as x is within limits, and where they meet there."""
    ends = {"a": 0.0, "b": 1.0, "c": 2.0}
    cut = {
        name: polygon((low, y), (low + 0.3, y), (high, y), closed=False)
        for name, y in ends.items()
    }
    inside = {
        name: [(form, x - low) for form, x in passes]
        for name, passes in MEETINGS.items()
        if all(low < x < high for _, x in passes)
    }
    return draw(cut, inside)


def fine_graph(atlas: Atlas, avoid: tuple[str, ...]) -> nx.Graph:
    """Many points on every arc, joined to their neighbours by their distances."""
    graph = nx.Graph()
    arcs = arc_graph(atlas)
    for first, last, key, arc in arcs.edges(keys=True, data=True):
        name = atlas.forms[arc["form"]].name
        if name in avoid:
            continue
        s = np.linspace(arc["start"], arc["end"], STEPS + 1)
        points = atlas.forms[arc["form"]].branch(s)
        inner = [(arc["form"], key, first, last, k) for k in range(1, STEPS)]
        nodes = [first, *inner, last]
        gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        for (a, b), gap in zip(pairwise(nodes), gaps, strict=True):
            graph.add_edge(a, b, weight=float(gap))
        for node, place in zip(nodes, s, strict=True):
            graph.nodes[node].setdefault("s", {})[arc["form"]] = float(place)
    graph.remove_nodes_from(avoid)
    return graph


def nearest_node(graph: nx.Graph, form: int, s: float, length: float):
    def gap(node) -> float:
        place = graph.nodes[node]["s"].get(form)
        if place is None:
            return np.inf
        away = abs(place - s) % length
        return min(away, length - away)

    return min(graph.nodes, key=gap)


def start_of(route: Route) -> tuple[str, float]:
    return route.legs[0].form, route.legs[0].start


def end_of(route: Route) -> tuple[str, float]:
    return route.legs[-1].form, route.legs[-1].end


POINTS = ("B1", "B2", "B3", "B4", "B5")


@pytest.mark.parametrize("avoid", [(), *[(name,) for name in POINTS], ("B1", "B4")])
@pytest.mark.parametrize(("start", "goal"), [("a", "b"), ("a", "c"), ("b", "c")])
def test_no_route_is_longer_than_the_shortest_on_a_fine_graph(start, goal, avoid):
    atlas = three_rings()
    free = find_route(atlas, start, goal)  # says where the names are
    graph = fine_graph(atlas, avoid)
    ends = []
    for name, s in (start_of(free), end_of(free)):
        form = atlas.form(name)
        ends.append(nearest_node(graph, form, s, atlas.forms[form].branch.length))
    wanted = nx.shortest_path_length(graph, *ends, weight="weight")
    route = find_route(atlas, start, goal, wishes=Wishes(avoid=avoid))
    spacing = 2 * max(form.branch.length for form in atlas.forms) / STEPS
    assert route.length < 1.001 * wanted + spacing
    assert not set(route.points) & set(avoid)


@pytest.mark.parametrize("limits", [(0.3, 5.8), (0.6, 5.7), (0.4, 4.2), (2.0, 5.9)])
@pytest.mark.parametrize("avoid", [(), ("B2", "B3")])
@pytest.mark.parametrize(("start", "goal"), [("a", "b"), ("a", "c"), ("b", "c")])
def test_within_limits_as_well_and_where_there_is_none_it_is_said(
    start, goal, avoid, limits
):
    atlas = within_limits(*limits)
    avoid = tuple({point.name for point in atlas.points} & set(avoid))
    ends = [middle_of_the_longest_arc(atlas, name) for name in (start, goal)]
    graph = fine_graph(atlas, avoid)
    nodes = []
    for name, place in zip((start, goal), ends, strict=True):
        form = atlas.form(name)
        length = atlas.forms[form].branch.length
        nodes.append(nearest_node(graph, form, place, length))
    places = [
        atlas.forms[atlas.form(name)].branch(place)
        for name, place in zip((start, goal), ends, strict=True)
    ]
    wishes = Wishes(avoid=avoid)
    if not nx.has_path(graph, *nodes):
        with pytest.raises(RouteError):
            find_route(atlas, *places, wishes=wishes)
        return
    route = find_route(atlas, *places, wishes=wishes)
    wanted = nx.shortest_path_length(graph, *nodes, weight="weight")
    spacing = 2 * max(form.branch.length for form in atlas.forms) / STEPS
    assert abs(route.length - wanted) < 0.001 * wanted + spacing
    assert not set(route.points) & set(avoid)
    width = limits[1] - limits[0]
    for leg in route.legs:  # none goes round
        assert min(leg.start, leg.end) >= -1e-9
        assert max(leg.start, leg.end) <= width + 1e-9


def middle_of_the_longest_arc(atlas: Atlas, name: str) -> float:
    arcs = [
        arc
        for _, _, arc in arc_graph(atlas).edges(data=True)
        if arc["form"] == atlas.form(name)
    ]
    longest = max(arcs, key=lambda arc: arc["end"] - arc["start"])
    return 0.5 * (longest["start"] + longest["end"])


def all_routes(atlas: Atlas, start: str, goal: str) -> list[Route]:
    """All that pass no point twice."""
    return find_routes(atlas, start, goal, 1000)


def cost_of(route: Route, cost: Cost) -> float:
    if cost is Cost.LENGTH:
        return route.length
    if cost is Cost.TRAVEL:
        return float(route.travel.max())
    return float(len(route.points))


def test_all_routes_are_all_simple_chains_of_arcs():
    atlas = three_rings()
    routes = all_routes(atlas, "a", "c")
    lengths = [route.length for route in routes]
    np.testing.assert_allclose(lengths, sorted(lengths))
    # the same by the graph of arcs, with start and goal as nodes that split two arcs
    graph = nx.MultiGraph(arc_graph(atlas))
    for node, (name, s) in (
        ("start", start_of(routes[0])),
        ("goal", end_of(routes[0])),
    ):
        form = atlas.form(name)
        length = atlas.forms[form].branch.length
        for first, last, key, arc in list(graph.edges(keys=True, data=True)):
            inside = (s - arc["start"]) % length < arc["end"] - arc["start"]
            if arc["form"] == form and inside:
                graph.remove_edge(first, last, key)
                graph.add_edge(first, node, form=-1, start=0.0, end=0.0)
                graph.add_edge(node, last, form=-1, start=0.0, end=0.0)
                break
    chains = list(nx.all_simple_edge_paths(graph, "start", "goal"))
    assert len(routes) == len(chains) > 10


WISHES = product(Cost, [("B3", "B1"), (), ("b",), ("B4",)], [1, 3, 7])


# One in five: every cost, every place and every number are among them.
@pytest.mark.parametrize("wish", one_in(5, WISHES))
def test_the_best_routes_are_the_best_of_all(wish):
    cost, through, best = wish
    atlas = three_rings()

    def passes(route: Route) -> bool:
        names = {leg.form for leg in route.legs} | set(route.points)
        return set(through) <= names

    allowed = [one for one in all_routes(atlas, "a", "c") if passes(one)]
    wanted = sorted(cost_of(route, cost) for route in allowed)
    wishes = Wishes(through=through, cost=cost)
    routes = find_routes(atlas, "a", "c", best, wishes=wishes)
    costs = [cost_of(route, cost) for route in routes]
    np.testing.assert_allclose(costs, sorted(costs))
    assert len(routes) == best
    assert all(leg.at for route in routes for leg in route.legs[:-1])
    assert all(passes(route) for route in routes)
    for own, least in zip(costs, wanted, strict=False):
        # a way that passes a point twice, on a detour, may be better still
        assert own <= least * (1 + 1e-9) + 1e-9


def test_what_is_avoided_and_passed_must_be_there():
    atlas = three_rings()
    with pytest.raises(RouteError, match="B9"):
        find_route(atlas, "a", "b", wishes=Wishes(avoid=("B9",)))
    with pytest.raises(RouteError, match="avoided and passed"):
        find_route(atlas, "a", "b", wishes=Wishes(avoid=("B1",), through=("B1",)))
    with pytest.raises(RouteError, match="that avoids 'B1', 'B2', 'B5'"):
        find_route(atlas, "a", "b", wishes=Wishes(avoid=("B1", "B2", "B5")))
