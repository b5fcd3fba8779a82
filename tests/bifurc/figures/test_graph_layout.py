"""Where forms stand in the graph of forms: apart, and joined by the right lines."""

import numpy as np

from bifurc.figures.form_graph import CLEARANCE, lay_out_graph


def test_lines_join_the_forms_that_meet_and_names_stand_apart(parallelogram):
    layout = lay_out_graph(parallelogram)
    assert layout.names == tuple(form.name for form in parallelogram.forms)
    assert len(layout.edges) == len(parallelogram.bifurcations) == 2
    for edge in layout.edges:
        gaps = np.linalg.norm(layout.places - edge.line[[0, -1], None], axis=-1)
        assert gaps.min(axis=1).max() < 1e-12
        assert set(gaps.argmin(axis=1)) == {0, 1}
    names = np.vstack([layout.places, [edge.label for edge in layout.edges]])
    first, second = np.triu_indices(len(names), 1)
    assert np.linalg.norm(names[first] - names[second], axis=1).min() > CLEARANCE


def test_the_graph_of_no_form_is_empty(nothing):
    layout = lay_out_graph(nothing)
    assert (layout.names, layout.edges) == ((), ())
