"""The table of a mechanism that is a single loop."""

from dataclasses import replace

import numpy as np
import pytest

import linkages
from linkages.closure.closure import Closure
from linkages.construction.constructions import lock
from linkages.identification.equivalence import compare, readings, table
from linkages.identification.identify import identify
from linkages.mechanisms.joint import Joint
from linkages.mechanisms.mechanism import Mechanism
from linkages.mechanisms.of_loop import mechanism_of_loop
from linkages.networks.entries import NETWORKS
from linkages.networks.mechanism import lock_network
from linkages.structure.single_loop import loop_geometry
from linkages.values import GeometryError


def closed(name):
    """A loop of the catalogue and a configuration (n,) of it."""
    loop = linkages.load_linkage(name).loop
    seeds = Closure(loop).seeds(np.random.default_rng(0), 4)
    return loop, seeds.points[0]


def limited(mechanism):
    """The mechanism with limits on its first joint."""
    first, *others = mechanism.joints
    return replace(mechanism, joints=(replace(first, limits=((-1.0, 1.0),)), *others))


@pytest.mark.parametrize(
    "name", ["bennett", "goldberg-5r", "mixed-double-goldberg-type-i"]
)
def test_limits_make_no_difference(name):
    loop, theta = closed(name)
    mechanism = limited(mechanism_of_loop(loop, theta))
    assert identify(loop_geometry(mechanism)).names == identify(loop).names


@pytest.mark.parametrize("joint", [1, 3, 6])
@pytest.mark.parametrize("value", [0.0, 0.7])
def test_a_locked_joint_is_replaced_with_its_links(joint, value):
    loop, theta = closed("bricard-line-symmetric")
    mechanism = mechanism_of_loop(loop, theta).with_locks({f"J{joint}": value})
    geometry = loop_geometry(mechanism)
    expected = lock(loop, joint, float(theta[joint - 1]) + value)
    assert geometry.n == 5
    tables = [one.of(table(geometry)) for one in readings(5) if not one.is_mirrored]
    gaps = compare(table(expected), np.array(tables), expected.characteristic_length)
    assert gaps.exact.min() < 1e-9


def test_the_linkage_that_a_lock_leaves_is_recognised():
    loop, theta = closed("mixed-double-goldberg-type-iii")
    mechanism = mechanism_of_loop(loop, theta)
    straight = mechanism.with_locks({"J3": -float(theta[2])})
    assert "goldberg-5r" in identify(loop_geometry(straight), 1e-7).names


def test_points_far_from_the_origin_are_known_to_less():
    loop, theta = closed("bennett")
    joints = []
    for joint in mechanism_of_loop(loop, theta).joints:
        point = tuple(np.array(joint.point) + 1e6)
        joints.append(replace(joint, point=point))
    geometry = loop_geometry(Mechanism(tuple(joints)))
    assert geometry.rounding > 1e-11
    assert "bennett" in identify(geometry).names


def platform_leg():
    """A loop with a prismatic joint."""
    return Mechanism(
        (
            Joint("A", "revolute", ("frame", "a"), (0, 0, 0), (0, 0, 1)),
            Joint("B", "revolute", ("a", "b"), (1, 0, 0), (0, 0, 1)),
            Joint("C", "revolute", ("b", "c"), (2, 1, 0), (0, 0, 1)),
            Joint("D", "prismatic", ("c", "frame"), None, (1, 0, 0)),
        )
    )


@pytest.mark.parametrize(
    ("mechanism", "reason"),
    [
        (platform_leg(), r"a prismatic joint \(D\)"),
        (lock_network(NETWORKS["serial-bennett-network"].build(), {}), "3 independent"),
    ],
)
def test_other_mechanisms_are_refused_with_the_reason(mechanism, reason):
    with pytest.raises(GeometryError, match=reason):
        loop_geometry(mechanism)


def planar_five_bar(points):
    """Five revolute joints with parallel axes through points (5, 2)."""
    joints = [
        Joint(
            f"J{k + 1}",
            "revolute",
            (f"body {k}", f"body {(k + 1) % 5}"),
            point=(*point, 0.0),
            direction=(0.0, 0.0, 1.0),
        )
        for k, point in enumerate(points)
    ]
    return Mechanism(tuple(joints))


def test_a_locked_joint_of_a_planar_five_bar_leaves_a_four_bar():
    points = np.array([[0, 0], [0.3, 1.0], [1.2, 1.7], [2.4, 1.1], [2.0, 0]])
    geometry = loop_geometry(planar_five_bar(points).with_locks({"J3": 0.4}))
    before, after = points[2] - points[1], points[3] - points[2]
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    ends = [turn @ after + before, np.linalg.inv(turn) @ after + before]
    lengths = np.array([float(value) for value in geometry.lengths])
    assert geometry.n == 4
    gaps = [np.abs(lengths - np.linalg.norm(end)).min() for end in ends]
    assert min(gaps) < 1e-14


@pytest.mark.parametrize("middle", [0.0, 0.5])
def test_a_lock_that_makes_two_axes_one_is_named(middle):
    # the links beside J3 are equally long and fold onto each other one of both ways
    five_bar = planar_five_bar([[0, 0], [1, 0], [2, 0], [2, 1], [1 - middle, 1]])
    with pytest.raises(
        GeometryError, match=r"lock of J3: -?90 degrees .* not the same"
    ):
        for value in (90.0, -90.0):
            loop_geometry(five_bar.with_locks({"J3": np.radians(value)}))
