"""Rods of links: joined at the joints, on the axes, and rigid."""

import numpy as np
import pytest

from linkages.linkage import load
from linkages.links.rods import link_corners, seat_heights
from linkages.loop import Loop
from tests.linkages.placed_links import place_links

NAMES = ("special-double-subtractive-goldberg", "bricard-trihedral", "bennett")


def spherical():
    return Loop([0] * 4, np.radians([60, 80, 70, 100]), [0] * 4)


LOOPS = [*(load(name).loop for name in NAMES), spherical()]


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: loop.name or "spherical")
def test_neighbouring_links_meet_at_their_joint_on_its_axis(loop):
    theta = np.random.default_rng(0).uniform(-3, 3, (5, loop.n))
    placed = place_links(loop, theta)
    frames = loop.frames(theta)
    heights = seat_heights(loop)
    seats = (
        frames[..., :3, 3]
        + np.append(heights, heights[0])[:, None] * (frames[..., :3, 2])
    )
    assert placed[..., 0, :] == pytest.approx(seats[:, :-1], abs=1e-12)
    assert placed[..., 3, :] == pytest.approx(seats[:, 1:], abs=1e-12)


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: loop.name or "spherical")
def test_the_rods_of_a_link_are_its_offsets_and_its_length(loop):
    lengths, _, offsets = loop.arrays
    corners = link_corners(loop)
    rods = np.linalg.norm(np.diff(corners, axis=1), axis=-1)
    if loop.name:
        assert rods[:, 1] == pytest.approx(np.abs(lengths), abs=1e-12)
        assert rods[:, 0] == pytest.approx(np.abs(offsets) / 2, abs=1e-12)
    else:  # chords of the unit sphere
        twists = loop.arrays.twists
        assert rods[:, 2] == pytest.approx(2 * np.sin(twists / 2))
        assert np.all(rods[:, :2] == 0)


def test_joints_of_one_line_stand_beside_each_other():
    loop = Loop([0, 1, 1, 1], [0, 0, 0, 0], [0, 0, 0, 0])
    first, second = seat_heights(loop)[:2]
    assert abs(second - first) > 0.1
