import logging
from dataclasses import replace

import numpy as np
import pytest

from linkages import load, map_linkage
from linkages.file import LinkageFileError
from linkages.formats.sdf_writing import mechanism_sdf
from linkages.mechanisms.couplings import Coupling
from linkages.values import GeometryError
from tests.linkages.formats.examples import EXAMPLES, assert_same_geometry
from tests.linkages.mechanisms.known_mechanisms import geared_five_bar


def read(tmp_path, text, name="m.sdf"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return load(path)


def link(name, pose, more=""):
    return f'<link name="{name}"><pose {more}>{pose}</pose></link>'


def joint(name, parent, child, pose, axis="<xyz>0 0 1</xyz>", more=""):
    return (
        f'<joint name="{name}" type="revolute"><pose {more}>{pose}</pose><parent>{parent}</parent>'
        f"<child>{child}</child><axis>{axis}</axis></joint>"
    )


# numbers of the tutorial on kinematic loops in osrf/gazebo_tutorials
GAZEBO = {
    "links": {
        "link_AB": "-0.01 -0.15 0 0 0 0",
        "link_BC": "0.1 -0.31 0 0 0 0",
        "link_CD": "0.21 -0.15 0 0 0 0",
    },
    "joints": [
        ("joint_A", "world", "link_AB", "0.01 0.15 0 0 0 0"),
        ("joint_B", "link_AB", "link_BC", "-0.1 0.01 0 0 0 0"),
        ("joint_D", "world", "link_CD", "-0.01 0.15 0 0 0 0"),
        ("joint_C", "link_CD", "link_BC", "0.1 0.01 0 0 0 0"),
    ],
}
# the same with the coupler in two halves, joined rigidly
SPLIT = {
    "links": {
        "link_AB": "-0.01 -0.15 0 0 0 0",
        "link_BE": "0.05 -0.31 0 0 0 0",
        "link_EC": "0.15 -0.31 0 0 0 0",
        "link_CD": "0.21 -0.15 0 0 0 0",
    },
    "joints": [
        ("joint_A", "world", "link_AB", "0.01 0.15 0 0 0 0"),
        ("joint_B", "link_AB", "link_BE", "-0.05 0.01 0 0 0 0"),
        ("joint_D", "world", "link_CD", "-0.01 0.15 0 0 0 0"),
        ("joint_C", "link_CD", "link_EC", "0.05 0.01 0 0 0 0"),
    ],
}
FIXED = '<joint name="joint_E" type="fixed"><parent>link_BE</parent><child>link_EC</child></joint>'


def model(case=GAZEBO, version="1.5", extra="", pose="0 0 0.04 0 0 0"):
    parts = [link(name, place) for name, place in case["links"].items()]
    parts += [joint(*row) for row in case["joints"]]
    return (
        f'<?xml version="1.0"?><sdf version="{version}"><model name="four_bar"><pose>{pose}</pose>'
        f"{''.join(parts)}{extra}</model></sdf>"
    )


@pytest.mark.parametrize(("case", "extra"), [(GAZEBO, ""), (SPLIT, FIXED)])
def test_the_four_bar_of_the_tutorial_is_a_rectangle(case, extra, tmp_path):
    mechanism = read(tmp_path, model(case, extra=extra))
    assert len(mechanism.bodies) == 4
    atlas = map_linkage(mechanism)
    # A (0, 0), B (0, -0.3), C (0.2, -0.3), D (0.2, 0): a parallelogram, which has a
    # second form, the antiparallelogram, and meets it in its two flat configurations
    assert len(atlas.forms) == 2
    assert len(atlas.points) == 2


def test_a_pose_may_be_relative_to_another_frame(tmp_path):
    parts = [
        '<frame name="base"><pose degrees="true">1 2 0 0 0 90</pose></frame>',
        '<frame name="tip" attached_to="b"><pose>0 1 0 0 0 0</pose></frame>',
        link("a", "0 0 0 0 0 0", 'relative_to="base"'),
        link("b", "1 0 0 0 0 0", 'relative_to="a"'),
        link("c", "0 0 0 0 0 0", 'relative_to="tip"'),
        joint("A", "world", "a", "0 0 0 0 0 0"),
        joint("B", "a", "b", "0 0 0 0 0 0", '<xyz expressed_in="base">0 0.6 0.8</xyz>'),
        joint("C", "b", "c", "1 1 1 0 0 0", more='relative_to="__model__"'),
        joint("D", "c", "world", "0 0 0 0 0 0", more='relative_to="world"'),
    ]
    text = f'<sdf version="1.9"><model name="m">{"".join(parts)}</model></sdf>'
    mechanism = read(tmp_path, text)
    places = {joint.name: joint.place for joint in mechanism.joints}
    np.testing.assert_allclose(places["A"], [1, 2, 0], atol=1e-15)
    np.testing.assert_allclose(places["B"], [1, 3, 0], atol=1e-15)
    np.testing.assert_allclose(places["C"], [1, 1, 1], atol=1e-15)
    np.testing.assert_allclose(
        mechanism.joint("B").direction, [-0.6, 0, 0.8], atol=1e-15
    )


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_is_written_is_read_again(name, tmp_path, caplog):
    mechanism = EXAMPLES[name]
    with caplog.at_level(logging.WARNING):
        again = read(tmp_path, mechanism_sdf(mechanism))
    assert not caplog.records
    assert again.gruebler == mechanism.gruebler
    if len(again.joints) == len(mechanism.joints):
        assert_same_geometry(mechanism, again)


# sdformat.org: the child of a joint must not be the world
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_world_is_no_child(name):
    mechanism = EXAMPLES[name]
    turned = replace(
        mechanism,
        joints=tuple(
            replace(joint, bodies=joint.bodies[::-1]) for joint in mechanism.joints
        ),
    )
    for one in (mechanism, turned):
        assert "<child>world</child>" not in mechanism_sdf(one)


def test_the_pitch_of_a_screw_has_its_sign_in_old_files_too(tmp_path):
    text = mechanism_sdf(EXAMPLES["screw_loop"])
    pitch = EXAMPLES["screw_loop"].joint("H").pitch
    old = text.replace('version="1.11"', 'version="1.6"')
    start, rest = old.split("<screw_thread_pitch>")
    end = rest.split("</screw_thread_pitch>")[1]
    old = f"{start}<thread_pitch>{-2 * np.pi / pitch!r}</thread_pitch>{end}"
    assert read(tmp_path, text).joint("H").pitch == pytest.approx(pitch)
    assert read(tmp_path, old).joint("H").pitch == pytest.approx(pitch)


def test_a_lock_has_no_word_in_sdf():
    slider_crank = EXAMPLES["slider_crank"]
    with pytest.raises(GeometryError, match=r"locked of joint J4: -0\.25 is"):
        mechanism_sdf(slider_crank.with_locks({"J4": -0.25}))
    with pytest.raises(GeometryError, match="locked of joint J1: 30 degrees is"):
        mechanism_sdf(slider_crank.with_locks({"J1": np.pi / 6}))


BAD = {
    "an old version": (model(version="1.4"), "version of <sdf>"),
    "a version that is none": (model(version="x"), "from 1.5 to 1.11"),
    "no model": ('<sdf version="1.7"/>', "models with joints"),
    "an unknown link": (model().replace("<child>link_BC", "<child>hook", 1), '"hook"'),
    "an unknown child": (
        model().replace("<child>link_BC", "<child>hook", 1),
        '<child> of <joint name="joint_B"> on line 1: "hook" is not allowed; it must be '
        "world or one of the links link_AB, link_BC, link_CD",
    ),
    "an unknown frame": (
        model(version="1.9", extra='<frame name="f" attached_to="g"/>').replace(
            "<pose >0.1", '<pose relative_to="f">0.1', 1
        ),
        'attached_to of <frame name="f"> on line 1: "g"',
    ),
    "no child": (model().replace("<child>link_BC</child>", "", 1), "<child>"),
    "a joint type": (
        model().replace('type="revolute"', 'type="revolute2"', 1),
        '"revolute2"',
    ),
    "five numbers": (
        model().replace("0.1 -0.31 0 0 0 0", "0.1 -0.31 0 0 0"),
        "6 numbers",
    ),
    "a name twice": (model(extra=link("link_AB", "0 0 0 0 0 0")), "given once"),
    "an axis of length zero": (
        model().replace("<xyz>0 0 1", "<xyz>0 0 0", 1),
        "length other than zero",
    ),
    "no axis": (model().replace("<axis><xyz>0 0 1</xyz></axis>", "", 1), "<axis>"),
    "a frame in an old file": (
        model().replace("<pose >-0.01", '<pose relative_to="link_BC">-0.01', 1),
        "relative_to",
    ),
    "a circle of frames": (
        '<sdf version="1.7"><model name="m">'
        + link("a", "0 0 0 0 0 0", 'relative_to="b"')
        + link("b", "0 0 0 0 0 0", 'relative_to="a"')
        + joint("A", "a", "b", "0 0 0 0 0 0")
        + "</model></sdf>",
        "relative to itself",
    ),
    "a model inside": (model(extra="<include><uri>x</uri></include>"), "<include>"),
}


@pytest.mark.parametrize("what", BAD)
def test_a_malformed_model_is_refused_with_its_place(what, tmp_path):
    text, message = BAD[what]
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, text)
    assert message in str(error.value)
    assert "m.sdf" in str(error.value)


def test_reversed_limits_are_none_and_named(tmp_path, caplog):
    limit = "<limit><lower>2</lower><upper>1</upper></limit></axis>"
    mechanism = read(tmp_path, model().replace("</axis>", limit, 1))
    assert mechanism.joint("joint_A").limits == (None,)
    assert "left out: the limits of joint joint_A, 2 to 1" in caplog.text


def test_links_without_joints_are_named(tmp_path, caplog):
    read(tmp_path, model(extra='<link name="lamp"/>'))
    assert "left out, as they have no joints: links lamp" in caplog.text


# --- joints that follow others --------------------------------------------------------


COUPLED = {
    "gears": geared_five_bar(offset=0.25),
    "a rack": replace(
        EXAMPLES["screw_loop"],
        joints=(
            replace(
                EXAMPLES["screw_loop"].joints[0],
                coupled=(None, Coupling("H", 0.3)),
            ),
            *EXAMPLES["screw_loop"].joints[1:],
        ),
    ),
    "a universal joint": replace(
        EXAMPLES["spatial_slider_crank"],
        joints=(
            replace(
                EXAMPLES["spatial_slider_crank"].joints[0],
                coupled=(Coupling("U.second", 0.5),),
            ),
            *EXAMPLES["spatial_slider_crank"].joints[1:],
        ),
    ),
}


@pytest.mark.parametrize("name", COUPLED)
def test_couplings_are_read_as_they_were_written(name, tmp_path, caplog):
    mechanism = COUPLED[name]
    with caplog.at_level(logging.WARNING):
        again = read(tmp_path, mechanism_sdf(mechanism))
    assert not caplog.records
    assert leaders_of(again) == leaders_of(mechanism)


def leaders_of(mechanism):
    """What every coupled variable follows, with ratio and offset."""
    variables = mechanism.variables
    return {
        one.label: (variables[one.leader.number].label, *one.leader[1:])
        for one in variables
        if variables[one.leader.number] is not one
    }


def test_a_mimic_counts_from_its_reference(tmp_path):
    text = mechanism_sdf(geared_five_bar(offset=0.25))
    text = text.replace("<offset>0.25</offset>", "<offset>0.75</offset>")
    text = text.replace("<reference>0</reference>", "<reference>0.25</reference>")
    assert leaders_of(read(tmp_path, text)) == {"E": ("A", -2.0, 1.25)}


def gearbox(ratio=3.0, axis="0 0 1", axis2="0 0 1", reference="world"):
    return (
        '<joint name="G" type="gearbox"><parent>a</parent><child>d</child>'
        f"<gearbox_reference_body>{reference}</gearbox_reference_body>"
        f"<gearbox_ratio>{ratio}</gearbox_ratio>"
        f"<axis><xyz>{axis}</xyz></axis><axis2><xyz>{axis2}</xyz></axis2></joint>"
    )


# theta_2 = -ratio theta_1, both from the reference (sdformat.org); joint E is counted
# from its link d to the frame, which turns its sign round
@pytest.mark.parametrize(
    ("axis", "axis2", "ratio"),
    [("0 0 1", "0 0 1", 3.0), ("0 0 1", "0 0 -1", -3.0), ("0 0 -2", "0 0 1", -3.0)],
)
def test_a_gearbox_couples_the_joints_of_its_links(axis, axis2, ratio, tmp_path):
    plain = replace(
        geared_five_bar(),
        joints=tuple(replace(one, coupled=()) for one in geared_five_bar().joints),
    )
    text = mechanism_sdf(plain)
    text = text.replace("</model>", gearbox(axis=axis, axis2=axis2) + "</model>")
    assert leaders_of(read(tmp_path, text)) == {"E": ("A", ratio, 0.0)}


def mimic(old, new):
    return mechanism_sdf(geared_five_bar()).replace(old, new)


BAD_COUPLINGS = {
    "an unknown leader": (mimic('mimic joint="A"', 'mimic joint="X"'), '"X"'),
    "no leader": (mimic('mimic joint="A"', "mimic"), "joint of <mimic>"),
    "a second axis": (mimic('axis="axis"', 'axis="axis2"'), "axis2 of A"),
    "an axis that is none": (mimic('axis="axis"', 'axis="axis3"'), '"axis3"'),
    "no multiplier": (mimic("<multiplier>-2.0</multiplier>", ""), "<multiplier>"),
    "a multiplier of 0": (mimic(">-2.0<", ">0<"), "other than 0"),
    "a text": (mimic(">-2.0<", ">two<"), '"two"'),
    "a joint that follows itself": (
        mimic('joint="A" axis', 'joint="E" axis'),
        "E -> E",
    ),
    "an old file": (mimic('version="1.11"', 'version="1.10"'), "1.11"),
    "a gearbox on no link": (
        mimic("</model>", gearbox(reference="b") + "</model>"),
        "<gearbox_reference_body>",
    ),
    "a gearbox without a reference": (
        mimic("</model>", gearbox(reference="") + "</model>"),
        "<gearbox_reference_body>",
    ),
    "a gearbox on what follows": (
        mimic("</model>", gearbox() + "</model>"),
        "coupled once",
    ),
    "a gearbox about another axis": (
        mimic("</model>", gearbox(axis="1 0 0") + "</model>"),
        "along <axis>",
    ),
}


@pytest.mark.parametrize("what", BAD_COUPLINGS)
def test_a_malformed_coupling_is_refused_with_its_place(what, tmp_path):
    text, message = BAD_COUPLINGS[what]
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, text)
    assert message in str(error.value)
    assert "m.sdf" in str(error.value)
