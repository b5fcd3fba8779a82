"""What is drawn of a mechanism: lines from joint to joint, rails, and symbols."""

import json

import numpy as np
import pytest

import linkages
from linkages.links.mechanism_drawing import (
    OVER_A_SHEET,
    best_view_of_mechanism,
    breadths_of_mechanism,
    draw_bodies,
    draw_symbols,
    held_body,
)
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.subject import (
    mechanism_from,
    mechanism_of,
    mechanism_subject,
)
from linkages.structure.structure import Structure
from linkages.values import GeometryError
from linkages.viewing.document import make_view_document
from studies.miura import miura
from tests.linkages.mechanisms.test_size import spatial_four_bar, split
from tests.linkages.viewing.conftest import mapped

UP = (0, 0, 1)


def body_called(document, name):
    return next(b for b in document["mechanism"]["bodies"] if b["name"] == name)


def test_a_loop_has_no_mechanism_and_a_mechanism_no_loop():
    loop = make_view_document(mapped("bennett"))
    mechanism = make_view_document(mapped("slider-crank"))
    assert "mechanism" not in loop
    assert "smallest" not in loop["forms"][0]
    assert list(loop)[:5] == ["title", "verdict", "completeness", "note", "loop"]
    assert "loop" not in mechanism
    json.dumps(mechanism, allow_nan=False)


def test_bodies_of_three_joints_are_triangles():
    document = make_view_document(mapped("Watt"))
    counts = {b["name"]: len(b["lines"]) for b in document["mechanism"]["bodies"]}
    assert counts == {
        "frame": 1,
        "crank": 1,
        "coupler": 3,
        "rocker": 3,
        "arm": 1,
        "hand": 1,
    }


def test_the_rail_of_a_slide_is_as_long_as_the_slide_is_used():
    atlas = mapped("slider-crank")
    document = make_view_document(atlas)
    size = document["mechanism"]["size"]
    *_, rail = body_called(document, "frame")["lines"]
    low, high = size * np.array(rail)[:, 0]
    # the slider is between 2 and 4 on either side of the pivot of the crank
    assert -4.0 - 0.2 * size < low < -4.0
    assert 4.0 < high < 4.0 + 0.2 * size
    assert body_called(document, "slider")["lines"] == []


def test_every_joint_has_a_symbol_on_the_body_that_moves_along_it():
    document = make_view_document(mapped("slider-crank"))["mechanism"]
    names = [body["name"] for body in document["bodies"]]
    symbols = {symbol["label"]: symbol for symbol in document["symbols"]}
    assert list(symbols) == ["J1", "J2", "J3", "J4"]
    slide = symbols["J4"]
    assert names[slide["holder"]] == "slider"
    assert names[slide["other"]] == "frame"
    assert slide["place"] == symbols["J3"]["place"]
    assert slide["columns"] == [3]


def test_joints_whose_axes_meet_are_drawn_apart():
    turns = [(0, 0, 1), (0, 0.6, 0.8), (0.6, 0.3, 0.9), (0.7, -0.1, 0.8), (0.3, -1, 1)]
    bodies = ["a", "b", "c", "d", "e", "a"]
    joints = [
        Joint(f"J{k}", "revolute", (bodies[k], bodies[k + 1]), (1, 2, 3), turn)
        for k, turn in enumerate(turns)
    ]
    structure = Structure(Mechanism(tuple(joints), "spherical five-bar"))
    places = [symbol["place"] for symbol in draw_symbols(structure)]
    distances = [np.linalg.norm(np.subtract(p, q)) for p in places for q in places]
    assert sum(distance < 0.1 for distance in distances) == len(places)
    drawn = draw_bodies(structure, np.zeros((1, 5)))
    assert all(len(body["lines"]) == 1 for body in drawn)


@pytest.mark.parametrize("size", [(2, 2), (3, 3)])
def test_joints_of_panels_are_in_the_middle_of_their_creases(size, tmp_path):
    content = miura(*size)
    path = tmp_path / "sheet.fold"
    path.write_text(json.dumps(content))
    structure = Structure(linkages.load(str(path)))
    corners = np.array(content["vertices_coords"])
    for symbol in draw_symbols(structure):
        ends = corners[[int(vertex) for vertex in symbol["label"].split("-")]]
        place = structure.unit * np.array(symbol["place"])
        np.testing.assert_allclose(place[:2], ends.mean(axis=0), atol=1e-9)


def test_a_joint_of_several_bodies_has_one_name():
    joints = (
        Joint("A", "cylindrical", ("frame", "b", "c"), (0, 0, 0), UP),
        Joint("B", "revolute", ("frame", "c"), (1, 0, 0), (0, 1, 0)),
        Joint("C", "revolute", ("b", "c"), (0, 1, 0), (1, 0, 0)),
    )
    symbols = draw_symbols(Structure(Mechanism(joints)))
    assert [symbol["label"] for symbol in symbols] == ["A", "", "B", "C"]


@pytest.mark.parametrize("name", ["RSRS", "platform"])
def test_what_a_cut_spherical_joint_does_is_not_said_to_stand_still(name):
    symbols = make_view_document(mapped(name))["mechanism"]["symbols"]
    spherical = [one["columns"] for one in symbols if one["kind"] == "spherical"]
    assert None in spherical
    assert [] not in spherical


def test_a_sheet_has_a_panel_for_each_face_and_creases_are_their_sides(tmp_path):
    path = tmp_path / "pattern.fold"
    path.write_text(json.dumps(miura(3, 3, 0.8)))
    mechanism = linkages.load(path)
    structure = Structure(mechanism)
    bodies = draw_bodies(structure, structure.reference[None])
    panels = {one["name"]: structure.unit * np.array(one["panels"]) for one in bodies}
    assert {name: corners.shape for name, corners in panels.items()} == {
        f"f{number}": (1, 4, 3) for number in range(9)
    }
    for joint in mechanism.joints:
        for body in joint.bodies:
            middles = 0.5 * (panels[body][0] + np.roll(panels[body][0], 1, axis=0))
            gaps = np.linalg.norm(middles - joint.place, axis=1)
            assert gaps.min() < 1e-12
    assert held_body(mechanism) == "f4"


def test_panels_are_kept_scaled_and_mirrored(tmp_path):
    path = tmp_path / "pattern.fold"
    path.write_text(json.dumps(miura(3, 3, 0.8)))
    mechanism = linkages.load(path)
    again = mechanism_from(mechanism_subject(mechanism)["mechanism"], "again")
    assert again.panels == mechanism.panels
    corners = np.array([panel.corners for panel in mechanism.panels])
    larger = np.array([panel.corners for panel in mechanism.scaled(2.0).panels])
    image = np.array([panel.corners for panel in mechanism.mirrored().panels])
    np.testing.assert_array_equal(larger, 2 * corners)
    np.testing.assert_array_equal(image, corners * [1, 1, -1])


@pytest.mark.parametrize("name", ["slider-crank", "Watt", "Kempe"])
def test_a_form_is_first_shown_away_from_singular_points_and_from_one_line(name):
    atlas = mapped(name)
    structure = Structure(mechanism_of(atlas))
    document = make_view_document(atlas)
    for number, form in enumerate(atlas.forms):
        start = document["forms"][number]["start"]
        length = form.branch.length
        for point in atlas.points:
            for index, s in point.passes:
                if index == number:
                    gap = abs(start - s)
                    assert min(gap, length - gap) > length / 72
        places = form.branch(np.linspace(0.0, length, 50))
        breadth = breadths_of_mechanism(structure, form.branch(np.array([start])))[0]
        # no worse than half of the configurations that it can be in
        assert breadth > np.median(breadths_of_mechanism(structure, places))


@pytest.mark.parametrize(
    "panels", [5, [5], [{"body": "f0"}], [{"body": "f9", "corners": []}]]
)
def test_panels_that_are_none_are_refused(panels, tmp_path):
    path = tmp_path / "pattern.fold"
    path.write_text(json.dumps(miura(2, 2)))
    values = mechanism_subject(linkages.load(path))["mechanism"]
    with pytest.raises(GeometryError, match="panel"):
        mechanism_from(values | {"panels": panels}, "damaged")


def test_joints_that_make_one_cylindrical_joint_are_drawn_on_their_axis():
    mechanism = split(spatial_four_bar(), slide_first=False)
    unit = Structure(mechanism).unit
    symbols = draw_symbols(Structure(mechanism))
    assert len(symbols) == 7
    for symbol in symbols:
        joint = mechanism.joint(symbol["label"].replace("slide", "turn"))
        aside = np.array(symbol["place"]) - np.array(joint.point) / unit
        direction = np.array(joint.direction) / np.linalg.norm(joint.direction)
        assert np.linalg.norm(np.cross(aside, direction)) < 1e-9


def test_a_sheet_that_lies_flat_is_seen_as_it_is_drawn(tmp_path):
    path = tmp_path / "miura.fold"
    path.write_text(json.dumps(miura(2, 2)))
    flat, folded = (Structure(linkages.load(name)) for name in (path, "miura-ori"))
    assert best_view_of_mechanism(flat, flat.reference) == OVER_A_SHEET
    assert best_view_of_mechanism(folded, folded.reference) != OVER_A_SHEET
