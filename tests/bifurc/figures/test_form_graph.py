"""The picture of the graph of forms."""

import numpy as np

from bifurc.figures.form_graph import plot_form_graph
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings


def test_the_graph_of_forms_names_surfaces_where_they_meet_something() -> None:
    problem = FunctionProblem(
        lambda u: np.array([u[2] * u[0], u[2] * u[1]]), [(-1, 1)] * 3
    )
    atlas = explore(problem, settings=SearchSettings(starts=20))
    axes = plot_form_graph(atlas).axes[0]
    assert sorted(text.get_text() for text in axes.texts) == [
        "D1",
        "Form 1",
        "surface 1",
    ]
