"""What single figures of the sources show: configurations, curves and marks."""

import io
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from bifurc.torus import difference
from linkages.source_figures.assembly import loop_assembly
from linkages.source_figures.configurations import (
    atlas_of,
    configuration,
    form_named,
    loop_of_content,
    places_at,
)
from linkages.source_figures.curves_figure import joints_alike, singular_values
from linkages.source_figures.draw import draw_source_figure
from linkages.source_figures.drawing import best_look, look_along, symmetry_line
from linkages.source_figures.graph_drawing import places_of
from linkages.source_figures.notation_figure import chain_assembly, ray_angles
from linkages.source_figures.table import Kind, figure_named, source_figures
from linkages.source_figures.tori_figure import Torus, companion_torus
from linkages.source_figures.transitions_figure import tour_of
from tests.linkages.test_figures_in_print import overlapping_texts
from tests.samples import one_in

TURN = 2 * np.pi
# The quickest figure of each kind, and of each chart.
DRAWN = (
    "thesis-3.2.1", "thesis-2.4.10", "003-3", "thesis-5.3.10", "004-13",
    "thesis-4.2.2", "thesis-4.4.2", "thesis-3.4.2", "thesis-5.3.12", "thesis-4.4.7",
    "thesis-5.3.16", "thesis-5.3.5", "thesis-2.2.1", "thesis-5.3.1",
    "003-1", "003-2", "004-3", "004-5", "004-6", "004-7", "004-8", "004-9", "004-10",
    "004-11", "004-12",
    # once with names on each other
    "thesis-2.3.1", "thesis-2.4.1", "thesis-2.4.9", "thesis-3.4.10", "thesis-5.4.11",
    "thesis-5.4.14",
    "thesis-table-3.3.1", "thesis-table-3.5.2", "000-table-3",
)  # fmt: skip


def assert_whole(figure):
    width, height = figure.get_size_inches()
    box = figure.get_tightbbox()
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -0.01


def texts_of(name):
    figure = draw_source_figure(figure_named(name))
    figure.draw_without_rendering()
    return {text.get_text() for text in figure.findobj(Text)}


def test_figures_have_the_names_of_lengths_and_angles_that_the_sources_write():
    assert set("rsφσχθ") <= texts_of("003-1")
    assert set("OTH") | {"M₁"} <= texts_of("004-10")
    above = texts_of("004-9")
    assert "b" in above
    assert {rf"$\mathregular{{O_1^{{{number}}}}}$" for number in range(1, 5)} <= above


def test_a_translator_of_150_degrees_is_drawn_on_its_short_stroke_alone():
    for name in ("004-11", "004-12"):
        figure = draw_source_figure(figure_named(name))
        labels = figure.axes[-1].get_legend_handles_labels()[1]
        long = [label for label in labels if "long" in label]
        assert all(label.startswith(("α = 90", "α = 120")) for label in long)
        highest = max(line.get_xdata().max() for line in figure.axes[0].lines)
        assert highest < 180


@pytest.mark.parametrize("name", one_in(3, DRAWN))
def test_a_figure_is_drawn_and_written(name):
    figure = draw_source_figure(figure_named(name))
    assert overlapping_texts(figure) == []
    assert_whole(figure)
    page = io.BytesIO()
    figure.savefig(page, format="svg")
    assert len(page.getvalue()) > 5000
    assert any(figure_named(name).name in text.get_text() for text in figure.texts)


def test_every_kind_is_among_those_drawn_here():
    assert {figure_named(name).kind for name in DRAWN} == set(Kind)


# --- configurations -------------------------------------------------------------------


def test_configurations_have_the_angle_that_the_source_gives():
    for name in (
        "thesis-4.2.3",
        "thesis-4.2.4",
        "thesis-4.3.3",
        "thesis-5.3.10",
        "thesis-5.3.13",
    ):
        content = figure_named(name).content
        joint, degrees, _ = content["at"]
        theta = configuration(content)
        gap = np.sin((theta[joint - 1] - np.radians(degrees)) / 2)
        assert abs(gap) < 1e-13
        assert loop_of_content(content).closure_error(theta) < 1e-12


@pytest.mark.parametrize("name", ["thesis-5.3.10", "thesis-5.3.13"])
def test_where_joint_2_is_at_the_kink_the_forms_meet_the_bennett_form(name):
    content = figure_named(name).content
    theta = configuration(content)
    points = [point.point.u for point in atlas_of(content).bifurcations]
    gaps = [
        np.abs(difference(point, theta, np.full(6, TURN))).max() for point in points
    ]
    assert min(gaps) < 1e-9


def test_all_places_of_an_angle_are_found():
    form = form_named(atlas_of({"linkage": "mixed-double-goldberg-type-ii"}), "")
    places = places_at(form.branch, 1, 1.0)
    assert len(places) == 2  # joint 1 turns twice
    np.testing.assert_allclose(
        np.sin((form.branch(places)[:, 0] - 1.0) / 2), 0, atol=1e-13
    )


def test_a_form_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(LookupError, match="Form II"):
        form_named(atlas_of({"linkage": "bricard-line-symmetric"}), "Form V")


def test_the_line_of_symmetry_exchanges_opposite_joints():
    for name in ("thesis-4.2.3", "thesis-4.3.4", "thesis-5.3.13"):
        content = figure_named(name).content
        loop = loop_of_content(content)
        assembly = loop_assembly(loop, configuration(content), list("123456"), [""] * 6)
        centre, line = symmetry_line(assembly, 6)
        turn = 2 * np.outer(line, line) - np.eye(3)
        for first, second in ("14", "25", "36"):
            image = centre + turn @ (assembly.joint(first) - centre)
            np.testing.assert_allclose(image, assembly.joint(second), atol=1e-9)


# --- curves ---------------------------------------------------------------------------


def test_curves_that_are_one_are_drawn_as_one():
    atlas = atlas_of({"linkage": "bricard-line-symmetric"})
    groups = joints_alike(form_named(atlas, "Form I").branch.sample(200))
    assert [group.joints for group in groups] == [(1, 4), (2, 5), (3,)]


def test_theta3_of_type_iii_and_of_the_bennett_form_stand_still():
    # figures 3.4.7 and 001-5.2
    for name, joints in (("thesis-3.4.7", [2]), ("001-5.2", [2, 5])):
        content = figure_named(name).content
        forms = content.get("forms", [""])
        samples = form_named(atlas_of(content), forms[0]).branch.sample(100)
        assert np.abs(np.sin(samples[:, joints] / 2)).max() < 1e-9


def test_the_dots_of_type_i_are_opposite_and_those_of_type_ii_a_turn_apart():
    first = [dot[0] for dot in figure_named("thesis-3.4.2").content["dots"]]
    second = [dot[0] for dot in figure_named("thesis-3.4.4").content["dots"]]
    assert first[0] == -first[1]
    assert second[1] - second[0] == 360


def test_forms_i_and_ii_of_the_octahedral_linkage_meet_where_joint_1_turns_back():
    atlas = atlas_of({"linkage": "bricard-octahedral-line-symmetric"})
    (form,) = atlas.forms
    highest = np.degrees(np.abs(form.branch.sample(4001)[:, 0]).max())
    assert highest == pytest.approx(142.6853813157, abs=1e-3)


def test_the_sixth_singular_value_vanishes_and_the_fifth_at_bifurcations_only():
    content = figure_named("thesis-5.3.9").content
    loop = loop_of_content(content)
    atlas = atlas_of(content)
    form = form_named(atlas, "Bennett 4R")
    values = singular_values(loop, form.branch.sample(400))
    assert values[:, 5].max() < 1e-12
    assert values[:, 4].min() > 1e-6
    points = np.array([point.point.u for point in atlas.bifurcations])
    assert singular_values(loop, points)[:, 4].max() < 1e-9


def test_singular_values_are_in_the_unit_of_the_source():
    content = figure_named("thesis-4.2.5").content
    loop = loop_of_content(content)
    theta = form_named(atlas_of(content), "Form I").branch(0.0)[None]
    screws = loop.joint_screws(theta[0])
    assert np.abs(screws[3:]).max() > 1.5  # lengths, not over their mean
    expected = np.linalg.svd(screws, compute_uv=False)
    np.testing.assert_allclose(singular_values(loop, theta)[0], expected)


# --- tours ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["thesis-5.2.5", "thesis-5.2.7"])
def test_a_tour_goes_round_the_four_forms_through_flat_bifurcations(name):
    content = figure_named(name).content
    loop = loop_of_content(content)
    stops = tour_of(atlas_of(content), content)
    assert len(stops) == 16
    places = [stop.place for stop in stops]
    assert places[0::4] == ["Form I", "Form III", "Form II", "Form IV"]
    for number, stop in enumerate(stops):
        assert loop.closure_error(stop.theta) < 1e-9
        is_flat = np.abs(np.sin(stop.theta)).max() < 1e-6
        assert is_flat == (number % 4 == 3) == stop.is_bifurcation


def test_the_tour_of_the_reconfigurable_linkage_ends_on_form_ii():
    content = figure_named("thesis-5.3.16").content
    stops = tour_of(atlas_of(content), content)
    places = [stop.place for stop in stops]
    assert len(stops) == 11
    assert places[0] == "Form I"
    assert places[4].startswith("Bennett")
    assert not stops[4].is_bifurcation
    assert places[-1] == "Form II"


# --- notation and tori ----------------------------------------------------------------


def test_the_angles_at_joint_3_add_up_as_in_equation_5_3_12():
    content = figure_named("thesis-5.3.5").content
    angles = ray_angles(content)
    spans = {
        label: angles[last] - angles[first] for first, last, label in content["arcs"]
    }
    gap = spans["θ3"] - spans["θ3'"] - spans["θ3''"] - np.pi
    assert np.sin(gap / 2) == pytest.approx(0, abs=1e-12)
    # the forms meet at theta3' and at theta3' + pi
    thirds = [point.point.u[2] for point in atlas_of(content).bifurcations]
    gaps = np.sort(np.abs(np.sin((np.array(thirds) - spans["θ3'"]) / 2)))
    np.testing.assert_allclose(gaps, [0, 1], atol=1e-9)


def test_a_chain_has_the_lengths_and_twists_of_its_rows():
    assembly = chain_assembly([[1.0, 50, 0, 0], [1.2, 65, 0.5, 70]], ["1", "2", "3"])
    lengths = [bar.length for bar in assembly.bars]
    twists = [np.degrees(assembly.twist(bar)) for bar in assembly.bars]
    np.testing.assert_allclose(lengths, [1.0, 1.2])
    np.testing.assert_allclose(twists, [50, 65])
    span = assembly.offset("2")
    assert np.linalg.norm(span[1] - span[0]) == pytest.approx(0.5)


def test_both_circles_make_the_same_torus():
    torus = Torus(1.5, 0.9, 0.8, 0.25)
    other = companion_torus(torus)
    # the numbers of the closed form in linkages.families.tori
    assert other.r == pytest.approx(0.866203074497, abs=1e-12)
    assert other.s == pytest.approx(1.519767164315, abs=1e-12)
    assert other.chi == pytest.approx(2.702834702730, abs=1e-12)
    assert other.theta == pytest.approx(-0.112996175807, abs=1e-12)
    phi = np.linspace(0, 6, 40)
    ours, theirs = torus.points(0.0, phi), other.points(0.0, phi)
    reaches = np.linalg.norm(ours[:, :2], axis=1), np.linalg.norm(theirs[:, :2], axis=1)
    np.testing.assert_allclose(reaches[0], reaches[1], atol=1e-12)
    np.testing.assert_allclose(ours[:, 2], theirs[:, 2], atol=1e-12)


# --- on paper -------------------------------------------------------------------------


def test_joints_with_a_seat_stand_on_their_link_and_no_two_joints_in_one_place():
    from linkages.source_figures.construction import assembly_of

    for name in ("thesis-3.4.6", "thesis-3.4.10", "thesis-5.2.3"):
        assembly = assembly_of(figure_named(name).content["panels"][0])
        places = places_of(assembly, tuple("123456"))
        spots = np.array(list(places.values()))
        gaps = np.linalg.norm(spots[:, None] - spots, axis=2)
        assert gaps[np.triu_indices(len(spots), 1)].min() > 0.15


def test_a_look_is_a_right_handed_frame():
    look = look_along(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(np.cross(look.right, look.up), look.near, atol=1e-14)
    assert look.up[2] > 0


def test_the_best_look_sees_no_axis_end_on():
    content = {"linkage": "bennett"}
    loop = loop_of_content(content)
    assembly = loop_assembly(loop, configuration(content), list("1234"), [""] * 4)
    look = best_look(assembly)
    for axis in assembly.axes.values():
        assert abs(axis.direction @ look.near) < 0.98


def test_names_of_figures_are_safe_names_of_files():
    for name in source_figures():
        assert all(letter.isalnum() or letter in ".-" for letter in name)


@pytest.mark.parametrize("name", ["thesis-2.3.3", "thesis-3.5.1", "thesis-5.2.7"])
def test_numbers_of_joints_do_not_cover_each_other(name):
    figure = draw_source_figure(source_figures()[name])
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        boxes = [
            text.get_window_extent()
            for text in axes.texts
            if text.get_text() in set("123456")
        ]
        for first, second in combinations(boxes, 2):
            assert not first.shrunk(0.7, 0.7).overlaps(second.shrunk(0.7, 0.7))
