"""What hangs on joints in no closed loop."""

from dataclasses import replace

import numpy as np
import pytest

from bifurc.settings import SearchSettings
from linkages import map_linkage
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.readout.poses import Poses
from linkages.readout.readout import Readout
from linkages.structure.structure import Structure
from tests.linkages.mechanisms.test_mechanism import four_bar

Z = (0.0, 0.0, 1.0)
LAMP = Joint("W", "prismatic", ("rocker", "lamp"), (0, 9, 0), Z)
HOOK = Joint("S", "spherical", ("lamp", "hook"), (0, 10, 0))
DOOR = Joint("D1", "revolute", ("hook", "door"), (0, 11, 0), Z, limits=((0.2, 1.0),))


def with_joints(*joints):
    return Mechanism((*four_bar().joints, *joints))


def test_a_chain_is_listed_with_what_every_joint_of_it_carries():
    slide, ball, door = Structure(with_joints(LAMP, HOOK, DOOR)).hanging.joints
    assert (slide.base, slide.bodies) == ("rocker", ("lamp", "hook", "door"))
    assert (ball.base, ball.bodies) == ("lamp", ("hook", "door"))
    assert (door.base, door.bodies) == ("hook", ("door",))
    assert [one.freedoms for one in (slide, ball, door)] == [1, 3, 1]
    assert slide.spaces == ("a line",)
    assert ball.spaces == ("all rotations",)
    assert door.spaces == ("an interval",)
    assert [one.limited for one in (slide, ball, door)] == [False, False, True]


def test_what_hangs_counts_in_gruebler_s_number():
    assert with_joints(LAMP, HOOK).gruebler == four_bar().gruebler + 4


def test_the_loops_are_mapped_as_they_are_alone():
    alone = [form.branch.length for form in map_linkage(four_bar()).forms]
    forms = map_linkage(with_joints(LAMP, HOOK, DOOR)).forms
    assert [form.branch.length for form in forms] == pytest.approx(alone)


def test_what_hangs_moves_with_the_body_that_it_hangs_on():
    mechanism = with_joints(LAMP, HOOK)
    readout = Readout(mechanism)
    form = map_linkage(mechanism).forms[0]
    poses = readout.poses(form.branch(np.linspace(0.0, form.branch.length, 7)))
    lamp, hook, rocker = map(mechanism.bodies.index, ("lamp", "hook", "rocker"))
    np.testing.assert_allclose(poses[:, lamp], poses[:, rocker], atol=1e-14)
    np.testing.assert_allclose(poses[:, hook], poses[:, rocker], atol=1e-14)


def test_a_joint_that_is_drawn_outside_of_its_limits_is_held_at_the_nearest_of_them():
    structure = Structure(with_joints(LAMP, HOOK, DOOR))
    (variable,) = (one for one in structure.mechanism.variables if one.label == "D1")
    assert variable.locked == 0.2


def test_with_flaps_they_are_unknowns():
    mechanism = replace(with_joints(LAMP), with_flaps=True)
    atlas = map_linkage(mechanism, settings=SearchSettings(charts=0))
    assert atlas.mobility == 2
    assert "W" in atlas.names


def test_a_joint_between_two_loops_hangs_and_both_are_mapped():
    second = [
        replace(
            joint, name=f"{joint.name}2", bodies=tuple(f"{b}2" for b in joint.bodies)
        )
        for joint in four_bar().joints
    ]
    bridge = Joint("N", "revolute", ("coupler", "frame2"), (0, 0, 0), (1, 0, 0))
    structure = Structure(with_joints(*second, bridge))
    (hanging,) = structure.hanging.joints
    assert hanging.joint == "N"
    assert set(hanging.bodies) == {"frame2", "crank2", "coupler2", "rocker2"}
    assert len(structure.closures) == 2


def test_the_body_at_rest_may_hang():
    joints = [
        replace(one, bodies=tuple("stand" if b == "frame" else b for b in one.bodies))
        for one in four_bar().joints
    ]
    joint = Joint("G", "revolute", ("ground", "crank"), (0, 0, 0), (1, 0, 0))
    mechanism = Mechanism((*joints, joint))
    assert mechanism.frame == "ground"
    (hanging,) = Structure(mechanism).hanging.joints
    assert (hanging.base, hanging.bodies) == ("crank", ("ground",))
    poses = Poses(Structure(mechanism)).at(np.zeros((1, 4)))
    np.testing.assert_allclose(poses[0, mechanism.bodies.index("ground")], np.eye(4))


def test_where_no_joint_is_in_a_loop_all_are_unknown():
    chain = Mechanism((LAMP, replace(DOOR, bodies=("lamp", "door"))))
    structure = Structure(chain)
    assert [one.label for one in structure.unknowns] == ["W", "D1"]
    assert structure.closures == ()
    assert map_linkage(chain).mobility == 2
