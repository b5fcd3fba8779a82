"""Dyads in space close where two cones meet, and the bodies with them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkages.dyads.geometry import DegenerateDyadError
from linkages.dyads.space import SpaceGeometry, SpacePose
from linkages.mechanisms.joint import Motion

GEOMETRY = SpaceGeometry(1.0)


def random_pose(rng):
    return SpacePose(Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3))


def axis(rng, point=(0.0, 0.0, 0.0)):
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    return Motion(True, direction, np.array(point, dtype=float))


def gap(one, other):
    return max(np.abs(a - b).max() for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("seed", range(5))
def test_a_displacement_gives_its_variable_back(seed):
    rng = np.random.default_rng(seed)
    motion = axis(rng, rng.normal(size=3))
    for value in (-3.0, -0.2, 0.0, 1e-9, 2.9):
        relative = GEOMETRY.motion(motion, value)
        assert GEOMETRY.value(relative, motion) == pytest.approx(value, abs=1e-14)
        both = relative.after(relative.inverse())
        assert gap(both, GEOMETRY.rest) < 1e-14


@pytest.mark.parametrize("seed", range(5))
def test_a_dyad_on_a_sphere_closes_twice(seed):
    rng = np.random.default_rng(seed)
    first, second, third = (axis(rng) for _ in range(3))
    rest = GEOMETRY.rest
    one, other = GEOMETRY.joint(rest, rest, first), GEOMETRY.joint(rest, rest, third)
    pin = GEOMETRY.joint(rest, rest, second)
    found = GEOMETRY.close_dyad(one, pin, other)
    assert len(found) == 2
    assert min(max(gap(a, rest), gap(b, rest)) for a, b in found) < 1e-12
    for poses in found:
        for pose, motion in zip(poses, (first, third), strict=True):
            turned = GEOMETRY.motion(motion, GEOMETRY.value(pose, motion))
            assert gap(pose, turned) < 1e-12
        relative = poses[0].inverse().after(poses[1])
        turned = GEOMETRY.motion(second, GEOMETRY.value(relative, second))
        assert gap(relative, turned) < 1e-12


def test_a_dyad_in_general_position_closes_where_it_was_taken_from_alone():
    rng = np.random.default_rng(7)
    motions = [axis(rng, rng.normal(size=3)) for _ in range(3)]
    rest = GEOMETRY.rest
    one, other = (GEOMETRY.joint(rest, rest, motions[k]) for k in (0, 2))
    pin = GEOMETRY.joint(rest, rest, motions[1])
    ((first, second),) = GEOMETRY.close_dyad(one, pin, other)
    assert max(gap(first, rest), gap(second, rest)) < 1e-12


def test_a_part_is_placed_by_two_axes_or_by_two_parallel_ones():
    rng = np.random.default_rng(8)
    pose = random_pose(rng)
    one, other = axis(rng, (0, 0, 0)), axis(rng, (1, 0.5, -0.3))
    beside = other._replace(direction=one.direction)
    for second in (other, beside):
        ends = [GEOMETRY.joint(pose, GEOMETRY.rest, motion) for motion in (one, second)]
        (found,) = GEOMETRY.close_monad(*ends)
        assert gap(found, pose) < 1e-12
    far = other._replace(point=other.point + 0.1)
    ends = [
        GEOMETRY.joint(pose, GEOMETRY.rest, one),
        GEOMETRY.joint(pose, GEOMETRY.rest, other)._replace(
            second=GEOMETRY.joint(pose, GEOMETRY.rest, far).second
        ),
    ]
    assert GEOMETRY.close_monad(*ends) == []


def test_axes_in_one_line_leave_a_curve_of_configurations():
    rng = np.random.default_rng(9)
    first, second = axis(rng), axis(rng)
    rest = GEOMETRY.rest
    one, other = GEOMETRY.joint(rest, rest, first), GEOMETRY.joint(rest, rest, first)
    pin = GEOMETRY.joint(rest, rest, second)
    assert GEOMETRY.may_be_degenerate(one, pin, other)
    with pytest.raises(DegenerateDyadError):
        GEOMETRY.close_dyad(one, pin, other)
