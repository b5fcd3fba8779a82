"""Small mechanisms, between them with every kind of joint."""

import numpy as np

from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism

Z = (0.0, 0.0, 1.0)


def slider_crank():
    """A planar slider-crank with limits of its slide."""
    joints = (
        Joint("J1", "revolute", ("frame", "crank"), (0.1, 0, 0), Z),
        Joint("J2", "revolute", ("crank", "rod"), (1, 0.3, 0), Z),
        Joint("J3", "revolute", ("rod", "slider"), (4, 0, 0), Z),
        Joint(
            "J4",
            "prismatic",
            ("frame", "slider"),
            (4, 0, 0),
            (1, 0, 0),
            limits=((-5.0, 1.0),),
        ),
    )
    return Mechanism(joints, "slider-crank")


def spatial_slider_crank():
    """RSUC: a crank, a rod between a spherical and a universal joint, and a slide that
    may turn."""
    joints = (
        Joint("R", "revolute", ("frame", "crank"), (0, 0, 0), (0.1, 0.2, 1)),
        Joint(
            "U", "universal", ("crank", "rod"), (1, 0, 0.2), (0, 0.3, 1), (0, 1, 0.2)
        ),
        Joint("S", "spherical", ("slider", "rod"), (3, 1, 0.5)),
        Joint("P", "prismatic", ("frame", "slider"), (3, 1, 0.5), (1, 0.2, 0.1)),
    )
    return Mechanism(joints, "spatial slider-crank")


def screw_loop():
    """Helical, cylindrical and revolute joints in one loop."""
    joints = (
        Joint("C", "cylindrical", ("frame", "a"), (0, 0, 0), (0, 0.1, 1)),
        Joint("H", "helical", ("a", "b"), (1, 0, 0), (0.4, 1, 0), pitch=0.7),
        Joint("D", "cylindrical", ("b", "c"), (1, 2, 0), (1, 0.2, 0.3)),
        Joint("R", "revolute", ("c", "d"), (0, 2, 1), (0.2, 0, 1)),
        Joint("Q", "revolute", ("d", "frame"), (0, 2, 0), (1, 1, 0.1)),
    )
    return Mechanism(joints, "screw loop")


def planar_joint_loop():
    """A planar joint that closes a loop with four revolute ones."""
    joints = (
        Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0.1, 1)),
        Joint("B", "revolute", ("a", "b"), (1, 0, 0), (0.4, 1, 0)),
        Joint("C", "revolute", ("b", "c"), (1, 2, 0), (1, 0.2, 0.3)),
        Joint("D", "revolute", ("c", "d"), (1.5, 2, 0.3), (0.1, -0.5, 0.8)),
        Joint("E", "planar", ("d", "frame"), (0, 2, 1), (0.2, 0, 1), (1.0, 0, -0.2)),
    )
    return Mechanism(joints, "planar joint")


def two_loops():
    """Two planar four-bars on one crank, with three bodies on one axis."""
    joints = (
        Joint("A", "revolute", ("frame", "crank"), (0, 0, 0), Z),
        Joint("B", "revolute", ("crank", "left", "right"), (0.5, 0.8, 0), Z),
        Joint("C", "revolute", ("left", "one"), (-2, 1.5, 0), Z),
        Joint("D", "revolute", ("one", "frame"), (-2, 0, 0), Z),
        Joint("E", "revolute", ("right", "other"), (2.5, 2, 0), Z),
        Joint("F", "revolute", ("other", "frame"), (2.2, 0.1, 0), Z),
    )
    return Mechanism(joints, "two loops")


EXAMPLES = {
    example.__name__: example()
    for example in (
        slider_crank,
        spatial_slider_crank,
        screw_loop,
        planar_joint_loop,
        two_loops,
    )
}


def assert_same_geometry(mechanism, other):
    """Every joint of the one is there in the other, by name, kind, bodies and place."""

    def body(name):
        return "world" if name in ("frame", "world") else name

    others = {joint.name: joint for joint in other.joints}
    for joint in mechanism.joints:
        twin = others[joint.name]
        assert twin.kind is joint.kind
        assert {body(name) for name in twin.bodies} == {
            body(name) for name in joint.bodies
        }
        is_turned = body(twin.bodies[0]) != body(joint.bodies[0])
        np.testing.assert_allclose(twin.place, joint.place, atol=1e-14)
        motions = joint.motions
        twins = twin.motions
        if is_turned:
            twins = twins[::-1] if joint.kind == "universal" else twins
        for motion, own in zip(motions, twins, strict=True):
            sine = np.linalg.norm(np.cross(motion.direction, own.direction))
            if joint.kind != "planar":
                assert sine < 1e-14
            assert (
                own.advance == motion.advance
                or abs(own.advance - motion.advance) < 1e-15
            )
