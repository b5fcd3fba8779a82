"""Segments of links and hinges lie where the axes are."""

import numpy as np
import pytest

from linkages.linkage import load
from linkages.links.distances import segment_distances
from linkages.loop import Loop
from linkages.mapping import map_linkage
from linkages.printing.assembly import (
    Assembly,
    Dimensions,
    Kind,
    Seats,
    link_corners,
    pairs_that_may_meet,
)

DIMENSIONS = Dimensions(6.0, 0.3, 1.2)


@pytest.fixture(scope="module")
def closed():
    """A linkage in mm with any seats, and a configuration."""
    name = "special-double-subtractive-goldberg"
    form = map_linkage(load(name)).forms[0]
    loop = load(name).loop.scaled(100.0)
    random = np.random.default_rng(3)
    sides = np.array([1.0, -1.0, 1.0, 1.0, -1.0, -1.0])
    seats = Seats(random.uniform(-80, 80, loop.n), sides)
    return Assembly(loop, DIMENSIONS, seats), form.branch(1.3)


def test_the_eyes_of_two_links_and_the_hinge_are_on_one_axis(closed):
    """The two eyes of a joint are a step from the middle of its hinge, on the axis that
    the joint screw gives."""
    assembly, theta = closed
    n = assembly.loop.n
    placed = assembly.placed(theta[None])[0]
    screws = assembly.loop.joint_screws(theta)
    heights, sides = assembly.seats.heights, assembly.seats.sides
    feet = assembly.loop.frames(theta)[:-1, :3, 3]
    for joint in range(n):
        axis, moment = screws[:3, joint], screws[3:, joint]
        middle = feet[joint] + heights[joint] * axis
        behind = placed[3 * joint, 0]
        before = placed[3 * ((joint - 1) % n) + 2, 1]
        step = sides[joint] * DIMENSIONS.step * axis
        assert behind == pytest.approx(middle + step, abs=1e-9)
        assert before == pytest.approx(middle - step, abs=1e-9)
        for point in (behind, before, *placed[3 * n + joint]):
            assert np.cross(point, axis) == pytest.approx(moment, abs=1e-9)


def test_links_leave_their_axes_at_right_angles(closed):
    assembly, _ = closed
    corners = link_corners(assembly.loop, DIMENSIONS, assembly.seats)
    twists = assembly.loop.arrays.twists
    axes = np.stack([0 * twists, np.sin(twists), np.cos(twists)], axis=1)
    first, last = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 3]
    assert (first * axes).sum(axis=1) == pytest.approx(np.zeros(6), abs=1e-9)
    assert last[:, 2] == pytest.approx(np.zeros(6), abs=1e-9)
    for arm in (first, last):
        assert np.linalg.norm(arm, axis=1) == pytest.approx(np.full(6, DIMENSIONS.arm))


def test_a_link_along_its_axis_leaves_it_across():
    loop = Loop([0, 1, 1, 1], [0, 1, 1, 1], [0, 0, 0, 0]).scaled(50.0)
    seats = Seats(np.array([40.0, -40.0, 0.0, 0.0]), np.ones(4))
    corners = link_corners(loop, DIMENSIONS, seats)
    assert np.all(np.isfinite(corners))
    assert corners[0, 1] - corners[0, 0] == pytest.approx([DIMENSIONS.arm, 0, 0])


def test_all_segments_are_compared_but_those_of_one_part_and_of_one_hinge():
    n = 6
    loop = Loop([1.0] * n, [1.0] * n, [0.0] * n)
    assembly = Assembly(loop, DIMENSIONS, Seats(np.zeros(n), np.ones(n)))
    pairs = {tuple(pair) for pair in pairs_that_may_meet(n).tolist()}
    assert len(pairs) == 24 * 23 // 2 - 6 * 3 - 6 * 3
    assert all(assembly.part(a) != assembly.part(b) for a, b in pairs)
    hinges = [m for m in range(24) if assembly.part(m).kind is Kind.HINGE]
    assert hinges == list(range(18, 24))
    assert (0, 18) not in pairs  # the first arm of link 12 at hinge 1
    assert (0, 17) not in pairs  # that and the last arm of link 61
    assert (2, 19) not in pairs
    assert (1, 18) in pairs  # the rod between the arms may come back
    assert (0, 19) in pairs


def test_distances_of_many_choices_are_those_of_each(closed):
    assembly, theta = closed
    heights = np.stack([assembly.seats.heights, assembly.seats.heights / 2])
    sides = np.stack([assembly.seats.sides, -assembly.seats.sides])
    both = Assembly(assembly.loop, DIMENSIONS, Seats(heights, sides))
    moments = np.stack([theta, theta + 0.1])
    together = both.clearances(both.placed(moments), both.pairs)
    assert together.shape == (2, 2, len(both.pairs))
    for k in range(2):
        one = Assembly(assembly.loop, DIMENSIONS, Seats(heights[k], sides[k]))
        alone = one.clearances(one.placed(moments), one.pairs)
        assert together[k] == pytest.approx(alone, abs=1e-9)
    placed = assembly.placed(theta[None])[0]
    a, b = assembly.pairs[40]
    expected = segment_distances(*placed[a], *placed[b]) - assembly.radii[[a, b]].sum()
    seen = assembly.clearances(placed[None], assembly.pairs)[0, 40]
    assert seen == pytest.approx(expected)
