"""The network of four Bennett linkages in closed form."""

import numpy as np
import pytest

from linkages.closed_forms.bennett_network import (
    angle_for,
    inner_angle,
    ring_angles,
    ring_loop,
)

TWISTS = dict(zip("abcd", np.radians([35.0, 62.0, 81.0, 48.0]), strict=True))
SPECIAL = dict(
    zip("abcd", np.radians([125.0, 14.192677219748038, 60.0, 45.0]), strict=True)
)


def test_the_ring_closes_for_any_three_odd_angles():
    rng = np.random.default_rng(5)
    loop = ring_loop(TWISTS, scale=1.7)
    for odd in rng.uniform(-np.pi, np.pi, (20, 3)):
        assert loop.closure_error(ring_angles(TWISTS, *odd)) < 1e-13


def test_the_mobility_is_three():
    loop = ring_loop(TWISTS)
    theta = ring_angles(TWISTS, 1.0, -2.0, 0.7)
    values = np.linalg.svd(loop.joint_screws(theta), compute_uv=False)
    assert values[4] > 1e-2
    assert values[5] < 1e-14


def test_the_angles_of_a_bennett_linkage_follow_each_other():
    for part in range(4):
        inner = inner_angle(TWISTS, part, 0.8)
        gap = angle_for(TWISTS, part, inner) - 0.8
        assert np.sin(gap / 2) == pytest.approx(0, abs=1e-13)


def test_a_lock_at_an_odd_joint_holds_one_inner_angle_and_at_an_even_one_a_difference():
    one = ring_angles(TWISTS, 1.0, -2.0, 0.3)
    other = ring_angles(TWISTS, 1.0, -2.0, 2.3)
    # joints 1, 2, 3 stand still, all others turn
    gap = np.abs(np.sin((one - other) / 2))
    assert gap[:3].max() < 1e-14
    assert gap[3:].min() > 1e-2


def test_all_even_joints_are_straight_in_the_case_of_a_4r_linkage():
    odd = (1.8608180359155986, -2.2699164201759237, -1.8608180359155986)
    theta = ring_angles(SPECIAL, *odd)
    assert np.abs(np.sin(theta[1::2] / 2)).max() < 1e-13
    assert ring_loop(SPECIAL).closure_error(theta) < 1e-13
