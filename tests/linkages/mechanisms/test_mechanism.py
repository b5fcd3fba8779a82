"""Joints and mechanisms as data: what they hold, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from linkages.mapping import map_linkage
from linkages.mechanisms.joint import Joint, JointKind
from linkages.mechanisms.mechanism import Mechanism
from linkages.structure.groups import displacement_of
from linkages.structure.structure import Structure
from linkages.values import GeometryError

Z = (0, 0, 1)


def revolute(name, bodies, x, y=0.0):
    return Joint(name, "revolute", bodies, point=(x, y, 0), direction=Z)


def four_bar():
    return Mechanism(
        (
            revolute("A", ("frame", "crank"), 0),
            revolute("B", ("crank", "coupler"), 0, 1),
            revolute("C", ("coupler", "rocker"), 2, 1.5),
            revolute("D", ("rocker", "frame"), 2),
        )
    )


def test_kinds_have_the_freedoms_of_the_textbooks():
    full = {"point": (0, 0, 0), "direction": Z}
    two = ("a", "b")
    joints = [
        Joint("J", "revolute", two, **full),
        Joint("J", "prismatic", two, direction=Z),
        Joint("J", "cylindrical", two, **full),
        Joint("J", "helical", two, **full, pitch=0.1),
        Joint("J", "universal", two, **full, second_direction=(1, 0, 0)),
        Joint("J", "spherical", two, point=(0, 0, 0)),
        Joint("J", "planar", two, direction=Z),
        Joint("J", "rigid", two),
    ]
    assert [joint.kind for joint in joints] == list(JointKind)
    assert [joint.freedoms for joint in joints] == [1, 1, 2, 1, 2, 3, 3, 0]


def test_a_joint_of_three_bodies_is_two_revolutes():
    joint = revolute("J", ("frame", "crank", "rod"), 0)
    assert joint.parts == ("crank", "rod")
    assert joint.freedoms == 2


def test_the_graph_has_a_node_a_body_and_an_edge_a_pair():
    graph = four_bar().graph()
    assert set(graph) == {"frame", "crank", "coupler", "rocker"}
    assert {data["joint"] for _, _, data in graph.edges(data=True)} == set("ABCD")


def test_locks_are_named_and_counted():
    locked = four_bar().with_locks({"A": 0.3})
    assert four_bar().gruebler == -2
    assert locked.gruebler == -3
    with pytest.raises(GeometryError, match=r'lock: "Q" .* one of A, B, C, D'):
        four_bar().with_locks({"Q": 1.0})


def test_scaling_and_mirroring_there_and_back_change_nothing():
    mechanism = Mechanism(
        (
            Joint("H", "helical", ("a", "b"), (1, 2, 3), (0, 1, 2), pitch=0.5),
            Joint("C", "cylindrical", ("b", "a"), (1, 0, 3), Z, locked=(0.1, 2.0)),
        )
    )
    back = mechanism.scaled(4.0).scaled(0.25).mirrored().mirrored()
    assert np.allclose(back.joints[0].point, (1, 2, 3))
    assert back.joints[1].locked == (0.1, 2.0)
    assert mechanism.scaled(4.0).joints[1].locked == (0.1, 8.0)
    assert mechanism.scaled(4.0).joints[0].pitch == 2.0


def changed(**changes):
    """The four-bar with other values of joint B."""
    joints = list(four_bar().joints)
    joints[1] = replace(joints[1], **changes)
    return Mechanism(tuple(joints))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "hinge"}, r'kind of joint B: "hinge" .* revolute, prismatic'),
        ({"name": "A"}, r'name of a joint: "A" .* given once'),
        ({"name": " "}, r"name of a joint"),
        ({"bodies": ("crank",)}, r"bodies of joint B: \['crank'\] .* two names"),
        ({"bodies": ("crank", "crank")}, r"different; crank stands twice"),
        ({"bodies": "crank"}, r"bodies of joint B"),
        ({"bodies": ("crank", 3)}, r"bodies of joint B: 3"),
        ({"direction": (0, 0, 0)}, r"direction of joint B: .* a non-zero vector"),
        ({"direction": None}, r"direction of joint B: a missing key .* revolute"),
        ({"point": (1, 2)}, r"point of joint B: \[1, 2\] .* vector"),
        ({"point": (1, 2, float("nan"))}, r"point of joint B\[3\]: nan .* finite"),
        ({"pitch": 0.1}, r"pitch of joint B: 0.1 .* left out"),
        ({"limits": ((1.0, 0.0),)}, r"limits of joint B: \[1.0, 0.0\] .* smaller"),
        ({"limits": ((0.0, 1.0),) * 2}, r"number of limits of joint B: 2 .* 1"),
        ({"limits": ((1.0, 1.0),)}, r"limits of joint B: \[1.0, 1.0\] .* locked = 1.0"),
        ({"limits": ((0.0,),)}, r"limits of joint B: \[0.0\] .* \[low, high\]"),
        ({"limits": ((0.0, 1.0, 2.0),)}, r"limits of joint B: \[0.0, 1.0, 2.0\]"),
        ({"limits": (5.0,)}, r"limits of joint B: 5.0 .* \[low, high\]"),
        ({"limits": 5.0}, r"limits of joint B: 5.0 .* \[low, high\]"),
        ({"limits": "ab"}, r'limits of joint B: "ab" .* \[low, high\]'),
        ({"limits": ((0.0, float("inf")),)}, r"limits of joint B: inf .* finite"),
        ({"limits": ((float("nan"), 1.0),)}, r"limits of joint B: nan .* finite"),
        ({"limits": ((-7000.0, 1.0),)}, r"limits of joint B: -7000 rad .* 1000 turns"),
        ({"locked": (0.1, 0.2)}, r"number of values of locked of joint B: 2"),
        ({"limits": ((0.0, 1.0),), "locked": (2.0,)}, r"locked of joint B: 2.0"),
        ({"kind": "universal"}, r"second_direction of joint B: a missing key"),
        (
            {"kind": "universal", "second_direction": Z},
            r"second_direction of joint B: .* not parallel",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_value(changes, message):
    with pytest.raises(GeometryError, match=message):
        changed(**changes)


def test_bodies_that_do_not_hang_together_are_parts():
    second = [
        replace(
            joint, name=f"{joint.name}2", bodies=tuple(f"{b}2" for b in joint.bodies)
        )
        for joint in four_bar().joints
    ]
    both = Mechanism((*four_bar().joints, *second))
    assert [part.joints for part in both.parts] == [four_bar().joints, tuple(second)]
    with pytest.raises(GeometryError, match=r"2 mechanisms apart, of frame, frame2"):
        Structure(both)


FULL = {"point": (0.3, -0.2, 0.4), "direction": (0.3, 0.5, -0.7)}
TWO = ("frame", "body")


@pytest.mark.parametrize(
    "joint",
    [
        Joint("J", "revolute", TWO, **FULL),
        Joint("J", "prismatic", TWO, direction=FULL["direction"]),
        Joint("J", "cylindrical", TWO, **FULL),
        Joint("J", "cylindrical", ("frame", "body", "third"), **FULL),
        Joint("J", "helical", TWO, **FULL, pitch=0.3),
        Joint("J", "universal", TWO, **FULL, second_direction=(1, 0, 0)),
        Joint("J", "planar", TWO, **FULL),
        Joint("J", "planar", TWO, **FULL, second_direction=(1, 2, 0)),
        Joint("J", "planar", TWO, direction=(0, 0, 1)),
    ],
    ids=lambda joint: f"{joint.kind} of {len(joint.bodies)}",
)
def test_a_joint_in_the_mirror_is_locked_where_the_mirror_image_is(joint):
    values = tuple(0.1 + 0.2 * k for k in range(len(joint.parts)))
    limits = tuple((value - 0.05, value + 0.5) for value in values)
    locked = replace(joint, locked=values, limits=limits)
    mirror = np.diag([1.0, 1.0, -1.0, 1.0])
    for number in range(len(joint.bodies) - 1):
        own = placed(locked, number)
        image = placed(mirror_image(locked), number)
        assert image == pytest.approx(mirror @ own @ mirror, abs=1e-14)
    for value, pair in zip(
        mirror_image(locked).locked, mirror_image(locked).limits, strict=True
    ):
        assert min(abs(value - pair[0]), abs(value - pair[1])) == pytest.approx(0.05)
    twice = mirror_image(mirror_image(locked))
    assert np.allclose(twice.locked, values)
    assert np.allclose(twice.limits, limits)


def mirror_image(joint):
    return with_joint(joint).mirrored().joints[0]


def with_joint(joint):
    """A mechanism of a joint and a rigid one between the same bodies."""
    return Mechanism((joint, Joint("K", "rigid", joint.bodies)))


def placed(joint, number):
    """The transform (4, 4) of a body of a locked joint from the reference."""
    return displacement_of(with_joint(joint), number)


@pytest.mark.parametrize(
    ("name", "bodies"),
    [
        ("C.turn", ("crank", "coupler")),
        ("C.slide", ("crank", "coupler")),
        ("D.rod", ("crank", "coupler")),
    ],
)
def test_a_joint_that_is_called_as_a_variable_of_another_is_refused(name, bodies):
    joints = (
        revolute("A", ("frame", "crank"), 0),
        revolute(name, bodies, 0, 1),
        Joint("C", "cylindrical", ("coupler", "rocker"), (2, 1.5, 0), Z),
        revolute("D", ("rocker", "frame", "rod"), 2),
        revolute("E", ("rod", "crank"), 1),
    )
    other = name[0]
    with pytest.raises(GeometryError, match=rf'joints {name} and {other}: "{name}"'):
        Mechanism(joints)


def test_variables_of_two_joints_that_are_called_alike_are_refused():
    # the one of C and "turn", the other of C.turn and nothing
    joints = (
        Joint("C", "cylindrical", ("a", "b"), (2, 1.5, 0), Z),
        revolute("C.slide", ("a", "b", "turn"), 0),
        revolute("E", ("turn", "b"), 1),
    )
    with pytest.raises(GeometryError, match=r"joints C and C\.slide"):
        Mechanism(joints)


def test_a_coordinate_of_a_body_and_a_variable_are_called_differently():
    # platform P, held by six rods, and a joint that is called as it is
    rng = np.random.default_rng(2)
    joints = []
    for k in range(5):
        near, far = rng.normal(size=(2, 3))
        joints.append(Joint(f"A{k}", "spherical", ("frame", f"rod{k}"), near))
        joints.append(
            Joint(f"B{k}", "spherical", (f"rod{k}", "P"), far + np.array([0, 0, 5]))
        )
    joints.append(Joint("P", "planar", ("frame", "arm"), (9, 0, 0), Z))
    joints.append(Joint("Q", "planar", ("frame", "arm"), (8, 0, 0), (1, 0, 0)))
    labels = [one.label for one in Structure(Mechanism(tuple(joints))).unknowns]
    assert {"P.x", "P.x (2)"} <= set(labels)
    assert len(labels) == len(set(labels))


@pytest.mark.parametrize("first", [0, 1, 2])
def test_a_body_on_an_axis_of_several_alone_turns_by_itself_in_any_order(first):
    bodies = ("loose", "frame", "crank")
    around = bodies[first:] + bodies[:first]
    joints = (revolute("A", around, 0), *four_bar().joints[1:])
    mechanism = Mechanism(joints)
    (hanging,) = Structure(mechanism).hanging.joints
    assert (hanging.joint, hanging.bodies) == ("A", ("loose",))
    lengths = [form.branch.length for form in map_linkage(mechanism).forms]
    alone = [form.branch.length for form in map_linkage(four_bar()).forms]
    assert lengths == pytest.approx(alone)
