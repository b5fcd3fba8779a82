"""The picture of the graph of forms."""

import numpy as np

from bifurc.figures.form_graph import plot_form_graph, shows_transitions
from bifurc.figures.selection import EVERYTHING
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from tests.bifurc.drawn_atlas import draw, ring


def test_the_graph_of_forms_names_surfaces_where_they_meet_something() -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * u[1]]), [(-1, 1)] * 3
    )
    atlas = explore(problem, settings=SearchSettings(starts=20))
    axes = plot_form_graph(atlas).axes[0]
    assert shows_transitions(atlas, EVERYTHING)
    assert sorted(text.get_text() for text in axes.texts) == [
        "D1",
        "Form 1",
        "surface 1",
    ]


def test_forms_that_do_not_meet_are_no_graph() -> None:
    rings = {"Form 1": ring(0.0), "Form 2": ring(1.0)}
    assert not shows_transitions(draw(rings, {}), EVERYTHING)
