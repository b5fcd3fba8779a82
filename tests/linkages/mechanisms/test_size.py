"""The size of a mechanism does not hang on how its joints are written."""

import numpy as np
import pytest

from linkages import load
from linkages.formats.sdf_writing import mechanism_sdf
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.structure import Structure

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


def parallel_loop():
    """A loop of four cylindrical joints: each slide is beside two turns along it."""
    joints = [
        Joint(f"C{k}", "cylindrical", (f"b{k}", f"b{(k + 1) % 4}"), point, UPWARDS)
        for k, point in enumerate([(0, 0, 0), (0, 1, 0), (2, 1.5, 0), (2, 0, 0)])
    ]
    return Mechanism(tuple(joints), "parallel")


@pytest.mark.parametrize("slide_first", [False, True])
def test_a_slide_between_two_turns_along_it_is_with_either(slide_first):
    whole = parallel_loop()
    parts = split(whole, slide_first)
    assert Structure(parts).unit == pytest.approx(Structure(whole).unit, rel=1e-12)
    turned = Mechanism(parts.joints[3:] + parts.joints[:3])
    assert Structure(turned).unit == pytest.approx(Structure(whole).unit, rel=1e-12)


def planar_loop(point, base="f"):
    """A planar joint and two revolute ones, ``base`` at rest."""
    names = {"f": "f", "a": "a", "b": "b", base: "world"}
    f, a, b = names["f"], names["a"], names["b"]
    return Mechanism(
        (
            Joint("A", "revolute", (f, a), (0, 0, 0), UPWARDS),
            Joint("B", "planar", (a, b), point, UPWARDS),
            Joint("C", "revolute", (b, f), (2, 1, 0), UPWARDS),
        ),
        "planar",
    )


MECHANISMS = {
    "parallel cylindrical joints": parallel_loop(),
    "a planar joint without a point": planar_loop(None),
    "a planar joint beside the axes": planar_loop((0.3, 5, 0)),
    "a planar joint on an axis": planar_loop((2, 1, 4)),
    "a planar joint that carries the world": planar_loop((1, 1, 0), base="b"),
}


@pytest.mark.parametrize("what", MECHANISMS)
def test_joints_that_a_file_writes_as_chains_are_read_as_one(what, tmp_path):
    mechanism = MECHANISMS[what]
    path = tmp_path / "model.sdf"
    path.write_text(mechanism_sdf(mechanism))
    again = load(path)
    assert [joint.name for joint in again.joints] == [
        joint.name for joint in mechanism.joints
    ]
    assert [joint.kind for joint in again.joints] == [
        joint.kind for joint in mechanism.joints
    ]
    for joint, other in zip(mechanism.joints, again.joints, strict=True):
        if len(joint.motions) == 1:
            continue  # turned round where the world is its second body
        motions = zip(joint.motions, other.motions, strict=True)
        same = [np.allclose(one.direction, two.direction) for one, two in motions]
        assert all(same)
    assert again.gruebler == mechanism.gruebler
    assert Structure(again).unit == pytest.approx(Structure(mechanism).unit, rel=1e-12)


def rprp(*points):
    """A planar RPRP loop whose slides are given at these points."""
    return Mechanism(
        (
            Joint("R1", "revolute", ("f", "a"), (0, 0, 0), UPWARDS),
            Joint("P2", "prismatic", ("a", "b"), points[0], (0.76, 0.64, 0)),
            Joint("R3", "revolute", ("b", "c"), (-1, 1, 0), UPWARDS),
            Joint("P4", "prismatic", ("f", "c"), points[1], (1, 0, 0)),
        )
    )


def test_where_slides_are_given_does_not_matter():
    on_axis = rprp((-1, 1, 0), (-1, 1, 0))
    for other in (
        rprp(None, None),
        rprp((3, 1, 2), (-4, 0, 1)),
        rprp(None, (-1, 1, 0)),
    ):
        assert Structure(other).unit == pytest.approx(
            Structure(on_axis).unit, rel=1e-12
        )
        np.testing.assert_allclose(slide_limits(other), slide_limits(on_axis))


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


def test_axes_on_one_line_are_measured_by_the_pitch():
    def vise(height):
        return Mechanism(
            (
                Joint("A", "helical", ("f", "n"), (0, 0, 0), UPWARDS, pitch=0.7),
                Joint("B", "revolute", ("n", "j"), (0, 0, height), UPWARDS),
                Joint("D", "prismatic", ("f", "j"), None, UPWARDS),
            )
        )

    assert [Structure(vise(height)).unit for height in (2.0, -5.0)] == [0.7, 0.7]
