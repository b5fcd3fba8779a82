"""Geometry of a loop: frames, screws, relabelling, refusals."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.construction.constructions import lock
from linkages.identification.equivalence import as_loop, table
from linkages.loop import Loop
from linkages.tolerance import make_with_errors
from linkages.values import GeometryError

NAMES = [
    "bennett",
    "goldberg-5r",
    "bricard-line-symmetric",
    "reconfigurable-bricard-1",
    "parallelogram",
]


def closed_configuration(loop):
    return Closure(loop).seeds(np.random.default_rng(0), 1).points[0]


def gap(loop, theta):
    """The largest entry of T_1 ... T_n - I, over the unit of length if that is long."""
    unit = max(loop.characteristic_length, 1.0)
    return np.abs(loop.frames(theta)[-1] - np.eye(4)).max() / unit


def rotation_about(axis, angle):
    """The homogeneous transform of a turn about the x (0) or the z (2) axis."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    out = np.eye(4)
    out[first, first] = out[second, second] = np.cos(angle)
    out[first, second] = -np.sin(angle)
    out[second, first] = np.sin(angle)
    return out


def translation_along(axis, distance):
    out = np.eye(4)
    out[axis, 3] = distance
    return out


def test_a_frame_is_turn_offset_length_twist_in_that_order():
    loop = Loop((0.7, 1, 1, 1), (0.4, 0, 0, 0), (0.3, 0, 0, 0))
    turn, slide = rotation_about(2, 0.9), translation_along(2, 0.3)
    length, twist = translation_along(0, 0.7), rotation_about(0, 0.4)
    frame = loop.frames(np.array([0.9, 0, 0, 0]))[1]
    assert frame == pytest.approx(turn @ slide @ length @ twist, abs=1e-15)


def test_frames_of_many_configurations_are_those_of_each():
    loop = entry("bricard-line-symmetric").build()
    thetas = np.random.default_rng(0).uniform(-3, 3, (2, 3, 6))
    one = loop.frames(thetas[1, 2])
    assert loop.frames(thetas)[1, 2] == pytest.approx(one, abs=1e-15)


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6))
def test_a_joint_screw_is_the_velocity_of_the_end_point(theta):
    loop, theta = entry("bricard-line-symmetric").build(), np.array(theta)
    screws, end = loop.joint_screws(theta), loop.frames(theta)[-1]
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-6
        forward, backward = loop.frames(theta + step)[-1], loop.frames(theta - step)[-1]
        rate = (forward - backward) / 2e-6
        skew = rate[:3, :3] @ end[:3, :3].T
        spin = [skew[2, 1], skew[0, 2], skew[1, 0]]
        assert spin == pytest.approx(screws[:3, i], abs=1e-8)
        velocity = screws[3:, i] + np.cross(screws[:3, i], end[:3, 3])
        # lengths of some 10, steps of 1e-6
        assert rate[:3, 3] == pytest.approx(velocity, abs=1e-8)


@pytest.mark.parametrize("name", NAMES)
def test_the_same_linkage_under_other_labels_closes_at_the_same_angles(name):
    loop = entry(name).build()
    theta = closed_configuration(loop)
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
    loop = Loop((1, 2, 0, 3), (0,) * 4, (0, -2, 0, 1))
    assert loop.characteristic_length == pytest.approx((1 + 4 + 4) / 3)
    assert Loop((0,) * 4, (1,) * 4, (0,) * 4).characteristic_length == 1.0


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_the_closure_error_is_the_largest_entry_in_characteristic_lengths(factor):
    loop = Loop((1, 1, 1, 1), (0,) * 4, (0,) * 4).scaled(factor)
    right_angles = np.full(4, np.pi / 2)
    straight = np.zeros(4)  # four links of length 1 in line
    errors = loop.closure_error(np.array([[right_angles, straight]]))
    assert errors == pytest.approx(np.array([[0.0, 4.0]]), abs=1e-15)


@pytest.mark.parametrize(
    ("arguments", "name", "value"),
    [
        (((1,) * 3, (0,) * 3, (0,) * 3), "number of joints", 3),
        (((1,) * 13, (0,) * 13, (0,) * 13), "number of joints", 13),
        (((1,) * 4, (0,) * 5, (0,) * 4), "number of twists", 5),
        (((1,) * 4, (0,) * 4, (0,) * 3), "number of offsets", 3),
        ((4, (0,) * 4, (0,) * 4), "lengths", 4),
        ((None, (0,) * 4, (0,) * 4), "lengths", None),
        (((1, 1, float("nan"), 1), (0,) * 4, (0,) * 4), "lengths[3]", "nan"),
        (((1,) * 4, (0, float("inf"), 0, 0), (0,) * 4), "twists[2]", "inf"),
        (((1,) * 4, (0,) * 4, (0, 0, 0, -float("inf"))), "offsets[4]", "-inf"),
        (((1, 10**400, 1, 1), (0,) * 4, (0,) * 4), "lengths[2]", 10**400),
        (((1, "2", 1, 1), (0,) * 4, (0,) * 4), "lengths[2]", '"2"'),
        (((1,) * 4, (None, 0, 0, 0), (0,) * 4), "twists[1]", None),
        (((1,) * 4, (0,) * 4, (0, 1j, 0, 0)), "offsets[2]", "1j"),
        ((np.full(4, 1 + 1j), (0,) * 4, (0,) * 4), "lengths[1]", "(1+1j)"),
        ((np.ones((4, 1)), (0,) * 4, (0,) * 4), "lengths[1]", "[1.]"),
        (((True, 1, 1, 1), (0,) * 4, (0,) * 4), "lengths[1]", True),
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


def test_a_loop_shows_its_name_and_its_table_in_degrees():
    twists = np.radians([30, -45, 0, 90])
    loop = Loop((1, 0.5, 2, 3), twists, (0, -0.25, 0, 0), "mine")
    assert repr(loop).splitlines() == [
        "mine: 4 joints",
        "  joint  link  length  twist (deg)  offset",
        "  1      12    1       30.0000      0",
        "  2      23    0.5     -45.0000     -0.25",
        "  3      34    2       0.0000       0",
        "  4      41    3       90.0000      0",
    ]


def test_a_loop_of_other_number_types_is_shown_too():
    a, alpha = sympy.symbols("a alpha")
    loop = Loop((a, mpmath.mpf(2), 1, 1), (alpha, mpmath.pi, 0, 0), (0,) * 4)
    lines = repr(loop).splitlines()
    assert lines[0] == "Loop: 4 joints"
    assert lines[2].split() == ["1", "12", "a", "alpha", "rad", "0"]
    assert lines[3].split() == ["2", "23", "2", "180.0000", "0"]


def test_the_rounding_of_lengths_is_kept_wherever_a_loop_is_made_again():
    # neighbours at joint 1 have one Bennett ratio
    loop = replace(entry("goldberg-5r").build(), rounding=1e-9)
    again = [
        loop.relabelled(2),
        loop.reversed(),
        loop.mirrored(),
        lock(loop, 3),
        make_with_errors(loop, 1e-3, np.random.default_rng(0)),
        as_loop(table(loop), rounding=loop.rounding),
    ]
    assert [one.rounding for one in again] == [1e-9] * len(again)
    assert loop.scaled(1e3).rounding == 1e3 * 1e-9
