"""The loop of joint axes: back and forth, parallel and intersecting axes, refusals."""

import numpy as np
import pytest

from linkages.axes import loop_from_axes
from linkages.catalogue import entry
from linkages.closure.closure import Closure
from linkages.values import GeometryError

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
UPRIGHT = [[0, 0, 1]] * 4


def replaced(vectors, i, vector):
    """The vectors with another one at place ``i``."""
    return [*vectors[:i], vector, *vectors[i + 1 :]]


def closed_configuration(loop):
    return Closure(loop).seeds(np.random.default_rng(0), 1).points[0]


@pytest.mark.parametrize(
    "name",
    ["bennett", "goldberg-5r", "bricard-line-symmetric", "reconfigurable-bricard-1"],
)
def test_axes_of_a_configuration_give_the_loop_back_in_any_frame_and_unit(name):
    loop = entry(name).build()
    frames = loop.frames(closed_configuration(loop))[:-1]
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    # any point of an axis will do
    along = np.random.default_rng(2).uniform(-1, 1, (loop.n, 1))
    directions = frames[:, :3, 2]
    points = 5.0 * (frames[:, :3, 3] + along * directions) @ rotation.T + 3.0
    again, angles = loop_from_axes(points, 2.0 * directions @ rotation.T)
    assert again.closure_error(angles) < 1e-12
    # the common normal has two senses: a length and its neighbours' angles may change
    # sign together
    one, other = again.arrays, loop.arrays
    lengths, offsets = 5.0 * np.abs(other.lengths), 5.0 * np.abs(other.offsets)
    sines = np.abs(np.sin(other.twists))
    assert np.abs(one.lengths) == pytest.approx(lengths, abs=1e-12)
    assert np.abs(np.sin(one.twists)) == pytest.approx(sines, abs=1e-12)
    assert np.abs(one.offsets) == pytest.approx(offsets, abs=1e-12)


def test_parallel_axes_have_no_twist_and_no_offset_between_them():
    loop, angles = loop_from_axes(SQUARE, UPRIGHT)
    assert loop.lengths == pytest.approx([1, 1, 1, 1])
    assert loop.twists == loop.offsets == (0.0, 0.0, 0.0, 0.0)
    assert np.abs(angles) == pytest.approx(np.pi / 2)


def test_the_normal_of_parallel_axes_goes_on_from_the_foot_of_the_previous_one():
    # axes 1 and 2 are parallel and 3 and 4 are not: only the axes next to those two
    # have offsets
    points = [[0, 0, 0], [1, 0, 5], [2, 1, 0], [0, 3, 1]]
    directions = [[0, 0, 1], [0, 0, 2], [0, 1, 1], [1, 0, 1]]
    loop, angles = loop_from_axes(points, directions)
    assert loop.closure_error(angles) < 1e-14
    assert loop.twists[0] == 0.0
    assert loop.lengths[0] == pytest.approx(1.0)


def test_axes_that_meet_in_a_point_have_lengths_and_offsets_of_exactly_zero():
    axes = [[1, 0, 1], [0, 1, 1], [-1, 0, 1.2], [0, -1, 1.5]]
    loop, angles = loop_from_axes(axes, axes)
    assert loop.lengths == loop.offsets == (0.0, 0.0, 0.0, 0.0)
    assert loop.closure_error(angles) < 1e-14


@pytest.mark.parametrize(
    ("points", "directions", "words"),
    [
        (SQUARE, UPRIGHT[:3], "number of directions: 3 .* 4, the number of points"),
        (SQUARE[:3], UPRIGHT[:3], "number of points: 3 .* 4 to 12 joints"),
        ([], [], "number of points: 0"),
        (7, UPRIGHT, "points: 7 .* a list of vectors"),
        (SQUARE, "zzzz", r'directions\[1\]: "z" .* a vector'),
        (replaced(SQUARE, 2, [1, 1]), UPRIGHT, r"points\[3\]: \[1, 1\] .* a vector"),
        (replaced(SQUARE, 2, 1.0), UPRIGHT, r"points\[3\]: 1.0 .* a vector"),
        (
            replaced(SQUARE, 3, [0, np.nan, 0]),
            UPRIGHT,
            r"points\[4\]\[2\]: nan .* a finite number",
        ),
        (
            SQUARE,
            replaced(UPRIGHT, 0, [0, 0, np.inf]),
            r"directions\[1\]\[3\]: inf .* a finite number",
        ),
        (
            SQUARE,
            replaced(UPRIGHT, 0, [0, "1", 1]),
            r'directions\[1\]\[2\]: "1" .* a number',
        ),
        (
            SQUARE,
            replaced(UPRIGHT, 1, [0, 0, 0]),
            r"directions\[2\]: 0, 0, 0 .* a non-zero vector",
        ),
        (
            replaced(SQUARE, 1, [0, 0, 1]),
            UPRIGHT,
            "axes 1 and 2: the same line .* different lines",
        ),
        (
            replaced(SQUARE, 0, [0, 1, 7]),
            replaced(UPRIGHT, 0, [0, 0, -2]),
            "axes 4 and 1: the same line .* different lines",
        ),
    ],
)
def test_axes_that_make_no_loop_are_refused_by_name_and_value(
    points, directions, words
):
    with pytest.raises(GeometryError, match=words):
        loop_from_axes(points, directions)


def meeting_axes(missed):
    """Four axes of which neighbours meet, but for one pair that misses by so much."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    directions = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    points[0][2] = missed
    return points, directions


@pytest.mark.parametrize("missed", [1e-16, 3e-14])
def test_lengths_that_were_taken_as_zero_are_recorded_as_rounding(missed):
    loop, _ = loop_from_axes(*meeting_axes(missed))
    assert loop.lengths == (0.0, 0.0, 0.0, 0.0)
    # what doubles of this size miss anyhow is not worth a word
    assert loop.rounding == (missed if missed > 1e-15 else 0.0)


def test_lengths_that_are_more_than_rounding_are_kept():
    loop, _ = loop_from_axes(*meeting_axes(1e-12))
    assert max(loop.lengths) == pytest.approx(1e-12, rel=1e-3)
    assert loop.rounding == 0.0


@pytest.mark.parametrize("far", [1e4, -1e8])
def test_axes_far_from_the_origin_have_the_lengths_of_their_differences(far):
    points = [[0, 0, 0], [0.75, 1.125, 0], [2.25, 1.5, 0.5], [3, 0, 0.25]]
    directions = [[0, 0, 1], [0.1, 0, 1], [0, 0.2, 1], [0.3, 0, 1]]
    near, _ = loop_from_axes(points, directions)
    moved, _ = loop_from_axes([[x + far, y, z] for x, y, z in points], directions)
    assert moved.arrays.lengths == pytest.approx(near.arrays.lengths, abs=1e-14)
    assert moved.arrays.offsets == pytest.approx(near.arrays.offsets, abs=1e-13)
    assert near.rounding == 0.0
    assert moved.rounding == np.spacing(abs(far)) / 2
