"""The graphs of an atlas as a GraphML file."""

from __future__ import annotations

import networkx as nx
import pytest

from bifurc.atlas import Atlas
from bifurc.files.graphml import write_graphml
from bifurc.function_problem import FunctionProblem
from bifurc.graphs import arc_graph, transition_graph
from bifurc.search.explore import explore


def test_graphml_holds_both_graphs_with_plain_attributes(
    atlas: Atlas, tmp_path
) -> None:
    path = write_graphml(atlas, tmp_path / "graph.graphml")
    graph = nx.read_graphml(path, force_multigraph=True)
    edges = {"forms": [], "arcs": []}
    for *_, edge in graph.edges(data=True):
        edges[edge["layer"]].append(edge)
    assert len(edges["forms"]) == transition_graph(atlas).number_of_edges()
    assert len(edges["arcs"]) == arc_graph(atlas).number_of_edges()
    total = sum(edge["length"] for edge in edges["arcs"])
    assert total == pytest.approx(sum(form.branch.length for form in atlas.forms))
    assert all("travel_x" in edge for edge in edges["arcs"])


def test_graphml_says_what_a_diagram_says(tmp_path) -> None:
    problem = FunctionProblem(
        lambda u: [u[1] * u[0] - u[0] ** 3], [(-2, 2)] * 2, names=["x", "p"]
    )
    atlas = explore(problem, parameter="p", events={"one": ("p", 1.0)})
    path = write_graphml(atlas, tmp_path / "graph.graphml")
    graph = nx.read_graphml(path, force_multigraph=True)
    assert graph.nodes["point/B1"]["branching"] == "supercritical pitchfork"
    arcs = [arc for *_, arc in graph.edges(data=True) if arc["layer"] == "arcs"]
    assert sorted(arc["stability"] for arc in arcs) == [
        "stable",
        "stable",
        "stable",
        "unstable (1)",
    ]
    assert sorted(arc["points"] for arc in arcs) == ["", "E1", "E2", "E3"]
