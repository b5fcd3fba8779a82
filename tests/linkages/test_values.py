"""Numbers out of any sensible range are refused by name, value and range; numbers in
errors are told apart."""

import math

import numpy as np
import pytest

from linkages.axes import loop_from_axes
from linkages.construction.conditions import require_within
from linkages.linkage import load
from linkages.loop import Loop
from linkages.mechanisms.joint import Joint
from linkages.values import GeometryError, check_angle, check_direction, told_apart

UP = (0, 0, 1)


def test_a_twist_of_over_a_thousand_turns_is_refused():
    with pytest.raises(GeometryError, match=r"twists\[2\]: 1e\+298 rad .* 6283.19 rad"):
        Loop([1, 1, 1, 1], [0.1, 1e298, 0.1, 0.1], [0, 0, 0, 0])
    with pytest.raises(GeometryError, match=r"1e\+300"):
        load("bennett", alpha=1e300)


@pytest.mark.parametrize("angle", [0, -6283.0, 6283, np.float64(6283.1)])
def test_other_angles_are_taken(angle):
    check_angle("angle", angle)


def test_angles_in_degrees_are_refused_in_degrees():
    with pytest.raises(GeometryError, match=r"360000.1 deg .* -360000 and 360000 deg"):
        check_angle("angle", 360000.1, in_degrees=True)


@pytest.mark.parametrize("key", ["limits", "locked"])
def test_values_of_a_turn_have_the_same_range(key):
    value = (1e300,) if key == "locked" else ((-1e300, 1e300),)
    with pytest.raises(GeometryError, match=rf"{key} of joint J: -?1e\+300 rad"):
        Joint("J", "revolute", ("a", "b"), (0, 0, 0), UP, **{key: value})
    slide = Joint("J", "prismatic", ("a", "b"), direction=UP, **{key: value})
    assert getattr(slide, key) == value


@pytest.mark.parametrize("tiny", [1e-200, 5e-324, 1e200])
def test_directions_out_of_range_are_shown_as_they_are(tiny):
    directions = [(1, 0, 0), (0, 0, tiny), (0, 1, 0), (0, 0, 1)]
    with pytest.raises(GeometryError) as caught:
        loop_from_axes(np.zeros((4, 3)), directions)
    assert f"directions[2]: 0, 0, {tiny:.16g} is" in str(caught.value)
    assert "between 1e-100 and 1e+100" in str(caught.value)
    with pytest.raises(GeometryError, match="direction of joint J"):
        Joint("J", "revolute", ("a", "b"), (0, 0, 0), (0, 0, tiny))


def test_a_short_direction_is_a_direction():
    check_direction("direction", (0, 0, 1e-99))
    with pytest.raises(GeometryError, match="non-zero"):
        check_direction("direction", (0, 0, 0))


def test_numbers_in_errors_are_told_apart():
    assert told_apart(1.0, 2.0) == ["1", "2"]
    assert told_apart(1.0000001, 1.0) == ["1.0000001", "1"]
    assert told_apart(1.0, 1.0) == ["1", "1"]
    assert told_apart(200.0, -0.0, 180.0) == ["200", "0", "180"]
    nearly = math.nextafter(1.0, 2.0)
    assert told_apart(nearly, 1.0) == ["1.0000000000000002", "1"]
    with pytest.raises(GeometryError, match=r"3.14159267 rad .* and 3.14159265 rad"):
        require_within("twist", math.radians(180.000001), 0, math.pi)
    with pytest.raises(GeometryError, match="not at an end"):
        require_within("twist", math.pi, 0, math.pi)
