"""Points on a sphere and arcs between them."""

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.file import LinkageFileError
from linkages.files.arcs import read_arcs
from linkages.readout.readout import Readout
from linkages.values import GeometryError

DEGREE = np.pi / 180
POINTS = {"A": [0, 0, 1], "B": [0.1, 0.4, 1], "C": [0.9, 0.8, 1], "D": [0.8, 0, 1]}
ARCS = [["A", "B"], ["B", "C"], ["C", "D"]]
FEW = SearchSettings(starts=60)


def content(**values):
    return {"fixed": ["A", "D"], "arcs": ARCS, "points": POINTS} | values


def six_bar():
    return read_arcs(
        content(
            arcs=[*ARCS, ["E", "F"], ["F", "G"]],
            points=POINTS | {"F": [1.6, 1.4, 1]},
            points_on_arcs={"E": ["B", "C", [20, 35]], "G": ["C", "D", [15, -20]]},
        ),
        "six-bar",
        DEGREE,
    )


def angle(first, second):
    return np.arctan2(np.linalg.norm(np.cross(first, second)), np.dot(first, second))


def test_four_arcs_are_the_twists_of_a_spherical_four_bar():
    mechanism = read_arcs(content(), "four-bar", DEGREE)
    single = Readout(mechanism).single_loop
    assert single is not None
    expected = [angle(POINTS[a], POINTS[b]) for a, b in ("AB", "BC", "CD", "DA")]
    assert np.abs(single.loop.lengths).max() < 1e-15
    # the sense of an axis, and with it a twist or the rest of half a turn, is free
    assert sorted(np.sin(single.loop.twists) ** 2) == pytest.approx(
        sorted(np.sin(expected) ** 2)
    )


def test_arcs_keep_their_angles_and_points_on_them_along_every_form():
    mechanism = six_bar()
    assert mechanism.bodies == ("frame", "A-B", "B-C", "C-D", "E-F", "F-G")
    atlas = linkages.map_linkage(mechanism, settings=FEW)
    assert len(atlas.forms) == 4
    readout = Readout(mechanism)
    for form in atlas.forms:
        poses = readout.poses(form.branch.sample(50))
        assert np.abs(poses[:, :, :3, 3]).max() < 1e-12  # the centre stands still
        for joint in mechanism.joints:
            places = [
                poses[:, mechanism.bodies.index(body), :3, :3] @ joint.place
                for body in joint.bodies
            ]
            np.testing.assert_allclose(places[0], places[1], atol=1e-12)


def test_a_point_on_an_arc_is_so_far_along_and_so_far_aside():
    joints = {joint.name: joint.place for joint in six_bar().joints}
    normal = np.cross(joints["B"], joints["C"])
    assert 90 - angle(joints["E"], normal) / DEGREE == pytest.approx(35)
    foot = joints["E"] - (joints["E"] @ normal) * normal / (normal @ normal)
    assert angle(joints["B"], foot) / DEGREE == pytest.approx(20)


def test_points_are_moved_until_arcs_have_their_angles():
    arcs = [["A", "B", 30], ["B", "C", 40], ["C", "D"]]
    mechanism = read_arcs(content(arcs=arcs), "four-bar", DEGREE)
    places = {joint.name: joint.place for joint in mechanism.joints}
    assert angle(places["A"], places["B"]) == pytest.approx(30 * DEGREE, abs=1e-14)
    assert angle(places["B"], places["C"]) == pytest.approx(40 * DEGREE, abs=1e-14)
    expected = angle(POINTS["C"], POINTS["D"])
    assert angle(places["C"], places["D"]) == pytest.approx(expected, abs=1e-14)


def test_an_arc_between_points_of_one_body_is_part_of_it():
    fixed = read_arcs(content(arcs=[*ARCS, ["A", "D"]]), "four-bar", DEGREE)
    assert fixed.bodies == ("frame", "A-B", "B-C", "C-D")


def test_angles_in_radians(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text(
        'angles = "rad"\nfixed = ["A", "D"]\n'
        'arcs = [["A", "B", 0.5], ["B", "C"], ["C", "D"]]\n[points]\n'
        + "".join(f"{name} = {place}\n" for name, place in POINTS.items())
    )
    places = {joint.name: joint.place for joint in linkages.load(path).joints}
    assert angle(places["A"], places["B"]) == pytest.approx(0.5, abs=1e-14)


BAD = {
    "no points": (content(points={}), "points"),
    "a point of two numbers": (content(points=POINTS | {"B": [1, 2]}), "point B"),
    "a point in the centre": (content(points=POINTS | {"B": [0, 0, 0]}), "point B"),
    "a point that is no number": (
        content(points=POINTS | {"B": [0, "x", 0]}),
        "point B",
    ),
    "a point on no arc": (content(points=POINTS | {"E": [1, 1, 1]}), "point E"),
    "an unknown fixed point": (content(fixed=["A", "X"]), "fixed"),
    "no arcs": (content(arcs=[]), "arcs"),
    "an arc of one point": (content(arcs=[*ARCS, ["A"]]), r"arcs\[4\]"),
    "an arc to an unknown point": (content(arcs=[*ARCS, ["A", "X"]]), r"arcs\[4\]"),
    "an arc to itself": (content(arcs=[*ARCS, ["A", "A"]]), r"arcs\[4\]"),
    "an arc given twice": (content(arcs=[*ARCS, ["B", "A"]]), r"arcs\[4\]"),
    "two arcs of one name": (
        content(
            arcs=[["A-B", "C"], ["A", "B-C"]],
            points=POINTS | {"A-B": [1, 2, 0], "B-C": [0, 2, 1]},
        ),
        'arcs "A-B" to "C" and "A" to "B-C": "A-B-C"',
    ),
    "an arc without length": (
        content(points=POINTS | {"B": [0, 0, 3]}),
        "arc A-B",
    ),
    "an arc of half a turn": (
        content(arcs=[["A", "B", 180], *ARCS[1:]]),
        r"angle of arcs\[1\]",
    ),
    "an arc between opposite points": (
        content(
            points=POINTS | {"C": [-x for x in POINTS["B"]]},
            arcs=[["A", "B", 25], ["B", "C"], ["C", "D"]],
        ),
        "arc B-C: between points .* opposite",
    ),
    "an arc that cannot fit": (
        content(arcs=[["A", "B", 5], ["B", "C", 5], ["C", "D", 5]]),
        "misses its angle by",
    ),
    "a point on an arc that is not there": (
        content(points_on_arcs={"E": ["A", "C", [10, 10]]}),
        "points_on_arcs E",
    ),
    "a point on an arc with one angle": (
        content(points_on_arcs={"E": ["A", "B", [10]]}),
        "points_on_arcs E",
    ),
    "a point on an arc named as another": (
        content(points_on_arcs={"C": ["A", "B", [10, 5]]}),
        "points_on_arcs C",
    ),
    "a point on an arc of later points": (
        content(points_on_arcs={"E": ["A", "F", [10, 5]]}),
        "points_on_arcs E",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_wrong_is_named(what):
    given, place = BAD[what]
    with pytest.raises(GeometryError, match=place):
        read_arcs(given, "bad", DEGREE)


def test_an_unknown_key_is_named_with_the_nearest(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text('arcs = [["A", "B"]]\npoint_on_arcs = 1\n[points]\nA = [0, 0, 1]\n')
    with pytest.raises(LinkageFileError, match="the nearest is 'points_on_arcs'"):
        linkages.load(path)
