"""Mechanisms in TOML files: what is read, and what is refused."""

import numpy as np
import pytest

import linkages
from linkages.file import LinkageFileError
from linkages.files.mechanism_file import mechanism_toml

JOINT = """
[[joints]]
name = "{name}"
kind = "revolute"
bodies = {bodies}
point = {point}
direction = [0, 0, 1]
"""


def four_bar(extra="", head=""):
    rows = [
        ("A", '["frame", "crank"]', "[0, 0, 0]"),
        ("B", '["crank", "coupler"]', "[0, 1, 0]"),
        ("C", '["coupler", "rocker"]', "[2, 1.5, 0]"),
    ]
    text = head
    for name, bodies, point in rows:
        text += JOINT.format(name=name, bodies=bodies, point=point)
    last = JOINT.format(name="D", bodies='["rocker", "frame"]', point="[2, 0, 0]")
    return text + last + extra


BARS = """
name = "triangle on a hinge"
fixed = ["A", "B"]
bars = [["A", "C"], ["B", "D"], ["C", "D"{length}]]
[points]
A = [0, 0]
B = [2, 0]
C = [0, 1]
D = [2, 1.5]
"""


def read(tmp_path, text):
    path = tmp_path / "mechanism.toml"
    path.write_text(text, encoding="utf-8")
    return linkages.load(path)


def test_joints_are_read_with_limits_and_locks_in_degrees(tmp_path):
    mechanism = read(tmp_path, four_bar("limits = [-90, 45]\nlocked = 30\n"))
    assert mechanism.name == "mechanism"
    assert [joint.name for joint in mechanism.joints] == list("ABCD")
    assert np.allclose(mechanism.joints[3].limits, [(-np.pi / 2, np.pi / 4)])
    assert np.allclose(mechanism.joints[3].locked, np.pi / 6)
    mechanism = read(tmp_path, four_bar("locked = 1.5\n", 'angles = "rad"\n'))
    assert mechanism.joints[3].locked == (1.5,)


def test_a_joint_of_several_variables_has_lists_of_limits_and_locks(tmp_path):
    extra = "limits = [[-90, 90], [-2, 2]]\nlocked = [45, 0.5]\n"
    joint = read(tmp_path, cylindrical_four_bar(extra)).joints[3]
    assert np.allclose(joint.limits, [(-np.pi / 2, np.pi / 2), (-2, 2)])
    assert np.allclose(joint.locked, (np.pi / 4, 0.5))


def cylindrical_four_bar(extra):
    head, last = four_bar(extra).rsplit("revolute", 1)
    return f"{head}cylindrical{last}"


def test_some_variables_of_a_joint_are_locked_or_limited(tmp_path):
    extra = 'limits = [[], [-2, 2]]\nlocked = ["free", 0.5]\n'
    mechanism = read(tmp_path, cylindrical_four_bar(extra))
    joint = mechanism.joints[3]
    assert joint.limits == (None, (-2.0, 2.0))
    assert joint.locked == (None, 0.5)
    assert read(tmp_path, mechanism_toml(mechanism)) == mechanism


def test_bars_are_bodies_and_points_are_joints(tmp_path):
    mechanism = read(tmp_path, BARS.format(length=""))
    assert mechanism.bodies == ("frame", "A-C", "B-D", "C-D")
    assert [joint.name for joint in mechanism.joints] == list("ABCD")
    assert mechanism.gruebler == 1


def test_lengths_that_do_not_fit_the_points_are_assembled_first(tmp_path):
    mechanism = read(tmp_path, BARS.format(length=", 2.5"))
    c, d = (np.array(mechanism.joint(name).point) for name in "CD")
    assert abs(np.linalg.norm(c - d) - 2.5) < 1e-15
    assert abs(np.linalg.norm(c) - 1.0) < 1e-15
    assert abs(np.linalg.norm(d - [2, 0, 0]) - 1.5) < 1e-15


def test_a_point_on_a_bar_is_rigid_with_it_and_so_is_one_on_the_frame(tmp_path):
    text = """
fixed = ["A", "B"]
bars = [["A", "a"], ["B", "b"], ["a", "b"], ["M", "m"]]
[points]
A = [0, 0]
B = [2, 0]
a = [0.5, 1]
b = [2.5, 1]
[points_on_bars]
M = ["A", "B", [0.5, 0.25]]
m = ["a", "b", [0.5, 0.25]]
"""
    mechanism = read(tmp_path, text)
    assert mechanism.joint("M").bodies == ("frame", "M-m")
    assert mechanism.joint("m").bodies == ("a-b", "M-m")
    assert np.allclose(mechanism.joint("m").point, (1.5, 1.5, 0))


MALFORMED = {
    "planar = 1\n" + four_bar(): r"planar: 1 .* true or false",
    "planar = true\n" + four_bar().replace("[0, 0, 1]", "[0, 1, 1]", 1): (
        r"planar: true .* not all axes are parallel"
    ),
    "joints = 3\n": r"joints: 3 is not allowed.* tables",
    "joints = []\n": r"number of joints: 0",
    "joints = [1]\n": r"joints\[1\]: 1 .* a table",
    four_bar("axis = 1\n"): r"key of joint D: 'axis' .* one of name, kind",
    four_bar(
        "", "lengths = [1]\n"
    ): r"key: 'lengths' .* one of name, angles, planar, origin, rounding, layers, joints",
    four_bar("", 'angles = "turns"\n'): r'angles: "turns" .* "deg"',
    four_bar("", "name = 3\n"): r"name: 3 .* text",
    four_bar("locked = [1, 2]\n"): r"locked of joint D: \[1, 2\] .* a number",
    four_bar('locked = "x"\n'): r'locked of joint D: "x" .* number',
    four_bar('locked = ["free"]\n'): r'locked of joint D: "free" .* number',
    cylindrical_four_bar("locked = [1]\n"): r'\[1\] .* 2 numbers, "free" for a',
    cylindrical_four_bar('locked = [1, "fre"]\n'): r'"fre" .* number',
    four_bar("limits = []\n"): r"limits of joint D: .* \[low, high\]",
    cylindrical_four_bar("limits = []\n"): r"limits of joint D: .* \[\] for those",
    four_bar("limits = 3\n"): r"limits of joint D: 3 .* \[low, high\]",
    four_bar("limits = [1, 2, 3]\n"): r"limits of joint D: .* \[low, high\]",
    four_bar().replace('kind = "revolute"\n', "", 1): r"kind of joint A: a missing key",
    four_bar().replace('name = "A"\n', ""): r"name of joints\[1\]: a missing key",
    four_bar().replace("[2, 1.5, 0]", "[2, 1.5]"): r"point of joint C: \[2, 1.5\]",
    'bars = [["A", "B"]]\n': r"points: None .* table",
    "[points]\nA = [0, 0]\n": r"bars: None .* list of bars",
    BARS.format(length=", -1"): r"length of bars\[3\]: -1.0 .* positive",
    BARS.format(length=", 9"): r"length of bar C-D: 9.0 .* misses its length by",
    BARS.format(length="").replace('"B", "D"', '"B", "X"'): r'bars\[2\]: "X" .* one of',
    BARS.format(length="").replace('"B", "D"', '"B", "B"'): r"bars\[2\]: .* two points",
    BARS.format(length="").replace('"B", "D"', '"C", "A"'): r"bars\[2\]: .* once",
    BARS.format(length="").replace('["A", "B"]', '["A", "Q"]'): r'fixed: "Q" .* one of',
    BARS.format(length="").replace('["A", "B"]', '["A", "A"]'): r'fixed: "A" .* once',
    BARS.format(length="").replace("D = [2, 1.5]", "D = [2]"): r"point D: \[2\] .* two",
    BARS.format(length="") + "E = [1, 1]\n": r"point E: on no bar",
    BARS.format(length="").replace('], ["C", "D"]', ", 3, 4]"): r"bars\[2\]: ",
    BARS.format(length="") + '[points_on_bars]\nP = ["A", "D", [0, 1]]\n': (
        r"points_on_bars P: A and D .* there is none between"
    ),
    BARS.format(length="") + '[points_on_bars]\nP = ["A", "D"]\n': (
        r"points_on_bars P: "
    ),
    BARS.format(length="") + '[points_on_bars]\nP = ["A", "Z", [0, 1]]\n': (
        r'points_on_bars P: "Z" .* stands before'
    ),
}


@pytest.mark.parametrize("number", range(len(MALFORMED)))
def test_a_malformed_file_is_refused_by_name_and_value(number, tmp_path):
    text, message = list(MALFORMED.items())[number]
    with pytest.raises(LinkageFileError, match=message):
        read(tmp_path, text)


def test_errors_of_limits_and_locks_are_in_the_unit_of_the_file(tmp_path):
    with pytest.raises(LinkageFileError, match=r"120 .* within the limits \[-90, 90\]"):
        read(tmp_path, four_bar("limits = [-90, 90]\nlocked = 120\n"))
    with pytest.raises(LinkageFileError, match=r"limits of joint D: \[90, -90\]"):
        read(tmp_path, four_bar("limits = [90, -90]\n"))
    with pytest.raises(LinkageFileError, match="stands still has locked = 5"):
        read(tmp_path, four_bar("limits = [5, 5]\n"))


def test_a_point_beyond_all_measure_is_refused(tmp_path):
    path = tmp_path / "m.toml"
    path.write_text(four_bar().replace("[0, 1, 0]", "[0, 1e308, 0]"))
    with pytest.raises(LinkageFileError, match="point of joint B"):
        linkages.load(path)


@pytest.mark.parametrize(
    ("unit", "limits", "is_said"),
    [
        ("rad", "[-90, 90]", True),
        ("rad", "[-7, 7]", False),
        ("deg", "[-900, 9]", False),
    ],
)
def test_limits_in_radians_of_more_than_two_turns_are_said(
    unit, limits, is_said, tmp_path, caplog
):
    path = tmp_path / "m.toml"
    text = four_bar(f"limits = {limits}\n", f'angles = "{unit}"\n')
    path.write_text(text, encoding="utf-8")
    linkages.load(path)
    assert ("limits of joint D are [-90, 90]" in caplog.text) is is_said


@pytest.mark.parametrize(
    ("head", "value", "shown"),
    [("", "3", "3 degrees"), ('angles = "rad"\n', "0.5", "0.5 rad")],
)
def test_a_lock_of_what_is_coupled_is_shown_as_the_file_has_it(
    tmp_path, head, value, shown
):
    text = four_bar(f'coupled = {{to = "A", ratio = 2.0}}\nlocked = {value}\n', head)
    with pytest.raises(LinkageFileError, match=f"locked of joint D: {shown} is not"):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("key", "hint"),
    [("limit", "nearest is 'limits'"), ("axis", None), ("stiffness", None)],
)
def test_a_key_is_hinted_at_only_where_it_is_nearly_the_one_given(tmp_path, key, hint):
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, four_bar(f"{key} = 1\n"))
    assert f"key of joint D: '{key}'" in str(error.value)
    assert ("nearest" in str(error.value)) == (hint is not None)
    assert hint is None or hint in str(error.value)


def test_what_does_not_hang_together_is_several_mechanisms(tmp_path):
    apart = "".join(
        JOINT.format(name=name, bodies='["p", "q"]', point="[9, 0, 0]") for name in "PQ"
    )
    parts = read(tmp_path, apart + four_bar()).parts
    assert [len(part.bodies) for part in parts] == [2, 4]
    assert [part.name for part in parts] == ["mechanism, part 1", "mechanism, part 2"]


def test_bars_without_fixed_points_that_need_a_frame_ask_for_them(tmp_path):
    text = BARS.format(length="").replace('fixed = ["A", "B"]\n', "")
    with pytest.raises(LinkageFileError, match=r"fixed: a missing key .* A-C hangs"):
        read(tmp_path, text)
