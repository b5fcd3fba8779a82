"""Coordinates far from the origin: counted from the mechanism, or said to be rounded."""

from dataclasses import replace
from decimal import Decimal

import pytest

from bifurc.completeness import Level
from bifurc.files.dataset import load_atlas, save_atlas
from linkages.app.texts.summary import make_summary
from linkages.file import LinkageFileError, read_file
from linkages.files.mechanism_file import mechanism_toml
from linkages.labels import loop_of
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.origin import WrittenNumber, counted_from_near
from linkages.mechanisms.subject import mechanism_of
from tests.linkages.mechanisms.test_maps import slider_crank
from tests.maps import map_of

UPWARDS = (0.0, 0.0, 1.0)
SLIDER_CRANK = """
[[joints]]
name = "A"
kind = "revolute"
bodies = ["frame", "crank"]
point = [{x}, 0.0, 0.0]
direction = [0, 0, 1]
[[joints]]
name = "B"
kind = "revolute"
bodies = ["crank", "rod"]
point = [{b}, 0.8, 0.0]
direction = [0, 0, 1]
[[joints]]
name = "C"
kind = "revolute"
bodies = ["rod", "slider"]
point = [{c}, 0.0, 0.0]
direction = [0, 0, 1]
[[joints]]
name = "D"
kind = "prismatic"
bodies = ["frame", "slider"]
direction = [1, 0, 0]
"""


def slider_crank_file(folder, offset):
    x = Decimal(offset)
    path = folder / "slider_crank.toml"
    text = SLIDER_CRANK.format(x=x, b=x + Decimal("0.6"), c=x + Decimal("1.2"))
    path.write_text(text)
    return path


def far_slider_crank(offset):
    """A slider-crank of equal lengths, with its slider line through the crank pivot."""
    near = slider_crank()
    joints = []
    for joint in near.joints:
        if joint.point is not None:
            x, y, z = joint.point
            joint = replace(joint, point=(x + offset, y, z))
        joints.append(joint)
    return replace(near, joints=tuple(joints))


@pytest.mark.parametrize("offset", ["0.0", "-70.0", "30000.0", "100000.1", "1e12"])
def test_the_decimals_of_a_file_are_counted_from_the_mechanism(offset, tmp_path):
    mechanism = read_file(slider_crank_file(tmp_path, offset))
    points = [joint.point for joint in mechanism.joints[:3]]
    assert points == [(0.0, 0.0, 0.0), (0.6, 0.8, 0.0), (1.2, 0.0, 0.0)]
    assert mechanism.origin == (float(offset), 0.0, 0.0)


@pytest.mark.parametrize("offset", ["30000.0", "100000.0"])
def test_bifurcations_far_from_the_origin_are_found(offset, tmp_path):
    atlas = map_of(read_file(slider_crank_file(tmp_path, offset)))
    assert len(atlas.forms) == 2
    assert len(atlas.bifurcations) == 2
    assert atlas.completeness.level == Level.CERTIFIED
    place = f"{float(offset):.10g}"
    assert f"Points are counted from {place} 0 0 of the file." in make_summary(atlas)


@pytest.mark.parametrize("offset", [3e4, 1e5])
def test_near_misses_that_rounding_of_coordinates_explains_are_in_doubt(offset):
    atlas = map_of(far_slider_crank(offset))
    assert len(atlas.near_misses) == 4
    assert atlas.completeness.level == Level.ESTIMATED
    assert "4 near misses may be at bifurcations" in atlas.completeness.statement
    assert "Coordinates of points are known to" in make_summary(atlas)


def test_near_misses_that_rounding_does_not_explain_are_certain():
    joints = list(far_slider_crank(0.0).joints)
    joints[1] = replace(joints[1], point=(0.6 + 1e-9, 0.8, 0))
    atlas = map_of(Mechanism(tuple(joints), "near"))
    assert len(atlas.near_misses) == 4
    assert atlas.completeness.level == Level.CERTIFIED


def test_a_far_loop_of_revolute_joints_says_how_well_it_is_known():
    points = [(0, 0, 0), (0, 1, 0), (2, 1.5, 0), (2, 0, 0)]
    bodies = ["frame", "crank", "coupler", "rocker", "frame"]
    joints = [
        Joint(f"J{k}", "revolute", (bodies[k], bodies[k + 1]), (x + 1e5, y, z), UPWARDS)
        for k, (x, y, z) in enumerate(points)
    ]
    atlas = map_of(Mechanism(tuple(joints), "far four-bar"))
    assert len(atlas.forms) == 2
    assert "known to 7.3e-12 only" in make_summary(atlas)


def test_the_axes_of_a_far_single_loop_are_those_of_a_near_one(tmp_path):
    places = [
        "[{0}0.0, 0, 0]",
        "[{0}0.7, 1.1, 0]",
        "[{0}2.3, 1.5, 0]",
        "[{0}2.9, 0, 0]",
    ]
    loops = []
    for start in ("", "40000"):
        points = ", ".join(place.format(start) for place in places)
        path = tmp_path / "axes.toml"
        path.write_text(f"points = [{points}]\ndirections = {[list(UPWARDS)] * 4}\n")
        loops.append(read_file(path))
    assert loops[0] == loops[1]


# 17 digits: these decimals were doubles, and known no better
ROUNDED = """points = [[30000.600000000001, 0.0, 0.0], [30000.900000000001, 0.4, 0.0],
[30001.900000000001, 0.4, 0.0], [30001.599999999999, 0.0, 0.0]]
directions = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]]
"""


def test_rounded_axes_of_a_single_loop_leave_bifurcations_in_doubt(tmp_path):
    path = tmp_path / "axes.toml"
    path.write_text(ROUNDED)
    loop = read_file(path)
    assert loop.rounding == pytest.approx(1.8e-12, rel=0.02)
    assert loop.scaled(1e3).rounding == 1e3 * loop.rounding
    atlas = map_of(loop)
    assert len(atlas.near_misses) == 4
    assert atlas.completeness.level == Level.ESTIMATED
    assert "4 near misses may be at bifurcations" in atlas.completeness.statement
    again = load_atlas(save_atlas(atlas, tmp_path / "atlas.nc"))
    assert loop_of(again).rounding == loop.rounding
    assert "Coordinates of points are known to 1.8e-12 only" in make_summary(again)


def test_far_points_of_bars_are_counted_from_the_first(tmp_path):
    path = tmp_path / "bars.toml"
    path.write_text(
        'fixed = ["A", "B"]\nbars = [["A", "C"], ["B", "D"], ["C", "D"]]\n[points]\n'
        "A = [5e6, -7e6]\nB = [5000002.3, -7e6]\nC = [5e6, -6999998.9]\n"
        "D = [5000002.3, -6999998.8]\n"
    )
    mechanism = read_file(path)
    assert mechanism.origin == (5e6, -7e6, 0.0)
    places = {joint.point for joint in mechanism.joints}
    assert places == {(0, 0, 0), (2.3, 0, 0), (0, 1.1, 0), (2.3, 1.2, 0)}


def test_the_origin_is_kept_in_files_and_datasets(tmp_path):
    mechanism = read_file(slider_crank_file(tmp_path, "30000.0"))
    copy = tmp_path / "copy.toml"
    copy.write_text(mechanism_toml(mechanism))
    assert read_file(copy).origin == mechanism.origin
    assert read_file(copy) == mechanism
    path = save_atlas(map_of(mechanism), tmp_path / "atlas.nc")
    assert mechanism_of(load_atlas(path)).origin == mechanism.origin


def far_rounded_mechanism(folder):
    """A parallelogram whose coordinates are doubles that were printed."""
    text = ""
    places = ["30000.600000000001", "30000.900000000001"]
    places += ["30001.900000000001", "30001.599999999999"]
    heights = ["0.0", "0.4", "0.4", "0.0"]
    bodies = ["f", "a", "b", "c", "f"]
    for k, (x, y) in enumerate(zip(places, heights, strict=True)):
        text += f'[[joints]]\nname = "J{k}"\nkind = "revolute"\n'
        text += f"bodies = {bodies[k : k + 2]}\n"
        text += f"point = [{x}, {y}, 0.0]\ndirection = [0, 0, 1]\n"
    path = folder / "rounded.toml"
    path.write_text(text)
    return read_file(path)


def test_the_rounding_is_kept_in_files(tmp_path):
    mechanism = far_rounded_mechanism(tmp_path)
    copy = tmp_path / "copy.toml"
    copy.write_text(mechanism_toml(mechanism))
    again = read_file(copy)
    assert again.rounding == mechanism.rounding == pytest.approx(1.8e-12, rel=0.02)
    atlas = map_of(again)
    assert "4 near misses may be at bifurcations" in atlas.completeness.statement


@pytest.mark.parametrize("given", ["-1e-9", "nan", '"small"', "true"])
def test_a_rounding_that_is_none_is_refused(given, tmp_path):
    path = tmp_path / "copy.toml"
    text = mechanism_toml(far_rounded_mechanism(tmp_path))
    (line,) = [one for one in text.splitlines() if one.startswith("rounding")]
    path.write_text(text.replace(line, f"rounding = {given}"))
    with pytest.raises(LinkageFileError, match="rounding"):
        read_file(path)


def test_numbers_that_no_fraction_should_hold_are_left_to_their_reader():
    rows = [[WrittenNumber("1e-999999999"), 0, 0], [1, 0, 0]]
    assert counted_from_near(rows) == (rows, None, 0.0)
    rows = [[1e300, 0, 0], [1, 0, 0]]
    assert counted_from_near(rows) == (rows, None, 0.0)


@pytest.mark.parametrize("zero", ["0.0e0", "0.000000e+00", "-0E-99", "0.e+999999999"])
def test_a_zero_with_an_exponent_is_a_zero(zero):
    rows = [
        [WrittenNumber("30000.6"), WrittenNumber(zero), 0],
        [WrittenNumber("30000.9"), WrittenNumber("4.0e-1"), WrittenNumber(zero)],
    ]
    near = counted_from_near(rows)
    assert near.rows == [[0.0, 0.0, 0.0], [0.3, 0.4, 0.0]]
    assert near.origin == (30000.6, 0.0, 0.0)


def test_a_spherical_loop_far_from_the_origin_moves_as_one_that_is_near(tmp_path):
    # sixteen digits beside 1: axes that meet miss each other by 1e-12 of the size
    rows = [
        ("A", ["f", "a"], "[1.0, 0.0, 0.0001]", [0.0, 0.0, 1.0]),
        (
            "B",
            ["a", "b"],
            "[1.000112928494679, 0.0, 0.00016506712298193567]",
            [0.5646424733950354, 0.0, 0.8253356149096783],
        ),
        (
            "C",
            ["b", "c"],
            "[1.0001738094359964, 0.0002190273890588195, 0.00010870732634300209]",
            [0.5793647866551066, 0.7300912968627317, 0.3623577544766736],
        ),
        (
            "D",
            ["f", "c"],
            "[1.0000605903874886, 0.000351296020934508, 0.00018143844857023095]",
            [0.15147596872130856, 0.8782400523362699, 0.4535961214255773],
        ),
    ]
    text = ""
    for name, bodies, point, direction in rows:
        text += f'[[joints]]\nname = "{name}"\nkind = "revolute"\n'
        text += f"bodies = {bodies}\npoint = {point}\ndirection = {direction}\n"
    path = tmp_path / "small.toml"
    path.write_text(text)
    mechanism = read_file(path)
    assert mechanism.rounding == pytest.approx(1.1e-16, rel=0.01)
    atlas = map_of(mechanism)
    assert len(atlas.forms) == 1
    assert "Coordinates of points are known to 1.1e-16" in make_summary(atlas)


def mjcf_slider_crank(x, slide="0 0 0"):
    """A slider-crank at x, in bodies that are turned, with decimals as they are."""
    near = [f"{Decimal(x) + Decimal(dx)}" for dx in ("0", "0.6", "1.2")]
    return f"""<mujoco><worldbody>
      <body name="c"><joint name="A" axis="0 0 1" pos="{near[0]} 0 0"/>
        <body name="r"><joint name="B" axis="0 0 1" pos="{near[1]} 0.8 0"/></body>
      </body>
      <body name="s" pos="{near[0]} 0 0" quat="0 1 0 0">
        <joint name="D" type="slide" axis="1 0 0" pos="{slide}"/></body>
    </worldbody><equality>
      <connect name="C.1" body1="r" body2="s" anchor="{near[2]} 0 0"/>
      <connect name="C.2" body1="r" body2="s" anchor="{near[2]} 0 1e-3"/>
    </equality></mujoco>"""


def sdf_slider_crank(x, slide="0 0 0"):
    near = [f"{Decimal(x) + Decimal(dx)}" for dx in ("0", "0.6", "1.2")]
    axis = "<axis><xyz>{}</xyz></axis>"
    rows = [
        ("A", "revolute", "world", "c", f"{near[0]} 0 0", "0 0 1"),
        ("B", "revolute", "c", "r", f"{near[1]} 0.8 0", "0 0 1"),
        ("C", "revolute", "r", "s", "1.2 0 0", "0 0 1"),
        ("D", "prismatic", "world", "s", slide, "1 0 0"),
    ]
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><pose>{place} 0 0 0</pose>'
        f"<parent>{parent}</parent><child>{child}</child>{axis.format(along)}</joint>"
        for name, kind, parent, child, place, along in rows
    )
    links = f'<link name="c"/><link name="r"/><link name="s"><pose>{near[0]} 0 0 0 0 0</pose></link>'
    return f'<sdf version="1.11"><model name="m">{links}{joints}</model></sdf>'


FILES = {"far.xml": mjcf_slider_crank, "far.sdf": sdf_slider_crank}


@pytest.mark.parametrize("slide", ["0 0 0", "-1e6 3 0"])
@pytest.mark.parametrize("offset", ["0", "-70", "30000", "100000.1", "1e12"])
@pytest.mark.parametrize("name", FILES)
def test_poses_far_from_the_origin_lose_no_digits(name, offset, slide, tmp_path):
    path = tmp_path / name
    path.write_text(FILES[name](offset, slide))
    mechanism = read_file(path)
    points = {joint.name: joint.point for joint in mechanism.joints}
    assert points["A"] == (0.0, 0.0, 0.0)
    assert points["B"] == (0.6, 0.8, 0.0)
    assert points["C"] == pytest.approx((1.2, 0.0, 0.0), abs=1e-15)
    assert mechanism.origin == (float(offset), 0.0, 0.0)
    assert mechanism.rounding == 0.0


@pytest.mark.parametrize("name", FILES)
def test_bifurcations_of_a_far_model_are_found(name, tmp_path):
    path = tmp_path / name
    path.write_text(FILES[name]("30000"))
    atlas = map_of(read_file(path))
    assert len(atlas.bifurcations) == 2
    assert "Points are counted from 30000 0 0 of the file." in make_summary(atlas)


def test_turned_bodies_far_from_the_origin_say_what_is_lost(tmp_path):
    # the arm from the axis of the world to the model is turned by 30 degrees
    text = mjcf_slider_crank("0")
    text = text.replace("<worldbody>", '<worldbody><frame euler="0 0 30">')
    text = text.replace("</worldbody>", "</frame></worldbody>")
    path = tmp_path / "turned.xml"
    path.write_text(text.replace("<frame ", '<frame pos="30000 0 0" '))
    mechanism = read_file(path)
    assert mechanism.rounding < 1e-15
    assert mechanism.joint("B").point == pytest.approx(
        (0.6 * 3**0.5 / 2 - 0.4, 0.3 + 0.4 * 3**0.5, 0), abs=1e-15
    )
    arm = '<frame euler="0 0 30"><frame pos="30000 0 0">'
    text = text.replace('<frame euler="0 0 30">', arm)
    path.write_text(text.replace("</frame>", "</frame></frame>"))
    assert read_file(path).rounding == pytest.approx(30000 * 2.2e-16, rel=0.01)


def test_decimals_of_a_far_model_that_were_doubles_are_known_no_better(tmp_path):
    path = tmp_path / "far.sdf"
    path.write_text(sdf_slider_crank("30000.599999999998"))
    assert read_file(path).rounding == pytest.approx(1.8e-12, rel=0.02)
    text = make_summary(map_of(read_file(path)))
    assert "Coordinates of points are known to 1.8e-12 only" in text


@pytest.mark.parametrize("slide", ["", "point = [0, 0, 0]", "point = [-1e9, 3, 0]"])
def test_the_point_of_a_slide_does_not_say_where_a_mechanism_is(slide, tmp_path):
    path = slider_crank_file(tmp_path, "30000.0")
    path.write_text(f"{path.read_text()}{slide}\n")
    mechanism = read_file(path)
    assert mechanism.joint("B").point == (0.6, 0.8, 0.0)
    assert mechanism.is_known_to_rounding
