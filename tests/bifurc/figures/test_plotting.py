"""Figures: names do not overlap, and the same atlas gives the same bytes."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from bifurc.atlas import Atlas, Surface
from bifurc.curves.certificate import Certificate, CertificateStatus
from bifurc.errors import ProblemError
from bifurc.figures.plotting import (
    FORMATS,
    plot_form_graph,
    plot_joint_angles,
    plot_singular_values,
    plot_transition_map,
    save_figures,
)
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from tests.samples import one_in


def test_joints_that_are_none_are_refused(parallelogram: Atlas) -> None:
    for joints in ([1, 4], [0, 1], [2, 2], [1]):
        with pytest.raises(ProblemError, match="numbered from 1 to 3"):
            plot_transition_map(parallelogram, joints=joints)
    with pytest.raises(ProblemError):
        plot_joint_angles(parallelogram, input_joint=4)


def texts_of(figure: Figure) -> list[str]:
    return [
        text.get_text()
        for text in figure.findobj(matplotlib.text.Text)
        if text.get_text()
    ]


def test_the_map_names_every_form_and_every_bifurcation(parallelogram: Atlas) -> None:
    texts = texts_of(plot_transition_map(parallelogram))
    assert len(parallelogram.forms) == 2 and len(parallelogram.bifurcations) == 2
    assert {"Form 1", "Form 2", "B1", "B2", "θ₁ (deg)", "θ₂ (deg)"} <= set(texts)


def test_bifurcations_on_one_spot_of_the_plane_share_a_label(circle: Atlas) -> None:
    flat = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2 - 1) * u[1], u[2]]),
        [[-2, 2]] * 3,
        names=("x", "y", "z"),
    )
    assert "B1, B2" in texts_of(
        plot_transition_map(
            explore(flat, settings=SearchSettings(starts=30)), joints=[2, 3]
        )
    )


def test_names_and_marks_of_bifurcations_do_not_overlap(parallelogram: Atlas) -> None:
    figure = plot_transition_map(parallelogram)
    figure.draw_without_rendering()
    boxes = [
        t.get_window_extent()
        for t in figure.findobj(matplotlib.text.Annotation)
        if t.get_text()
    ]
    assert len(boxes) == 2
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


@pytest.mark.parametrize(
    "plot",
    [plot_transition_map, plot_joint_angles, plot_singular_values, plot_form_graph],
)
@pytest.mark.parametrize("name", ["parallelogram", "circle", "nothing"])
def test_no_text_sticks_out_of_the_figure(plot, name: str, request) -> None:
    figure = plot(request.getfixturevalue(name))
    figure.draw_without_rendering()
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -1e-9


@pytest.mark.parametrize("kind", one_in(4, Kind))
@pytest.mark.parametrize("plot", [plot_transition_map, plot_joint_angles])
def test_no_entry_of_the_legend_sticks_out_of_the_figure(
    plot, kind: Kind, circle: Atlas
) -> None:
    samples = circle.forms[0].branch.sample(5)
    surface = Surface(2, samples, "surface 1")
    points = tuple(replace(point, kind=kind) for point in circle.points)
    atlas = replace(circle, points=points, surfaces=(surface,))
    figure = plot(atlas)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    texts = [" ".join(text.get_text().split()) for text in legend.get_texts()]
    assert texts == ["Form 1", "Form 2", kind.value, "mobility 2 or more"]
    assert legend.get_window_extent().x1 <= figure.bbox.x1


def test_an_atlas_without_forms_says_so(nothing: Atlas) -> None:
    assert any("no form" in text for text in texts_of(plot_transition_map(nothing)))


def test_singular_values_have_a_panel_a_form_and_name_where_they_vanish(
    circle: Atlas,
) -> None:
    figure = plot_singular_values(circle)
    visible = [axes for axes in figure.axes if axes.get_visible()]
    assert [axes.get_title(loc="left") for axes in visible] == ["Form 1", "Form 2"]
    for axes in visible:
        assert axes.get_yscale() == "log" and {"B1", "B2"} <= {
            text.get_text() for text in axes.texts
        }


def test_bars_on_the_axis_show_where_a_form_is_not_certified(circle: Atlas) -> None:
    refused = Certificate(
        status=CertificateStatus.NOT_CERTIFIED,
        gaps=np.array([[0.5, 0.6]]),
        blurred=np.empty((0, 2)),
        points=0,
        bound=1.0,
    )
    forms = (replace(circle.forms[0], certificate=refused), *circle.forms[1:])
    first, second = plot_singular_values(replace(circle, forms=forms)).axes[:2]
    bars = [line for line in first.lines if line.get_label() == "not certified"]
    assert [line.get_xdata()[[0, -1]].tolist() for line in bars] == [[0.5, 0.6]]
    assert not any(line.get_label() == "not certified" for line in second.lines)


def test_edges_between_the_same_forms_are_drawn_apart(parallelogram: Atlas) -> None:
    (axes,) = plot_form_graph(parallelogram).axes
    first, second = (line.get_xydata() for line in axes.lines)
    np.testing.assert_allclose(first[[0, -1]], second[[0, -1]])
    assert np.linalg.norm(first[20] - second[20]) > 0.3


def test_files_are_the_same_bytes_every_time_and_nothing_else_is_left(
    parallelogram: Atlas, tmp_path
) -> None:
    folders = tmp_path / "a", tmp_path / "b"
    for folder in folders:
        folder.mkdir()
        paths = save_figures(parallelogram, folder, formats=FORMATS)
        assert sorted(paths) == sorted(folder.iterdir()) and len(paths) == 12
    for path in folders[0].iterdir():
        assert path.read_bytes() == (folders[1] / path.name).read_bytes(), path.name


def test_a_file_that_cannot_be_written_is_named(parallelogram: Atlas, tmp_path) -> None:
    with pytest.raises(NotADirectoryError, match="nowhere"):
        save_figures(parallelogram, tmp_path / "nowhere")
    (tmp_path / "joint_angles.svg").mkdir()
    with pytest.raises(IsADirectoryError, match=r"joint_angles\.svg"):
        save_figures(parallelogram, tmp_path)


def test_a_figure_that_is_interrupted_leaves_no_part_of_itself(
    parallelogram: Atlas, tmp_path, monkeypatch
) -> None:
    def interrupted(content: bytes, part: Path) -> None:
        part.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr("bifurc.figures.plotting._write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save_figures(parallelogram, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_nothing_depends_on_pyplot_and_the_atlas_does_not_load_matplotlib() -> None:
    code = (
        "import sys, bifurc.search.explore, bifurc.files.dataset; assert 'matplotlib' not in sys.modules;"
        "import bifurc.figures.plotting; assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
