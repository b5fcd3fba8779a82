import logging
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkages import load
from linkages.file import LinkageFileError
from linkages.formats.mjcf_writing import mechanism_mjcf
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.readout import Readout
from linkages.structure.structure import Structure
from tests.linkages.formats.examples import EXAMPLES, assert_same_geometry
from tests.linkages.mechanisms.test_couplings import five_bar
from tests.maps import map_of

CONFIGURATIONS = 50


def replace_limits(mechanism, name, limits):
    joints = [
        replace(joint, limits=(limits,)) if joint.name == name else joint
        for joint in mechanism.joints
    ]
    return Mechanism(tuple(joints), mechanism.name)


def slider_with_rack():
    """A five-bar with a slide in place of the last turn, which follows the first
    one."""
    *joints, last = five_bar().joints
    rack = Joint(
        "P",
        "prismatic",
        last.bodies,
        last.point,
        (1.0, 0.3, 0.0),
        coupled=(Coupling("A", 0.4),),
    )
    return Mechanism((*joints, rack))


def read(tmp_path, text, name="m.xml"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return load(path)


def simulated(mechanism):
    model = mujoco.MjModel.from_xml_string(mechanism_mjcf(mechanism))
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    return model, mujoco.MjData(model)


def set_configuration(model, data, mechanism, readout, point):
    """Put MuJoCo's joints where a configuration of an atlas has them."""
    values = dict(zip(readout.labels(), readout.values(point)[0], strict=True))
    poses = dict(zip(mechanism.bodies, readout.poses(point)[0], strict=True))
    poses["world"] = poses[mechanism.frame]
    for number in range(model.njnt):
        joint = model.joint(number)
        start = joint.qposadr[0]
        if joint.type[0] == mujoco.mjtJoint.mjJNT_BALL:
            body = model.body(joint.bodyid[0])
            parent = model.body(body.parentid[0])
            turn = poses[parent.name][:3, :3].T @ poses[body.name][:3, :3]
            mujoco.mju_mat2Quat(data.qpos[start : start + 4], turn.ravel())
            continue
        label = joint.name.removesuffix(".advance")
        variable = next(v for v in mechanism.variables if v.label == label)
        is_slide = joint.name.endswith(".advance")
        factor = variable.motion.advance if is_slide else 1.0
        data.qpos[start] = factor * values[label]


def equality(data):
    """Residuals (m,) of MuJoCo's equalities, and their Jacobian (m, v)."""
    is_equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    jacobian = data.efc_J.reshape(data.nefc, -1)[is_equality]
    return data.efc_pos[is_equality], jacobian


@pytest.mark.parametrize("name", EXAMPLES)
def test_forms_close_in_mujoco_and_its_jacobian_has_the_mobility(name):
    mechanism = EXAMPLES[name]
    atlas = map_of(mechanism)
    readout = Readout(mechanism)
    model, data = simulated(mechanism)
    assert atlas.forms
    for form in atlas.forms:
        nullities = []
        for point in form.branch.sample(CONFIGURATIONS):
            set_configuration(model, data, mechanism, readout, point)
            mujoco.mj_forward(model, data)
            residuals, jacobian = equality(data)
            assert np.abs(residuals).max() < 1e-11
            singular = np.linalg.svd(jacobian, compute_uv=False)
            rank = int((singular > 1e-6 * singular[0]).sum())
            nullities.append(model.nv - rank)
        assert np.median(nullities) == 1


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_is_written_is_read_again(name, tmp_path, caplog):
    mechanism = EXAMPLES[name]
    with caplog.at_level(logging.WARNING):
        again = read(tmp_path, mechanism_mjcf(mechanism))
    assert not caplog.records
    assert len(again.bodies) == len(mechanism.bodies)
    assert again.gruebler == mechanism.gruebler
    if all(len(joint.bodies) == 2 for joint in mechanism.joints):
        assert_same_geometry(mechanism, again)


def test_locks_and_limits_survive(tmp_path):
    mechanism = EXAMPLES["slider_crank"].with_locks({"J4": -0.25})
    again = read(tmp_path, mechanism_mjcf(mechanism))
    slide = again.joint("J4")
    assert slide.locked == (-0.25,)
    assert slide.limits == ((-5.0, 1.0),)


GEARED = {
    "gears": five_bar(E=Coupling("A", 0.5, 0.3)),
    "a chain of gears": five_bar(E=Coupling("D", -1.0), D=Coupling("A", 0.5)),
    "a limit": replace_limits(five_bar(E=Coupling("A", -1.0)), "A", (-1.0, 2.0)),
    "a slide": slider_with_rack(),
}


@pytest.mark.parametrize("name", GEARED)
def test_couplings_are_written_and_read_again(name, tmp_path, caplog):
    mechanism = GEARED[name]
    with caplog.at_level(logging.WARNING):
        again = read(tmp_path, mechanism_mjcf(mechanism))
    assert not caplog.records
    assert again.is_coupled
    leaders = {
        one.label: (mechanism.variables[one.leader.number].label, *one.leader[1:])
        for one in mechanism.variables
    }
    for one in again.variables:
        to = again.variables[one.leader.number].label
        assert leaders[one.label] == (to, *one.leader[1:])


def test_coupled_joints_have_their_values_in_mujoco():
    mechanism = GEARED["gears"]
    atlas = map_of(mechanism)
    readout = Readout(mechanism)
    model, data = simulated(mechanism)
    assert atlas.forms
    for form in atlas.forms:
        for point in form.branch.sample(CONFIGURATIONS):
            set_configuration(model, data, mechanism, readout, point)
            mujoco.mj_forward(model, data)
            assert np.abs(equality(data)[0]).max() < 1e-11


def four_bar_and_gears(*couplings):
    """The four-bar below, a wheel outside of the loop, and couplings."""
    wheel = '<body name="wheel" pos="5 0 0"><joint name="W"/></body>'
    text = four_bar(equality="".join(couplings))
    return text.replace('<body name="ball"', wheel + '<body name="ball"')


def test_joints_in_loops_that_follow_one_outside_of_them_stay_coupled(tmp_path):
    text = four_bar_and_gears(
        '<joint joint1="A" joint2="W" polycoef="0.1 2 0 0 0"/>',
        '<joint joint1="D" joint2="W" polycoef="0.5 1 0 0 0"/>',
    )
    mechanism = read(tmp_path, text)
    (coupling,) = mechanism.joint("D").coupled
    assert coupling.to == "W"
    assert coupling.ratio == pytest.approx(1.0)
    structure = Structure(mechanism)
    assert structure.hanging.pairs
    assert structure.hanging.joints == ()  # W moves the loop
    assert "W" in [one.label for one in structure.unknowns]


def test_a_joint_outside_of_the_loops_follows_one_in_them(tmp_path):
    mechanism = read(tmp_path, four_bar_and_gears('<joint joint1="W" joint2="A"/>'))
    assert mechanism.is_coupled
    assert Structure(mechanism).hanging.joints == ()


FOUR_BAR = """
<mujoco model="four-bar">
  <compiler {compiler}/>
  <default>
    <joint type="hinge" axis="0 0 1"/>
    <default class="long"><joint range="-170 170"/></default>
  </default>
  <worldbody>
    <site name="pivot" pos="2 0 0"/>
    <frame pos="0 0 0">
      <body name="crank" euler="0 0 90" childclass="long">
        <joint name="A"/>
        <body name="coupler" pos="1 0 0" quat="0.7071067811865476 0 0 -0.7071067811865476">
          <joint name="B"/>
          <body pos="2 0 0">
            <site name="tip" pos="0 0 0"/>
            <site name="tip2" pos="0 0 0.3"/>
            <body name="pointer" pos="9 9 9"/>
          </body>
        </body>
      </body>
    </frame>
    <body name="rocker" pos="2 0 0" zaxis="0 0 2">
      <joint name="D"/>
      <site name="end" pos="0 1 0"/><site name="end2" pos="0 1 0.3"/>
    </body>
    <body name="ball" pos="5 5 5"><freejoint/></body>
  </worldbody>
  <equality>
    <connect name="C.1" site1="tip" site2="end"/>
    <connect name="C.2" site1="tip2" site2="end2"/>
    {equality}
  </equality>
</mujoco>
"""


def four_bar(compiler="", equality=""):
    return FOUR_BAR.format(compiler=compiler, equality=equality)


def test_defaults_frames_sites_and_degrees_are_taken(tmp_path, caplog):
    mechanism = read(tmp_path, four_bar())
    assert sorted(mechanism.bodies) == ["coupler", "crank", "rocker", "world"]
    assert not caplog.records
    places = {joint.name: joint.place for joint in mechanism.joints}
    np.testing.assert_allclose(places["B"], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(places["C"], [2, 1, 0], atol=1e-12)
    assert mechanism.joint("A").limits[0] == pytest.approx(np.radians((-170, 170)))
    assert mechanism.joint("D").limits == (None,)
    assert mechanism.joint("C").kind == "revolute"


def test_poses_are_those_of_mujoco(tmp_path):
    rng = np.random.default_rng(3)
    numbers = " ".join(map(str, rng.uniform(-1, 1, 3)))
    poses = {
        "quat": "0.3 -0.2 0.5 0.8",
        "euler": "20 -35 60",
        "axisangle": "1 2 -0.5 40",
        "xyaxes": "1 0.2 0 0.1 1 0.3",
        "zaxis": "0.3 -0.4 0.2",
    }
    for sequence in ("xyz", "XYZ", "zyx", "xZy"):
        for key, value in poses.items():
            text = (
                f'<mujoco><compiler eulerseq="{sequence}"/><worldbody>'
                f'<body name="a" pos="{numbers}" {key}="{value}"><joint name="A" axis="0.1 1 0.3" '
                'pos="0.2 0 0.1"/><geom size="1"/><body name="b" pos="1 0 0"><joint name="B" '
                'axis="1 0.3 0"/><geom size="1"/></body></body></worldbody><equality>'
                '<connect body1="b" body2="world" anchor="0.2 0.5 0"/></equality></mujoco>'
            )
            mechanism = read(tmp_path, text)
            model = mujoco.MjModel.from_xml_string(text)
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            places = [mechanism.joint(name).place for name in "AB"]
            np.testing.assert_allclose(places, data.xanchor, atol=1e-12)
            axes = [mechanism.joint(name).direction for name in "AB"]
            np.testing.assert_allclose(axes, data.xaxis, atol=1e-12)


def test_sites_that_miss_each_other_are_closed_and_the_gap_is_said(tmp_path, caplog):
    text = four_bar().replace('name="end" pos="0 1 0"', 'name="end" pos="0 1 1e-4"')
    read(tmp_path, text)
    assert "closure gap" in caplog.text


COUPLED = '<joint joint1="A" joint2="D" polycoef="0 -1 0.5 0 0"/>'
BAD = {
    "no XML": ("<mujoco><worldbody>", "line 1"),
    "an entity": ('<!DOCTYPE m [<!ENTITY a "b">]><mujoco/>', "<!DOCTYPE m> with"),
    "another document": ("<html/>", "<mujoco> or <sdf>"),
    "no joint": ("<mujoco/>", "no joint is left"),
    "a coupling": (four_bar(equality=COUPLED), "a coupling of joints A and D"),
    "a coupling to itself": (
        four_bar(equality='<joint joint1="A" joint2="A"/>'),
        "coupled of A",
    ),
    "two couplings of a joint": (
        four_bar(equality=2 * '<joint joint1="A" joint2="B"/>'),
        "coupled to one joint",
    ),
    "a tendon": (four_bar(equality='<tendon tendon1="t"/>'), "<tendon>"),
    "an unknown body": (four_bar(equality='<weld body1="hook"/>'), '"hook"'),
    "an unknown site": (four_bar(equality='<connect site1="tip" site2="x"/>'), '"x"'),
    "no anchor": (four_bar(equality='<connect body1="crank"/>'), "anchor of <connect>"),
    "global coordinates": (
        four_bar(compiler='coordinate="global"'),
        "coordinate of <compiler>",
    ),
    "a unit of angles": (four_bar(compiler='angle="gon"'), '"gon"'),
    "a number that is none": (
        four_bar().replace('pos="1 0 0"', 'pos="1 0 z"'),
        '"1 0 z"',
    ),
    "too few numbers": (four_bar().replace('pos="1 0 0"', 'pos="1 0"'), "3 numbers"),
    "a number beyond all": (
        four_bar().replace('pos="1 0 0"', 'pos="1 0 nan"'),
        "finite",
    ),
    "an axis of length zero": (
        four_bar().replace('axis="0 0 1"', 'axis="0 0 0"'),
        "axis of <joint",
    ),
    "a class that is not there": (
        four_bar().replace('childclass="long"', 'childclass="x"'),
        '"x"',
    ),
    "a joint type": (four_bar().replace('type="hinge"', 'type="gear"'), '"gear"'),
    "a file inside": (
        four_bar().replace("<worldbody>", '<include file="a.xml"/><worldbody>'),
        "<include>",
    ),
    "a body twice": (four_bar().replace('name="rocker"', 'name="crank"'), "given once"),
    "what cannot be closed": (
        four_bar().replace('pos="2 0 0" zaxis', 'pos="9 0 0" zaxis'),
        "open by up to",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_a_malformed_model_is_refused_with_its_place(what, tmp_path):
    text, message = BAD[what]
    with pytest.raises(LinkageFileError) as error:
        read(tmp_path, text)
    assert message in str(error.value)
    assert "m.xml" in str(error.value)


# body, parent, pos, xyaxes, joint type, ref, range: the left leg of agility_cassie in
# google-deepmind/mujoco_menagerie, rounded as it is there
CASSIE_LEG = [
    ("hip", None, "0 0 0", "", None, 0, None),
    (
        "rod",
        "hip",
        "0 0 0.045",
        "0.7922 -0.60599 -0.072096 0.60349 0.79547 -0.054922",
        "ball",
        0,
        None,
    ),
    (
        "knee",
        "hip",
        "0.12 0 0.0045",
        "0.70711 -0.70711 0 0.70711 0.70711 0",
        "hinge",
        -45,
        "-164 -37",
    ),
    ("shin", "knee", "0.06068 0.04741 0", "", "hinge", 0, "-20 20"),
    (
        "tarsus",
        "shin",
        "0.43476 0.02 0",
        "0.52992 0.84805 0 -0.84805 0.52992 0",
        "hinge",
        58,
        "50 170",
    ),
    (
        "heel",
        "tarsus",
        "-0.01269 -0.03059 0.00092",
        "-0.91211 0.40829 0.036948 -0.40992 -0.90952 -0.068841",
        "hinge",
        0,
        None,
    ),
    ("crank", "tarsus", "0.058 -0.034 0.02275", "", "hinge", 0, "-140 -30"),
    ("plantar", "crank", "0.055 0 -0.00791", "", "hinge", 0, None),
    ("foot", "tarsus", "0.408 -0.04 0", "", "hinge", 0, "-140 -30"),
]


def body_text(name):
    _, _, pos, axes, kind, ref, limits = next(
        row for row in CASSIE_LEG if row[0] == name
    )
    turned = f' xyaxes="{axes}"' if axes else ""
    limited = f' range="{limits}"' if limits else ""
    joint = f'<joint name="{name}" type="{kind}" ref="{ref}"{limited}/>' if kind else ""
    inner = "".join(body_text(row[0]) for row in CASSIE_LEG if row[1] == name)
    return f'<body name="{name}" pos="{pos}"{turned}><geom size="0.01"/>{joint}{inner}</body>'


def cassie_leg():
    return (
        f'<mujoco model="leg"><worldbody>{body_text("hip")}</worldbody><equality>'
        '<connect body1="plantar" body2="foot" anchor="0.35012 0 0"/>'
        '<connect body1="rod" body2="heel" anchor="0.5012 0 0"/></equality></mujoco>'
    )


def test_the_leg_of_a_robot_has_two_loops_in_the_places_of_mujoco(tmp_path):
    mechanism = read(tmp_path, cassie_leg())
    assert mechanism.independent_loops == 2
    model = mujoco.MjModel.from_xml_string(cassie_leg())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for number in range(model.njnt):
        name = model.joint(number).name
        np.testing.assert_allclose(
            mechanism.joint(name).place, data.xanchor[number], atol=1e-9
        )
    # angles begin at qpos0, which is ref: -45 of -164 to -37 degrees at the knee
    low, high = mechanism.joint("knee").limits[0]
    assert np.degrees([low, high]) == pytest.approx([-119, 8])


def test_a_joint_between_two_loops_hangs(tmp_path):
    twice = (
        four_bar()
        .replace(
            '    <body name="ball"',
            '''
    <body name="neck" pos="0 0 5"><joint name="N"/>
      <body name="u" pos="0 1 0"><joint name="U"/><body name="v" pos="1 0 0"><joint name="V"/></body></body>
      <body name="w" pos="2 0 0"><joint name="W"/></body>
    </body>
    <body name="ball"''',
        )
        .replace(
            "</equality>",
            """
    <connect name="X.1" body1="v" body2="w" anchor="0.5 0 0"/>
    <connect name="X.2" body1="v" body2="w" anchor="0.5 0 1"/></equality>""",
        )
    )
    mechanism = read(tmp_path, twice)
    assert mechanism.independent_loops == 2
    by_name = {one.joint: one for one in Structure(mechanism).hanging.joints}
    assert by_name["N"].bodies == ("neck", "u", "v", "w")


@pytest.mark.parametrize(
    ("given", "expected"),
    [("10 100", (10, 100)), ("-400 400", (-400, 400)), ("0 90", (0, 90))],
)
def test_limits_that_the_pose_of_the_file_misses_stay_as_they_are(
    given, expected, tmp_path
):
    path = tmp_path / "model.xml"
    path.write_text(f"""<mujoco model="four-bar"><compiler angle="degree"/>
<worldbody>
 <body name="a"><joint name="j1" type="hinge" axis="0 0 1"/>
  <body name="b" pos="1 0 0"><joint name="j2" type="hinge" axis="0 0 1"/>
   <body name="c" pos="1 1 0"><joint name="j3" type="hinge" axis="0 0 1"/>
    <body name="d" pos="1 -.4 0">
     <joint name="j4" type="hinge" axis="0 0 1" range="{given}"/>
 </body></body></body></body></worldbody>
<equality><weld body1="d"/></equality></mujoco>""")
    (limits,) = load(path).joint("j4").limits
    assert np.degrees(limits) == pytest.approx(expected)


OPEN_CHAINS = """<mujoco><default><equality {default}/></default><worldbody>
  <body name="a"><joint name="A" type="hinge" axis="0 0 1" range="0 0"/><geom size=".1"/>
   <body name="b" pos="0 1 0"><joint axis="0 0 1"/><geom size=".1"/></body></body>
  <body name="c" pos="2 0 0"><joint axis="0 0 1"/><geom size=".1"/></body>
  </worldbody><equality>
  <connect name="D.1" body1="b" body2="c" anchor="2 0 0"/>
  <connect name="D.2" body1="b" body2="c" anchor="2 0 1"/>
  </equality></mujoco>"""


def test_equalities_take_the_defaults_of_equalities(tmp_path):
    inactive = OPEN_CHAINS.format(default='active="false"')
    assert not mujoco.MjModel.from_xml_string(inactive).eq_active0.any()
    assert read(tmp_path, inactive).independent_loops == 0
    assert read(tmp_path, OPEN_CHAINS.format(default="")).independent_loops == 1


def test_a_range_without_a_width_is_no_limit(tmp_path):
    text = OPEN_CHAINS.format(default="")
    assert not mujoco.MjModel.from_xml_string(text).jnt_limited.any()
    assert read(tmp_path, text).joint("A").limits == (None,)


def test_names_that_mujoco_keeps_apart_are_kept_apart(tmp_path, caplog):
    # bodies, joints and equalities may be called alike in MuJoCo, or not at all
    text = """<mujoco><worldbody>
    <body><joint name="J2.turn" axis="0 0 1"/><joint name="J2.slide" type="slide"/>
      <geom size="1"/>
      <body name="body1" pos="0 1 0"><joint axis="0 0 1"/><joint axis="1 0 0"/>
        <joint axis="0 0 1"/><geom size="1"/></body></body>
    <body name="body1.1" pos="2 0 0"><joint name="J2" axis="0 0 1"/><geom size="1"/>
    </body>
    </worldbody><equality>
    <connect name="J2" body1="body1" body2="body1.1" anchor="1 0 0"/>
    <connect name="near" body1="body1" body2="world" anchor="0 0 0"/>
    </equality></mujoco>"""
    mujoco.MjModel.from_xml_string(text)
    mechanism = read(tmp_path, text)
    names = [joint.name for joint in mechanism.joints]
    assert names[:2] == ["J2.turn+J2.slide", "J3"]
    assert "equality J2 is called J2.2" in caplog.text
    assert len(names) == len(set(names))
    bodies = {"body1", "body2", "body1.1", "body1.1.2", "body1.2", "world"}
    assert bodies == set(mechanism.bodies)


MOTORS = """
<actuator>
  <motor joint="A"/>
  <position tendon="both"/>
  <general name="adhesion" body="rod"/>
</actuator>
<tendon><fixed name="both"><joint joint="D" coef="1"/></fixed></tendon>
"""


def test_actuators_are_motors(tmp_path, caplog):
    text = four_bar().replace("</mujoco>", f"{MOTORS}</mujoco>")
    mechanism = read(tmp_path, text)
    assert mechanism.motors == ("A", "D")
    assert "actuators adhesion" in caplog.text
