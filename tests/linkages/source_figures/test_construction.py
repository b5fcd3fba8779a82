"""What schematics show is what their labels say: every link that is drawn has the
length and the twist of its name, also those that a construction removes."""

import numpy as np
import pytest

from linkages.construction.link import Link
from linkages.construction.spatial_triangle import composite_link
from linkages.source_figures.assembly import (
    Assembly,
    Axis,
    Bar,
    bar_between,
    fourth_joint,
    joint_after,
    loop_assembly,
)
from linkages.source_figures.assembly_figure import transversal_points
from linkages.source_figures.configurations import configuration, linkage_of
from linkages.source_figures.construction import (
    assembly_of,
    basic_links,
    link_text,
    link_value,
)
from linkages.source_figures.table import Kind, source_figures
from tests.samples import one_in

FIGURES = {
    name: figure
    for name, figure in source_figures().items()
    if figure.kind is Kind.ASSEMBLY and name.startswith("thesis")
}


def known_links(panel):
    """Basic links of a panel by their letters."""
    if "network" in panel:
        twists = {key: np.radians(value) for key, value in panel["twists"].items()}
        return {key: np.array([np.sin(twist), twist]) for key, twist in twists.items()}
    loop = linkage_of(panel).loop
    return basic_links(loop, panel.get("labels", [""] * loop.n), panel)


def check_panel(panel):
    """Compare every labelled link with its name; how many there were."""
    links = known_links(panel)
    assembly = assembly_of(panel)
    count = 0
    for bar in assembly.bars:
        name = bar.label.split("/")[0]
        letters = set(name) - set("+-")
        if not name or not letters <= set(links):
            continue
        length, twist = link_value(name, links)
        assert bar.length == pytest.approx(abs(length), abs=1e-9)
        # axes have no direction here: twists are compared up to half turns
        sine = abs(np.sin(assembly.twist(bar)))
        assert sine == pytest.approx(abs(np.sin(twist)), abs=1e-9)
        count += 1
    return count


@pytest.mark.parametrize("name", one_in(4, FIGURES))
def test_every_link_has_the_length_and_twist_of_its_name(name):
    panels = FIGURES[name].content["panels"]
    counts = [check_panel(panel) for panel in panels]
    for panel, count in zip(panels, counts, strict=True):
        names = [label for label in panel.get("labels", "abcd") if len(label) == 1]
        if FIGURES[name].content.get("graph", True) and names:
            assert count >= 2


def test_a_wrong_name_is_noticed():
    panel = {
        "linkage": "goldberg-5r",
        "labels": ["b", "a+c", "b", "c", "a"],
        "joints": ["X on 2-3 c"],  # a is right
        "links": ["X-5 b removed"],
    }
    with pytest.raises(AssertionError):
        check_panel(panel)


def test_the_virtual_links_of_the_first_reconfigurable_linkage_are_those_of_the_triangle():
    panel = FIGURES["thesis-5.3.3"].content["panels"][0]
    assembly = assembly_of(panel)
    third = composite_link(
        Link(0.9, np.radians(35)), Link(2.0, np.radians(60)), np.radians(-70), 0.7
    ).link
    for bar in assembly.bars[-2:]:
        assert bar.length == pytest.approx(abs(third.length), abs=1e-12)
        assert np.sin(assembly.twist(bar)) == pytest.approx(np.sin(third.twist))
    ratio = np.sin(np.radians(160)) / assembly.bars[2].length
    assert np.sin(third.twist) / abs(third.length) == pytest.approx(ratio)


def test_kinks_of_the_replaced_link_pairs_are_one_link_with_offsets():
    panel = FIGURES["thesis-5.4.5"].content["panels"][1]
    assembly = assembly_of(panel)
    assert {"8-2", "4-6"} <= {f"{bar.first}-{bar.last}" for bar in assembly.bars}
    assert "1" not in assembly.axes
    span = assembly.offset("2")
    assert np.linalg.norm(span[1] - span[0]) > 0.01


def test_the_fourth_joint_completes_a_bennett_linkage():
    panel = {"linkage": "bennett", "at": [1, 70, 0]}
    assembly = assembly_of(panel)
    axes = list(assembly.axes.values())
    found = fourth_joint(axes[0], axes[1], axes[2])
    np.testing.assert_allclose(found.point, axes[3].point, atol=1e-12)
    across = np.cross(found.direction, axes[3].direction)
    np.testing.assert_allclose(across, 0, atol=1e-12)


def test_a_chain_that_is_not_turned_goes_straight_on():
    first = Axis(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    second = Axis(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    third = joint_after(first, second, 0.0, 2.0, 0.0)
    np.testing.assert_allclose(third.point, [3, 0, 0])


def test_a_link_between_parallel_axes_joins_their_points():
    up = np.array([0.0, 0.0, 1.0])
    assembly = Assembly(
        {"1": Axis(np.zeros(3), up), "2": Axis(np.array([1.0, 0, 0]), up)}
    )
    bar = bar_between(assembly, "1", "2")
    assert isinstance(bar, Bar)
    np.testing.assert_allclose(bar.ends, [[0, 0, 0], [1, 0, 0]])


def test_links_of_a_loop_with_offsets_are_its_common_normals():
    panel = {"linkage": "bricard-line-symmetric", "form": "Form I", "at": [1, 60, 0]}
    assembly = assembly_of(panel)
    loop = linkage_of(panel).loop
    lengths = [bar.length for bar in assembly.bars]
    np.testing.assert_allclose(lengths, loop.arrays.lengths, atol=1e-12)
    spans = [assembly.offset(name) for name in assembly.axes]
    offsets = [np.linalg.norm(span[1] - span[0]) for span in spans]
    np.testing.assert_allclose(offsets, np.abs(loop.arrays.offsets), atol=1e-9)


def test_the_transversal_meets_all_six_axes():
    assembly = assembly_of({"linkage": "wohlhart-hybrid"})
    points = transversal_points(assembly)
    line = points - points[0]
    assert np.linalg.matrix_rank(line, tol=1e-9) == 1
    for point, axis in zip(points, assembly.axes.values(), strict=True):
        across = np.cross(point - axis.point, axis.direction)
        np.testing.assert_allclose(across, 0, atol=1e-9)


def lines(assembly):
    """Feet of all links and directions of all axes, both up to what was reversed."""
    feet = np.array([bar.ends for bar in assembly.bars])
    return feet, np.array([axis.direction for axis in assembly.axes.values()])


@pytest.mark.parametrize(
    "pair", [("bennett", "bennett-lb-2"), ("bennett-ab-2", "bennett-line-symmetric")]
)
def test_bennett_linkages_of_both_set_ups_are_the_same_lines(pair):
    # figure 2.2.2: side lengths and distances of opposite joints at theta1 = 110 deg
    shapes = []
    for name in pair:
        assembly = assembly_of({"linkage": name, "at": [1, 110, 0]})
        points = np.array([assembly.joint(joint) for joint in assembly.axes])
        shapes.append(np.linalg.norm(points[:, None] - points, axis=2))
    np.testing.assert_allclose(shapes[0], shapes[1], atol=1e-12)


def test_the_revised_bricard_linkage_is_the_original_with_three_axes_reversed():
    # figures 4.2.3, 4.3.3 and 4.4.1
    original, revised = (
        assembly_of(panel) for panel in FIGURES["thesis-4.4.1"].content["panels"]
    )
    feet, directions = lines(original)
    other_feet, other_directions = lines(revised)
    np.testing.assert_allclose(other_feet, feet, atol=1e-9)
    signs = np.sum(directions * other_directions, axis=1)
    np.testing.assert_allclose(signs, [1, 1, 1, -1, -1, -1], atol=1e-9)


def test_names_of_sums_are_written_as_in_the_sources():
    assert link_text("a+c") == "a+c/α+γ"
    assert link_text("a12/α12") == "a12/α12"


@pytest.mark.parametrize("line", ["X near 1-2 a", "X on 1-2 q"])
def test_words_that_describe_no_joint_are_refused(line):
    panel = {
        "linkage": "goldberg-5r",
        "labels": ["b", "a+c", "b", "c", "a"],
        "joints": [line],
    }
    with pytest.raises(ValueError, match=line.split()[-1]):
        assembly_of(panel)


def test_a_loop_is_drawn_where_it_closes():
    panel = {"linkage": "wohlhart-symmetric", "at": [1, 60, 0]}
    theta = configuration(panel)
    loop = linkage_of(panel).loop
    assert loop.closure_error(theta) < 1e-12
    names = [str(i + 1) for i in range(loop.n)]
    assembly = loop_assembly(loop, theta, names, [""] * loop.n)
    np.testing.assert_allclose(
        assembly.bars[-1].ends[1], assembly.bars[0].ends[0], atol=1e-12
    )
