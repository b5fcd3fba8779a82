"""Points and bars: lengths that are given are the lengths of the mechanism."""

import math

import numpy as np
import pytest

import linkages
from bifurc.settings import SearchSettings
from linkages.files.bars import read_bars
from linkages.values import GeometryError

POINTS = {"A": [0, 0], "B": [0.5, 1], "C": [3, 2], "D": [4, 0]}
QUICK = SearchSettings(starts=60)
SHORTEST = 4 - math.sqrt(1.25) - math.sqrt(5)  # of BC: then all points lie on AD
LONGEST = 4 + math.sqrt(1.25) + math.sqrt(5)


def four_bar(length, points=POINTS, sides=((), ())):
    """A four-bar on A and D whose coupler has this length."""
    first, last = sides
    bars = [["A", "B", *first], ["B", "C", length], ["C", "D", *last]]
    return read_bars({"fixed": ["A", "D"], "bars": bars, "points": points}, "four-bar")


def stretched():
    """7 = 4 + 1 + 2: one assembly, on a line, which the points are far from."""
    points = {"A": [0, 0], "B": [-0.6, 0.8], "C": [5.2, 1.6], "D": [4, 0]}
    return four_bar(7.0, points, ((1.0,), (2.0,)))


def test_bars_that_are_just_long_enough_do_not_move():
    atlas = linkages.map_linkage(stretched(), settings=QUICK)
    assert not atlas.forms
    assert not atlas.surfaces
    assert len(atlas.points) + len(atlas.rigid) == 1


@pytest.mark.parametrize("length", [SHORTEST, LONGEST])
def test_bars_that_can_only_just_be_assembled_are(length):
    mechanism = four_bar(length)
    b, c = (np.array(mechanism.joint(name).point) for name in "BC")
    assert abs(np.linalg.norm(b - c) - length) < 1e-14
    assert max(abs(b[1]), abs(c[1])) < 1e-12  # first order: they lie on AD


@pytest.mark.parametrize("length", [SHORTEST - 1e-11, LONGEST + 1e-11])
def test_bars_that_miss_by_more_than_rounding_are_refused(length):
    with pytest.raises(GeometryError, match="misses its length by"):
        four_bar(length)


def test_points_that_miss_a_length_by_little_are_moved():
    # the bar between the points is 5e-12 too short for the length given
    length = math.dist(POINTS["B"], POINTS["C"]) + 5e-12
    mechanism = four_bar(length)
    b, c = (np.array(mechanism.joint(name).point) for name in "BC")
    assert abs(np.linalg.norm(b - c) - length) < 1e-15


@pytest.mark.parametrize("length", [10.0, 100.0, 1e6])
def test_the_gap_that_is_told_is_the_smallest(length):
    # three bars share what is missing on a line through A and D
    least = (length - LONGEST) / 3
    with pytest.raises(GeometryError) as error:
        four_bar(length)
    told = float(str(error.value).rsplit(" ", 1)[1])
    assert told == pytest.approx(least, rel=1e-2)


@pytest.mark.parametrize("fixed", [["A", "D"], ["A", "P", "D"], ["A", "P"]])
def test_bodies_do_not_depend_on_the_order_of_the_bars(fixed):
    bars = [["A", "B"], ["B", "C"], ["C", "D"], ["P", "A"], ["P", "B"], ["D", "A"]]
    on_bars = {"P": ["A", "B", [0.5, 0.3]]}
    counts = set()
    for shift in range(len(bars)):
        turned = bars[shift:] + bars[:shift]
        content = {"fixed": fixed, "bars": turned, "points": POINTS}
        mechanism = read_bars({**content, "points_on_bars": on_bars}, "four-bar")
        counts.add((frozenset(mechanism.bodies), mechanism.gruebler))
    assert len(counts) == 1


def test_bars_between_different_points_with_one_name_are_refused():
    points = {"A": [0, 0], "A-B": [1, 0], "B-C": [1, 1], "C": [0, 1]}
    bars = [["A", "B-C"], ["A-B", "C"]]
    with pytest.raises(GeometryError, match='"A" to "B-C" and "A-B" to "C": "A-B-C"'):
        read_bars({"bars": bars, "points": points}, "two bars")


def test_numbers_may_be_constant_expressions():
    points = {"A": [0, "0"], "B": ["1/2", "sqrt(3)/2"], "C": [3, 2], "D": ["2^2", 0]}
    mechanism = four_bar("2*sqrt(2)", points)
    b, c = (np.array(mechanism.joint(name).point) for name in "BC")
    np.testing.assert_allclose(np.linalg.norm(b - c), math.sqrt(8), rtol=1e-14)
    exact = four_bar(math.sqrt(8), {**POINTS, "B": [0.5, math.sqrt(0.75)]})
    assert mechanism.joints == exact.joints


@pytest.mark.parametrize(
    "text", ["", "x", "sqrt(-1)", "1/0", "2 x", "__import__('os')"]
)
def test_what_is_no_constant_is_refused_with_the_point(text):
    with pytest.raises(GeometryError, match=r'point B: .* or a text such as "sqrt'):
        four_bar(2.0, {**POINTS, "B": [text, 1]})
