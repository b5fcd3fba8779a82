"""The pictures of surfaces."""

import numpy as np
import pytest

from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.surface_plot import plot_charts
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.surfaces.chart_atlas import ChartAtlas


def test_the_picture_of_a_surface_has_all_its_triangles(
    sphere_charts: ChartAtlas,
) -> None:
    axes = plot_charts(sphere_charts, np.eye(3)[:2]).axes[0]
    assert len(axes.collections[0].get_paths()) == len(sphere_charts.triangles)
    assert np.abs(axes.dataLim.get_points()).max() == pytest.approx(1.0, abs=0.03)


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
