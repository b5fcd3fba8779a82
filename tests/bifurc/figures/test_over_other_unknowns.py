"""The figures over unknowns of the reader's choice."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from bifurc.errors import ProblemError
from bifurc.figures.singular_values import plot_singular_values_against
from bifurc.figures.space import plot_map_in_space


def test_a_map_in_space_has_a_line_a_form_and_a_name_a_point(parallelogram):
    figure = plot_map_in_space(parallelogram, [1, 2, 3])
    (axes,) = figure.axes
    assert len(curves_of(figure)) == len(parallelogram.forms)
    names = {text.get_text().strip() for text in axes.texts}
    assert {point.name for point in parallelogram.points} <= names


def curves_of(figure):
    lines = figure.axes[0].lines
    return [line for line in lines if line.get_marker() == "None"]


def test_marks_in_space_are_on_both_faces_of_the_frame(parallelogram):
    figure = plot_map_in_space(parallelogram, [1, 2, 3])
    (marks,) = [one for one in figure.axes[0].lines if one not in curves_of(figure)]
    spots = np.array(marks.get_data_3d()).T
    assert len(spots) > len(parallelogram.points)
    for spot in spots:
        for axis in np.flatnonzero(np.abs(np.abs(spot) - 180) < 1e-6):
            other = spot.copy()
            other[axis] *= -1
            assert np.linalg.norm(spots - other, axis=1).min() < 1e-6


def test_lines_in_space_break_where_they_leave_the_frame(parallelogram):
    figure = plot_map_in_space(parallelogram, [1, 2, 3])
    for line in curves_of(figure):
        points = np.array(line.get_data_3d())
        steps = np.abs(np.diff(points, axis=1))
        assert not np.any(steps > 180.0)


def test_singular_values_stand_over_the_unknown_that_is_asked_for(parallelogram):
    figure = plot_singular_values_against(parallelogram, 2)
    assert figure.get_supxlabel() == "θ₂ (deg)"
    panels = [axes for axes in figure.axes if axes.get_visible()]
    assert len(panels) == len(parallelogram.forms)
    for axes in panels:
        assert axes.get_xlim() == (-180, 180)
        strong = max(axes.lines, key=lambda line: line.get_linewidth())
        assert np.nanmin(strong.get_ydata()) < 1e-9  # it comes down to zero


@pytest.mark.parametrize("unknowns", [[1, 2], [1, 2, 2], [0, 1, 2], [1, 2, 9]])
def test_other_numbers_than_three_of_the_unknowns_are_refused(parallelogram, unknowns):
    with pytest.raises(ProblemError, match="3 of the unknowns"):
        plot_map_in_space(parallelogram, unknowns)


@pytest.mark.parametrize("unknown", [0, 5, -1])
def test_an_unknown_that_is_not_there_is_refused(parallelogram, unknown):
    with pytest.raises(ProblemError, match="numbered from 1 to 3"):
        plot_singular_values_against(parallelogram, unknown)


def test_numbers_and_names_of_a_map_in_space_are_apart(parallelogram):
    figure = plot_map_in_space(parallelogram, [1, 2, 3])
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    (axes,) = figure.axes
    shown = [text.get_text() for text in axes.yaxis.get_ticklabels()]
    assert {"\N{MINUS SIGN}90", "0", "90"} <= set(shown)
    assert not {"\N{MINUS SIGN}180", "180"} & set(shown)
    texts = [*axes.texts]
    for line in (axes.xaxis, axes.yaxis, axes.zaxis):
        texts += [text for text in line.get_ticklabels() if text.get_text()]
    boxes = [text.get_window_extent() for text in texts]
    # ticks beyond the frame stand somewhere, and are not drawn
    boxes = [box for box in boxes if 0 < box.x1 < 2 * figure.bbox.width]
    for first, second in combinations(boxes, 2):
        assert not first.shrunk(0.6, 0.6).overlaps(second.shrunk(0.6, 0.6))
