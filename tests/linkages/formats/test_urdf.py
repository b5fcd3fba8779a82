"""Robots in URDF, with the YAML file that closes their loops."""

import numpy as np
import pytest

from linkages import load, map_linkage
from linkages.file import LinkageFileError
from linkages.mechanisms.joint import JointKind
from linkages.structure.structure import Structure


def joint(name, parent, child, place, kind="revolute", more=""):
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{place}"/>'
        f'<parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/>'
        f"{more}</joint>"
    )


LINKS = "base", "crank", "rod", "rocker", "end_a", "end_b", "hand"
JOINTS = {
    "A": joint("A", "base", "crank", "0 0 0"),
    "B": joint("B", "crank", "rod", "0 1 0"),
    "D": joint("D", "base", "rocker", "2 0 0"),
    "a": joint("a", "rod", "end_a", "2 0.5 0"),
    "b": joint("b", "rocker", "end_b", "0 1.5 0", kind="fixed"),
    "H": joint("H", "rocker", "hand", "0 2 0", more='<limit lower="-1" upper="0.5"/>'),
}
WHOLE = "closed_loop: [['a', 'b']]\ntype: ['6d']\nname_mot: ['A']\n"
POINT = "closed_loop:\n  - [a, b]\ntype: [3d]\n"


def robot(tmp_path, closures=WHOLE, more="", **joints):
    links = "".join(f'<link name="{link}"/>' for link in LINKS)
    text = "".join({**JOINTS, **joints}.values()) + more
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="four-bar">{links}{text}</robot>')
    if closures:
        (tmp_path / "robot.yaml").write_text(closures)
    return load(path)


def test_a_loop_is_closed_by_the_file_beside(tmp_path, caplog):
    mechanism = robot(tmp_path)
    assert mechanism.independent_loops == 1
    assert mechanism.motors == ("A",)
    (hanging,) = Structure(mechanism).hanging.joints
    assert (hanging.joint, hanging.limited) == ("H", True)
    np.testing.assert_allclose(mechanism.joint("H").place, [2, 2, 0], atol=1e-12)
    assert mechanism.joint("H").limits == ((-1.0, 0.5),)
    four_bar = map_linkage(mechanism)
    assert four_bar.mobility == 1
    assert len(four_bar.forms) == 2  # no link of 1, 2.06, 1.5 and 2 turns past its line


def test_frames_that_share_a_point_are_held_by_a_ball(tmp_path):
    joints = {"a": joint("a", "rod", "end_a", "2 0.5 0", kind="fixed")}
    mechanism = robot(tmp_path, POINT, **joints)
    assert mechanism.joint("a=b").kind is JointKind.SPHERICAL
    assert map_linkage(mechanism).mobility == 1


def test_another_file_closes_the_loops(tmp_path, caplog):
    robot(tmp_path, "")
    assert "no loop is closed" in caplog.text
    closures = tmp_path / "loops.yaml"
    closures.write_text(WHOLE)
    mechanism = load(tmp_path / "robot.urdf", closures=closures)
    assert mechanism.independent_loops == 1
    with pytest.raises(LinkageFileError, match=r"there_is_none\.yaml"):
        load(tmp_path / "robot.urdf", closures=tmp_path / "there_is_none.yaml")
    with pytest.raises(LinkageFileError, match="a URDF takes them"):
        load(tmp_path / "robot.xml", closures=closures)


def closing_frames(*names):
    """Frames at the ends of the rod and of the rocker, in the plane of the joints."""
    places = {"1": ("rod", "2 0.5"), "2": ("rocker", "0 1.5")}
    text = ""
    for name in names:
        link, place = places[name[0]]
        height = 0.1 if name.endswith("_z") else 0.0
        frame = f"closing_top_{name}"
        text += f'<link name="{frame}"/>'
        text += joint(f"{frame}_frame", link, frame, f"{place} {height}", kind="fixed")
    return text


@pytest.mark.parametrize(
    ("frames", "kind"),
    [
        (("1", "2"), JointKind.SPHERICAL),
        (("1", "1_z", "2", "2_z"), JointKind.REVOLUTE),
    ],
)
def test_frames_called_closing_close_a_loop(frames, kind, tmp_path, caplog):
    mechanism = robot(tmp_path, "", more=closing_frames(*frames))
    assert "closed by the names of frames" in caplog.text
    assert mechanism.joint("closing_top").kind is kind
    assert map_linkage(mechanism).mobility == 1


def test_a_closing_frame_without_another_one_is_said(tmp_path, caplog):
    robot(tmp_path, "", more=closing_frames("1"))
    assert "closing_top_1, as there is no closing_top_2" in caplog.text


def test_a_loop_that_is_drawn_half_a_turn_from_closed_closes(tmp_path):
    # both ends turned by half a turn: no small turn brings the frames nearer
    far = joint("B", "crank", "rod", "0 1 0").replace("/>", ' rpy="0 0 3.1415"/>', 1)
    mechanism = robot(tmp_path, B=far)
    assert map_linkage(mechanism).mobility == 1


def test_what_cannot_close_names_the_joint_that_misses(tmp_path):
    far = joint("D", "base", "rocker", "9 0 0")
    with pytest.raises(LinkageFileError, match=r"open by up to .*, at a=b, is not"):
        robot(tmp_path, D=far)


def test_motors_of_no_joint_are_said(tmp_path, caplog):
    mechanism = robot(tmp_path, WHOLE.replace("['A']", "['A', 'M']"))
    assert mechanism.motors == ("A",)
    assert "motors of M" in caplog.text


def test_motors_are_what_dead_points_are_told_of(tmp_path):
    atlas = map_linkage(robot(tmp_path, WHOLE.replace("['A']", "['D']")))
    assert [atlas.names[k] for k in atlas.subject["drivers"]] == ["D"]


def test_without_a_file_all_joints_hang(tmp_path):
    mechanism = robot(tmp_path, "")
    assert mechanism.independent_loops == 0
    assert map_linkage(mechanism).mobility == 5


def test_a_mimic_is_a_coupling(tmp_path):
    mimic = '<mimic joint="A" multiplier="-2" offset="0.5"/>'
    closures = "joint_name: [a]\njoint_type: [FIXED]\n"
    joints = {"H": joint("H", "rocker", "hand", "0 2 0", more=mimic)}
    (coupling,) = robot(tmp_path, closures, **joints).joint("H").coupled
    assert (coupling.to, coupling.ratio) == ("A", -2.0)


def test_joints_get_the_kinds_that_the_file_names(tmp_path):
    closures = WHOLE + "joint_name: [B, H]\njoint_type: [SPHERICAL, UJOINT_ZX]\n"
    mechanism = robot(tmp_path, closures)
    assert mechanism.joint("B").kind is JointKind.SPHERICAL
    cross = mechanism.joint("H")
    assert cross.kind is JointKind.UNIVERSAL
    np.testing.assert_allclose(cross.direction, [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(cross.second_direction, [1, 0, 0], atol=1e-12)


def semantic(tmp_path, constraint, **joints):
    """The same robot with an SRDF beside it."""
    (tmp_path / "robot.srdf").write_text(f"<robot name='four-bar'>{constraint}</robot>")
    return robot(tmp_path, "", **joints)


# example-robot-data has all three: b1_6d, b1_closed_loop, kangaroo_loop
@pytest.mark.parametrize("mask", ["", "x y z roll pitch", "x y yaw", "x y"])
def test_an_srdf_closes_loops_in_the_directions_of_its_mask(mask, tmp_path):
    """A plane four-bar, whose rod and rocker come together in a point or about an axis."""
    words = f"mask='{mask}'" if mask else ""
    kind = "revolute" if mask in ("", "x y yaw") else "fixed"
    a = joint("a", "rod", "end_a", "2 0.5 0", kind=kind)
    constraint = f"<loop_constraint frame1='a' frame2='b' {words}/>"
    mechanism = semantic(tmp_path, constraint, a=a)
    slides = [one for one in mechanism.joints if one.kind is JointKind.PRISMATIC]
    assert len(slides) == (mask in ("x y yaw", "x y"))
    for slide in slides:
        np.testing.assert_allclose(np.abs(slide.direction), [0, 0, 1], atol=1e-12)
    atlas = map_linkage(mechanism)
    assert len(atlas.forms) == 2


def test_an_srdf_without_closures_leaves_the_tree(tmp_path, caplog):
    semantic(tmp_path, "<group_state name='home' group='all'/>")
    assert "no loop is closed" in caplog.text


@pytest.mark.parametrize(
    ("constraint", "message"),
    [
        ("<loop_constraint frame1='a'/>", "frame of <loop_constraint>"),
        ("<loop_constraint frame1='a' frame2='b' mask='x w'/>", '"x w"'),
        ("<loop_constraint frame1='a' frame2='b' mask='x'/>", "two of x, y and z"),
        ("<loop_constraint frame1='a' frame2='b' mask='x y roll'/>", "or x z pitch"),
    ],
)
def test_what_is_wrong_in_an_srdf_is_named(constraint, message, tmp_path):
    with pytest.raises(LinkageFileError, match=message):
        semantic(tmp_path, constraint)


BAD = {
    "a frame that is not there": ("closed_loop: [[a, z]]\ntype: [6d]\n", r'"z"'),
    "a type that is not there": ("closed_loop: [[a, b]]\ntype: [5d]\n", r'"5d"'),
    "a type too few": ("closed_loop: [[a, b]]\n", "number of type: 0"),
    "no YAML": ("closed_loop: [[a, b]\n", "robot.yaml"),
    "no table": ("- a\n", "closures"),
    "a kind that is not there": (
        "joint_name: [B]\njoint_type: [SCREW]\n",
        'joint_type of B: "SCREW"',
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_named(name, tmp_path):
    closures, message = BAD[name]
    with pytest.raises(LinkageFileError, match=message):
        robot(tmp_path, closures)


def test_a_circle_of_joints_is_no_tree(tmp_path):
    circle = joint("A", "rod", "crank", "0 0 0")
    with pytest.raises(LinkageFileError, match="in a circle"):
        robot(tmp_path, A=circle)
