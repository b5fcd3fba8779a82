"""Rigid origami from FOLD files."""

import json
from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest

import linkages
from bifurc import plot_singular_values, second_order_at
from bifurc.settings import SearchSettings
from bifurc.singular.point import Kind
from bifurc.system import jacobian_at
from linkages.app.texts.summary import certainty_in_short
from linkages.closure.closure import Closure
from linkages.file import LinkageFileError
from linkages.mechanisms.subject import mechanism_from, mechanism_subject
from linkages.readout.drawn import drawn_place
from linkages.readout.poses import Poses
from linkages.structure.single_loop import loop_geometry
from linkages.structure.structure import Structure
from linkages.subject import as_subject
from linkages.values import GeometryError
from linkages.viewing.start import start_of
from studies.miura import SECTOR, miura
from tests.linkages.mechanisms.test_maps import counts
from tests.maps import map_of
from tests.samples import one_in


def read(tmp_path, content, name="pattern.fold"):
    path = tmp_path / name
    text = content if isinstance(content, str) else json.dumps(content)
    path.write_text(text, encoding="utf-8")
    return linkages.load(str(path))


# Schenk and Guest 2013; Kumar, Feng, Guest 2021: from flat, a vertex of Miura's pattern
# folds two ways, and one pair of creases folds alone
def test_a_vertex_folds_two_ways_from_flat(tmp_path):
    mechanism = read(tmp_path, miura(2, 2)).with_free_creases()
    assert mechanism.name == "Miura-ori 2 x 2"
    assert [joint.name for joint in mechanism.joints] == ["1-4", "3-4", "4-5", "4-7"]
    assert mechanism.bodies == ("f0", "f1", "f2", "f3")
    atlas = map_of(mechanism, settings=SearchSettings(starts=60))
    assert counts(atlas) == (3, [Kind.BIFURCATION] * 3, [], 0)


@pytest.mark.parametrize("fold", [0.9, -0.4])
def test_a_sheet_with_fold_angles_is_folded_first(fold, tmp_path):
    mechanism = read(tmp_path, miura(4, 4, fold))
    assert mechanism.independent_loops == 9
    assert mechanism.gruebler == -30
    problem = Closure(mechanism)
    assert np.abs(problem.residuals(problem.reference[None])).max() < 1e-14
    values = np.linalg.svd(jacobian_at(problem, problem.reference), compute_uv=False)
    assert np.count_nonzero(values > 1e-9) == problem.n - 1  # it folds one way
    # panels along a zigzag: the dihedral angle that the file says
    poses = Poses(problem.structure)
    assert np.allclose(poses.at(problem.reference[None]), np.eye(4))
    first, second = (np.array(mechanism.joint(n).direction) for n in ("1-6", "6-11"))
    half = np.arctan(np.tan(fold / 2) * np.cos(SECTOR))
    straight = [np.array(mechanism.joint(n).direction) for n in ("5-6", "6-7")]
    assert straight[0] @ straight[1] < 1.0 - 1e-3  # lines are straight only when flat
    assert abs(half) < abs(fold / 2)
    assert first @ second < np.cos(np.pi - 2 * SECTOR)


def test_folded_coordinates_are_the_same_state_as_fold_angles(tmp_path):
    flat = read(tmp_path, miura(3, 3))
    folded = read(tmp_path, miura(3, 3, 0.8))
    problem = Closure(flat)
    content = miura(3, 3, 0.8)
    angles = dict(
        zip(
            [f"{a}-{b}" for a, b in content["edges_vertices"]],
            np.radians(content["edges_foldAngle"]),
            strict=True,
        )
    )
    point = np.array([angles[name] for name in problem.domain.names])
    poses = Poses(problem.structure).at(point[None])[0]
    places = np.zeros((len(content["vertices_coords"]), 3))
    for number, face in enumerate(content["faces_vertices"]):
        pose = poses[flat.bodies.index(f"f{number}")]
        for vertex in face:
            at = np.array([*content["vertices_coords"][vertex], 0.0])
            places[vertex] = pose[:3, :3] @ at + pose[:3, 3]
    state = {
        "frame_classes": ["foldedForm"],
        "frame_inherit": True,
        "frame_parent": 0,
        "vertices_coords": places.tolist(),
    }
    given = read(tmp_path, {**content, "file_frames": [state]})
    for joint in given.joints:
        other = folded.joint(joint.name)
        assert joint.bodies == other.bodies
        assert np.allclose(joint.point, other.point, atol=1e-12)
        assert np.allclose(joint.direction, other.direction, atol=1e-12)


def test_a_valley_is_a_positive_angle_that_lifts_the_panel(tmp_path):
    mechanism = read(tmp_path, miura(2, 2))
    problem = Closure(mechanism)
    content = miura(2, 2, 0.3)
    angles = {
        f"{a}-{b}": np.radians(angle)
        for (a, b), angle in zip(
            content["edges_vertices"], content["edges_foldAngle"], strict=True
        )
    }
    point = np.array([angles[name] for name in problem.domain.names])
    assert np.abs(problem.residuals(point[None])).max() < 1e-15
    for joint in mechanism.joints:
        base, moved = (mechanism.bodies.index(body) for body in joint.bodies)
        poses = Poses(problem.structure).at(point[None])[0]
        relative = np.linalg.inv(poses[base]) @ poses[moved]
        corners = content["faces_vertices"][int(joint.bodies[1][1:])]
        corners = [[*content["vertices_coords"][k], 0.0, 1.0] for k in corners]
        heights = (relative @ np.array(corners).T)[2]
        is_valley = angles[joint.name] > 0
        assert (heights.max() > 1e-3) == is_valley
        assert (heights.min() < -1e-3) != is_valley


def test_flat_edges_join_panels_and_cuts_part_them(tmp_path):
    content = miura(3, 3, 0.8)
    letters = content["edges_assignment"]
    inner = content["edges_vertices"].index([5, 6])
    whole = read(tmp_path, content)
    letters[inner] = "F"
    content["edges_foldAngle"] = [0.0] * len(letters)
    joined = read(tmp_path, content)
    assert len(joined.bodies) == len(whole.bodies) - 1
    assert len(joined.joints) == len(whole.joints) - 1
    letters[inner] = "C"
    cut = read(tmp_path, content)
    assert len(cut.bodies) == len(whole.bodies)
    assert len(cut.joints) == len(whole.joints) - 1


def test_two_parts_of_one_crease_are_one_joint(tmp_path):
    content = miura(2, 2)
    # a vertex on the crease from 4 to 7
    (x, y), (u, v) = (content["vertices_coords"][k] for k in (4, 7))
    content["vertices_coords"].append([0.5 * (x + u), 0.5 * (y + v)])
    edge = content["edges_vertices"].index([4, 7])
    content["edges_vertices"][edge] = [4, 9]
    content["edges_vertices"].append([9, 7])
    content["edges_assignment"].append(content["edges_assignment"][edge])
    content["edges_foldAngle"].append(0.0)
    for face in content["faces_vertices"]:
        for first, second in ((4, 7), (7, 4)):
            ring = [*face, face[0]]
            for k in range(len(face)):
                if ring[k : k + 2] == [first, second]:
                    face.insert(k + 1, 9)
                    break
    mechanism = read(tmp_path, content)
    assert len(mechanism.joints) == 4


def test_fold_angles_that_are_rounded_are_moved_with_a_warning(tmp_path, caplog):
    content = miura(3, 3, 0.8)
    content["edges_foldAngle"] = [round(a, 1) for a in content["edges_foldAngle"]]
    problem = Closure(read(tmp_path, content))
    assert np.abs(problem.residuals(problem.reference[None])).max() < 1e-12
    assert "edges_foldAngle: moved by up to 0.0" in caplog.text


def test_fold_angles_that_do_not_close_are_refused_with_what_they_miss(tmp_path):
    content = miura(3, 3, 0.8)
    content["edges_foldAngle"] = [abs(a) for a in content["edges_foldAngle"]]
    with pytest.raises(
        LinkageFileError, match=r"edges_foldAngle: not closed, by a gap"
    ):
        read(tmp_path, content)


@pytest.mark.parametrize("letter", ["M", "V", "U"])
def test_a_crease_that_is_no_side_of_a_face_is_refused_by_name(tmp_path, letter):
    content = miura(3, 3, 0.8)
    del content["edges_foldAngle"]
    ends = content["faces_vertices"][0]
    content["edges_vertices"].append([ends[0], ends[2]])
    content["edges_assignment"].append(letter)
    message = f'edge: {ends[0]}-{ends[2]}, "{letter}", is not allowed'
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, content)
    content["edges_assignment"][-1] = "F"  # a line on a panel holds nothing
    read(tmp_path, content)


def test_a_flap_that_is_free_is_an_unknown_of_the_map(tmp_path):
    content = miura(2, 2)
    first = len(content["vertices_coords"])
    below, above = (content["vertices_coords"][k] for k in (5, 8))
    content["vertices_coords"] += [[below[0] + 1, below[1]], [above[0] + 1, above[1]]]
    content["edges_assignment"][content["edges_vertices"].index([5, 8])] = "V"
    content["edges_vertices"] += [[5, first], [first, first + 1], [8, first + 1]]
    content["edges_assignment"] += ["B"] * 3
    content["edges_foldAngle"] += [0.0] * 3
    content["faces_vertices"] += [[5, first, first + 1, 8]]
    sheet = read(tmp_path, content)
    held = map_of(sheet)
    free = map_of(replace(sheet, with_flaps=True))
    assert (held.mobility, free.mobility) == (1, 2)
    (form,), (surface,) = held.forms, free.surfaces
    # each form times what the flap turns through
    area = np.pi * form.branch.length
    assert surface.charts.area == pytest.approx(area, rel=0.02)
    freely = replace(sheet.with_free_creases(), with_flaps=True)
    assert map_of(freely).mobility == 2
    assert loop_geometry(freely).n == 4


# --- thick panels ---------------------------------------------------------------------


FIRST, SECOND = np.radians(60), np.radians(100)
RATIO = np.sin(FIRST) / np.sin(SECOND)  # of the steps of a Bennett linkage
SECTORS = FIRST, SECOND, np.pi - FIRST, np.pi - SECOND


def vertex(**values):
    """Four creases that meet at one vertex, at angles with which it folds flat."""
    angles = np.cumsum([0.0, *SECTORS[:3]])
    ends = [[np.cos(angle), np.sin(angle)] for angle in angles]
    return {
        "vertices_coords": [[0.0, 0.0], *ends],
        "faces_vertices": [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
        "edges_vertices": [[0, 1], [0, 2], [0, 3], [0, 4]],
        "edges_assignment": ["M", "M", "M", "V"],
        **values,
    }


def heights(signs, ratio=RATIO):
    """Heights of four hinges, with steps a, b, a, b of these signs between them."""
    steps = 0.1 * np.array([ratio, 1.0, ratio, 1.0]) * signs
    return [0.0, *np.cumsum(steps[:3]).tolist()]


# Chen, Peng and You 2015: a thick vertex of four creases is a Bennett linkage
@pytest.mark.parametrize("signs", [(1, 1, -1, -1), (1, -1, -1, 1)])
def test_a_thick_vertex_moves_as_a_bennett_linkage(signs, tmp_path):
    content = vertex(**{"bifurc:edges_height": heights(signs)})
    # heights say which side comes together, whatever the letters say
    atlas = map_of(read(tmp_path, content).with_free_creases())
    assert len(atlas.forms) == 1
    assert atlas.forms[0].branch.closed


@pytest.mark.parametrize(
    "values",
    [
        {"bifurc:thickness": 0.1},
        {"bifurc:edges_height": heights((1, 1, -1, -1), ratio=1.1)},
    ],
)
def test_another_thick_vertex_does_not_move(values, tmp_path):
    atlas = map_of(read(tmp_path, vertex(**values)))
    assert not atlas.forms


def test_hinges_are_on_the_faces_that_come_together(tmp_path):
    given = {"bifurc:thickness": 0.2, "bifurc:edges_height": [None, 0.3, None, None]}
    mechanism = read(tmp_path, vertex(**given))
    places = {joint.name: joint.place[2] for joint in mechanism.joints}
    assert places == {"0-1": -0.1, "0-2": 0.3, "0-3": -0.1, "0-4": 0.1}
    # seen from below: what was a valley is on the other side of the paper
    faces = [face[::-1] for face in vertex()["faces_vertices"]]
    below = read(tmp_path, vertex(**given, faces_vertices=faces))
    assert {joint.name: -joint.place[2] for joint in below.joints} == places


def changed(**values):
    content = {**miura(3, 3, 0.8), **values}
    return {key: value for key, value in content.items() if value is not None}


COUNT = len(miura(3, 3)["edges_vertices"])
LETTERS = miura(3, 3, 0.8)["edges_assignment"]
ENDS = miura(3, 3)["edges_vertices"]
FACES = miura(3, 3)["faces_vertices"]
POINTS = miura(3, 3)["vertices_coords"]
MALFORMED = {
    "no JSON": ("{", r"content: no JSON"),
    "no table": ("[]", r"content: .* a table"),
    "no vertices": (changed(vertices_coords=None), "vertices_coords: a missing key"),
    "a vertex of one number": (
        changed(vertices_coords=[[0.0], *POINTS[1:]]),
        r"vertices_coords\[0\]: \[0.0\]",
    ),
    "a vertex that is a text": (
        changed(vertices_coords=[["x", 0], *POINTS[1:]]),
        r'vertices_coords\[0\]: "x"',
    ),
    "no faces and no edges": (
        changed(faces_vertices=None, edges_vertices=None),
        "edges_vertices: a missing key",
    ),
    "a face of two": (
        changed(faces_vertices=[[0, 1], *FACES[1:]]),
        r"faces_vertices\[0\]: \[0, 1\]",
    ),
    "a vertex too many": (
        changed(faces_vertices=[[0, 1, 99], *FACES[1:]]),
        r"faces_vertices\[0\]: 99 .* from 0 to 15",
    ),
    "a vertex twice": (
        changed(faces_vertices=[[0, 1, 1, 5], *FACES[1:]]),
        r"faces_vertices\[0\]: .* 1 stands twice",
    ),
    "a face turned round": (
        changed(faces_vertices=[FACES[0][::-1], *FACES[1:]]),
        r"faces_vertices: \d+-\d+ in f0 and f1 .* oriented alike",
    ),
    "letters too few": (
        changed(edges_assignment=LETTERS[1:]),
        rf"number of edges_assignment: {COUNT - 1} .* {COUNT}",
    ),
    "an unknown letter": (
        changed(edges_assignment=["X", *LETTERS[1:]]),
        r'edges_assignment\[0\]: "X" .* one of M, V',
    ),
    "edges missing": (changed(edges_vertices=None), "edges_vertices: a missing key"),
    "an edge of three": (
        changed(edges_vertices=[[0, 1, 2], *ENDS[1:]]),
        r"edges_vertices\[0\]: \[0, 1, 2\]",
    ),
    "an angle too large": (
        changed(edges_foldAngle=[200, *[0] * (COUNT - 1)]),
        r"edges_foldAngle\[0\]: 200 .* -180 to 180",
    ),
    "angles of a sheet that is folded already": (
        changed(vertices_coords=[[*POINTS[0], 1.0], *POINTS[1:]]),
        r"vertices_coords: heights 1 apart",
    ),
    "a thickness below 0": (
        changed(**{"bifurc:thickness": -1}),
        r"bifurc:thickness: -1 .* 0 or more",
    ),
    "a thickness that is a text": (
        changed(**{"bifurc:thickness": "thin"}),
        r'bifurc:thickness: "thin"',
    ),
    "heights too few": (
        changed(**{"bifurc:edges_height": [0.1]}),
        rf"number of bifurc:edges_height: 1 .* {COUNT}",
    ),
    "a height that is a text": (
        changed(**{"bifurc:edges_height": ["x", *[0] * (COUNT - 1)]}),
        r'bifurc:edges_height\[0\]: "x"',
    ),
    "thick panels, folded": (
        changed(frame_classes=["foldedForm"], **{"bifurc:thickness": 0.1}),
        r"bifurc:thickness: .* flat crease pattern",
    ),
    "a parent that comes later": (
        changed(file_frames=[{"frame_inherit": True, "frame_parent": 3}]),
        r"frame_parent of file_frames\[1\]: 3",
    ),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_file_is_refused_by_name_and_value(name, tmp_path):
    content, message = MALFORMED[name]
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, content)


def test_a_sheet_with_one_crease_folds_in_half(tmp_path):
    """As `examples/diagonal-cp.fold` of edemaine/fold; nothing closes a loop."""
    content = {
        "vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [3, 1]],
        "edges_assignment": ["B", "B", "B", "B", "V"],
        "edges_foldAngle": [0, 0, 0, 0, 180],
    }
    atlas = map_of(read(tmp_path, content))
    (form,) = atlas.forms
    assert form.branch.length == pytest.approx(np.pi)
    assert len(plot_singular_values(atlas).axes) == 1
    assert 0.0 <= start_of(atlas, 0) <= form.branch.length


def test_an_angle_that_rounding_makes_wrong_is_at_the_limit(tmp_path):
    content = miura(2, 2)
    letters = content["edges_assignment"]
    signs = {"M": 1e-20, "V": -1e-20}
    content["edges_foldAngle"] = [signs.get(letter, 0.0) for letter in letters]
    for one in read(tmp_path, content).creases:
        assert one.angle == 0.0
        assert 0.0 in one.limits


def test_a_flap_is_held_and_said_to_be_free(tmp_path):
    cut = [1, 5]
    letters = ["C" if x == cut else y for x, y in zip(ENDS, LETTERS, strict=True)]
    mechanism = read(tmp_path, changed(edges_assignment=letters))
    flaps = {one.joint: one for one in Structure(mechanism).hanging.joints}
    assert flaps["4-5"].bodies == ("f0",)
    assert flaps["4-5"].spaces == ("an interval",)
    free = Structure(mechanism.with_free_creases()).hanging.joints
    assert {one.spaces for one in free if one.joint == "4-5"} == {("a circle",)}


# --- assignments ----------------------------------------------------------------------

# a flat vertex whose opposite sectors add up to 180 degrees (Kawasaki), in degrees
FLAT_SECTORS = 60.0, 80.0, 120.0, 100.0


def flat_vertex(letters, **keys):
    places = np.radians(np.cumsum([0.0, *FLAT_SECTORS[:-1]]))
    around = [[float(np.cos(place)), float(np.sin(place))] for place in places]
    after = [2, 3, 4, 1]
    return {
        "vertices_coords": [[0.0, 0.0], *around],
        "edges_vertices": [*([0, k] for k in (1, 2, 3, 4))]
        + [[k, after[k - 1]] for k in (1, 2, 3, 4)],
        "edges_assignment": [*letters, *"BBBB"],
        "faces_vertices": [[0, k, after[k - 1]] for k in (1, 2, 3, 4)],
        **keys,
    }


# Maekawa: mountains and valleys differ by two; the creases beside the smallest sector
# differ (Bern and Hayes 1996)
@pytest.mark.parametrize("letters", one_in(2, map("".join, product("MV", repeat=4))))
def test_a_vertex_folds_as_assigned_where_theorems_say_so(letters, tmp_path):
    is_foldable = abs(letters.count("M") - 2) == 1 and letters[0] != letters[1]
    mechanism = read(tmp_path, flat_vertex(letters))
    atlas = linkages.map_linkage(mechanism)
    names = [form.name for form in atlas.forms]
    assert names == ["Form 1 (as assigned)"] * is_foldable
    free = linkages.map_linkage(mechanism.with_free_creases())
    assert len(free.forms) == 2
    named = [form for form in free.forms if form.name.endswith("(as assigned)")]
    assert len(named) == is_foldable


def test_the_flat_state_in_a_corner_of_the_assignment_is_in_no_doubt(tmp_path):
    atlas = linkages.map_linkage(read(tmp_path, flat_vertex("MVVV")))
    assert [point.kind for point in atlas.points] == [Kind.RANK_DROP] * 2
    assert not atlas.completeness.doubts
    lone = linkages.map_linkage(read(tmp_path, flat_vertex("VVVV")))
    assert not lone.points and not lone.completeness.doubts
    assert np.allclose(lone.rigid, 0.0) and len(lone.rigid) == 1


def test_a_flat_sheet_folds_one_way_as_assigned_and_is_in_no_doubt(tmp_path):
    atlas = linkages.map_linkage(read(tmp_path, miura(3, 3)))
    assert [form.name for form in atlas.forms] == ["Form 1 (as assigned)"]
    kinds = [point.kind for point in atlas.points]
    # surfaces meet there, too, but outside the limits
    assert kinds == [Kind.RANK_DROP] * 2
    assert not atlas.completeness.doubts


def test_a_vertex_of_six_creases_has_three_freedoms_within_its_assignment(tmp_path):
    corners = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
    ]
    around = [1, 2, 3, 4, 5, 6]
    rim = list(zip(around, [*around[1:], 1], strict=True))
    waterbomb = {
        "vertices_coords": [[0.0, 0.0], *corners],
        "edges_vertices": [*([0, k] for k in around), *map(list, rim)],
        "edges_assignment": [*"VVMVVM", *"BBBBBB"],
        "faces_vertices": [[0, *side] for side in rim],
    }
    atlas = linkages.map_linkage(read(tmp_path, waterbomb))
    assert [surface.dimension for surface in atlas.surfaces] == [3]
    assert not atlas.forms
    in_short = certainty_in_short(atlas.completeness)
    assert in_short.count("(") == in_short.count(")") == 2
    assert "; without limits, " in in_short


def test_faces_come_from_edges_where_they_are_not_given(tmp_path):
    content = miura(4, 3)
    given = read(tmp_path, content)
    del content["faces_vertices"]
    found = read(tmp_path, content)
    names = sorted(joint.name for joint in given.joints)
    assert sorted(joint.name for joint in found.joints) == names
    outlines = [
        {tuple(sorted(one.corners)) for one in m.panels} for m in (given, found)
    ]
    assert outlines[0] == outlines[1]


def test_a_crease_that_ends_inside_a_face_folds_nothing(tmp_path, caplog):
    content = flat_vertex("VVVV")
    del content["faces_vertices"]
    content["vertices_coords"].append([0.2, 0.1])
    content["edges_vertices"].append([0, 5])
    content["edges_assignment"].append("V")
    found = read(tmp_path, content)
    assert len(found.joints) == 4
    assert "creases that end inside of a face fold nothing: 0-5" in caplog.text


def test_angles_and_folded_coordinates_leave_the_same_way_to_go(tmp_path):
    content = miura(3, 3, 0.8)
    by_angles = read(tmp_path, content)
    given = {one.joint: one for one in by_angles.creases}
    coordinates = folded_coordinates(
        by_angles, len(content["vertices_coords"]), content
    )
    folded = {
        **content,
        "frame_classes": ["foldedForm"],
        "vertices_coords": coordinates,
    }
    del folded["edges_foldAngle"]
    for crease in read(tmp_path, folded).creases:
        assert crease.letter == given[crease.joint].letter
        assert crease.angle == pytest.approx(given[crease.joint].angle, abs=1e-9)


def folded_coordinates(mechanism, count, content):
    """The vertices (count, 3) of a sheet in the reference configuration."""
    places = np.zeros((count, 3))
    by_body = {panel.body: panel.corners for panel in mechanism.panels}
    for number, face in enumerate(content["faces_vertices"]):
        places[face] = by_body[f"f{number}"]
    return places.tolist()


def test_a_crease_that_is_folded_against_its_letter_is_free_and_named(tmp_path, caplog):
    content = miura(3, 3, 0.8)
    wrong = content["edges_assignment"].index("V")
    content["edges_assignment"][wrong] = "M"
    name = "-".join(map(str, content["edges_vertices"][wrong]))
    mechanism = read(tmp_path, content)
    assert mechanism.joint(name).limits == (None,)
    assert f"crease {name} is M and folded by" in caplog.text


def test_an_assignment_survives_mirroring_and_json(tmp_path):
    mechanism = read(tmp_path, miura(3, 3, 0.8))
    values = json.loads(json.dumps(mechanism_subject(mechanism)))
    assert mechanism_from(values["mechanism"], "m").creases == mechanism.creases
    back = mechanism.mirrored().mirrored()
    assert back.creases == mechanism.creases
    for crease in mechanism.mirrored().creases:
        (limits,) = mechanism.mirrored().joint(crease.joint).limits
        assert limits == pytest.approx(crease.limits)


# Abel et al. 2016, theorem 4: from flat a vertex folds as assigned where three creases of
# one letter, within no half plane, and one of the other letter are among its creases
def vertex_of(turns, letters):
    """A vertex with creases in directions ``turns`` (k,), rad, assigned by letters."""
    count = len(turns)
    corners = np.transpose([np.cos(turns), np.sin(turns)]).tolist()
    return {
        "vertices_coords": [[0.0, 0.0], *corners],
        "faces_vertices": [[0, 1 + k, 1 + (k + 1) % count] for k in range(count)],
        "edges_vertices": [[0, 1 + k] for k in range(count)],
        "edges_assignment": list(letters),
    }


@pytest.mark.parametrize(
    ("letters", "folds"),
    [("VVMMVMVV", True), ("VVVVMMMM", False)],
)
def test_a_vertex_of_eight_creases_leaves_the_flat_state_where_it_can(
    letters, folds, tmp_path
):
    turns = np.radians([0.0, 41.2, 81.3, 140.4, 190.1, 214.4, 272.4, 327.8])
    drawn = drawn_place(map_of(read(tmp_path, vertex_of(turns, letters))))
    there = "surface 1" if folds else "a rigid assembly"
    assert drawn.name.split(" or ")[0] == there


def has_birds_foot(turns, letters):
    """Whether three creases that leave no half-plane free fold one way, and another one
    folds the other way: a flat vertex folds as it is assigned if and only if it has such
    (Abel, Cantarella, Demaine, Eppstein, Hull, Ku, Lang and Tachi 2016)."""
    for one in combinations(range(len(turns)), 3):
        own = {letters[k] for k in one}
        gaps = np.diff([*turns[list(one)], turns[one[0]] + 2 * np.pi])
        if len(own) == 1 and gaps.max() < np.pi and own != set(letters):
            return True
    return False


def random_vertex(seed):
    """Directions of 4 to 8 creases from a flat vertex, none next to another one, and
    their letters."""
    rng = np.random.default_rng(seed)
    count = rng.integers(4, 9)
    while True:
        turns = np.sort(rng.uniform(0.0, 2 * np.pi, size=count))
        gaps = np.diff([*turns, turns[0] + 2 * np.pi])
        if gaps.min() > 0.05 and gaps.max() < np.pi - 0.05:
            return turns, rng.choice(["V", "M"], size=count).tolist()


@pytest.mark.parametrize("seed", one_in(25, range(1000)))
def test_a_flat_vertex_is_held_unless_it_has_a_birds_foot(seed, tmp_path):
    turns, letters = random_vertex(seed)
    problem = Closure(read(tmp_path, vertex_of(turns, letters)))
    second = second_order_at(problem, problem.reference)
    assert second.is_prestress_stable != has_birds_foot(turns, letters)


def test_two_creases_on_a_line_fold_while_the_others_stay_flat(tmp_path):
    """Of what leads away without limits no sample is within them."""
    turns = np.radians([0.0, 45.0, 90.0, 180.0, 225.0, 270.0])
    atlas = map_of(read(tmp_path, vertex_of(turns, "MVVVVM")))
    (form,) = atlas.forms
    assert form.branch.length == pytest.approx(np.pi * np.sqrt(2.0))
    assert not atlas.completeness.doubts


def test_panels_bend_along_their_shortest_diagonals(tmp_path):
    # a panel with a notch beside a rectangle
    content = {
        "vertices_coords": [[0, 0], [2, 0], [2, 1], [0, 1], [3, 2], [1, 1.2], [-1, 2]],
        "faces_vertices": [[0, 1, 2, 3], [3, 2, 4, 5, 6]],
        "bifurc:triangulated": True,
    }
    mechanism = read(tmp_path, content)
    names = {joint.name for joint in mechanism.joints}
    assert len(mechanism.panels) == 5 and len(names) == 4
    assert {"2-3", "2-5", "3-5"} < names
    area = sum(
        0.5 * np.linalg.norm(np.cross(b - a, c - a))
        for a, b, c in (np.array(panel.corners) for panel in mechanism.panels)
    )
    assert area == pytest.approx(2.0 + 1.4)  # by the shoelace formula
    with pytest.raises(LinkageFileError, match="bifurc:triangulated: 1 is not allowed"):
        read(tmp_path, content | {"bifurc:triangulated": 1})


@pytest.mark.parametrize("name", ["pattern.fold", "pattern.cp", "pattern.svg"])
def test_panels_bend_by_an_option_as_by_the_key(name, tmp_path):
    """Whatever the format: a square sheet with one crease across it."""
    texts = {
        "fold": json.dumps(
            {
                "vertices_coords": [[0, 0], [2, 0], [4, 0], [4, -4], [2, -4], [0, -4]],
                "edges_vertices": [
                    [0, 1],
                    [1, 2],
                    [2, 3],
                    [3, 4],
                    [4, 5],
                    [5, 0],
                    [1, 4],
                ],
                "edges_assignment": list("BBBBBBM"),
            }
        ),
        "cp": "1 0 0 4 0\n1 4 0 4 4\n1 4 4 0 4\n1 0 4 0 0\n2 2 0 2 4\n",
        "svg": '<svg><rect width="4" height="4" stroke="black"/>'
        '<line x1="2" x2="2" y2="4" stroke="red"/></svg>',
    }
    text = texts[name.partition(".")[2]]
    bodies = [2, 4]
    for triangulated, count in zip((False, True), bodies, strict=True):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        sheet = linkages.load(path, triangulated=triangulated)
        assert len(sheet.panels) == count and len(sheet.joints) == count - 1
    if name.endswith("fold"):
        keyed = read(tmp_path, json.loads(text) | {"bifurc:triangulated": True})
        assert keyed == sheet


def test_an_option_bends_the_panels_of_a_frame_inside_of_a_file(tmp_path):
    frame = {**miura(2, 2, 0.8), "frame_inherit": False}
    path = tmp_path / "frames.fold"
    path.write_text(json.dumps({"file_frames": [frame]}), encoding="utf-8")
    assert len(linkages.load(path, triangulated=True).panels) == 8


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("bennett", "a crease pattern: a sheet by name, or a FOLD, CP or SVG file"),
        ("scissors", "a crease pattern: a sheet by name"),
        ("none.toml", "none.toml: has no panels to triangulate"),
        ("none.urdf", "none.urdf: has no panels to triangulate"),
    ],
)
def test_only_a_crease_pattern_is_triangulated(source, words):
    with pytest.raises((GeometryError, LinkageFileError), match=words):
        linkages.load(source, triangulated=True)


def test_a_bent_miura_ori_has_one_freedom_more_a_diagonal_at_its_vertex(tmp_path):
    folded = read(tmp_path, miura(2, 2, 0.8))
    bent = read(tmp_path, miura(2, 2, 0.8) | {"bifurc:triangulated": True})
    ranks = [
        np.linalg.matrix_rank(problem.jacobians(problem.reference[None])[0], tol=1e-8)
        for problem in (Closure(folded), Closure(bent))
    ]
    assert Closure(folded).n - ranks[0] == 1
    # two of the four diagonals cut off corners that are flaps
    assert Closure(bent).n == Closure(folded).n + 2
    assert Closure(bent).n - ranks[1] == 3


def test_a_sheet_that_folds_along_one_line_is_not_seen_from_its_edge(tmp_path):
    turns = np.radians([0.0, 45.0, 90.0, 180.0, 225.0, 270.0])
    subject = as_subject(read(tmp_path, vertex_of(turns, "MVVVVM")))
    assert subject.parts.normal is not None
    assert subject.parts.best_view(subject.readout.structure.reference).elevation > 30.0


def test_a_grid_of_panels_with_an_assignment_is_answered(tmp_path):
    """Polygons of charts beside bounds that are left empty."""
    corners = [(i, j) for j in range(3) for i in range(4)]
    content = {
        "vertices_coords": corners,
        "faces_vertices": [
            [4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4]
            for j in range(2)
            for i in range(3)
        ],
        "edges_vertices": [[1, 5], [2, 6], [4, 5], [5, 6], [5, 9], [6, 7], [6, 10]],
        "edges_assignment": list("VVVMVVM"),
    }
    assert map_of(read(tmp_path, content)).forms
