"""Geometry of a loop: frames, screws, relabelling, axes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkages.catalogue import entry
from linkages.closure.loop_closure import LoopClosure
from linkages.loop import GeometryError, Loop, loop_from_axes

NAMES = [
    "bennett",
    "goldberg-5r",
    "bricard-line-symmetric",
    "reconfigurable-bricard-1",
    "parallelogram",
]


def closed(loop):
    return LoopClosure(loop).seeds(np.random.default_rng(0), 1).points[0]


def gap(loop, theta):
    return np.abs(loop.frames(theta)[-1] - np.eye(4)).max() / max(
        loop.characteristic_length, 1.0
    )


def test_a_frame_is_turn_offset_length_twist_in_that_order():
    loop = Loop((0.7, 1, 1, 1), (0.4, 0, 0, 0), (0.3, 0, 0, 0))
    t, alpha = 0.9, 0.4
    turn = np.array(
        [
            [np.cos(t), -np.sin(t), 0, 0],
            [np.sin(t), np.cos(t), 0, 0],
            [0, 0, 1, 0],
            [0, 0, 0, 1],
        ]
    )
    slide, length, twist = np.eye(4), np.eye(4), np.eye(4)
    slide[2, 3], length[0, 3] = 0.3, 0.7
    twist[1:3, 1:3] = [[np.cos(alpha), -np.sin(alpha)], [np.sin(alpha), np.cos(alpha)]]
    assert loop.frames(np.array([t, 0, 0, 0]))[1] == pytest.approx(
        turn @ slide @ length @ twist, abs=1e-15
    )


def test_frames_of_many_configurations_are_those_of_each():
    loop = entry("bricard-line-symmetric").build()
    thetas = np.random.default_rng(0).uniform(-3, 3, (2, 3, 6))
    assert loop.frames(thetas)[1, 2] == pytest.approx(
        loop.frames(thetas[1, 2]), abs=1e-15
    )


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6))
def test_a_joint_screw_is_the_velocity_of_the_end_point(theta):
    loop, theta = entry("bricard-line-symmetric").build(), np.array(theta)
    screws, end = loop.joint_screws(theta), loop.frames(theta)[-1]
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-6
        rate = (loop.frames(theta + step)[-1] - loop.frames(theta - step)[-1]) / 2e-6
        spin = rate[:3, :3] @ end[:3, :3].T
        assert [spin[2, 1], spin[0, 2], spin[1, 0]] == pytest.approx(
            screws[:3, i], abs=1e-8
        )
        velocity = screws[3:, i] + np.cross(screws[:3, i], end[:3, 3])
        assert rate[:3, 3] == pytest.approx(
            velocity, abs=1e-8
        )  # lengths of some 10, steps of 1e-6


@pytest.mark.parametrize("name", NAMES)
def test_the_same_linkage_under_other_labels_closes_at_the_same_angles(name):
    loop = entry(name).build()
    theta = closed(loop)
    for shift in range(-1, loop.n + 1):
        assert gap(loop.relabelled(shift), np.roll(theta, -shift)) < 1e-13
    assert gap(loop.reversed(), theta[::-1]) < 1e-13
    assert gap(loop.mirrored(), theta) < 1e-13
    for factor in (1e-3, 1e3):
        assert gap(loop.scaled(factor), theta) < 1e-13


def test_labels_return_after_a_full_round_and_two_reversals():
    loop = entry("reconfigurable-bricard-1").build()
    assert loop.relabelled(2).relabelled(4) == loop
    assert loop.reversed().reversed() == loop
    assert loop.mirrored().mirrored() == loop


def test_the_characteristic_length_is_the_mean_extent_and_one_where_there_is_none():
    assert Loop(
        (1, 2, 0, 3), (0,) * 4, (0, -2, 0, 1)
    ).characteristic_length == pytest.approx((1 + 4 + 4) / 3)
    assert Loop((0,) * 4, (1,) * 4, (0,) * 4).characteristic_length == 1.0


@pytest.mark.parametrize("name", NAMES[:-1])
def test_axes_of_a_configuration_give_the_loop_back_in_any_frame_and_unit(name):
    loop = entry(name).build()
    theta = closed(loop)
    frames = loop.frames(theta)[:-1]
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    along = np.random.default_rng(2).uniform(
        -1, 1, (loop.n, 1)
    )  # any point of an axis will do
    points = 5.0 * (frames[:, :3, 3] + along * frames[:, :3, 2]) @ rotation.T + 3.0
    again, angles = loop_from_axes(points, 2.0 * frames[:, :3, 2] @ rotation.T)
    assert gap(again, angles) < 1e-12
    # the common normal has two senses: a length and its neighbours' angles may change
    # sign together
    assert np.abs(again.arrays[0]) == pytest.approx(
        5.0 * np.abs(loop.arrays[0]), abs=1e-12
    )
    assert np.abs(np.sin(again.arrays[1])) == pytest.approx(
        np.abs(np.sin(loop.arrays[1])), abs=1e-12
    )
    assert np.abs(again.arrays[2]) == pytest.approx(
        5.0 * np.abs(loop.arrays[2]), abs=1e-12
    )


@pytest.mark.parametrize(
    ("arguments", "name", "value"),
    [
        (((1,) * 3, (0,) * 3, (0,) * 3), "number of joints", 3),
        (((1,) * 13, (0,) * 13, (0,) * 13), "number of joints", 13),
        (((1,) * 4, (0,) * 5, (0,) * 4), "number of twists", 5),
        (((1,) * 4, (0,) * 4, (0,) * 3), "number of offsets", 3),
        (((1, 1, float("nan"), 1), (0,) * 4, (0,) * 4), "lengths[3]", "nan"),
        (((1,) * 4, (0, float("inf"), 0, 0), (0,) * 4), "twists[2]", "inf"),
        (((1,) * 4, (0,) * 4, (0, 0, 0, -float("inf"))), "offsets[4]", "-inf"),
    ],
)
def test_a_loop_that_cannot_be_built_is_refused_by_name_and_value(
    arguments, name, value
):
    with pytest.raises(GeometryError) as caught:
        Loop(*arguments)
    assert caught.value.name == name
    assert str(value) in str(caught.value)
    assert caught.value.allowed in str(caught.value)


def test_a_configuration_of_another_number_of_angles_is_refused():
    with pytest.raises(GeometryError, match="number of joint angles"):
        entry("bennett").build().frames(np.zeros(5))


@pytest.mark.parametrize(
    ("points", "directions", "words"),
    [
        ([[0, 0, 0]] * 4, [[0, 0, 1]] * 3, "shape of directions"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, np.nan, 0]], [[0, 0, 1]] * 4, "points"),
        (
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            [[0, 0, 1], [0, 0, 0], [0, 0, 1], [0, 0, 1]],
            "directions.*2.*non-zero",
        ),
        (
            [[0, 0, 0], [0, 0, 1], [1, 1, 0], [0, 1, 0]],
            [[0, 0, 1]] * 4,
            "axes 1 and 2.*same line",
        ),
    ],
)
def test_axes_that_make_no_loop_are_refused_by_name(points, directions, words):
    with pytest.raises(GeometryError, match=words):
        loop_from_axes(points, directions)
