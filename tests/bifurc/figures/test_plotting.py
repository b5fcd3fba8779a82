"""Figures: lines break only where they leave the frame, names do not overlap, and the
same atlas gives the same bytes."""

from __future__ import annotations

import subprocess
import sys
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from bifurc.atlas import Atlas
from bifurc.errors import ProblemError
from bifurc.figures.planes import (
    Scale,
    choose_plane,
    copies_in_frame,
    cut_to_frame,
    place_in_frame,
    scale_of,
)
from bifurc.figures.plotting import (
    plot_form_graph,
    plot_joint_angles,
    plot_singular_values,
    plot_transition_map,
    save_figures,
)
from bifurc.function_problem import FunctionProblem
from bifurc.search.explore import explore
from bifurc.search.settings import SearchSettings

TORUS = (Scale(180 / np.pi, 180.0, "x"), Scale(180 / np.pi, 180.0, "y"))
PLAIN = (Scale(1.0, np.inf, "x"), Scale(1.0, np.inf, "y"))


def pieces_of(rows: np.ndarray) -> list[np.ndarray]:
    """The unbroken stretches of a line."""
    broken = np.flatnonzero(np.isnan(rows[:, 0]))
    return [
        part[~np.isnan(part[:, 0])] for part in np.split(rows, broken) if len(part) > 1
    ]


@pytest.fixture(scope="module")
def parallelogram() -> Atlas:
    """A parallelogram four-bar: x and y turn against each other in one form and
    together in the other, z is constant."""

    def closure(u: np.ndarray) -> np.ndarray:
        x, y, z = u
        turned = np.array(
            [np.cos(x) + 2 * np.cos(x + y), np.sin(x) + 2 * np.sin(x + y)]
        )
        # the far joint lies at distance 1 from (2, 0)
        return np.array(
            [(turned[0] - 2) ** 2 + turned[1] ** 2 - 1, np.sin((z - 0.3) / 2)]
        )

    names = ("theta1", "theta2", "theta3")
    problem = FunctionProblem(
        closure,
        [[-np.inf, np.inf]] * 3,
        names=names,
        units=("rad",) * 3,
        periods=(2 * np.pi,) * 3,
    )
    return explore(problem, settings=SearchSettings(starts=30))


@pytest.fixture(scope="module")
def circle() -> Atlas:
    """A circle and a line through it, in a plane without periods."""
    problem = FunctionProblem(
        lambda u: np.array([(u[0] ** 2 + u[1] ** 2 - 1) * u[1]]),
        [[-2, 2], [-2, 2]],
        names=("x", "y"),
        units=("", "m"),
    )
    return explore(problem, settings=SearchSettings(starts=30))


@pytest.fixture(scope="module")
def nothing() -> Atlas:
    """No solution at all."""
    return explore(
        FunctionProblem(lambda u: np.array([u @ u + 1]), [[-1, 1], [-1, 1]]),
        settings=SearchSettings(starts=5),
    )


# --- lines on the torus -------------------------------------------------------------------------------


def test_a_line_is_broken_where_it_leaves_the_frame_and_nowhere_else() -> None:
    s = np.linspace(0.0, 4 * np.pi, 301)
    parts = pieces_of(cut_to_frame(np.stack([s + 1.0, 0.5 * np.sin(s)], axis=1), TORUS))
    for part in parts:
        assert np.abs(part).max() <= 180 * (1 + 1e-8)
        assert np.linalg.norm(np.diff(part, axis=0), axis=1).max() < 5
        assert part[0, 0] == pytest.approx(-180) or part[0, 0] == pytest.approx(
            np.rad2deg(1.0)
        )
    drawn = sum(np.abs(np.diff(part[:, 0])).sum() for part in parts)
    assert drawn == pytest.approx(720)


def test_a_line_along_the_edge_is_drawn_on_both_edges() -> None:
    s = np.linspace(-np.pi, np.pi, 101)
    parts = pieces_of(cut_to_frame(np.stack([s, np.full(101, np.pi)], axis=1), TORUS))
    assert sorted(round(part[0, 1]) for part in parts) == [-180, 180]


def test_a_closed_curve_inside_the_frame_stays_in_one_piece() -> None:
    t = np.linspace(0, 2 * np.pi, 100)
    for scales in (TORUS, PLAIN):
        rows = np.stack([np.cos(t), np.sin(t)], axis=1)
        (part,) = pieces_of(cut_to_frame(rows, scales))
        np.testing.assert_allclose(part, rows * scales[0].factor, atol=1e-12)


def test_a_point_at_pi_is_drawn_at_both_edges_and_a_corner_at_all_four() -> None:
    spots = place_in_frame(
        np.array([[3 * np.pi, 0.5], [-np.pi, np.pi], [0.1, -7.0]]), TORUS
    )
    np.testing.assert_allclose(spots[0], [180, np.rad2deg(0.5)])
    assert [len(copies_in_frame(spot, TORUS)) for spot in spots] == [2, 4, 1]
    np.testing.assert_allclose(spots[2], np.rad2deg([0.1, 2 * np.pi - 7.0]))


# --- the choice of a plane ----------------------------------------------------------------------------


def test_the_plane_avoids_a_constant_unknown(parallelogram: Atlas) -> None:
    assert choose_plane(parallelogram) == (0, 1)


def test_the_plane_tells_forms_apart_that_look_alike_in_others(circle: Atlas) -> None:
    def lines(u: np.ndarray) -> np.ndarray:
        return np.array([u[0] - u[1], u[2] ** 2 - 1.0])

    atlas = explore(
        FunctionProblem(lines, [[-2, 2]] * 3), settings=SearchSettings(starts=20)
    )
    assert len(atlas.forms) == 2 and 2 in choose_plane(atlas)


def test_angles_are_shown_in_degrees_and_other_units_as_they_are(
    parallelogram: Atlas, circle: Atlas
) -> None:
    assert scale_of(parallelogram, 0).label == "θ₁ (deg)" and scale_of(
        parallelogram, 0
    ).half == pytest.approx(180)
    assert scale_of(circle, 1) == Scale(1.0, np.inf, "y (m)")


def test_joints_that_are_none_are_refused(parallelogram: Atlas) -> None:
    for joints in ([1, 4], [0, 1], [2, 2], [1]):
        with pytest.raises(ProblemError, match="numbered from 1 to 3"):
            plot_transition_map(parallelogram, joints=joints)
    with pytest.raises(ProblemError):
        plot_joint_angles(parallelogram, input_joint=4)


# --- figures ------------------------------------------------------------------------------------------


def texts_of(figure: Figure) -> list[str]:
    return [
        text.get_text()
        for text in figure.findobj(matplotlib.text.Text)
        if text.get_text()
    ]


def test_the_map_names_every_form_and_every_bifurcation(parallelogram: Atlas) -> None:
    found = texts_of(plot_transition_map(parallelogram))
    assert len(parallelogram.forms) == 2 and len(parallelogram.bifurcations) == 2
    assert {"Form 1", "Form 2", "B1", "B2", "θ₁ (deg)", "θ₂ (deg)"} <= set(found)


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


def test_edges_between_the_same_forms_are_drawn_apart(parallelogram: Atlas) -> None:
    (axes,) = plot_form_graph(parallelogram).axes
    first, second = (line.get_xydata() for line in axes.lines)
    np.testing.assert_allclose(first[[0, -1]], second[[0, -1]])
    assert np.linalg.norm(first[20] - second[20]) > 0.3


def test_files_are_the_same_bytes_every_time_and_nothing_else_is_left(
    parallelogram: Atlas, tmp_path
) -> None:
    folders = tmp_path / "a", tmp_path / "b"
    for folder, size in zip(folders, (10.0, 20.0), strict=True):
        folder.mkdir()
        with matplotlib.rc_context(
            {"font.size": size}
        ):  # the user's settings make no difference
            paths = save_figures(parallelogram, folder)
        assert sorted(paths) == sorted(folder.iterdir()) and len(paths) == 8
    for path in folders[0].iterdir():
        assert path.read_bytes() == (folders[1] / path.name).read_bytes(), path.name


def test_nothing_depends_on_pyplot_and_the_atlas_does_not_load_matplotlib() -> None:
    code = (
        "import sys, bifurc.search.explore, bifurc.files.dataset; assert 'matplotlib' not in sys.modules;"
        "import bifurc.figures.plotting; assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
