"""The graphs of an atlas as a GraphML file."""

from __future__ import annotations

import networkx as nx
import pytest

from bifurc.atlas import Atlas
from bifurc.files.graphml import write_graphml
from bifurc.graphs import arc_graph, transition_graph


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
