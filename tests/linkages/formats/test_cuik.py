import logging

import numpy as np
import pytest

from linkages import load, map_linkage
from linkages.file import LinkageFileError
from linkages.structure.hanging import Hanging
from tests.linkages.formats.worlds import CASES, world_text
from tests.samples import one_in

MAPPED = [name for name, case in CASES.items() if case["facts"] is not None]


def read(tmp_path, text, name="m.world"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return load(path)


@pytest.mark.parametrize("name", CASES)
def test_a_world_is_read_in_a_closed_configuration(name, tmp_path, caplog):
    case = CASES[name]
    with caplog.at_level(logging.WARNING):
        mechanism = read(tmp_path, world_text(case))
    assert len(mechanism.bodies) == case["bodies"]
    only_nearly = "near_motions" in (case["facts"] or {})
    assert ("closure gap" in caplog.text) == only_nearly


@pytest.mark.parametrize("name", one_in(3, MAPPED))
def test_the_map_of_a_world_has_the_counts_of_the_suite(name, tmp_path):
    atlas = map_linkage(read(tmp_path, world_text(CASES[name])))
    counts = {
        "forms": len(atlas.forms),
        "bifurcations": len(atlas.points),
        "rigid": len(atlas.rigid),
        "surfaces": len(atlas.surfaces),
        "near_motions": len(atlas.near_motions),
    }
    facts = CASES[name]["facts"]
    assert {what: counts[what] for what in facts} == facts


def test_points_of_shapes_and_vertices_of_files_are_joint_points(tmp_path):
    (tmp_path / "square.off").write_text("OFF\n4 0 0\n1 0 0 0 0 1 -1 0 0 0 0 -1\n")
    text = "[LINKS]\n"
    for name in "abcd":
        text += f'{name}: body "square.off" red\n'
    text += "[JOINTS]\n"
    for first, second in ("ab", "bc", "cd", "da"):
        text += f"revolute: {first} 0+(0,1,0) {second} 0:1+(0,1,0)\n"
    mechanism = read(tmp_path, text)
    places = [joint.place for joint in mechanism.joints]
    sides = [np.linalg.norm(places[k] - places[k - 1]) for k in range(4)]
    np.testing.assert_allclose(sides, np.sqrt(2), atol=1e-12)


def test_rods_and_legs_become_bodies(tmp_path):
    text = "[LINKS]\nbase\nplate\n[JOINTS]\n"
    for k, angle in enumerate(range(0, 360, 60)):
        x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        kind = "length 2 radius 0.1 color (1,0,0)"
        word = "SPH_SPH"
        if k == 0:
            word, kind = "sph_prs_sph", "range [1,3] radius 0.1"
        text += f"{word} leg{k}: base ({x},{y},0) plate ({0.6 * x},{0.5 * y},{0.1 * k}) {kind}\n"
    mechanism = read(tmp_path, text)
    assert len(mechanism.bodies) == 2 + 5 + 2
    slide = next(joint for joint in mechanism.joints if joint.name == "leg0")
    low, high = slide.limits[0]
    assert high - low == pytest.approx(2)
    assert low <= 0 <= high


def test_limits_count_from_the_configuration_found(tmp_path):
    text = "[LINKS]\na\nb\nc\nd\n[JOINTS]\n"
    ends = [("a", "b", 3), ("b", "c", 1), ("c", "d", 2.5), ("d", "a", 2)]
    for first, second, length in ends:
        text += f"revolute: {first} ({length},0,0)+(0,0,1) {second} (0,0,0)+(0,0,1)\n"
    text += "range [0.2, 3] +(1,0,0) +(1,0,0)\n"
    mechanism = read(tmp_path, text)
    low, high = mechanism.joints[3].limits[0]
    assert high - low == pytest.approx(2.8)
    assert low <= 0 <= high


def test_what_hangs_on_no_loop_stays(tmp_path):
    text = world_text(CASES["FourBars"]).replace("[JOINTS]", "hook\n[JOINTS]")
    text += "revolute: link1 (0,0,0)+(0,0,1) hook (0,0,0)+(0,0,1)\n"
    mechanism = read(tmp_path, text)
    assert len(mechanism.bodies) == 5
    (hanging,) = Hanging(mechanism).joints
    assert (hanging.joint, hanging.base, hanging.bodies) == ("J5", "link1", ("hook",))


def test_links_without_joints_are_named(tmp_path, caplog):
    text = world_text(CASES["FourBars"]).replace("[JOINTS]", "lamp\nhook\n[JOINTS]")
    read(tmp_path, text)
    assert "left out, as they have no joints: links lamp, hook" in caplog.text


BAD = {
    "an unknown sign": ("[LINKS]\n$", 'line 2: "$"'),
    "no section": ("a := 1", "a section such as"),
    "an unknown section": ("[LAWS]\n", "[LAWS]"),
    "a constant given twice": ("[CONSTANTS]\na:=1\na:=2", 'line 3: "a"'),
    "an unknown constant": ("[CONSTANTS]\na:=b", 'line 2: "b"'),
    "a root of less than 0": ("[CONSTANTS]\na:=sqrt(-1)", "an expression without"),
    "a division by 0": ("[CONSTANTS]\na:=1/0", "an expression without a value"),
    "a link given twice": ("[LINKS]\na\na\n", "given once"),
    "an unknown link": (
        "[LINKS]\na\n[JOINTS]\nspherical: a (0,0,0) c (0,0,0)",
        "one of the links a",
    ),
    "an unknown joint": ("[LINKS]\na\n[JOINTS]\nhinge: a", '"hinge"'),
    "a coupled joint": ("[LINKS]\na\nb\n[JOINTS]\ncrevolute: a", "coupled to another"),
    "an axis without length": (
        "[LINKS]\na\nb\n[JOINTS]\nrevolute: a (0,0,0) (0,0,0) b (0,0,0) (0,0,1)",
        "axis of joint J1",
    ),
    "a body that is not there": (
        '[LINKS]\na: body "x.off"\nb\n[JOINTS]\nspherical: a 0 b (0,0,0)',
        "x.off",
    ),
    "a point beyond all measure": (
        "[LINKS]\na\nb\n[JOINTS]\nspherical: a (1e308,0,0) b (0,0,0)",
        "point of joint J1: at 1e+308",
    ),
    "an end in the middle": (
        "[LINKS]\na\nb\n[JOINTS]\nspherical: a (0,0",
        "the end of the file",
    ),
    "another file": ('[INCLUDE]\nrobot: "x.world"', "[INCLUDE]"),
    "parentheses without end": ("[CONSTANTS]\na:=" + 500 * "(", "parentheses inside"),
}


@pytest.mark.parametrize("what", BAD)
def test_a_malformed_world_is_refused_with_its_place(what, tmp_path):
    text, message = BAD[what]
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, text)
    assert message in str(error.value)
    assert "m.world" in str(error.value)


def test_joints_that_cannot_fit_are_refused(tmp_path):
    text = "[LINKS]\na\nb\nc\nd\n[JOINTS]\n"
    for first, second, length in (
        ("a", "b", 9),
        ("b", "c", 1),
        ("c", "d", 1),
        ("d", "a", 1),
    ):
        text += f"revolute: {first} ({length},0,0)+(0,0,1) {second} (0,0,0)+(0,0,1)\n"
    with pytest.raises(LinkageFileError, match="open by up to"):
        read(tmp_path, text)
