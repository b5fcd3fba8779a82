"""Names of bodies and joints in files of other programs: each once, none forbidden."""

import logging
from dataclasses import replace

import mujoco
import pytest

from linkages import load
from linkages.formats.mjcf_writing import mechanism_mjcf
from linkages.formats.sdf_writing import mechanism_sdf
from linkages.mechanisms.couplings import Coupling
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

WRITERS = {".sdf": mechanism_sdf, ".xml": mechanism_mjcf}
UPWARDS = (0.0, 0.0, 1.0)


def slider_crank(joints, bodies, name="slider-crank"):
    """Four joints with these names, between these bodies."""
    f, c, r, s = bodies
    a, b, d, e = joints
    return Mechanism(
        (
            Joint(a, "revolute", (f, c), (0, 0, 0), UPWARDS),
            Joint(b, "revolute", (c, r), (0.6, 0.8, 0), UPWARDS),
            Joint(d, "cylindrical", (r, s), (3, 0, 0), UPWARDS),
            Joint(e, "prismatic", (f, s), None, (1, 0, 0)),
        ),
        name,
    )


NAMES = {
    "joints like bodies": ("fcrs", "fcrs"),
    "a joint called world": (("A", "B", "world", "D"), "fcrs"),
    "a joint called after the model": (("A", "__model__", "C", "D"), "fcrs"),
    "bodies that are reserved": ("ABCD", ("f", "__root__", "world", "universe")),
    "the world at rest": ("ABCD", ("world", "world.body", "r", "s")),
    "scopes": (("A::B", "A.B", "C", "D"), ("f", "x::y", "x.y", "s")),
    "a body like a link": ("ABCD", ("f", "C.turn.link", "C.copy3", "A")),
    "a body like a copy": ("ABCD", ("f", "A.copy0", "B.copy1", "D.copy3")),
}


@pytest.mark.parametrize("ending", WRITERS)
@pytest.mark.parametrize("case", NAMES)
def test_a_written_file_is_read_again_whatever_the_names(case, ending, tmp_path):
    mechanism = slider_crank(*NAMES[case])
    path = tmp_path / f"model{ending}"
    path.write_text(WRITERS[ending](mechanism), encoding="utf-8")
    again = load(path)
    assert len(again.variables) == len(mechanism.variables)
    assert again.independent_loops == 1
    if ending == ".xml":
        mujoco.MjModel.from_xml_path(str(path))


def test_what_is_renamed_is_said_and_nothing_else(caplog):
    mechanism = slider_crank(("A", "c", "C", "D"), "fcrs", name="__model__")
    with caplog.at_level(logging.WARNING):
        text = mechanism_sdf(mechanism)
    assert [record.getMessage() for record in caplog.records] == [
        "joint c is called c.joint in the file"
    ]
    assert '<joint name="A"' in text
    assert '<model name="__model__.model">' in text


def test_couplings_follow_joints_that_are_renamed(tmp_path):
    mechanism = slider_crank("fcrs", "fcrs")
    joints = list(mechanism.joints)
    joints[1] = replace(joints[1], coupled=(Coupling("f", -2.0, 0.0),))
    path = tmp_path / "model.sdf"
    path.write_text(mechanism_sdf(Mechanism(tuple(joints))), encoding="utf-8")
    (coupling,) = load(path).joint("c.joint").coupled
    assert coupling == Coupling("f", -2.0, 0.0)


@pytest.mark.parametrize("ending", WRITERS)
def test_a_joint_of_several_bodies_gets_another_begin(ending, tmp_path):
    # the pair of the joint __J that carries the body x__ would be called __J.x__
    joints = (
        Joint("__J", "revolute", ("f", "b", "x__"), (0, 0, 0), UPWARDS),
        Joint("A", "revolute", ("b", "c"), (1, 0, 0), UPWARDS),
        Joint("B", "revolute", ("x__", "c"), (0, 1, 0), UPWARDS),
        Joint("C", "revolute", ("f", "d"), (3, 0, 0), UPWARDS),
        Joint("joint.__J.b", "revolute", ("d", "c"), (2, 2, 0), UPWARDS),
    )
    mechanism = Mechanism(joints)
    path = tmp_path / f"model{ending}"
    path.write_text(WRITERS[ending](mechanism), encoding="utf-8")
    assert load(path).independent_loops == mechanism.independent_loops


def test_names_that_are_allowed_stay(caplog):
    joints = ("x::y", "x.y", "x.y.joint", "D")
    bodies = ("f", "u::v", "u.v", "u.v.body")
    with caplog.at_level(logging.WARNING):
        mechanism_sdf(slider_crank(joints, bodies))
    assert [record.getMessage() for record in caplog.records] == [
        "body u::v is called body.u.v in the file",
        "joint x::y is called joint.x.y in the file",
    ]
