"""Figures of linkages in the widths of a column and of a page: nothing sticks out, no
text lies on another, and most of the width is the axes'."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import combinations, product

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.text import Text

from bifurc.atlas import Atlas
from bifurc.figures.form_graph import plot_form_graph
from bifurc.figures.plotting import (
    plot_joint_angles,
    plot_singular_values,
    plot_transition_map,
    save_figures,
)
from bifurc.figures.selection import Selection
from bifurc.figures.singular_values import plot_singular_values_against
from bifurc.figures.space import plot_map_in_space
from linkages.linkage import load
from linkages.mapping import map_linkage
from tests.linkages.app.slider_cranks import slider_crank_text
from tests.maps import map_of
from tests.samples import one_in

LINKAGES = (
    "special-double-subtractive-goldberg",
    "bennett",
    "bricard-line-symmetric",
    "wohlhart-double-goldberg",
    "four-bar",
    "altmann",
    "goldberg-5r",
    "parallelogram",
)
PLOTS: dict[str, Callable[..., Figure]] = {
    "map": plot_transition_map,
    "angles": plot_joint_angles,
    "values": plot_singular_values,
    "against": partial(plot_singular_values_against, unknown=1),
    "graph": plot_form_graph,
    "space": partial(plot_map_in_space, unknowns=[1, 2, 3]),
}
SIZES = {"column": (3.4, 2.6), "page": (7.0, 4.0)}  # inches
TOUCHING = 1.0  # pixels by which boxes of texts may overlap: they have empty rims


class TextRecorder(RendererAgg):
    """Keeps where every text is when it is drawn: in space that is known only then."""

    def __init__(self, figure: Figure):
        super().__init__(figure.bbox.width, figure.bbox.height, figure.dpi)
        self.outlines: dict[Text, Path] = {}

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None) -> None:
        if mtext is not None and s.strip():
            self.outlines[mtext] = outline(mtext, self)


def outline(text: Text, renderer: RendererAgg) -> Path:
    """The corners of a text, turned as it is, in pixels."""
    rotation = text.get_rotation()
    box = text.get_window_extent(renderer)
    middle = np.array([0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)])
    text.set_rotation(0)
    box = text.get_window_extent(renderer)
    text.set_rotation(rotation)
    half = 0.5 * np.array([box.width, box.height]) - TOUCHING
    corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    turn = np.deg2rad(rotation)
    matrix = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    return Path(corners @ matrix + middle)


def overlapping_texts(figure: Figure) -> list[tuple[str, str]]:
    recorder = TextRecorder(figure)
    figure.draw(recorder)
    return [
        (first.get_text(), second.get_text())
        for (first, a), (second, b) in combinations(recorder.outlines.items(), 2)
        if a.intersects_path(b, filled=True)
    ]


def width_of_axes(figure: Figure) -> float:
    """The part of the width from the first frame to the last."""
    boxes = [axes.get_window_extent() for axes in figure.axes]
    span = max(box.x1 for box in boxes) - min(box.x0 for box in boxes)
    return float(span / figure.bbox.width)


# One in five: every linkage, every plot and both sizes are among them.
@pytest.mark.parametrize("case", one_in(5, product(LINKAGES, PLOTS, SIZES), " ".join))
def test_figures_fit_the_width_of_a_column_and_of_a_page(case) -> None:
    name, plot, size = case
    with matplotlib.rc_context({"figure.figsize": SIZES[size]}):
        figure = PLOTS[plot](map_of(name))
    assert overlapping_texts(figure) == []
    width, height = figure.get_size_inches()
    assert width == SIZES[size][0]
    box = figure.get_tightbbox()
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -1e-9
    assert width_of_axes(figure) >= 0.5


def test_a_text_that_lies_on_another_is_found() -> None:
    figure = Figure()
    figure.text(0.5, 0.5, "one")
    figure.text(0.51, 0.5, "another")
    figure.text(0.5, 0.9, "a third")
    figure.draw_without_rendering()
    assert overlapping_texts(figure) == [("one", "another")]


@pytest.mark.parametrize("plot", [plot_transition_map, plot_form_graph])
def test_a_plot_is_drawn_into_axes_and_adds_nothing_beside_them(plot) -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    atlas = map_of(LINKAGES[0])
    assert plot(atlas, ax=left) is figure
    assert left.texts and not right.texts
    assert not figure.legends and figure.axes == [left, right]


def test_lines_in_axes_are_named_in_the_order_of_the_forms() -> None:
    axes: Axes = Figure().subplots()
    plot_transition_map(map_of(LINKAGES[0]), ax=axes)
    _, names = axes.get_legend_handles_labels()
    assert [name.split(" (")[0] for name in names] == [
        "Form I",
        "Form II",
        "Form III",
        "Form IV",
    ]


@pytest.mark.parametrize("plot", PLOTS.values(), ids=PLOTS)
def test_a_plot_is_drawn_into_a_part_of_a_figure(plot) -> None:
    figure = Figure(figsize=(9, 4), layout="constrained")
    left, right = figure.subfigures(1, 2)
    assert plot(map_of(LINKAGES[0]), figure=left) is figure
    figure.draw_without_rendering()
    assert left.axes and not right.axes
    assert left.get_tightbbox().x1 <= left.bbox.x1 + 1e-9


def test_joints_go_by_names_and_numbers_in_all_plots() -> None:
    atlas = map_of("bennett")
    labels = [
        plot_transition_map(atlas, joints=joints).axes[0].get_xlabel()
        for joints in ((2, 3), ("theta2", "theta3"), ("theta2", 3))
    ]
    assert labels == ["θ₂ (deg)"] * 3
    plot_joint_angles(atlas, input_joint="theta4")
    plot_singular_values_against(atlas, "theta4")
    plot_map_in_space(atlas, ["theta1", 2, "theta4"])


def test_settings_of_the_user_go_over_those_of_the_project() -> None:
    atlas = map_of("bennett")
    usual = plot_transition_map(atlas).axes[0]
    assert usual.xaxis.label.get_size() == 9
    settings = {
        "font.size": 14,
        "font.family": "DejaVu Serif",
        "axes.prop_cycle": matplotlib.cycler(color=["#123456"], linestyle=["--"]),
    }
    with matplotlib.rc_context(settings):
        axes = plot_transition_map(atlas).axes[0]
    assert axes.xaxis.label.get_size() == 14
    assert axes.xaxis.label.get_family() == ["DejaVu Serif"]
    assert axes.lines[0].get_color() == "#123456"
    assert axes.lines[0].get_linestyle() == "--"


def test_a_window_shows_the_angles_in_it_and_no_others() -> None:
    atlas = map_of(LINKAGES[0])
    whole = plot_transition_map(
        atlas, joints=(1, 5), selection=Selection(window=(0, 360))
    )
    for line in whole.axes[0].lines:
        x, y = line.get_data()
        assert np.nanmin([x, y]) > -1e-3 and np.nanmax([x, y]) < 360 + 1e-3
    part = plot_transition_map(atlas, selection=Selection(window=(20, 80)))
    assert part.axes[0].get_xlim() == part.axes[0].get_ylim() == (20, 80)
    assert all(line.get_clip_on() for line in part.axes[0].lines)


def test_chosen_forms_keep_their_colours_and_bring_their_points() -> None:
    atlas = map_of(LINKAGES[0])
    (every,) = plot_transition_map(atlas, joints=(1, 5)).axes
    colors = {line.get_label(): line.get_color() for line in every.lines}
    name = next(form.name for form in atlas.forms if form.name.startswith("Form II "))
    chosen = Selection(forms=[name])
    (one,) = plot_transition_map(atlas, joints=(1, 5), selection=chosen).axes
    named = [line for line in one.lines if not line.get_label().startswith("_")]
    assert [line.get_label() for line in named] == [name]
    assert named[0].get_color() == colors[name]
    index = atlas.form(name)
    passed = {p.name for p in atlas.points if index in [form for form, _ in p.passes]}
    assert (
        {text.get_text() for text in one.texts}
        == passed
        < {point.name for point in atlas.points}
    )


@pytest.fixture(scope="module")
def crank(tmp_path_factory) -> Atlas:
    """A slider-crank as drawn on its first form, with the dead points of its slide
    there, and a second form along which the slide stands still."""
    path = tmp_path_factory.mktemp("crank") / "crank.toml"
    path.write_text(slider_crank_text((0.6, 0.8), 1.2))
    return map_linkage(load(path))


def marks_in(axes: Axes, marker: str) -> int:
    """How many marks of one kind there are, all of them inside the frame."""
    count = 0
    for line in axes.lines:
        if line.get_marker() == marker:
            places = axes.transData.transform(line.get_xydata())
            box = axes.get_window_extent().padded(1.0)
            assert all(box.contains(*place) for place in places)
            count += len(places)
    return count


def test_marks_of_forms_that_are_not_chosen_are_not_drawn(crank: Atlas) -> None:
    number = crank.form("Form 2")
    chosen = Selection(forms=["Form 2"])
    assert chosen.drawn(crank) is None and not chosen.dead_points(crank)
    other = Selection(forms=["Form 1"])
    assert np.array_equal(other.drawn(crank), crank.drawn)
    assert {event.form for event in other.dead_points(crank)} == {1 - number}
    for plot in (plot_transition_map, plot_joint_angles):
        figure = plot(crank, selection=chosen)
        figure.draw_without_rendering()
        for axes in figure.axes:
            assert marks_in(axes, "*") == marks_in(axes, "s") == 0
            assert marks_in(axes, "o") == 2
        words = [text.get_text() for text in figure.legends[0].get_texts()]
        assert words == ["Form 2", "bifurcation"]


def test_points_far_from_a_flat_form_are_in_the_frame(crank: Atlas) -> None:
    chosen = Selection(["Form 2"], overlay={"J1": [10, 20], "J4": [0.5, -3.0]})
    figure = plot_transition_map(crank, joints=(1, 4), selection=chosen)
    figure.draw_without_rendering()
    assert marks_in(figure.axes[0], "+") == 2


def test_in_space_there_is_all_that_the_legend_names(crank: Atlas) -> None:
    overlay = {"J1": [10.0], "J2": [20.0], "J4": [0.5]}
    selection = Selection(overlay=overlay)
    figure = plot_map_in_space(crank, ["J1", "J2", "J4"], selection=selection)
    named = {one.get_marker() for one in figure.legends[0].legend_handles}
    drawn = {line.get_marker() for line in figure.axes[0].lines}
    assert named == drawn == {"None", "o", "s", "*", "+"}


def test_points_of_the_user_are_laid_over_where_both_joints_have_some() -> None:
    overlay = {"theta1": [10.0, 200.0], "theta2": [20.0, 30.0]}
    selection = Selection(overlay=overlay)
    figure = plot_joint_angles(map_of("bennett"), selection=selection)
    crosses = [
        [line.get_xydata() for line in axes.lines if line.get_marker() == "+"]
        for axes in figure.axes
    ]
    assert [len(one) for one in crosses] == [1, 0, 0]
    np.testing.assert_allclose(crosses[0][0], [[10, 20], [-160, 30]])


def test_what_shows_nothing_is_not_written(tmp_path) -> None:
    paths = save_figures(map_of("bennett"), tmp_path, formats=["png"])
    assert [path.stem for path in paths] == [
        "transition_map",
        "joint_angles",
        "singular_values",
    ]
