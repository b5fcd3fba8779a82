"""The size of a mechanism does not hang on how its joints are written."""

import numpy as np
import pytest

from linkages import load
from linkages.mechanisms.formats.sdf_writing import mechanism_sdf
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.structure import Structure

UPWARDS = (0.0, 0.0, 1.0)


def spatial_four_bar(kind="cylindrical"):
    """RCCC."""
    return Mechanism(
        (
            Joint("A", "revolute", ("f", "a"), (0, 0, 0), UPWARDS),
            Joint("B", kind, ("a", "b"), (1, 0, 0), (0, 0.5, 1)),
            Joint("C", kind, ("b", "c"), (2, 1, 0), (0.2, -0.8, 1)),
            Joint("D", kind, ("f", "c"), (3, 0, 0), (0.7, 0.1, 1)),
        ),
        "RCCC",
    )


def split(mechanism, slide_first):
    """The mechanism with cylindrical joints as a turn and a slide."""
    joints = []
    for joint in mechanism.joints:
        if joint.kind != "cylindrical":
            joints.append(joint)
            continue
        first, second = joint.bodies
        inner = f"{joint.name}.link"
        bodies = [(first, inner), (inner, second)]
        if slide_first:
            bodies.reverse()
        turn = (joint.point, joint.direction)
        joints.append(Joint(f"{joint.name}.turn", "revolute", bodies[0], *turn))
        slide = (None, joint.direction)
        joints.append(Joint(f"{joint.name}.slide", "prismatic", bodies[1], *slide))
    return Mechanism(tuple(joints))


def slide_limits(mechanism):
    structure = Structure(mechanism)
    return sorted(
        limits
        for number, variable in enumerate(mechanism.variables)
        if not variable.motion.is_turn
        and (limits := structure.limits(number)) is not None
    )


@pytest.mark.parametrize("slide_first", [False, True])
def test_a_cylindrical_joint_may_be_a_turn_and_a_slide(slide_first):
    whole = spatial_four_bar()
    parts = split(whole, slide_first)
    assert Structure(parts).unit == pytest.approx(Structure(whole).unit, rel=1e-12)
    np.testing.assert_allclose(slide_limits(parts), slide_limits(whole), rtol=1e-12)


def test_a_loop_of_parallel_cylindrical_joints_keeps_its_size_in_a_file(tmp_path):
    joints = [
        Joint(f"C{k}", "cylindrical", (f"b{k}", f"b{(k + 1) % 4}"), point, UPWARDS)
        for k, point in enumerate([(0, 0, 0), (0, 1, 0), (2, 1.5, 0), (2, 0, 0)])
    ]
    mechanism = Mechanism(tuple(joints), "parallel")
    path = tmp_path / "model.sdf"
    path.write_text(mechanism_sdf(mechanism))
    again = load(path)
    assert len(again.joints) == 8
    assert Structure(again).unit == pytest.approx(Structure(mechanism).unit, rel=1e-12)


def test_a_planar_joint_keeps_the_size_in_a_file(tmp_path):
    mechanism = Mechanism(
        (
            Joint("A", "planar", ("f", "a"), (0, 0, 0), UPWARDS),
            Joint("B", "revolute", ("a", "b"), (1, 0, 0), UPWARDS),
            Joint("C", "revolute", ("b", "f"), (2, 1, 0), UPWARDS),
        ),
        "planar",
    )
    path = tmp_path / "model.sdf"
    path.write_text(mechanism_sdf(mechanism))
    assert Structure(load(path)).unit == pytest.approx(
        Structure(mechanism).unit, rel=1e-12
    )


def test_a_slider_crank_keeps_turn_and_slide_apart():
    mechanism = Mechanism(
        (
            Joint("A", "revolute", ("f", "c"), (0, 0, 0), UPWARDS),
            Joint("B", "revolute", ("c", "r"), (3, 4, 0), UPWARDS),
            Joint("C", "revolute", ("r", "s"), (8, 4, 0), UPWARDS),
            Joint("D", "prismatic", ("f", "s"), None, (1, 0, 0)),
        )
    )
    assert Structure(mechanism).unit == pytest.approx((5 + 5 + np.hypot(8, 4)) / 4)
