"""The graphs of an atlas, on curves drawn by hand so that every number is known."""

import numpy as np
import pytest

from bifurc.atlas import Atlas, Event
from bifurc.graphs import ArcAttributes, arc_graph, transition_graph
from bifurc.torus import wrap
from tests.bifurc.drawn_atlas import PERIOD, bridge, draw, figure_eight, polygon, ring


def arcs_of(atlas: Atlas) -> list[ArcAttributes]:
    return [arc for *_, arc in arc_graph(atlas).edges(data=True)]


@pytest.mark.parametrize("stops", [0, 1, 2, 3])
def test_a_closed_form_with_stops_is_cut_into_as_many_arcs(stops: int) -> None:
    points = {f"B{i}": [("ring", 0.5 + i)] for i in range(stops)}
    atlas = draw({"ring": ring(0.0)}, points)
    arcs = arcs_of(atlas)
    assert len(arcs) == max(stops, 1)
    assert sum(arc["length"] for arc in arcs) == pytest.approx(PERIOD)
    assert sum(arc["travel"] for arc in arcs) == pytest.approx([PERIOD, 0.0])
    assert len(arc_graph(atlas)) == max(stops, 1)


def test_an_open_form_has_its_ends_as_nodes_unless_singular_points_lie_there() -> None:
    line = polygon((0, 0), (1, 0), (2, 0), closed=False)
    assert set(arc_graph(draw({"line": line}, {}))) == {"line start", "line end"}
    atlas = draw({"line": line}, {"S1": [("line", 2.0 - 1e-9)], "B1": [("line", 1.0)]})
    assert set(arc_graph(atlas)) == {"S1", "B1", "line start"}
    assert arc_graph(atlas).number_of_edges() == 2


def test_arcs_name_the_nodes_at_their_start_and_end() -> None:
    atlas = draw({"ring": ring(0.0)}, {"B1": [("ring", 1.0)], "B2": [("ring", 4.5)]})
    nodes = arc_graph(atlas).nodes
    for arc in arcs_of(atlas):
        for node, s in ((arc["first"], arc["start"]), (arc["last"], arc["end"])):
            gap = atlas.forms[0].branch(s) - nodes[node]["u"]
            assert np.abs(wrap(gap, atlas.periods)).max() < 1e-12


def test_travel_counts_the_way_there_and_back() -> None:
    square = polygon((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
    places = ((0, 1.5), (0, 3.5), (1, 0.5), (1, 2.5))
    dead = tuple(Event(0, s, square(s), index=i) for i, s in places)
    (arc,) = arcs_of(draw({"square": square}, {"B1": [("square", 1.75)]}, dead))
    assert arc["travel"] == pytest.approx([2.0, 2.0], abs=1e-15)


def test_the_graph_of_forms_joins_all_pairs_at_a_bifurcation_once() -> None:
    branches = {"a": ring(0.0), "b": bridge(1.0), "c": polygon((1, 0), (4, 3), (7, 6))}
    atlas = draw(
        branches,
        {"B1": [("a", 1.0), ("b", 0.0), ("c", 0.0)], "B2": [("a", 4.0), ("b", 3.0)]},
    )
    edges = transition_graph(atlas).edges(keys=True)
    assert sorted((*sorted((a, b)), key) for a, b, key in edges) == [
        ("a", "b", "B1"),
        ("a", "b", "B2"),
        ("a", "c", "B1"),
        ("b", "c", "B1"),
    ]


def test_a_form_that_crosses_itself_is_a_loop_in_the_graph_of_forms() -> None:
    atlas = draw({"eight": figure_eight()}, {"B1": [("eight", 0.0), ("eight", 4.0)]})
    assert list(transition_graph(atlas).edges(keys=True)) == [("eight", "eight", "B1")]
    assert [arc["length"] for arc in arcs_of(atlas)] == [4.0, 4.0]
