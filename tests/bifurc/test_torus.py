"""Arithmetic modulo the periods of the unknowns."""

import numpy as np
import pytest

from bifurc.torus import (
    common_period,
    difference,
    into_box,
    tree_box,
    whole_turns,
    wrap,
)

ANGLES = np.full(2, 2 * np.pi)
ONE_ANGLE = np.array([2 * np.pi, np.inf])


@pytest.mark.parametrize(
    ("periods", "expected"),
    [
        (ANGLES, [6.0 - 2 * np.pi, 6.0 - 2 * np.pi]),
        (ONE_ANGLE, [6.0 - 2 * np.pi, 6.0]),
        (np.full(2, np.inf), [6.0, 6.0]),
    ],
)
def test_a_difference_is_the_shortest_way_round(periods, expected):
    gap = difference(np.array([3.0, 3.0]), np.array([-3.0, -3.0]), periods)
    assert gap == pytest.approx(expected, abs=1e-15)


def test_wrapped_angles_lie_in_the_half_open_turn_and_rounding_does_not_change_sides():
    angles = np.array([np.pi, -np.pi, -np.pi + 1e-12, 3 * np.pi, 7.0])
    wrapped = wrap(np.stack([angles, angles], axis=1), ONE_ANGLE)
    expected = [np.pi, np.pi, np.pi, np.pi, 7.0 - 2 * np.pi]
    assert wrapped[:, 0] == pytest.approx(expected, abs=1e-9)
    assert np.array_equal(wrapped[:, 1], angles)


@pytest.mark.parametrize("periods", [ANGLES, ONE_ANGLE])
def test_points_in_the_box_are_not_negative_and_below_the_period(periods):
    points = np.array([[-1e-20, 0.5], [2 * np.pi, -1.0], [-7.0, 13.0]])
    inside = into_box(points, periods)
    periodic = np.isfinite(periods)
    assert np.all(inside[:, periodic] >= 0.0)
    assert np.all(inside[:, periodic] < 2 * np.pi)
    assert np.array_equal(inside[:, ~periodic], points[:, ~periodic])
    assert np.abs(difference(inside, points, periods)).max() < 1e-14


def test_whole_turns_count_periods_and_nothing_of_unknowns_without_one():
    turns = whole_turns(np.array([-4 * np.pi + 1e-9, 12.0]), ONE_ANGLE)
    assert turns.tolist() == [-2, 0]
    assert turns.dtype.kind == "i"


def test_a_tree_takes_no_period_as_zero():
    assert tree_box(ONE_ANGLE).tolist() == [2 * np.pi, 0.0]


@pytest.mark.parametrize(
    ("ratios", "turns"),
    [
        ((1.0, 0.0), 1.0),
        ((1.0, 0.5), 2.0),
        ((2.0, -4.0), 0.5),
        ((1 / 3, 0.5), 6.0),
        ((np.sqrt(2.0), 1.0), np.inf),
    ],
)
def test_an_angle_comes_round_when_all_that_it_turns_do(ratios, turns):
    assert common_period(ratios) == turns * 2 * np.pi
